//! Time per call on one thread: `cargo bench`. That the answers are as accurate as asked is shown by
//! `the_benchmarked_solves_are_as_accurate_as_they_claim` in tests/convergence.rs.

use divan::{Bencher, black_box};
use hydrostat::description::builtin;
use hydrostat::model::{CrossSection, Frame, Load, LoadKind};
use hydrostat::statics::{Settings, Weight, Workspace, constant_curvature, solve_in, solve_near};
use hydrostat::verify::verify;
use hydrostat::{Equilibrium, Robot};
use nalgebra::Vector3;

fn main() {
    divan::main();
}

/// The shape alone, to a part of the length; a text, which divan prints as it stands.
fn to(tolerance: &str) -> Settings {
    let tolerance = tolerance.parse().expect("a number");
    Settings { tolerance, stations: 0, eigenvalue: false, ..Settings::default() }
}

/// The thesis's rod with a mass hung at its tip, kg.
fn thesis_rod(mass: f64) -> Robot {
    let mut robot = builtin::robot().expect("the built-in robot is read").value;
    robot.loads.push(Load { name: None, kind: LoadKind::Mass { at: robot.length(), mass } });
    robot
}

/// The thesis's rod, its outer half thinner, with a force that follows the tip: six unknowns.
fn two_sections_with_follower() -> Robot {
    let mut robot = builtin::robot().expect("the built-in robot is read").value;
    robot.sections[0].length *= 0.5;
    let mut distal = robot.sections[0].clone();
    let thinner = CrossSection::Round { diameter: 1.2e-3 };
    (distal.profile.base, distal.profile.tip) = (thinner, thinner);
    robot.sections.push(distal);
    let kind = LoadKind::Point {
        at: robot.length(),
        force: Vector3::new(0.05, 0.1, 0.0),
        moment: Vector3::zeros(),
        frame: Frame::Body,
    };
    robot.loads.push(Load { name: None, kind });
    robot
}

fn solved(robot: &Robot, settings: &Settings, workspace: &mut Workspace) -> Equilibrium {
    solve_in(robot, settings, workspace).expect("the benchmark's rod has an answer")
}

/// From the unloaded shape, in memory used before.
fn cold(bencher: Bencher, robot: &Robot, tolerance: &str) {
    let (settings, mut workspace) = (to(tolerance), Workspace::default());
    bencher.bench_local(|| solved(black_box(robot), &settings, &mut workspace));
}

/// From the last solution, the mass 1 % away from it.
fn warm(bencher: Bencher, tolerance: &str) {
    let (settings, mut workspace) = (to(tolerance), Workspace::default());
    let mut rods = [thesis_rod(0.02), thesis_rod(0.0202)];
    solved(&rods[1], &settings, &mut workspace);
    bencher.bench_local(|| {
        rods.swap(0, 1);
        solve_near(black_box(&rods[1]), &settings, &mut workspace).expect("the benchmark's rod has an answer")
    });
}

#[divan::bench(args = ["1e-6", "1e-9"])]
fn cold_20_g(bencher: Bencher, tolerance: &str) {
    cold(bencher, &thesis_rod(0.02), tolerance);
}

#[divan::bench(args = ["1e-6", "1e-9"])]
fn warm_20_g_1_percent(bencher: Bencher, tolerance: &str) {
    warm(bencher, tolerance);
}

#[divan::bench(args = ["1e-9"])]
fn cold_41_7_g(bencher: Bencher, tolerance: &str) {
    cold(bencher, &thesis_rod(0.0417), tolerance);
}

#[divan::bench(args = ["1e-6", "1e-9"])]
fn cold_two_sections_follower(bencher: Bencher, tolerance: &str) {
    cold(bencher, &two_sections_with_follower(), tolerance);
}

#[divan::bench]
fn constant_curvature_20_g(bencher: Bencher) {
    let robot = thesis_rod(0.02);
    bencher.bench_local(|| {
        constant_curvature(black_box(&robot), Weight::Included).expect("the benchmark's rod has an answer")
    });
}

/// The eleven loads of Table 2 against all models.
#[divan::bench(sample_count = 10)]
fn verify_the_built_in_bench(bencher: Bencher) {
    let experiment = builtin::experiment().expect("the built-in experiment is read").value;
    let settings = Settings::default();
    bencher.bench_local(|| verify(black_box(&experiment), &settings).expect("every row has an answer"));
}

#[divan::bench]
fn one_station(bencher: Bencher) {
    let (robot, mut workspace) = (thesis_rod(0.02), Workspace::default());
    solved(&robot, &to("1e-9"), &mut workspace);
    let s = 0.61 * robot.length();
    bencher.bench_local(|| workspace.station(&robot, black_box(s)));
}

#[divan::bench]
fn cold_20_g_with_101_stations(bencher: Bencher) {
    let (robot, mut workspace) = (thesis_rod(0.02), Workspace::default());
    let settings = Settings { stations: 101, ..to("1e-9") };
    bencher.bench_local(|| solved(black_box(&robot), &settings, &mut workspace));
}

#[divan::bench]
fn cold_20_g_with_smallest_eigenvalue(bencher: Bencher) {
    let (robot, mut workspace) = (thesis_rod(0.02), Workspace::default());
    let settings = Settings { eigenvalue: true, ..to("1e-9") };
    bencher.bench_local(|| solved(black_box(&robot), &settings, &mut workspace));
}
