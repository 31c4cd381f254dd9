//! Partial Gaussian elimination of a matrix of 3 x 3 blocks: the frontal step of a block elimination.

use nalgebra::{Matrix3, Vector3};

/// A square matrix of blocks, row by row. Of a symmetric one the blocks on and above the diagonal count.
pub struct Front<'a> {
    pub blocks: &'a mut [Matrix3<f64>],
    /// Blocks a side.
    pub size: usize,
    pub symmetric: bool,
}

impl Front<'_> {
    /// Adds `scale` times a block on or above the diagonal.
    #[inline(always)]
    pub fn add(&mut self, row: usize, column: usize, scale: f64, block: &Matrix3<f64>) {
        self.blocks[row * self.size + column] += scale * block;
    }

    /// Adds an off-diagonal block, and the one across the diagonal where the matrix is not symmetric.
    #[inline(always)]
    pub fn add_pair(
        &mut self,
        row: usize,
        column: usize,
        scale: f64,
        block: &Matrix3<f64>,
        across: impl FnOnce() -> Matrix3<f64>,
    ) {
        self.add(row, column, scale, block);
        if !self.symmetric {
            self.add(column, row, scale, &across());
        }
    }

    /// Eliminates the first `pivots` blocks of unknowns in place, without exchanges: the inverse of each pivot on the
    /// diagonal, its row of U beside it and its column of L below, and what is left for the other unknowns in the last rows
    /// and columns. Returns the number of negative scalar pivots, for a symmetric matrix the number of negative eigenvalues
    /// of the eliminated block; None where a pivot vanishes.
    pub fn eliminate(&mut self, pivots: usize) -> Option<usize> {
        let size = self.size;
        let mut negative = 0;
        for p in 0..pivots {
            let (above, below) = self.blocks.split_at_mut((p + 1) * size);
            let row = &mut above[p * size..];
            let pivot = if self.symmetric { symmetric(&row[p]) } else { row[p] };
            let (inverse, below_zero) = invert(&pivot)?;
            negative += below_zero;
            row[p] = inverse;
            for (i, other) in (p + 1..size).zip(below.chunks_exact_mut(size)) {
                let (factor, first) =
                    if self.symmetric { (row[i].tr_mul(&inverse), i) } else { (other[p] * inverse, p + 1) };
                other[p] = factor;
                for (entry, top) in other[first..].iter_mut().zip(&row[first..]) {
                    subtract_product(entry, &factor, top);
                }
            }
        }
        if self.symmetric {
            // what rounding leaves of an antisymmetric part would grow from one elimination to the next
            for i in pivots..size {
                self.blocks[i * size + i] = symmetric(&self.blocks[i * size + i]);
            }
        }
        Some(negative)
    }
}

/// `entry -= a b`. A call of its own: inlined into loops over blocks, the compiler makes vectors across blocks, which is slower.
#[inline(never)]
fn subtract_product(entry: &mut Matrix3<f64>, a: &Matrix3<f64>, b: &Matrix3<f64>) {
    let [a0, a1, a2] = &a.data.0;
    let less = |c: &[f64; 3], [x, y, z]: &[f64; 3]| {
        let at = |i: usize| c[i] - (a0[i] * x + a1[i] * y + a2[i] * z);
        [at(0), at(1), at(2)]
    };
    let (c, b) = (&entry.data.0, &b.data.0);
    entry.data.0 = [less(&c[0], &b[0]), less(&c[1], &b[1]), less(&c[2], &b[2])];
}

/// Carries a right-hand side through [`Front::eliminate`]: afterwards its last entries are those of what is left.
pub fn forward(blocks: &[Matrix3<f64>], size: usize, pivots: usize, right: &mut [Vector3<f64>]) {
    for (i, row) in blocks.chunks_exact(size).enumerate().skip(1) {
        let (known, rest) = right.split_at_mut(i);
        let mut sum = rest[0];
        for (block, known) in row[..pivots.min(i)].iter().zip(&*known) {
            sum -= block * known;
        }
        rest[0] = sum;
    }
}

/// Finds the eliminated unknowns: on entry the first entries of `x` are those of the right-hand side after [`forward`], the
/// others are known.
pub fn backward(blocks: &[Matrix3<f64>], size: usize, pivots: usize, x: &mut [Vector3<f64>]) {
    for p in (0..pivots).rev() {
        let row = &blocks[p * size..(p + 1) * size];
        let mut sum = x[p];
        for (block, known) in row[p + 1..].iter().zip(&x[p + 1..]) {
            sum -= block * known;
        }
        x[p] = row[p] * sum;
    }
}

/// The symmetric part.
pub fn symmetric(m: &Matrix3<f64>) -> Matrix3<f64> {
    0.5 * (m + m.transpose())
}

/// Inverse and number of negative pivots of elimination without exchanges; None where one vanishes.
fn invert(m: &Matrix3<f64>) -> Option<(Matrix3<f64>, usize)> {
    let (a, b, c) = (m.column(0), m.column(1), m.column(2));
    let cross = b.cross(&c);
    let minors = [m.m11, m.m11 * m.m22 - m.m12 * m.m21, a.dot(&cross)];
    if minors.iter().any(|minor| *minor == 0.0 || !minor.is_finite()) {
        return None;
    }
    let signs = minors.map(|minor| minor < 0.0);
    let negative =
        usize::from(signs[0]) + usize::from(signs[0] != signs[1]) + usize::from(signs[1] != signs[2]);
    let inverse = Matrix3::from_columns(&[cross, c.cross(&a), a.cross(&b)]).transpose() / minors[2];
    Some((inverse, negative))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn partial_elimination_solves_and_counts_negative_eigenvalues() {
        let (size, pivots) = (3, 2);
        for symmetric in [true, false] {
            let full = DMatrix::from_fn(9, 9, |i, j| {
                let (a, b) =
                    if symmetric { (i.min(j) as f64, i.max(j) as f64) } else { (i as f64, j as f64) };
                (1.3 * a + 0.7 * b * b).sin() + if i == j { 4.5 - a } else { 0.0 }
            });
            let right = DVector::from_fn(9, |i, _| (i as f64).cos());
            let block = |i: usize, j: usize| Matrix3::from_fn(|a, b| full[(3 * i + a, 3 * j + b)]);
            let mut blocks: Vec<Matrix3<f64>> = (0..9).map(|k| block(k / 3, k % 3)).collect();
            if symmetric {
                // below the diagonal nothing counts
                [3, 6, 7].into_iter().for_each(|k| blocks[k].fill(f64::NAN));
            }
            let mut front = Front { blocks: &mut blocks, size, symmetric };
            let negative = front.eliminate(pivots).expect("no pivot is zero");
            if symmetric {
                let eigenvalues = full.view((0, 0), (6, 6)).into_owned().symmetric_eigenvalues();
                assert_eq!(negative, eigenvalues.iter().filter(|value| **value < 0.0).count());
            }
            // finish with the rest
            let mut x: Vec<Vector3<f64>> =
                (0..3).map(|k| Vector3::from_fn(|i, _| right[3 * k + i])).collect();
            forward(&blocks, size, pivots, &mut x);
            x[2] = blocks[8].lu().solve(&x[2]).expect("is regular");
            backward(&blocks, size, pivots, &mut x);
            let x = DVector::from_iterator(9, x.iter().flat_map(|x| x.iter().copied()));
            assert!((full * x - right).norm() < 1e-12);
        }
    }
}
