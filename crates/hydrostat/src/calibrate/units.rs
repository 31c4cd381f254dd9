//! Whether a unit is wrong: with what power of ten the robot of the files explains at once what no fit should have to.

use super::fit::Fit;
use super::{Calibration, Points, Problem, plausible};
use crate::Error;
use crate::statics::Settings;
use crate::verify::{Experiment, Varied};

/// Part of the length from which a mean error makes a fit doubtful, and below which one is explained.
const EXPLAINED: f64 = 0.05;
/// Part of the error as it stands that a wrong unit must explain; times the fitted error that it may leave.
const BETTER: f64 = 0.2;
const AS_GOOD: f64 = 2.0;
/// A load of another unit than said. A factor of ten would be one of stiffness as well.
const OF_LOADS: [f64; 2] = [1e3, 1e-3];
/// A place of another unit than said: m, cm, mm, um and inches.
const OF_READINGS: [f64; 8] = [1e3, 1e-3, 1e2, 1e-2, 10.0, 0.1, 25.4, 1.0 / 25.4];
/// Rows that are asked.
const ROWS: usize = 20;
/// Loads, in bending stiffness over squares of the length, that are large already: nobody means a thousand times as much.
const LARGE: f64 = 20.0;

/// An error where a fit is doubtful or has failed, and a wrong unit explains what was measured without any.
pub(super) fn mistaken(problem: &Problem, settings: &Settings, found: Option<&Calibration>) -> Option<Error> {
    let doubtful = |found: &Calibration| {
        found.after.mean_fraction > EXPLAINED
            || found.parameters.iter().any(|estimate| plausible::unphysical(problem, estimate).is_some())
    };
    if !found.is_none_or(doubtful) {
        return None;
    }
    let few = few_rows(problem);
    let points = predicted(&few, settings);
    let as_stated = error(&few.experiment, points.as_ref(), 1.0);
    // no unit is wrong where the stated robot is near
    if as_stated < EXPLAINED {
        return None;
    }
    let kinds = [
        |of: &Varied| matches!(of, Varied::HungMass { .. }),
        |of: &Varied| matches!(of, Varied::Force { .. } | Varied::Tension { .. }),
        |of: &Varied| matches!(of, Varied::Displacement { .. }),
    ];
    let mut tried: Vec<(f64, String, f64)> = Vec::new();
    for kind in kinds {
        let inputs: Vec<usize> =
            (0..few.experiment.inputs.len()).filter(|&i| kind(&few.experiment.inputs[i].quantity)).collect();
        for factor in OF_LOADS.into_iter().filter(|_| !inputs.is_empty()) {
            tried.push((loaded(&few, &inputs, factor, settings), columns(&few.experiment, &inputs), factor));
        }
    }
    for factor in OF_READINGS {
        let left = error(&few.experiment, points.as_ref(), factor);
        tried.push((left, "the measured coordinates".to_owned(), factor));
    }
    let (left, what, factor) = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let explains = left < EXPLAINED
        && left < BETTER * as_stated
        && found.is_none_or(|found| left < AS_GOOD * found.after.mean_fraction);
    explains.then(|| refusal(problem, as_stated, left, &what, factor, found))
}

fn refusal(
    problem: &Problem,
    as_stated: f64,
    left: f64,
    what: &str,
    factor: f64,
    found: Option<&Calibration>,
) -> Error {
    let mm = |part: f64| format!("{:.1} mm", 1e3 * part * problem.experiment.robot.length());
    let before =
        if as_stated.is_finite() { format!("{} as it stands", mm(as_stated)) } else { "no shape".to_owned() };
    let after = found.map(|found| {
        let values: Vec<String> = found
            .parameters
            .iter()
            .map(|estimate| {
                format!("{} = {}", estimate.parameter.name, estimate.parameter.show(estimate.value, None))
            })
            .collect();
        format!("; to fit it takes {} and leaves {}", values.join(", "), mm(found.after.mean_fraction))
    });
    let factor = if factor > 1.0 {
        format!("multiplied by {factor}")
    } else {
        format!("divided by {}", (1.0 / factor * 10.0).round() / 10.0)
    };
    Error::new(format!(
        "a unit is wrong: with {what} {factor} the robot of the files errs by {} on average, against {before}{}",
        mm(left),
        after.unwrap_or_default()
    ))
    .hint(
        "check the unit in the header of the table, or under [[vary]] and [[measure]]; if it is right, a value of the robot file is as \
         wrong: correct that",
    )
}

fn columns(experiment: &Experiment, inputs: &[usize]) -> String {
    let names: Vec<String> = inputs
        .iter()
        .map(|&i| &experiment.inputs[i])
        .map(|input| format!("{} [{}]", input.column, input.unit.0))
        .collect();
    match &names[..] {
        [one] => format!("the column {one}"),
        [first, rest @ ..] => format!("the column {first} and {} like it", rest.len()),
        [] => String::new(),
    }
}

/// Rows from all over the table.
fn few_rows(problem: &Problem) -> Problem {
    let mut few = problem.clone();
    let rows = &problem.experiment.rows;
    few.experiment.rows = rows.iter().step_by(rows.len().div_ceil(ROWS)).cloned().collect();
    few.holdout.clear();
    few
}

/// Points with the files' values; None where there is no shape.
fn predicted(problem: &Problem, settings: &Settings) -> Option<Points> {
    let mut fit = Fit::new(problem, settings).ok()?;
    let start = fit.start.clone();
    fit.points(&start).ok()
}

/// Mean error over the length, with readings so many times as large; without end where there is no shape.
fn error(experiment: &Experiment, points: Option<&Points>, readings: f64) -> f64 {
    let Some(points) = points else { return f64::INFINITY };
    let errors = experiment.rows.iter().zip(points).flat_map(|(row, points)| {
        let mut row = row.clone();
        row.observed.iter_mut().for_each(|observed| *observed *= readings);
        experiment.differences(&row, points)
    });
    experiment.summary(experiment.robot.length(), errors).mean_fraction
}

/// The same with these inputs so many times as large; without end where they are too large to ask.
fn loaded(problem: &Problem, inputs: &[usize], factor: f64, settings: &Settings) -> f64 {
    let mut other = problem.clone();
    let Experiment { robot, rows, .. } = &mut other.experiment;
    let length = robot.length();
    let bending = robot.sections.iter().map(|section| section.stiffness(0.0).1);
    let softest = bending.map(|bending| bending[0].min(bending[1])).fold(f64::INFINITY, f64::min);
    for row in rows {
        for &i in inputs {
            let value = row.inputs[i].abs();
            let asked = match problem.experiment.inputs[i].quantity {
                Varied::Displacement { .. } => value * factor / length,
                Varied::HungMass { .. } => value * robot.gravity.norm() * length.powi(2) / softest / LARGE,
                _ => value * length.powi(2) / softest / LARGE,
            };
            if factor > 1.0 && asked > 1.0 {
                return f64::INFINITY;
            }
            row.inputs[i] *= factor;
        }
    }
    error(&problem.experiment, predicted(&other, settings).as_ref(), 1.0)
}
