//! Anderson's acceleration of a fixed-point iteration: for a linear map the residuals of GMRES.
//!
//! H. F. Walker, P. Ni, "Anderson acceleration for fixed-point iterations", SIAM Journal on Numerical Analysis 49(4), 2011.

use nalgebra::{DMatrix, DVector};

/// Differences that are kept.
const DEPTH: usize = 6;
/// Directions whose singular value is smaller than this part of the largest are left out.
const SMALLEST: f64 = 1e-10;

/// The last iterates of `x = g(x)`.
#[derive(Clone, Debug, Default)]
pub struct Anderson {
    last: Option<(DVector<f64>, DVector<f64>)>,
    /// Differences of g and of the residual g - x.
    images: Vec<DVector<f64>>,
    residuals: Vec<DVector<f64>>,
}

impl Anderson {
    /// The next iterate after `x` with its image: the one whose residual would vanish if the map were linear between the last ones.
    pub fn next(&mut self, x: &[f64], image: &[f64]) -> Vec<f64> {
        let image = DVector::from_column_slice(image);
        let residual = &image - DVector::from_column_slice(x);
        if let Some((last_image, last_residual)) = self.last.take() {
            if self.images.len() == DEPTH {
                self.images.remove(0);
                self.residuals.remove(0);
            }
            self.images.push(&image - last_image);
            self.residuals.push(&residual - last_residual);
        }
        let mut next = image.clone();
        if !self.residuals.is_empty() {
            let svd = DMatrix::from_columns(&self.residuals).svd(true, true);
            let smallest = SMALLEST * svd.singular_values.max();
            if let Ok(parts) = svd.solve(&residual, smallest) {
                for (part, difference) in parts.iter().zip(&self.images) {
                    next.axpy(-part, difference, 1.0);
                }
            }
        }
        self.last = Some((image, residual));
        next.as_slice().to_vec()
    }

    /// Forgets all, where the map has led astray.
    pub fn restart(&mut self) {
        *self = Anderson::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear map that stretches: the plain iteration diverges, four unknowns take five images.
    #[test]
    fn a_linear_map_is_solved_in_as_many_steps_as_unknowns() {
        let a =
            DMatrix::from_fn(4, 4, |i, j| ((3 * i + 5 * j) as f64).sin() - if i == j { 1.5 } else { 0.0 });
        let b = DVector::from_vec(vec![1.0, -2.0, 0.5, 0.7]);
        let (mut anderson, mut x) = (Anderson::default(), vec![0.0; 4]);
        let image = |x: &[f64]| &a * DVector::from_column_slice(x) + &b;
        for _ in 0..5 {
            x = anderson.next(&x, image(&x).as_slice());
        }
        assert!((image(&x) - DVector::from_column_slice(&x)).norm() < 1e-10);
    }
}
