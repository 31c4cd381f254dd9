//! Small quadratic programs whose unknowns must not be negative.

use nalgebra::{DMatrix, DVector};

/// Added to the diagonal, relative to its largest entry, so that redundant unknowns are shared evenly.
const RIDGE: f64 = 1e-12;

/// Minimises `x . S x / 2 - b . x` over `x >= 0` for a positive semi-definite `S`, by the active-set method of Lawson and
/// Hanson (Solving Least Squares Problems, ch. 23). None where it does not end.
pub fn minimise(s: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let n = b.len();
    let ridge = RIDGE * s.diagonal().amax();
    let mut x = DVector::zeros(n);
    let mut free = vec![false; n];
    let threshold = 1e-13 * b.amax();
    for _ in 0..10 * (n + 1) {
        // the unknown that gains most by growing
        let slope = b - s * &x;
        let candidate = (0..n)
            .filter(|&i| !free[i] && slope[i] > threshold)
            .max_by(|&i, &j| slope[i].total_cmp(&slope[j]));
        let Some(candidate) = candidate else { return Some(x) };
        free[candidate] = true;
        loop {
            let chosen: Vec<usize> = (0..n).filter(|&i| free[i]).collect();
            if chosen.is_empty() {
                return None; // nothing grows although it would gain: `S` is not semi-definite
            }
            let mut block = DMatrix::from_fn(chosen.len(), chosen.len(), |i, j| s[(chosen[i], chosen[j])]);
            for i in 0..chosen.len() {
                block[(i, i)] += ridge;
            }
            let right = DVector::from_fn(chosen.len(), |i, _| b[chosen[i]]);
            let solved = block.lu().solve(&right)?;
            if solved.iter().all(|value| *value > 0.0) {
                x.fill(0.0);
                chosen.iter().zip(solved.iter()).for_each(|(&i, value)| x[i] = *value);
                break;
            }
            // as far as the first that would turn negative, which is then held at zero
            let mut part = 1.0_f64;
            for (&i, value) in chosen.iter().zip(solved.iter()) {
                if *value <= 0.0 {
                    part = part.min(x[i] / (x[i] - value));
                }
            }
            for (&i, value) in chosen.iter().zip(solved.iter()) {
                x[i] += part * (value - x[i]);
                if x[i] <= 1e-15 * solved.amax() {
                    x[i] = 0.0;
                    free[i] = false;
                }
            }
        }
    }
    None
}

/// Finds `x >= 0` with `S x >= b` and one of the two an equality in every row, for any `S`, by the primal-dual active-set method
/// from the unknowns that were `free` before. None where it does not end.
pub fn complementary(s: &DMatrix<f64>, b: &DVector<f64>, free: &[bool]) -> Option<DVector<f64>> {
    let n = b.len();
    let mut free = free.to_vec();
    for _ in 0..10 * (n + 1) {
        let masked =
            DMatrix::from_fn(
                n,
                n,
                |i, j| {
                    if free[i] && free[j] { s[(i, j)] } else { f64::from(u8::from(i == j)) }
                },
            );
        let x = masked.lu().solve(&DVector::from_fn(n, |i, _| if free[i] { b[i] } else { 0.0 }))?;
        let rest = b - s * &x;
        let threshold = 1e-13 * b.amax();
        let next: Vec<bool> =
            (0..n).map(|i| if free[i] { x[i] > 0.0 } else { rest[i] > threshold }).collect();
        if next == free {
            return Some(x);
        }
        free = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_optimum_satisfies_its_conditions() {
        let a = DMatrix::from_fn(5, 4, |i, j| ((3 * i + 7 * j) as f64).sin());
        let s = a.tr_mul(&a);
        let b = DVector::from_vec(vec![1.0, -2.0, 0.5, 0.7]);
        let x = minimise(&s, &b).expect("ends");
        let slope = &b - &s * &x;
        assert!(x.iter().any(|x| *x > 0.0));
        for (x, slope) in x.iter().zip(slope.iter()) {
            assert!(*x >= 0.0 && *slope <= 1e-9 && (x * slope).abs() < 1e-9);
        }
        assert_eq!(minimise(&-DMatrix::<f64>::identity(4, 4), &b), None);
        let regular = s + DMatrix::identity(4, 4);
        let [x, y] =
            [minimise(&regular, &b), complementary(&regular, &b, &[true; 4])].map(|x| x.expect("ends"));
        assert!((x - y).norm() < 1e-9);
    }
}
