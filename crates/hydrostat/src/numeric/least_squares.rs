//! Nonlinear least squares between bounds: the method of Levenberg and Marquardt, projected.
//!
//! Own code: the crate `levenberg-marquardt` has neither bounds nor a robust loss, and follows another nalgebra.

use crate::Error;
use nalgebra::{DMatrix, DVector};

/// Residuals and their derivatives at a point, (n) and (n x p).
#[derive(Clone, Debug)]
pub struct Evaluation {
    pub residuals: DVector<f64>,
    pub jacobian: DMatrix<f64>,
}

/// How a residual counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Loss {
    /// r^2
    #[default]
    Squares,
    /// r^2 up to the threshold k, 2 k |r| - k^2 beyond (Huber 1964).
    Huber { threshold: f64 },
}

#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub most_steps: usize,
    /// Ends when a step promises less than this part of the cost.
    pub tolerance: f64,
    /// Ends when a step promises less than this cost.
    pub negligible: f64,
    /// Largest factor by which a step changes a variable whose lower bound is above 0.
    pub most_growth: f64,
    /// Trials without an evaluation that end the search.
    pub most_failures: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            most_steps: 200,
            tolerance: 1e-16,
            negligible: 0.0,
            most_growth: f64::INFINITY,
            most_failures: 100,
        }
    }
}

/// A point from which no step between the bounds goes down.
#[derive(Clone, Debug)]
pub struct Minimum {
    pub x: DVector<f64>,
    pub at: Evaluation,
    /// Variables that lie on a bound and would go beyond it.
    pub held: Vec<bool>,
    pub steps: usize,
    /// Whether it ended on the floor of a valley, not at its lowest point.
    pub crept: bool,
}

/// Damping at the start, and where no smaller step can help.
const FIRST_DAMPING: f64 = 1e-3;
const MOST_DAMPING: f64 = 1e12;
/// Part of the promised decrease below which a step is refused.
const LEAST_GAIN: f64 = 1e-4;
/// A search that stalls above this part of the cost has not converged.
const STALLED: f64 = 1e-6;
/// One that gains less than that in so many steps creeps along the floor of a valley: regular ones need five to ten in all.
const CREEPING: usize = 20;

impl Loss {
    /// Weight of a residual in the normal equations.
    pub fn weight(self, residual: f64) -> f64 {
        match self {
            Loss::Huber { threshold } if residual.abs() > threshold => threshold / residual.abs(),
            _ => 1.0,
        }
    }

    fn cost(self, residuals: &DVector<f64>) -> f64 {
        let of = |r: f64| match self {
            Loss::Huber { threshold } if r.abs() > threshold => threshold * (2.0 * r.abs() - threshold),
            _ => r * r,
        };
        residuals.iter().map(|&r| of(r)).sum()
    }

    /// J^T W J and J^T W r.
    fn normal_equations(self, at: &Evaluation) -> (DMatrix<f64>, DVector<f64>) {
        let mut weighted = at.jacobian.clone();
        for (mut row, &r) in weighted.row_iter_mut().zip(&at.residuals) {
            row *= self.weight(r);
        }
        (weighted.tr_mul(&at.jacobian), weighted.tr_mul(&at.residuals))
    }
}

/// Goes down from `start`, theory (44) and (45). Where `evaluate` fails on the way, a shorter step is tried.
///
/// # Errors
/// Of `evaluate` at the start, or no convergence.
pub fn minimize(
    start: &DVector<f64>,
    bounds: &[[f64; 2]],
    loss: Loss,
    settings: &Settings,
    evaluate: &mut dyn FnMut(&DVector<f64>) -> Result<Evaluation, Error>,
) -> Result<Minimum, Error> {
    let clamped = |x: &DVector<f64>| DVector::from_fn(x.len(), |i, _| x[i].clamp(bounds[i][0], bounds[i][1]));
    let near = |from: &DVector<f64>, x: &DVector<f64>| {
        let growth = settings.most_growth;
        let of =
            |i: usize| if bounds[i][0] > 0.0 { x[i].clamp(from[i] / growth, from[i] * growth) } else { x[i] };
        DVector::from_fn(x.len(), |i, _| of(i))
    };
    let mut x = clamped(start);
    let mut failures = 0;
    let mut at = evaluate(&x)?;
    let mut cost = loss.cost(&at.residuals);
    let mut scale = DVector::<f64>::zeros(x.len());
    let (mut damping, mut growth) = (FIRST_DAMPING, 2.0);
    let mut earlier = cost;
    for steps in 0..settings.most_steps {
        let (normal, gradient) = loss.normal_equations(&at);
        scale.zip_apply(&normal.diagonal(), |scale, n| *scale = scale.max(n));
        let held: Vec<bool> = (0..x.len())
            .map(|i| {
                (x[i] <= bounds[i][0] && gradient[i] > 0.0) || (x[i] >= bounds[i][1] && gradient[i] < 0.0)
            })
            .collect();
        if steps % CREEPING == CREEPING - 1 {
            if earlier - cost <= STALLED * cost {
                return Ok(Minimum { x, at, held, steps, crept: true });
            }
            earlier = cost;
        }
        let promise = |step: &DVector<f64>| -(2.0 * gradient.dot(step) + step.dot(&(&normal * step)));
        let little = settings.tolerance * cost + settings.negligible;
        // the longest step that goes down as promised
        loop {
            let whole = damped_step(&normal, &gradient, &scale, &held, damping);
            let trial = clamped(&near(&x, &(&x + &whole)));
            let promised = promise(&(&trial - &x));
            // one that is cut need not go down where a shorter one does
            if promised <= little && promise(&whole) <= little {
                return Ok(Minimum { x, at, held, steps, crept: false });
            }
            let found = (promised > little).then(|| evaluate(&trial));
            if let Some(Err(error)) = &found {
                failures += 1;
                if failures >= settings.most_failures {
                    return Err(without_solution(failures, error));
                }
            }
            let found = found.and_then(Result::ok).map(|found| (loss.cost(&found.residuals), found));
            let gain = found.as_ref().map_or(-1.0, |(new, _)| (cost - new) / promised);
            if let Some((new, found)) = found.filter(|_| gain > LEAST_GAIN) {
                (x, at, cost) = (trial, found, new);
                damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
                growth = 2.0;
                break;
            }
            damping *= growth;
            growth *= 2.0;
            if damping >= MOST_DAMPING {
                if promised <= STALLED * cost {
                    return Ok(Minimum { x, at, held, steps, crept: false });
                }
                return Err(Error::new("the fit has stalled: no step along its gradient goes down")
                    .hint("start from values nearer to the truth, or give bounds"));
            }
        }
    }
    Err(Error::new(format!("the fit has not converged in {} steps", settings.most_steps))
        .hint("start from values nearer to the truth, or give bounds or priors"))
}

fn without_solution(failures: usize, last: &Error) -> Error {
    Error::new(format!(
        "the fit has not converged: {failures} sets of trial values have no solution, the last with {}",
        last.message()
    ))
    .hint("free fewer parameters, or give bounds or priors that keep the values possible")
}

/// (N + damping diag N) step = -gradient of the variables that are not held.
fn damped_step(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    scale: &DVector<f64>,
    held: &[bool],
    damping: f64,
) -> DVector<f64> {
    let free: Vec<usize> = (0..held.len()).filter(|&i| !held[i] && scale[i] > 0.0).collect();
    let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| {
        let damped = if i == j { damping * scale[free[i]] } else { 0.0 };
        normal[(free[i], free[j])] + damped
    });
    let right = DVector::from_fn(free.len(), |i, _| -gradient[free[i]]);
    let mut step = DVector::zeros(held.len());
    // without a factor the matrix is singular to rounding: the diagonal alone goes down as well
    let solved = matrix.cholesky().map(|factor| factor.solve(&right));
    for (k, &i) in free.iter().enumerate() {
        step[i] = solved.as_ref().map_or_else(|| right[k] / (scale[i] * (1.0 + damping)), |solved| solved[k]);
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    type Model = fn(&[f64], f64) -> (f64, Vec<f64>);

    fn fit(data: &[(f64, f64)], model: Model, start: &[f64], bounds: &[[f64; 2]], loss: Loss) -> Minimum {
        let mut evaluate = |b: &DVector<f64>| {
            let rows: Vec<_> = data.iter().map(|&(y, x)| (y, model(b.as_slice(), x))).collect();
            let residuals = DVector::from_iterator(rows.len(), rows.iter().map(|(y, (f, _))| f - y));
            let jacobian = DMatrix::from_fn(rows.len(), b.len(), |i, j| rows[i].1.1[j]);
            Ok(Evaluation { residuals, jacobian })
        };
        let start = DVector::from_column_slice(start);
        minimize(&start, bounds, loss, &Settings::default(), &mut evaluate).expect("converges")
    }

    /// Values and standard deviations as certified, to the digits that double precision leaves.
    fn certified(name: &str, minimum: &Minimum, values: &[(f64, f64)], squares: f64) {
        const DIGITS: f64 = 1e-7;
        let at = &minimum.at;
        let found = at.residuals.norm_squared();
        assert!((found / squares - 1.0).abs() < DIGITS, "{name}: sum of squares {found}");
        let variance = found / (at.residuals.len() - values.len()) as f64;
        let covariance = at.jacobian.tr_mul(&at.jacobian).try_inverse().expect("is regular") * variance;
        for (i, (value, deviation)) in values.iter().enumerate() {
            assert!((minimum.x[i] / value - 1.0).abs() < DIGITS, "{name} b{}: {}", i + 1, minimum.x[i]);
            let found = covariance[(i, i)].sqrt();
            assert!((found / deviation - 1.0).abs() < 1e-5, "{name} sd {}: {found}", i + 1);
        }
    }

    /// NIST StRD, Misra1a: y = b1 (1 - exp(-b2 x)).
    #[test]
    fn misra1a() {
        let data = [
            (10.07, 77.6),
            (14.73, 114.9),
            (17.94, 141.1),
            (23.93, 190.8),
            (29.61, 239.9),
            (35.18, 289.0),
            (40.02, 332.8),
            (44.82, 378.4),
            (50.76, 434.8),
            (55.05, 477.3),
            (61.01, 536.8),
            (66.40, 593.1),
            (75.47, 689.1),
            (81.78, 760.0),
        ];
        let model: Model = |b, x| {
            let decay = (-b[1] * x).exp();
            (b[0] * (1.0 - decay), vec![1.0 - decay, b[0] * x * decay])
        };
        let values = [(2.389_421_291_8e2, 2.707_007_524_1), (5.501_564_318_1e-4, 7.266_868_843_6e-6)];
        for start in [[500.0, 1e-4], [250.0, 5e-4]] {
            let minimum = fit(&data, model, &start, &[FREE; 2], Loss::Squares);
            certified("Misra1a", &minimum, &values, 0.124_551_388_94);
        }
    }

    /// NIST StRD, Rat43: y = b1 / (1 + exp(b2 - b3 x))^(1/b4), of higher difficulty.
    #[test]
    fn rat43() {
        let y = [
            16.08, 33.83, 65.80, 97.20, 191.55, 326.20, 386.87, 520.53, 590.03, 651.92, 724.93, 699.56,
            689.96, 637.56, 717.41,
        ];
        let data: Vec<(f64, f64)> = y.iter().enumerate().map(|(i, &y)| (y, i as f64 + 1.0)).collect();
        let model: Model = |b, x| {
            let e = (b[1] - b[2] * x).exp();
            let power = (1.0 + e).powf(-1.0 / b[3]);
            let along = -b[0] * power * e / ((1.0 + e) * b[3]);
            (b[0] * power, vec![power, along, -x * along, b[0] * power * (1.0 + e).ln() / b[3].powi(2)])
        };
        let values = [
            (6.996_415_127_0e2, 1.630_229_781_7e1),
            (5.277_125_302_5, 2.082_873_582_9),
            (7.596_293_832_9e-1, 1.956_612_345_1e-1),
            (1.279_248_385_9, 6.876_193_638_5e-1),
        ];
        for start in [[100.0, 10.0, 1.0, 1.0], [700.0, 5.0, 0.75, 1.3]] {
            let minimum = fit(&data, model, &start, &[FREE; 4], Loss::Squares);
            certified("Rat43", &minimum, &values, 8.786_404_908_0e3);
        }
    }

    const LINE: Model = |b, x| (b[0] + b[1] * x, vec![1.0, x]);

    /// y = x at four points between bounds: with slope 1/2 the best offset is the mean of x/2.
    #[test]
    fn bounds_hold_and_the_rest_is_best() {
        let data: Vec<(f64, f64)> = (0..4).map(|i| (f64::from(i), f64::from(i))).collect();
        let minimum = fit(&data, LINE, &[0.0, 0.0], &[FREE, [-1.0, 0.5]], Loss::Squares);
        assert!((minimum.x[1] - 0.5).abs() < 1e-15 && (minimum.x[0] - 0.75).abs() < 1e-9, "{}", minimum.x);
        assert_eq!(minimum.held, [false, true]);
    }

    /// Along the floor of a valley, which a bound crosses: cut there, the first steps go up its side.
    #[test]
    fn a_step_that_is_cut_uphill_is_shortened() {
        let data = [(2.0, 0.0), (0.1, 1.0)];
        let model: Model = |b, x| match x {
            0.0 => (b[0] + b[1], vec![1.0, 1.0]),
            _ => (1e-3 * (b[0] - b[1]), vec![1e-3, -1e-3]),
        };
        let minimum = fit(&data, model, &[1.0, 1.0], &[FREE, [0.0, f64::INFINITY]], Loss::Squares);
        // of b0 alone: (b0 - 2) + 1e-6 (b0 - 100) = 0
        let best = (2.0 + 1e-4) / (1.0 + 1e-6);
        assert!(minimum.x[1] == 0.0 && (minimum.x[0] - best).abs() < 1e-9, "{}", minimum.x);
    }

    /// exp(b) = 1e6 from b = 1e-3, where a full step would go to 1e6.
    #[test]
    fn growth_is_limited() {
        let mut largest = 0.0_f64;
        let mut evaluate = |x: &DVector<f64>| {
            largest = largest.max(x[0]);
            Ok(Evaluation {
                residuals: DVector::from_element(1, x[0].exp() - 1e6),
                jacobian: DMatrix::from_element(1, 1, x[0].exp()),
            })
        };
        let settings = Settings { most_growth: 4.0, negligible: 1e-12, ..Settings::default() };
        let start = DVector::from_element(1, 1e-3);
        let bounds = [[f64::MIN_POSITIVE, f64::INFINITY]];
        let minimum = minimize(&start, &bounds, Loss::Squares, &settings, &mut evaluate).expect("converges");
        assert!((minimum.x[0] - 1e6_f64.ln()).abs() < 1e-9, "{}", minimum.x);
        assert!(largest < 4.0 * 1e6_f64.ln(), "{largest}");
    }

    #[test]
    fn trials_without_solution_come_to_an_end() {
        let mut trials = 0;
        let mut evaluate = |x: &DVector<f64>| {
            trials += 1;
            if trials > 1 {
                return Err(Error::new("no shape"));
            }
            Ok(Evaluation { residuals: x.clone(), jacobian: DMatrix::from_element(1, 1, 1.0) })
        };
        let start = DVector::from_element(1, 1.0);
        let settings = Settings { most_failures: 3, ..Settings::default() };
        let error = minimize(&start, &[FREE], Loss::Squares, &settings, &mut evaluate).expect_err("ends");
        assert!(
            error.message().contains("3 sets of trial values have no solution, the last with no shape"),
            "{error}"
        );
        assert_eq!(trials, 4);
    }

    /// One wild reading among equal ones: the location m solves (n-1) (m - 0) = k.
    #[test]
    fn huber_limits_the_pull_of_an_outlier() {
        let data = [(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (1e3, 0.0)];
        let model: Model = |b, _| (b[0], vec![1.0]);
        let minimum = fit(&data, model, &[50.0], &[FREE], Loss::Huber { threshold: 2.0 });
        assert!((minimum.x[0] - 0.5).abs() < 1e-6, "{}", minimum.x);
    }

    #[test]
    fn a_failure_on_the_way_shortens_the_step_and_one_at_the_start_is_an_error() {
        // sqrt(x) = 1 from 9: the first full step would end below zero
        let mut evaluate = |x: &DVector<f64>| {
            if x[0] <= 0.0 {
                return Err(Error::new("no root"));
            }
            Ok(Evaluation {
                residuals: DVector::from_element(1, x[0].sqrt() - 1.0),
                jacobian: DMatrix::from_element(1, 1, 0.5 / x[0].sqrt()),
            })
        };
        let mut from = |x| {
            let start = DVector::from_element(1, x);
            let settings = Settings { negligible: 1e-24, ..Settings::default() };
            minimize(&start, &[FREE], Loss::Squares, &settings, &mut evaluate)
        };
        assert!((from(9.0).expect("converges").x[0] - 1.0).abs() < 1e-9);
        assert!(from(-1.0).is_err());
    }
}
