//! Robots that no file describes but a program may build: refused, never solved as something else.

use hydrostat::description::{builtin, parse_robot};
use hydrostat::model::{Command, CrossSection, Frame, Load, LoadKind, Motion};
use hydrostat::statics::{Settings, Workspace, solve, solve_in};
use hydrostat::{Error, Robot};
use nalgebra::Vector3;

fn rod() -> Robot {
    builtin::robot().expect("the built-in rod is read").value
}

fn refused(change: impl FnOnce(&mut Robot), words: &str) {
    let mut robot = rod();
    change(&mut robot);
    let error = solve(&robot, &Settings::default()).expect_err(words);
    assert!(error.to_string().contains(words), "{error}");
}

fn mass_at(at: f64) -> Load {
    Load { name: None, kind: LoadKind::Mass { at, mass: 0.02 } }
}

/// A unit wrong by a million: said at once, where a mesh for so many turns would take gigabytes.
#[test]
fn tensions_that_would_wind_the_robot_up() {
    let text = include_str!("../../../robots/scr.toml");
    let mut robot = parse_robot(text, "scr.toml").expect("is valid").value;
    robot.actuation[2] = Command::Tension { tension: 1e6, motion: Motion::Pulled };
    let error = solve(&robot, &Settings::default()).expect_err("has no such shape").to_string();
    assert!(error.contains("would wind the robot up"), "{error}");
    // a spring of many coils is none of that
    let mut spring = rod();
    spring.sections[0].rest_curvature = Vector3::new(3000.0, 0.0, 0.0);
    spring.loads.clear();
    spring.gravity = Vector3::zeros();
    solve(&spring, &Settings { tolerance: 1e-4, ..Settings::default() }).expect("has its own shape");
}

#[test]
fn loads_off_the_backbone() {
    for at in [0.40, -0.1, f64::NAN] {
        refused(|robot| robot.loads.push(mass_at(at)), "is not on the backbone");
    }
    let (force_per_length, moment_per_length) = (Vector3::x(), Vector3::zeros());
    let kind = LoadKind::Distributed {
        from: 0.3,
        to: 0.2,
        force_per_length,
        moment_per_length,
        frame: Frame::World,
    };
    refused(|robot| robot.loads.push(Load { name: None, kind }), "it acts from");
}

#[test]
fn sections_without_mechanics() {
    refused(|robot| robot.sections.clear(), "no section");
    refused(|robot| robot.sections[0].length = 0.0, "the length is 0");
    refused(|robot| robot.sections[0].material.youngs_modulus = f64::NAN, "Young's modulus is NaN");
    refused(
        |robot| robot.sections[0].profile.tip = CrossSection::Round { diameter: 0.0 },
        "a stiffness is 0",
    );
    let strip = CrossSection::Strip { width: 1e-3, height: 1e-3 };
    refused(|robot| robot.sections[0].profile.tip = strip, "from one kind of profile to another");
    refused(|robot| robot.gravity.x = f64::INFINITY, "expected finite numbers");
    refused(|robot| robot.base.position.y = f64::NAN, "expected finite numbers");
}

#[test]
fn settings_that_ask_for_nothing() {
    let settings = Settings::default();
    for settings in [
        Settings { tolerance: f64::NAN, ..settings.clone() },
        Settings { largest_load_step: 0.0, ..settings.clone() },
        Settings { shooting_intervals: Some(0), ..settings.clone() },
        Settings { stations: 1, ..settings },
    ] {
        assert!(solve(&rod(), &settings).is_err(), "{settings:?}");
    }
}

#[test]
fn a_workspace_without_a_solution_has_no_stations() -> Result<(), Error> {
    let mut workspace = Workspace::default();
    assert!(workspace.station(&rod(), 0.1).is_none());
    solve_in(&rod(), &Settings::default(), &mut workspace)?;
    assert!(workspace.station(&rod(), 0.1).is_some() && workspace.station(&rod(), 5.0).is_none());
    let mut impossible = rod();
    impossible.loads.push(mass_at(5.0));
    assert!(solve_in(&impossible, &Settings::default(), &mut workspace).is_err());
    assert!(workspace.station(&rod(), 0.1).is_none());
    Ok(())
}

/// The largest strain lies inside a step, 13 % above that at the ends of the two steps that this shape takes.
#[test]
fn strain_is_found_between_the_ends() -> Result<(), Error> {
    let mut robot = rod();
    robot.gravity = Vector3::zeros();
    let length = robot.length();
    let ei = robot.sections[0].stiffness(0.0).1.x;
    let distributed = LoadKind::Distributed {
        from: 0.0,
        to: length,
        force_per_length: Vector3::new(0.0, 0.6 * ei / length.powi(3), 0.0),
        moment_per_length: Vector3::zeros(),
        frame: Frame::World,
    };
    let force = Vector3::new(0.0, -0.42 * ei / length.powi(2), 0.0);
    let tip = LoadKind::Point { at: length, force, moment: Vector3::zeros(), frame: Frame::World };
    robot.loads = [distributed, tip].map(|kind| Load { name: None, kind }).to_vec();
    let strain = |stations| -> Result<f64, Error> {
        Ok(solve(&robot, &Settings { stations, ..Settings::default() })?.checks[0].value)
    };
    let (few, many) = (strain(0)?, strain(2001)?);
    assert!((few / many - 1.0).abs() < 1e-2, "{few} against {many}");
    Ok(())
}
