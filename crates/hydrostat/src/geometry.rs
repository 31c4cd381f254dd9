//! Rotations: the hat map, Cayley coordinates and rotation vectors of SO(3).

use nalgebra::{Matrix3, Vector3};

/// The skew matrix of `a`: `hat(a) b = a x b`.
pub fn hat(a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// Cayley map, theory (12): the rotation about `w` by the angle `2 atan(|w| / 2)`; orthogonal for every `w`.
///
/// ```text
/// cay(w) = I + (hat(w) + hat(w)^2 / 2) / (1 + |w|^2 / 4)
/// ```
pub fn cayley(w: &Vector3<f64>) -> Matrix3<f64> {
    let c = 1.0 / (1.0 + 0.25 * w.norm_squared());
    let h = 0.5 * c;
    let d = 1.0 - h * w.norm_squared();
    let (xy, xz, yz) = (h * w.x * w.y, h * w.x * w.z, h * w.y * w.z);
    let (x, y, z) = (c * w.x, c * w.y, c * w.z);
    Matrix3::new(
        d + h * w.x * w.x,
        xy - z,
        xz + y,
        xy + z,
        d + h * w.y * w.y,
        yz - x,
        xz - y,
        yz + x,
        d + h * w.z * w.z,
    )
}

/// Inverse of [`cayley`]; infinite at half a turn.
pub fn cayley_coordinates(q: &Matrix3<f64>) -> Vector3<f64> {
    let skew = Vector3::new(q.m32 - q.m23, q.m13 - q.m31, q.m21 - q.m12);
    skew * (2.0 / (1.0 + q.trace()))
}

/// Rate of the Cayley coordinates of `R0^T R` while `R' = R hat(u)`, theory (13).
///
/// ```text
/// w' = u + w x u / 2 + (w . u) w / 4
/// ```
pub fn cayley_rate(w: &Vector3<f64>, u: &Vector3<f64>) -> Vector3<f64> {
    u + 0.5 * w.cross(u) + (0.25 * w.dot(u)) * w
}

/// The rotation vector of a rotation by less than half a turn; accurate for small ones, where an arc cosine is not.
pub fn rotation_vector(q: &Matrix3<f64>) -> Vector3<f64> {
    let twice_sin = Vector3::new(q.m32 - q.m23, q.m13 - q.m31, q.m21 - q.m12);
    let sin = 0.5 * twice_sin.norm();
    let angle = sin.atan2(0.5 * (q.trace() - 1.0));
    twice_sin * if sin > 0.0 { 0.5 * angle / sin } else { 0.5 }
}

/// A rotation vector `w` with what its exponential and its rate need, theory (23, 24).
///
/// ```text
/// E(w) = I + sinc hat(w) + alpha hat(w)^2
/// u = J(w) w' = w' - alpha w x w' + beta w x (w x w')     while R = R0 E(w),  R' = R hat(u)
/// ```
/// `alpha` = (1 - cos |w|) / |w|^2 and `beta` = (|w| - sin |w|) / |w|^3 are entire functions of x = |w|^2; their
/// derivatives are with respect to x.
#[derive(Clone, Copy, Debug)]
pub struct RotationVector {
    w: Vector3<f64>,
    sinc: f64,
    alpha: [f64; 3],
    beta: [f64; 3],
}

/// Terms of the series of `alpha` and `beta`: up to each square of the angle the next is under 1e-17.
const TERMS: usize = 11;
const SERIES_UP_TO: f64 = 3.0;
const FEW_TERMS: usize = 6;
const FEW_UP_TO: f64 = 0.09;

/// Coefficients of sum (-x)^k / (2k + 2)! and of its first two derivatives, then the same with (2k + 3)!; highest power last.
const SERIES: [[f64; 6]; TERMS] = {
    let mut table = [[0.0; 6]; TERMS];
    let mut which = 0;
    while which < 2 {
        let first = 2 + which;
        let (mut k, mut coefficient, mut factor) = (0, 1.0, 1);
        while factor < first {
            factor += 1;
            coefficient /= factor as f64;
        }
        while k < TERMS {
            table[k][3 * which] = coefficient;
            if k >= 1 {
                table[k - 1][3 * which + 1] = k as f64 * coefficient;
            }
            if k >= 2 {
                table[k - 2][3 * which + 2] = (k * (k - 1)) as f64 * coefficient;
            }
            k += 1;
            coefficient /= -(((2 * k + first) * (2 * k + first - 1)) as f64);
        }
        which += 1;
    }
    table
};

fn series(terms: &[[f64; 6]], x: f64) -> [f64; 6] {
    let mut sums = [0.0; 6];
    for row in terms.iter().rev() {
        for (sum, c) in sums.iter_mut().zip(row) {
            *sum = *sum * x + c;
        }
    }
    sums
}

impl Default for RotationVector {
    /// No turn.
    fn default() -> Self {
        Self::new(Vector3::zeros())
    }
}

impl RotationVector {
    pub fn new(w: Vector3<f64>) -> Self {
        let x = w.norm_squared();
        if x < SERIES_UP_TO {
            let [a, a1, a2, b, b1, b2] =
                if x < FEW_UP_TO { series(&SERIES[..FEW_TERMS], x) } else { series(&SERIES, x) };
            return RotationVector { w, sinc: 1.0 - x * b, alpha: [a, a1, a2], beta: [b, b1, b2] };
        }
        let angle = x.sqrt();
        let sinc = angle.sin() / angle;
        let (a, b) = ((1.0 - angle.cos()) / x, (1.0 - sinc) / x);
        let (a1, b1) = ((sinc - 2.0 * a) / (2.0 * x), (a - 3.0 * b) / (2.0 * x));
        let (a2, b2) = ((0.5 * (b - a) - 4.0 * a1) / (2.0 * x), (a1 - 5.0 * b1) / (2.0 * x));
        RotationVector { w, sinc, alpha: [a, a1, a2], beta: [b, b1, b2] }
    }

    /// E(w).
    #[inline]
    pub fn rotation(&self) -> Matrix3<f64> {
        let (w, c, s) = (&self.w, self.alpha[0], self.sinc);
        let d = 1.0 - c * w.norm_squared();
        let (xy, xz, yz) = (c * w.x * w.y, c * w.x * w.z, c * w.y * w.z);
        let (x, y, z) = (s * w.x, s * w.y, s * w.z);
        Matrix3::new(
            d + c * w.x * w.x,
            xy - z,
            xz + y,
            xy + z,
            d + c * w.y * w.y,
            yz - x,
            xz - y,
            yz + x,
            d + c * w.z * w.z,
        )
    }

    /// J(w): the body-frame rate of rotation over the rate of `w`.
    #[inline]
    pub fn jacobian(&self) -> Matrix3<f64> {
        let (w, a, b) = (&self.w, self.alpha[0], self.beta[0]);
        let d = 1.0 - b * w.norm_squared();
        let (xy, xz, yz) = (b * w.x * w.y, b * w.x * w.z, b * w.y * w.z);
        let (x, y, z) = (a * w.x, a * w.y, a * w.z);
        Matrix3::new(
            d + b * w.x * w.x,
            xy + z,
            xz - y,
            xy - z,
            d + b * w.y * w.y,
            yz + x,
            xz + y,
            yz - x,
            d + b * w.z * w.z,
        )
    }

    /// d(J(w) a)/dw at fixed `a`.
    pub fn jacobian_differential(&self, a: &Vector3<f64>) -> Matrix3<f64> {
        self.differential(-1.0, a)
    }

    /// d(J(w)^T a)/dw at fixed `a`; its symmetric part is the quadratic form `d -> a . dJ[d] d`.
    pub fn transpose_differential(&self, a: &Vector3<f64>) -> Matrix3<f64> {
        self.differential(1.0, a)
    }

    /// d/dw of `a + sign alpha w x a + beta w x (w x a)`.
    #[inline]
    fn differential(&self, sign: f64, a: &Vector3<f64>) -> Matrix3<f64> {
        let (w, [alpha, alpha1, _], [beta, beta1, _]) = (&self.w, self.alpha, self.beta);
        let across = w.cross(a);
        let along_w = (2.0 * sign * alpha1) * across + (2.0 * beta1) * w.cross(&across) - (2.0 * beta) * a;
        let (bw, d, h) = (beta * w, beta * w.dot(a), (-sign * alpha) * a);
        let entry = |i: usize, j: usize| bw[i] * a[j] + along_w[i] * w[j];
        Matrix3::new(
            entry(0, 0) + d,
            entry(0, 1) - h.z,
            entry(0, 2) + h.y,
            entry(1, 0) + h.z,
            entry(1, 1) + d,
            entry(1, 2) - h.x,
            entry(2, 0) - h.y,
            entry(2, 1) + h.x,
            entry(2, 2) + d,
        )
    }

    /// Second derivative of `c . J(w) a` with respect to `w`, symmetric.
    #[inline]
    pub fn second_differential(&self, c: &Vector3<f64>, a: &Vector3<f64>) -> Matrix3<f64> {
        let (w, x) = (&self.w, self.w.norm_squared());
        let ([_, alpha1, alpha2], [beta, beta1, beta2]) = (self.alpha, self.beta);
        // c . J a = c . a - alpha w . k + beta w . S w,  S = sym(c a^T) - (c . a) I
        let (k, ca) = (a.cross(c), c.dot(a));
        let sw = 0.5 * (c * a.dot(w) + a * c.dot(w)) - ca * w;
        let (wk, q) = (w.dot(&k), c.dot(w) * a.dot(w) - x * ca);
        let s = 0.5 * (c * a.transpose() + a * c.transpose()) - Matrix3::from_diagonal_element(ca);
        let mixed = 4.0 * beta1 * sw - 2.0 * alpha1 * k;
        let diagonal = 2.0 * (beta1 * q - alpha1 * wk);
        2.0 * beta * s
            + Matrix3::from_diagonal_element(diagonal)
            + (4.0 * (beta2 * q - alpha2 * wk)) * (w * w.transpose())
            + w * mixed.transpose()
            + mixed * w.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_vector_inverts_the_exponential() {
        for size in [0.0, 1e-12, 1e-7, 0.3, 3.0] {
            let w = size * Vector3::new(0.6, -0.48, 0.64);
            let found = rotation_vector(&RotationVector::new(w).rotation());
            assert!((found - w).norm() < 1e-14 * (1.0 + size), "{size} {found}");
        }
    }

    #[test]
    fn cayley_is_a_rotation_and_inverts() {
        let w = Vector3::new(0.3, -1.2, 0.7);
        let q = cayley(&w);
        assert!((q.transpose() * q - Matrix3::identity()).norm() < 1e-15);
        assert!((cayley_coordinates(&q) - w).norm() < 1e-15);
        let axis_angle = nalgebra::Rotation3::new(w.normalize() * 2.0 * (0.5 * w.norm()).atan());
        assert!((q - axis_angle.matrix()).norm() < 1e-15);
    }

    #[test]
    fn cayley_rate_matches_a_finite_difference() {
        let (w, u) = (Vector3::new(0.3, -1.2, 0.7), Vector3::new(-0.5, 0.2, 1.1));
        let h = 1e-6;
        let ahead = cayley_coordinates(&(cayley(&w) * cayley(&(h * u))));
        let behind = cayley_coordinates(&(cayley(&w) * cayley(&(-h * u))));
        assert!(((ahead - behind) / (2.0 * h) - cayley_rate(&w, &u)).norm() < 1e-9);
    }

    /// On both sides of the limit of the series.
    const VECTORS: [[f64; 3]; 3] = [[0.02, -0.01, 0.03], [0.3, -1.2, 0.7], [1.3, -1.2, 0.9]];

    #[test]
    fn rotation_vectors_match_nalgebra_and_finite_differences() {
        let (a, c, h) = (Vector3::new(-0.5, 0.2, 1.1), Vector3::new(0.7, 0.4, -0.9), 1e-5);
        for w in VECTORS.map(Vector3::from) {
            let at = |w: Vector3<f64>| RotationVector::new(w);
            assert!((at(w).rotation() - nalgebra::Rotation3::new(w).matrix()).norm() < 1e-15);
            for i in 0..3 {
                let step = h * Vector3::ith(i, 1.0);
                let central =
                    |of: &dyn Fn(Vector3<f64>) -> Vector3<f64>| (of(w + step) - of(w - step)) / (2.0 * h);
                // E(w)^T dE = hat(J dw)
                let turn = at(w - step).rotation().transpose() * at(w + step).rotation() / (2.0 * h);
                let rate = 0.5 * Vector3::new(turn.m32 - turn.m23, turn.m13 - turn.m31, turn.m21 - turn.m12);
                assert!((rate - at(w).jacobian().column(i)).norm() < 1e-9);
                let j = central(&|w| at(w).jacobian() * a);
                assert!((j - at(w).jacobian_differential(&a).column(i)).norm() < 1e-9);
                let jt = central(&|w| at(w).jacobian().transpose() * a);
                assert!((jt - at(w).transpose_differential(&a).column(i)).norm() < 1e-9);
                let second = central(&|w| at(w).jacobian_differential(&a).transpose() * c);
                assert!((second - at(w).second_differential(&c, &a).column(i)).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn series_and_closed_forms_meet() {
        let w = Vector3::new(1.0, 1.0, 1.0);
        let few = Vector3::new(0.3, 0.0, 0.0);
        for (w, tiny) in [(w, 1e-15), (few, 1e-15)] {
            let (below, above) =
                (RotationVector::new(w * (1.0 - tiny)), RotationVector::new(w * (1.0 + tiny)));
            for (a, b) in below.alpha.iter().zip(&above.alpha).chain(below.beta.iter().zip(&above.beta)) {
                assert!((a - b).abs() < 1e-14, "{a} {b}");
            }
        }
    }
}
