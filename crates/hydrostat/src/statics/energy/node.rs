//! The energy of one Gauss node, with its gradient and Hessian.

use super::mesh::NodeData;
use crate::geometry::{RotationVector, hat};
use crate::numeric::blocks::symmetric;
use crate::statics::section::{Pulled, Stiffened};
use nalgebra::{Matrix3, Vector3};

/// The shape at a node: rotation vector since the panel's start and its rate, strains, rotation in the world.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    pub(super) turn: RotationVector,
    pub(super) rate: Vector3<f64>,
    pub(super) v: Vector3<f64>,
    pub(super) u: Vector3<f64>,
    /// E(turn), and R = R_start E.
    pub(super) since_start: Matrix3<f64>,
    pub(super) rotation: Matrix3<f64>,
    /// du = turn_u d(turn) + jacobian d(rate); jacobian d(turn) is the rotation of the section since the start, body frame.
    pub(super) jacobian: Matrix3<f64>,
    pub(super) turn_u: Matrix3<f64>,
}

impl Shape {
    /// Places the node by the rotation of the panel's start.
    #[inline]
    pub(super) fn place(
        &mut self,
        start: &Matrix3<f64>,
        turn: Vector3<f64>,
        rate: Vector3<f64>,
        v: Vector3<f64>,
    ) {
        let turn = RotationVector::new(turn);
        self.since_start = turn.rotation();
        self.jacobian = turn.jacobian();
        self.turn_u = turn.jacobian_differential(&rate);
        self.u = self.jacobian * rate;
        self.rotation = start * self.since_start;
        (self.turn, self.rate, self.v) = (turn, rate, v);
    }

    /// Rotation of the section by those of the panel's start and of the turn, body frame.
    #[inline]
    pub(super) fn turned(&self, start: &Vector3<f64>, turn: &Vector3<f64>) -> Vector3<f64> {
        self.since_start.tr_mul(start) + self.jacobian * turn
    }
}

/// What acts on a node beside the elastic law, world frame, with the load factor in it.
pub(super) struct Acting {
    /// Force beyond, less what the chords carry.
    pub(super) force: Vector3<f64>,
    pub(super) moment_per_length: Vector3<f64>,
    /// Of following moments, body frame.
    pub(super) following_moment: Vector3<f64>,
    pub(super) gravity: Vector3<f64>,
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
#[derive(Clone, Debug, Default)]
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
    /// Inverse of the v-v block; NaN where the energy does not grow with v.
    v_v_inverse: Matrix3<f64>,
    /// The v rows of du, None where no tendon passes; those of the section's rotation are -hat(force), that of the force beyond
    /// is -R^T.
    v_u: Option<Matrix3<f64>>,
    force: Vector3<f64>,
}

/// What pulls at a placed node in the body frame.
#[derive(Clone, Debug)]
pub(super) struct Local {
    /// The energy's gradient in v without its weight and without the force beyond: K_se (v - v*) + sum tau t.
    u_v: Vector3<f64>,
    /// The energy's gradient in u: K_bt (u - u*) + sum tau r x t.
    u_u: Vector3<f64>,
    force: Vector3<f64>,
    weight: Vector3<f64>,
    dead_moment: Vector3<f64>,
    following_moment: Vector3<f64>,
    /// Of the conservative forces about the section.
    moment: Vector3<f64>,
}

impl Local {
    /// `pulled` by the tendons that pass, if any do.
    pub(super) fn new(data: &NodeData, pulled: Option<&Pulled>, shape: &Shape, acting: &Acting) -> Self {
        let [force, moment] = &data.left_out;
        let mut u_v = data.shear.component_mul(&(shape.v - Vector3::z())) + force;
        let mut u_u = data.bend.component_mul(&(shape.u - data.rest_curvature)) + moment;
        if let Some(pulled) = pulled {
            u_v += pulled.force;
            u_u += pulled.moment;
        }
        let force = shape.rotation.tr_mul(&acting.force);
        let to_body =
            |of: &Vector3<f64>, acts: bool| if acts { shape.rotation.tr_mul(of) } else { Vector3::zeros() };
        let weight = to_body(&acting.gravity, data.mass_moment != Vector3::zeros());
        Local {
            u_v,
            u_u,
            moment: shape.v.cross(&force) + data.mass_moment.cross(&weight),
            dead_moment: to_body(&acting.moment_per_length, data.moment_per_length != Vector3::zeros()),
            following_moment: acting.following_moment,
            force,
            weight,
        }
    }

    /// Of the backbone, body frame: what acts beyond less what the chords carry.
    pub(super) fn force(&self) -> &Vector3<f64> {
        &self.force
    }

    /// The energy's gradient for the weight of the node, theory (31).
    pub(super) fn gradient(&self, data: &NodeData, shape: &Shape) -> Form {
        let moment = data.weight * (self.moment + self.dead_moment + self.following_moment);
        let u_u = data.weight * self.u_u;
        Form {
            v: data.weight * (self.u_v - self.force),
            turn: shape.turn_u.tr_mul(&u_u) - shape.jacobian.tr_mul(&moment),
            rate: shape.jacobian.tr_mul(&u_u),
            start: -(shape.since_start * moment),
            force: Vector3::zeros(),
        }
    }
}

/// The Hessian at a node per unit weight with `shift` times the elastic part added, v eliminated. The blocks of the force beyond
/// are filled where that force is `unknown`: beside chords, and before followers.
#[inline]
pub(super) fn linearise(
    data: &NodeData,
    shape: &Shape,
    local: &Local,
    stiffened: Option<&Stiffened>,
    shift: f64,
    unknown: bool,
) -> Linearised {
    let stiffer = 1.0 + shift;
    let Local { u_u, force, weight, moment, dead_moment, following_moment, .. } = local;
    let (jacobian, b, back) = (&shape.jacobian, &shape.turn_u, &shape.since_start);

    // v eliminated from the form in du, the section's rotation a, and the force beyond
    let v_turned = -hat(force);
    let (v_v_inverse, mut uu, ua);
    if let Some(tendons) = stiffened {
        v_v_inverse = convex_inverse(&(tendons.v_v + Matrix3::from_diagonal(&(stiffer * data.shear))));
        let du = v_v_inverse * tendons.v_u;
        (uu, ua) = (tendons.u_u - tendons.v_u.tr_mul(&du), -du.tr_mul(&v_turned));
        for axis in 0..3 {
            uu[(axis, axis)] += stiffer * data.bend[axis];
        }
    } else {
        v_v_inverse = Matrix3::from_diagonal(&(stiffer * data.shear).map(f64::recip));
        (uu, ua) = (Matrix3::from_diagonal(&(stiffer * data.bend)), Matrix3::zeros());
    }
    let da = v_v_inverse * v_turned;
    // rotations of the section: of the panel's start before that since the start
    let order = outer_less_dot(force, &shape.v) + outer_less_dot(weight, &data.mass_moment);
    let of_v = v_turned.tr_mul(&da);
    let either = symmetric(&order) - of_v;
    let in_order = order - of_v;

    let uu_rate = uu * jacobian;
    let start_a = back * in_order;
    let ua_turn = ua * jacobian;
    let mut model = Linearised {
        turn_turn: b.tr_mul(&(uu * b))
            + shape.turn.second_differential(u_u, &shape.rate)
            + jacobian.tr_mul(&(either * jacobian))
            - symmetric(&shape.turn.transpose_differential(moment)),
        turn_rate: b.tr_mul(&uu_rate) + shape.turn.transpose_differential(u_u).transpose(),
        rate_rate: jacobian.tr_mul(&uu_rate),
        start_start: back * (either * back.transpose()),
        start_turn: start_a * jacobian,
        turn_start: Matrix3::zeros(),
        start_rate: Matrix3::zeros(),
        turn_force: Matrix3::zeros(),
        rate_force: Matrix3::zeros(),
        start_force: Matrix3::zeros(),
        force_force: Matrix3::zeros(),
        v_v_inverse,
        v_u: stiffened.map(|tendons| tendons.v_u),
        force: *force,
    };
    if stiffened.is_some() {
        let mixed = b.tr_mul(&ua_turn);
        model.turn_turn += mixed + mixed.transpose();
        model.turn_rate += ua_turn.tr_mul(jacobian);
        let start_u = back * ua.transpose();
        model.start_turn += start_u * b;
        model.start_rate = start_u * jacobian;
    }
    model.turn_start = model.start_turn.transpose();
    if *dead_moment != Vector3::zeros() {
        // a dead moment is not the slope of an energy
        let follow = jacobian.tr_mul(&(-hat(dead_moment)));
        model.turn_turn += follow * jacobian - shape.turn.transpose_differential(dead_moment);
        model.turn_start += follow * back.transpose();
        model.start_start -= 0.5 * hat(&(back * dead_moment));
    }
    if *following_moment != Vector3::zeros() {
        model.turn_turn -= shape.turn.transpose_differential(following_moment);
        model.start_turn += back * hat(following_moment) * jacobian;
        model.start_start += 0.5 * hat(&(back * following_moment));
    }
    if unknown {
        let to_body = shape.rotation.transpose();
        let of_force = v_v_inverse * to_body;
        let turned_force = v_turned.tr_mul(&of_force) - hat(&shape.v) * to_body;
        model.turn_force = jacobian.tr_mul(&turned_force);
        model.start_force = back * turned_force;
        model.force_force = -(shape.rotation * of_force);
        if let Some(tendons) = stiffened {
            let u_force = tendons.v_u.tr_mul(&of_force);
            model.turn_force += b.tr_mul(&u_force);
            model.rate_force = jacobian.tr_mul(&u_force);
        }
    }
    model
}

/// hat(a) hat(b) with the sign changed: a . b - b a^T.
fn outer_less_dot(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(a.dot(b)) - b * a.transpose()
}

/// Inverse of a symmetric matrix; NaN where it is not positive definite.
fn convex_inverse(m: &Matrix3<f64>) -> Matrix3<f64> {
    let (a, b, c) = (m.column(0), m.column(1), m.column(2));
    let cross = b.cross(&c);
    let determinant = a.dot(&cross);
    let convex = m.m11 > 0.0 && m.m11 * m.m22 > m.m12 * m.m12 && determinant > 0.0;
    let scale = if convex { 1.0 / determinant } else { f64::NAN };
    scale * Matrix3::from_columns(&[cross, c.cross(&a), a.cross(&b)])
}

impl Linearised {
    /// What is left of a right-hand side once v is eliminated.
    #[inline]
    pub(super) fn condense(&self, shape: &Shape, right: &Form) -> Form {
        let v = self.v_v_inverse * right.v;
        let turned = self.force.cross(&v);
        let mut left = Form {
            v: right.v,
            turn: right.turn - shape.jacobian.tr_mul(&turned),
            rate: right.rate,
            start: right.start - shape.since_start * turned,
            force: right.force + shape.rotation * v,
        };
        if let Some(v_u) = &self.v_u {
            let u = v_u.tr_mul(&v);
            left.turn -= shape.turn_u.tr_mul(&u);
            left.rate -= shape.jacobian.tr_mul(&u);
        }
        left
    }

    /// v from the others: `solved` holds their values, `turned` the rotation of the section by them, `right` the right-hand side.
    #[inline]
    pub(super) fn recover_v(
        &self,
        shape: &Shape,
        right: &Vector3<f64>,
        solved: &Form,
        turned: &Vector3<f64>,
    ) -> Vector3<f64> {
        let mut of_v = right + self.force.cross(turned) + shape.rotation.tr_mul(&solved.force);
        if let Some(v_u) = &self.v_u {
            of_v -= v_u * (shape.turn_u * solved.turn + shape.jacobian * solved.rate);
        }
        self.v_v_inverse * of_v
    }
}
