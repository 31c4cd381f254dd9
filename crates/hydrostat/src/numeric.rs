//! Numerical methods that know no robot.

/// Butcher's explicit Runge-Kutta method of order 6 in 7 stages (J. C. Butcher, "On Runge-Kutta processes
/// of high order", J. Austral. Math. Soc. 4, 1964).
pub mod butcher6 {
    /// Order of the global error.
    pub const ORDER: i32 = 6;
    /// Distinct abscissae of the stages.
    pub const ABSCISSAE: [f64; 5] = [0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0];
    /// Abscissa of each stage, as an index into [`ABSCISSAE`].
    pub const STAGE_ABSCISSA: [usize; 7] = [0, 1, 3, 1, 2, 2, 4];
    /// Strictly lower triangle of the tableau.
    pub const A: [[f64; 6]; 7] = [
        [0.0; 6],
        [1.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 2.0 / 3.0, 0.0, 0.0, 0.0, 0.0],
        [1.0 / 12.0, 1.0 / 3.0, -1.0 / 12.0, 0.0, 0.0, 0.0],
        [-1.0 / 16.0, 9.0 / 8.0, -3.0 / 16.0, -3.0 / 8.0, 0.0, 0.0],
        [0.0, 9.0 / 8.0, -3.0 / 8.0, -3.0 / 4.0, 1.0 / 2.0, 0.0],
        [
            9.0 / 44.0,
            -9.0 / 11.0,
            63.0 / 44.0,
            18.0 / 11.0,
            0.0,
            -16.0 / 11.0,
        ],
    ];
    /// Weights.
    pub const B: [f64; 7] = [
        11.0 / 120.0,
        0.0,
        27.0 / 40.0,
        27.0 / 40.0,
        -4.0 / 15.0,
        -4.0 / 15.0,
        11.0 / 120.0,
    ];
}

/// Largest system [`eliminate`] takes.
pub const MAX_UNKNOWNS: usize = 6;

/// Solves `n` linear equations with four right-hand sides in place; row `i` is `[a_i1 .. a_in | b_i1 .. b_i4]`.
///
/// Gaussian elimination with partial pivoting: the sizes that occur (3 and 6) are chosen at run time, which
/// the fixed-size factorisations of nalgebra do not allow. Returns the determinant; zero means that the
/// rows are left unsolved.
pub fn eliminate(rows: &mut [[f64; MAX_UNKNOWNS + 4]; MAX_UNKNOWNS], n: usize) -> f64 {
    let width = n + 4;
    let mut determinant = 1.0;
    for k in 0..n {
        // pivot
        let mut pivot = k;
        for i in k + 1..n {
            if rows[i][k].abs() > rows[pivot][k].abs() {
                pivot = i;
            }
        }
        if pivot != k {
            rows.swap(pivot, k);
            determinant = -determinant;
        }
        determinant *= rows[k][k];
        if rows[k][k] == 0.0 || !rows[k][k].is_finite() {
            return 0.0;
        }
        // eliminate below
        let top = rows[k];
        for row in rows.iter_mut().take(n).skip(k + 1) {
            let factor = row[k] / top[k];
            for j in k + 1..width {
                row[j] -= factor * top[j];
            }
        }
    }
    // substitute back
    for k in (0..n).rev() {
        for b in n..width {
            let mut sum = rows[k][b];
            for j in k + 1..n {
                sum -= rows[k][j] * rows[j][b];
            }
            rows[k][b] = sum / rows[k][k];
        }
    }
    determinant
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elimination_solves_and_gives_the_determinant() {
        let mut rows = [[0.0; MAX_UNKNOWNS + 4]; MAX_UNKNOWNS];
        rows[0][..7].copy_from_slice(&[0.0, 2.0, 1.0, 7.0, 1.0, 0.0, 0.0]);
        rows[1][..7].copy_from_slice(&[1.0, -1.0, 0.0, -1.0, 0.0, 1.0, 0.0]);
        rows[2][..7].copy_from_slice(&[3.0, 0.0, 4.0, 15.0, 0.0, 0.0, 1.0]);
        // by hand: x = (1, 2, 3) for the first right-hand side; det = -5
        assert!((eliminate(&mut rows, 3) + 5.0).abs() < 1e-14);
        for (row, x) in rows.iter().zip([1.0, 2.0, 3.0]) {
            assert!((row[3] - x).abs() < 1e-14);
        }
    }
}
