//! How the solution answers small changes: further right-hand sides of its factors, by the implicit function theorem.
//!
//! At the equilibrium the gradient vanishes and taut tendons held by displacement have no excess of length. A small change moves both at
//! a fixed shape ([`Push`]); the shape and the tensions follow so that both vanish again, theory (38).

use super::mesh::{Layout, Mesh, Tables};
use super::newton::Equations;
use super::sweep::{Column, Folded, Problem, Step, Sweep};
use super::tendons::{self, Drive};
use super::{Energy, Memory, friction};
use crate::geometry::RotationVector;
use crate::model::Command;
use crate::numeric::anderson::Anderson;
use crate::numeric::larger;
use crate::solution::{Derivative, PoseDerivative, TendonDerivative};
use crate::statics::chain::Chain;
use crate::statics::derivatives::Input;
use crate::{Error, Robot};
use nalgebra::{DMatrix, DVector, Dyn, LU, Matrix3, Vector3};

/// Derivatives of the poses at `places` and of the tendons at the last solution.
pub(in crate::statics) fn derivatives(
    energy: &mut Energy,
    robot: &Robot,
    chain: &Chain,
    places: &[f64],
    inputs: &[Input],
) -> Result<Vec<Derivative>, Error> {
    energy.bring_gaps(robot, chain);
    let Energy { tables, layouts, coarse, memory, seen, .. } = energy;
    if robot.tendons.len() != memory.drive.tensions.len() {
        return Err(Error::new("the robot has other tendons than the one that was solved"));
    }
    let equations = Equations { robot, chain, tables, factor: 1.0 };
    let Memory { sweep, drive, .. } = memory;
    let factored = match sweep.factored {
        Some(negative) if seen.factors_fit => Some(negative),
        // those at hand are of a shape before the last steps, or of another matrix
        _ => sweep.factor(&equations.problem(&drive.tensions), coarse, 0.0),
    };
    let mut solution = Solution { robot, chain, tables, layouts, mesh: coarse, sweep, drive, places };
    let border = factored.and_then(|_| solution.border());
    let border = border.ok_or_else(|| {
        Error::new("the equilibrium is about to snap or buckle, and has no derivatives there")
            .hint("change the loads or commands a little")
    })?;
    // memory that the inputs share
    let (mut push, mut answer) = (Push::default(), Answer::default());
    let respond = |input| {
        solution.push(input, &mut push)?;
        solution.respond(&border, &mut push, &mut answer)
    };
    inputs.iter().map(respond).collect()
}

/// The last solution with the factors of its Hessian.
struct Solution<'a> {
    robot: &'a Robot,
    chain: &'a Chain,
    tables: &'a Tables,
    layouts: &'a [Layout],
    mesh: &'a Mesh,
    sweep: &'a mut Sweep,
    drive: &'a Drive,
    places: &'a [f64],
}

/// The tendons in the equations: what they add to the factors.
struct Border {
    /// d(length), of every tendon.
    lengths: Vec<Folded>,
    /// The tendons that keep their displacement, and the shape's answer to the pull of each.
    taut: Vec<usize>,
    responses: Vec<Step>,
    /// G H^-1 G^T + stretch, theory (36); empty without taut tendons.
    compliance: LU<f64, Dyn, Dyn>,
}

/// What a small change does while the shape and the tensions of the taut tendons stay.
#[derive(Default)]
struct Push {
    /// Minus the change of the gradient.
    right: Column,
    /// Of the excess of length, per tendon.
    excess: Vec<f64>,
    fixed: Derivative,
}

/// How shape and tensions answer a push.
#[derive(Default)]
struct Answer {
    step: Step,
    /// Of the taut tendons.
    tensions: Vec<f64>,
    /// Of the tendons by friction alone; empty without.
    stretch: Vec<f64>,
    /// How the cuts move, world frame.
    cuts: Vec<Vector3<f64>>,
}

/// Turns of shape and friction, and the relative change that ends them.
const MOST_TURNS: usize = 50;
const SETTLED: f64 = 1e-10;
/// Turn of a difference along a variation, rad.
const SMALL: f64 = 1e-5;

impl Solution<'_> {
    /// None where the tendons' lengths do not determine their tensions.
    fn border(&mut self) -> Option<Border> {
        let count = self.robot.tendons.len();
        let Drive { held, taut, .. } = self.drive;
        let taut: Vec<usize> =
            held.iter().zip(taut).filter(|(_, taut)| **taut).map(|(held, _)| *held).collect();
        let mut form = Column::default();
        let mut lengths = vec![Folded::default(); count];
        for (tendon, folded) in lengths.iter_mut().enumerate() {
            tendons::length_form(self.mesh, self.sweep, tendon, false, &mut form);
            form.fold(self.sweep, self.mesh, self.tables, folded);
        }
        let mut responses = vec![Step::default(); taut.len()];
        for (&tendon, response) in taut.iter().zip(&mut responses) {
            tendons::length_form(self.mesh, self.sweep, tendon, true, &mut form);
            self.sweep.solve(self.mesh, self.tables, &form, response);
        }
        let compliance = DMatrix::from_fn(taut.len(), taut.len(), |i, j| {
            let stretch = if i == j { self.drive.compliance(self.robot, taut[i]) } else { 0.0 };
            lengths[taut[i]].dot(&responses[j]) + stretch
        });
        let compliance = compliance.lu();
        (taut.is_empty() || compliance.is_invertible()).then_some(Border {
            lengths,
            taut,
            responses,
            compliance,
        })
    }

    /// What an input does at a fixed shape.
    fn push(&self, input: &Input, push: &mut Push) -> Result<(), Error> {
        let count = self.robot.tendons.len();
        push.excess.clear();
        push.excess.resize(count, 0.0);
        push.fixed = Derivative {
            poses: vec![PoseDerivative::default(); self.places.len()],
            tendons: vec![TendonDerivative::default(); count],
        };
        let right = &mut push.right;
        match *input {
            Input::Command(tendon) => match self.robot.actuation[tendon] {
                Command::Tension { .. } => {
                    tendons::length_form(self.mesh, self.sweep, tendon, true, right);
                    right.negate();
                    let displacement = self.drive.compliance(self.robot, tendon);
                    push.fixed.tendons[tendon] = TendonDerivative { tension: 1.0, displacement, length: 0.0 };
                }
                Command::Displacement { .. } => {
                    right.clear(self.mesh);
                    push.excess[tendon] = 1.0;
                }
            },
            Input::TipWrench { force, moment } => self.tip_work(&force, &moment, right),
            Input::Parameter { behind, ahead, step } => {
                right.clear(self.mesh);
                let [behind, ahead] = [self.state_of(behind)?, self.state_of(ahead)?];
                push.difference(&behind, &ahead, step);
            }
        }
        Ok(())
    }

    /// Work of a dead wrench at the tip, as a linear form: F . dp + M . w.
    fn tip_work(&self, force: &Vector3<f64>, moment: &Vector3<f64>, column: &mut Column) {
        column.clear(self.mesh);
        for ((data, shape), form) in self.mesh.data.iter().zip(&self.sweep.shapes).zip(&mut column.nodes) {
            let force = data.weight * shape.rotation.tr_mul(force);
            let turning = shape.v.cross(&force);
            form.v = force;
            form.turn = shape.jacobian.tr_mul(&turning);
            form.start = shape.since_start * turning;
        }
        let tip = self.mesh.panels.len();
        column.cuts[tip] = self.mesh.rotations[tip].tr_mul(moment);
    }

    /// The change of everything that is seen.
    fn respond(
        &mut self,
        border: &Border,
        push: &mut Push,
        answer: &mut Answer,
    ) -> Result<Derivative, Error> {
        if self.robot.tendons.iter().any(|tendon| tendon.friction > 0.0) {
            *answer = self.rub(border, push)?;
        } else {
            self.hold(border, &push.right, &push.excess, answer);
        }
        let Answer { step, tensions, stretch, cuts } = answer;
        let mut derivative = std::mem::take(&mut push.fixed);
        for (&tendon, tension) in border.taut.iter().zip(&*tensions) {
            derivative.tendons[tendon].tension += tension;
            derivative.tendons[tendon].displacement += self.drive.compliance(self.robot, tendon) * tension;
        }
        for (tendon, stretch) in derivative.tendons.iter_mut().zip(&*stretch) {
            tendon.displacement += stretch;
        }
        for (tendon, form) in derivative.tendons.iter_mut().zip(&border.lengths) {
            let length = form.dot(step);
            tendon.length += length;
            tendon.displacement -= length;
        }
        self.move_poses(step, cuts, &mut derivative.poses);
        Ok(derivative)
    }

    /// Shape and tensions that bring gradient and excess back to zero, theory (39).
    fn hold(&mut self, border: &Border, right: &Column, excess: &[f64], answer: &mut Answer) {
        let Answer { step, tensions, .. } = answer;
        self.sweep.solve(self.mesh, self.tables, right, step);
        tensions.clear();
        if !border.taut.is_empty() {
            let excess = |&tendon: &usize| border.lengths[tendon].dot(step) + excess[tendon];
            let mut solved = DVector::from_vec(border.taut.iter().map(excess).collect());
            border.compliance.solve_mut(&mut solved);
            tensions.extend(solved.iter());
        }
        for (tension, response) in tensions.iter().zip(&border.responses) {
            step.add(-tension, response);
        }
    }

    /// With friction the tensions along the tendons follow the shape, and the shape follows them: in turns, as the solution was found,
    /// theory (42).
    fn rub(&mut self, border: &Border, push: &Push) -> Result<Answer, Error> {
        let (mut anderson, mut change) = (Anderson::default(), f64::INFINITY);
        let mut rubbed = vec![0.0; self.mesh.shares().len() + self.robot.tendons.len()];
        let mut last: Option<Step> = None;
        for _ in 0..MOST_TURNS {
            let (pull, stretch) = self.of_rubbed(&rubbed);
            let mut right = push.right.clone();
            add(&mut right, -1.0, &pull);
            let excess: Vec<f64> = push.excess.iter().zip(&stretch).map(|(a, b)| a - b).collect();
            let mut answer = Answer::default();
            self.hold(border, &right, &excess, &mut answer);
            let mut way = answer.step.clone();
            if let Some(last) = &last {
                way.add(-1.0, last);
                change = size(&way) / size(&answer.step).max(f64::MIN_POSITIVE);
            }
            if change <= SETTLED {
                return Ok(Answer { stretch, ..answer });
            }
            rubbed = anderson.next(&rubbed, &self.rubbed(&answer.step));
            last = Some(answer.step);
        }
        Err(Error::new(format!("the derivative with friction has not settled: last change {change:.1e}"))
            .hint("less friction, or smaller loads"))
    }

    /// Changes of the shares in answer to a variation of the shape, then of their averages: by differences along it at the
    /// solution.
    fn rubbed(&self, step: &Step) -> Vec<f64> {
        let scale = SMALL / size(step).max(f64::MIN_POSITIVE);
        let [behind, ahead] = [-scale, scale].map(|scale| {
            let (mut mesh, mut sweep) = (self.mesh.clone(), Sweep::default());
            mesh.turn.iter_mut().zip(&step.turn).for_each(|(turn, change)| *turn += scale * change);
            mesh.v.iter_mut().zip(&step.v).for_each(|(v, change)| *v += scale * change);
            sweep.place(&mut mesh, self.tables);
            let (mut means, mut ends) = (Vec::new(), Vec::new());
            friction::update(self.robot, &mut mesh, &sweep, self.tables, &mut means, &mut ends);
            let mut all = mesh.shares();
            all.append(&mut means);
            all
        });
        behind.iter().zip(&ahead).map(|(behind, ahead)| 0.5 * (ahead - behind) / scale).collect()
    }

    /// What such changes do to the gradient, and to the stretch of each tendon.
    fn of_rubbed(&self, rubbed: &[f64]) -> (Column, Vec<f64>) {
        // the solution's mesh with the changes in place of the shares
        let mut changes = self.mesh.clone();
        changes.set_shares(rubbed);
        let means = &rubbed[rubbed.len() - self.robot.tendons.len()..];
        let (mut pull, mut of_one) = (Column::default(), Column::default());
        pull.clear(self.mesh);
        let mut stretch = Vec::with_capacity(means.len());
        for (i, (tendon, mean)) in self.robot.tendons.iter().zip(means).enumerate() {
            let tension = self.drive.tensions[i];
            tendons::length_form(&changes, self.sweep, i, true, &mut of_one);
            add(&mut pull, tension, &of_one);
            let give = tendon.stiffness.map_or(0.0, |stiffness| self.drive.home[i] / stiffness);
            stretch.push(mean * give * tension);
        }
        (pull, stretch)
    }

    /// Adds the change of the poses at the places by a variation of the shape, theory (40); `cuts` for those of the cuts.
    fn move_poses(&self, step: &Step, cuts: &mut Vec<Vector3<f64>>, poses: &mut [PoseDerivative]) {
        cuts.clear();
        let mut cut = Vector3::zeros();
        cuts.push(cut);
        for (k, panel) in self.mesh.panels.iter().enumerate() {
            for node in panel.nodes.clone() {
                let shape = &self.sweep.shapes[node];
                let turned = shape.turned(&step.cuts[k], &step.turn[node]);
                cut +=
                    self.mesh.data[node].weight * (shape.rotation * (step.v[node] + turned.cross(&shape.v)));
            }
            cuts.push(cut);
        }
        for (s, pose) in self.places.iter().zip(poses) {
            let k = self.mesh.panels.partition_point(|panel| panel.from < *s).saturating_sub(1);
            let panel = &self.mesh.panels[k];
            let t = (s - panel.from) / panel.length;
            if t >= 1.0 - ROUNDING {
                pose.position += cuts[k + 1];
                pose.rotation += self.mesh.rotations[k + 1] * step.cuts[k + 1];
                continue;
            }
            let table = self.tables.of(panel.nodes.len());
            pose.position += cuts[k];
            for (point, weight) in table.points.iter().zip(&table.weights) {
                let (rotation, turned, v, dv) = self.within(step, k, t * point);
                pose.position += (t * weight * panel.length) * (rotation * (dv + turned.cross(&v)));
            }
            let (rotation, turned, ..) = self.within(step, k, t);
            pose.rotation += rotation * turned;
        }
    }

    /// At a fraction of a panel: rotation, its change (body frame), v, its change.
    fn within(
        &self,
        step: &Step,
        k: usize,
        t: f64,
    ) -> (Matrix3<f64>, Vector3<f64>, Vector3<f64>, Vector3<f64>) {
        let panel = &self.mesh.panels[k];
        let table = self.tables.of(panel.nodes.len());
        let [mut dturn, mut v, mut dv] = [Vector3::zeros(); 3];
        let row = table.row(t);
        let mut turn = row.bow * panel.length * panel.bow;
        for (j, node) in panel.nodes.clone().enumerate() {
            let (value, inner) = (row.value[j], row.inner[j]);
            turn += value * self.mesh.turn[node];
            dturn += value * step.turn[node];
            v += inner * self.mesh.v[node];
            dv += inner * step.v[node];
        }
        let turn = RotationVector::new(turn);
        let since_start = turn.rotation();
        let turned = since_start.tr_mul(&step.cuts[k]) + turn.jacobian() * dturn;
        (self.mesh.rotations[k] * since_start, turned, v, dv)
    }
}

/// Of a panel: closer to its end is its end.
const ROUNDING: f64 = 1e-12;

/// Another robot in the shape of the solution, under the tensions of its own commands or, where held, of the solution.
struct State {
    gradient: Column,
    excess: Vec<f64>,
    poses: Vec<(Vector3<f64>, Matrix3<f64>)>,
    tendons: Vec<TendonDerivative>,
}

impl Solution<'_> {
    /// Nothing is solved here: the mesh of the other robot takes the shape over.
    fn state_of(&self, robot: &Robot) -> Result<State, Error> {
        let mut chain = Chain::default();
        chain.rebuild(robot);
        let (mut mesh, mut sweep, mut drive) = (Mesh::default(), Sweep::default(), self.drive.clone());
        let count = self.robot.tendons.len();
        let other = || {
            Error::new("the robot of a changed parameter has other breakpoints: no derivative there")
                .hint("a length that changes takes its guides and loads along")
        };
        let kinds =
            |robot: &Robot| -> Vec<_> { robot.actuation.iter().map(std::mem::discriminant).collect() };
        if chain.spans.len() != self.chain.spans.len() || kinds(robot) != kinds(self.robot) {
            return Err(other());
        }
        mesh.rebuild(robot, &chain, self.layouts, self.tables);
        if mesh.passing.len() != self.mesh.passing.len() || mesh.chords.len() != self.mesh.chords.len() {
            return Err(other());
        }
        tendons::at_rest(&mesh, &mut drive.home, count);
        mesh.copy_shape(self.mesh);
        sweep.place(&mut mesh, self.tables);
        tendons::measure(&mesh, &sweep, &mut drive.lengths, count);
        if robot.tendons.iter().any(|tendon| tendon.friction > 0.0) {
            let (means, ends) = (&mut drive.mean_shares, &mut drive.end_shares);
            friction::update(robot, &mut mesh, &sweep, self.tables, means, ends);
        }
        drive.apply(robot, 1.0);

        let mut gradient = Column::default();
        let (tables, gravity, tensions) = (self.tables, robot.gravity, &drive.tensions);
        let problem = Problem { chain: &chain, tables, factor: 1.0, gravity, tensions };
        sweep.gradient(&problem, &mesh, &mut gradient);
        // rates are taken along the panels of the solution
        for (panel, own) in mesh.panels.iter().zip(&self.mesh.panels) {
            for form in &mut gradient.nodes[panel.nodes.clone()] {
                form.rate *= own.length / panel.length;
            }
        }
        let pose = |s: &f64| {
            let tip = *s >= self.chain.length * (1.0 - ROUNDING);
            let sample = mesh.at(self.tables, if tip { chain.length } else { *s });
            (sample.position, sample.rotation)
        };
        let tendon = |i: usize| {
            let stretch = drive.compliance(robot, i) * drive.tensions[i];
            let displacement = drive.home[i] - robot.tendons[i].home - drive.lengths[i] + stretch;
            TendonDerivative { tension: drive.tensions[i], displacement, length: drive.lengths[i] }
        };
        Ok(State {
            poses: self.places.iter().map(pose).collect(),
            tendons: (0..count).map(tendon).collect(),
            excess: (0..count).map(|i| drive.excess(robot, i, 1.0)).collect(),
            gradient,
        })
    }
}

impl Push {
    /// Central differences of two robots in the same shape, theory (41).
    fn difference(&mut self, behind: &State, ahead: &State, step: f64) {
        let per = 0.5 / step;
        add(&mut self.right, per, &behind.gradient);
        add(&mut self.right, -per, &ahead.gradient);
        for (excess, (b, a)) in self.excess.iter_mut().zip(behind.excess.iter().zip(&ahead.excess)) {
            *excess = per * (a - b);
        }
        for (pose, (b, a)) in self.fixed.poses.iter_mut().zip(behind.poses.iter().zip(&ahead.poses)) {
            pose.position = per * (a.0 - b.0);
            pose.rotation = per * small_rotation(&(a.1 * b.1.transpose()));
        }
        for (tendon, (b, a)) in self.fixed.tendons.iter_mut().zip(behind.tendons.iter().zip(&ahead.tendons)) {
            tendon.tension = per * (a.tension - b.tension);
            tendon.displacement = per * (a.displacement - b.displacement);
            tendon.length = per * (a.length - b.length);
        }
    }
}

/// Largest turn, rad, or change of v.
fn size(step: &Step) -> f64 {
    step.turn.iter().chain(&step.v).map(Vector3::amax).fold(0.0, larger)
}

/// Rotation vector of a rotation near the identity, whose error is of third order in the angle.
fn small_rotation(r: &Matrix3<f64>) -> Vector3<f64> {
    0.5 * Vector3::new(r.m32 - r.m23, r.m13 - r.m31, r.m21 - r.m12)
}

fn add(column: &mut Column, scale: f64, other: &Column) {
    for (own, other) in column.nodes.iter_mut().zip(&other.nodes) {
        own.v += scale * other.v;
        own.turn += scale * other.turn;
        own.rate += scale * other.rate;
        own.start += scale * other.start;
    }
    column.cuts.iter_mut().zip(&other.cuts).for_each(|(own, other)| *own += scale * other);
    let own = column.gaps.iter_mut().flatten();
    own.zip(other.gaps.iter().flatten()).for_each(|(own, other)| *own += scale * other);
}
