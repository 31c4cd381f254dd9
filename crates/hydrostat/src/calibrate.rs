//! Fits parameters of a robot and its bench to what was measured, and says how sure they are.

mod check;
mod fit;
mod neighbours;
mod outliers;
mod parameter;
mod part;
mod plausible;
mod predict;
mod ranking;
mod search;
mod sensitivity;
mod setup;
mod statistics;
mod units;
mod verdict;

pub use parameter::{Parameter, Prior};
pub use part::{Dimension, Part};
pub use sensitivity::{Expected, Points, expected, predict, predictions, sensitivities, start};
pub use verdict::in_common;

use crate::numeric::least_squares::{Evaluation, Minimum};
use crate::statics::Settings;
use crate::verify::{Experiment, PointError, Row, Summary, systematic};
use crate::{Error, Robot};
use fit::Fit;
use nalgebra::{DMatrix, DVector};
use statistics::Statistics;

/// A bench, and what of it is not known.
#[derive(Clone, Debug)]
pub struct Problem {
    pub experiment: Experiment,
    pub parameters: Vec<Parameter>,
    pub loss: Loss,
    /// Points from which the fit starts: the files' values, then others between the bounds; at least 1.
    pub starts: usize,
    /// Parts of the rows, each predicted from all others by a fit of its own; 0 for none.
    pub folds: usize,
    /// Rows like those of the experiment that the fit does not see; may be empty.
    pub holdout: Vec<Row>,
}

/// How far a calibration has come.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Such as `start 2 of 5`.
    pub stage: String,
    /// Of all rows, so far in this stage.
    pub evaluations: usize,
    /// Root mean square of residual over reading error.
    pub residual: f64,
}

/// How a residual counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loss {
    /// By its square.
    #[default]
    Squares,
    /// By its square while it is small, by its size beyond: outliers pull less.
    Huber,
}

/// Where Huber's loss turns, in standard errors: 95 % as efficient as squares without outliers (Huber 1981).
const HUBER_THRESHOLD: f64 = 1.345;

/// The outcome of [`calibrate`].
#[derive(Clone, Debug)]
pub struct Calibration {
    /// In the order of the problem.
    pub parameters: Vec<Estimate>,
    /// (parameters x parameters); NaN where a parameter has no standard error.
    pub correlation: DMatrix<f64>,
    /// The calibrated robot without what is the bench's: mount angle, offsets.
    pub robot: Robot,
    pub rows: Vec<CalibratedRow>,
    pub before: Summary,
    pub after: Summary,
    /// Of errors over stated reading errors, priors included.
    pub chi_square: f64,
    pub degrees_of_freedom: usize,
    /// Chance that reading alone leaves so large a chi-square; None without degrees of freedom.
    pub chance: Option<f64>,
    /// How many times as large as stated the errors are taken to be; 1 unless chi-square refutes the stated ones.
    pub error_scale: f64,
    /// How many times as wide the intervals should be, as rows next to each other err alike; None where they do not.
    pub too_narrow: Option<f64>,
    /// What the reading error does not explain, per coordinate, m.
    pub unexplained: f64,
    /// Whether the residuals follow an input; None where that cannot be tested.
    pub systematic: Option<bool>,
    /// Errors of each row as predicted by a fit to all others; None where a row alone determines a parameter.
    pub left_out: Option<Summary>,
    /// Errors of the rows of each fold as predicted by a fit to all others; theory (53).
    pub folds: Option<Summary>,
    /// How the starts ended, in words; None with a single one.
    pub starts: Option<String>,
    /// Errors of the rows that were held out: as the files have the robot, and calibrated.
    pub holdout: Option<[Summary; 2]>,
    /// In words: goodness of fit, systematic residuals, what the data can tell.
    pub verdict: Vec<String>,
    /// In words: what to doubt.
    pub warnings: Vec<String>,
    pub steps: usize,
}

/// A calibrated parameter; SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    pub parameter: Parameter,
    pub before: f64,
    pub value: f64,
    /// None where the data do not determine it, or it lies on a bound.
    pub standard_error: Option<f64>,
    /// Cut at the bounds.
    pub interval_95: Option<[f64; 2]>,
    /// Which ends of the interval are bounds, where the data alone allow more.
    pub cut: [bool; 2],
}

impl Estimate {
    /// From half the width of its interval.
    fn new(
        parameter: &Parameter,
        before: f64,
        value: f64,
        standard_error: Option<f64>,
        half: Option<f64>,
    ) -> Estimate {
        let [low, high] = parameter.bounds;
        let whole = half.map(|half| [value - half, value + half]);
        Estimate {
            parameter: parameter.clone(),
            before,
            value,
            standard_error,
            interval_95: whole.map(|ends| ends.map(|end| end.clamp(low, high))),
            cut: whole.map_or([false; 2], |ends| [ends[0] < low, ends[1] > high]),
        }
    }
}

/// A row before and after; one error per measured point, bench axes.
#[derive(Clone, Debug)]
pub struct CalibratedRow {
    pub inputs: Vec<f64>,
    pub before: Vec<PointError>,
    pub after: Vec<PointError>,
}

impl Problem {
    /// Least squares from the files' values, nothing held out.
    pub fn new(experiment: Experiment, parameters: Vec<Parameter>) -> Problem {
        let (loss, starts, folds, holdout) = (Loss::Squares, 1, 0, Vec::new());
        Problem { experiment, parameters, loss, starts, folds, holdout }
    }

    /// Everything that was read: rows, points, axes.
    pub(crate) fn coordinates(&self) -> usize {
        self.experiment.rows.len()
            * self.experiment.points.iter().map(|point| point.axes.len()).sum::<usize>()
    }
}

/// Least squares over all measured coordinates, theory (44) to (50).
///
/// # Errors
/// A row that cannot be solved where the fit starts, with its inputs; more free parameters than coordinates; a parameter that moves
/// nothing that was measured; no convergence; a unit that is probably wrong.
pub fn calibrate(problem: &Problem, settings: &Settings) -> Result<Calibration, Error> {
    calibrate_watched(problem, settings, &mut |_| ())
}

/// The same, telling how far it has come.
pub fn calibrate_watched(
    problem: &Problem,
    settings: &Settings,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Calibration, Error> {
    problem.check()?;
    judged(problem, settings, watch)?
}

/// A fit of a problem that asks for what can be, for those who need it less than they fear a wrong unit.
///
/// # Errors
/// A unit that is probably wrong.
pub(crate) fn judged(
    problem: &Problem,
    settings: &Settings,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Result<Calibration, Error>, Error> {
    let mut found = fitted(problem, settings, watch);
    units::judge(problem, settings, &mut found)?;
    Ok(found)
}

fn fitted(
    problem: &Problem,
    settings: &Settings,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Calibration, Error> {
    let mut fit = Fit::new(problem, settings)?;
    let start = fit.variables(&fit.start);
    let first = fit.evaluate(&start, 1.0)?;
    let before = fit.points_at(&start)?;
    refuse_without_influence(problem, &fit, &first.jacobian)?;

    let found = search::from_several_starts(&mut fit, &start, watch);
    let (minimum, starts) = found.map_err(|error| with_likely_reason(error, &fit, &first))?;
    let (minimum, error_scale) = reweighted(&mut fit, minimum, watch)?;
    let values = fit.values(&minimum.x);
    let at = fit.evaluate(&minimum.x, error_scale)?;
    let statistics = Statistics::new(problem, &at, &minimum.held, error_scale);
    let after = fit.points_at(&minimum.x)?;

    let mut calibration = result(&fit, &minimum, &statistics, error_scale, [before, after]);
    refuse_collapse(&calibration, &minimum)?;
    let length = calibration.robot.length();
    calibration.starts = starts;
    let left_out = statistics.left_out(problem, &at);
    calibration.left_out = left_out.map(|errors| {
        problem.experiment.summary(problem.experiment.robot.length(), errors.into_iter().flatten())
    });
    let tested = (problem.folds > 0)
        .then(|| search::fold_errors(problem, settings, &values, error_scale, watch))
        .transpose()?;
    let (folds, not_known) = tested.map_or((None, None), |tested| match tested {
        Ok(errors) => (Some(problem.experiment.summary(length, errors.into_iter())), None),
        Err(sentence) => (None, Some(sentence)),
    });
    calibration.folds = folds;
    if !problem.holdout.is_empty() {
        let lengths = [problem.experiment.robot.length(), length];
        calibration.holdout = Some(held_out(problem, settings, [&fit.start, &values], lengths)?);
    }
    put_in_words(&mut calibration, &fit, &minimum, &statistics, &at, not_known)?;
    Ok(calibration)
}

/// What the data cannot tell apart where the fit starts is the likely reason for a fit that fails.
fn with_likely_reason(error: Error, fit: &Fit, first: &Evaluation) -> Error {
    let statistics = Statistics::new(fit.problem, first, &vec![false; fit.scale.len()], 1.0);
    match verdict::identifiability(fit.problem, &statistics, first, &fit.scale).first() {
        Some(sentence) if fit.scale.len() > 1 && statistics.is_degenerate() => error.hint(sentence.clone()),
        _ => error,
    }
}

/// Errors are as stated until chi-square refutes them; priors and robust loss then weigh against larger ones.
fn reweighted(
    fit: &mut Fit,
    mut minimum: Minimum,
    watch: &mut dyn FnMut(&Progress),
) -> Result<(Minimum, f64), Error> {
    let problem = fit.problem;
    let mut error_scale = statistics::error_scale(problem, &minimum, 1.0);
    let weighs =
        problem.loss == Loss::Huber || problem.parameters.iter().any(|parameter| parameter.prior.is_some());
    for _ in 0..MOST_REWEIGHTINGS {
        if !weighs {
            break;
        }
        let before = minimum.steps;
        minimum = fit.minimize(&minimum.x, error_scale, problem.loss, watch)?;
        minimum.steps += before;
        let next = statistics::error_scale(problem, &minimum, error_scale);
        if (next / error_scale - 1.0).abs() < SETTLED {
            break;
        }
        error_scale = next;
    }
    Ok((minimum, error_scale))
}

/// What the fit itself says, with the points before and after: no tests of prediction, no words.
fn result(
    fit: &Fit,
    minimum: &Minimum,
    statistics: &Statistics,
    error_scale: f64,
    [before, after]: [Points; 2],
) -> Calibration {
    let problem = fit.problem;
    let experiment = &problem.experiment;
    let rows = experiment.rows.iter().zip(before.iter().zip(&after));
    let rows: Vec<CalibratedRow> = rows
        .map(|(row, (before, after))| CalibratedRow {
            inputs: row.inputs.clone(),
            before: experiment.differences(row, before),
            after: experiment.differences(row, after),
        })
        .collect();
    let summary = |length: f64, errors: &dyn Fn(&CalibratedRow) -> Vec<PointError>| {
        experiment.summary(length, rows.iter().flat_map(errors))
    };
    let values = fit.values(&minimum.x);
    let robot = fit.base.with(&problem.parameters, &values).turned();
    let parameters = problem.parameters.iter().enumerate().map(|(j, parameter)| {
        let standard_error = statistics.standard_error(j).map(|error| error * fit.scale[j]);
        let half = standard_error.zip(statistics.quantile).map(|(error, quantile)| quantile * error);
        Estimate::new(parameter, fit.start[j], values[j], standard_error, half)
    });
    Calibration {
        parameters: parameters.collect(),
        correlation: statistics.correlation(),
        before: summary(experiment.robot.length(), &|row| row.before.clone()),
        after: summary(robot.length(), &|row| row.after.clone()),
        robot,
        rows,
        chi_square: statistics.chi_square,
        degrees_of_freedom: statistics.degrees_of_freedom,
        chance: statistics.chance,
        error_scale,
        too_narrow: None,
        unexplained: statistics.unexplained,
        systematic: None,
        left_out: None,
        folds: None,
        starts: None,
        holdout: None,
        verdict: Vec::new(),
        warnings: Vec::new(),
        steps: minimum.steps,
    }
}

/// Standard error over value, and value over that of the files, at which a quantity that must be above 0 has none.
const TELLS_NOTHING: f64 = 100.0;
const VANISHED: f64 = 1e-4;

/// A value that no robot has, or of which the table tells nothing, is no fit, unless the user allows it by bounds.
fn refuse_collapse(calibration: &Calibration, minimum: &Minimum) -> Result<(), Error> {
    let all = calibration.parameters.iter().zip(&minimum.held);
    let all: Vec<(&Estimate, bool)> =
        all.map(|(estimate, held)| (estimate, *held)).filter(|(e, _)| !e.parameter.bounded).collect();
    let positive = |estimate: &Estimate| estimate.parameter.parts[0].lowest_possible() > 0.0;
    let errs = calibration.after.mean_fraction > units::EXPLAINED;
    let impossible = |(estimate, held): &&(&Estimate, bool)| {
        let ends = *held && errs && estimate.value == estimate.parameter.bounds[1];
        positive(estimate) && estimate.value < VANISHED * estimate.before || ends
    };
    let unknown = |(estimate, _): &&(&Estimate, bool)| {
        let error = estimate.standard_error.unwrap_or(0.0);
        positive(estimate) && error > TELLS_NOTHING * estimate.value
    };
    let (estimate, what) = match (all.iter().find(impossible), all.iter().find(unknown)) {
        (Some((estimate, _)), _) => (estimate, "which no robot has"),
        (None, Some((estimate, _))) => (estimate, "of which the table tells nothing"),
        (None, None) => return Ok(()),
    };
    Err(Error::new(format!(
        "the fit ends at {} = {}, {what}: its mean error is {:.1} mm there, {:.1} mm with the values of the files",
        estimate.parameter.name,
        estimate.parameter.show(estimate.value, None),
        1e3 * calibration.after.mean,
        1e3 * calibration.before.mean
    ))
    .hint(
        "check the table for swapped columns, a turned axis or a wrong unit: `hydrostat verify` shows it row by row; or give bounds \
         or priors",
    ))
}

/// Tests of the residuals, verdict and warnings.
fn put_in_words(
    calibration: &mut Calibration,
    fit: &Fit,
    minimum: &Minimum,
    statistics: &Statistics,
    at: &Evaluation,
    not_known: Option<String>,
) -> Result<(), Error> {
    let problem = fit.problem;
    let experiment = &problem.experiment;
    let inputs: Vec<&[f64]> = calibration.rows.iter().map(|row| row.inputs.as_slice()).collect();
    let residuals: Vec<&[PointError]> = calibration.rows.iter().map(|row| row.after.as_slice()).collect();
    let runs = systematic(experiment, &inputs, &residuals);
    let alike = neighbours::alike(experiment, &calibration.rows);
    let tests = runs
        .iter()
        .map(|found| found.is)
        .chain(alike.iter().map(|alike| alike.chance < statistics::SIGNIFICANCE));
    calibration.systematic = tests.reduce(|a, b| a || b);

    calibration.verdict = verdict::verdict(problem, calibration, statistics, at, &fit.scale);
    let rows = experiment.rows.len();
    calibration.too_narrow = alike.as_ref().and_then(|alike| verdict::widening(alike, rows));
    let narrow = alike.as_ref().and_then(|alike| verdict::narrow(alike, rows));
    calibration.verdict.splice(1..1, verdict::follows(runs.into_iter().next(), alike));
    calibration.warnings = verdict::warnings(problem, calibration, statistics, at, &minimum.held);
    calibration.warnings.extend(narrow.into_iter().chain(not_known));
    calibration.warnings.extend(problem.moved_starts()?);
    calibration.warnings.extend(minimum.crept.then(|| verdict::CREPT.to_owned()));
    Ok(())
}

/// Errors of the rows that were held out, with each of two sets of values.
fn held_out(
    problem: &Problem,
    settings: &Settings,
    values: [&[f64]; 2],
    lengths: [f64; 2],
) -> Result<[Summary; 2], Error> {
    let mut unseen = problem.clone();
    unseen.experiment.rows = std::mem::take(&mut unseen.holdout);
    unseen.experiment.refuse_impossible_readings().map_err(|error| error.within("held out"))?;
    let experiment = &unseen.experiment;
    let errors = |i: usize| -> Result<Summary, Error> {
        let points = Fit::new(&unseen, settings)?.points(values[i])?;
        let rows = experiment.rows.iter().zip(&points);
        Ok(experiment.summary(lengths[i], rows.flat_map(|(row, points)| experiment.differences(row, points))))
    };
    let both = errors(0).and_then(|before| Ok([before, errors(1)?]));
    both.map_err(|error| error.within("held out"))
}

/// Turns of weights and fit, and the relative change of the errors' scale that ends them.
const MOST_REWEIGHTINGS: usize = 20;
const SETTLED: f64 = 1e-4;

/// A parameter whose own size, or a large change of it, stays below so many reading errors tells nothing.
pub(crate) const LEAST_INFLUENCE: f64 = 0.1;

fn refuse_without_influence(problem: &Problem, fit: &Fit, jacobian: &DMatrix<f64>) -> Result<(), Error> {
    let coordinates = problem.coordinates();
    for (j, parameter) in problem.parameters.iter().enumerate() {
        let column: DVector<f64> = jacobian.column(j).rows(0, coordinates).into();
        if parameter.prior.is_some() || column.norm() >= LEAST_INFLUENCE {
            continue;
        }
        let change = parameter.show(fit.scale[j], None);
        return Err(Error::new(format!(
            "{} has no influence on what was measured: a change by {change} moves it by {:.1e} reading errors",
            parameter.name,
            column.norm()
        ))
        .hint("do not free it, give it a prior, or measure where it shows"));
    }
    Ok(())
}
