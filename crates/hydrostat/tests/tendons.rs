//! Tendon robots: closed forms, published figures, two methods, two ways of input.

use hydrostat::description::{parse_commands, parse_robot};
use hydrostat::model::{Command, Motion};
use hydrostat::solution::Method;
use hydrostat::statics::{Settings, Workspace, solve, solve_from, solve_in, solve_near};
use hydrostat::{Equilibrium, Robot};
use nalgebra::Vector3;

const METHODS: [Method; 2] = [Method::Energy, Method::Shooting];
/// Printed digits of the closed forms.
const DIGITS: f64 = 1e-9;
/// Two methods agree to this part of the length; each is asked for 1e-9.
const AGREEMENT: f64 = 1e-8;

fn by(method: Method) -> Settings {
    Settings { method, ..Settings::default() }
}

fn read(text: &str) -> Robot {
    parse_robot(text, "test.toml").expect("is valid").value
}

fn solved(robot: &Robot, method: Method) -> Equilibrium {
    solve(robot, &by(method)).unwrap_or_else(|error| panic!("{} {method:?}: {error}", robot.name))
}

/// 400 mm of 1.56 mm Nitinol with a straight tendon at 8 mm; what follows is added.
fn niti(more: &str) -> Robot {
    read(&format!(
        r#"
        name = "niti"
        gravity = "[0, 0, 0] m/s^2"
        [material.niti54]
        youngs_modulus = "54 GPa"
        poisson_ratio = 0.33
        density = "6.45 g/cm^3"
        [[section]]
        name = "rod"
        length = "400 mm"
        material = "niti54"
        profile = {{ diameter = "1.56 mm" }}
        {more}"#
    ))
}

const ONE: &str = r#"
    [[tendon]]
    name = "a"
    ends = "rod"
    radius = "8 mm"
    [actuation]
    tension = { a = "5 N" }"#;

/// Without loads the bend of the changed tension is the whole answer, however far: what is left for Newton's method is to see it.
#[test]
fn a_far_tension_is_near_without_loads() {
    let (mut robot, mut workspace) = (niti(ONE), Workspace::default());
    let settings = Settings { eigenvalue: false, ..by(Method::Energy) };
    solve_in(&robot, &settings, &mut workspace).expect("has an answer");
    for tension in [2.0, 4.5, 0.5] {
        robot.actuation[0] = Command::Tension { tension, motion: Motion::Pulled };
        let near = solve_near(&robot, &settings, &mut workspace).expect("has an answer");
        assert!(near.report.iterations <= 2, "{tension} N: {} iterations", near.report.iterations);
        let inertia = std::f64::consts::PI / 64.0 * 1.56e-3_f64.powi(4);
        let angle = tension * 8e-3 / (54e9 * inertia) * 0.4;
        let tip = near.tip.rotation.matrix();
        assert!((tip[(0, 2)] - angle.sin()).abs() < DIGITS, "{tension} N: {} {angle}", tip[(0, 2)]);
    }
}

/// E I kappa = tau r, v3 = 1 - tau / EA.
#[test]
fn straight_tendon_bends_an_arc() {
    for method in METHODS {
        let shape = solved(&niti(ONE), method);
        let area = std::f64::consts::PI / 4.0 * 1.56e-3_f64.powi(2);
        for station in &shape.stations {
            assert!((station.u.y - 2.547_991_291_7).abs() < 1e-9, "{method:?} {}", station.u);
            assert!((station.v.z - (1.0 - 5.0 / (54e9 * area))).abs() < 1e-12);
        }
        let tip = Vector3::new(0.186_784_981_559, 0.0, 0.334_242_104_764);
        assert!((shape.tip.position - tip).norm() < DIGITS, "{method:?} {}", shape.tip.position);
    }
}

/// Till, Aloi & Rucker's robot; figures computed outside this project.
#[test]
fn till_2019() {
    let mut robot = read(include_str!("../../../robots/till2019.toml"));
    for method in METHODS {
        robot.gravity = Vector3::new(9.81, 0.0, 0.0);
        parse_commands(&mut robot, &mut Vec::new(), &["a=15N,c=0N".into()], &[], &[]).expect("commands");
        let tip = solved(&robot, method).tip.position;
        // printed with seven digits
        assert!((tip - Vector3::new(0.182_211_7, 0.0, 0.453_229_3)).norm() < 2e-7, "{method:?} {tip}");
        robot.gravity = Vector3::zeros();
        let curvature = solved(&robot, method).stations[50].u.y;
        assert!((curvature - 1.438_124_065_8).abs() < 1e-9, "{curvature}");
    }
}

/// tip angle = ln(1 + mu r T0 L / EI) / mu.
#[test]
fn capstan_friction() {
    let stiffness = 54e9 * std::f64::consts::PI / 64.0 * 1.56e-3_f64.powi(4);
    let mut robot = niti(&ONE.replace("radius", "friction = 0.2\nradius"));
    let shape = solved(&robot, Method::Energy);
    let angle = (1.0 + 0.2 * 8e-3 * 5.0 * 0.4 / stiffness).ln() / 0.2;
    let tip = shape.tip.rotation.matrix();
    assert!((tip.m13.atan2(tip.m33) - angle).abs() < 1e-8);
    assert!((shape.tendons[0].tip_tension - 5.0 * (-0.2 * angle).exp()).abs() < 1e-7);
    assert_eq!(shape.report.stable, None, "friction has no energy");
    // a release leaves more tension at the tip, and bends more
    robot.actuation[0] = Command::Tension { tension: 5.0, motion: Motion::Released };
    let released = solved(&robot, Method::Energy);
    assert!(released.tendons[0].tip_tension > 5.0 && released.tip.position.x > shape.tip.position.x);
}

const SHIPPED: [&str; 7] = [
    include_str!("../../../robots/gray2009_rod.toml"),
    include_str!("../../../robots/scr.toml"),
    include_str!("../../../robots/scr_two_section.toml"),
    include_str!("../../../robots/till2019.toml"),
    include_str!("../../../robots/rucker2011_helical.toml"),
    include_str!("../../../robots/rao2021.toml"),
    include_str!("../../../robots/elephant_trunk.toml"),
];

#[test]
fn both_methods_agree_on_every_shipped_robot() {
    for text in SHIPPED {
        let robot = read(text);
        let [a, b] = METHODS.map(|method| solved(&robot, method));
        let length = robot.length();
        for (a, b) in a.stations.iter().zip(&b.stations) {
            let apart = (a.position - b.position).norm() / length;
            assert!(apart < AGREEMENT, "{} at s = {}: {apart:.1e}", robot.name, a.s);
        }
        for (a, b) in a.tendons.iter().zip(&b.tendons) {
            assert!((a.length - b.length).abs() < AGREEMENT * length, "{}", robot.name);
        }
        assert_eq!((a.report.stable, b.report.stable), (Some(true), Some(true)), "{}", robot.name);
    }
}

/// Displacements of a solution by tension, commanded, give its tensions and its shape again.
#[test]
fn displacement_and_tension_are_inverse() {
    let mut found_by_shooting = 0;
    for text in &SHIPPED[1..] {
        let mut robot = read(text);
        let pulled = solved(&robot, Method::Energy);
        for (command, tendon) in robot.actuation.iter_mut().zip(&pulled.tendons) {
            if tendon.tension > 0.0 {
                *command =
                    Command::Displacement { displacement: tendon.displacement, motion: Motion::Pulled };
            }
        }
        for method in METHODS {
            // shooting finds the tensions by differences, and says so where they are too coarse
            let held = match solve(&robot, &by(method)) {
                Ok(held) => held,
                Err(error) => {
                    assert!(method == Method::Shooting, "{}: {error}", robot.name);
                    continue;
                }
            };
            found_by_shooting += usize::from(method == Method::Shooting);
            let apart = (held.tip.position - pulled.tip.position).norm() / robot.length();
            assert!(apart < AGREEMENT, "{} {method:?} {apart:.1e}", robot.name);
            for (a, b) in held.tendons.iter().zip(&pulled.tendons) {
                assert!(
                    (a.tension - b.tension).abs() < 1e-5 * (1.0 + b.tension),
                    "{} {method:?}",
                    robot.name
                );
            }
        }
    }
    assert!(found_by_shooting >= 3, "{found_by_shooting}");
}

/// Holding the others at home lets the ones on the inside go slack, and none push.
#[test]
fn tendons_that_would_push_are_slack() {
    let mut robot = read(SHIPPED[1]);
    parse_commands(&mut robot, &mut Vec::new(), &[], &["a=5mm,b=0mm,c=0mm".into()], &[]).expect("commands");
    // the outer ones are paid out enough to hang
    parse_commands(&mut robot, &mut Vec::new(), &[], &["b=-10mm".into()], &[]).expect("commands");
    let tendons = solved(&robot, Method::Energy).tendons;
    assert!((tendons[0].displacement - 5e-3).abs() < 1e-9 && tendons[0].tension > 0.0);
    assert!(tendons[1].slack && tendons[1].tension == 0.0, "{tendons:?}");
    // hanging: shorter than what was paid out
    assert!(tendons[1].displacement > -10e-3);
    assert!(tendons.iter().all(|tendon| tendon.tension >= 0.0));
}

/// Rounding decides whether a tendon at 0 N pulls, where a solution's own displacements are its commands.
#[test]
fn a_solutions_own_displacements_fail_no_check() {
    let slack = |found: &Equilibrium| found.checks.iter().find(|check| check.name == "slack").cloned();
    for robot in SHIPPED.map(read).into_iter().filter(|robot| !robot.tendons.is_empty()) {
        let found = solved(&robot, Method::Energy);
        let mut held = robot.clone();
        for digits in [1e-18, 1e-6] {
            for (command, state) in held.actuation.iter_mut().zip(&found.tendons) {
                let displacement = (state.displacement / digits).round() * digits;
                *command = Command::Displacement { displacement, motion: Motion::Pulled };
            }
            let check = slack(&solved(&held, Method::Energy)).expect("tendons are held");
            assert!(check.ok, "{}, to {digits} m: {check:?}", robot.name);
        }
    }
    // a and c in one hole: c is too long by 2 mm
    let mut robot = read(SHIPPED[1]);
    robot.tendons[2].path = robot.tendons[0].path;
    parse_commands(&mut robot, &mut Vec::new(), &[], &["a=5mm,b=-5mm,c=3mm".into()], &[]).expect("commands");
    let check = slack(&solved(&robot, Method::Energy)).expect("tendons are held");
    assert_eq!((check.ok, check.tendons), (false, vec!["c".to_owned()]));
}

/// d l1 / d T2 = d l2 / d T1 (Maxwell), by central differences.
#[test]
fn lengths_and_tensions_are_reciprocal() {
    let robot = read(SHIPPED[4]);
    let lengths = |changes: [f64; 2]| {
        let mut robot = robot.clone();
        for (i, change) in [0, 4].into_iter().zip(changes) {
            let Command::Tension { tension, .. } = &mut robot.actuation[i] else { panic!("by tension") };
            *tension += change;
        }
        let tendons = solved(&robot, Method::Energy).tendons;
        [tendons[0].length, tendons[4].length]
    };
    let step = 1e-3;
    let first = (lengths([0.0, step])[0] - lengths([0.0, -step])[0]) / (2.0 * step);
    let second = (lengths([step, 0.0])[1] - lengths([-step, 0.0])[1]) / (2.0 * step);
    assert!((first - second).abs() < 1e-5 * first.abs(), "{first} {second}");
}

/// From shapes far away the energy leads to a stable equilibrium.
#[test]
fn any_start_leads_to_the_same_stable_shape() {
    let robot = read(SHIPPED[4]);
    let expected = solved(&robot, Method::Energy);
    for number in 0..5 {
        let mut other = robot.clone();
        let phase = f64::from(number);
        other.sections[0].rest_curvature = 10.0 * Vector3::new(phase.sin(), (3.1 * phase).cos(), 0.3);
        let start = solved(&other, Method::Energy).stations;
        let found = solve_from(&robot, &by(Method::Energy), &start).expect("finds a shape");
        assert_eq!(found.report.stable, Some(true));
        let apart = (found.tip.position - expected.tip.position).norm();
        assert!(apart < AGREEMENT * robot.length(), "start {number}: {apart:.1e}");
    }
}

/// Straight chords approach the channel as the guides get closer, with order 2.
#[test]
fn guides_converge_to_the_channel() {
    let tip = |more: &str, routing: &str| {
        let text = ONE.replace("radius", &format!("routing = \"{routing}\"\nradius"));
        let robot = niti(&format!("{more}\n{text}"));
        solved(&robot, Method::Energy).tip.position
    };
    let channel = tip("", "channel");
    let off = |spacing: &str| {
        (tip(&format!("guides = {{ spacing = \"{spacing} mm\" }}"), "guides") - channel).norm()
    };
    let order = (off("40") / off("20")).log2();
    assert!((order - 2.0).abs() < 0.2, "observed order {order}");
}

/// Tensions pulled in beyond the breaking load are refused, not answered.
#[test]
fn a_displacement_that_tears_the_tendon_is_an_error() {
    let mut robot = niti(&ONE.replace("radius", "breaking_load = \"10 N\"\nradius"));
    parse_commands(&mut robot, &mut Vec::new(), &[], &["a=40mm".into()], &[]).expect("commands");
    for method in METHODS {
        let error = solve(&robot, &by(method)).expect_err("tears");
        assert!(error.message().contains("tears"), "{error}");
    }
}

/// What shooting has found in the same memory is no start for the energy method.
#[test]
fn methods_that_share_a_workspace_do_not_mix() {
    let mut robot = read(SHIPPED[4]);
    let mut workspace = Workspace::default();
    solve_in(&robot, &by(Method::Energy), &mut workspace).expect("has an answer");
    robot.gravity = Vector3::new(3.0, -2.0, 5.0);
    solve_in(&robot, &by(Method::Shooting), &mut workspace).expect("has an answer");
    let near = solve_near(&robot, &by(Method::Energy), &mut workspace).expect("has an answer");
    let cold = solved(&robot, Method::Energy);
    let apart = (near.tip.position - cold.tip.position).norm();
    assert!(apart < AGREEMENT * robot.length(), "{apart:.1e}");
    assert_eq!(near.report.iterations, cold.report.iterations, "it starts from rest");
}
