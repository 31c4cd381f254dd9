//! The section law with tendons in channels, solved by code that the solvers do not share.

use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// A tendon, by its number, that passes a cross-section: hole, its derivative along the backbone, tension.
#[derive(Clone, Copy)]
pub(super) struct Pull {
    pub(super) tendon: usize,
    pub(super) hole: Vector3<f64>,
    pub(super) along: Vector3<f64>,
    pub(super) tension: f64,
}

impl Pull {
    /// Derivative of the path along the backbone, body frame.
    pub(super) fn path(&self, v: &Vector3<f64>, u: &Vector3<f64>) -> Vector3<f64> {
        v + u.cross(&self.hole) + self.along
    }

    /// Force and moment with which the tendon beyond pulls, body frame.
    pub(super) fn wrench(&self, v: &Vector3<f64>, u: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let force = self.tension * self.path(v, u).normalize();
        (force, self.hole.cross(&force))
    }
}

/// A linear elastic section, diagonals of its stiffness, under the tendons that pass.
pub(super) struct Law<'a> {
    pub(super) se: Vector3<f64>,
    pub(super) bt: Vector3<f64>,
    pub(super) rest_curvature: Vector3<f64>,
    pub(super) pulls: &'a [Pull],
}

const MOST_ITERATIONS: usize = 60;

impl Law<'_> {
    /// Force and moment of rod and tendons together, body frame.
    fn wrench(&self, v: &Vector3<f64>, u: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let mut force = self.se.component_mul(&(v - Vector3::z()));
        let mut moment = self.bt.component_mul(&(u - self.rest_curvature));
        for pull in self.pulls {
            let (more_force, more_moment) = pull.wrench(v, u);
            force += more_force;
            moment += more_moment;
        }
        (force, moment)
    }

    /// The strains under a wrench: Newton's method, halved where it does not come closer. The energy is convex in them.
    pub(super) fn strains(
        &self,
        force: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let mut v = Vector3::z();
        let mut u = self.rest_curvature;
        if self.pulls.iter().all(|pull| pull.tension == 0.0) {
            return (v + force.component_div(&self.se), u + moment.component_div(&self.bt));
        }
        // forces and moments in units that make both a strain of the same size
        let arm = (self.bt.z / self.se.z).sqrt();
        let off = |v: &Vector3<f64>, u: &Vector3<f64>| {
            let (n, m) = self.wrench(v, u);
            let (n, m) = (force - n, (moment - m) / arm);
            (Vector6::new(n.x, n.y, n.z, m.x, m.y, m.z), (n.norm() + m.norm()) / self.se.z)
        };
        let (mut rest, mut size) = off(&v, &u);
        for _ in 0..MOST_ITERATIONS {
            let Some(step) = self.tangent(&v, &u, arm).cholesky().map(|tangent| tangent.solve(&rest)) else {
                break;
            };
            let (dv, du) =
                (Vector3::new(step[0], step[1], step[2]), Vector3::new(step[3], step[4], step[5]) / arm);
            let mut part = 1.0;
            let closer = loop {
                let (tried_v, tried_u) = (v + part * dv, u + part * du);
                let (tried, tried_size) = off(&tried_v, &tried_u);
                if tried_size < size {
                    (v, u, rest, size) = (tried_v, tried_u, tried, tried_size);
                    break true;
                }
                part *= 0.5;
                if part < 1e-3 {
                    break false;
                }
            };
            if !closer {
                break;
            }
        }
        (v, u)
    }

    /// Derivative of the wrench by the strains, rows and columns of moment and curvature in units of `arm`.
    fn tangent(&self, v: &Vector3<f64>, u: &Vector3<f64>, arm: f64) -> Matrix6<f64> {
        let bt = self.bt / arm.powi(2);
        let mut tangent =
            Matrix6::from_diagonal(&Vector6::new(self.se.x, self.se.y, self.se.z, bt.x, bt.y, bt.z));
        for pull in self.pulls {
            let path = pull.path(v, u);
            let (speed, t) = (path.norm(), path.normalize());
            let across = (Matrix3::identity() - t * t.transpose()) * (pull.tension / speed);
            // d(path) = dv + du x hole
            let by_u = -pull.hole.cross_matrix() / arm;
            let block = [across, across * by_u, by_u.tr_mul(&across), by_u.tr_mul(&across) * by_u];
            for (k, block) in block.iter().enumerate() {
                let mut view = tangent.fixed_view_mut::<3, 3>(3 * (k / 2), 3 * (k % 2));
                view += block;
            }
        }
        tangent
    }
}
