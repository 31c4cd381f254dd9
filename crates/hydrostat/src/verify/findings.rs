//! What the source printed, held against its own data and against the model.

use super::{Experiment, Published, VerifiedRow};
use crate::Error;
use crate::statics::Settings;
use nalgebra::{DMatrix, DVector, Vector3};

/// Sentences; empty where the source printed no prediction.
pub(super) fn findings(
    experiment: &Experiment,
    rows: &[VerifiedRow],
    settings: &Settings,
) -> Result<Vec<String>, Error> {
    let Some(published) = experiment.published.as_ref().filter(|published| !published.predicted.is_empty())
    else {
        return Ok(Vec::new());
    };
    let mut findings = vec![mean_errors(experiment, published)];
    findings.extend(error_column(experiment, published));
    findings.extend(percent_column(experiment, published));
    findings.push(reproduction(experiment, published, rows));
    findings.extend(fit(experiment, published, settings)?);
    Ok(findings)
}

/// Distances between the printed coordinates, first point of every row.
fn recomputed(experiment: &Experiment, published: &Published) -> Vec<f64> {
    let rows = experiment.rows.iter().zip(&published.predicted);
    rows.map(|(row, predicted)| (row.observed[0] - predicted).norm()).collect()
}

fn mean_errors(experiment: &Experiment, published: &Published) -> String {
    let errors = recomputed(experiment, published);
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let max = errors.iter().copied().fold(0.0, f64::max);
    let mut text = format!(
        "The mean error of the printed coordinates is {:.2} mm ({:.2} % of {:.0} mm), the largest {:.2} mm",
        1e3 * mean,
        100.0 * mean / experiment.robot.length(),
        1e3 * experiment.robot.length(),
        1e3 * max
    );
    for (name, stated) in &published.mean_errors {
        let agrees = (stated - mean).abs() <= published.rounding[1].max(ROUNDING);
        let verb = if agrees { "agrees" } else { "disagrees" };
        text += &format!("; the {name}, {:.1} mm, {verb}", 1e3 * stated);
    }
    text + "."
}

/// Half of the last digit of a number printed in tenths of a millimetre, m.
const ROUNDING: f64 = 0.05e-3;

/// The range of distances that the rounding of the printed coordinates leaves, per row.
fn possible_errors(experiment: &Experiment, published: &Published) -> Vec<[f64; 2]> {
    let rounding = published.rounding[0];
    let axes = &experiment.points[0].axes;
    let rows = experiment.rows.iter().zip(&published.predicted);
    rows.map(|(row, predicted)| {
        let off = row.observed[0] - predicted;
        [-rounding, rounding]
            .map(|d| axes.iter().map(|&i| (off[i].abs() + d).max(0.0).powi(2)).sum::<f64>().sqrt())
    })
    .collect()
}

/// Rows whose printed error no rounding of the coordinates explains.
fn error_column(experiment: &Experiment, published: &Published) -> Option<String> {
    let error = published.rounding[1];
    let exact = recomputed(experiment, published);
    let wrong: Vec<String> = possible_errors(experiment, published)
        .iter()
        .zip(&published.error)
        .enumerate()
        .filter(|(_, (possible, printed))| *printed + error < possible[0] || *printed - error > possible[1])
        .map(|(k, (_, printed))| {
            let inputs = experiment.inputs_of(&experiment.rows[k]);
            format!(
                "{inputs}: {:.1} mm printed, {:.1} mm from its coordinates",
                1e3 * printed,
                1e3 * exact[k]
            )
        })
        .collect();
    if published.error.is_empty() {
        return None;
    }
    let exceptions = if wrong.is_empty() { String::new() } else { format!(", except {}", wrong.join("; ")) };
    Some(format!("The printed errors are the distances between the printed coordinates{exceptions}."))
}

/// Whether one length explains every printed percentage, given the roundings of errors and coordinates.
fn percent_column(experiment: &Experiment, published: &Published) -> Option<String> {
    let [_, error, fraction] = published.rounding;
    let possible = possible_errors(experiment, published);
    let rows = possible.iter().zip(&published.error).zip(&published.error_fraction);
    let [low, high] = rows
        .filter(|(_, f)| **f > fraction)
        .map(|((possible, e), f)| {
            let [near, far] = [possible[0].max(e - error), possible[1].min(e + error)];
            // a misprinted error leaves the coordinates alone to tell
            let [near, far] = if near <= far { [near, far] } else { *possible };
            [near / (f + fraction), far / (f - fraction)]
        })
        .reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])])?;
    Some(if low <= high {
        format!("The printed percentages fit a length of {:.1} to {:.1} mm.", 1e3 * low, 1e3 * high)
    } else {
        format!(
            "No single length explains the printed percentages: one row needs at least {:.1} mm, another at most {:.1} mm.",
            1e3 * low,
            1e3 * high
        )
    })
}

/// How closely the model reproduces the printed prediction.
fn reproduction(experiment: &Experiment, published: &Published, rows: &[VerifiedRow]) -> String {
    let largest = rows
        .iter()
        .zip(&published.predicted)
        .map(|(row, predicted)| (row.points[0].predicted - predicted).amax())
        .fold(0.0, f64::max);
    let values = if largest <= 2.0 * published.rounding[0] { "reproduced" } else { "not reproduced" };
    format!(
        "The printed prediction is {values} by the values of {}: the largest difference of a coordinate is {:.2} mm \
         (rounding explains {:.2} mm).",
        experiment.robot.name,
        1e3 * largest,
        1e3 * published.rounding[0]
    )
}

/// Least-squares fit of stiffness and weight to the printed prediction, as multiples of the stated ones.
fn fit(experiment: &Experiment, published: &Published, settings: &Settings) -> Result<Option<String>, Error> {
    let coordinates = published.predicted.len() * experiment.points[0].axes.len();
    if coordinates < 3 || experiment.robot.sections.iter().any(|section| section.material.density <= 0.0) {
        return Ok(None);
    }
    let residual = |stiffness: f64, weight: f64| -> Result<DVector<f64>, Error> {
        let mut robot = experiment.robot.clone();
        for section in &mut robot.sections {
            section.material.youngs_modulus *= stiffness;
            section.material.shear_modulus *= stiffness;
            section.material.density *= weight;
        }
        let predicted = experiment.predict(&robot, settings)?;
        let rows = predicted.iter().zip(&published.predicted);
        let axes = &experiment.points[0].axes;
        Ok(DVector::from_iterator(
            coordinates,
            rows.flat_map(|(ours, printed)| axes.iter().map(move |&i| ours[0][i] - printed[i])),
        ))
    };
    // Gauss-Newton on difference quotients: the problem is mild, and what the fit leaves is said
    let mut x = Vector3::new(1.0, 1.0, 0.0);
    let mut off = residual(x[0], x[1])?;
    for _ in 0..20 {
        let h = 1e-5;
        let columns = [(residual(x[0] + h, x[1])? - &off) / h, (residual(x[0], x[1] + h)? - &off) / h];
        let jacobian = DMatrix::from_columns(&columns);
        let Some(step) = jacobian.clone().svd(true, true).solve(&off, 1e-9).ok() else { return Ok(None) };
        x -= Vector3::new(step[0], step[1], 0.0);
        if x[0] <= 0.0 || x[1] <= 0.0 {
            return Ok(None);
        }
        off = residual(x[0], x[1])?;
        if step.amax() < 1e-6 {
            let section = &experiment.robot.sections[0];
            return Ok(Some(format!(
                "A least-squares fit to the printed prediction gives {:.4} times the stated stiffness (E = {:.2} GPa) \
                 and {:.3} times the stated weight ({:.2} g/cm^3), and then reproduces every coordinate within {:.2} mm{}.",
                x[0],
                x[0] * section.material.youngs_modulus * 1e-9,
                x[1],
                x[1] * section.material.density * 1e-3,
                1e3 * off.amax(),
                if off.amax() <= 2.0 * published.rounding[0] {
                    ": the prediction was made with those values"
                } else {
                    ", which does not explain it"
                }
            )));
        }
    }
    Ok(None)
}
