//! Residuals of all rows, and the fit.

use super::predict::{Predicted, Trial, points_of};
use super::setup::Setup;
use super::{Loss, Points, Problem, Progress};
use crate::Error;
use crate::numeric::least_squares::{self, Evaluation, Minimum};
use crate::statics::{self, Workspace};
use crate::verify::Experiment;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Error of a solution over the smallest reading error: far below what any step of the fit changes.
const TOLERANCE: f64 = 1e-4;
/// Of the length; less is lost to rounding.
const FINEST: f64 = 1e-10;
/// Part of the cost that a last step would still take away: a thousandth of a standard error of any parameter, at most.
const CONVERGED: f64 = 1e-10;
/// A cost, in squares of reading errors, that nobody sees.
const NEGLIGIBLE: f64 = 1e-12;
/// Factor by which a step may change what must stay above 0: derivatives tell nothing of a rod without stiffness.
const MOST_GROWTH: f64 = 4.0;
/// Trial values without equilibrium after which a fit gives up.
const MOST_FAILURES: usize = 30;

/// A problem with what its solution needs again and again.
#[derive(Clone)]
pub(super) struct Fit<'a> {
    pub(super) problem: &'a Problem,
    pub(super) base: Setup,
    /// SI, per parameter: where the files are, and a change that matters.
    pub(super) start: Vec<f64>,
    pub(super) scale: Vec<f64>,
    settings: statics::Settings,
    /// One per row, each with its last solution.
    workspaces: Vec<Workspace>,
    /// Rows that weigh nothing.
    ignored: Range<usize>,
    /// What the watcher is told.
    pub(super) stage: String,
    evaluations: usize,
    /// Where it was evaluated last.
    last: Option<Evaluated>,
}

/// Everything at one place, with reading errors as stated.
#[derive(Clone)]
struct Evaluated {
    x: DVector<f64>,
    at: Evaluation,
    /// (rows x points), bench axes; no points of rows that weigh nothing.
    points: Points,
}

/// A row and its solution; None of one that was not asked.
type Solved = Option<(Predicted, Workspace)>;

impl<'a> Fit<'a> {
    pub(super) fn new(problem: &'a Problem, settings: &statics::Settings) -> Result<Fit<'a>, Error> {
        let experiment = &problem.experiment;
        let base = Setup::new(experiment);
        let start = problem.parameters.iter().map(|parameter| {
            let value = parameter.start(&base)?;
            let [low, high] = parameter.bounds;
            Ok(if parameter.bounded { value.clamp(low, high) } else { value })
        });
        let start = start.collect::<Result<Vec<f64>, Error>>()?;
        let scale = problem
            .parameters
            .iter()
            .zip(&start)
            .map(|(parameter, &value)| parameter.parts[0].scale(experiment, value));
        let scale = scale.collect();
        let finest = experiment.points.iter().map(|point| point.reading_error).fold(f64::INFINITY, f64::min);
        let wanted = (TOLERANCE * finest / experiment.robot.length()).max(FINEST);
        let tolerance = settings.tolerance.min(wanted);
        let settings = statics::Settings { stations: 0, eigenvalue: false, tolerance, ..settings.clone() };
        let workspaces = vec![Workspace::default(); experiment.rows.len()];
        let (stage, evaluations, last) = ("fit".to_owned(), 0, None);
        Ok(Fit { problem, base, start, scale, settings, workspaces, ignored: 0..0, stage, evaluations, last })
    }

    /// The same with rows that weigh nothing.
    pub(super) fn ignoring(self, rows: Range<usize>) -> Fit<'a> {
        Fit { ignored: rows, last: None, ..self }
    }

    /// In SI, of variables in units of their scale.
    pub(super) fn values(&self, x: &DVector<f64>) -> Vec<f64> {
        x.iter().zip(&self.scale).map(|(x, scale)| x * scale).collect()
    }

    pub(super) fn variables(&self, values: &[f64]) -> DVector<f64> {
        DVector::from_iterator(
            values.len(),
            values.iter().zip(&self.scale).map(|(value, scale)| value / scale),
        )
    }

    /// Residuals over reading errors, so many times as large as stated, of every coordinate, then of the priors; theory (44).
    pub(super) fn evaluate(&mut self, x: &DVector<f64>, error_scale: f64) -> Result<Evaluation, Error> {
        let mut at = self.evaluated(x)?.at.clone();
        let measured = self.problem.coordinates();
        at.residuals.rows_mut(0, measured).unscale_mut(error_scale);
        at.jacobian.rows_mut(0, measured).unscale_mut(error_scale);
        Ok(at)
    }

    /// Points of every row there, bench axes.
    pub(super) fn points_at(&mut self, x: &DVector<f64>) -> Result<Points, Error> {
        self.evaluated(x).map(|found| found.points.clone())
    }

    /// Solves and differentiates every row, unless that was what it did last.
    fn evaluated(&mut self, x: &DVector<f64>) -> Result<&Evaluated, Error> {
        let known = self.last.take().filter(|last| last.x == *x);
        let found = known.map_or_else(|| self.solve(x), Ok)?;
        Ok(self.last.insert(found))
    }

    /// Starts from the last solutions; where a row has none, that of the first such row is the error, and they stay.
    fn solve(&mut self, x: &DVector<f64>) -> Result<Evaluated, Error> {
        let values = self.values(x);
        let Fit { problem, base, scale, settings, workspaces, ignored, .. } = &*self;
        let experiment = &problem.experiment;
        let trial = Trial::new(experiment, &problem.parameters, base, &values, scale);
        let first_failed = AtomicUsize::new(usize::MAX);
        let row = |(row, last): (usize, &Workspace)| -> Result<Solved, Error> {
            // rows after a failed one decide nothing
            if ignored.contains(&row) || first_failed.load(Ordering::Relaxed) < row {
                return Ok(None);
            }
            let mut workspace = last.clone();
            let predicted = trial.row(row, settings, &mut workspace);
            predicted.map(|predicted| Some((predicted, workspace))).map_err(|error| {
                first_failed.fetch_min(row, Ordering::Relaxed);
                in_row(experiment, row, error)
            })
        };
        let rows: Vec<Result<Solved, Error>> = workspaces.par_iter().enumerate().map(row).collect();
        self.evaluations += 1;
        let rows = rows.into_iter().collect::<Result<Vec<Solved>, Error>>()?;
        let mut predicted = Vec::with_capacity(rows.len());
        for (workspace, row) in self.workspaces.iter_mut().zip(rows) {
            predicted.push(row.map(|(predicted, reached)| {
                *workspace = reached;
                predicted
            }));
        }
        let at = self.compared(&predicted, &values);
        let points = predicted.into_iter().map(|row| row.map(|row| row.points).unwrap_or_default());
        Ok(Evaluated { x: x.clone(), at, points: points.collect() })
    }

    /// Predictions against readings and values against priors.
    fn compared(&self, predicted: &[Option<Predicted>], values: &[f64]) -> Evaluation {
        let Problem { experiment, parameters, .. } = self.problem;
        let priors = parameters.iter().filter(|parameter| parameter.prior.is_some()).count();
        let coordinates = self.problem.coordinates();
        let mut residuals = DVector::zeros(coordinates + priors);
        let mut jacobian = DMatrix::zeros(coordinates + priors, parameters.len());
        let mut k = 0;
        for (row, predicted) in experiment.rows.iter().zip(predicted) {
            let Some(predicted) = predicted else {
                k += coordinates / experiment.rows.len();
                continue;
            };
            for (i, point) in experiment.points.iter().enumerate() {
                for &axis in &point.axes {
                    residuals[k] = (predicted.points[i][axis] - row.observed[i][axis]) / point.reading_error;
                    for j in 0..parameters.len() {
                        jacobian[(k, j)] = predicted.derivatives[j][i][axis] / point.reading_error;
                    }
                    k += 1;
                }
            }
        }
        for (j, parameter) in parameters.iter().enumerate() {
            if let Some(prior) = parameter.prior {
                residuals[k] = (values[j] - prior.value) / prior.standard_error;
                jacobian[(k, j)] = self.scale[j] / prior.standard_error;
                k += 1;
            }
        }
        Evaluation { residuals, jacobian }
    }

    /// No residuals, with given derivatives, SI (coordinates x parameters), and those of the priors.
    pub(super) fn exact(&self, jacobian: &DMatrix<f64>, error_scale: f64) -> Evaluation {
        let points = &self.problem.experiment.points;
        let per_row: Vec<f64> =
            points.iter().flat_map(|point| point.axes.iter().map(|_| point.reading_error)).collect();
        let scaled = |k: usize, j: usize| {
            jacobian[(k, j)] * self.scale[j] / (per_row[k % per_row.len()] * error_scale)
        };
        let measured = DMatrix::from_fn(jacobian.nrows(), self.scale.len(), scaled);
        let priors: Vec<(usize, f64)> = (0..self.scale.len())
            .filter_map(|j| Some((j, self.scale[j] / self.problem.parameters[j].prior?.standard_error)))
            .collect();
        let mut all = measured.insert_rows(jacobian.nrows(), priors.len(), 0.0);
        for (k, (j, weight)) in priors.into_iter().enumerate() {
            all[(jacobian.nrows() + k, j)] = weight;
        }
        Evaluation { residuals: DVector::zeros(all.nrows()), jacobian: all }
    }

    /// The best values with reading errors so many times as large as stated.
    pub(super) fn minimize(
        &mut self,
        from: &DVector<f64>,
        error_scale: f64,
        loss: Loss,
        watch: &mut dyn FnMut(&Progress),
    ) -> Result<Minimum, Error> {
        let bounds = self.problem.parameters.iter().zip(&self.scale);
        let bounds: Vec<[f64; 2]> =
            bounds.map(|(parameter, scale)| parameter.bounds.map(|bound| bound / scale)).collect();
        let loss = match loss {
            Loss::Squares => least_squares::Loss::Squares,
            Loss::Huber => least_squares::Loss::Huber { threshold: super::HUBER_THRESHOLD },
        };
        let settings = least_squares::Settings {
            tolerance: CONVERGED,
            negligible: NEGLIGIBLE,
            most_growth: MOST_GROWTH,
            most_failures: MOST_FAILURES,
            ..Default::default()
        };
        let per_row = self.problem.coordinates() / self.problem.experiment.rows.len();
        let unseen = self.ignored.len() * per_row;
        least_squares::minimize(from, &bounds, loss, &settings, &mut |x| {
            let at = self.evaluate(x, error_scale)?;
            let counted = (at.residuals.len() - unseen) as f64;
            let residual = at.residuals.norm() * error_scale / counted.sqrt();
            watch(&Progress { stage: self.stage.clone(), evaluations: self.evaluations, residual });
            Ok(at)
        })
    }

    /// Points of every row with these values, bench axes.
    pub(super) fn points(&mut self, values: &[f64]) -> Result<Points, Error> {
        let setup = self.base.with(&self.problem.parameters, values);
        let experiment = &self.problem.experiment;
        let (mounted, acting) = (setup.mounted(experiment), setup.acting(experiment));
        let rows = self.workspaces.par_iter_mut().zip(&acting).enumerate();
        let points = rows.map(|(row, (workspace, acting))| {
            let robot = experiment.robot_in(&mounted, acting);
            statics::solve_near(&robot, &self.settings, workspace)
                .and_then(|_| points_of(experiment, &setup, &robot, workspace))
                .map_err(|error| in_row(experiment, row, error))
        });
        let points: Vec<_> = points.collect();
        points.into_iter().collect()
    }
}

/// Points of every row with each of many sets of values, each from the same start, so that no set depends on another.
pub(super) fn points_with(
    problem: &Problem,
    sets: &[Vec<f64>],
    settings: &statics::Settings,
) -> Result<Vec<Result<Points, Error>>, Error> {
    let mut start = Fit::new(problem, settings)?;
    let values = start.start.clone();
    start.points(&values)?;
    Ok(sets.par_iter().map(|values| start.clone().points(values)).collect())
}

fn in_row(experiment: &Experiment, row: usize, error: Error) -> Error {
    error.within(&format!("row {} ({})", row + 1, experiment.inputs_of(&experiment.rows[row])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::{CalibrationFlags, builtin};

    /// The rod without a mass has a shape with an offset that is no number, the others have none.
    #[test]
    fn a_refused_trial_leaves_nothing_behind() {
        let free = vec!["youngs_modulus,mass_offset".to_owned()];
        let flags = CalibrationFlags { free, ..CalibrationFlags::default() };
        let mut problem = builtin::calibration(&flags).expect("is valid").value;
        problem.experiment.rows[0].inputs[0] = 0.0;
        let new = || Fit::new(&problem, &statics::Settings::default()).expect("is valid");
        let (mut refused, mut straight) = (new(), new());
        let start = straight.variables(&straight.start);
        let with = |factor: f64, offset: f64| DVector::from_vec(vec![factor * start[0], offset]);
        for fit in [&mut refused, &mut straight] {
            fit.evaluate(&start, 1.0).expect("solves");
        }
        let error = refused.evaluate(&with(0.5, f64::NAN), 1.0).expect_err("has no shape");
        assert!(error.message().starts_with("row 2 (mass "), "{error}");
        let [a, b] =
            [&mut refused, &mut straight].map(|fit| fit.evaluate(&with(1.1, 0.0), 1.0).expect("solves"));
        assert_eq!((a.residuals, a.jacobian), (b.residuals, b.jacobian));
    }
}
