//! What must hold for every rod, whatever its shape.

use hydrostat::Equilibrium;
use hydrostat::Robot;
use hydrostat::model::{CrossSection, Frame, Load, LoadKind, Material, Pose, Profile, Section};
use hydrostat::statics::{Settings, solve};
use hydrostat::validate::robustness;
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Of the length: the solver's own tolerance and a margin for two solves.
const CLOSE: f64 = 1e-8;

fn solved(robot: &Robot) -> Equilibrium {
    solve(robot, &shooting()).unwrap_or_else(|error| panic!("{}: {error}", robot.name))
}

/// Two sections, one tapered, bent at rest, with one load of every kind.
fn rod() -> Robot {
    let material = Material {
        name: "polymer".into(),
        youngs_modulus: 3e9,
        shear_modulus: 1.1e9,
        density: 1300.0,
        strain_limit: None,
    };
    let section =
        |name: &str, length: f64, base: CrossSection, tip: CrossSection, rest: Vector3<f64>| Section {
            name: name.into(),
            length,
            material: material.clone(),
            profile: Profile { base, tip, shear_coefficient: 0.9 },
            rest_curvature: rest,
            guides: None,
        };
    let round = |diameter| CrossSection::Round { diameter };
    let strip = CrossSection::Strip { width: 6e-3, height: 3e-3 };
    let load = |kind| Load { name: None, kind };
    Robot {
        tendons: Vec::new(),
        actuation: Vec::new(),
        name: "two sections".into(),
        gravity: Vector3::new(1.0, -9.0, 3.0),
        base: Pose {
            position: Vector3::new(0.1, -0.2, 0.3),
            rotation: Rotation3::from_euler_angles(0.4, 1.0, -0.3),
        },
        sections: vec![
            section("proximal", 0.2, round(5e-3), round(4e-3), Vector3::new(2.0, -1.0, 3.0)),
            section("distal", 0.2, strip, strip, Vector3::new(0.0, 4.0, -2.0)),
        ],
        loads: vec![
            load(LoadKind::Point {
                at: 0.4,
                force: Vector3::new(0.3, 0.2, -0.4),
                moment: Vector3::new(0.01, -0.02, 0.03),
                frame: Frame::World,
            }),
            load(LoadKind::Point {
                at: 0.27,
                force: Vector3::new(0.1, 0.3, 0.0),
                moment: Vector3::new(0.0, 0.0, 0.01),
                frame: Frame::Body,
            }),
            load(LoadKind::Mass { at: 0.13, mass: 0.02 }),
            load(LoadKind::Distributed {
                from: 0.1,
                to: 0.35,
                force_per_length: Vector3::new(0.5, 0.0, 0.4),
                moment_per_length: Vector3::new(0.0, 0.02, 0.0),
                frame: Frame::World,
            }),
        ],
    }
}

/// Rods of the sweep beside the one above.
fn rods() -> Vec<Robot> {
    (0..10).map(|index| robustness::robot(7, index)).chain([rod()]).collect()
}

/// Applies maps to the force-like and moment-like vectors of all loads: in the world and in the body frame.
fn map_loads(
    robot: &mut Robot,
    force: impl Fn(Vector3<f64>, Frame) -> Vector3<f64>,
    moment: impl Fn(Vector3<f64>, Frame) -> Vector3<f64>,
) {
    for load in &mut robot.loads {
        match &mut load.kind {
            LoadKind::Point { force: f, moment: m, frame, .. } => {
                (*f, *m) = (force(*f, *frame), moment(*m, *frame))
            }
            LoadKind::Distributed { force_per_length: f, moment_per_length: m, frame, .. } => {
                (*f, *m) = (force(*f, *frame), moment(*m, *frame))
            }
            LoadKind::Mass { .. } => {}
        }
    }
}

/// Largest distance of positions over the stations, as a fraction of the length.
fn distance(a: &Equilibrium, b: &Equilibrium, to_b: impl Fn(Vector3<f64>) -> Vector3<f64>) -> f64 {
    assert_eq!(a.stations.len(), b.stations.len());
    let length = b.stations[b.stations.len() - 1].s;
    let pairs = a.stations.iter().zip(&b.stations);
    pairs.map(|(a, b)| (to_b(a.position) - b.position).norm()).fold(0.0, hydrostat::numeric::larger) / length
}

#[test]
fn a_rigid_motion_of_everything_moves_the_shape() {
    let (turn, shift) = (Rotation3::from_euler_angles(1.0, -0.5, 2.0), Vector3::new(1.0, 2.0, -0.5));
    for robot in rods() {
        let mut moved = robot.clone();
        moved.base.position = turn * robot.base.position + shift;
        moved.base.rotation = turn * robot.base.rotation;
        moved.gravity = turn * robot.gravity;
        let world = |x, frame| if frame == Frame::World { turn * x } else { x };
        map_loads(&mut moved, world, world);
        let found = distance(&solved(&robot), &solved(&moved), |p| turn * p + shift);
        assert!(found < CLOSE, "{}: {found:.1e}", robot.name);
    }
}

/// World mirrored at z = 0, body at d1 = 0: vectors change one sign, moments and curvatures (pseudovectors) the other two.
#[test]
fn the_mirror_image_of_the_loads_gives_the_mirror_image_of_the_shape() {
    let world = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    let body = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
    for robot in rods() {
        let mut mirrored = robot.clone();
        mirrored.base.position = world * robot.base.position;
        mirrored.base.rotation =
            Rotation3::from_matrix_unchecked(world * robot.base.rotation.matrix() * body);
        mirrored.gravity = world * robot.gravity;
        for section in &mut mirrored.sections {
            section.rest_curvature = -(body * section.rest_curvature);
        }
        let mirror = |frame| if frame == Frame::World { world } else { body };
        map_loads(&mut mirrored, |x, frame| mirror(frame) * x, |x, frame| -(mirror(frame) * x));
        let found = distance(&solved(&robot), &solved(&mirrored), |p| world * p);
        assert!(found < CLOSE, "{}: {found:.1e}", robot.name);
    }
}

/// The same rod in other units of length, mass and time.
#[test]
fn units_do_not_matter() {
    let (length, mass, time) = (1e3, 0.3, 60.0);
    let force = mass * length / (time * time);
    for robot in rods() {
        let mut scaled = robot.clone();
        scaled.base.position *= length;
        scaled.gravity *= length / (time * time);
        for section in &mut scaled.sections {
            section.length *= length;
            section.rest_curvature /= length;
            section.material.youngs_modulus *= force / (length * length);
            section.material.shear_modulus *= force / (length * length);
            section.material.density *= mass / length.powi(3);
            section.profile.base = enlarged(section.profile.base, length);
            section.profile.tip = enlarged(section.profile.tip, length);
        }
        for load in &mut scaled.loads {
            match &mut load.kind {
                LoadKind::Point { at, force: f, moment, .. } => {
                    *at *= length;
                    *f *= force;
                    *moment *= force * length;
                }
                LoadKind::Mass { at, mass: m } => {
                    *at *= length;
                    *m *= mass;
                }
                LoadKind::Distributed { from, to, force_per_length, moment_per_length, .. } => {
                    *from *= length;
                    *to *= length;
                    *force_per_length *= force / length;
                    *moment_per_length *= force;
                }
            }
        }
        let found = distance(&solved(&robot), &solved(&scaled), |p| length * p);
        assert!(found < CLOSE, "{}: {found:.1e}", robot.name);
    }
}

fn enlarged(section: CrossSection, by: f64) -> CrossSection {
    match section {
        CrossSection::Round { diameter } => CrossSection::Round { diameter: by * diameter },
        CrossSection::Tube { diameter, inner_diameter } => {
            CrossSection::Tube { diameter: by * diameter, inner_diameter: by * inner_diameter }
        }
        CrossSection::Strip { width, height } => {
            CrossSection::Strip { width: by * width, height: by * height }
        }
    }
}

/// Force and moment of the part beyond each station, summed from the loads themselves over the found shape.
#[test]
fn the_wrench_balances_what_is_beyond_every_station() {
    for robot in rods() {
        let found = robustness::defects(&robot, &solved(&robot));
        // 1e-7: Runge-Kutta of order 4 on 1600 steps
        assert!(found.largest() < 1e-7, "{}: {found:?}", robot.name);
    }
}

/// Without loads a section of constant u* is a helix, exactly: p = (sin, 1 - cos, ..) about the axis u*.
#[test]
fn an_unloaded_rod_has_its_rest_shape() {
    let mut robot = rod();
    robot.gravity = Vector3::zeros();
    robot.loads.clear();
    let found = solved(&robot);
    let (mut position, mut rotation) = (robot.base.position, *robot.base.rotation.matrix());
    let mut start = 0.0;
    for section in &robot.sections {
        let u = section.rest_curvature;
        let at = |s: f64| {
            let turn = Rotation3::new(u * s).into_inner();
            let w = u.norm();
            let along = u * u.dot(&Vector3::z()) / (w * w);
            let chord = along * s
                + (Vector3::z() - along) * (w * s).sin() / w
                + u.cross(&Vector3::z()) * (1.0 - (w * s).cos()) / (w * w);
            (position + rotation * chord, rotation * turn)
        };
        for station in &found.stations {
            let s = station.s - start;
            if (0.0..=section.length).contains(&s) {
                let (exact, axes) = at(s);
                assert!((station.position - exact).norm() < CLOSE * robot.length());
                assert!((station.rotation - axes).norm() < CLOSE);
                assert!(station.force.norm() + station.moment.norm() < 1e-12);
            }
        }
        let end = at(section.length);
        start += section.length;
        (position, rotation) = end;
    }
    assert_eq!(found.report.stable, Some(true));
}

#[test]
fn loads_at_one_place_add_up() {
    let mut split = rod();
    for load in &mut split.loads {
        match &mut load.kind {
            LoadKind::Point { force, moment, .. } => (*force, *moment) = (0.3 * *force, 0.3 * *moment),
            LoadKind::Mass { mass, .. } => *mass *= 0.3,
            LoadKind::Distributed { force_per_length: f, moment_per_length: m, .. } => {
                (*f, *m) = (0.3 * *f, 0.3 * *m)
            }
        }
    }
    let mut rest = split.loads.clone();
    for load in &mut rest {
        match &mut load.kind {
            LoadKind::Point { force, moment, .. } => {
                (*force, *moment) = (*force * 7.0 / 3.0, *moment * 7.0 / 3.0)
            }
            LoadKind::Mass { mass, .. } => *mass *= 7.0 / 3.0,
            LoadKind::Distributed { force_per_length: f, moment_per_length: m, .. } => {
                (*f, *m) = (*f * 7.0 / 3.0, *m * 7.0 / 3.0)
            }
        }
    }
    split.loads.extend(rest);
    assert!(distance(&solved(&rod()), &solved(&split), |p| p) < CLOSE);
}

#[test]
fn a_hung_mass_is_a_dead_force() {
    let mut force = rod();
    for load in &mut force.loads {
        if let LoadKind::Mass { at, mass } = load.kind {
            load.kind = LoadKind::Point {
                at,
                force: mass * force.gravity,
                moment: Vector3::zeros(),
                frame: Frame::World,
            };
        }
    }
    assert!(distance(&solved(&rod()), &solved(&force), |p| p) < CLOSE);
}

/// A section cut in two of the same kind is the same section.
#[test]
fn where_a_section_is_divided_does_not_matter() {
    let mut divided = rod();
    let whole = divided.sections.remove(0);
    let middle = whole.cross_section(0.25);
    let (mut first, mut second) = (whole.clone(), whole.clone());
    first.length = 0.25 * whole.length;
    second.length = 0.75 * whole.length;
    (first.profile.tip, second.profile.base) = (middle, middle);
    divided.sections.splice(0..0, [first, second]);
    assert!(distance(&solved(&rod()), &solved(&divided), |p| p) < CLOSE);
}

/// Maxwell and Betti about the loaded shape: the tip's linear response to small forces is symmetric.
#[test]
fn the_response_to_small_tip_forces_is_symmetric() {
    let mut robot = rod();
    robot.loads.retain(|load| !matches!(load.kind, LoadKind::Point { frame: Frame::Body, .. }));
    // a moment about a fixed axis has no potential either
    map_loads(&mut robot, |force, _| force, |_, _| Vector3::zeros());
    let step = 1e-3;
    let tight = Settings { tolerance: 1e-12, ..shooting() };
    let tip = |force: Vector3<f64>| {
        let mut robot = robot.clone();
        let kind =
            LoadKind::Point { at: robot.length(), force, moment: Vector3::zeros(), frame: Frame::World };
        robot.loads.push(Load { name: None, kind });
        solve(&robot, &tight).unwrap_or_else(|error| panic!("{error}")).tip.position
    };
    let column = |axis: Vector3<f64>| (tip(step * axis) - tip(-step * axis)) / (2.0 * step);
    let compliance = Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(column));
    let skew = (compliance - compliance.transpose()).norm() / compliance.norm();
    // what central differences leave: (1 mN against loads of 0.5 N)^2
    assert!(skew < 4e-6, "{skew:.1e}");
}

/// This file is about the shooting method.
fn shooting() -> Settings {
    Settings { method: hydrostat::solution::Method::Shooting, ..Settings::default() }
}
