//! Whether a unit is wrong: whether loads or readings in another unit make the robot of the files explain at once what no fit should have to.

use super::fit::Fit;
use super::{Calibration, Parameter, Points, Problem, plausible};
use crate::Error;
use crate::statics::Settings;
use crate::verify::{Experiment, Varied};

/// Part of the length from which a mean error makes a fit doubtful, and below which one is explained.
pub(super) const EXPLAINED: f64 = 0.05;
/// Part of the error as it stands that a wrong unit must explain; times the fitted error that it may leave.
const BETTER: f64 = 0.2;
const AS_GOOD: f64 = 2.0;

type Factor = (f64, &'static str);
/// A load of another unit than said. A factor of ten would be one of stiffness as well.
const OF_LOADS: [Factor; 2] = [(1e3, "multiplied by 1000"), (1e-3, "divided by 1000")];
/// A place of another unit than said: m, cm, mm, um and inches.
const OF_READINGS: [Factor; 8] = [
    (1e3, "multiplied by 1000"),
    (1e-3, "divided by 1000"),
    (1e2, "multiplied by 100"),
    (1e-2, "divided by 100"),
    (10.0, "multiplied by 10"),
    (0.1, "divided by 10"),
    (25.4, "multiplied by 25.4"),
    (1.0 / 25.4, "divided by 25.4"),
];
/// Rows that are asked.
const ROWS: usize = 20;
/// Loads, in bending stiffness over squares of the length, that are large already: nobody means a thousand times as much.
const LARGE: f64 = 20.0;

/// Another unit for a part of the table.
struct Trial {
    /// Such as `the column mass [g] divided by 1000`.
    what: String,
    /// Mean error of the robot of the files over the length; without end where there is no shape.
    left: f64,
}

/// An error where a fit is doubtful or has failed, and another unit explains what was measured without any. Where the user has bounded what
/// is doubtful, or given it a prior, a warning of the fit instead.
pub(super) fn judge(
    problem: &Problem,
    settings: &Settings,
    found: &mut Result<Calibration, Error>,
) -> Result<(), Error> {
    if found.as_ref().is_ok_and(|found| !is_doubtful(problem, found)) {
        return Ok(());
    }
    let Some(sentence) = explanation(problem, settings, found.as_ref().ok()) else { return Ok(()) };
    let check = "check the unit in the header of the table, or under [[vary]] and [[measure]], and the values of the robot file";
    match found {
        Err(error) => Err(error.clone().or_hint(&format!("probably {sentence}: {check}"))),
        Ok(found) if is_meant(problem, found) => {
            found.warnings.insert(0, format!("Probably {sentence}."));
            Ok(())
        }
        Ok(found) => {
            let names: Vec<&str> =
                found.parameters.iter().map(|estimate| estimate.parameter.name.as_str()).collect();
            Err(Error::new(format!("probably {sentence}")).hint(format!(
                "{check}; if all of them are meant, say so by bounds or a prior (--bounds, --prior) of {}",
                names.join(", ")
            )))
        }
    }
}

fn is_doubtful(problem: &Problem, found: &Calibration) -> bool {
    found.after.mean_fraction > EXPLAINED
        || found.parameters.iter().any(|estimate| plausible::unphysical(problem, estimate).is_some())
}

/// Whether the user has said of all that is doubtful between which values, or about where, it lies.
fn is_meant(problem: &Problem, found: &Calibration) -> bool {
    let said = |parameter: &Parameter| parameter.bounded || parameter.prior.is_some();
    let errs = found.after.mean_fraction > EXPLAINED;
    let mut doubtful =
        found.parameters.iter().filter(|estimate| errs || plausible::unphysical(problem, estimate).is_some());
    doubtful.all(|estimate| said(&estimate.parameter))
}

/// As the rest of `probably ...`, where another unit explains the table.
fn explanation(problem: &Problem, settings: &Settings, found: Option<&Calibration>) -> Option<String> {
    let few = few_rows(problem);
    let points = predicted(&few, settings);
    let as_stated = error(&few.experiment, points.as_ref(), 1.0);
    // no unit is wrong where the stated robot is near
    if as_stated < EXPLAINED {
        return None;
    }
    let mut tried = with_other_loads(&few, settings);
    tried.extend(OF_READINGS.map(|(factor, word)| Trial {
        what: format!("the measured coordinates {word}"),
        left: error(&few.experiment, points.as_ref(), factor),
    }));
    let best = tried.into_iter().min_by(|a, b| a.left.total_cmp(&b.left))?;
    let explains = best.left < EXPLAINED
        && best.left < BETTER * as_stated
        && found.is_none_or(|found| best.left < AS_GOOD * found.after.mean_fraction);
    explains.then(|| sentence(problem, as_stated, &best, found))
}

/// Columns of one kind are of one unit.
fn with_other_loads(few: &Problem, settings: &Settings) -> Vec<Trial> {
    let kinds = [
        |of: &Varied| matches!(of, Varied::HungMass { .. }),
        |of: &Varied| matches!(of, Varied::Force { .. } | Varied::Tension { .. }),
        |of: &Varied| matches!(of, Varied::Displacement { .. }),
    ];
    let mut tried = Vec::new();
    for kind in kinds {
        let inputs: Vec<usize> =
            (0..few.experiment.inputs.len()).filter(|&i| kind(&few.experiment.inputs[i].quantity)).collect();
        for (factor, word) in OF_LOADS.into_iter().filter(|_| !inputs.is_empty()) {
            let what = format!("{} {word}", columns(&few.experiment, &inputs));
            tried.push(Trial { what, left: loaded(few, &inputs, factor, settings) });
        }
    }
    tried
}

fn sentence(problem: &Problem, as_stated: f64, best: &Trial, found: Option<&Calibration>) -> String {
    let mm = |part: f64| format!("{:.1} mm", 1e3 * part * problem.experiment.robot.length());
    let before =
        if as_stated.is_finite() { format!("{} as it stands", mm(as_stated)) } else { "no shape".to_owned() };
    let after = found.map_or_else(String::new, |found| {
        let values = found.parameters.iter().map(|estimate| {
            format!("{} = {}", estimate.parameter.name, estimate.parameter.show(estimate.value, None))
        });
        let values = values.collect::<Vec<String>>().join(", ");
        format!("; to fit it takes {values} and leaves {}", mm(found.after.mean_fraction))
    });
    format!(
        "a unit is wrong: with {} the robot of the files errs by {} on average, against {before}{after}",
        best.what,
        mm(best.left)
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
