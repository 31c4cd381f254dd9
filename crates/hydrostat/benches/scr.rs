//! Time per call of tendon robots on one thread: `cargo bench -p hydrostat --bench scr`. All to 1e-6 of the length.

use divan::{Bencher, black_box};
use hydrostat::description::parse_robot;
use hydrostat::model::{Command, Frame, Load, LoadKind, Routing};
use hydrostat::statics::{Input, Settings, Workspace, derivatives, solve_in, solve_near};
use hydrostat::{Equilibrium, Robot};
use nalgebra::Vector3;

fn main() {
    divan::main();
}

fn settings() -> Settings {
    Settings { tolerance: 1e-6, stations: 0, eigenvalue: false, ..Settings::default() }
}

/// SCR with a force at its tip and all three tendons pulled.
fn scr(routing: Routing) -> Robot {
    let mut robot =
        parse_robot(include_str!("../../../robots/scr.toml"), "scr.toml").expect("is valid").value;
    for tendon in &mut robot.tendons {
        tendon.routing = routing;
    }
    if routing == Routing::Channel {
        robot.sections[0].guides = None;
    }
    let force = Vector3::new(0.1, 0.05, -0.1);
    let kind = LoadKind::Point { at: robot.length(), force, moment: Vector3::zeros(), frame: Frame::World };
    robot.loads.push(Load { name: None, kind });
    pull(&mut robot, [5.0, 2.0, 1.0]);
    robot
}

fn pull(robot: &mut Robot, tensions: [f64; 3]) {
    for (command, tension) in robot.actuation.iter_mut().zip(tensions) {
        *command = Command::Tension { tension, motion: Default::default() };
    }
}

/// Every tension or displacement 1 % larger.
fn more(robot: &Robot) -> Robot {
    let mut robot = robot.clone();
    for command in &mut robot.actuation {
        match command {
            Command::Tension { tension, .. } => *tension *= 1.01,
            Command::Displacement { displacement, .. } => *displacement *= 1.01,
        }
    }
    robot
}

/// The same shape, its tendons held by what they are pulled in.
fn by_displacement(mut robot: Robot) -> Robot {
    let shape = solve_in(&robot, &settings(), &mut Workspace::default()).expect("has an answer");
    for (command, tendon) in robot.actuation.iter_mut().zip(&shape.tendons) {
        *command = Command::Displacement { displacement: tendon.displacement, motion: Default::default() };
    }
    robot
}

/// SCR cut into so many sections, three tendons to the tip.
fn sections(count: usize) -> Robot {
    let mut robot = scr(Routing::Channel);
    robot.sections[0].length /= count as f64;
    robot.sections = vec![robot.sections[0].clone(); count];
    robot.tendons.iter_mut().for_each(|tendon| tendon.ends = count - 1);
    robot
}

/// SCR with so many guides.
fn guides(count: usize) -> Robot {
    let mut robot = scr(Routing::Guides);
    let guides = robot.sections[0].guides.as_mut().expect("has guides");
    guides.mass *= 30.0 / count as f64;
    guides.positions = (1..=count).map(|k| 0.3 * k as f64 / count as f64).collect();
    robot
}

/// Two sections with ten guides each and six tendons.
fn rao() -> Robot {
    parse_robot(include_str!("../../../robots/rao2021.toml"), "rao2021.toml").expect("is valid").value
}

fn cold(bencher: Bencher, robot: &Robot) {
    let (settings, mut workspace) = (settings(), Workspace::default());
    bencher.bench_local(|| solve_in(black_box(robot), &settings, &mut workspace).expect("has an answer"));
}

/// From the last solution, every command 1 % away from it.
fn warm(bencher: Bencher, robot: &Robot) {
    warm_then(bencher, robot, |_, _| {});
}

fn warm_then(bencher: Bencher, robot: &Robot, then: impl Fn(&Robot, &mut Workspace)) {
    let (settings, mut workspace) = (settings(), Workspace::default());
    let mut robots = [robot.clone(), more(robot)];
    let mut solve = |robot: &Robot| -> Equilibrium {
        let shape = solve_near(black_box(robot), &settings, &mut workspace).expect("has an answer");
        then(robot, &mut workspace);
        shape
    };
    solve(&robots[1]);
    bencher.bench_local(|| {
        robots.swap(0, 1);
        solve(&robots[1])
    });
}

#[divan::bench]
fn cold_channel(bencher: Bencher) {
    cold(bencher, &scr(Routing::Channel));
}

#[divan::bench]
fn warm_channel(bencher: Bencher) {
    warm(bencher, &scr(Routing::Channel));
}

#[divan::bench]
fn warm_channel_by_displacement(bencher: Bencher) {
    warm(bencher, &by_displacement(scr(Routing::Channel)));
}

#[divan::bench]
fn warm_channel_with_jacobian_and_compliance(bencher: Bencher) {
    warm_then(bencher, &scr(Routing::Channel), |robot, workspace| {
        let inputs = [Input::commands(robot), Input::tip_wrench().to_vec()].concat();
        derivatives(robot, workspace, &[robot.length()], &inputs).expect("is regular");
    });
}

#[divan::bench]
fn cold_guides(bencher: Bencher) {
    cold(bencher, &scr(Routing::Guides));
}

#[divan::bench]
fn warm_guides(bencher: Bencher) {
    warm(bencher, &scr(Routing::Guides));
}

#[divan::bench]
fn warm_two_sections_six_tendons_twenty_guides(bencher: Bencher) {
    warm(bencher, &rao());
}

#[divan::bench(args = [1, 2, 4, 8, 16])]
fn warm_sections(bencher: Bencher, count: usize) {
    warm(bencher, &sections(count));
}

#[divan::bench(args = [10, 30, 100, 300])]
fn warm_number_of_guides(bencher: Bencher, count: usize) {
    warm(bencher, &guides(count));
}
