//! The energy of one Gauss node, with its gradient and Hessian.

use super::mesh::{NodeData, Passing};
use crate::geometry::{RotationVector, hat};
use crate::statics::section::Pulled;
use nalgebra::{Matrix3, Vector3};

/// The shape at a node: rotation vector since the panel's start and its rate, strains, rotation in the world.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) turn: RotationVector,
    pub(super) rate: Vector3<f64>,
    pub(super) v: Vector3<f64>,
    pub(super) u: Vector3<f64>,
    /// E(turn), and R = R_start E.
    pub(super) since_start: Matrix3<f64>,
    pub(super) rotation: Matrix3<f64>,
}

impl Shape {
    pub(super) fn new(start: &Matrix3<f64>, turn: Vector3<f64>, rate: Vector3<f64>, v: Vector3<f64>) -> Self {
        let turn = RotationVector::new(turn);
        let since_start = turn.rotation();
        Shape { u: turn.jacobian() * rate, turn, rate, v, rotation: start * since_start, since_start }
    }
}

/// What acts on a node beside the elastic law, world frame, with the load factor in it.
pub(super) struct Acting {
    /// Dead force beyond, less what the chords carry.
    pub(super) force: Vector3<f64>,
    pub(super) moment_per_length: Vector3<f64>,
    pub(super) gravity: Vector3<f64>,
}

/// Path of a channel tendon at a node: d(path length)/ds, its tangent, body frame.
pub(super) fn tangent(shape: &Shape, passing: &Passing) -> (f64, Vector3<f64>) {
    passing.pull(&[]).path(&shape.v, &shape.u)
}

/// A linear form on the variations of a node: of v, of the turn, of its rate, of the panel's start (body), of the force beyond (world).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Form {
    pub(super) v: Vector3<f64>,
    pub(super) turn: Vector3<f64>,
    pub(super) rate: Vector3<f64>,
    pub(super) start: Vector3<f64>,
    pub(super) force: Vector3<f64>,
}

/// Quadratic model of a node's energy after elimination of v, theory (32); rows and columns as in [`Form`].
#[derive(Clone, Debug)]
pub(super) struct Linearised {
    pub(super) turn_turn: Matrix3<f64>,
    pub(super) turn_rate: Matrix3<f64>,
    pub(super) rate_rate: Matrix3<f64>,
    pub(super) start_start: Matrix3<f64>,
    pub(super) start_turn: Matrix3<f64>,
    pub(super) turn_start: Matrix3<f64>,
    pub(super) start_rate: Matrix3<f64>,
    pub(super) turn_force: Matrix3<f64>,
    pub(super) rate_force: Matrix3<f64>,
    pub(super) start_force: Matrix3<f64>,
    pub(super) force_force: Matrix3<f64>,
    /// Inverse of the v-v block, and the v rows of the others.
    pub(super) v_v_inverse: Matrix3<f64>,
    pub(super) v_turn: Matrix3<f64>,
    pub(super) v_rate: Matrix3<f64>,
    pub(super) v_start: Matrix3<f64>,
    pub(super) v_force: Matrix3<f64>,
    /// Whether v could be eliminated from an energy that grows with it.
    pub(super) convex_in_v: bool,
}

/// The energy's gradient in the strains: K (xi - xi*) + sum tau (t, r x t).
pub(super) fn strain_gradient(
    data: &NodeData,
    passing: &[Passing],
    tensions: &[f64],
    shape: &Shape,
) -> (Vector3<f64>, Vector3<f64>) {
    let pulled = pulled(passing, tensions, shape);
    let force = data.shear.component_mul(&(shape.v - Vector3::z()));
    let moment = data.bend.component_mul(&(shape.u - data.rest_curvature));
    (force + pulled.force, moment + pulled.moment)
}

fn pulled(passing: &[Passing], tensions: &[f64], shape: &Shape) -> Pulled {
    let mut pulled = Pulled::default();
    for tendon in passing {
        pulled.add(&tendon.pull(tensions), &shape.v, &shape.u);
    }
    pulled
}

/// The energy's gradient at a node per unit weight, theory (31).
pub(super) fn gradient(
    data: &NodeData,
    passing: &[Passing],
    tensions: &[f64],
    shape: &Shape,
    acting: &Acting,
) -> Form {
    let (u_v, u_u) = strain_gradient(data, passing, tensions, shape);
    let force = shape.rotation.tr_mul(&acting.force);
    let weight = shape.rotation.tr_mul(&acting.gravity);
    let moment = shape.v.cross(&force)
        + data.mass_moment.cross(&weight)
        + shape.rotation.tr_mul(&acting.moment_per_length);
    let jacobian = shape.turn.jacobian();
    Form {
        v: u_v - force,
        turn: shape.turn.jacobian_differential(&shape.rate).tr_mul(&u_u) - jacobian.tr_mul(&moment),
        rate: jacobian.tr_mul(&u_u),
        start: -(shape.since_start * moment),
        force: Vector3::zeros(),
    }
}

/// The Hessian at a node per unit weight, with `shift` times the elastic part added, v eliminated.
pub(super) fn linearise(
    data: &NodeData,
    passing: &[Passing],
    tensions: &[f64],
    shape: &Shape,
    acting: &Acting,
    shift: f64,
) -> Linearised {
    let stiffer = 1.0 + shift;
    let mut u_v = data.shear.component_mul(&(shape.v - Vector3::z()));
    let mut u_u = data.bend.component_mul(&(shape.u - data.rest_curvature));
    let mut vv = Matrix3::from_diagonal(&(stiffer * data.shear));
    let mut uu = Matrix3::from_diagonal(&(stiffer * data.bend));
    let pulled = pulled(passing, tensions, shape);
    u_v += pulled.force;
    u_u += pulled.moment;
    vv += pulled.v_v;
    uu += pulled.u_u;
    let vu = pulled.v_u;
    let jacobian = shape.turn.jacobian();
    let b = shape.turn.jacobian_differential(&shape.rate);
    let back = shape.since_start.transpose();
    let to_body = shape.rotation.transpose();
    let (force, weight) = (to_body * acting.force, to_body * acting.gravity);
    let dead_moment = to_body * acting.moment_per_length;
    let moment = shape.v.cross(&force) + data.mass_moment.cross(&weight);

    // rotations of the section: of the panel's start before that since the start
    let in_order = -(hat(&force) * hat(&shape.v) + hat(&weight) * hat(&data.mass_moment));
    let either = 0.5 * (in_order + in_order.transpose());
    let curl = shape.turn.transpose_differential(&moment);
    let follow = jacobian.tr_mul(&(-hat(&dead_moment)));
    let uu_j = uu * jacobian;
    let mut model = Linearised {
        turn_turn: b.tr_mul(&uu) * b
            + shape.turn.second_differential(&u_u, &shape.rate)
            + jacobian.tr_mul(&either) * jacobian
            - 0.5 * (curl + curl.transpose())
            + follow * jacobian
            - shape.turn.transpose_differential(&dead_moment),
        turn_rate: b.tr_mul(&uu_j) + shape.turn.transpose_differential(&u_u).transpose(),
        rate_rate: jacobian.tr_mul(&uu_j),
        start_start: back.tr_mul(&either) * back - 0.5 * hat(&(shape.since_start * dead_moment)),
        start_turn: back.tr_mul(&in_order) * jacobian,
        turn_start: jacobian.tr_mul(&in_order.transpose()) * back + follow * back,
        start_rate: Matrix3::zeros(),
        turn_force: -jacobian.tr_mul(&hat(&shape.v)) * to_body,
        rate_force: Matrix3::zeros(),
        start_force: -back.tr_mul(&hat(&shape.v)) * to_body,
        force_force: Matrix3::zeros(),
        v_v_inverse: Matrix3::zeros(),
        v_turn: vu * b - hat(&force) * jacobian,
        v_rate: vu * jacobian,
        v_start: -hat(&force) * back,
        v_force: -to_body,
        convex_in_v: vv.cholesky().is_some(),
    };
    model.eliminate_v(&vv);
    model
}

impl Linearised {
    fn eliminate_v(&mut self, vv: &Matrix3<f64>) {
        self.v_v_inverse = vv.try_inverse().unwrap_or_else(|| Matrix3::from_element(f64::NAN));
        let z = &self.v_v_inverse;
        let (turn, rate, start) = (z * self.v_turn, z * self.v_rate, z * self.v_start);
        let force = z * self.v_force;
        self.turn_turn -= self.v_turn.tr_mul(&turn);
        self.turn_rate -= self.v_turn.tr_mul(&rate);
        self.rate_rate -= self.v_rate.tr_mul(&rate);
        self.start_start -= self.v_start.tr_mul(&start);
        self.start_turn -= self.v_start.tr_mul(&turn);
        self.turn_start -= self.v_turn.tr_mul(&start);
        self.start_rate -= self.v_start.tr_mul(&rate);
        self.turn_force -= self.v_turn.tr_mul(&force);
        self.rate_force -= self.v_rate.tr_mul(&force);
        self.start_force -= self.v_start.tr_mul(&force);
        self.force_force -= self.v_force.tr_mul(&force);
    }

    /// What is left of a right-hand side once v is eliminated.
    pub(super) fn condense(&self, right: &Form) -> Form {
        let v = self.v_v_inverse * right.v;
        Form {
            v: right.v,
            turn: right.turn - self.v_turn.tr_mul(&v),
            rate: right.rate - self.v_rate.tr_mul(&v),
            start: right.start - self.v_start.tr_mul(&v),
            force: right.force - self.v_force.tr_mul(&v),
        }
    }

    /// v from the others: `solved` holds their values, `right` the right-hand side.
    pub(super) fn recover_v(&self, right: &Vector3<f64>, solved: &Form) -> Vector3<f64> {
        self.v_v_inverse
            * (right
                - self.v_turn * solved.turn
                - self.v_rate * solved.rate
                - self.v_start * solved.start
                - self.v_force * solved.force)
    }
}
