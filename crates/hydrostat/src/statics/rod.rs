//! The equations of the rod over one integration step: state and transition matrix.

use super::section::{self, Pull, Stiffened};
use super::span::{Jump, Step};
use crate::geometry::{cayley, cayley_coordinates, cayley_rate, hat};
use crate::numeric::dop853::{B, STAGES, TABLEAU};
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

/// Strains (v, u), body frame, and the force n at a point of a step.
pub(super) struct Section {
    pub(super) v: Vector3<f64>,
    pub(super) u: Vector3<f64>,
    pub(super) force: Vector3<f64>,
}

impl Section {
    /// Force and moment in the backbone alone at the end of a step, world frame: of the whole section less the tendons. Of K (v - v*)
    /// rounding would leave little where the backbone is slender.
    pub(super) fn backbone(&self, step: &Step, node: &Node) -> (Vector3<f64>, Vector3<f64>) {
        let (mut force, mut moment) = (self.force, node.moment);
        for pull in pulls(step, END, 1.0) {
            let slope = pull.slope(&self.v, &self.u, &pull.path(&self.v, &self.u).tangent);
            force -= node.rotation * (pull.tension * slope.v);
            moment -= node.rotation * (pull.tension * slope.u);
        }
        (force, moment)
    }
}

/// R', p', m', n' at a point of a step; the rotation's by its body-frame rate u.
struct Rates {
    u: Vector3<f64>,
    position: Vector3<f64>,
    moment: Vector3<f64>,
    force: Vector3<f64>,
}

/// What loads a point of a step beyond the wrench of the node; in the frame of the node.
#[derive(Clone, Copy)]
struct Loads {
    /// Dead force n beyond the point, and dead moment l per length.
    force: Vector3<f64>,
    moment_per_length: Vector3<f64>,
    gravity: Vector3<f64>,
}

impl Loads {
    /// World frame.
    fn at(step: &Step, c: usize, factor: f64) -> Self {
        Loads {
            force: factor * step.stages[c].force,
            moment_per_length: factor * step.moment_per_length,
            gravity: factor * step.gravity,
        }
    }

    /// Seen from a rotated frame.
    #[inline(always)]
    fn seen_from(&self, frame: &Matrix3<f64>) -> Self {
        Loads {
            force: frame.tr_mul(&self.force),
            moment_per_length: frame.tr_mul(&self.moment_per_length),
            gravity: frame.tr_mul(&self.gravity),
        }
    }
}

/// The section law, theory (5).
///
/// ```text
/// R^T n = K_se (v - v*),   R^T m = K_bt (u - u*)
/// ```
#[inline(always)]
fn strains(step: &Step, c: usize, factor: f64, loads: &Loads, node: &Node) -> Section {
    let point = &step.stages[c];
    let force = loads.force + node.force;
    if !step.pulls.is_empty() {
        let (n, m) = (node.rotation.tr_mul(&force), node.rotation.tr_mul(&node.moment));
        let pulls = pulls(step, c, factor);
        let (v, u) = section::strains(&point.shear, &point.bend, &step.rest_curvature, pulls, &n, &m);
        return Section { v, u, force };
    }
    let v = Vector3::z() + point.shear.component_mul(&node.rotation.tr_mul(&force));
    let u = step.rest_curvature + point.bend.component_mul(&node.rotation.tr_mul(&node.moment));
    Section { v, u, force }
}

/// The channel tendons at a point of a step under `factor` times their tensions.
fn pulls(step: &Step, c: usize, factor: f64) -> impl Iterator<Item = Pull> + Clone + '_ {
    step.pulls.iter().map(move |points| Pull { tension: factor * points[c].tension, ..points[c] })
}

/// The section law at abscissa `c` (an index) of the step, under `factor` times the loads; world frame.
pub(super) fn section_law(step: &Step, c: usize, factor: f64, node: &Node) -> Section {
    strains(step, c, factor, &Loads::at(step, c, factor), node)
}

/// The equations of the rod, theory (1) to (4), in any frame at rest.
///
/// ```text
/// R' = R hat(u),   p' = R v,   n' = -f,   m' = -p' x n - l
/// ```
#[inline(always)]
fn rates(step: &Step, c: usize, factor: f64, loads: &Loads, node: &Node) -> Rates {
    let section = strains(step, c, factor, loads, node);
    let position = node.rotation * section.v;
    let mut moment = section.force.cross(&position) - loads.moment_per_length;
    if step.gravity != Vector3::zeros() {
        moment -= (node.rotation * step.stages[c].mass_moment).cross(&loads.gravity);
    }
    if !step.follows {
        return Rates { u: section.u, position, moment, force: Vector3::zeros() };
    }
    let moment = moment - node.rotation * (factor * step.following_moment);
    Rates { u: section.u, position, moment, force: node.rotation * (-factor * step.following_force) }
}

/// Integrates one step: the Runge-Kutta method DOP853 in the frame of the start and in Cayley coordinates of
/// the rotation since then, theory (12, 13): a Runge-Kutta-Munthe-Kaas method of order 8, R stays a rotation. Returns the
/// node at the end, before any jump, and the change of position.
pub(super) fn integrate(step: &Step, factor: f64, start: &Node) -> (Node, Vector3<f64>) {
    let h = step.length;
    let frame = &start.rotation;
    let moment = frame.tr_mul(&start.moment);
    let force = frame.tr_mul(&start.force);
    // rates of: rotation (3), moment (3); position; following force
    let mut state_rate = [[0.0; 6]; STAGES];
    let (mut p_rate, mut n_rate) = ([Vector3::zeros(); STAGES], [Vector3::zeros(); STAGES]);
    for stage in 0..STAGES {
        let mut state = [0.0; 6];
        let mut node = Node { rotation: Matrix3::zeros(), moment, force };
        for &(j, a) in TABLEAU[stage] {
            for (state, rate) in state.iter_mut().zip(&state_rate[j]) {
                *state += (h * a) * rate;
            }
            if step.follows {
                node.force += (h * a) * n_rate[j];
            }
        }
        let w = Vector3::new(state[0], state[1], state[2]);
        node.rotation = cayley(&w);
        node.moment += Vector3::new(state[3], state[4], state[5]);
        let loads = Loads::at(step, stage, factor).seen_from(frame);
        let rates = rates(step, stage, factor, &loads, &node);
        let turning = cayley_rate(&w, &rates.u);
        state_rate[stage] = [turning.x, turning.y, turning.z, rates.moment.x, rates.moment.y, rates.moment.z];
        p_rate[stage] = rates.position;
        n_rate[stage] = rates.force;
    }
    let (mut w, mut moment, mut force, mut position) = (Vector3::zeros(), moment, force, Vector3::zeros());
    for stage in 0..STAGES {
        if B[stage] != 0.0 {
            let (b, rate) = (h * B[stage], &state_rate[stage]);
            w += b * Vector3::new(rate[0], rate[1], rate[2]);
            moment += b * Vector3::new(rate[3], rate[4], rate[5]);
            position += b * p_rate[stage];
            force += b * n_rate[stage];
        }
    }
    // a force that nothing changes stays what it is, whatever rounding does to the frame
    let force = if step.follows { frame * force } else { start.force };
    let end = Node { rotation: frame * cayley(&w), moment: frame * moment, force };
    (end, frame * position)
}

/// The transition over a step from its two ends, by the variational equations `Y' = H(s) Y`.
///
/// Classical Runge-Kutta (order 4) with H at both ends and in the middle, where the state is Hermite's
/// cubic. `softening` multiplies the compliance in H: 1 gives the derivative.
pub(super) fn transition<const N: usize>(
    step: &Step,
    factor: f64,
    softening: f64,
    start: &Node,
    end: &Node,
) -> Transition<N> {
    let h = step.length;
    let middle = middle(step, factor, start, end);
    let variation = |c, node| Variation::new(step, c, factor, softening, node);
    let (first, second, third) = (variation(START, start), variation(MIDDLE, &middle), variation(END, end));
    let k1: Transition<N> = first.blocks();
    let k2: Transition<N> = second.times_identity_plus(0.5 * h, &k1);
    let k3: Transition<N> = second.times_identity_plus(0.5 * h, &k2);
    let k4: Transition<N> = third.times_identity_plus(h, &k3);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let sum = k1[i][j] + 2.0 * (k2[i][j] + k3[i][j]) + k4[i][j];
            let identity = if i == j { Matrix3::identity() } else { Matrix3::zeros() };
            identity + h / 6.0 * sum
        })
    })
}

/// The state in the middle of a step by Hermite's cubic.
#[inline(always)]
fn middle(step: &Step, factor: f64, start: &Node, end: &Node) -> Node {
    let h = step.length;
    let rates = |c, node| rates(step, c, factor, &Loads::at(step, c, factor), node);
    let (at_start, at_end) = (rates(START, start), rates(END, end));
    let w = cayley_coordinates(&start.rotation.tr_mul(&end.rotation));
    let w_middle = 0.5 * w + h / 8.0 * (at_start.u - cayley_rate(&w, &at_end.u));
    Node {
        rotation: start.rotation * cayley(&w_middle),
        moment: 0.5 * (start.moment + end.moment) + h / 8.0 * (at_start.moment - at_end.moment),
        force: 0.5 * (start.force + end.force) + h / 8.0 * (at_start.force - at_end.force),
    }
}

/// Indices of the ends and the middle among the points of a step.
pub(super) const START: usize = 0;
pub(super) const END: usize = STAGES - 1;
pub(super) const MIDDLE: usize = STAGES;

/// The matrix H of the variational equations, theory (14), by its blocks that are not zero.
///
/// ```text
/// y'  = bend (dm + m x y)
/// dp' = y x p' + shear (dn + n x y)
/// dm' = n x dp' - p' x dn - y x l_following
/// dn' = -y x f_following
/// ```
/// with `bend` = R K_bt^-1 R^T and `shear` = R K_se^-1 R^T.
struct Variation {
    y_y: Matrix3<f64>,
    y_m: Matrix3<f64>,
    y_n: Matrix3<f64>,
    m_y: Matrix3<f64>,
    m_m: Matrix3<f64>,
    m_n: Matrix3<f64>,
    n_y: Matrix3<f64>,
    /// Of p', which nothing else depends on.
    p_y: Matrix3<f64>,
    p_m: Matrix3<f64>,
    p_n: Matrix3<f64>,
    /// Whether tendons couple shear with bending: otherwise y_n and m_m are zero.
    coupled: bool,
}

impl Variation {
    #[inline(always)]
    fn new(step: &Step, c: usize, factor: f64, softening: f64, node: &Node) -> Self {
        let point = &step.stages[c];
        let section = section_law(step, c, factor, node);
        let (n_hat, p_hat) = (hat(&section.force), hat(&(node.rotation * section.v)));
        let following_moment = node.rotation * (factor * step.following_moment);
        let following_force = node.rotation * (factor * step.following_force);
        let (bend, shear) = (softening * point.bend, softening * point.shear);
        let mut follow = hat(&following_moment);
        if step.gravity != Vector3::zeros() {
            let weighed = hat(&(node.rotation * point.mass_moment));
            follow -= hat(&(factor * step.gravity)) * weighed;
        }
        let n_y = hat(&following_force);
        let zero = Matrix3::zeros();
        if step.pulls.is_empty() {
            let (bend, shear) = (turned(&node.rotation, &bend), turned(&node.rotation, &shear));
            let n_shear = n_hat * shear;
            return Variation {
                y_y: bend * hat(&node.moment),
                y_m: bend,
                y_n: zero,
                m_y: (n_shear * n_hat - n_hat * p_hat) + follow,
                m_m: zero,
                m_n: n_shear - p_hat,
                n_y,
                p_y: shear * n_hat - p_hat,
                p_m: zero,
                p_n: shear,
                coupled: false,
            };
        }
        let pulls = pulls(step, c, factor).map(|pull| (pull, pull.path(&section.v, &section.u)));
        let stiffened = Stiffened::new(pulls, &bend.map(f64::recip), &section.v, &section.u);
        let to_world = |block: Matrix3<f64>| node.rotation * block * node.rotation.transpose();
        let blocks =
            section::compliance(&shear, &bend, &stiffened).unwrap_or([Matrix3::from_element(f64::NAN); 4]);
        let [v_n, v_m, u_n, u_m] = blocks.map(to_world);
        let m_hat = hat(&node.moment);
        let p_y = v_n * n_hat + v_m * m_hat - p_hat;
        Variation {
            y_y: u_m * m_hat + u_n * n_hat,
            y_m: u_m,
            y_n: u_n,
            m_y: n_hat * p_y + follow,
            m_m: n_hat * v_m,
            m_n: n_hat * v_n - p_hat,
            n_y,
            p_y,
            p_m: v_m,
            p_n: v_n,
            coupled: true,
        }
    }

    fn blocks<const N: usize>(&self) -> Transition<N> {
        let mut blocks = [[Matrix3::zeros(); N]; N];
        blocks[0][0] = self.y_y;
        blocks[0][1] = self.y_m;
        blocks[1][0] = self.m_y;
        blocks[1][1] = self.m_m;
        if N > 2 {
            blocks[0][2] = self.y_n;
            blocks[1][2] = self.m_n;
            blocks[2][0] = self.n_y;
        }
        blocks
    }

    /// H (I + a K).
    #[inline(always)]
    fn times_identity_plus<const N: usize>(&self, a: f64, k: &Transition<N>) -> Transition<N> {
        let mut product = self.blocks();
        for j in 0..N {
            product[0][j] += a * (self.y_y * k[0][j] + self.y_m * k[1][j]);
            product[1][j] += a * (self.m_y * k[0][j]);
            if self.coupled {
                product[1][j] += a * (self.m_m * k[1][j]);
            }
            if N > 2 {
                if self.coupled {
                    product[0][j] += a * (self.y_n * k[2][j]);
                }
                product[1][j] += a * (self.m_n * k[2][j]);
                product[2][j] += a * (self.n_y * k[0][j]);
            }
        }
        product
    }

    /// Rows of p' applied to a transition.
    fn displacement(&self, t: &Transition<3>) -> [Matrix3<f64>; 3] {
        [0, 1, 2].map(|j| self.p_y * t[0][j] + self.p_m * t[1][j] + self.p_n * t[2][j])
    }
}

/// d(displacement over a step) over (rotation, moment, force) at its start, from its transition: Simpson's rule, with the
/// transition to the middle by Hermite's cubic.
pub(super) fn displacement_transition(
    step: &Step,
    factor: f64,
    softening: f64,
    start: &Node,
    end: &Node,
    transition: &Transition<3>,
) -> [Matrix3<f64>; 3] {
    let h = step.length;
    let variation = |c, node| Variation::new(step, c, factor, softening, node);
    let middle = middle(step, factor, start, end);
    let (first, second, third) = (variation(START, start), variation(MIDDLE, &middle), variation(END, end));
    let identity: Transition<3> = std::array::from_fn(|i| {
        std::array::from_fn(|j| if i == j { Matrix3::identity() } else { Matrix3::zeros() })
    });
    let (slope, end_slope) = (first.blocks::<3>(), third.applied(transition));
    let half: Transition<3> = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            0.5 * (identity[i][j] + transition[i][j]) + h / 8.0 * (slope[i][j] - end_slope[i][j])
        })
    });
    let (a, b, c) =
        (first.displacement(&identity), second.displacement(&half), third.displacement(transition));
    [0, 1, 2].map(|j| h / 6.0 * (a[j] + 4.0 * b[j] + c[j]))
}

impl Variation {
    /// H T.
    fn applied(&self, t: &Transition<3>) -> Transition<3> {
        let h = self.blocks::<3>();
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| h[i][k] * t[k][j]).sum()))
    }
}

/// R diag(d) R^T.
#[inline(always)]
fn turned(rotation: &Matrix3<f64>, d: &Vector3<f64>) -> Matrix3<f64> {
    let mut scaled = *rotation;
    for (mut column, d) in scaled.column_iter_mut().zip(d.iter()) {
        column *= *d;
    }
    scaled * rotation.transpose()
}

/// Passes a point load, theory (11): the wrench beyond it lacks what it carries.
pub(super) fn pass(jump: &Jump, factor: f64, node: &mut Node) {
    let hung = (node.rotation * jump.hung).cross(&jump.gravity);
    node.moment -= factor * (jump.moment + hung + node.rotation * jump.following_moment);
    node.force -= factor * (node.rotation * jump.following_force);
}

/// [`pass`] for the transition, with the rotation at the load.
pub(super) fn pass_transition<const N: usize>(
    jump: &Jump,
    factor: f64,
    rotation: &Matrix3<f64>,
    transition: &mut Transition<N>,
) {
    let weighed = factor * (hat(&jump.gravity) * hat(&(rotation * jump.hung)));
    let moment = hat(&(rotation * (factor * jump.following_moment))) - weighed;
    let force = hat(&(rotation * (factor * jump.following_force)));
    let turn = transition[0];
    for (entry, y) in transition[1].iter_mut().zip(&turn) {
        *entry += moment * y;
    }
    if N > 2 {
        for (entry, y) in transition[2].iter_mut().zip(&turn) {
            *entry += force * y;
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::chain::Chain;
    use super::*;
    use crate::Robot;
    use crate::model::{CrossSection, Frame, Load, LoadKind, Material, Pose, Profile, Section};
    use nalgebra::Rotation3;
    use std::f64::consts::PI;

    /// Stated orders of the state and of its transition, and how far an observed order may be from them.
    const STATE_ORDER: f64 = 8.0;
    const TRANSITION_ORDER: f64 = 4.0;
    const ORDER_MARGIN: f64 = 0.2;
    /// Steps of the transition that is held against differences: its own error is then below 1e-8.
    const STEPS: usize = 256;
    /// Step of the central differences in units of 1, and what they leave: h^2, and the rounding of 256 steps, 1e-12 / h.
    const DIFFERENCE: f64 = 1e-5;
    const LEFT_BY_DIFFERENCES: f64 = 1e-7;

    /// A tapered rod of unit length, stiffness near 1, bent and twisted at rest, under dead loads in space and, if
    /// asked for, such that follow it. At the tip forces and moments of the same kinds.
    pub(in super::super) fn tapered_rod(follower: bool) -> Robot {
        let diameter: f64 = 0.1;
        let youngs_modulus = 64.0 / (PI * diameter.powi(4));
        let round = |diameter| CrossSection::Round { diameter };
        let of = |frame, scale: f64| {
            let point = LoadKind::Point {
                at: 1.0,
                force: scale * Vector3::new(0.5, 0.4, -0.3),
                moment: scale * Vector3::new(-0.2, 0.3, 0.1),
                frame,
            };
            let distributed = LoadKind::Distributed {
                from: 0.0,
                to: 1.0,
                force_per_length: scale * Vector3::new(-0.6, 0.8, 0.5),
                moment_per_length: scale * Vector3::new(0.2, -0.3, 0.4),
                frame,
            };
            [point, distributed].map(|kind| Load { name: None, kind })
        };
        let mut loads = Vec::from(of(Frame::World, 1.0));
        if follower {
            loads.extend(of(Frame::Body, -0.7));
        }
        Robot {
            tendons: Vec::new(),
            actuation: Vec::new(),
            name: "tapered rod".into(),
            gravity: Vector3::new(0.2, -0.3, -1.0),
            base: Pose { position: Vector3::zeros(), rotation: Rotation3::from_euler_angles(0.4, 1.0, -0.3) },
            sections: vec![Section {
                name: "tapered".into(),
                length: 1.0,
                material: Material {
                    name: "unit stiffness".into(),
                    youngs_modulus,
                    shear_modulus: youngs_modulus / 2.6,
                    density: 100.0,
                    strain_limit: None,
                },
                profile: Profile {
                    base: round(diameter),
                    tip: round(0.8 * diameter),
                    shear_coefficient: 0.9,
                },
                rest_curvature: Vector3::new(1.0, -1.5, 0.8),
                guides: None,
            }],
            loads,
        }
    }

    /// The one span of a robot in equal steps, with a load at its end.
    fn steps(robot: &Robot, count: usize) -> (Vec<Step>, Jump) {
        let mut chain = Chain::default();
        chain.rebuild(robot);
        let length = 1.0 / count as f64;
        let step = |i| chain.spans[0].step(robot, &[], i as f64 * length, length);
        ((0..count).map(step).collect(), chain.spans[0].jump)
    }

    /// A wrench at the base as large as the loads make it.
    fn start(robot: &Robot, follower: bool) -> Node {
        let force = if follower { Vector3::new(-0.4, 0.9, 0.3) } else { Vector3::zeros() };
        Node { rotation: *robot.base.rotation.matrix(), moment: Vector3::new(0.8, -0.6, 0.5), force }
    }

    fn integrate_all(steps: &[Step], factor: f64, start: Node) -> (Node, Vector3<f64>) {
        steps.iter().fold((start, Vector3::zeros()), |(node, position), step| {
            let (end, displacement) = integrate(step, factor, &node);
            (end, position + displacement)
        })
    }

    fn transition_of_all<const N: usize>(steps: &[Step], start: Node) -> Transition<N> {
        let identity: Transition<N> = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { Matrix3::identity() } else { Matrix3::zeros() })
        });
        let mut node = start;
        steps.iter().fold(identity, |product, step| {
            let end = integrate(step, 1.0, &node).0;
            let factor = transition::<N>(step, 1.0, 1.0, &node, &end);
            node = end;
            std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..N).map(|k| factor[i][k] * product[k][j]).sum())
            })
        })
    }

    /// The observed order falls to 8 from above while the steps shorten, and reaches it just before rounding does. The rest
    /// curvature, loads and steps are therefore chosen, by a scan over them, so that the range in between is wide enough.
    #[test]
    fn the_state_converges_with_order_eight() {
        for (follower, rest, load) in [(false, 0.5, 0.8), (true, 0.9, 0.7)] {
            let mut robot = tapered_rod(follower);
            robot.sections[0].rest_curvature *= rest;
            let mut start = start(&robot, follower);
            start.moment *= load;
            start.force *= load;
            let at = |count| integrate_all(&steps(&robot, count).0, load, start);
            let (exact, exact_position) = at(24);
            let errors = [8, 12].map(|count| {
                let (end, position) = at(count);
                [
                    (end.rotation - exact.rotation).norm(),
                    (end.moment - exact.moment).norm() + (end.force - exact.force).norm(),
                    (position - exact_position).norm(),
                ]
            });
            for (i, name) in ["rotation", "wrench", "position"].into_iter().enumerate() {
                let order = (errors[0][i] / errors[1][i]).ln() / 1.5_f64.ln();
                assert!((order - STATE_ORDER).abs() <= ORDER_MARGIN, "{name}: order {order:.2}, {errors:?}");
            }
        }
    }

    #[test]
    fn the_transition_converges_with_order_four() {
        fn observed<const N: usize>(follower: bool) {
            let robot = tapered_rod(follower);
            let at = |count| transition_of_all::<N>(&steps(&robot, count).0, start(&robot, follower));
            let exact = at(1024);
            let error = |count| {
                flat::<N>(&at(count))
                    .iter()
                    .zip(flat::<N>(&exact))
                    .map(|(a, b)| (a - b).powi(2))
                    .sum::<f64>()
                    .sqrt()
            };
            let (coarse, fine) = (error(32), error(64));
            let order = (coarse / fine).log2();
            assert!(
                (order - TRANSITION_ORDER).abs() <= ORDER_MARGIN,
                "N = {N}: {order:.2}, {coarse:e}, {fine:e}"
            );
        }
        observed::<2>(false);
        observed::<3>(true);
    }

    fn flat<const N: usize>(transition: &Transition<N>) -> Vec<f64> {
        transition.iter().flatten().flat_map(|block| block.iter().copied()).collect()
    }

    /// Change of the end over a change of the start, by central differences; with the load at the end passed or not.
    fn differences<const N: usize>(end: impl Fn(&Node) -> Node, start: &Node) -> Transition<N> {
        let mut blocks = [[Matrix3::zeros(); N]; N];
        for (of, axis) in (0..N).flat_map(|of| [0, 1, 2].map(|axis| (of, axis))) {
            let moved = |by: f64| {
                let (mut node, by) = (*start, by * Vector3::ith(axis, 1.0));
                match of {
                    0 => node.rotation = cayley(&by) * node.rotation,
                    1 => node.moment += by,
                    _ => node.force += by,
                }
                end(&node)
            };
            let (ahead, behind) = (moved(DIFFERENCE), moved(-DIFFERENCE));
            let turned = cayley_coordinates(&(ahead.rotation * behind.rotation.transpose()));
            let changes = [turned, ahead.moment - behind.moment, ahead.force - behind.force];
            for (row, change) in changes.iter().enumerate().take(N) {
                blocks[row][of].set_column(axis, &(change / (2.0 * DIFFERENCE)));
            }
        }
        blocks
    }

    fn assert_equal<const N: usize>(name: &str, ours: &Transition<N>, expected: &Transition<N>) {
        for i in 0..N {
            for j in 0..N {
                let off = (ours[i][j] - expected[i][j]).amax();
                assert!(off < LEFT_BY_DIFFERENCES, "{name}, N = {N}, block {i}{j}: {off:.1e}");
            }
        }
    }

    fn assert_derivatives<const N: usize>(follower: bool) {
        let robot = tapered_rod(follower);
        let (steps, jump) = steps(&robot, STEPS);
        let start = start(&robot, follower);
        let mut ours = transition_of_all::<N>(&steps, start);
        let end = |node: &Node| integrate_all(&steps, 1.0, *node).0;
        assert_equal("transition", &ours, &differences::<N>(end, &start));
        pass_transition(&jump, 1.0, &end(&start).rotation, &mut ours);
        let beyond = |node: &Node| {
            let mut node = end(node);
            pass(&jump, 1.0, &mut node);
            node
        };
        assert_equal("with the load passed", &ours, &differences::<N>(beyond, &start));
    }

    #[test]
    fn the_transition_is_the_derivative_of_the_integration() {
        assert_derivatives::<2>(false);
        assert_derivatives::<3>(false);
        assert_derivatives::<3>(true);
    }

    /// One step as the solver takes it: the same derivative, up to the transition's own order in the step.
    #[test]
    fn one_short_step_has_the_same_derivative() {
        let robot = tapered_rod(true);
        let steps = steps(&robot, STEPS).0;
        let start = start(&robot, true);
        let end = |node: &Node| integrate(&steps[0], 1.0, node).0;
        let ours = transition::<3>(&steps[0], 1.0, 1.0, &start, &end(&start));
        assert_equal("one step", &ours, &differences::<3>(end, &start));
    }
}
