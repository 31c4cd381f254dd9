//! Gauss collocation: a polynomial on [0, 1] that is zero at 0, by its values at the Gauss points.

/// Fewest and most points.
pub const FEWEST: usize = 2;
pub const MOST: usize = 10;

/// The points of one number and what the polynomial does there and at the end; rows of length `points`.
#[derive(Clone, Debug)]
pub struct Collocation {
    /// Gauss-Legendre points and weights on \[0, 1\]: exact to degree 2 points - 1.
    pub points: Vec<f64>,
    pub weights: Vec<f64>,
    /// `(points x points)`: derivative at the i-th point per value at the j-th.
    pub derivative: Vec<f64>,
    /// Value at 1 per value at the j-th.
    pub end: Vec<f64>,
    /// Coefficient of the shifted Legendre polynomial of highest degree per value at the j-th.
    pub top: Vec<f64>,
    /// Of the next lower degree.
    pub below_top: Vec<f64>,
    /// Coefficient of the Legendre polynomial of degree points - 1 per value at the j-th.
    pub top_of_rate: Vec<f64>,
    /// What the integral of the next higher Legendre polynomial, which is zero at the points, is to count for there: its values times
    /// (points + 1) / (2 points + 1), with which the weights are exact for its product with a polynomial of degree points - 1.
    pub bow: Vec<f64>,
    /// At 0, 1/2 and 1.
    pub start: Row,
    pub middle: Row,
    pub finish: Row,
    /// Weights of the integral from 0 to 1/2, exact to degree points - 1.
    pub to_middle: Vec<f64>,
    /// `(points x points)`: weights of the integral from 0 to the i-th point, of the same degree.
    pub to_point: Vec<f64>,
    /// 1 / product of the differences to the other points.
    scales: Vec<f64>,
}

/// What the values at the points contribute at one place; the first `points` entries count.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Value and slope of the polynomial that is zero at 0.
    pub value: [f64; MOST],
    pub slope: [f64; MOST],
    /// Value and slope of the polynomial of one degree less, through the points alone.
    pub inner: [f64; MOST],
    pub inner_slope: [f64; MOST],
    /// The integral of the Legendre polynomial that is zero at the points, and that polynomial.
    pub bow: f64,
    pub bow_slope: f64,
}

impl Collocation {
    pub fn new(count: usize) -> Self {
        let (points, weights) = gauss_legendre(count);
        let scale = |j: usize| -> f64 {
            let others = points.iter().enumerate().filter(|(i, _)| *i != j);
            1.0 / others.map(|(_, other)| points[j] - other).product::<f64>()
        };
        let scales: Vec<f64> = (0..count).map(scale).collect();
        // the highest coefficient in powers of t, and that of Legendre's polynomial, (2n)! / (n!)^2
        let legendre: f64 = (1..=count).map(|k| (count + k) as f64 / k as f64).product();
        let top = points.iter().zip(&scales).map(|(t, scale)| scale / t / legendre).collect();
        let below_top = points
            .iter()
            .zip(&weights)
            .map(|(t, weight)| {
                (2 * count - 1) as f64 * weight * legendre_polynomial(count - 1, 2.0 * t - 1.0).0
            })
            .collect();
        let before = |t: &f64| legendre_polynomial(count - 1, 2.0 * t - 1.0).0;
        let top_of_rate = points
            .iter()
            .zip(&weights)
            .map(|(t, weight)| (2 * count - 1) as f64 * weight * before(t))
            .collect();
        let bow = points.iter().map(|t| -before(t) / (2 * (2 * count + 1)) as f64).collect();
        let mut table = Collocation {
            points,
            weights,
            below_top,
            top_of_rate,
            bow,
            derivative: Vec::with_capacity(count * count),
            end: Vec::new(),
            top,
            start: Row::default(),
            middle: Row::default(),
            finish: Row::default(),
            to_middle: Vec::new(),
            to_point: Vec::with_capacity(count * count),
            scales,
        };
        for i in 0..count {
            let row = table.row(table.points[i]);
            table.derivative.extend(&row.slope[..count]);
        }
        [table.start, table.middle, table.finish] = [0.0, 0.5, 1.0].map(|t| table.row(t));
        table.end = table.finish.value[..count].to_vec();
        table.to_middle = table.integral_to(0.5);
        for i in 0..count {
            let to_point = table.integral_to(table.points[i]);
            table.to_point.extend(to_point);
        }
        table
    }

    /// Weights of the integral from 0 to `end` of the polynomial through the points.
    fn integral_to(&self, end: f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.points.len()];
        for (t, weight) in self.points.iter().zip(&self.weights) {
            let inner = self.row(end * t).inner;
            sums.iter_mut().zip(inner).for_each(|(sum, inner)| *sum += end * weight * inner);
        }
        sums
    }

    /// Lagrange's polynomials through the points alone at `t`, as [`Row::inner`].
    pub fn inner(&self, t: f64) -> [f64; MOST] {
        let mut inner = [0.0; MOST];
        let mut product = 1.0;
        for ((part, point), scale) in inner.iter_mut().zip(&self.points).zip(&self.scales) {
            *part = scale * product;
            product *= t - point;
        }
        product = 1.0;
        for (part, point) in inner.iter_mut().zip(&self.points).rev() {
            *part *= product;
            product *= t - point;
        }
        inner
    }

    /// Lagrange's polynomials at `t`.
    pub fn row(&self, t: f64) -> Row {
        let count = self.points.len();
        // products of t - point and their slopes, over the points before and from each on
        let (mut before, mut from) = ([(1.0, 0.0); MOST + 1], [(1.0, 0.0); MOST + 1]);
        for j in 0..count {
            let (product, slope) = before[j];
            before[j + 1] = (product * (t - self.points[j]), slope * (t - self.points[j]) + product);
        }
        for j in (0..count).rev() {
            let (product, slope) = from[j + 1];
            from[j] = (product * (t - self.points[j]), slope * (t - self.points[j]) + product);
        }
        let mut row = Row::default();
        for j in 0..count {
            let ((a, a_slope), (b, b_slope)) = (before[j], from[j + 1]);
            let (inner, slope) = (self.scales[j] * a * b, self.scales[j] * (a_slope * b + a * b_slope));
            (row.inner[j], row.inner_slope[j]) = (inner, slope);
            row.value[j] = inner * t / self.points[j];
            row.slope[j] = (inner + t * slope) / self.points[j];
        }
        let (after, legendre) = legendre_polynomial(count + 1, 2.0 * t - 1.0);
        let before = legendre_polynomial(count, 2.0 * t - 1.0).1;
        (row.bow, row.bow_slope) = ((after - before) / (2 * (2 * count + 1)) as f64, legendre);
        row
    }
}

/// Legendre's polynomial of a degree on [-1, 1], and that of one degree less.
fn legendre_polynomial(degree: usize, x: f64) -> (f64, f64) {
    let (mut p, mut before) = (1.0, 0.0);
    for k in 0..degree {
        let k = k as f64;
        (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
    }
    (p, before)
}

/// Gauss-Legendre points and weights on [0, 1] by Newton's method on Legendre's polynomial.
fn gauss_legendre(count: usize) -> (Vec<f64>, Vec<f64>) {
    let n = count as f64;
    let (mut points, mut weights) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for i in (0..count).rev() {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (p, before) = legendre_polynomial(count, x);
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        points.push(0.5 * (1.0 + x));
        weights.push(1.0 / ((1.0 - x * x) * slope * slope));
    }
    (points, weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_exact_to_degree_two_points_minus_one() {
        for count in FEWEST..=MOST {
            let c = Collocation::new(count);
            let degree = 2 * count as i32 - 1;
            let integral: f64 = c.points.iter().zip(&c.weights).map(|(t, w)| w * t.powi(degree)).sum();
            assert!((integral - 1.0 / f64::from(degree + 1)).abs() < 1e-15, "{count}");
            let degree = count as i32 - 1;
            let half: f64 = c.points.iter().zip(&c.to_middle).map(|(t, w)| w * t.powi(degree)).sum();
            assert!((half - 0.5_f64.powi(degree + 1) / f64::from(degree + 1)).abs() < 1e-15, "{count}");
            assert!(c.points.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }

    #[test]
    fn the_two_highest_coefficients_are_those_of_legendre() {
        for count in FEWEST..=MOST {
            let c = Collocation::new(count);
            let values = c.points.iter().map(|t| {
                let (p, before) = legendre_polynomial(count, 2.0 * t - 1.0);
                3.0 * (p + before)
            });
            let values: Vec<f64> = values.collect();
            for row in [&c.top, &c.below_top] {
                let found: f64 = row.iter().zip(&values).map(|(a, b)| a * b).sum();
                assert!((found - 3.0).abs() < 1e-11, "{count} points: {found}");
            }
        }
    }

    #[test]
    fn the_bow_is_the_integral_of_the_next_polynomial() {
        for count in FEWEST..MOST {
            let c = Collocation::new(count);
            let fine = Collocation::new(MOST);
            for t in [0.2, 0.7, 1.0] {
                let of = |point: &f64| legendre_polynomial(count, 2.0 * t * point - 1.0).0;
                let integral: f64 = fine.points.iter().zip(&fine.weights).map(|(p, w)| t * w * of(p)).sum();
                assert!((c.row(t).bow - integral).abs() < 1e-14, "{count} points at {t}");
            }
            // its product with a polynomial of degree points - 1, exact and by the points alone
            let degree = count as i32 - 1;
            let exact = fine.points.iter().zip(&fine.weights);
            let exact: f64 = exact.map(|(t, w)| w * c.row(*t).bow * t.powi(degree)).sum();
            let by_points = c.points.iter().zip(&c.weights).zip(&c.bow);
            let by_points: f64 = by_points.map(|((t, w), bow)| w * bow * t.powi(degree)).sum();
            assert!((exact - by_points).abs() < 1e-15, "{count}: {exact} {by_points}");
        }
    }

    #[test]
    fn derivative_and_end_are_exact_for_polynomials_that_are_zero_at_zero() {
        for count in FEWEST..=MOST {
            let c = Collocation::new(count);
            let degree = count as i32;
            let values: Vec<f64> = c.points.iter().map(|t| t.powi(degree) - 2.0 * t).collect();
            let dot = |row: &[f64]| -> f64 { row.iter().zip(&values).map(|(a, b)| a * b).sum() };
            assert!((dot(&c.end) + 1.0).abs() < 1e-11);
            for (i, t) in c.points.iter().enumerate() {
                let slope = f64::from(degree) * t.powi(degree - 1) - 2.0;
                assert!((dot(&c.derivative[i * count..(i + 1) * count]) - slope).abs() < 1e-11);
            }
        }
    }
}
