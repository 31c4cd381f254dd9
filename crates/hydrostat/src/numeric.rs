//! Numerical methods that know no robot.

pub mod anderson;
pub mod blocks;
pub mod collocation;
pub mod least_squares;
pub mod nonnegative;
pub mod random;

/// The explicit Runge-Kutta method of order 8 in 12 stages of Dormand and Prince, as in DOP853
/// (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, 2nd ed., appendix).
pub mod dop853 {
    /// Order of the global error.
    pub const ORDER: i32 = 8;
    /// Number of stages.
    pub const STAGES: usize = 12;
    /// Abscissae of the stages; the first is 0, the last 1.
    pub const C: [f64; STAGES] = [
        0.0,
        0.05260015195876773,
        0.0789002279381516,
        0.1183503419072274,
        0.2816496580927726,
        0.3333333333333333,
        0.25,
        0.3076923076923077,
        0.6512820512820513,
        0.6,
        0.8571428571428571,
        1.0,
    ];
    /// Rows of the tableau: (earlier stage, coefficient).
    #[rustfmt::skip]
    pub const TABLEAU: [&[(usize, f64)]; STAGES] = [
        &[],
        &[(0, 0.05260015195876773)],
        &[(0, 0.0197250569845379), (1, 0.0591751709536137)],
        &[(0, 0.02958758547680685), (2, 0.08876275643042054)],
        &[(0, 0.2413651341592667), (2, -0.8845494793282861), (3, 0.924834003261792)],
        &[(0, 0.037037037037037035), (3, 0.17082860872947386), (4, 0.12546768756682242)],
        &[(0, 0.037109375), (3, 0.17025221101954405), (4, 0.06021653898045596), (5, -0.017578125)],
        &[(0, 0.03709200011850479), (3, 0.17038392571223998), (4, 0.10726203044637328), (5, -0.015319437748624402), (6, 0.008273789163814023)],
        &[(0, 0.6241109587160757), (3, -3.3608926294469414), (4, -0.868219346841726), (5, 27.59209969944671), (6, 20.154067550477894), (7, -43.48988418106996)],
        &[(0, 0.47766253643826434), (3, -2.4881146199716677), (4, -0.590290826836843), (5, 21.230051448181193), (6, 15.279233632882423), (7, -33.28821096898486), (8, -0.020331201708508627)],
        &[(0, -0.9371424300859873), (3, 5.186372428844064), (4, 1.0914373489967295), (5, -8.149787010746927), (6, -18.52006565999696), (7, 22.739487099350505), (8, 2.4936055526796523), (9, -3.0467644718982196)],
        &[(0, 2.273310147516538), (3, -10.53449546673725), (4, -2.0008720582248625), (5, -17.9589318631188), (6, 27.94888452941996), (7, -2.8589982771350235), (8, -8.87285693353063), (9, 12.360567175794303), (10, 0.6433927460157636)],
    ];
    /// Weights.
    pub const B: [f64; STAGES] = [
        0.054293734116568765,
        0.0,
        0.0,
        0.0,
        0.0,
        4.450312892752409,
        1.8915178993145003,
        -5.801203960010585,
        0.3111643669578199,
        -0.1521609496625161,
        0.20136540080403034,
        0.04471061572777259,
    ];
}

/// The larger of two; NaN is larger than everything, so that it cannot get lost in a maximum.
pub fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
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
            let known: f64 = (k + 1..n).map(|j| rows[k][j] * rows[j][b]).sum();
            rows[k][b] = (rows[k][b] - known) / rows[k][k];
        }
    }
    determinant
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dop853_is_of_order_eight_on_a_nonlinear_equation() {
        // y' = y cos t, y = exp(sin t)
        let solve = |steps: usize| {
            let h = 2.0 / steps as f64;
            let mut y = 1.0;
            for step in 0..steps {
                let mut k = [0.0; dop853::STAGES];
                for i in 0..dop853::STAGES {
                    let stage: f64 = y + h * dop853::TABLEAU[i].iter().map(|&(j, a)| a * k[j]).sum::<f64>();
                    k[i] = stage * ((step as f64 + dop853::C[i]) * h).cos();
                }
                y += h * (0..dop853::STAGES).map(|i| dop853::B[i] * k[i]).sum::<f64>();
            }
            (y - 2.0_f64.sin().exp()).abs()
        };
        let order = (solve(4) / solve(8)).log2();
        assert!(order > 7.8, "observed order {order}");
    }

    #[test]
    fn nan_survives_a_maximum() {
        for values in [[f64::NAN, 1.0, 2.0], [1.0, f64::NAN, 2.0], [1.0, 2.0, f64::NAN]] {
            assert!(values.into_iter().fold(0.0, larger).is_nan());
        }
        assert!(
            (larger(1.0, 2.0) - 2.0).abs() < f64::EPSILON && (larger(2.0, 1.0) - 2.0).abs() < f64::EPSILON
        );
    }

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
