//! The equations of the rod over one integration step: state and transition matrix.

use super::chain::{Jump, Step};
use crate::geometry::{cayley, cayley_rate, hat};
use crate::numeric::butcher6::{A, B, STAGE_ABSCISSA};
use nalgebra::{Matrix3, Vector3};

/// What the equations carry along the backbone. The position follows from it and nothing depends on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// R, columns d1 d2 d3.
    pub(super) rotation: Matrix3<f64>,
    /// m, world frame.
    pub(super) moment: Vector3<f64>,
    /// The part of n that follower loads cause, world frame; the dead part is known beforehand.
    pub(super) force: Vector3<f64>,
}

/// d(rotation, moment\[, force\]) at the end of a step over the same at its start; the variation of the
/// rotation is the world vector `y` of `delta R = hat(y) R`. `N` = 2 blocks for dead loads, 3 with followers.
pub(super) type Transition<const N: usize> = [[Matrix3<f64>; N]; N];

/// Strains (v, u), body frame, and the force n, world frame, at a point of a step.
pub(super) struct Section {
    pub(super) v: Vector3<f64>,
    pub(super) u: Vector3<f64>,
    pub(super) force: Vector3<f64>,
}

/// The section law (G 13, 15) at abscissa `c` (an index) of the step, under `factor` times the loads.
pub(super) fn section_law(step: &Step, c: usize, factor: f64, node: &Node) -> Section {
    let point = &step.stages[c];
    let force = factor * point.force + node.force;
    let v = Vector3::z() + point.shear.component_mul(&node.rotation.tr_mul(&force));
    let u = step.rest_curvature + point.bend.component_mul(&node.rotation.tr_mul(&node.moment));
    Section { v, u, force }
}

/// Integrates one step: Runge-Kutta of order 6 in Cayley coordinates of the rotation at its start
/// (a Runge-Kutta-Munthe-Kaas method: R stays a rotation). Returns the node at the end, before any jump,
/// and the change of position.
pub(super) fn integrate(step: &Step, factor: f64, start: &Node) -> (Node, Vector3<f64>) {
    let (end, position, _) = advance::<2, false>(step, factor, 1.0, start);
    (end, position)
}

/// [`integrate`] together with the variational equations. `softening` multiplies the compliance
/// in the variation alone (1 gives the derivative; see `stability`).
pub(super) fn integrate_with_transition<const N: usize>(
    step: &Step,
    factor: f64,
    softening: f64,
    start: &Node,
) -> (Node, Vector3<f64>, Transition<N>) {
    advance::<N, true>(step, factor, softening, start)
}

fn advance<const N: usize, const TRANSITION: bool>(
    step: &Step,
    factor: f64,
    softening: f64,
    start: &Node,
) -> (Node, Vector3<f64>, Transition<N>) {
    let h = step.length;
    let zero = Vector3::zeros();
    let (mut k_w, mut k_p, mut k_m, mut k_n) = ([zero; 7], [zero; 7], [zero; 7], [zero; 7]);
    let identity: Transition<N> = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            if i == j {
                Matrix3::identity()
            } else {
                Matrix3::zeros()
            }
        })
    });
    let mut k_y = [[[Matrix3::zeros(); N]; N]; 7];

    for stage in 0..7 {
        // state at the stage
        let (mut w, mut node) = (zero, *start);
        let mut y = identity;
        for j in 0..stage {
            let a = h * A[stage][j];
            if a == 0.0 {
                continue;
            }
            w += a * k_w[j];
            node.moment += a * k_m[j];
            node.force += a * k_n[j];
            if TRANSITION {
                for (row, k_row) in y.iter_mut().zip(&k_y[j]) {
                    for (block, k_block) in row.iter_mut().zip(k_row) {
                        *block += a * k_block;
                    }
                }
            }
        }
        node.rotation = start.rotation * cayley(&w);
        let c = STAGE_ABSCISSA[stage];
        let section = section_law(step, c, factor, &node);

        // R' = R hat(u), p' = R v, n' = -f, m' = -p' x n - l   (G 3, 4, 6, 11)
        let following_force = node.rotation * (factor * step.following_force);
        let following_moment = node.rotation * (factor * step.following_moment);
        k_w[stage] = cayley_rate(&w, &section.u);
        k_p[stage] = node.rotation * section.v;
        k_n[stage] = -following_force;
        k_m[stage] = section.force.cross(&k_p[stage]) - factor * step.moment_per_length - following_moment;

        if TRANSITION {
            let point = &step.stages[c];
            let rotate = |diagonal: &Vector3<f64>| {
                let mut scaled = node.rotation;
                for (mut column, d) in scaled.column_iter_mut().zip(diagonal.iter()) {
                    column *= softening * d;
                }
                scaled * node.rotation.transpose()
            };
            let (bend, shear) = (rotate(&point.bend), rotate(&point.shear));
            let (n_hat, p_hat) = (hat(&section.force), hat(&k_p[stage]));
            // y'  = bend (dm + m x y)
            // dp' = y x p' + shear (dn + n x y)
            // dm' = n x dp' - p' x dn - y x l_following
            // dn' = -y x f_following
            let y_y = bend * hat(&node.moment);
            let m_y = n_hat * (shear * n_hat - p_hat) + hat(&following_moment);
            let m_n = n_hat * shear - p_hat;
            let n_y = hat(&following_force);
            for column in 0..N {
                k_y[stage][0][column] = y_y * y[0][column] + bend * y[1][column];
                k_y[stage][1][column] = m_y * y[0][column];
                if N > 2 {
                    k_y[stage][1][column] += m_n * y[2][column];
                    k_y[stage][2][column] = n_y * y[0][column];
                }
            }
        }
    }

    let (mut w, mut position, mut end, mut y) = (zero, zero, *start, identity);
    for stage in 0..7 {
        let b = h * B[stage];
        w += b * k_w[stage];
        position += b * k_p[stage];
        end.moment += b * k_m[stage];
        end.force += b * k_n[stage];
        if TRANSITION {
            for (row, k_row) in y.iter_mut().zip(&k_y[stage]) {
                for (block, k_block) in row.iter_mut().zip(k_row) {
                    *block += b * k_block;
                }
            }
        }
    }
    end.rotation = start.rotation * cayley(&w);
    (end, position, y)
}

/// Passes a point load: the wrench beyond it lacks what it carries.
pub(super) fn pass(jump: &Jump, factor: f64, node: &mut Node) {
    node.moment -= factor * (jump.moment + node.rotation * jump.following_moment);
    node.force -= factor * (node.rotation * jump.following_force);
}

/// [`pass`] for the transition, with the rotation at the load.
pub(super) fn pass_transition<const N: usize>(
    jump: &Jump,
    factor: f64,
    rotation: &Matrix3<f64>,
    transition: &mut Transition<N>,
) {
    let moment = hat(&(rotation * (factor * jump.following_moment)));
    let force = hat(&(rotation * (factor * jump.following_force)));
    for column in 0..N {
        let y = transition[0][column];
        transition[1][column] += moment * y;
        if N > 2 {
            transition[2][column] += force * y;
        }
    }
}
