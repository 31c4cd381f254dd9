//! Time per call of tendon robots on one thread: `cargo bench -p hydrostat --bench scr`.

mod cases;

use cases::{by_displacement, differentiate, guides, judging, more, rao, scr, sections, settings};
use divan::{Bencher, black_box};
use hydrostat::model::Routing;
use hydrostat::statics::{Settings, Workspace, solve_in, solve_near};
use hydrostat::{Equilibrium, Robot};

fn main() {
    divan::main();
}

fn cold(bencher: Bencher, robot: &Robot) {
    let (settings, mut workspace) = (judging(), Workspace::default());
    bencher.bench_local(|| solve_in(black_box(robot), &settings, &mut workspace).expect("has an answer"));
}

/// From the last solution, every command 1 % away from it.
fn warm(bencher: Bencher, robot: &Robot) {
    warm_then(bencher, robot, &settings(), |_, _| {});
}

fn warm_then(bencher: Bencher, robot: &Robot, settings: &Settings, then: impl Fn(&Robot, &mut Workspace)) {
    let mut workspace = Workspace::default();
    let mut robots = [robot.clone(), more(robot)];
    let mut solve = |robot: &Robot| -> Equilibrium {
        let shape = solve_near(black_box(robot), settings, &mut workspace).expect("has an answer");
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
fn warm_channel_judged(bencher: Bencher) {
    warm_then(bencher, &scr(Routing::Channel), &judging(), |_, _| {});
}

#[divan::bench]
fn warm_channel_by_displacement(bencher: Bencher) {
    warm(bencher, &by_displacement(scr(Routing::Channel)));
}

#[divan::bench]
fn cold_channel_by_displacement(bencher: Bencher) {
    cold(bencher, &by_displacement(scr(Routing::Channel)));
}

#[divan::bench]
fn cold_channel_with_jacobian_and_compliance(bencher: Bencher) {
    let (robot, settings, mut workspace) = (scr(Routing::Channel), judging(), Workspace::default());
    bencher.bench_local(|| {
        let shape = solve_in(black_box(&robot), &settings, &mut workspace).expect("has an answer");
        differentiate(&robot, &mut workspace);
        shape
    });
}

#[divan::bench]
fn warm_channel_with_jacobian_and_compliance(bencher: Bencher) {
    warm_then(bencher, &scr(Routing::Channel), &settings(), differentiate);
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
