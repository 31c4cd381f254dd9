//! Plans against brute force, and against what `calibrate` reports once the planned rows are measured.

use hydrostat::Error;
use hydrostat::calibrate::{Problem, calibrate, expected, sensitivities};
use hydrostat::description::{CalibrationFlags, PlanFlags, builtin, parse_plan};
use hydrostat::plan::{Choice, Plan, Request, plan};
use hydrostat::statics::Settings;
use hydrostat::verify::Row;
use nalgebra::{DMatrix, Vector3};

fn free(names: &str) -> CalibrationFlags {
    CalibrationFlags { free: vec![names.to_owned()], ..CalibrationFlags::default() }
}

fn flags(limits: &[&str], measurements: usize) -> PlanFlags {
    PlanFlags {
        limits: limits.iter().map(|text| (*text).to_owned()).collect(),
        measurements: Some(measurements),
        repeats: Some(2),
        seed: 1,
    }
}

fn request(names: &str, limits: &[&str], measurements: usize) -> Request {
    builtin::plan(&free(names), &flags(limits, measurements)).expect("is valid").value
}

fn planned(request: &Request) -> Plan {
    plan(request, &Settings::default()).expect("is found")
}

/// Derivatives of the rows at hand and of the same bench with other masses, in reading errors, (rows x (2 x parameters)).
fn derivatives(problem: &Problem, masses: &[f64]) -> (DMatrix<f64>, Vec<DMatrix<f64>>) {
    let scaled = |problem: &Problem| {
        sensitivities(problem, &Settings::default()).expect("solves").1
            / problem.experiment.points[0].reading_error
    };
    let mut candidates = problem.clone();
    candidates.experiment.rows =
        masses.iter().map(|mass| Row { inputs: vec![*mass], observed: vec![Vector3::zeros()] }).collect();
    let all = scaled(&candidates);
    let rows = (0..masses.len()).map(|i| all.rows(2 * i, 2).into_owned());
    (scaled(problem), rows.collect())
}

fn masses() -> Vec<f64> {
    (0..21).map(|i| 41.7e-3 * f64::from(i) / 20.0).collect()
}

/// The row at which the parameter shows most, as often as there is time.
#[test]
fn one_parameter_is_measured_where_it_shows_most() {
    let request = request("youngs_modulus", &[], 2);
    let found = planned(&request);
    let masses = masses();
    let (_, candidates) = derivatives(&request.problem, &masses);
    let best = (0..masses.len()).max_by(|&a, &b| candidates[a].norm().total_cmp(&candidates[b].norm()));
    let best = masses[best.expect("is not empty")];
    for design in [&found.d_optimal, &found.a_optimal] {
        for row in &design.rows {
            assert!((row.inputs[0] - best).abs() < 1e-9, "{row:?} {best}");
        }
    }
}

/// All 231 pairs of the grid.
#[test]
fn two_rows_for_two_parameters_are_the_best_pair() {
    let request = request("youngs_modulus,length", &[], 2);
    let found = planned(&request);
    let (measured, candidates) = derivatives(&request.problem, &masses());
    let base = measured.tr_mul(&measured);
    let own: Vec<DMatrix<f64>> = candidates.iter().map(|rows| rows.tr_mul(rows)).collect();
    let (mut largest, mut smallest) = (0.0_f64, f64::INFINITY);
    for a in 0..own.len() {
        for b in 0..=a {
            let all = &base + &own[a] + &own[b];
            let determinant = all[(0, 0)] * all[(1, 1)] - all[(0, 1)].powi(2);
            largest = largest.max(determinant);
            let relative = all[(1, 1)] / 54e9_f64.powi(2) + all[(0, 0)] / 0.39_f64.powi(2);
            smallest = smallest.min(relative / determinant);
        }
    }
    let before = base[(0, 0)] * base[(1, 1)] - base[(0, 1)].powi(2);
    let volume = found.d_optimal.volume.expect("is determined");
    assert!((volume / (before / largest).sqrt() - 1.0).abs() < 1e-6, "{volume}");
    let sum: f64 =
        found.parameters.iter().map(|p| (p.after_a.expect("is determined") / p.value).powi(2)).sum();
    let smallest = smallest * found.error_scale.powi(2);
    assert!((sum / smallest - 1.0).abs() < 1e-6, "{sum:e} {smallest:e}");
}

/// Exact readings at the rows at hand and at the planned ones, and a calibration of all.
#[test]
fn expected_errors_are_those_of_a_calibration() {
    /// Both from the same derivatives, at values that the fit finds again.
    const CLOSE: f64 = 1e-4;
    for (names, limits) in [
        ("youngs_modulus,length", &[][..]),
        ("youngs_modulus,length,density", &["mount_angle=0 deg to 60 deg", "mass=0 g to 20 g"]),
    ] {
        let mut request = request(names, limits, 3);
        request.problem.parameters[0].prior =
            Some(hydrostat::calibrate::Prior { value: 54e9, standard_error: 1e9 });
        let exact = sensitivities(&request.problem, &Settings::default()).expect("solves").0;
        for (i, row) in request.problem.experiment.rows.iter_mut().enumerate() {
            row.observed[0] = Vector3::new(exact[2 * i], exact[2 * i + 1], 0.0);
        }
        let found = planned(&request);
        let mut problem = request.problem.clone();
        problem.experiment.inputs = request.limits.iter().map(|limit| limit.input.clone()).collect();
        let inputs = problem.experiment.inputs.len();
        for row in &mut problem.experiment.rows {
            row.inputs.resize(inputs, 0.0);
        }
        let now = calibrate(&problem, &Settings::default()).expect("fits");
        for row in &found.d_optimal.rows {
            let observed = row.predicted.clone();
            problem.experiment.rows.push(Row { inputs: row.inputs.clone(), observed });
        }
        let after = calibrate(&problem, &Settings::default()).expect("fits");
        for (j, planned) in found.parameters.iter().enumerate() {
            for (expected, reported) in
                [(planned.now, &now.parameters[j]), (planned.after_d, &after.parameters[j])]
            {
                let (expected, reported) =
                    (expected.expect("is determined"), reported.standard_error.expect("is determined"));
                assert!(
                    (expected / reported - 1.0).abs() < CLOSE,
                    "{}: {expected:e} {reported:e}",
                    planned.parameter.name
                );
            }
            let [low, high] = after.parameters[j].interval_95.expect("is determined");
            let half = found.quantiles[1].expect("is known") * planned.after_d.expect("is determined");
            assert!((half / (0.5 * (high - low)) - 1.0).abs() < CLOSE, "{half:e} {low:e} {high:e}");
        }
    }
}

/// As `calibrate` widens its intervals by the residuals of the rows at hand, so does the plan.
#[test]
fn errors_are_those_of_the_fit_to_the_rows_at_hand() {
    /// Derivatives are those at the files' values, not at the optimum.
    const CLOSE: f64 = 0.03;
    let request = request("youngs_modulus,length", &[], 2);
    let found = planned(&request);
    let fitted = calibrate(&request.problem, &Settings::default()).expect("fits");
    assert_eq!(found.error_scale, fitted.error_scale);
    for (planned, estimate) in found.parameters.iter().zip(&fitted.parameters) {
        let (now, reported) =
            (planned.now.expect("is determined"), estimate.standard_error.expect("is determined"));
        assert!((now / reported - 1.0).abs() < CLOSE, "{}: {now:e} {reported:e}", planned.parameter.name);
        let [low, high] = estimate.interval_95.expect("is determined");
        let half = found.quantiles[0].expect("is known") * now;
        assert!((half / (0.5 * (high - low)) - 1.0).abs() < CLOSE, "{half:e} {low:e} {high:e}");
    }
    // more rows, more degrees of freedom
    assert!(found.quantiles[1] < found.quantiles[0], "{:?}", found.quantiles);
    let last = found.verdict.last().expect("has words");
    assert!(
        last.contains(
            "errors 3.3 times the stated reading error, as the fit to the 11 rows at hand finds them"
        ),
        "{last}"
    );
}

/// Two coordinates and one parameter that they see: Student's t of one degree of freedom, Abramowitz & Stegun, table 26.10.
#[test]
fn what_does_not_show_costs_no_degree_of_freedom() {
    let mut few = request("youngs_modulus,shear_modulus", &["mass=0 g to 40 g"], 2);
    few.problem.experiment.rows.drain(..10);
    let found = planned(&few);
    assert!(found.error_scale > 1.0, "{}", found.error_scale);
    assert!((found.quantiles[0].expect("is known") - 12.706).abs() < 1e-3, "{:?}", found.quantiles);
    assert!(found.parameters[1].now.is_none());
    // as many as coordinates
    let mut few = request("youngs_modulus,length", &["mass=0 g to 40 g"], 2);
    few.problem.experiment.rows.drain(..10);
    let derivatives = sensitivities(&few.problem, &Settings::default()).expect("solves").1;
    let of = |scale| expected(&few.problem, &derivatives, scale).expect("is valid").quantile;
    assert!(of(2.0).is_none() && of(1.0).is_some_and(f64::is_finite));
    // one of them on its bound in the fit, none in the plan
    few.problem.parameters[1].bounds = [0.3895, 0.3905];
    few.problem.parameters[1].bounded = true;
    let found = planned(&few);
    assert!(found.error_scale > 1.0 && found.quantiles[0].is_none(), "{found:?}");
    assert!(
        found.verdict.iter().any(|sentence| sentence.starts_with("No 95 % interval is known now: ")),
        "{:?}",
        found.verdict
    );
}

/// A table in a wrong unit plans nothing; one that has no fit for another reason plans with a warning.
#[test]
fn rows_at_hand_without_a_fit_are_said() {
    let mut wrong = request("youngs_modulus", &["mass=0 g to 40 g"], 1);
    wrong.problem.experiment.rows.iter_mut().for_each(|row| row.inputs[0] *= 1e-3);
    let error = plan(&wrong, &Settings::default()).expect_err("wrong unit").to_string();
    assert!(error.contains("a unit is wrong: with the column mass [g] multiplied by 1000"), "{error}");
    let mut few = request("youngs_modulus,length,density", &["mass=0 g to 40 g"], 1);
    few.problem.experiment.rows.truncate(1);
    let found = planned(&few);
    assert!(
        found.warnings[0].contains("have no fit")
            && found.warnings[0].contains("only 2 measured coordinates"),
        "{:?}",
        found.warnings
    );
    assert!(planned(&request("youngs_modulus", &[], 1)).warnings.is_empty());
}

/// A list with more values than a grid may have rows is drawn from, and what is drawn twice is one candidate.
#[test]
fn drawn_rows_are_not_repeated() {
    let masses: Vec<String> = (0..=400).map(|i| format!("{} g", 0.1 * f64::from(i))).collect();
    let mut request = request("youngs_modulus,length", &[&format!("mass={}", masses.join(","))], 30);
    request.repeats = 1;
    let found = planned(&request);
    for design in [&found.d_optimal, &found.a_optimal] {
        let mut masses: Vec<f64> = design.rows.iter().map(|row| row.inputs[0]).collect();
        masses.sort_by(f64::total_cmp);
        assert!(masses.len() == 30 && masses.windows(2).all(|pair| pair[0] < pair[1]), "{masses:?}");
    }
}

/// A row comes as often as is allowed, and only weights that there are.
#[test]
fn weights_from_a_list_are_not_repeated() {
    let mut request = request("youngs_modulus,length", &["mass=0 g, 20 g, 50 g, 20 g"], 3);
    request.repeats = 1;
    let found = planned(&request);
    assert_eq!(found.candidates, 3);
    for design in [&found.d_optimal, &found.a_optimal] {
        let mut masses: Vec<f64> = design.rows.iter().map(|row| row.inputs[0]).collect();
        masses.sort_by(f64::total_cmp);
        assert_eq!(masses, [0.0, 0.02, 0.05]);
    }
    request.measurements = 5;
    let short = planned(&request);
    assert_eq!((short.d_optimal.rows.len(), short.a_optimal.rows.len()), (3, 3));
    assert!(
        short.verdict.iter().any(
            |sentence| sentence.starts_with("Only 3 of 5 rows are planned: with each taken once at most")
        ),
        "{:?}",
        short.verdict
    );
    request.repeats = 2;
    assert_eq!(planned(&request).d_optimal.rows.len(), 5);
    request.repeats = 0;
    assert!(plan(&request, &Settings::default()).is_err());
}

/// A rod that would yield or fall over is no proposal, and a row whose derivatives are good for nothing is doubted.
#[test]
fn doubtful_rows_are_left_out_or_said() {
    let found = planned(&request(
        "youngs_modulus,mount_angle",
        &["mass=0 g to 200 g", "mount_angle=-90 deg to 90 deg"],
        2,
    ));
    let reasons: Vec<&str> = found.left_out.iter().map(|(reason, _)| reason.as_str()).collect();
    assert!(
        reasons.contains(&"check strain fails") && reasons.contains(&"check stability fails"),
        "{reasons:?}"
    );
    let counted: usize = found.left_out.iter().map(|(_, count)| count).sum();
    assert_eq!(counted + found.candidates, 400);
    let upright = planned(&request(
        "youngs_modulus,density,mount_angle",
        &["mass=20 g to 24 g", "mount_angle=85 deg to 90 deg"],
        2,
    ));
    assert!(
        upright.verdict.iter().any(|sentence| sentence.starts_with("Doubt the row mass ")),
        "{:?}",
        upright.verdict
    );
}

#[test]
fn what_nothing_determines_is_named() {
    let found =
        planned(&request("youngs_modulus,shear_modulus,density", &["mount_angle=0 deg to 45 deg"], 2));
    assert!(
        found.parameters[1].now.is_none() && found.parameters[1].after_d.is_none(),
        "{:?}",
        found.parameters
    );
    assert!(found.parameters[0].after_d.is_some() && found.d_optimal.volume.is_none());
    assert!(
        found
            .verdict
            .iter()
            .any(|sentence| sentence.contains("Nothing within the limits determines shear_modulus")),
        "{:?}",
        found.verdict
    );
    // collinear whatever the mass
    let found = planned(&request("youngs_modulus,diameter", &[], 2));
    let words = found.verdict.join(" ");
    assert!(words.contains("youngs_modulus and diameter can") && words.contains("told apart"), "{words}");
}

const SCR: &str = include_str!("../../../robots/scr.toml");

fn of_scr(limits: &[&str], names: &str) -> Result<Plan, Error> {
    plan(&scr(limits, names, "")?, &Settings::default())
}

/// With `[plan]` as given.
fn scr(limits: &[&str], names: &str, wanted: &str) -> Result<Request, Error> {
    let bench = "name = \"scr\"\nrobot = \"scr.toml\"\ndata = \"data.csv\"\n[[vary]]\nquantity = \"tension\"\ntendon = \"a\"\n\
                 column = \"pull\"\n[[measure]]\nat = \"tip\"\nx = \"x\"\nz = \"z\"\nreading_error = \"0.5 mm\"\n";
    let data = "pull [N],x [mm],z [mm]\n0.5,1,1\n1,1,1\n";
    let mut load = |path: &str| Ok(if path == "data.csv" { data.to_owned() } else { SCR.to_owned() });
    let bench = bench.to_owned() + wanted;
    parse_plan(&bench, "bench.toml", &mut load, &free(names), &flags(limits, 2)).map(|parsed| parsed.value)
}

#[test]
fn a_list_of_the_file_is_a_list() {
    let read = |limit: &str| scr(&[], "youngs_modulus", &format!("[plan]\nlimit = {{ pull = {limit} }}\n"));
    let choice = |limit: &str| read(limit).unwrap_or_else(|error| panic!("{error}")).limits[0].choice.clone();
    assert_eq!(choice("[\"2 N\"]"), Choice::Values(vec![2.0]));
    assert_eq!(choice("[\"2 N\", \"1 N\", \"2 N\"]"), Choice::Values(vec![1.0, 2.0]));
    assert_eq!(choice("\"1 N to 2 N\""), Choice::Range([1.0, 2.0]));
    for (limit, words) in [
        ("[\"0 N to 2 N\"]", "a range stands without brackets"),
        ("[]", "expected one value at least"),
        ("[\"1 N\", \"-1 N\"]", "found -1 N, expected a force of at least 0"),
        ("[\"1 N\", \"1 g\"]", "found a mass, expected a force"),
    ] {
        let error = read(limit).expect_err(limit).to_string();
        assert!(error.contains(words) && error.contains("bench.toml:14:"), "expected {words:?} in {error}");
    }
}

/// Tendons that the table does not vary may be pulled as well.
#[test]
fn tendons_are_candidates() {
    let found = of_scr(&["tension.b=0 N to 2 N"], "youngs_modulus,tendon.b.radius").expect("is found");
    assert!(
        found.parameters[1].now.is_none() && found.parameters[1].after_d.is_some(),
        "{:?}",
        found.parameters
    );
    assert!(found.d_optimal.rows.iter().any(|row| row.inputs[1] > 0.0), "{:?}", found.d_optimal);
    assert!(
        found.verdict.last().is_some_and(|sentence| sentence.contains("by itself")),
        "{:?}",
        found.verdict
    );
}

#[test]
fn refusals() {
    let refused = |limit: &str, words: &[&str]| {
        let error = builtin::plan(&free("youngs_modulus"), &flags(&[limit], 2)).expect_err(limit).to_string();
        for word in words {
            assert!(error.contains(word), "expected {word:?} in {error}");
        }
    };
    refused("mass", &["found --limit \"mass\", expected NAME=LOW to HIGH"]);
    refused(
        "mass=5 g",
        &["--limit \"mass=5 g\": found \"5 g\", expected two values, such as \"20 g to 20 g\""],
    );
    refused("mass=5 g, 6 mm", &["found a length, expected a mass"]);
    refused("mass=-5 g, 6 g", &["expected a mass of at least 0"]);
    refused("mass=5 mm to 6 mm", &["found a length, expected a mass"]);
    refused("mass=6 g to 5 g", &["found \"6 g to 5 g\", expected the lower value first"]);
    refused("mass=-6 g to 5 g", &["expected a mass of at least 0"]);
    refused(
        "angle=0 deg to 5 deg",
        &["\"angle\" is nothing that is or could be varied here", "what can be: mass, mount_angle"],
    );
    refused("tension.a=0 N to 5 N", &["there is no tendon \"a\""]);
    let error = of_scr(&["tension.a=0 N to 2 N"], "youngs_modulus").expect_err("twice").to_string();
    assert!(error.contains("tendon \"a\" is varied already") && error.contains("\"pull\""), "{error}");
    let error = of_scr(&["displacement.b=0 mm to 900 mm"], "youngs_modulus").expect_err("long").to_string();
    assert!(error.contains("cannot be pulled in by 900 mm"), "{error}");
    let none = plan(&request("youngs_modulus", &[], 0), &Settings::default()).expect_err("none").to_string();
    assert!(none.contains("found 0 measurements to plan, expected 1 to 100"), "{none}");
    let heavy = plan(&request("youngs_modulus", &["mass=5 kg to 6 kg"], 1), &Settings::default());
    let heavy = heavy.expect_err("breaks").to_string();
    assert!(
        heavy.contains("nothing within the limits can be measured") && heavy.contains("strain"),
        "{heavy}"
    );
    assert!(builtin::plan(&CalibrationFlags::default(), &flags(&[], 1)).is_err());
}
