//! Time per call of tendon robots on one thread: `cargo bench --bench scr`. All to 1e-6 of the length.

use divan::{Bencher, black_box};
use hydrostat::description::parse_robot;
use hydrostat::model::{Command, Frame, Load, LoadKind, Routing};
use hydrostat::statics::{Settings, Workspace, solve_in, solve_near};
use hydrostat::{Equilibrium, Robot};
use nalgebra::Vector3;

fn main() {
    divan::main();
}

fn settings() -> Settings {
    Settings { tolerance: 1e-6, stations: 0, eigenvalue: false, ..Settings::default() }
}

/// The shipped robot with a force at its tip and all three tendons pulled.
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

fn cold(bencher: Bencher, robot: &Robot) {
    let (settings, mut workspace) = (settings(), Workspace::default());
    bencher.bench_local(|| solve_in(black_box(robot), &settings, &mut workspace).expect("has an answer"));
}

/// Every tension 1 % away from the last solution.
fn warm(bencher: Bencher, robot: &Robot) {
    let (settings, mut workspace) = (settings(), Workspace::default());
    let mut robots = [robot.clone(), robot.clone()];
    pull(&mut robots[1], [5.05, 2.02, 1.01]);
    let mut solve = |robot: &Robot| -> Equilibrium {
        solve_near(black_box(robot), &settings, &mut workspace).expect("has an answer")
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
fn cold_guides(bencher: Bencher) {
    cold(bencher, &scr(Routing::Guides));
}

#[divan::bench]
fn warm_guides(bencher: Bencher) {
    warm(bencher, &scr(Routing::Guides));
}
