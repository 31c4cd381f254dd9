//! The inner loop works in memory that it has: what a solve allocates does not grow with its work.

use allocation_counter::measure;
use hydrostat::Robot;
use hydrostat::description::builtin;
use hydrostat::model::{Frame, Load, LoadKind};
use hydrostat::statics::{Settings, Workspace, solve_in, solve_near};
use nalgebra::Vector3;

/// The list of checks grows to at most four entries in one allocation; nothing else is returned on the heap.
const RESULT: u64 = 1;

fn thesis_rod(mass: f64) -> Robot {
    let mut robot = builtin::robot().expect("the built-in robot is read").value;
    robot.loads.push(Load { name: None, kind: LoadKind::Mass { at: robot.length(), mass } });
    robot
}

fn following(force: f64) -> Robot {
    let mut robot = thesis_rod(0.01);
    let kind = LoadKind::Point {
        at: robot.length(),
        force: Vector3::new(0.0, force, 0.02),
        moment: Vector3::zeros(),
        frame: Frame::Body,
    };
    robot.loads.push(Load { name: None, kind });
    robot
}

fn to(tolerance: f64) -> Settings {
    Settings { tolerance, stations: 0, eigenvalue: false, ..shooting() }
}

/// Iterations and allocations of one call, after calls that grew the workspace to what it needs.
fn counted(mut call: impl FnMut() -> usize) -> (usize, u64) {
    for _ in 0..4 {
        call();
    }
    let mut iterations = 0;
    let counted = measure(|| iterations = call());
    (iterations, counted.count_total)
}

#[test]
fn solving_near_allocates_no_more_than_the_result() {
    for rods in [[thesis_rod(0.02), thesis_rod(0.0202)], [following(0.05), following(0.0505)]] {
        let mut work = Vec::new();
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let (settings, mut workspace, mut rods) = (to(tolerance), Workspace::default(), rods.clone());
            let (iterations, allocations) = counted(|| {
                rods.swap(0, 1);
                solve_near(&rods[0], &settings, &mut workspace).expect("an answer").report.iterations
            });
            assert!(allocations <= RESULT, "{tolerance:e}: {allocations} in {iterations} iterations");
            work.push(iterations);
        }
        assert!(work[0] < work[2], "more accuracy takes more work: {work:?}");
    }
}

#[test]
fn solving_from_cold_in_kept_memory_allocates_no_more_than_the_result() {
    for robot in [thesis_rod(0.002), thesis_rod(0.2), following(0.05), following(0.3)] {
        for tolerance in [1e-6, 1e-12] {
            let (settings, mut workspace) = (to(tolerance), Workspace::default());
            let (iterations, allocations) =
                counted(|| solve_in(&robot, &settings, &mut workspace).expect("an answer").report.iterations);
            assert!(allocations <= RESULT, "{tolerance:e}: {allocations} in {iterations} iterations");
        }
    }
}

/// This file is about the shooting method.
fn shooting() -> Settings {
    Settings { method: hydrostat::solution::Method::Shooting, ..Settings::default() }
}
