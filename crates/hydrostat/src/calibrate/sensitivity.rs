//! What was measured as the model predicts it, how that answers parameters, and what a fit to it would know.

use super::fit::{self, Fit};
use super::statistics::Statistics;
use super::{LEAST_INFLUENCE, Parameter, Problem, verdict};
use crate::Error;
use crate::statics::Settings;
use nalgebra::{DMatrix, DVector, DVectorView, Vector3};

/// Where a fit of this problem starts: the values of the files, within the bounds that the user gives, SI.
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
    /// Half a 95 % interval over its standard error; None where errors larger than stated are known from no degree of freedom.
    pub quantile: Option<f64>,
    /// In words: which combinations the rows would not tell apart.
    pub told_apart: Vec<String>,
}

/// What a fit would know if its rows had these derivatives, SI (coordinates x parameters), and errors so many times as large as stated.
///
/// # Errors
/// As [`start`].
pub fn expected(problem: &Problem, jacobian: &DMatrix<f64>, error_scale: f64) -> Result<Expected, Error> {
    let fit = Fit::new(problem, &Settings::default())?;
    let at = fit.exact(jacobian, error_scale);
    // what a fit would refuse to free is not determined, and in nobody's way
    let unseen = |(parameter, column): (&Parameter, DVectorView<f64>)| {
        parameter.prior.is_none() && column.norm() < LEAST_INFLUENCE / error_scale
    };
    let held: Vec<bool> = problem.parameters.iter().zip(at.jacobian.column_iter()).map(unseen).collect();
    let statistics = Statistics::new(problem, &at, &held, error_scale);
    let error = |j: usize| statistics.standard_error(j).map(|error| error * fit.scale[j]);
    Ok(Expected {
        standard_errors: (0..fit.scale.len()).map(error).collect(),
        quantile: statistics.quantile,
        told_apart: verdict::identifiability(problem, &statistics, &at, &fit.scale),
    })
}
