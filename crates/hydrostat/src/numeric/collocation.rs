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
}

impl Collocation {
    pub fn new(count: usize) -> Self {
        let (points, weights) = gauss_legendre(count);
        // Lagrange's polynomials on 0 and the points
        let nodes: Vec<f64> = std::iter::once(0.0).chain(points.iter().copied()).collect();
        let mut derivative = Vec::with_capacity(count * count);
        for at in &points {
            derivative.extend((1..=count).map(|j| lagrange(&nodes, j, *at).1));
        }
        let end = (1..=count).map(|j| lagrange(&nodes, j, 1.0).0).collect();
        Collocation { points, weights, derivative, end }
    }

    /// Value and derivative at `t` of the polynomial that is 1 at the j-th point.
    pub fn basis(&self, j: usize, t: f64) -> (f64, f64) {
        let nodes: Vec<f64> = std::iter::once(0.0).chain(self.points.iter().copied()).collect();
        lagrange(&nodes, j + 1, t)
    }

    /// The polynomial of one degree less, 1 at the j-th point and 0 at the others, at `t`.
    pub fn inner(&self, j: usize, t: f64) -> f64 {
        lagrange(&self.points, j, t).0
    }

    /// Its derivative.
    pub fn inner_slope(&self, j: usize, t: f64) -> f64 {
        lagrange(&self.points, j, t).1
    }
}

/// The j-th Lagrange polynomial on `nodes` and its derivative at `t`.
fn lagrange(nodes: &[f64], j: usize, t: f64) -> (f64, f64) {
    let others = || nodes.iter().enumerate().filter(|(i, _)| *i != j).map(|(_, node)| *node);
    let scale: f64 = others().map(|node| nodes[j] - node).product();
    let value: f64 = others().map(|node| t - node).product();
    let slope: f64 = (0..nodes.len())
        .filter(|&left_out| left_out != j)
        .map(|left_out| -> f64 {
            let factors = nodes.iter().enumerate().filter(|(i, _)| *i != j && *i != left_out);
            factors.map(|(_, node)| t - node).product()
        })
        .sum();
    (value / scale, slope / scale)
}

/// Gauss-Legendre points and weights on [0, 1] by Newton's method on Legendre's polynomial.
fn gauss_legendre(count: usize) -> (Vec<f64>, Vec<f64>) {
    let n = count as f64;
    let (mut points, mut weights) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for i in (0..count).rev() {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut p, mut before) = (1.0, 0.0);
            for k in 0..count {
                let k = k as f64;
                (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
            }
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
            assert!(c.points.windows(2).all(|pair| pair[0] < pair[1]));
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
