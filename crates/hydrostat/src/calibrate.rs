//! Fits parameters of a robot and its bench to what was measured, and says how sure they are.

mod fit;
mod neighbours;
mod outliers;
mod parameter;
mod part;
mod plausible;
mod predict;
mod ranking;
mod search;
mod setup;
mod statistics;
mod units;
mod verdict;

pub use parameter::{Parameter, Prior};
pub use part::{Dimension, Part};
pub use verdict::in_common;

use crate::statics::Settings;
use crate::verify::{Experiment, PointError, Row, Summary, systematic};
use crate::{Error, Robot};
use fit::Fit;
use nalgebra::{DMatrix, DVector, Vector3};
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

    fn check(&self) -> Result<(), Error> {
        self.experiment.refuse_impossible_readings()?;
        if self.folds == 1 || self.folds > self.experiment.rows.len() {
            let (folds, rows) = (self.folds, self.experiment.rows.len());
            return Err(Error::new(format!("{rows} rows in {folds} folds, expected 2 to {rows} folds")));
        }
        if self.experiment.rows.is_empty() {
            return Err(Error::new("the experiment has no rows"));
        }
        if self.parameters.is_empty() {
            return Err(Error::new("nothing is free, so that there is nothing to calibrate"));
        }
        for (j, parameter) in self.parameters.iter().enumerate() {
            let earlier = self.parameters[..j]
                .iter()
                .find(|other| other.parts.iter().any(|part| parameter.parts.contains(part)));
            if let Some(other) = earlier {
                return Err(Error::new(format!(
                    "\"{}\" and \"{}\" free the same quantity",
                    other.name, parameter.name
                )));
            }
        }
        let priors = self.parameters.iter().filter(|parameter| parameter.prior.is_some()).count();
        let (free, coordinates) = (self.parameters.len(), self.coordinates());
        if free > coordinates + priors {
            return Err(Error::new(format!(
                "{free} free parameters, but only {coordinates} measured coordinates"
            ))
            .hint("free fewer, tie some (a+b), give priors, or measure more"));
        }
        Ok(())
    }
}

/// Least squares over all measured coordinates, theory (44) to (50).
///
/// # Errors
/// A row that cannot be solved where the fit starts, with its inputs; more free parameters than coordinates; a parameter that moves
/// nothing that was measured; no convergence; a unit that is wrong by a power of ten.
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
    let found = fitted(problem, settings, watch);
    units::mistaken(problem, settings, found.as_ref().ok()).map_or(found, Err)
}

fn fitted(
    problem: &Problem,
    settings: &Settings,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Calibration, Error> {
    let experiment = &problem.experiment;
    let mut fit = Fit::new(problem, settings)?;
    let start = fit.variables(&fit.start);
    let first = fit.evaluate(&start, 1.0)?;
    let before = fit.points_at(&start)?;
    refuse_without_influence(problem, &fit, &first.jacobian)?;

    // errors are as stated until chi-square refutes them; priors and robust loss then weigh against larger ones
    let found = search::from_several_starts(&mut fit, &start, watch);
    let (mut minimum, starts) = found.map_err(|error| {
        // what the data cannot tell apart where the fit starts is the likely reason
        let held = vec![false; start.len()];
        let statistics = Statistics::new(problem, &first, &held, 1.0);
        match verdict::identifiability(problem, &statistics, &first, &fit.scale).first() {
            Some(sentence) if start.len() > 1 && statistics.is_degenerate() => error.hint(sentence.clone()),
            _ => error,
        }
    })?;
    let mut error_scale = statistics::error_scale(problem, &minimum, 1.0);
    let weighs =
        problem.loss == Loss::Huber || problem.parameters.iter().any(|parameter| parameter.prior.is_some());
    for _ in 0..MOST_REWEIGHTINGS {
        if !weighs {
            break;
        }
        minimum = fit.minimize(&minimum.x, error_scale, problem.loss, watch)?;
        let next = statistics::error_scale(problem, &minimum, error_scale);
        if (next / error_scale - 1.0).abs() < SETTLED {
            break;
        }
        error_scale = next;
    }
    let values = fit.values(&minimum.x);
    let at = fit.evaluate(&minimum.x, error_scale)?;
    let statistics = Statistics::new(problem, &at, &minimum.held, error_scale);

    let after = fit.points_at(&minimum.x)?;
    let rows: Vec<CalibratedRow> = experiment
        .rows
        .iter()
        .zip(before.iter().zip(&after))
        .map(|(row, (before, after))| CalibratedRow {
            inputs: row.inputs.clone(),
            before: experiment.differences(row, before),
            after: experiment.differences(row, after),
        })
        .collect();
    let calibrated = fit.base.with(&problem.parameters, &values);
    let robot = calibrated.turned();
    let summary = |length: f64, errors: &dyn Fn(&CalibratedRow) -> Vec<PointError>| {
        experiment.summary(length, rows.iter().flat_map(errors))
    };
    let inputs: Vec<&[f64]> = rows.iter().map(|row| row.inputs.as_slice()).collect();
    let residuals: Vec<&[PointError]> = rows.iter().map(|row| row.after.as_slice()).collect();
    let runs = systematic(experiment, &inputs, &residuals);
    let alike = neighbours::alike(experiment, &rows);
    let tests = runs
        .iter()
        .map(|found| found.is)
        .chain(alike.iter().map(|alike| alike.chance < statistics::SIGNIFICANCE));
    let follows = tests.reduce(|a, b| a || b);
    let parameters = problem.parameters.iter().enumerate().map(|(j, parameter)| {
        let standard_error = statistics.standard_error(j).map(|error| error * fit.scale[j]);
        let half = standard_error.map(|error| statistics.quantile * error);
        Estimate::new(parameter, fit.start[j], values[j], standard_error, half)
    });
    let folds = (problem.folds > 0)
        .then(|| search::fold_errors(problem, settings, &values, error_scale, watch))
        .transpose()?;
    let (folds, not_known) = match folds {
        Some(Ok(errors)) => (Some(experiment.summary(robot.length(), errors.into_iter())), None),
        Some(Err(sentence)) => (None, Some(sentence)),
        None => (None, None),
    };
    let holdout = (!problem.holdout.is_empty()).then(|| {
        let lengths = [experiment.robot.length(), robot.length()];
        held_out(problem, settings, [&fit.start, &values], lengths)
    });
    let mut calibration = Calibration {
        holdout: holdout.transpose()?,
        folds,
        starts,
        parameters: parameters.collect(),
        correlation: statistics.correlation(),
        before: summary(experiment.robot.length(), &|row| row.before.clone()),
        after: summary(robot.length(), &|row| row.after.clone()),
        robot,
        chi_square: statistics.chi_square,
        degrees_of_freedom: statistics.degrees_of_freedom,
        chance: statistics.chance,
        error_scale,
        unexplained: statistics.unexplained,
        systematic: follows,
        left_out: statistics
            .left_out(problem, &at)
            .map(|errors| experiment.summary(experiment.robot.length(), errors.into_iter().flatten())),
        rows,
        verdict: Vec::new(),
        warnings: Vec::new(),
        steps: minimum.steps,
    };
    calibration.verdict = verdict::verdict(problem, &calibration, &statistics, &at, &fit.scale);
    let narrow = alike.as_ref().and_then(|alike| verdict::narrow(alike, problem.experiment.rows.len()));
    calibration.verdict.splice(1..1, verdict::follows(runs.into_iter().next(), alike));
    calibration.warnings = verdict::warnings(problem, &calibration, &statistics, &at, &minimum.held);
    calibration.warnings.extend(narrow.into_iter().chain(not_known));
    for (j, parameter) in problem.parameters.iter().enumerate() {
        let stated = parameter.start(&fit.base)?;
        if stated != fit.start[j] {
            calibration.warnings.push(format!(
                "The file's {} = {} lies outside its bounds: the fit and \"before\" start from {}.",
                parameter.name,
                parameter.show(stated, None),
                parameter.show(fit.start[j], None)
            ));
        }
    }
    if minimum.crept {
        calibration.warnings.push(verdict::CREPT.to_owned());
    }
    Ok(calibration)
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

/// Where a fit of this problem starts: the values of the files, within their bounds, SI.
///
/// # Errors
/// A parameter that has no value, such as the stiffness of an inextensible tendon.
pub fn start(problem: &Problem) -> Result<Vec<f64>, Error> {
    Fit::new(problem, &Settings::default()).map(|fit| fit.start)
}

/// What was measured, as predicted with one parameter at `value`, SI, and all others as in the files: (coordinates).
///
/// # Errors
/// A row that cannot be solved, with its inputs.
pub fn predict(
    problem: &Problem,
    parameter: usize,
    value: f64,
    settings: &Settings,
) -> Result<DVector<f64>, Error> {
    let mut fit = Fit::new(problem, settings)?;
    let mut values = fit.start.clone();
    values[parameter] = value;
    let predicted = fit.points(&values)?;
    let points = predicted.iter().flat_map(|row| problem.experiment.points.iter().zip(row));
    let coordinates = points.flat_map(|(point, position)| point.axes.iter().map(|&axis| position[axis]));
    Ok(DVector::from_vec(coordinates.collect()))
}

/// What was measured, as predicted with the values of the files: (coordinates), and its derivatives by every parameter, SI,
/// (coordinates x parameters). Coordinates are in the order of rows, points, axes.
///
/// # Errors
/// A row that cannot be solved, with its inputs.
pub fn sensitivities(problem: &Problem, settings: &Settings) -> Result<(DVector<f64>, DMatrix<f64>), Error> {
    let mut fit = Fit::new(problem, settings)?;
    let at = fit.evaluate(&fit.variables(&fit.start), 1.0)?;
    let experiment = &problem.experiment;
    let read = experiment.rows.iter().flat_map(|row| experiment.points.iter().zip(&row.observed));
    let read = read
        .flat_map(|(point, observed)| point.axes.iter().map(|&axis| (observed[axis], point.reading_error)));
    let read: Vec<(f64, f64)> = read.collect();
    let predicted = DVector::from_fn(read.len(), |k, _| read[k].0 + read[k].1 * at.residuals[k]);
    let jacobian =
        DMatrix::from_fn(read.len(), fit.scale.len(), |k, j| read[k].1 * at.jacobian[(k, j)] / fit.scale[j]);
    Ok((predicted, jacobian))
}

/// Points of every row, bench axes: (rows x points).
pub type Points = Vec<Vec<Vector3<f64>>>;

/// What was measured, as predicted with each of many sets of values, SI, in their order.
///
/// # Errors
/// A row that cannot be solved with the values of the files; of a set alone where only that has none.
pub fn predictions(
    problem: &Problem,
    sets: &[Vec<f64>],
    settings: &Settings,
) -> Result<Vec<Result<Points, Error>>, Error> {
    fit::points_with(problem, sets, settings)
}

/// What a fit would know of its parameters.
#[derive(Clone, Debug)]
pub struct Expected {
    /// Per parameter, SI; None where the rows do not determine it.
    pub standard_errors: Vec<Option<f64>>,
    /// Half a 95 % interval over its standard error.
    pub quantile: f64,
    /// In words: which combinations the rows would not tell apart.
    pub told_apart: Vec<String>,
}

/// What a fit would know if its rows had these derivatives, SI (coordinates x parameters), and errors so many times as large as stated.
///
/// # Errors
/// As [`start`].
pub fn expected(problem: &Problem, jacobian: &DMatrix<f64>, error_scale: f64) -> Result<Expected, Error> {
    let fit = Fit::new(problem, &Settings::default())?;
    let mut at = fit.exact(jacobian, error_scale);
    // what a fit would refuse to free is not determined, and in nobody's way
    let unseen = LEAST_INFLUENCE / error_scale;
    for mut column in at.jacobian.column_iter_mut().filter(|column| column.norm() < unseen) {
        column.fill(0.0);
    }
    let statistics = Statistics::new(problem, &at, &vec![false; fit.scale.len()], error_scale);
    let error = |j: usize| statistics.standard_error(j).map(|error| error * fit.scale[j]);
    Ok(Expected {
        standard_errors: (0..fit.scale.len()).map(error).collect(),
        quantile: statistics.quantile,
        told_apart: verdict::identifiability(problem, &statistics, &at, &fit.scale),
    })
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
