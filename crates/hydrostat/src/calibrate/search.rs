//! Fits from several starts, and of parts of the rows.

use super::fit::Fit;
use super::{LEAST_INFLUENCE, Loss, Parameter, Problem, Progress, plausible};
use crate::Error;
use crate::numeric::least_squares::Minimum;
use crate::statics::Settings;
use crate::verify::PointError;
use nalgebra::DVector;
use statrs::distribution::{ContinuousCDF, Normal};

/// Costs that differ by less, relative or in squares of reading errors, are of one minimum: nobody sees the difference.
const SAME_COST: f64 = 1e-4;
const SAME_SQUARES: f64 = 1e-2;
/// How far starts lie from the files' values at most: part of a positive value for which nothing tighter is known, and a value of any sign
/// in units of its scale.
const SPREAD: f64 = 1.0;
const SPREAD_OF_SIGNED: f64 = 0.1;

/// The lowest minimum, and in words how the starts ended; the first start is that of the files.
pub(super) fn from_several_starts(
    fit: &mut Fit,
    first: &DVector<f64>,
    watch: &mut dyn FnMut(&Progress),
) -> Result<(Minimum, Option<String>), Error> {
    let count = fit.problem.starts.max(1);
    if count == 1 {
        return Ok((fit.minimize(first, 1.0, Loss::Squares, watch)?, None));
    }
    let mut ends: Vec<(f64, Minimum, Fit)> = Vec::new();
    let mut refusal = None;
    for k in 0..count {
        fit.stage = format!("start {} of {count}", k + 1);
        let start = if k == 0 { first.clone() } else { other_start(fit, k) };
        // shapes of its own: where a row has two, no start follows another
        let mut own = fit.clone();
        match own.minimize(&start, 1.0, Loss::Squares, watch) {
            Ok(minimum) => ends.push((minimum.at.residuals.norm_squared(), minimum, own)),
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let refused = count - ends.len();
    let Some((lowest, ..)) = ends.first() else {
        return Err(refusal.unwrap_or_else(|| Error::new("no start led to a fit")));
    };
    let same = ends.iter().filter(|(cost, ..)| cost - lowest <= SAME_COST * lowest + SAME_SQUARES).count();
    let mut told = format!("{same} of {count} starts lead to this fit");
    let higher = count - refused - same;
    if higher > 0 {
        told += &format!(", {higher} to worse ones");
    }
    if refused > 0 {
        told += &format!(", {refused} to none");
    }
    let (_, minimum, best) = ends.swap_remove(0);
    *fit = best;
    Ok((minimum, Some(told + ".")))
}

/// Evenly spread by an additive recurrence (Roberts 2018), the same at every run.
fn other_start(fit: &Fit, k: usize) -> DVector<f64> {
    let count = fit.scale.len();
    let mut base: f64 = 2.0;
    for _ in 0..40 {
        base = (1.0 + base).powf(1.0 / (count as f64 + 1.0));
    }
    let values: Vec<f64> = fit
        .problem
        .parameters
        .iter()
        .enumerate()
        .map(|(j, parameter)| {
            let part = (0.5 + k as f64 * base.powi(-(j as i32 + 1))).fract();
            start_of(parameter, fit.start[j], fit.scale[j], part)
        })
        .collect();
    fit.variables(&values)
}

/// The value below which a part of the starts lies.
fn start_of(parameter: &Parameter, value: f64, scale: f64, part: f64) -> f64 {
    let [low, high] = parameter.bounds;
    let side = 2.0 * part - 1.0;
    let found = match parameter.prior {
        Some(prior) => {
            prior.value + prior.standard_error * Normal::standard().inverse_cdf(part.clamp(1e-3, 1.0 - 1e-3))
        }
        None if parameter.bounded => low + part * (high - low),
        None if low >= 0.0 && value > 0.0 => {
            value * (1.0 + plausible::tolerated(&parameter.parts[0]).unwrap_or(SPREAD)).powf(side)
        }
        None => value + SPREAD_OF_SIGNED * scale * side,
    };
    found.clamp(low, high)
}

/// Errors of every fold of neighbouring rows, predicted with the values that fit all others best; in words why not, where a fold alone
/// determines a parameter.
pub(super) fn fold_errors(
    problem: &Problem,
    settings: &Settings,
    values: &[f64],
    error_scale: f64,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Result<Vec<PointError>, String>, Error> {
    let rows = problem.experiment.rows.len();
    let mut errors = Vec::new();
    for fold in 0..problem.folds {
        let held = fold * rows / problem.folds..(fold + 1) * rows / problem.folds;
        // held rows stay where they are: drives remember them
        let mut fit = Fit::new(problem, settings)?.ignoring(held.clone());
        fit.stage = format!("fold {} of {}", fold + 1, problem.folds);
        let start = fit.variables(values);
        let minimum = fit.minimize(&start, error_scale, problem.loss, watch)?;
        for (j, parameter) in problem.parameters.iter().enumerate() {
            if parameter.prior.is_none() && minimum.at.jacobian.column(j).norm() < LEAST_INFLUENCE {
                return Ok(Err(format!(
                    "How well a part of the table is predicted from the rest is not known: {} shows in fold {} of {} alone.",
                    parameter.name,
                    fold + 1,
                    problem.folds
                )));
            }
        }
        let values = fit.values(&minimum.x);
        let points = fit.points(&values)?;
        for k in held {
            errors.extend(problem.experiment.differences(&problem.experiment.rows[k], &points[k]));
        }
    }
    Ok(Ok(errors))
}
