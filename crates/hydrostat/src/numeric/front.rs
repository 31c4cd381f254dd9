//! Partial Gaussian elimination of a dense matrix: the frontal step of a block elimination.

/// Eliminates the first `pivots` unknowns of the square `matrix` (row-major, `size` x `size`) in place, without exchanges:
/// L below the diagonal, U on and above, and what is left for the other unknowns in the last rows and columns. Returns the
/// number of negative pivots, for a symmetric matrix the number of negative eigenvalues of the eliminated block; None where
/// a pivot vanishes.
pub fn eliminate(matrix: &mut [f64], size: usize, pivots: usize) -> Option<usize> {
    let mut negative = 0;
    for p in 0..pivots {
        let (above, below) = matrix.split_at_mut((p + 1) * size);
        let row = &above[p * size..];
        let pivot = row[p];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        negative += usize::from(pivot < 0.0);
        let inverse = 1.0 / pivot;
        for other in below.chunks_exact_mut(size) {
            let factor = other[p] * inverse;
            other[p] = factor;
            if factor != 0.0 {
                for (entry, top) in other[p + 1..].iter_mut().zip(&row[p + 1..]) {
                    *entry -= factor * top;
                }
            }
        }
    }
    Some(negative)
}

/// Carries a right-hand side through [`eliminate`]: afterwards its last entries are those of what is left.
pub fn forward(matrix: &[f64], size: usize, pivots: usize, right: &mut [f64]) {
    for p in 0..pivots {
        let value = right[p];
        for i in p + 1..size {
            right[i] -= matrix[i * size + p] * value;
        }
    }
}

/// Finds the eliminated unknowns: on entry the first entries of `x` are those of the right-hand side after [`forward`], the others are known.
pub fn backward(matrix: &[f64], size: usize, pivots: usize, x: &mut [f64]) {
    for p in (0..pivots).rev() {
        let row = &matrix[p * size..(p + 1) * size];
        let known: f64 = row[p + 1..].iter().zip(&x[p + 1..]).map(|(a, b)| a * b).sum();
        x[p] = (x[p] - known) / row[p];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn partial_elimination_solves_and_counts_negative_eigenvalues() {
        let (size, pivots) = (6, 4);
        let full = DMatrix::from_fn(size, size, |i, j| {
            let (i, j) = (i.min(j) as f64, i.max(j) as f64);
            (1.3 * i + 0.7 * j * j).sin() + if i == j { 1.5 - i } else { 0.0 }
        });
        let right = DVector::from_fn(size, |i, _| (i as f64).cos());
        let mut front: Vec<f64> = full.transpose().iter().copied().collect();
        let negative = eliminate(&mut front, size, pivots).expect("no pivot is zero");
        let block = full.view((0, 0), (pivots, pivots)).into_owned();
        assert_eq!(negative, block.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count());
        // finish with the rest
        let mut x: Vec<f64> = right.iter().copied().collect();
        forward(&front, size, pivots, &mut x);
        let rest = DMatrix::from_fn(2, 2, |i, j| front[(pivots + i) * size + pivots + j]);
        let solved = rest.lu().solve(&DVector::from_column_slice(&x[pivots..])).expect("is regular");
        x[pivots..].copy_from_slice(solved.as_slice());
        backward(&front, size, pivots, &mut x);
        assert!((full * DVector::from_vec(x) - right).norm() < 1e-12);
    }
}
