//! Rotations: the hat map and Cayley coordinates of SO(3).

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
