//! How the error falls with what is asked for.

use hydrostat::description::builtin;
use hydrostat::model::LoadKind;
use hydrostat::statics::{Settings, Workspace, solve, solve_near};
use hydrostat::validate::robustness;

/// The largest distance from a solution at 1e-12 stays below what was asked for, and so does its estimate, which is right
/// within a factor of three: an estimate, not a bound.
#[test]
fn the_error_and_its_estimate_are_below_the_tolerance() {
    for index in 0..20 {
        let robot = robustness::robot(3, index);
        let at = |tolerance: f64| {
            let settings = Settings { tolerance, ..shooting() };
            solve(&robot, &settings).unwrap_or_else(|error| panic!("{}: {error}", robot.name))
        };
        let exact = at(1e-12);
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
            let found = at(tolerance);
            let pairs = found.stations.iter().zip(&exact.stations);
            let error = pairs.map(|(a, b)| (a.position - b.position).norm()).fold(0.0, f64::max);
            let estimate = found.report.error_estimate;
            let asked = tolerance * robot.length();
            assert!(estimate <= asked, "{}: {estimate:.1e} for {asked:.1e}", robot.name);
            // the reference itself is good to 1e-12
            let bound = asked.min(3.0 * estimate) + 1e-11 * robot.length();
            assert!(error <= bound, "{}, {tolerance:.0e}: {error:.1e} > {bound:.1e}", robot.name);
        }
    }
}

/// What `cargo bench` times is as accurate as its names say: cold, and warm from a mass 1 % away, at every mass of the thesis.
#[test]
fn the_benchmarked_solves_are_as_accurate_as_they_claim() {
    let bench = builtin::experiment().expect("the built-in experiment is read").value;
    for (row, acting) in bench.rows.iter().zip(bench.acting()) {
        let robot = bench.robot_in(&bench.robot, &acting);
        let mut lighter = robot.clone();
        for load in &mut lighter.loads {
            if let LoadKind::Mass { mass, .. } = &mut load.kind {
                *mass *= 0.99;
            }
        }
        let at = |tolerance: f64| Settings { tolerance, stations: 0, eigenvalue: false, ..shooting() };
        let answer = "every row has an answer";
        let exact = solve(&robot, &at(1e-12)).expect(answer).tip.position;
        for tolerance in [1e-6, 1e-9] {
            let mut workspace = Workspace::default();
            let cold = solve(&robot, &at(tolerance)).expect(answer);
            solve_near(&lighter, &at(tolerance), &mut workspace).expect(answer);
            let warm = solve_near(&robot, &at(tolerance), &mut workspace).expect(answer);
            for (start, found) in [("cold", cold), ("warm", warm)] {
                let error = (found.tip.position - exact).norm() / robot.length();
                assert!(error < tolerance, "{start}, {:?} kg, {tolerance:e}: {error:.1e}", row.inputs);
            }
        }
    }
}

/// This file is about the shooting method.
fn shooting() -> Settings {
    Settings { method: hydrostat::solution::Method::Shooting, ..Settings::default() }
}
