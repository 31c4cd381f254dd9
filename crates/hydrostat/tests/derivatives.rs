//! Derivatives from the factors of the Hessian against central differences of solves.

use hydrostat::description::{parse_commands, parse_robot};
use hydrostat::model::{Command, CrossSection, Frame, Load, LoadKind};
use hydrostat::solution::{Derivative, Method, PoseDerivative, TendonDerivative};
use hydrostat::statics::{Input, Settings, Workspace, derivatives, solve_in, solve_near};
use hydrostat::{Equilibrium, Robot};
use nalgebra::{Rotation3, Vector3};

const SCR: &str = include_str!("../../../robots/scr.toml");
const TWO_SECTIONS: &str = include_str!("../../../robots/scr_two_section.toml");
const TILL: &str = include_str!("../../../robots/till2019.toml");
const HELICAL: &str = include_str!("../../../robots/rucker2011_helical.toml");

/// Of the length; leaves 1e-11 / 1e-3 of a difference over a step of 1e-3.
const TOLERANCE: f64 = 1e-11;
/// Step of the differences as a part of what is changed: leaves 1e-6 of the curvature.
const STEP: f64 = 1e-3;
/// Of the largest derivative of the same kind.
const CLOSE: f64 = 3e-6;
/// Of parameters, whose powers curve more: at a fixed shape, and between solves.
const PARAMETER_STEP: f64 = 2e-5;
const SOLVED_STEP: f64 = 2e-4;
/// What bows that are held leave out of a derivative.
const HELD: f64 = 5e-5;
/// Two derivatives from one set of factors.
const ROUNDING: f64 = 1e-9;

fn read(text: &str) -> Robot {
    parse_robot(text, "test.toml").expect("is valid").value
}

fn commanded(text: &str, tensions: &str, displacements: &str) -> Robot {
    let mut robot = read(text);
    let list = |text: &str| if text.is_empty() { vec![] } else { vec![text.to_owned()] };
    parse_commands(&mut robot, &mut Vec::new(), &list(tensions), &list(displacements), &[])
        .expect("commands");
    robot
}

fn solved(robot: &Robot) -> (Equilibrium, Workspace) {
    let mut workspace = Workspace::default();
    let settings = Settings { tolerance: TOLERANCE, eigenvalue: false, ..Settings::default() };
    let shape =
        solve_in(robot, &settings, &mut workspace).unwrap_or_else(|error| panic!("{}: {error}", robot.name));
    (shape, workspace)
}

/// Two places inside, away from where a strain jumps, and the tip.
fn places(robot: &Robot) -> Vec<f64> {
    let length = robot.length();
    vec![0.31 * length, 0.777 * length, length]
}

/// Two points between guides with bows, which are held in derivatives, against more points without: guides that are not evenly spread are
/// solved in the gaps.
#[test]
fn derivatives_with_bows_are_as_accurate_as_the_shape() {
    let mut robot = commanded(SCR, "a=5N,b=2N,c=1N", "");
    let positions = &mut robot.sections[0].guides.as_mut().expect("has guides").positions;
    let last = positions.len() - 1;
    positions[..last].iter_mut().enumerate().for_each(|(k, at)| *at += 1e-3 * ((k % 3) as f64 - 1.0));
    let inputs = [Input::commands(&robot), Input::tip_wrench().to_vec()].concat();
    for coarse in [1e-4, 1e-5, 1e-6] {
        let [with, without] = [coarse, TOLERANCE].map(|tolerance| {
            let mut workspace = Workspace::default();
            let settings = Settings { tolerance, eigenvalue: false, ..Settings::default() };
            solve_in(&robot, &settings, &mut workspace).expect("has an answer");
            derivatives(&robot, &mut workspace, &[robot.length()], &inputs).expect("is regular")
        });
        for (with, without) in with.iter().zip(&without) {
            let (a, b) = (with.poses[0].position, without.poses[0].position);
            assert!((a - b).norm() < HELD * b.norm(), "{coarse:e}: {a} {b}");
        }
    }
}

/// Factors of the solve that serve again, and those that must not: of a shape further away, or of other tensions at the same shape.
#[test]
fn factors_at_hand_serve_where_they_are_of_the_solution() {
    let pulled = |[a, b]: [f64; 2]| commanded(TILL, &format!("a={a}N,b={b}N,c=1N,d=0N"), "");
    // the second solve has another mesh than the first, the third begins with the factors of the second
    let ways = [
        ("cold", vec![pulled([3.0, 1.0])]),
        ("held", vec![commanded(TILL, "a=1N,c=0N,d=0N", "b=2mm")]),
        ("on by little", vec![pulled([3.0, 1.0]), pulled([3.0, 1.001]), pulled([3.0, 1.002])]),
        ("on by more", vec![pulled([3.0, 1.0]), pulled([3.0, 1.001]), pulled([3.2, 1.3])]),
    ];
    for (what, way) in ways {
        let last = way.last().expect("is not empty");
        let inputs = [Input::commands(last), Input::tip_wrench().to_vec()].concat();
        let [rough, fine] = [1e-6, TOLERANCE].map(|tolerance| {
            let mut workspace = Workspace::default();
            let settings = Settings {
                tolerance,
                eigenvalue: false,
                stability: false,
                stations: 0,
                ..Settings::default()
            };
            for robot in &way {
                solve_near(robot, &settings, &mut workspace).expect("has an answer");
            }
            derivatives(last, &mut workspace, &[last.length()], &inputs).expect("is regular")
        });
        for (rough, fine) in rough.iter().zip(&fine) {
            let (a, b) = (rough.poses[0].position, fine.poses[0].position);
            assert!((a - b).norm() < HELD * b.norm(), "{what}: {a} {b}");
        }
    }
}

/// Difference of two solves over the change between them.
fn by_difference(behind: &Robot, ahead: &Robot, at: &Robot, change: f64) -> Derivative {
    let ((a, of_a), (b, of_b)) = (solved(behind), solved(ahead));
    let pose = |s: &f64| {
        // the tip stays the tip
        let end = |robot: &Robot| if *s == at.length() { robot.length() } else { *s };
        let a = of_a.station(behind, end(behind)).expect("is on the backbone");
        let b = of_b.station(ahead, end(ahead)).expect("is on the backbone");
        let turn = b.rotation * a.rotation.transpose();
        // sin(angle) x axis, where nalgebra's logarithm has lost the digits of a small angle
        let turn = 0.5 * Vector3::new(turn.m32 - turn.m23, turn.m13 - turn.m31, turn.m21 - turn.m12);
        PoseDerivative { position: (b.position - a.position) / change, rotation: turn / change }
    };
    let tendons = a.tendons.iter().zip(&b.tendons).map(|(a, b)| TendonDerivative {
        tension: (b.tension - a.tension) / change,
        displacement: (b.displacement - a.displacement) / change,
        length: (b.length - a.length) / change,
    });
    Derivative { poses: places(at).iter().map(pose).collect(), tendons: tendons.collect() }
}

/// Every entry is close to the difference, measured by the largest of its kind; `change` is what the solves differ by.
fn compare(what: &str, found: &Derivative, expected: &Derivative, change: f64) {
    let of_poses = |d: &Derivative, of: fn(&PoseDerivative) -> Vector3<f64>| -> Vec<f64> {
        d.poses.iter().flat_map(|pose| <[f64; 3]>::from(of(pose))).collect()
    };
    let kinds = |d: &Derivative| {
        let position = of_poses(d, |pose| pose.position);
        let rotation = of_poses(d, |pose| pose.rotation);
        let tension = d.tendons.iter().map(|tendon| tendon.tension).collect();
        let length = d.tendons.iter().flat_map(|tendon| [tendon.length, tendon.displacement]).collect();
        [("position", position), ("rotation", rotation), ("tension", tension), ("length", length)]
    };
    for ((kind, found), (_, expected)) in kinds(found).iter().zip(&kinds(expected)) {
        let largest = expected.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        for (i, (f, e)) in found.iter().zip(expected).enumerate() {
            let close = (f - e).abs() <= CLOSE * largest + TOLERANCE / change;
            assert!(close, "{what}, {kind} {i}: {f:e}, by difference {e:e}, of {largest:e}");
        }
    }
}

fn with_friction(text: &str) -> String {
    text.replace("[[tendon]]", "[[tendon]]\nfriction = 0.15")
}

/// With loads that follow the shape, at a point and along the backbone; for 300 mm in the middle between guides every 10 mm.
fn with_followers(mut robot: Robot, force: f64) -> Robot {
    let length = robot.length();
    let (force, moment) =
        (force * Vector3::new(1.0, -0.6, -0.4), force * length * Vector3::new(0.1, 0.2, 0.3));
    let point = LoadKind::Point { at: 185.0 / 300.0 * length, force, moment, frame: Frame::Body };
    let distributed = LoadKind::Distributed {
        from: 0.25 * length,
        to: 275.0 / 300.0 * length,
        force_per_length: force.yzx() / length,
        moment_per_length: moment.zxy() / length,
        frame: Frame::Body,
    };
    robot.loads.extend([point, distributed].map(|kind| Load { name: None, kind }));
    robot
}

fn robots() -> Vec<Robot> {
    let stretching = TWO_SECTIONS.replace("breaking_load", "stiffness = \"3 kN\"\nbreaking_load");
    vec![
        read(SCR),
        commanded(TILL, "a=3N,c=15N,b=0N", ""),
        read(HELICAL),
        // taut by displacement in both sections, one by tension, the others slack
        commanded(&stretching, "a=6N", "b=0mm,c=-3mm,d=2mm,e=4mm,f=-9mm"),
        commanded(HELICAL, "straight2=1N", "helix=2mm,straight1=1mm"),
        with_followers(commanded(TILL, "a=3N,c=15N,b=0N", ""), 0.3),
        with_followers(commanded(&stretching, "a=6N", "b=0mm,c=-3mm,d=2mm,e=4mm,f=-9mm"), 0.1),
        commanded(&with_friction(TILL), "a=3N,b=4N,c=15N", ""),
        commanded(&with_friction(&stretching), "a=6N", "b=0mm,c=-3mm,d=2mm,e=4mm,f=-9mm"),
    ]
}

#[test]
fn commands() {
    for robot in robots() {
        let (shape, mut workspace) = solved(&robot);
        let found = derivatives(&robot, &mut workspace, &places(&robot), &Input::commands(&robot))
            .expect("derivatives");
        for (tendon, found) in found.iter().enumerate() {
            let mut sides = [robot.clone(), robot.clone()];
            let mut change = 0.0;
            for (side, sign) in sides.iter_mut().zip([-1.0, 1.0]) {
                match &mut side.actuation[tendon] {
                    Command::Tension { tension, .. } => {
                        change = STEP * tension.max(1.0);
                        *tension += sign * change;
                        // a tendon that does not pull can only pull more: one side
                        *tension = tension.max(0.0);
                    }
                    Command::Displacement { displacement, .. } => {
                        change = STEP * 1e-3;
                        *displacement += sign * change;
                    }
                }
            }
            if matches!(robot.actuation[tendon], Command::Tension { tension, .. } if tension == 0.0) {
                continue;
            }
            let expected = by_difference(&sides[0], &sides[1], &robot, 2.0 * change);
            let state = &shape.tendons[tendon];
            if state.slack {
                assert!(
                    found.poses.iter().all(|pose| pose.position == Vector3::zeros()),
                    "slack moves nothing"
                );
            }
            compare(
                &format!("{}, {} (slack {})", robot.name, state.name, state.slack),
                found,
                &expected,
                2.0 * change,
            );
        }
    }
}

#[test]
fn tip_wrench() {
    let mut turned = commanded(HELICAL, "straight2=1N", "");
    let moment = Vector3::new(4e-3, -2e-3, 3e-3);
    let kind = LoadKind::Point {
        at: turned.length(),
        force: Vector3::new(0.02, 0.03, 0.01),
        moment,
        frame: Frame::World,
    };
    turned.loads.push(Load { name: None, kind });
    for robot in robots().into_iter().chain([turned]) {
        let (_, mut workspace) = solved(&robot);
        let inputs = Input::tip_wrench();
        let found = derivatives(&robot, &mut workspace, &places(&robot), &inputs).expect("derivatives");
        for (i, (found, input)) in found.iter().zip(&inputs).enumerate() {
            let Input::TipWrench { force, moment } = *input else { panic!("a wrench") };
            let change = STEP * if i < 3 { 0.1 } else { 0.01 };
            let sides = [-change, change].map(|size| {
                let mut side = robot.clone();
                let (force, moment) = (size * force, size * moment);
                let kind = LoadKind::Point { at: robot.length(), force, moment, frame: Frame::World };
                side.loads.push(Load { name: None, kind });
                side
            });
            let expected = by_difference(&sides[0], &sides[1], &robot, 2.0 * change);
            compare(&format!("{}, wrench {i}", robot.name), found, &expected, 2.0 * change);
        }
    }
}

/// A parameter by its effect: the robot with that part more of it, and what that part is of.
type Change = (&'static str, fn(&mut Robot, f64));

const PARAMETERS: [Change; 12] = [
    ("E and G", |robot, part| {
        for section in &mut robot.sections {
            section.material.youngs_modulus *= 1.0 + part;
            section.material.shear_modulus *= 1.0 + part;
        }
    }),
    ("G", |robot, part| robot.sections[0].material.shear_modulus *= 1.0 + part),
    ("diameter", |robot, part| {
        let CrossSection::Round { diameter } = robot.sections[0].profile.base else { panic!("is round") };
        let thicker = CrossSection::Round { diameter: diameter * (1.0 + part) };
        (robot.sections[0].profile.base, robot.sections[0].profile.tip) = (thicker, thicker);
    }),
    ("density", |robot, part| robot.sections[0].material.density *= 1.0 + part),
    ("length", |robot, part| {
        let section = &mut robot.sections[0];
        section.length *= 1.0 + part;
        if let Some(guides) = &mut section.guides {
            guides.positions.iter_mut().for_each(|position| *position *= 1.0 + part);
        }
    }),
    ("rest curvature", |robot, part| robot.sections[0].rest_curvature += part * Vector3::new(0.5, 0.3, -0.4)),
    ("hole radius", |robot, part| {
        robot.tendons[0].path.radius *= 1.0 + part;
        robot.tendons[0].path.tip_radius *= 1.0 + part;
    }),
    ("hole angle", |robot, part| robot.tendons[0].path.angle += part),
    ("base", |robot, part| {
        robot.base.position += part * Vector3::new(0.1, 0.2, -0.1);
        robot.base.rotation = Rotation3::new(part * Vector3::new(0.3, 0.5, -0.4)) * robot.base.rotation;
    }),
    ("stiffness of the tendons", |robot, part| {
        for tendon in &mut robot.tendons {
            tendon.stiffness = tendon.stiffness.map(|stiffness| stiffness * (1.0 + part));
        }
    }),
    ("friction", |robot, part| robot.tendons.iter_mut().for_each(|tendon| tendon.friction *= 1.0 + part)),
    ("force along the backbone", |robot, part| {
        robot.loads.push(Load {
            name: None,
            kind: LoadKind::Distributed {
                from: 0.0,
                to: robot.sections[0].length,
                force_per_length: part * Vector3::new(0.2, 0.1, 0.1),
                moment_per_length: Vector3::zeros(),
                frame: Frame::World,
            },
        });
    }),
];

#[test]
fn parameters() {
    for robot in robots() {
        let (_, mut workspace) = solved(&robot);
        for (name, change) in PARAMETERS {
            let beside = |part: f64| {
                let mut side = robot.clone();
                change(&mut side, part);
                side
            };
            let [behind, ahead] = [-PARAMETER_STEP, PARAMETER_STEP].map(beside);
            let input = Input::Parameter { behind: &behind, ahead: &ahead, step: PARAMETER_STEP };
            let found = derivatives(&robot, &mut workspace, &places(&robot), &[input]).expect("derivatives");
            let expected =
                by_difference(&beside(-SOLVED_STEP), &beside(SOLVED_STEP), &robot, 2.0 * SOLVED_STEP);
            compare(&format!("{}, {name}", robot.name), &found[0], &expected, 2.0 * SOLVED_STEP);
        }
    }
}

/// Betti: the tip moves along F by as much per tension as the tendon gives way per force, and so on.
#[test]
fn reciprocity() {
    let follows = |load: &Load| {
        matches!(
            load.kind,
            LoadKind::Point { frame: Frame::Body, .. } | LoadKind::Distributed { frame: Frame::Body, .. }
        )
    };
    let lossless = |robot: &Robot| {
        robot.tendons.iter().all(|tendon| tendon.friction == 0.0) && !robot.loads.iter().any(follows)
    };
    for robot in robots().into_iter().filter(lossless) {
        let (shape, mut workspace) = solved(&robot);
        let inputs: Vec<Input> = Input::tip_wrench().into_iter().chain(Input::commands(&robot)).collect();
        let found = derivatives(&robot, &mut workspace, &[robot.length()], &inputs).expect("derivatives");
        let (wrenches, commands) = found.split_at(6);
        let tip = |d: &Derivative, i: usize| {
            if i < 3 { d.poses[0].position[i] } else { d.poses[0].rotation[i - 3] }
        };
        for (i, a) in wrenches.iter().enumerate() {
            for (j, b) in wrenches.iter().enumerate() {
                let scale = (tip(a, i) * tip(b, j)).abs().sqrt();
                assert!(
                    (tip(a, j) - tip(b, i)).abs() < ROUNDING * scale,
                    "{}: compliance {i} {j}",
                    robot.name
                );
            }
        }
        let by_tension: Vec<usize> = (0..robot.tendons.len())
            .filter(|&i| matches!(robot.actuation[i], Command::Tension { .. }))
            .collect();
        for &tendon in &by_tension {
            for (i, wrench) in wrenches.iter().enumerate() {
                let (moves, gives) = (tip(&commands[tendon], i), -wrench.tendons[tendon].length);
                let scale = (tip(wrench, i) * commands[tendon].tendons[tendon].length).abs().sqrt();
                assert!((moves - gives).abs() < ROUNDING * scale, "{}: {tendon} and wrench {i}", robot.name);
            }
            for &other in &by_tension {
                let (a, b) = (commands[tendon].tendons[other].length, commands[other].tendons[tendon].length);
                let own = commands[tendon].tendons[tendon].length * commands[other].tendons[other].length;
                assert!((a - b).abs() < ROUNDING * own.abs().sqrt(), "{}: {tendon} and {other}", robot.name);
            }
        }
        // a force along which the displacement moves the tip slackens the tendon
        for (tendon, state) in shape.tendons.iter().enumerate().filter(|(i, _)| !by_tension.contains(i)) {
            for (i, wrench) in wrenches.iter().enumerate() {
                let (moves, tension) = (tip(&commands[tendon], i), -wrench.tendons[tendon].tension);
                let scale = (tip(wrench, i) * commands[tendon].tendons[tendon].tension).abs().sqrt();
                assert!(
                    (moves - tension).abs() <= ROUNDING * scale,
                    "{}: {} {moves} {tension}",
                    robot.name,
                    state.name
                );
            }
        }
    }
}

#[test]
fn the_solution_stays_as_it_was() {
    for robot in robots() {
        let (_, mut workspace) = solved(&robot);
        let place = 0.4 * robot.length();
        let station = |workspace: &Workspace| {
            let station = workspace.station(&robot, place).expect("is on the backbone");
            (station.position, station.force, station.moment)
        };
        let before = station(&workspace);
        let mut found =
            || derivatives(&robot, &mut workspace, &[place], &Input::commands(&robot)).expect("derivatives");
        assert_eq!(found(), found());
        assert_eq!(before, station(&workspace), "{}", robot.name);
    }
}

#[test]
fn refusals() {
    let robot = commanded(TILL, "a=3N", "");
    let refused = |workspace: &mut Workspace, at: f64, input: Input, words: &str| {
        let error = derivatives(&robot, workspace, &[at], &[input]).expect_err(words);
        assert!(error.to_string().contains(words), "{error}");
    };
    let first = Input::Command(0);
    refused(&mut Workspace::default(), 0.1, first, "the workspace has none");
    let (_, mut workspace) = solved(&robot);
    refused(&mut workspace, 0.6, first, "s = 0.6 m is not on the backbone of 0 to 0.5 m");
    refused(&mut workspace, 0.1, Input::Command(4), "the command of tendon 5 of 4");
    let no_step = Input::Parameter { behind: &robot, ahead: &robot, step: 0.0 };
    refused(&mut workspace, 0.1, no_step, "a parameter's step of 0");
    // a mass that moves along the backbone appears as a new breakpoint
    let mut hung = robot.clone();
    hung.loads.push(Load { name: None, kind: LoadKind::Mass { at: 0.2, mass: 0.1 } });
    let other = Input::Parameter { behind: &robot, ahead: &hung, step: 0.1 };
    refused(&mut workspace, 0.1, other, "has other breakpoints");
    let mut shot = Workspace::default();
    solve_in(&robot, &Settings { method: Method::Shooting, ..Settings::default() }, &mut shot)
        .expect("solves");
    refused(&mut shot, 0.1, first, "this was solved by shooting");
}
