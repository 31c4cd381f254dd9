//! Robots bent by tendons.

use super::{Case, Group, material, prismatic, rod};
use crate::model::{Command, CrossSection, Guides, Motion, Path, Routing, Tendon};
use crate::solution::Method;
use crate::statics::{self, Settings};
use crate::{Equilibrium, Robot};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

const METHODS: [(Method, &str); 2] = [(Method::Energy, "energy"), (Method::Shooting, "shooting")];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = straight();
    cases.extend(published());
    cases.extend(capstan());
    cases.extend(guides());
    cases.extend(energy());
    cases.extend(ending_halfway());
    cases
}

fn solved(robot: &Robot, method: Method) -> Result<Equilibrium, String> {
    let settings =
        Settings { method, tolerance: 1e-10, stations: 3, eigenvalue: false, ..Settings::default() };
    statics::solve(robot, &settings).map_err(|error| error.to_string())
}

/// A rod along x with parallel tendons at one radius; hole at angle 0 along world y.
fn pulled(length: f64, diameter: f64, youngs_modulus: f64, radius: f64, tensions: &[(f64, f64)]) -> Robot {
    let section = CrossSection::Round { diameter };
    let mut robot = rod(length, material(youngs_modulus, 0.33), prismatic(section));
    for (angle, tension) in tensions {
        robot.tendons.push(Tendon {
            name: format!("{angle}"),
            ends: 0,
            path: Path { radius, tip_radius: radius, angle: *angle, turns: 0.0 },
            routing: Routing::Channel,
            stiffness: None,
            friction: 0.0,
            breaking_load: None,
            mass_per_length: 0.0,
            home: 0.0,
        });
        robot.actuation.push(Command::Tension { tension: *tension, motion: Motion::Pulled });
    }
    robot
}

fn straight() -> Vec<Case> {
    let group = Group {
        title: "Straight tendons",
        source: "exact: EI kappa = tau r, v3 = 1 - tau/EA; NiTi of 1.56 mm, 54 GPa, 0.4 m, 5 N at 8 mm",
        reason: "the solver is asked for 1e-10 L",
    };
    let robot = pulled(0.4, 1.56e-3, 54e9, 8e-3, &[(0.0, 5.0)]);
    let compressed = pulled(0.4, 1.56e-3, 54e9, 8e-3, &[0.0, 1.0, 2.0].map(|i| (i * PI * 2.0 / 3.0, 20.0)));
    let area = PI / 4.0 * 1.56e-3_f64.powi(2);
    METHODS
        .into_iter()
        .flat_map(|(method, name)| {
            let one = solved(&robot, method);
            let all = solved(&compressed, method);
            let read = |of: &Result<Equilibrium, String>, number: &dyn Fn(&Equilibrium) -> f64| {
                of.as_ref().map(number).map_err(Clone::clone)
            };
            [
                group.case(
                    format!("{name}: curvature [1/m]"),
                    2.547_991_291_7,
                    read(&one, &|e| e.stations[1].u.norm()),
                    1e-9,
                ),
                group.case(
                    format!("{name}: tip, aside [m]"),
                    0.186_784_981_559,
                    read(&one, &|e| e.tip.position.y),
                    1e-10,
                ),
                group.case(
                    format!("{name}: tip, along [m]"),
                    0.334_242_104_764,
                    read(&one, &|e| e.tip.position.x),
                    1e-10,
                ),
                group.case(
                    format!("{name}: three of 20 N at 120 degrees: v3"),
                    1.0 - 60.0 / (54e9 * area),
                    read(&all, &|e| e.stations[1].v.z),
                    1e-12,
                ),
            ]
        })
        .collect()
}

fn published() -> Vec<Case> {
    let group = Group {
        title: "Robot of Till, Aloi and Rucker 2019, 15 N on one tendon",
        source: "computed outside this project; without gravity exact, tau r/EI",
        reason: "seven printed digits; ten for the curvature",
    };
    let mut robot = pulled(0.5, 2e-3, 200e9, 15.06e-3, &[(0.0, 15.0)]);
    robot.sections[0].material.shear_modulus = 80e9;
    let arc = robot.clone();
    robot.sections[0].material.density = 8000.0;
    robot.gravity = Vector3::new(0.0, 9.81, 0.0);
    METHODS
        .into_iter()
        .flat_map(|(method, name)| {
            let heavy = solved(&robot, method);
            let tip = |axis: usize| heavy.as_ref().map(|e| e.tip.position[axis]).map_err(Clone::clone);
            [
                group.case(format!("{name}: tip, aside [m]"), 0.182_211_7, tip(1), 2e-7),
                group.case(format!("{name}: tip, along [m]"), 0.453_229_3, tip(0), 2e-7),
                group.case(
                    format!("{name}: curvature without gravity [1/m]"),
                    1.438_124_065_8,
                    solved(&arc, method).map(|e| e.stations[1].u.norm()),
                    1e-9,
                ),
            ]
        })
        .collect()
}

fn capstan() -> Vec<Case> {
    let group = Group {
        title: "Capstan friction, EI 0.0157 N m^2, r 8 mm, 5 N, mu 0.2, L 0.3 m",
        source: "exact: tip angle ln(1 + mu r T L/EI)/mu, tip tension T exp(-mu angle)",
        reason: "shares of the tension are found to 1e-11, lengths to 1e-10",
    };
    let diameter = (0.0157 * 64.0 / PI / 54e9_f64).powf(0.25);
    let mut robot = pulled(0.3, diameter, 54e9, 8e-3, &[(0.0, 5.0)]);
    robot.tendons[0].friction = 0.2;
    let found = solved(&robot, Method::Energy);
    let angle = |e: &Equilibrium| {
        let along = e.tip.rotation.matrix().column(2).into_owned();
        along.y.atan2(along.x)
    };
    vec![
        group.case("tip angle [rad]", 0.711_256_129_6, found.as_ref().map(angle).map_err(Clone::clone), 1e-8),
        group.case("tip tension [N]", 4.337_016_6, found.map(|e| e.tendons[0].tip_tension), 1e-7),
    ]
}

fn guides() -> Vec<Case> {
    let group = Group {
        title: "Straight between guides against a channel",
        source: "theory: chords approach a smooth curve with the square of their length",
        reason: "order observed between spacings of 40 and 20 mm",
    };
    let tip = |spacing: Option<f64>| {
        let mut robot = pulled(0.4, 1.56e-3, 54e9, 8e-3, &[(0.0, 5.0)]);
        if let Some(spacing) = spacing {
            robot.tendons[0].routing = Routing::Guides;
            let count = (0.4 / spacing).round() as usize;
            let positions = (1..=count).map(|i| (i as f64 * spacing).min(0.4)).collect();
            robot.sections[0].guides =
                Some(Guides { positions, mass: 0.0, mass_center: [0.0; 2], radius: None });
        }
        solved(&robot, Method::Energy).map(|e| e.tip.position)
    };
    let order = || {
        let (channel, coarse, fine) = (tip(None)?, tip(Some(0.04))?, tip(Some(0.02))?);
        Ok(((coarse - channel).norm() / (fine - channel).norm()).log2())
    };
    vec![group.case("observed order", 2.0, order(), 0.2)]
}

/// A rod with a straight tendon of 0.8 N that ends halfway and a helical one of 2 N to the tip.
fn halfway() -> Robot {
    let mut robot = pulled(0.242, 0.8e-3, 210e9, 8e-3, &[(0.3, 0.8), (1.0, 2.0)]);
    robot.sections[0].length *= 0.5;
    robot.sections.push(robot.sections[0].clone());
    robot.tendons[1].ends = 1;
    robot.tendons[1].path.turns = 1.0;
    robot
}

fn energy() -> Vec<Case> {
    let group = Group {
        title: "Tendons and energy",
        source: "Maxwell: dl1/dT2 = dl2/dT1; lengths pulled in and tensions are inverse to each other",
        reason: "differences of solves to 1e-10 L over 0.02 N; lengths to 1e-10 L",
    };
    let mut robot = halfway();
    robot.gravity = Vector3::new(0.0, -9.81, 0.0);
    robot.sections.iter_mut().for_each(|section| section.material.density = 7850.0);
    let slope = |length: usize, tension: usize| {
        let at = |change: f64| {
            let mut robot = robot.clone();
            let Command::Tension { tension, .. } = &mut robot.actuation[tension] else {
                return Err("commanded by tension".to_owned());
            };
            *tension += change;
            solved(&robot, Method::Energy).map(|e| e.tendons[length].length)
        };
        Ok::<f64, String>((at(0.01)? - at(-0.01)?) / 0.02)
    };
    let asymmetry = || Ok::<f64, String>((slope(0, 1)? - slope(1, 0)?) / slope(1, 0)?.abs());
    let there_and_back = || {
        let there = solved(&robot, Method::Energy)?;
        let mut held = robot.clone();
        for (command, tendon) in held.actuation.iter_mut().zip(&there.tendons) {
            *command = Command::Displacement { displacement: tendon.displacement, motion: Motion::Pulled };
        }
        Ok::<f64, String>(solved(&held, Method::Energy)?.tendons[1].tension)
    };
    vec![
        group.case("(dl1/dT2 - dl2/dT1) / dl2/dT1", 0.0, asymmetry(), 1e-6),
        group.case("tension that holds what 2 N pulled in [N]", 2.0, there_and_back(), 1e-6),
    ]
}

/// Without loads the whole wrench is zero everywhere, so that the section law gives the strains place by place, kink and all.
fn ending_halfway() -> Vec<Case> {
    let group = Group {
        title: "A straight tendon that ends halfway beside a helical one",
        source: "section law with zero total wrench by fixed-point iteration, integrated by 4,000 steps of Runge-Kutta",
        reason: "the solver is asked for 1e-10 L; the integration is exact to 1e-12",
    };
    let robot = halfway();
    let reference = integrated(&robot, 4000);
    METHODS
        .into_iter()
        .flat_map(|(method, name)| {
            let found = solved(&robot, method);
            let of = |axis: usize| found.as_ref().map(|e| e.tip.position[axis]).map_err(Clone::clone);
            ["x", "y", "z"]
                .into_iter()
                .enumerate()
                .map(move |(axis, label)| {
                    group.case(format!("{name}: tip {label} [m]"), reference[axis], of(axis), 1e-9)
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Tip of a robot without loads whose straight rod is pulled by channel tendons.
fn integrated(robot: &Robot, steps: usize) -> Vector3<f64> {
    let (shear, bend) = robot.sections[0].stiffness(0.0);
    let strains = |s: f64, before_end: bool| {
        let (mut v, mut u) = (Vector3::z(), Vector3::zeros());
        for _ in 0..60 {
            let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
            for (tendon, command) in robot.tendons.iter().zip(&robot.actuation) {
                let end = robot.tendon_end(tendon);
                let Command::Tension { tension, .. } = *command else { continue };
                if s < end * (1.0 - 1e-12) || before_end && s < end * (1.0 + 1e-12) {
                    let (hole, along) = tendon.path.hole(s / end, end);
                    let pull = tension * (v + u.cross(&hole) + along).normalize();
                    force -= pull;
                    moment -= hole.cross(&pull);
                }
            }
            (v, u) = (Vector3::z() + force.component_div(&shear), moment.component_div(&bend));
        }
        (v, u)
    };
    let h = robot.length() / steps as f64;
    let (mut position, mut rotation) = (robot.base.position, *robot.base.rotation.matrix());
    for step in 0..steps {
        let s = step as f64 * h;
        let rate = |rotation: &Matrix3<f64>, (v, u): (Vector3<f64>, Vector3<f64>)| {
            (rotation * v, rotation * u.cross_matrix())
        };
        let [start, middle, end] =
            [(s, false), (s + 0.5 * h, false), (s + h, true)].map(|(s, end)| strains(s, end));
        let a = rate(&rotation, start);
        let b = rate(&(rotation + 0.5 * h * a.1), middle);
        let c = rate(&(rotation + 0.5 * h * b.1), middle);
        let d = rate(&(rotation + h * c.1), end);
        position += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
        rotation += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
    }
    position
}
