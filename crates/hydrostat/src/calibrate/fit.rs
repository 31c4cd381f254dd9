//! Predictions of every row with their sensitivities, and the fit.

use super::parameter::{Part, Setup};
use super::{Loss, Parameter, Problem};
use crate::Error;
use crate::model::Robot;
use crate::numeric::least_squares::{self, Evaluation, Minimum};
use crate::statics::{self, Input, Workspace};
use crate::verify::{Experiment, Row};
use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

/// Step of a difference at a fixed shape, of the parameter's scale.
const STEP: f64 = 1e-4;
/// Of the length: what a solution leaves must be far below what a step of the fit changes.
const TOLERANCE: f64 = 1e-10;
/// A cost, in squares of reading errors, that nobody sees.
const NEGLIGIBLE: f64 = 1e-12;

/// A problem with what its solution needs again and again.
pub(super) struct Fit<'a> {
    pub(super) problem: &'a Problem,
    pub(super) base: Setup,
    /// SI, per parameter: where the files are, and a change that matters.
    pub(super) start: Vec<f64>,
    pub(super) scale: Vec<f64>,
    settings: statics::Settings,
    /// One per row, each with its last solution.
    workspaces: Vec<Workspace>,
}

/// Points of one row, bench axes, and their derivatives by every parameter, per its scale.
struct Predicted {
    points: Vec<Vector3<f64>>,
    /// (parameters x points)
    derivatives: Vec<Vec<Vector3<f64>>>,
}

impl<'a> Fit<'a> {
    pub(super) fn new(problem: &'a Problem, settings: &statics::Settings) -> Result<Fit<'a>, Error> {
        let experiment = &problem.experiment;
        let base = Setup::new(experiment);
        let start = problem.parameters.iter().map(|parameter| {
            let value = parameter.start(&base)?;
            let outside = value < parameter.bounds[0] || value > parameter.bounds[1];
            Ok(if outside { parameter.bounds[0].max(parameter.bounds[1].min(value)) } else { value })
        });
        let start = start.collect::<Result<Vec<f64>, Error>>()?;
        let scale = problem
            .parameters
            .iter()
            .zip(&start)
            .map(|(parameter, &value)| parameter.parts[0].scale(experiment, value));
        let scale = scale.collect();
        let tolerance = settings.tolerance.min(TOLERANCE);
        let settings = statics::Settings { stations: 0, eigenvalue: false, tolerance, ..settings.clone() };
        let workspaces = vec![Workspace::default(); experiment.rows.len()];
        Ok(Fit { problem, base, start, scale, settings, workspaces })
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

    /// Residuals over reading errors of every coordinate, then of the priors; theory (44).
    pub(super) fn evaluate(&mut self, x: &DVector<f64>, error_scale: f64) -> Result<Evaluation, Error> {
        let values = self.values(x);
        let Fit { problem, base, scale, settings, workspaces, .. } = self;
        let (experiment, parameters) = (&problem.experiment, &problem.parameters);
        let row = |(workspace, (number, row)): (&mut Workspace, (usize, &Row))| {
            predict(experiment, parameters, base, &values, scale, settings, row, workspace)
                .map_err(|error| error.within(&format!("row {} ({})", number + 1, experiment.inputs_of(row))))
        };
        let rows: Vec<_> = experiment.rows.iter().enumerate().collect();
        let predicted = workspaces.par_iter_mut().zip(rows).map(row).collect::<Vec<_>>();
        let predicted = predicted.into_iter().collect::<Result<Vec<Predicted>, Error>>()?;

        let priors = parameters.iter().filter(|parameter| parameter.prior.is_some()).count();
        let coordinates = problem.coordinates();
        let mut residuals = DVector::zeros(coordinates + priors);
        let mut jacobian = DMatrix::zeros(coordinates + priors, parameters.len());
        let mut k = 0;
        for (row, predicted) in experiment.rows.iter().zip(&predicted) {
            for (i, point) in experiment.points.iter().enumerate() {
                let error = point.reading_error * error_scale;
                for &axis in &point.axes {
                    residuals[k] = (predicted.points[i][axis] - row.observed[i][axis]) / error;
                    for j in 0..parameters.len() {
                        jacobian[(k, j)] = predicted.derivatives[j][i][axis] / error;
                    }
                    k += 1;
                }
            }
        }
        for (j, parameter) in parameters.iter().enumerate() {
            if let Some(prior) = parameter.prior {
                residuals[k] = (values[j] - prior.value) / prior.standard_error;
                jacobian[(k, j)] = scale[j] / prior.standard_error;
                k += 1;
            }
        }
        Ok(Evaluation { residuals, jacobian })
    }

    /// The best values with reading errors so many times as large as stated.
    pub(super) fn minimize(
        &mut self,
        from: &DVector<f64>,
        error_scale: f64,
        loss: Loss,
    ) -> Result<Minimum, Error> {
        let bounds = self.problem.parameters.iter().zip(&self.scale);
        let bounds: Vec<[f64; 2]> =
            bounds.map(|(parameter, scale)| parameter.bounds.map(|bound| bound / scale)).collect();
        let loss = match loss {
            Loss::Squares => least_squares::Loss::Squares,
            Loss::Huber => least_squares::Loss::Huber { threshold: super::HUBER_THRESHOLD },
        };
        let settings = least_squares::Settings { negligible: NEGLIGIBLE, ..Default::default() };
        least_squares::minimize(from, &bounds, loss, &settings, &mut |x| self.evaluate(x, error_scale))
    }

    /// Points of every row with these values, bench axes.
    pub(super) fn points(&mut self, values: &[f64]) -> Result<Vec<Vec<Vector3<f64>>>, Error> {
        let setup = self.base.with(&self.problem.parameters, values);
        let experiment = &self.problem.experiment;
        let rows = experiment.rows.iter().zip(&mut self.workspaces).enumerate();
        rows.map(|(number, (row, workspace))| {
            let robot = setup.robot_in(experiment, row);
            statics::solve_near(&robot, &self.settings, workspace)
                .and_then(|_| points_of(experiment, &setup, &robot, workspace))
                .map_err(|error| error.within(&format!("row {} ({})", number + 1, experiment.inputs_of(row))))
        })
        .collect()
    }
}

/// Marked points of the solution in the workspace, bench axes.
fn points_of(
    experiment: &Experiment,
    setup: &Setup,
    robot: &Robot,
    workspace: &Workspace,
) -> Result<Vec<Vector3<f64>>, Error> {
    let points = experiment.points.iter().zip(&setup.marker_offsets);
    points
        .map(|(point, offset)| {
            let station = workspace.station(robot, experiment.place(point.at, robot));
            let station = station
                .ok_or_else(|| Error::new(format!("no point at s = {} m on this backbone", point.at)))?;
            Ok(experiment.to_bench(&(station.position + station.rotation * offset)))
        })
        .collect()
}

/// Solves a row and differentiates it, theory (38) to (42).
#[allow(clippy::too_many_arguments, reason = "a row of a larger computation")]
fn predict(
    experiment: &Experiment,
    parameters: &[Parameter],
    base: &Setup,
    values: &[f64],
    scale: &[f64],
    settings: &statics::Settings,
    row: &Row,
    workspace: &mut Workspace,
) -> Result<Predicted, Error> {
    let setup = base.with(parameters, values);
    let robot = setup.robot_in(experiment, row);
    statics::solve_near(&robot, settings, workspace)?;
    let points = points_of(experiment, &setup, &robot, workspace)?;
    let places: Vec<f64> = experiment.points.iter().map(|point| experiment.place(point.at, &robot)).collect();
    let offset_in_world = |workspace: &Workspace, i: usize, offset: &Vector3<f64>| {
        workspace.station(&robot, places[i]).map_or_else(Vector3::zeros, |station| station.rotation * offset)
    };

    // the robot a little before and behind each parameter, at a fixed shape
    let beside = |j: usize| -> Option<[Robot; 2]> {
        if matches!(parameters[j].parts[0], Part::MarkerOffset { .. }) {
            return None;
        }
        // where a value may not be negative the difference moves inside
        let step = STEP * scale[j];
        let middle = values[j].max(parameters[j].parts[0].lowest_possible() + step);
        Some([-step, step].map(|change| {
            let mut values = values.to_vec();
            values[j] = middle + change;
            base.with(parameters, &values).robot_in(experiment, row)
        }))
    };
    let sides: Vec<Option<[Robot; 2]>> = (0..parameters.len()).map(beside).collect();
    let inputs: Vec<Input> = sides
        .iter()
        .flatten()
        .map(|[behind, ahead]| Input::Parameter { behind, ahead, step: STEP })
        .collect();
    let mut found = statics::derivatives(&robot, workspace, &places, &inputs)?.into_iter();
    let derivatives = parameters.iter().zip(&sides).zip(scale).map(|((parameter, sides), scale)| {
        let inverse = experiment.axes.rotation.inverse();
        let Some(derivative) = sides.as_ref().and_then(|_| found.next()) else {
            let moved = |i: usize| {
                let along = parameter.parts.iter().filter_map(|part| match *part {
                    Part::MarkerOffset { point, axis } if point == i => Some(Vector3::ith(axis, *scale)),
                    _ => None,
                });
                inverse * offset_in_world(workspace, i, &along.sum())
            };
            return (0..places.len()).map(moved).collect();
        };
        let poses = derivative.poses.iter().enumerate();
        let moved = poses.map(|(i, pose)| {
            let offset = offset_in_world(workspace, i, &setup.marker_offsets[i]);
            inverse * (pose.position + pose.rotation.cross(&offset))
        });
        moved.collect()
    });
    let derivatives = derivatives.collect();
    Ok(Predicted { points, derivatives })
}
