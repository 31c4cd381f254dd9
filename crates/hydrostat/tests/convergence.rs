//! How the error falls with what is asked for.

use hydrostat::statics::{Settings, solve};
use hydrostat::validate::robustness;

/// The largest distance from a solution at 1e-12 stays below what was asked for, and so does its estimate, which is right
/// within a factor of three: an estimate, not a bound.
#[test]
fn the_error_and_its_estimate_are_below_the_tolerance() {
    for index in 0..20 {
        let robot = robustness::robot(3, index);
        let at = |tolerance: f64| {
            let settings = Settings { tolerance, ..Settings::default() };
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
