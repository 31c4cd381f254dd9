//! Gradient and Hessian against differences of the energy.

use super::mesh::{Layout, Mesh, Tables};
use super::newton::{Begin, Equations};
use super::sweep::{Column, Folded, Problem, Step, Sweep};
use super::{Energy, tendons};
use crate::Robot;
use crate::description::parse_robot;
use crate::model::{Command, Frame, Guides, Load, LoadKind, Motion, Path, Routing, Tendon};
use crate::statics::chain::Chain;
use crate::statics::rod::tests::tapered_rod;
use crate::statics::{Settings, Workspace, solve_in};
use nalgebra::Vector3;

/// Step of the differences, and what they leave of the first and of the second derivative, relative.
const DIFFERENCE: f64 = 1e-4;
const LEFT_OF_FIRST: f64 = 1e-7;
const LEFT_OF_SECOND: f64 = 1e-5;

/// A tapered rod of stiffness near 1 with helical tendons in channels and straight ones between guides, which all weigh.
pub(super) fn robot(routed: &[Routing]) -> Robot {
    let mut robot = tapered_rod(false);
    robot.loads.retain(|load| matches!(load.kind, LoadKind::Distributed { frame: Frame::World, .. }));
    for load in &mut robot.loads {
        if let LoadKind::Distributed { moment_per_length, .. } = &mut load.kind {
            *moment_per_length = Vector3::zeros();
        }
    }
    let hung = LoadKind::Point {
        at: 0.37,
        force: Vector3::new(0.3, -0.2, 0.4),
        moment: Vector3::zeros(),
        frame: Frame::World,
    };
    robot.loads.push(Load { name: None, kind: hung });
    let mass_center = [0.02, -0.01];
    robot.sections[0].guides =
        Some(Guides { positions: vec![0.25, 0.5, 0.8], mass: 0.1, mass_center, radius: None });
    for (number, routing) in routed.iter().copied().enumerate() {
        let angle = 2.0 * number as f64;
        robot.tendons.push(Tendon {
            name: number.to_string(),
            ends: 0,
            path: Path { radius: 0.15, tip_radius: 0.1, angle, turns: 0.3 * number as f64 },
            routing,
            stiffness: None,
            friction: 0.0,
            breaking_load: None,
            mass_per_length: 0.2,
            home: 0.0,
        });
        robot.actuation.push(Command::Tension { tension: 1.0 + number as f64, motion: Motion::Pulled });
    }
    robot
}

/// Energy at a multiple of a step from the mesh's shape.
pub(super) fn energy(problem: &Problem, mesh: &Mesh, sweep: &mut Sweep, step: &Step, scale: f64) -> f64 {
    let mut moved = mesh.clone();
    moved.turn.iter_mut().zip(&step.turn).for_each(|(turn, change)| *turn += scale * change);
    moved.v.iter_mut().zip(&step.v).for_each(|(v, change)| *v += scale * change);
    sweep.place(&mut moved, problem.tables);
    let mut lengths = Vec::new();
    tendons::measure(&moved, sweep, &mut lengths, problem.tensions.len());
    sweep.energy(problem, &moved, &lengths)
}

#[test]
fn gradient_and_hessian_are_derivatives_of_the_energy() {
    let (channel, guides) = (Routing::Channel, Routing::Guides);
    let routed: [&[Routing]; 3] = [&[channel; 2], &[guides; 2], &[channel, channel, guides]];
    for (routed, parts) in routed.into_iter().flat_map(|routed| [(routed, 1), (routed, 2)]) {
        let robot = robot(routed);
        let mut chain = Chain::default();
        chain.rebuild(&robot);
        let tables = Tables::default();
        let mut mesh = Mesh::default();
        let layouts: Vec<Layout> = chain.spans.iter().map(|_| Layout { parts, points: 3 }).collect();
        mesh.rebuild(&robot, &chain, &layouts, &tables);
        // somewhere else than at an equilibrium
        for (i, (turn, v)) in mesh.turn.iter_mut().zip(&mut mesh.v).enumerate() {
            let phase = i as f64;
            *turn += 0.1 * Vector3::new(phase.sin(), (1.7 * phase).cos(), (2.3 * phase).sin());
            *v += 0.05 * Vector3::new((0.7 * phase).cos(), (1.1 * phase).sin(), (1.9 * phase).cos());
        }
        let tensions = [1.0, 2.0, 3.0];
        let problem = Problem {
            chain: &chain,
            tables: &tables,
            factor: 0.9,
            gravity: robot.gravity,
            tensions: &tensions[..robot.tendons.len()],
        };
        let (mut sweep, mut gradient, mut step) = (Sweep::default(), Column::default(), Step::default());
        sweep.place(&mut mesh, &tables);
        sweep.gradient(&problem, &mesh, &mut gradient);
        sweep.factor(&problem, &mesh, 0.0);
        let mut right = Column::default();
        let mut first = Column::default();
        tendons::length_form(&mesh, &sweep, robot.tendons.len() - 1, true, &mut first);
        right.clone_from(&first);
        sweep.solve(&mesh, &tables, &right, &mut step);
        let scale = 0.3 / step.size;
        let [slope, curvature] = [&gradient, &right].map(|form| {
            let mut folded = Folded::default();
            form.fold(&sweep, &mesh, &tables, &mut folded);
            folded.dot(&step)
        });
        let (slope, curvature) = (scale * slope, scale * scale * curvature);

        let mut other = Sweep::default();
        let mut at = |h: f64| energy(&problem, &mesh, &mut other, &step, scale * h);
        let (ahead, here, behind) = (at(DIFFERENCE), at(0.0), at(-DIFFERENCE));
        let by_difference = (ahead - behind) / (2.0 * DIFFERENCE);
        assert!((slope - by_difference).abs() < LEFT_OF_FIRST * slope.abs(), "{slope} {by_difference}");
        let by_difference = (ahead - 2.0 * here + behind) / DIFFERENCE.powi(2);
        assert!(
            (curvature - by_difference).abs() < LEFT_OF_SECOND * curvature.abs(),
            "{curvature} {by_difference}"
        );
    }
}

/// The tangent of loads without an energy: the solved step moves the gradient by the right-hand side, to the second order of the step.
#[test]
fn the_tangent_of_followers_and_dead_moments_is_that_of_the_gradient() {
    for routed in [&[][..], &[Routing::Channel], &[Routing::Guides, Routing::Channel]] {
        let mut robot = robot(routed);
        let (force, moment) = (Vector3::new(0.4, -0.3, 0.2), Vector3::new(-0.1, 0.2, 0.15));
        for frame in [Frame::Body, Frame::World] {
            robot.loads.push(Load { name: None, kind: LoadKind::Point { at: 0.6, force, moment, frame } });
            robot.loads.push(Load {
                name: None,
                kind: LoadKind::Distributed {
                    from: 0.1,
                    to: 0.7,
                    force_per_length: moment,
                    moment_per_length: 0.5 * force,
                    frame,
                },
            });
        }
        let (mut chain, mut mesh, tables) = (Chain::default(), Mesh::default(), Tables::default());
        chain.rebuild(&robot);
        assert!(chain.follower && !chain.symmetric);
        let layouts = vec![Layout { parts: 2, points: 3 }; chain.spans.len()];
        mesh.rebuild(&robot, &chain, &layouts, &tables);
        let tensions = [1.0, 2.0];
        let problem = Problem {
            chain: &chain,
            tables: &tables,
            factor: 0.9,
            gravity: robot.gravity,
            tensions: &tensions[..robot.tendons.len()],
        };
        // at the equilibrium, where a turn of the frame of a cut adds nothing to the gradient
        let (mut sweep, mut gradient, mut step) = (Sweep::default(), Column::default(), Step::default());
        for _ in 0..30 {
            sweep.place(&mut mesh, &tables);
            sweep.gradient(&problem, &mesh, &mut gradient);
            sweep.factor(&problem, &mesh, 0.0).expect("is regular");
            gradient.negate();
            sweep.solve(&mesh, &tables, &gradient, &mut step);
            let part = (0.3 / step.size).min(1.0);
            mesh.turn.iter_mut().zip(&step.turn).for_each(|(turn, change)| *turn += part * change);
            mesh.v.iter_mut().zip(&step.v).for_each(|(v, change)| *v += part * change);
        }
        assert!(step.size < 1e-12, "{}", step.size);
        sweep.place(&mut mesh, &tables);
        sweep.gradient(&problem, &mesh, &mut gradient);
        sweep.factor(&problem, &mesh, 0.0).expect("is regular");
        let mut right = Column::default();
        right.clear(&mesh);
        for (i, form) in right.nodes.iter_mut().enumerate() {
            let phase = i as f64;
            form.turn = Vector3::new(phase.sin(), (1.7 * phase).cos(), (2.3 * phase).sin());
            form.v = Vector3::new((0.7 * phase).cos(), (1.1 * phase).sin(), (1.9 * phase).cos());
        }
        sweep.solve(&mesh, &tables, &right, &mut step);
        let scale = 1e-5 / step.size;
        let [behind, ahead] = [-scale, scale].map(|scale| {
            let (mut moved, mut sweep, mut gradient) = (mesh.clone(), Sweep::default(), Column::default());
            moved.turn.iter_mut().zip(&step.turn).for_each(|(turn, change)| *turn += scale * change);
            moved.v.iter_mut().zip(&step.v).for_each(|(v, change)| *v += scale * change);
            sweep.place(&mut moved, &tables);
            sweep.gradient(&problem, &moved, &mut gradient);
            gradient.reduced(&sweep, &moved, &tables)
        });
        let expected = right.reduced(&sweep, &mesh, &tables);
        let largest = expected.iter().map(Vector3::amax).fold(0.0, f64::max);
        for (i, expected) in expected.iter().enumerate() {
            let found = (ahead[i] - behind[i]) / (2.0 * scale);
            assert!((found - expected).amax() < 1e-5 * largest, "{routed:?} {i}: {found} {expected}");
        }
    }
}

/// The bound of convexity at the robot's equilibrium, which is below the smallest eigenvalue there.
fn bound_below_the_eigenvalue(robot: &Robot, loaded_by: f64) -> f64 {
    let mut workspace = Workspace::default();
    let found = solve_in(robot, &Settings::default(), &mut workspace).expect("has an answer");
    let eigenvalue = found.report.smallest_eigenvalue.expect("asked for");
    let Workspace { chain, energy: Energy { tables, coarse, memory, .. }, .. } = &workspace;
    let tensions = &memory.drive.tensions;
    let problem = Problem { chain, tables, factor: 1.0, gravity: robot.gravity, tensions };
    let bound = memory.sweep.curvature_bound(&problem, coarse).expect("has an energy");
    assert!(bound <= eigenvalue, "{loaded_by}: {bound} {eigenvalue}");
    bound
}

/// Tensions in chords, up to nearly what folds the robot between its guides.
const TENSIONS: [f64; 4] = [0.25, 1.0, 2.0, 4.0];

#[test]
fn the_bound_with_chords_alone_is_below_the_smallest_eigenvalue() {
    let bounds = TENSIONS.map(|tension| {
        let mut robot = robot(&[Routing::Guides; 2]);
        robot.gravity = Vector3::zeros();
        robot.loads.clear();
        robot.actuation.fill(Command::Tension { tension, motion: Motion::Pulled });
        bound_below_the_eigenvalue(&robot, tension)
    });
    assert!(bounds[0] > 0.4 && bounds[TENSIONS.len() - 1] < 0.1, "{bounds:?}");
}

/// Two points between guides see of the curvature what is constant and what grows: the bow is missing.
#[test]
fn bows_between_guides_stand_for_a_third_point() {
    let text = include_str!("../../../../../robots/scr.toml");
    let mut robot = parse_robot(text, "scr.toml").expect("is valid").value;
    let length = robot.length();
    for (i, pull) in [6.0, 2.0, 0.5].into_iter().enumerate() {
        robot.actuation[i] = Command::Tension { tension: pull, motion: Motion::Pulled };
    }
    let with = |tolerance: f64| Settings { tolerance, eigenvalue: false, ..Settings::default() };
    let exact = solve_in(&robot, &with(1e-11), &mut Workspace::default()).expect("has an answer");
    let mut workspace = Workspace::default();
    let found = solve_in(&robot, &with(1e-6), &mut workspace).expect("has an answer");
    let off = |tip: &Vector3<f64>| (tip - exact.tip.position).norm() / length;
    let Workspace { chain, energy: Energy { tables, coarse, memory, .. }, .. } = &mut workspace;
    assert!(coarse.bows && coarse.panels.iter().all(|panel| panel.nodes.len() == 2));
    let (left, estimate) = (off(&found.tip.position), found.report.error_estimate / length);
    assert!(left < 1e-7 && left < estimate && estimate < 1e-6, "{left} {estimate}");

    coarse.bows = false;
    coarse.panels.iter_mut().for_each(|panel| panel.bow = Vector3::zeros());
    let equations = Equations { robot: &robot, chain, tables, factor: 1.0 };
    equations.newton(memory, coarse, 1e-9, Begin::Anew, &mut 0).expect("converges");
    let without = off(&coarse.positions[coarse.panels.len()]);
    assert!(without > 30.0 * left, "{without} {left}");
}

/// Forces that push the tip along the base, up to nearly what buckles a rod of stiffness 1; the bound is sure of the first alone.
const PUSHES: [f64; 5] = [0.02, 0.2, 0.5, 1.0, 2.0];

#[test]
fn the_bound_of_convexity_is_below_the_smallest_eigenvalue() {
    for routed in
        [&[][..], &[Routing::Channel; 2], &[Routing::Guides; 2], &[Routing::Guides, Routing::Channel]]
    {
        let bounds = PUSHES.map(|push| {
            let mut robot = robot(routed);
            robot.gravity *= push;
            if robot.tendons.iter().any(|tendon| tendon.routing == Routing::Guides) {
                // where they go straight tendons bend the robot towards themselves
                for command in &mut robot.actuation {
                    *command = Command::Tension { tension: 0.05 * push, motion: Motion::Pulled };
                }
            }
            let force = -push * robot.base.rotation.matrix().column(2);
            let kind =
                LoadKind::Point { at: robot.length(), force, moment: Vector3::zeros(), frame: Frame::World };
            robot.loads = vec![Load { name: None, kind }];
            bound_below_the_eigenvalue(&robot, push)
        });
        assert!(bounds[0] > 0.4 && bounds[PUSHES.len() - 1] < 0.0, "{bounds:?}");
    }
}

impl Column {
    /// On turns and v alone: the rotations of the cuts carried back to the turns before them.
    fn reduced(&self, sweep: &Sweep, mesh: &Mesh, tables: &Tables) -> Vec<Vector3<f64>> {
        let mut folded = Folded::default();
        self.fold(sweep, mesh, tables, &mut folded);
        let Folded { mut turn, v, mut cuts } = folded;
        for k in (0..mesh.panels.len()).rev() {
            let (panel, end) = (&mesh.panels[k], &sweep.panels[k].end);
            let table = tables.of(panel.nodes.len());
            for (node, e) in panel.nodes.clone().zip(&table.end) {
                turn[node] += *e * end.jacobian.tr_mul(&cuts[k + 1]);
            }
            let carried = end.across.tr_mul(&cuts[k + 1]);
            cuts[k] += carried;
        }
        turn.extend(v);
        turn
    }
}
