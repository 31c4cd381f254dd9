//! What the solver says of stability, against columns whose answer is known.

use hydrostat::model::{
    Command, CrossSection, Frame, Load, LoadKind, Material, Motion, Path, Pose, Profile, Routing, Section,
    Tendon,
};
use hydrostat::statics::{Settings, Workspace, solve, solve_near};
use hydrostat::{Equilibrium, Robot};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::PI;

/// Stretch and shear, left out by Euler, change the eigenvalue by P/EA + P/GA: 6e-7 at length / diameter = 1000.
const SLENDER: f64 = 1e-5;
/// What the solver itself calls an eigenvalue of 1.
const UNLOADED: f64 = 1e-3;
/// The largest load step in which the branch may turn unstable unseen, with one more for the mesh's own error.
const LOAD_STEP: f64 = 2.0 / 64.0;

/// Parts of Euler's load.
const BELOW: [f64; 5] = [-1.0, 0.01, 0.5, 0.9, 0.999];
const JUST_ABOVE: [f64; 4] = [1.001, 1.05, 2.0, 8.9];

/// An upright column of unit length and unit bending stiffness, base to tip along z.
fn column() -> Robot {
    let diameter: f64 = 1e-3;
    let youngs_modulus = 64.0 / (PI * diameter.powi(4));
    let round = CrossSection::Round { diameter };
    Robot {
        tendons: Vec::new(),
        actuation: Vec::new(),
        name: "column".into(),
        gravity: Vector3::zeros(),
        base: Pose { position: Vector3::zeros(), rotation: Rotation3::identity() },
        sections: vec![Section {
            name: "column".into(),
            length: 1.0,
            material: Material {
                name: "unit stiffness".into(),
                youngs_modulus,
                shear_modulus: youngs_modulus / 2.6,
                density: 0.0,
                strain_limit: None,
            },
            profile: Profile { base: round, tip: round, shear_coefficient: 0.9 },
            rest_curvature: Vector3::zeros(),
            guides: None,
        }],
        loads: Vec::new(),
    }
}

fn at_tip(force: Vector3<f64>, moment: Vector3<f64>, frame: Frame) -> Robot {
    let mut robot = column();
    robot.loads.push(Load { name: None, kind: LoadKind::Point { at: 1.0, force, moment, frame } });
    robot
}

/// The column under a part of Euler's load, pi^2/4.
fn thrust(part_of_critical: f64) -> Robot {
    at_tip(-part_of_critical * PI * PI / 4.0 * Vector3::z(), Vector3::zeros(), Frame::World)
}

fn solved(robot: &Robot) -> Equilibrium {
    solve(robot, &shooting()).unwrap_or_else(|error| panic!("{error}"))
}

/// Value of the check and whether it passed.
fn stability_check(found: &Equilibrium) -> Option<(f64, bool)> {
    found.checks.iter().find(|check| check.name == "stability").map(|check| (check.value, check.ok))
}

/// A warm start whose steps are too small to need another Hessian: the load alone takes a straight column over Euler's load.
#[test]
fn the_energy_method_sees_a_straight_column_buckle_between_warm_starts() {
    let settings = Settings { eigenvalue: false, ..Settings::default() };
    let mut workspace = Workspace::default();
    for step in 0..40 {
        let part = 0.51 + 0.02 * f64::from(step);
        let found = solve_near(&thrust(part), &settings, &mut workspace).expect("straight");
        assert!(found.tip.position.xy().norm() < 1e-9);
        assert_eq!(found.report.stable, Some(part < 1.0), "{part} of Euler's load");
    }
    // asked not to judge, it says nothing
    let bare = Settings { stability: false, ..settings };
    let found = solve_near(&thrust(1.31), &bare, &mut workspace).expect("straight");
    assert_ne!(found.report.stable, Some(true));
}

/// Tendons paid out hold nothing: the column buckles as without them. The same tendons taut hold it.
#[test]
fn slack_tendons_do_not_hold_a_column() {
    for (displacement, stable) in [(-1e-4, false), (1e-6, true)] {
        let mut robot = thrust(1.2);
        for i in 0..3 {
            let angle = 2.0 * PI * f64::from(i) / 3.0;
            robot.tendons.push(Tendon {
                name: i.to_string(),
                ends: 0,
                path: Path { radius: 0.02, tip_radius: 0.02, angle, turns: 0.0 },
                routing: Routing::Channel,
                stiffness: None,
                friction: 0.0,
                breaking_load: None,
                mass_per_length: 0.0,
                home: 0.0,
            });
            robot.actuation.push(Command::Displacement { displacement, motion: Motion::Pulled });
        }
        for eigenvalue in [true, false] {
            let settings = Settings { eigenvalue, ..Settings::default() };
            let found = solve(&robot, &settings).expect("straight");
            assert_eq!(found.report.stable, Some(stable), "{displacement} m, eigenvalue {eigenvalue}");
        }
    }
}

#[test]
fn an_unloaded_rod_has_the_eigenvalue_one() {
    let mut bent = column();
    bent.sections[0].rest_curvature = Vector3::new(1.0, -2.0, 3.0);
    for robot in [column(), bent] {
        let found = solved(&robot);
        let eigenvalue = found.report.smallest_eigenvalue.expect("asked for");
        assert!((eigenvalue - 1.0).abs() < UNLOADED, "{eigenvalue}");
        assert_eq!(found.report.stable, Some(true));
        assert_eq!(stability_check(&found), Some((eigenvalue, true)));
    }
}

/// The second variation EI phi'^2 - P phi^2 over EI phi'^2 is least for the buckling mode: 1 - P / P_critical.
#[test]
fn a_column_has_the_eigenvalue_of_euler() {
    for part in BELOW {
        let found = solved(&thrust(part));
        let eigenvalue = found.report.smallest_eigenvalue.expect("asked for");
        // in tension the eigenvalues accumulate at 1 from above, and 1 stands for them
        let exact = f64::min(1.0 - part, 1.0);
        assert!((eigenvalue - exact).abs() < SLENDER, "{part} of Euler's load: {eigenvalue}");
        assert_eq!(found.report.stable, Some(true));
        assert_eq!(found.report.unstable_from, None);
    }
}

#[test]
fn beyond_eulers_load_the_straight_column_is_unstable_and_the_check_fails() {
    for part in JUST_ABOVE {
        let found = solved(&thrust(part));
        let eigenvalue = found.report.smallest_eigenvalue.expect("asked for");
        assert!((eigenvalue - (1.0 - part)).abs() < SLENDER * part, "{part} of Euler's load: {eigenvalue}");
        assert_eq!(found.report.stable, Some(false));
        assert_eq!(stability_check(&found), Some((eigenvalue, false)));
    }
}

/// Also where the eigenvalue is not asked for, nothing unstable may be called stable.
#[test]
fn conjugate_points_alone_find_the_same_answer() {
    for part in BELOW.into_iter().chain(JUST_ABOVE) {
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let settings = Settings { tolerance, eigenvalue: false, ..shooting() };
            let found = solve(&thrust(part), &settings).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(found.report.stable, Some(part < 1.0), "{part} of Euler's load, {tolerance:e}");
        }
    }
}

#[test]
fn an_unstable_answer_says_from_which_load_on() {
    for part in JUST_ABOVE {
        let report = solved(&thrust(part)).report;
        let from = report.unstable_from.unwrap_or_else(|| panic!("{part} of Euler's load: {report:?}"));
        assert!((from * part - 1.0).abs() < LOAD_STEP * part, "unstable from {from} of {part}");
    }
}

#[test]
fn loads_without_an_energy_are_never_called_stable() {
    let zero = Vector3::zeros();
    let mut spread = column();
    spread.loads.push(Load {
        name: None,
        kind: LoadKind::Distributed {
            from: 0.2,
            to: 1.0,
            force_per_length: zero,
            moment_per_length: Vector3::new(0.3, 0.0, 0.1),
            frame: Frame::World,
        },
    });
    let small = [
        at_tip(zero, Vector3::new(0.5, 0.0, 0.2), Frame::World),
        at_tip(zero, Vector3::new(0.5, 0.0, 0.2), Frame::Body),
        at_tip(-0.5 * Vector3::z(), zero, Frame::Body),
        at_tip(Vector3::new(0.3, 0.2, -0.5), zero, Frame::Body),
        spread,
    ];
    for (i, robot) in small.iter().enumerate() {
        let found = solved(robot);
        assert_eq!(found.report.stable, None, "load {i}");
        assert_eq!(stability_check(&found), None, "load {i}");
    }
    // Beck's column: no buckling, flutter at 20.05 EI/L^2, which statics does not see
    for thrust in [15.0, 25.0] {
        let beck = solved(&at_tip(-thrust * Vector3::z(), zero, Frame::Body));
        assert_ne!(beck.report.stable, Some(true), "{thrust}");
    }
    // Greenhill's shaft: a twisting moment of fixed direction
    for moment in [1.0, 4.0] {
        let shaft = solved(&at_tip(zero, moment * Vector3::z(), Frame::World));
        assert_ne!(shaft.report.stable, Some(true), "{moment}");
    }
}

/// This file is about the shooting method.
fn shooting() -> Settings {
    Settings { method: hydrostat::solution::Method::Shooting, ..Settings::default() }
}
