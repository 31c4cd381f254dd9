//! Lengths of the tendons on a placed shape, and how they change with it.

use super::mesh::{Mesh, Panel, Tables};
use super::sweep::{Column, Sweep, weighted};
use crate::Robot;
use crate::geometry::RotationVector;
use crate::model::Command;
use crate::numeric::collocation::{Collocation, MOST};
use crate::statics::section::{Path, Pull};
use nalgebra::{Matrix3, Vector3};

/// A path that gains so little along the backbone, per length of it, has shrunk to nothing.
const FOLDED: f64 = 1e-3;

/// How the tendons are driven.
#[derive(Clone, Debug, Default)]
pub(super) struct Drive {
    /// At the base, per tendon.
    pub(super) tensions: Vec<f64>,
    /// Of the given ones since the last solution.
    pub(super) changes: Vec<f64>,
    /// Of the paths on the placed shape, and on the unloaded one.
    pub(super) lengths: Vec<f64>,
    pub(super) home: Vec<f64>,
    /// What the gaps add to the lengths of an averaged robot; empty otherwise.
    pub(super) left_out: Vec<f64>,
    /// Tendons held by displacement, and whether each is taut.
    pub(super) held: Vec<usize>,
    pub(super) taut: Vec<bool>,
    pub(super) springs: Springs,
    /// Average tension and that at the end over that at the base, per tendon; empty without friction.
    pub(super) mean_shares: Vec<f64>,
    pub(super) end_shares: Vec<f64>,
}

/// Springs that stand for the held tendons while the shape is far from an equilibrium.
#[derive(Clone, Debug, Default)]
pub(super) struct Springs {
    /// Length per tension, per held tendon; empty where their lengths are exact.
    pub(super) give: Vec<f64>,
    /// Tension, per tendon, at which a spring has no length of its own.
    pub(super) centre: Vec<f64>,
}

impl Springs {
    /// How much longer the i-th held tendon may be than without its spring, negative.
    pub(super) fn lag(&self, i: usize, tendon: usize, tension: f64) -> f64 {
        self.give.get(i).map_or(0.0, |give| give * (self.centre[tendon] - tension))
    }
}

impl Drive {
    /// At rest: no tension, and no friction of a robot before.
    pub(super) fn rest(&mut self, robot: &Robot) {
        self.tensions.clear();
        self.tensions.resize(robot.tendons.len(), 0.0);
        self.mean_shares.clear();
        self.end_shares.clear();
        self.springs.give.clear();
        self.left_out.clear();
        self.held.clear();
        for (tendon, command) in robot.actuation.iter().enumerate() {
            if matches!(command, Command::Displacement { .. }) {
                self.held.push(tendon);
            }
        }
        self.taut.clear();
        self.taut.resize(self.held.len(), true);
    }

    /// Whether the held tendons are those of the robot.
    pub(super) fn is_of(&self, robot: &Robot) -> bool {
        let held =
            |(i, command): (usize, &Command)| matches!(command, Command::Displacement { .. }).then_some(i);
        self.tensions.len() == robot.tendons.len()
            && robot.actuation.iter().enumerate().filter_map(held).eq(self.held.iter().copied())
    }

    /// Sets the given tensions to a part of the command.
    pub(super) fn apply(&mut self, robot: &Robot, factor: f64) {
        for (tension, command) in self.tensions.iter_mut().zip(&robot.actuation) {
            if let Command::Tension { tension: whole, .. } = command {
                *tension = factor * whole;
            }
        }
    }

    /// Takes the lengths in the gaps for those of the averaged robot at the same shape.
    pub(super) fn take_lengths(&mut self, lengths: &[f64]) {
        self.left_out.resize(lengths.len(), 0.0);
        for ((left_out, own), length) in self.left_out.iter_mut().zip(&mut self.lengths).zip(lengths) {
            *left_out += length - *own;
            *own = *length;
        }
    }

    /// Stretch of a tendon per tension at the base, m/N.
    pub(super) fn compliance(&self, robot: &Robot, tendon: usize) -> f64 {
        let mean = self.mean_shares.get(tendon).unwrap_or(&1.0);
        robot.tendons[tendon].stiffness.map_or(0.0, |stiffness| mean * self.home[tendon] / stiffness)
    }

    /// How much longer a held tendon is than its command and stretch allow.
    pub(super) fn excess(&self, robot: &Robot, tendon: usize, factor: f64) -> f64 {
        let pulled = match robot.actuation[tendon] {
            Command::Displacement { displacement, .. } => {
                factor * (displacement + robot.tendons[tendon].home)
            }
            Command::Tension { .. } => 0.0,
        };
        self.lengths[tendon] - self.home[tendon] + pulled
            - self.compliance(robot, tendon) * self.tensions[tendon]
    }

    /// Largest excess of a held tendon without tension: above 0 it would have to pull.
    pub(super) fn longest_slack(&self, robot: &Robot, factor: f64) -> f64 {
        let slack = self.held.iter().filter(|tendon| self.tensions[**tendon] == 0.0);
        slack.map(|tendon| self.excess(robot, *tendon, factor)).fold(0.0, f64::max)
    }
}

/// Lengths of the paths on the placed shape.
pub(super) fn measure(mesh: &Mesh, sweep: &Sweep, lengths: &mut Vec<f64>, count: usize) {
    lengths.clear();
    lengths.resize(count, 0.0);
    for data in &mesh.data {
        for (passing, path) in
            mesh.passing[data.passing.clone()].iter().zip(&sweep.paths[data.passing.clone()])
        {
            lengths[passing.tendon] += data.weight * path.speed;
        }
    }
    for (chord, (_, length)) in mesh.chords.iter().zip(&sweep.spans) {
        lengths[chord.tendon] += length;
    }
}

/// Lengths of the paths on the robot at rest.
pub(super) fn at_rest(mesh: &Mesh, lengths: &mut Vec<f64>, count: usize) {
    lengths.clear();
    lengths.resize(count, 0.0);
    for data in &mesh.data {
        for passing in &mesh.passing[data.passing.clone()] {
            lengths[passing.tendon] +=
                data.weight * passing.slack.path(&Vector3::z(), &data.rest_curvature).speed;
        }
    }
    for gap in &mesh.gaps {
        // from plate to plate along arcs of constant curvature, in the frame of the first
        let (mut position, mut rotation) = (Vector3::zeros(), Matrix3::identity());
        for panel in &mesh.panels[gap.panels.clone()] {
            let curvature = mesh.data[panel.nodes.start].rest_curvature;
            if curvature == Vector3::zeros() {
                position += panel.length * rotation.column(2);
                continue;
            }
            let turn = RotationVector::new(panel.length * curvature);
            // the integral of exp(t hat(u)) is J(-w) = J(w)^T for constant u
            position += panel.length * (rotation * (turn.jacobian().transpose() * Vector3::z()));
            rotation *= turn.rotation();
        }
        for chord in &mesh.chords[gap.chords.clone()] {
            lengths[chord.tendon] += (position + rotation * chord.holes[1] - chord.holes[0]).norm();
        }
    }
}

/// d(length of one tendon) as a linear form; `shares` weights it by the share of the tension, which is its pull.
pub(super) fn length_form(mesh: &Mesh, sweep: &Sweep, tendon: usize, shares: bool, column: &mut Column) {
    column.clear(mesh);
    let scale = |share: f64| if shares { share } else { 1.0 };
    for (node, (data, shape)) in mesh.data.iter().zip(&sweep.shapes).enumerate() {
        let passing = mesh.passing[data.passing.clone()].iter().zip(&sweep.paths[data.passing.clone()]);
        for (passing, path) in passing.filter(|(passing, _)| passing.tendon == tendon) {
            let slope = passing.slack.slope(&shape.v, &shape.u, &path.tangent);
            let weight = data.weight * scale(passing.share);
            let moment = weight * slope.u;
            let form = &mut column.nodes[node];
            form.v += weight * slope.v;
            form.turn += shape.turn_u.tr_mul(&moment);
            form.rate += shape.jacobian.tr_mul(&moment);
        }
    }
    for (number, gap) in mesh.gaps.iter().enumerate() {
        for number_of_chord in gap.chords.clone().filter(|&chord| mesh.chords[chord].tendon == tendon) {
            let chord = &mesh.chords[number_of_chord];
            let t = sweep.spans[number_of_chord].0 * scale(chord.share);
            let [first, second] = [gap.panels.start, gap.panels.end].map(|k| mesh.rotations[k].tr_mul(&t));
            column.gaps[number][0] += t;
            column.gaps[number][1] -= chord.holes[0].cross(&first);
            column.cuts[gap.panels.end] += chord.holes[1].cross(&second);
        }
    }
}

/// Force and moment of the tendons at `s` under the given tensions, all in channels, body frame.
fn pull_at(
    robot: &Robot,
    tensions: &[f64],
    s: f64,
    v: &Vector3<f64>,
    u: &Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (tendon, &tension) in robot.tendons.iter().zip(tensions) {
        let end = robot.tendon_end(tendon);
        if tension != 0.0 && s < end {
            let (hole, along) = tendon.path.hole(s / end, end);
            let pull = tension * Pull { hole, along, tension, gap: 0.0 }.path(v, u).tangent;
            force += pull;
            moment += hole.cross(&pull);
        }
    }
    (force, moment)
}

/// Turns of a panel's nodes under curvatures: exact for a constant one, which most are nearly.
fn turns<'a>(
    panel: &'a Panel,
    table: &'a Collocation,
    curvatures: &'a [Vector3<f64>],
) -> impl Iterator<Item = Vector3<f64>> + 'a {
    let rows = table.to_point.chunks_exact(panel.nodes.len());
    rows.map(move |weights| panel.length * weighted(weights, curvatures))
}

/// Rounds of the tendons' directions and the strain in [`Mesh::bend_by`].
const ROUNDS: usize = 2;

impl Mesh {
    /// Bends every node as tendons in channels would under these tensions, were there nothing else: where to start from.
    pub(super) fn bend_by(&mut self, robot: &Robot, tensions: &[f64], tables: &Tables) {
        for panel in &self.panels {
            let table = tables.of(panel.nodes.len());
            let mut curvatures = [Vector3::zeros(); MOST];
            for ((node, point), curvature) in panel.nodes.clone().zip(&table.points).zip(&mut curvatures) {
                let data = &self.data[node];
                let s = panel.from + point * panel.length;
                let (mut v, mut u) = (Vector3::z(), data.rest_curvature);
                for _ in 0..ROUNDS {
                    let (force, moment) = pull_at(robot, tensions, s, &v, &u);
                    v = Vector3::z() - force.component_div(&data.shear);
                    u = data.rest_curvature - moment.component_div(&data.bend);
                }
                (self.v[node], *curvature) = (v, u);
            }
            for (turn, of_bend) in
                self.turn[panel.nodes.clone()].iter_mut().zip(turns(panel, table, &curvatures))
            {
                *turn = of_bend;
            }
        }
    }

    /// Bends every node further by what changes of the tensions would, were there nothing else. Returns a bound of the turn.
    pub(super) fn bend_further(&mut self, robot: &Robot, changes: &[f64], tables: &Tables) -> f64 {
        let mut largest = 0.0;
        for panel in &self.panels {
            let table = tables.of(panel.nodes.len());
            let mut curvatures = [Vector3::zeros(); MOST];
            for ((node, point), curvature) in panel.nodes.clone().zip(&table.points).zip(&mut curvatures) {
                let data = &self.data[node];
                let s = panel.from + point * panel.length;
                let (force, moment) = pull_at(robot, changes, s, &Vector3::z(), &data.rest_curvature);
                self.v[node] -= force.component_div(&data.shear);
                *curvature = -moment.component_div(&data.bend);
                largest += data.weight * curvature.norm();
            }
            for (turn, further) in
                self.turn[panel.nodes.clone()].iter_mut().zip(turns(panel, table, &curvatures))
            {
                *turn += further;
            }
        }
        largest
    }

    /// From hole to hole across a gap, world frame.
    pub(super) fn chord(&self, gap: &super::mesh::Gap, holes: &[Vector3<f64>; 2]) -> Vector3<f64> {
        let (a, b) = (gap.panels.start, gap.panels.end);
        self.positions[b] - self.positions[a] + self.rotations[b] * holes[1] - self.rotations[a] * holes[0]
    }
}

/// A tendon whose path shrinks to nothing, and where: the robot has folded about it.
pub(super) fn folded(mesh: &Mesh, sweep: &Sweep) -> Option<(usize, f64)> {
    for panel in &mesh.panels {
        for node in panel.nodes.clone() {
            for passing in mesh.data[node].passing.clone() {
                let Path { speed, tangent } = sweep.paths[passing];
                if speed * tangent.z < FOLDED {
                    return Some((mesh.passing[passing].tendon, panel.from));
                }
            }
        }
    }
    for gap in &mesh.gaps {
        let panels = &mesh.panels[gap.panels.clone()];
        let length: f64 = panels.iter().map(|panel| panel.length).sum();
        let mut chords = gap.chords.clone();
        if let Some(chord) = chords.find(|&chord| sweep.spans[chord].1 < FOLDED * length) {
            return Some((mesh.chords[chord].tendon, panels[0].from));
        }
    }
    None
}
