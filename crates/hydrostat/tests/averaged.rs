//! Robots with guides by way of averaged gaps, theory (67) to (70), against solutions in the gaps alone to 1e-10.

use hydrostat::description::parse_robot;
use hydrostat::model::{Command, Frame, Load, LoadKind, Motion, Routing};
use hydrostat::statics::{Input, Settings, Workspace, derivatives, solve, solve_in, solve_near};
use hydrostat::validate::robustness;
use hydrostat::{Equilibrium, Robot};
use nalgebra::Vector3;

const SCR: &str = include_str!("../../../robots/scr.toml");
const RAO: &str = include_str!("../../../robots/rao2021.toml");

fn to(tolerance: f64) -> Settings {
    Settings { tolerance, stations: 21, eigenvalue: false, ..Settings::default() }
}

/// As a control loop asks.
fn to_tip(tolerance: f64) -> Settings {
    Settings { stations: 0, ..to(tolerance) }
}

/// In the gaps alone: all the load at once is what averaging begins with.
fn in_gaps(tolerance: f64) -> Settings {
    Settings { largest_load_step: 0.999, ..to(tolerance) }
}

fn read(text: &str) -> Robot {
    parse_robot(text, "test.toml").expect("is valid").value
}

fn pull(robot: &mut Robot, tensions: &[f64]) {
    for (command, tension) in robot.actuation.iter_mut().zip(tensions) {
        *command = Command::Tension { tension: *tension, motion: Motion::Pulled };
    }
}

fn more(robot: &mut Robot, times: f64) {
    for command in &mut robot.actuation {
        match command {
            Command::Tension { tension, .. } => *tension *= times,
            Command::Displacement { displacement, .. } => *displacement *= times,
        }
    }
}

fn push_tip(robot: &mut Robot, force: Vector3<f64>, moment: Vector3<f64>) {
    let kind = LoadKind::Point { at: robot.length(), force, moment, frame: Frame::World };
    robot.loads.push(Load { name: None, kind });
}

/// SCR between so many guides, their mass in all the same.
fn scr(guides: usize) -> Robot {
    let mut robot = read(SCR);
    let section = &mut robot.sections[0];
    let of = section.guides.as_mut().expect("has guides");
    of.mass *= of.positions.len() as f64 / guides as f64;
    of.positions = (1..=guides).map(|k| section.length * k as f64 / guides as f64).collect();
    robot
}

/// Largest distance of tips and stations, over the length.
fn off(found: &Equilibrium, exact: &Equilibrium, robot: &Robot) -> f64 {
    let stations = found.stations.iter().zip(&exact.stations).map(|(a, b)| (a.position - b.position).norm());
    stations.fold((found.tip.position - exact.tip.position).norm(), f64::max) / robot.length()
}

fn estimate(found: &Equilibrium, robot: &Robot) -> f64 {
    found.report.error_estimate / robot.length()
}

/// A solution is off by no more than it says, and that is no more than was asked.
fn check(what: &str, robot: &Robot, exact: &Equilibrium, asked: &Settings) {
    let found = solve(robot, asked).expect("has an answer");
    let (far, says, tolerance) = (off(&found, exact, robot), estimate(&found, robot), asked.tolerance);
    assert!(far <= says && says <= tolerance, "{what}, {tolerance:e}: off by {far:.1e}, says {says:.1e}");
}

/// A random robot with its guides spread evenly, so that it may be averaged; None where a section has no guides.
fn even(index: usize) -> Option<Robot> {
    let mut robot = robustness::tendon_robot(17, index);
    for section in &mut robot.sections {
        section.profile.tip = section.profile.base;
        let positions = &mut section.guides.as_mut()?.positions;
        let count = positions.len();
        *positions = (1..=count).map(|k| section.length * k as f64 / count as f64).collect();
    }
    for tendon in &mut robot.tendons {
        (tendon.routing, tendon.friction) = (Routing::Guides, 0.0);
    }
    let tip = robot.length();
    for load in &mut robot.loads {
        match &mut load.kind {
            LoadKind::Point { at, moment, frame, .. } => {
                (*at, *moment, *frame) = (tip, Vector3::zeros(), Frame::World);
            }
            LoadKind::Mass { at, .. } => *at = tip,
            LoadKind::Distributed { from, to, moment_per_length, frame, .. } => {
                (*from, *to, *moment_per_length, *frame) = (0.0, tip, Vector3::zeros(), Frame::World);
            }
        }
    }
    robot.check().ok()?;
    Some(robot)
}

/// Cold none is off by more than the tolerance; under other commands one in a hundred may be off by more than it says, where that is more
/// than a tenth of the tolerance.
#[test]
fn random_robots_are_as_accurate_as_asked() {
    for tolerance in [1e-4, 1e-6, 1e-7] {
        let (mut count, mut averaged, mut warm, mut beyond) = (0, 0, 0, 0);
        for index in 0..60 {
            let Some(mut robot) = even(index) else { continue };
            let Ok(exact) = solve(&robot, &to(1e-10)) else { continue };
            let found = solve(&robot, &to(tolerance)).expect("has an answer");
            let far = off(&found, &exact, &robot);
            assert!(far <= tolerance, "{tolerance:e}: robot {index} is off by {far:.1e}");
            let alone = solve(&robot, &in_gaps(tolerance)).expect("has an answer");
            (count, averaged) = (count + 1, averaged + usize::from(alone.tip.position != found.tip.position));
            let mut workspace = Workspace::default();
            solve_near(&robot, &to_tip(tolerance), &mut workspace).expect("has an answer");
            for times in [1.01, 1.03, 0.9] {
                more(&mut robot, times);
                let found = solve_near(&robot, &to_tip(tolerance), &mut workspace);
                let (Ok(found), Ok(exact)) = (found, solve(&robot, &to_tip(1e-10))) else { continue };
                let far = off(&found, &exact, &robot);
                warm += 1;
                beyond += usize::from(far > estimate(&found, &robot).max(0.1 * tolerance));
                assert!(far <= 3.0 * tolerance, "{tolerance:e}: robot {index} x {times} is off by {far:.1e}");
            }
        }
        assert!(3 * averaged > 2 * count, "{tolerance:e}: {averaged} of {count} averaged");
        assert!(100 * beyond <= warm, "{tolerance:e}: {beyond} of {warm} off by more than they say");
    }
}

/// Tensions that nearly buckle the backbone between its guides.
#[test]
fn softened_gaps_are_as_accurate_as_they_say() {
    for (guides, force) in [(10, [0.0; 3]), (20, [0.1, 0.05, -0.1]), (30, [0.0; 3]), (30, [0.1, 0.05, -0.1])]
    {
        for softening in [1.0, 2.5, 5.8] {
            let mut robot = scr(guides);
            let (stiffness, length) = (robot.sections[0].stiffness(0.0).1.x, robot.length());
            let sum = softening * stiffness * (guides as f64 / length).powi(2);
            let pulls = (0.5 * stiffness / length / robot.tendons[0].path.radius).min(0.4 * sum);
            let rest = (sum - pulls) / 3.0;
            pull(&mut robot, &[rest + pulls, rest, rest]);
            push_tip(&mut robot, force.into(), Vector3::zeros());
            let exact = solve(&robot, &to(1e-10)).expect("has an answer");
            let what = format!("{guides} guides, {softening}");
            for tolerance in [1e-3, 1e-4, 1e-5, 1e-6] {
                let ways = [to(tolerance), to_tip(tolerance), in_gaps(tolerance)];
                ways.iter().for_each(|way| check(&what, &robot, &exact, way));
            }
        }
    }
}

/// One that bends there and back ends as it began, and yet has bent.
#[test]
fn an_s_is_as_accurate_as_it_says() {
    for guides in [6, 12, 30] {
        for together in [0.0, 2.0] {
            let mut robot = scr(guides);
            robot.gravity = Vector3::zeros();
            let (stiffness, length) = (robot.sections[0].stiffness(0.0).1.x, robot.length());
            let radius = robot.tendons[0].path.radius;
            pull(&mut robot, &[0.5 * stiffness / length / radius + together, together, together]);
            let bent = solve(&robot, &to_tip(1e-9)).expect("has an answer");
            let away = bent.tip.position - robot.base.position;
            let tangent = robot.base.rotation * Vector3::z();
            let side = (away - away.dot(&tangent) * tangent).normalize();
            // the force that turns the tip back
            let pushed = |force: f64| {
                let mut robot = robot.clone();
                push_tip(&mut robot, -force * side, Vector3::zeros());
                robot
            };
            let (mut less, mut most) = (0.0, 2.0 * stiffness / (length * length));
            for _ in 0..25 {
                let force = 0.5 * (less + most);
                let shape = solve(&pushed(force), &to_tip(1e-8)).expect("has an answer");
                let still = (shape.tip.rotation * Vector3::z()).dot(&side) > 0.0;
                (less, most) = if still { (force, most) } else { (less, force) };
            }
            let robot = pushed(less);
            let exact = solve(&robot, &to(1e-10)).expect("has an answer");
            let what = format!("{guides} guides");
            for tolerance in [1e-4, 1e-6, 1e-7] {
                [to(tolerance), to_tip(tolerance)].iter().for_each(|way| check(&what, &robot, &exact, way));
            }
        }
    }
}

/// Loads that buckle the robot leave two shapes to bend to: the one that small steps lead to is found.
#[test]
fn a_robot_beyond_buckling_is_not_loaded_at_once() {
    let mut robot = read(RAO);
    for section in &mut robot.sections {
        section.guides.as_mut().expect("has guides").mass *= 2.0;
    }
    pull(&mut robot, &[1.2e-3, 0.0, 1.8e-3, 1e-4, 6e-4, 1.7e-3]);
    push_tip(&mut robot, Vector3::new(0.14, 0.088, -0.222), Vector3::new(-7e-5, -0.0163, -0.0047));
    let small = Settings { largest_load_step: 0.05, ..to(1e-9) };
    let exact = solve(&robot, &small).expect("has an answer");
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let found = solve(&robot, &to(tolerance)).expect("has an answer");
        let far = off(&found, &exact, &robot);
        assert!(far <= tolerance, "{tolerance:e}: off by {far:.1e}");
    }
}

/// A straight robot shows nothing of how its tensions soften it: its stability and derivatives do.
#[test]
fn a_straight_robot_softens_at_any_tolerance() {
    let mut robot = read(SCR);
    for (tension, stable) in [(20.0, true), (100.0, true), (300.0, true), (320.0, false)] {
        pull(&mut robot, &[tension; 3]);
        let [exact, found] = [1e-10, 1e-6].map(|tolerance| {
            let mut workspace = Workspace::default();
            let settings = Settings { eigenvalue: true, ..to(tolerance) };
            let found = solve_in(&robot, &settings, &mut workspace).expect("has an answer");
            assert_eq!(found.report.stable, Some(stable), "{tension} N, {tolerance:e}");
            let compliance = derivatives(&robot, &mut workspace, &[robot.length()], &Input::tip_wrench());
            (found.report.smallest_eigenvalue.expect("is asked for"), compliance.expect("is regular"))
        });
        assert!((exact.0 - found.0).abs() < 1e-3, "{tension} N: eigenvalues {} {}", exact.0, found.0);
        let [exact, found] = [exact, found].map(|(_, compliance)| compliance[0].poses[0].position.norm());
        assert!((exact / found - 1.0).abs() < 5e-3, "{tension} N: compliances {exact} {found}");
    }
}

/// Steps with factors of elsewhere that happen to cancel are not the end of the way.
#[test]
fn balanced_tensions_in_turn_are_as_accurate_as_they_say() {
    let mut robot = read(SCR);
    let mut workspace = Workspace::default();
    for tensions in [[164.986, 166.498, 165.269], [160.681, 161.698, 161.881], [180.9, 182.96, 181.218]] {
        pull(&mut robot, &tensions);
        let found = solve_near(&robot, &to_tip(1e-6), &mut workspace).expect("has an answer");
        let exact = solve(&robot, &to_tip(1e-10)).expect("has an answer");
        let (far, says) = (off(&found, &exact, &robot), estimate(&found, &robot));
        assert!(far <= says && says <= 1e-6, "{tensions:?}: off by {far:.1e}, says {says:.1e}");
    }
}
