//! How sure the fitted values are.

use super::{HUBER_THRESHOLD, Loss, Problem};
use crate::numeric::least_squares::{Evaluation, Minimum};
use crate::verify::{Experiment, Point, PointError, Row};
use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// Below this chance, chi-square refutes the stated reading errors, and an outlier or a run is none of chance.
pub(super) const SIGNIFICANCE: f64 = 0.05;
/// Two-sided 95 % point of the normal distribution.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Standard deviation over median of the absolute values, of the normal distribution.
const MEDIAN_TO_DEVIATION: f64 = 1.482_602_218_505_602;
/// Part of the largest eigenvalue of the scaled normal matrix that the differences of its columns' rounding leave.
const SINGULAR: f64 = 1e-9;
/// Part of the largest eigenvalue at which a correlation is about 0.999.
const DEGENERATE: f64 = 1e-3;
/// Root of the part of a direction's information below which the other rows do not see it.
const LEAST_PIVOT: f64 = 1e-4;
/// Part of all residuals below which the spread of the others is rounding.
const LEAST_SPREAD: f64 = 1e-6;
/// Part of a singular direction that spoils a parameter.
const INVOLVED: f64 = 1e-6;

/// What the derivatives at the optimum say; variables in units of their scale.
pub(super) struct Statistics {
    /// (J^T J)^-1 of what is determined (parameters x parameters).
    inverse: DMatrix<f64>,
    /// Directions that are determined, of one standard error each (parameters x directions).
    basis: DMatrix<f64>,
    /// Covariance over the inverse.
    inflation: f64,
    /// Errors over the stated reading errors.
    error_scale: f64,
    determined: Vec<bool>,
    /// Of the normal matrix with columns of length one: theory (47); ascending, of those that are not held.
    pub(super) eigen: Vec<(f64, DVector<f64>)>,
    /// Norm of every column of the Jacobian.
    pub(super) norms: Vec<f64>,
    /// Half an interval over its standard error; None where no degree of freedom tells larger errors.
    pub(super) quantile: Option<f64>,
    pub(super) chi_square: f64,
    pub(super) degrees_of_freedom: usize,
    pub(super) chance: Option<f64>,
    pub(super) unexplained: f64,
    /// Diagonal of the hat matrix.
    leverage: Vec<f64>,
}

/// By how much the reading errors are too small, theory (46): 1 unless chi-square refutes them. Priors have no say in it: one that
/// contradicts the data would excuse itself.
pub(super) fn error_scale(problem: &Problem, minimum: &Minimum, used: f64) -> f64 {
    let (residuals, freedom) = without_priors(problem, minimum);
    let residuals = residuals * used;
    let stated = residuals.norm_squared();
    if freedom == 0 || chance(stated, freedom) >= SIGNIFICANCE {
        return 1.0;
    }
    let scale = match problem.loss {
        Loss::Squares => (stated / freedom as f64).sqrt(),
        Loss::Huber => {
            let count = residuals.len();
            let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            let median = 0.5 * (sizes[(count - 1) / 2] + sizes[count / 2]);
            MEDIAN_TO_DEVIATION * median * (count as f64 / freedom as f64).sqrt()
        }
    };
    scale.max(1.0)
}

/// Residuals of what was measured where a fit without priors would end, to first order, and their degrees of freedom.
fn without_priors(problem: &Problem, minimum: &Minimum) -> (DVector<f64>, usize) {
    let coordinates = problem.coordinates();
    let residuals = minimum.at.residuals.rows(0, coordinates).into_owned();
    let free: Vec<usize> = (0..minimum.held.len()).filter(|&j| !minimum.held[j]).collect();
    if free.is_empty() || problem.parameters.iter().all(|parameter| parameter.prior.is_none()) {
        return (residuals, coordinates.saturating_sub(free.len()));
    }
    let jacobian = minimum.at.jacobian.rows(0, coordinates).select_columns(&free);
    let norms: Vec<f64> = jacobian.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)).collect();
    let unit = DMatrix::from_fn(coordinates, free.len(), |k, j| jacobian[(k, j)] / norms[j]);
    let weighted =
        DMatrix::from_fn(coordinates, free.len(), |k, j| weight(problem.loss, residuals[k]) * unit[(k, j)]);
    let pull = weighted.tr_mul(&residuals);
    let found = SymmetricEigen::new(weighted.tr_mul(&unit));
    let least = SINGULAR * found.eigenvalues.max();
    let mut step = DVector::zeros(free.len());
    let mut rank = 0;
    for (value, direction) in found.eigenvalues.iter().zip(found.eigenvectors.column_iter()) {
        if *value > least {
            step -= direction * (direction.dot(&pull) / value);
            rank += 1;
        }
    }
    (residuals + unit * step, coordinates.saturating_sub(rank))
}

/// With the stated errors, of residuals over `used` times those.
fn chi_square_with(problem: &Problem, residuals: &DVector<f64>, used: f64) -> f64 {
    let coordinates = problem.coordinates();
    let of = |(k, r): (usize, &f64)| if k < coordinates { (r * used).powi(2) } else { r * r };
    residuals.iter().enumerate().map(of).sum()
}

/// Chance of a chi-square at least so large.
fn chance(chi_square: f64, degrees_of_freedom: usize) -> f64 {
    ChiSquared::new(degrees_of_freedom as f64).map_or(f64::NAN, |distribution| distribution.sf(chi_square))
}

/// Student's distribution; two-sided 95 % point.
fn student_95(degrees_of_freedom: usize) -> f64 {
    let distribution = StudentsT::new(0.0, 1.0, degrees_of_freedom as f64);
    distribution.map_or(f64::NAN, |distribution| distribution.inverse_cdf(0.975))
}

impl Statistics {
    /// `at` with the errors scaled.
    pub(super) fn new(problem: &Problem, at: &Evaluation, held: &[bool], error_scale: f64) -> Statistics {
        let count = held.len();
        let index: Vec<usize> = (0..count).filter(|&j| !held[j]).collect();
        let norms: Vec<f64> = at.jacobian.column_iter().map(|column| column.norm()).collect();
        let unit = DMatrix::from_fn(at.jacobian.nrows(), index.len(), |i, k| {
            at.jacobian[(i, index[k])] / norms[index[k]].max(f64::MIN_POSITIVE)
        });

        // theory (45) and (47): eigenvalues tell what is determined, the rest is inverted
        // nothing is left where every parameter lies on a bound
        let found = (!index.is_empty()).then(|| SymmetricEigen::new(unit.tr_mul(&unit)));
        let pairs = found.iter().flat_map(|found| {
            let vectors = found.eigenvectors.column_iter().map(|column| column.into_owned());
            found.eigenvalues.iter().copied().zip(vectors)
        });
        let pairs: Vec<(f64, DVector<f64>)> = pairs.collect();
        let largest = pairs.iter().map(|(value, _)| *value).fold(0.0, f64::max);
        let mut eigen: Vec<(f64, DVector<f64>)> = Vec::new();
        let mut columns: Vec<DVector<f64>> = Vec::new();
        let mut determined: Vec<bool> = held.iter().map(|held| !held).collect();
        for (value, direction) in pairs {
            let mut vector = DVector::zeros(count);
            for (&j, part) in index.iter().zip(&direction) {
                vector[j] = *part;
            }
            if value <= SINGULAR * largest {
                for j in 0..count {
                    determined[j] &= vector[j].powi(2) < INVOLVED;
                }
            } else {
                let of = |j: usize| vector[j] / norms[j].max(f64::MIN_POSITIVE) / value.sqrt();
                columns.push(DVector::from_fn(count, |j, _| of(j)));
            }
            eigen.push((value.max(0.0), vector));
        }
        eigen.sort_by(|a, b| a.0.total_cmp(&b.0));
        let basis = DMatrix::from_fn(count, columns.len(), |j, k| columns[k][j]);
        let inverse = &basis * basis.transpose();
        let leverage = at.jacobian.row_iter().map(|row| (row * &inverse).dot(&row)).collect();

        let coordinates = problem.coordinates();
        let degrees_of_freedom = at.residuals.len().saturating_sub(index.len());
        let chi_square = chi_square_with(problem, &at.residuals, error_scale);
        let estimated = error_scale > 1.0;
        Statistics {
            inverse,
            basis,
            inflation: huber_factor(problem, at, index.len()),
            error_scale,
            determined,
            eigen,
            norms,
            quantile: match degrees_of_freedom {
                0 if estimated => None,
                freedom if estimated => Some(student_95(freedom)),
                _ => Some(NORMAL_95),
            },
            chi_square,
            degrees_of_freedom,
            chance: (degrees_of_freedom > 0).then(|| chance(chi_square, degrees_of_freedom)),
            unexplained: unexplained(
                problem,
                &at.residuals.rows(0, coordinates).into(),
                error_scale,
                degrees_of_freedom,
            ),
            leverage,
        }
    }

    /// None where the data do not determine it.
    pub(super) fn standard_error(&self, j: usize) -> Option<f64> {
        self.determined[j].then(|| (self.inflation * self.inverse[(j, j)]).sqrt())
    }

    pub(super) fn correlation(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.determined.len(), self.determined.len(), |i, j| match () {
            () if !(self.determined[i] && self.determined[j]) => f64::NAN,
            () if i == j => 1.0,
            () => self.inverse[(i, j)] / (self.inverse[(i, i)] * self.inverse[(j, j)]).sqrt(),
        })
    }

    /// Correlation of a parameter with the best combination of all others; 1 where it is not determined.
    pub(super) fn multiple_correlation(&self, j: usize) -> f64 {
        if !self.determined[j] {
            return 1.0;
        }
        let inflation: f64 =
            self.eigen.iter().filter(|(value, _)| *value > 0.0).map(|(value, v)| v[j].powi(2) / value).sum();
        (1.0 - 1.0 / inflation.max(1.0)).sqrt()
    }

    /// Whether some direction is hardly seen.
    pub(super) fn is_degenerate(&self) -> bool {
        let values = self.eigen.iter().map(|(value, _)| *value);
        let (low, high) =
            values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        low <= DEGENERATE * high
    }

    /// Whether a direction cannot be seen at all.
    pub(super) fn is_singular(&self, value: f64) -> bool {
        value <= SINGULAR * self.eigen.last().map_or(1.0, |(largest, _)| *largest)
    }

    /// Errors of every row as predicted by the fit to all other rows, to first order, theory (48).
    pub(super) fn left_out(&self, problem: &Problem, at: &Evaluation) -> Option<Vec<Vec<PointError>>> {
        let experiment = &problem.experiment;
        let per_row = problem.coordinates() / experiment.rows.len();
        // in the basis the normal matrix of squares is one
        let jacobian = &at.jacobian * &self.basis;
        let mut curved = jacobian.clone();
        for (mut row, r) in curved.row_iter_mut().zip(&at.residuals) {
            row *= curvature_of_loss(problem.loss, *r);
        }
        let normal = curved.tr_mul(&jacobian);
        let off = |number: usize| -> Option<DVector<f64>> {
            let own = jacobian.rows(number * per_row, per_row);
            let residuals = at.residuals.rows(number * per_row, per_row);
            let pull = residuals.map(|r| r * weight(problem.loss, r));
            let others = (&normal - curved.rows(number * per_row, per_row).tr_mul(&own)).cholesky()?;
            // the row alone determines something
            if others.l_dirty().diagonal().iter().any(|pivot| *pivot < LEAST_PIVOT) {
                return None;
            }
            Some(residuals + own * others.solve(&own.tr_mul(&pull)))
        };
        let rows = experiment.rows.iter().enumerate();
        rows.map(|(number, row)| Some(self.as_errors(experiment, row, &off(number)?))).collect()
    }

    /// Errors of a row from its residuals.
    fn as_errors(&self, experiment: &Experiment, row: &Row, off: &DVector<f64>) -> Vec<PointError> {
        let mut off = off.iter();
        let points = experiment.points.iter().zip(&row.observed);
        let error = |(point, observed): (&Point, &Vector3<f64>)| {
            let mut away = Vector3::zeros();
            for (&axis, off) in point.axes.iter().zip(&mut off) {
                away[axis] = off * point.reading_error * self.error_scale;
            }
            let predicted = observed + away;
            PointError { at: point.at, predicted, observed: *observed, error: away.norm() }
        };
        points.map(error).collect()
    }

    /// Coordinates that lie off by more than chance allows among so many, theory (49): index, standard errors off.
    pub(super) fn outliers(&self, problem: &Problem, at: &Evaluation) -> Vec<(usize, f64)> {
        let coordinates = problem.coordinates();
        if self.degrees_of_freedom < 3 {
            return Vec::new();
        }
        let rest = self.degrees_of_freedom - 1;
        let Ok(distribution) = StudentsT::new(0.0, 1.0, rest as f64) else { return Vec::new() };
        let squares = at.residuals.norm_squared();
        // deleted residuals: each against the spread of all others
        let off = |k: usize| {
            let own = at.residuals[k].powi(2) / (1.0 - self.leverage[k]).max(1e-9);
            let spread = match problem.loss {
                Loss::Squares => ((squares - own) / rest as f64).max(0.0).sqrt(),
                // the errors' scale is that of the bulk already
                Loss::Huber => 1.0,
            };
            own.sqrt() / spread.max(LEAST_SPREAD * squares.sqrt()).max(f64::MIN_POSITIVE)
        };
        (0..coordinates)
            .map(|k| (k, off(k)))
            .filter(|(_, off)| 2.0 * distribution.sf(*off) * (coordinates as f64) < SIGNIFICANCE)
            .collect()
    }
}

/// How a residual pulls, over itself.
fn weight(loss: Loss, residual: f64) -> f64 {
    match loss {
        Loss::Huber if residual.abs() > HUBER_THRESHOLD => HUBER_THRESHOLD / residual.abs(),
        _ => 1.0,
    }
}

/// Half the second derivative of the loss.
fn curvature_of_loss(loss: Loss, residual: f64) -> f64 {
    match loss {
        Loss::Huber if residual.abs() > HUBER_THRESHOLD => 0.0,
        _ => 1.0,
    }
}

/// Loss of efficiency and spread of Huber's estimate over those of squares (Huber 1981, section 7.6).
fn huber_factor(problem: &Problem, at: &Evaluation, free: usize) -> f64 {
    if problem.loss == Loss::Squares {
        return 1.0;
    }
    let n = at.residuals.len() as f64;
    let inside = at.residuals.iter().filter(|r| r.abs() <= HUBER_THRESHOLD).count() as f64 / n;
    let spread: f64 = at.residuals.iter().map(|r| r.abs().min(HUBER_THRESHOLD).powi(2)).sum();
    let correction = 1.0 + free as f64 / n * (1.0 - inside) / inside.max(1.0 / n);
    let variance = spread / (n - free as f64).max(1.0) / inside.max(1.0 / n).powi(2);
    // never surer than the reading error allows
    (correction.powi(2) * variance).max(1.0)
}

/// Root of the mean square per coordinate beyond the reading error, m.
fn unexplained(
    problem: &Problem,
    residuals: &DVector<f64>,
    error_scale: f64,
    degrees_of_freedom: usize,
) -> f64 {
    let points = &problem.experiment.points;
    let per_row: Vec<f64> =
        points.iter().flat_map(|point| point.axes.iter().map(|_| point.reading_error)).collect();
    let errors = per_row.iter().cycle();
    let (mut squares, mut read) = (0.0, 0.0);
    for (r, error) in residuals.iter().zip(errors) {
        squares += (r * error * error_scale).powi(2);
        read += error.powi(2);
    }
    let n = residuals.len() as f64;
    (squares / (degrees_of_freedom as f64).clamp(1.0, n) - read / n).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz & Stegun, tables 26.8 and 26.10.
    #[test]
    fn distributions_agree_with_their_tables() {
        for (n, point) in [(2, 5.99146), (10, 18.3070), (100, 124.342)] {
            assert!((chance(point, n) - 0.05).abs() < 1e-6, "{n}");
        }
        for (n, point) in [(1, 12.706), (5, 2.571), (20, 2.086), (120, 1.980)] {
            assert!((student_95(n) - point).abs() < 5e-4, "{n}: {}", student_95(n));
        }
    }
}
