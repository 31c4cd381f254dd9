//! What tendons add to the section law.

use crate::geometry::hat;
use nalgebra::{Matrix3, Matrix6, Vector3};

/// A tendon at a cross-section: in a channel, or on average over the gap in which it is straight.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pull {
    /// r and r', body frame.
    pub(super) hole: Vector3<f64>,
    pub(super) along: Vector3<f64>,
    pub(super) tension: f64,
    /// h^2/24 of the gap, m^2; 0 in a channel.
    pub(super) gap: f64,
}

/// d(path length)/ds, and the tangent, body frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Path {
    pub(super) speed: f64,
    pub(super) tangent: Vector3<f64>,
}

/// The derivatives of d(path length)/ds with respect to v and u.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    pub(super) v: Vector3<f64>,
    pub(super) u: Vector3<f64>,
}

impl Pull {
    /// Its path, theory (26) and (67).
    #[inline]
    pub(super) fn path(&self, v: &Vector3<f64>, u: &Vector3<f64>) -> Path {
        let mut path = v + u.cross(&self.hole) + self.along;
        if self.gap != 0.0 {
            path += self.gap * u.cross(&u.cross(&path));
        }
        let speed = path.norm();
        Path { speed, tangent: path / speed }
    }

    /// At its tangent there.
    #[inline]
    pub(super) fn slope(&self, v: &Vector3<f64>, u: &Vector3<f64>, t: &Vector3<f64>) -> Slope {
        if self.gap == 0.0 {
            return Slope { v: *t, u: self.hole.cross(t) };
        }
        let across = t + self.gap * u.cross(&u.cross(t));
        let p = v + u.cross(&self.hole) + self.along;
        // d(t . u x (u x p))/du at fixed t and p
        let turning = u.dot(&p) * t + u.dot(t) * p - (2.0 * t.dot(&p)) * u;
        Slope { v: across, u: self.hole.cross(&across) + self.gap * turning }
    }
}

/// d(u x (u x a))/du at fixed `a`.
fn turning(u: &Vector3<f64>, a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(u.dot(a)) + u * a.transpose() - 2.0 * a * u.transpose()
}

/// Force and moment of tendons at a cross-section, body frame: the derivatives of sum tau x path length with respect to v and u, in channels
/// sum tau t and sum tau r x t.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pulled {
    pub(super) force: Vector3<f64>,
    pub(super) moment: Vector3<f64>,
}

impl Pulled {
    /// Of the tendons of a cross-section whose bending stiffness is `bend`, and their paths.
    #[inline]
    pub(super) fn new(
        pulls: impl Iterator<Item = (Pull, Path)>,
        bend: &Vector3<f64>,
        v: &Vector3<f64>,
        u: &Vector3<f64>,
    ) -> Self {
        let mut pulled = Pulled::default();
        let mut gap = 0.0;
        for (pull, path) in taut(pulls) {
            let slope = pull.slope(v, u, &path.tangent);
            pulled.force += pull.tension * slope.v;
            pulled.moment += pull.tension * slope.u;
            gap += pull.tension * pull.gap;
        }
        if gap != 0.0 {
            pulled.moment -= given_way(gap, bend).component_mul(u);
        }
        pulled
    }
}

/// The tendons that pull.
fn taut(pulls: impl Iterator<Item = (Pull, Path)>) -> impl Iterator<Item = (Pull, Path)> {
    pulls.filter(|(pull, _)| pull.tension != 0.0)
}

/// By how much a backbone between guides bends more easily than one whose curvature were even: h^4/720 N^2/K, theory (67), from the
/// sum of the tensions times h^2/24.
fn given_way(gap: f64, bend: &Vector3<f64>) -> Vector3<f64> {
    let of = 0.8 * gap * gap;
    Vector3::new(of / bend.x, of / bend.y, 0.0)
}

/// The second derivatives of the same sum.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stiffened {
    pub(super) v_v: Matrix3<f64>,
    pub(super) v_u: Matrix3<f64>,
    pub(super) u_u: Matrix3<f64>,
}

impl Stiffened {
    /// As [`Pulled::new`].
    #[inline]
    pub(super) fn new(
        pulls: impl Iterator<Item = (Pull, Path)>,
        bend: &Vector3<f64>,
        v: &Vector3<f64>,
        u: &Vector3<f64>,
    ) -> Self {
        let mut stiffened = Stiffened::default();
        let mut gap = 0.0;
        for (pull, path) in taut(pulls) {
            if pull.gap == 0.0 {
                stiffened.add(&pull, &path);
            } else {
                stiffened.add_in_gap(&pull, &path, v, u);
                gap += pull.tension * pull.gap;
            }
        }
        if gap != 0.0 {
            stiffened.u_u -= Matrix3::from_diagonal(&given_way(gap, bend));
        }
        stiffened
    }

    fn add(&mut self, pull: &Pull, path: &Path) {
        let Path { speed, tangent: t } = path;
        let (across, hole) = (pull.tension / speed, &pull.hole);
        // I - t t^T, times hat(r) by columns, then hat(r) times that
        let v_v = Matrix3::from_fn(|i, j| across * (f64::from(u8::from(i == j)) - t[i] * t[j]));
        let column = |j: usize| v_v.column(j).into_owned();
        let v_u = Matrix3::from_columns(&[
            column(2) * hole.y - column(1) * hole.z,
            column(0) * hole.z - column(2) * hole.x,
            column(1) * hole.x - column(0) * hole.y,
        ]);
        self.v_v += v_v;
        self.v_u += v_u;
        for j in 0..3 {
            let turned = hole.cross(&v_u.column(j));
            for i in 0..3 {
                self.u_u[(i, j)] += turned[i];
            }
        }
    }

    /// The path is S p with p as in a channel, S = I + g hat(u)^2 = even I + g u u^T, and changes by S dv + B du.
    fn add_in_gap(&mut self, pull: &Pull, path: &Path, v: &Vector3<f64>, u: &Vector3<f64>) {
        let Path { speed, tangent: t } = path;
        let (tension, g, across) = (pull.tension, pull.gap, pull.tension / speed);
        let q = v + pull.along;
        let p = q + u.cross(&pull.hole);
        let (square, along) = (u.norm_squared(), u.dot(&p));
        let even = 1.0 - g * square;
        let slope = pull.slope(v, u, t);
        let outer = |scale: f64, a: &Vector3<f64>, b: &Vector3<f64>| scale * a * b.transpose();
        let b = Matrix3::from_diagonal_element(g * along) - hat(&(even * pull.hole)) + outer(g, u, &q)
            - outer(2.0 * g, &p, u);
        let b_u = even * pull.hole.cross(u) + g * square * q - g * along * u;
        self.v_v += Matrix3::from_diagonal_element(across * even * even)
            + outer(across * g * (1.0 + even), u, u)
            - outer(across, &slope.v, &slope.v);
        self.v_u += across * even * b + outer(across * g, u, &b_u) - outer(across, &slope.v, &slope.u)
            + tension * g * turning(u, t);
        // d(t . S p)/du at fixed t twice
        let of_hole = u.dot(t) * hat(&pull.hole) + pull.hole.cross(u) * t.transpose()
            - 2.0 * pull.hole.cross(t) * u.transpose();
        let twice = of_hole + p * t.transpose() - Matrix3::from_diagonal_element(t.dot(&p));
        self.u_u += across * b.tr_mul(&b) - outer(across, &slope.u, &slope.u)
            + tension * g * (twice + twice.transpose());
    }
}

/// Iterations of the section law, and the relative change at which they end.
const MOST_ITERATIONS: usize = 60;
const CONVERGED: f64 = 1e-15;
/// Changes above this are halved where they lead away.
const HALVED_ABOVE: f64 = 1e-6;

/// The section law with tendons, theory (27): strains under the total force and moment, body frame.
///
/// ```text
/// K_se (v - v*) + sum tau t = force,   K_bt (u - u*) + sum tau r x t = moment
/// ```
/// `shear`, `bend` are the diagonals of the compliances. NaN where Newton's method does not end.
pub(super) fn strains(
    shear: &Vector3<f64>,
    bend: &Vector3<f64>,
    rest_curvature: &Vector3<f64>,
    pulls: impl Iterator<Item = Pull> + Clone,
    force: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let mut v = Vector3::z();
    let mut u = *rest_curvature;
    let (mut change_v, mut change_u) = (Vector3::zeros(), Vector3::zeros());
    let (mut last, mut last_off) = (f64::INFINITY, f64::INFINITY);
    // makes bending a strain of the same size
    let arm = (shear.z / bend.z).sqrt();
    let stiffness = bend.map(f64::recip);
    for _ in 0..MOST_ITERATIONS {
        let paths = pulls.clone().map(|pull| (pull, pull.path(&v, &u)));
        let pulled = Pulled::new(paths.clone(), &stiffness, &v, &u);
        // in units of strain
        let off_v = v - Vector3::z() - shear.component_mul(&(force - pulled.force));
        let off_u = u - rest_curvature - bend.component_mul(&(moment - pulled.moment));
        let off = off_v.norm() + arm * off_u.norm();
        if off > last_off && last > HALVED_ABOVE {
            // too far: back by half
            (change_v, change_u, last) = (0.5 * change_v, 0.5 * change_u, 0.5 * last);
            v += change_v;
            u += change_u;
            continue;
        }
        last_off = off;
        let stiffened = Stiffened::new(paths, &stiffness, &v, &u);
        let Some(tangent) = compliance(shear, bend, &stiffened) else { break };
        let (stiff_v, stiff_u) = (off_v.component_div(shear), off_u.component_div(bend));
        change_v = tangent[0] * stiff_v + tangent[1] * stiff_u;
        change_u = tangent[2] * stiff_v + tangent[3] * stiff_u;
        v -= change_v;
        u -= change_u;
        let change = change_v.amax() + change_u.amax() / (1.0 + u.amax());
        if change <= CONVERGED || change >= last && change < 1e-12 {
            return (v, u);
        }
        last = change;
    }
    (Vector3::from_element(f64::NAN), Vector3::from_element(f64::NAN))
}

/// Blocks v-n, v-m, u-n, u-m of the inverse of the tangent stiffness.
pub(super) fn compliance(
    shear: &Vector3<f64>,
    bend: &Vector3<f64>,
    stiffened: &Stiffened,
) -> Option<[Matrix3<f64>; 4]> {
    let mut tangent = Matrix6::zeros();
    tangent
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(stiffened.v_v + Matrix3::from_diagonal(&shear.map(f64::recip))));
    tangent.fixed_view_mut::<3, 3>(0, 3).copy_from(&stiffened.v_u);
    tangent.fixed_view_mut::<3, 3>(3, 0).copy_from(&stiffened.v_u.transpose());
    tangent
        .fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&(stiffened.u_u + Matrix3::from_diagonal(&bend.map(f64::recip))));
    let inverse = tangent.try_inverse()?;
    let block = |i, j| inverse.fixed_view::<3, 3>(i, j).into_owned();
    Some([block(0, 0), block(0, 3), block(3, 0), block(3, 3)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_finite_differences() {
        let (v, u) = (Vector3::new(0.02, -0.03, 1.01), Vector3::new(4.0, -7.0, 3.0));
        let bend = Vector3::new(0.02, 0.03, 0.01);
        for gap in [0.0, 0.02_f64.powi(2) / 24.0] {
            let pull = |x: f64, y: f64, tension| Pull {
                hole: Vector3::new(x, y, 0.0),
                along: Vector3::new(0.01, 0.02, 0.0),
                tension,
                gap,
            };
            let pulls = [pull(8e-3, 1e-3, 3.0), pull(-5e-3, 6e-3, 1.0)];
            let length = |v: &Vector3<f64>, u: &Vector3<f64>| -> f64 {
                let lengths = pulls.iter().map(|pull| pull.tension * pull.path(v, u).speed).sum::<f64>();
                let sum: f64 = pulls.iter().map(|pull| pull.tension * pull.gap).sum();
                lengths - 0.5 * u.dot(&given_way(sum, &bend).component_mul(u))
            };
            let paths = |v: &Vector3<f64>, u: &Vector3<f64>| pulls.map(|pull| (pull, pull.path(v, u)));
            let of = |v: &Vector3<f64>, u: &Vector3<f64>| Pulled::new(paths(v, u).into_iter(), &bend, v, u);
            let stiffened = Stiffened::new(paths(&v, &u).into_iter(), &bend, &v, &u);
            let pulled = of(&v, &u);
            for axis in 0..3 {
                let (small, large) = (1e-5 * Vector3::ith(axis, 1.0), 1e-3 * Vector3::ith(axis, 1.0));
                let slope = (length(&(v + small), &u) - length(&(v - small), &u)) / 2e-5;
                assert!((slope - pulled.force[axis]).abs() < 1e-8, "{gap} {slope} {}", pulled.force);
                let slope = (length(&v, &(u + large)) - length(&v, &(u - large))) / 2e-3;
                assert!((slope - pulled.moment[axis]).abs() < 1e-9, "{gap} {slope} {}", pulled.moment);
                let [behind, ahead] = [of(&(v - small), &u), of(&(v + small), &u)];
                let second = (ahead.force - behind.force) / 2e-5;
                assert!((second - stiffened.v_v.column(axis)).norm() < 1e-7, "{gap} {axis}");
                let second = (ahead.moment - behind.moment) / 2e-5;
                assert!((second - stiffened.v_u.transpose().column(axis)).norm() < 1e-8, "{gap} {axis}");
                let [behind, ahead] = [of(&v, &(u - large)), of(&v, &(u + large))];
                let second = (ahead.moment - behind.moment) / 2e-3;
                assert!((second - stiffened.u_u.column(axis)).norm() < 1e-9, "{gap} {axis}");
            }
        }
    }

    #[test]
    fn the_law_of_a_gap_is_its_chord() {
        // of a helix: constant strains over the gap
        let (v, u, h) = (Vector3::new(0.0, 0.0, 1.0), Vector3::new(4.0, -7.0, 3.0), 0.01);
        let hole = Vector3::new(8e-3, 1e-3, 0.0);
        let half = |sign: f64| {
            let turn = crate::geometry::RotationVector::new(0.5 * sign * h * u);
            // the integral of exp(s hat(u)) from 0 is s J(-s u)
            0.5 * sign * h * (turn.jacobian().transpose() * v) + turn.rotation() * hole
        };
        let chord = (half(1.0) - half(-1.0)).norm() / h;
        let of = |gap| Pull { hole, along: Vector3::zeros(), tension: 1.0, gap }.path(&v, &u).speed;
        let (channel, gap) = (of(0.0) - chord, of(h * h / 24.0) - chord);
        assert!(channel > 1e-4 && gap.abs() < 1e-3 * channel, "{channel} {gap}");
    }
}
