//! What tendons in channels add to the section law.

use nalgebra::{Matrix3, Matrix6, Vector3};

/// A channel tendon at a cross-section.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pull {
    /// r and r', body frame.
    pub(super) hole: Vector3<f64>,
    pub(super) along: Vector3<f64>,
    pub(super) tension: f64,
}

impl Pull {
    /// d(path length)/ds and the tangent, body frame, theory (26).
    pub(super) fn path(&self, v: &Vector3<f64>, u: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let path = v + u.cross(&self.hole) + self.along;
        let speed = path.norm();
        (speed, path / speed)
    }
}

/// Force sum tau t and moment sum tau r x t of tendons at a cross-section, body frame, and their derivatives: the second
/// derivatives of sum tau |v + u x r + r'|.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pulled {
    pub(super) force: Vector3<f64>,
    pub(super) moment: Vector3<f64>,
    pub(super) v_v: Matrix3<f64>,
    pub(super) v_u: Matrix3<f64>,
    pub(super) u_u: Matrix3<f64>,
}

impl Pulled {
    pub(super) fn add(&mut self, pull: &Pull, v: &Vector3<f64>, u: &Vector3<f64>) {
        if pull.tension == 0.0 {
            return;
        }
        let (speed, t) = pull.path(v, u);
        let force = pull.tension * t;
        let (across, hole) = (pull.tension / speed, &pull.hole);
        // I - t t^T, times hat(r) by columns, then hat(r) times that
        let v_v = Matrix3::from_fn(|i, j| across * (f64::from(u8::from(i == j)) - t[i] * t[j]));
        let column = |j: usize| v_v.column(j).into_owned();
        let v_u = Matrix3::from_columns(&[
            column(2) * hole.y - column(1) * hole.z,
            column(0) * hole.z - column(2) * hole.x,
            column(1) * hole.x - column(0) * hole.y,
        ]);
        self.force += force;
        self.moment += hole.cross(&force);
        self.v_v += v_v;
        self.v_u += v_u;
        for j in 0..3 {
            let turned = hole.cross(&v_u.column(j));
            for i in 0..3 {
                self.u_u[(i, j)] += turned[i];
            }
        }
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
    for _ in 0..MOST_ITERATIONS {
        let mut pulled = Pulled::default();
        pulls.clone().for_each(|pull| pulled.add(&pull, &v, &u));
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
        let Some(tangent) = compliance(shear, bend, &pulled) else { break };
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
    pulled: &Pulled,
) -> Option<[Matrix3<f64>; 4]> {
    let mut tangent = Matrix6::zeros();
    tangent
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(pulled.v_v + Matrix3::from_diagonal(&shear.map(f64::recip))));
    tangent.fixed_view_mut::<3, 3>(0, 3).copy_from(&pulled.v_u);
    tangent.fixed_view_mut::<3, 3>(3, 0).copy_from(&pulled.v_u.transpose());
    tangent
        .fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&(pulled.u_u + Matrix3::from_diagonal(&bend.map(f64::recip))));
    let inverse = tangent.try_inverse()?;
    let block = |i, j| inverse.fixed_view::<3, 3>(i, j).into_owned();
    Some([block(0, 0), block(0, 3), block(3, 0), block(3, 3)])
}
