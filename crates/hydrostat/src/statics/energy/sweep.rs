//! The placed shape, the memory of its elimination, and solving with the factors.
//!
//! The unknowns of a panel are the turns of its nodes (v is eliminated node by node); its state is the small rotation of
//! its start. Chords couple the plates of a gap: there the elimination carries, besides the rotation, the force that the
//! chords take (nu), the displacement between the plates (d) and the rotation of the first plate. The panel with which the gap
//! begins eliminates nu and d, too; its start is the first plate.

use super::following::Following;
use super::mesh::{Mesh, Panel, Tables};
use super::node::{Form, Linearised, Local, Shape};
use crate::geometry::RotationVector;
use crate::numeric::blocks;
use crate::numeric::collocation::{Collocation, MOST};
use crate::numeric::larger;
use crate::statics::chain::Chain;
use crate::statics::section::Path;
use nalgebra::{Matrix3, Vector3};

/// What the energy is made of, beside the shape.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub(super) chain: &'a Chain,
    pub(super) tables: &'a Tables,
    /// Part of the loads.
    pub(super) factor: f64,
    /// World frame, the whole.
    pub(super) gravity: Vector3<f64>,
    /// At the base, per tendon.
    pub(super) tensions: &'a [f64],
}

/// Most blocks of a panel's front behind its turns: in a gap nu and d, the rotation of its start, and in a gap that began before the
/// rotation of the first plate. With followers one more row: their force beyond the start.
pub(super) const STATE: usize = 4;
/// nu and d.
pub(super) const GAP: usize = 2;

/// Largest turn over its chord for turns up to a right angle.
const TURN_OF_CHORD: f64 = 1.12;

/// Scratch memory of the linearisation, and its factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Sweep {
    pub(super) shapes: Vec<Shape>,
    pub(super) locals: Vec<Local>,
    /// As [`Mesh::passing`].
    pub(super) paths: Vec<Path>,
    pub(super) models: Vec<Linearised>,
    pub(super) panels: Vec<PanelFront>,
    /// Directions in which the energy fell where the fronts' factors were made; None for those of a shifted Hessian.
    pub(super) factored: Option<usize>,
    /// Bound of how far the shape has moved since then, rad, and the rotations of the nodes there.
    pub(super) moved: f64,
    factored_at: Vec<Matrix3<f64>>,
    /// Blocks of the panels' fronts, one panel behind the other.
    pub(super) fronts: Vec<Matrix3<f64>>,
    pub(super) gaps: Vec<GapPull>,
    /// Direction and length of every chord.
    pub(super) spans: Vec<(Vector3<f64>, f64)>,
    /// Of every panel, and the following force beyond every node, world frame; empty without followers.
    pub(super) following: Vec<Following>,
    pub(super) following_forces: Vec<Vector3<f64>>,
    /// Change of the following force at the base by the last step.
    at_base: Vector3<f64>,
    /// Right-hand sides on their way through the fronts.
    right: Vec<Vector3<f64>>,
}

/// A panel's part of the elimination.
#[derive(Clone, Copy, Debug)]
pub(super) struct PanelFront {
    /// Where its blocks begin among `fronts`, and its rows among `right`.
    pub(super) blocks: usize,
    rows: usize,
    /// Blocks a side, the number of those eliminated, and the place of the start's rotation.
    pub(super) size: usize,
    pub(super) pivots: usize,
    pub(super) start: usize,
    pub(super) end: End,
    /// The energy's slope in the rotation of the end, body frame, and the internal moment there, on the base side.
    pub(super) slope: Vector3<f64>,
}

/// From the start of a panel to its end: `theta+ = across theta + jacobian d(turn)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) turn: RotationVector,
    pub(super) across: Matrix3<f64>,
    pub(super) jacobian: Matrix3<f64>,
}

/// The force that a gap's chords carry, and the gradient with respect to its plates.
#[derive(Clone, Debug, Default)]
pub(super) struct GapPull {
    pub(super) force: Vector3<f64>,
    pub(super) first_plate: Vector3<f64>,
    pub(super) second_plate: Vector3<f64>,
}

/// A linear form on all variations: of the nodes, of the rotations of the cuts, of the gaps' displacements and first plates.
#[derive(Clone, Debug, Default)]
pub(super) struct Column {
    pub(super) nodes: Vec<Form>,
    pub(super) cuts: Vec<Vector3<f64>>,
    pub(super) gaps: Vec<[Vector3<f64>; 2]>,
}

/// A linear form on turns, v and cuts.
#[derive(Clone, Debug, Default)]
pub(super) struct Folded {
    pub(super) turn: Vec<Vector3<f64>>,
    pub(super) v: Vec<Vector3<f64>>,
    pub(super) cuts: Vec<Vector3<f64>>,
}

/// A variation of the shape.
#[derive(Clone, Debug, Default)]
pub(super) struct Step {
    pub(super) turn: Vec<Vector3<f64>>,
    pub(super) v: Vec<Vector3<f64>>,
    /// Rotations of the cuts, body frame.
    pub(super) cuts: Vec<Vector3<f64>>,
    /// Largest rotation of a node, rad, or change of its v.
    pub(super) size: f64,
}

impl Column {
    pub(super) fn clear(&mut self, mesh: &Mesh) {
        self.clear_but_nodes(mesh);
        self.nodes.clear();
        self.nodes.resize(mesh.data.len(), Form::default());
    }

    /// Leaves the forms of the nodes to be set.
    pub(super) fn clear_but_nodes(&mut self, mesh: &Mesh) {
        self.cuts.clear();
        self.cuts.resize(mesh.panels.len() + 1, Vector3::zeros());
        self.gaps.clear();
        self.gaps.resize(mesh.gaps.len(), [Vector3::zeros(); 2]);
    }

    pub(super) fn negate(&mut self) {
        for form in &mut self.nodes {
            for part in [&mut form.v, &mut form.turn, &mut form.rate, &mut form.start] {
                part.neg_mut();
            }
        }
        self.cuts.iter_mut().chain(self.gaps.iter_mut().flatten()).for_each(|part| part.neg_mut());
    }

    /// The same form on the turns, v and cuts alone, which a variation consists of.
    pub(super) fn fold(&self, sweep: &Sweep, mesh: &Mesh, tables: &Tables, folded: &mut Folded) {
        let Folded { turn, v, cuts } = folded;
        turn.clear();
        turn.extend(self.nodes.iter().map(|form| form.turn));
        v.clear();
        v.extend(self.nodes.iter().map(|form| form.v));
        cuts.clone_from(&self.cuts);
        for (k, panel) in mesh.panels.iter().enumerate() {
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let turns = &mut turn[panel.nodes.clone()];
            for (local, form) in self.nodes[panel.nodes.clone()].iter().enumerate() {
                let rate = form.rate / panel.length;
                for (turn, d) in turns.iter_mut().zip(&table.derivative[local * points..(local + 1) * points])
                {
                    *turn += *d * rate;
                }
                cuts[k] += form.start;
            }
        }
        for (gap, [displacement, plate]) in mesh.gaps.iter().zip(&self.gaps) {
            cuts[gap.panels.start] += plate;
            for k in gap.panels.clone() {
                for node in mesh.panels[k].nodes.clone() {
                    let shape = &sweep.shapes[node];
                    let along = mesh.data[node].weight * shape.rotation.tr_mul(displacement);
                    let turning = shape.v.cross(&along);
                    v[node] += along;
                    turn[node] += shape.jacobian.tr_mul(&turning);
                    cuts[k] += shape.since_start * turning;
                }
            }
        }
    }
}

impl Folded {
    /// The form applied to a variation.
    pub(super) fn dot(&self, step: &Step) -> f64 {
        let pairs = [(&self.turn, &step.turn), (&self.v, &step.v), (&self.cuts, &step.cuts)];
        let mut sum = 0.0;
        for (form, step) in pairs {
            for (form, step) in form.iter().zip(step) {
                sum += form.dot(step);
            }
        }
        sum
    }
}

impl Step {
    pub(super) fn add(&mut self, scale: f64, other: &Step) {
        let pairs = [(&mut self.turn, &other.turn), (&mut self.v, &other.v), (&mut self.cuts, &other.cuts)];
        for (own, other) in pairs {
            own.iter_mut().zip(other).for_each(|(own, other)| *own += scale * other);
        }
    }

    /// Largest rotation of a node or cut, rad, or change of v.
    pub(super) fn largest(&self, sweep: &Sweep, mesh: &Mesh) -> f64 {
        let mut largest = self.cuts.iter().map(Vector3::norm).fold(0.0, larger);
        for (panel, start) in mesh.panels.iter().zip(&self.cuts) {
            for node in panel.nodes.clone() {
                let shape = &sweep.shapes[node];
                let turned = shape.turned(start, &self.turn[node]);
                largest = larger(largest, larger(turned.norm(), self.v[node].norm()));
            }
        }
        largest
    }
}

/// d(turn)/ds at a node by the turns of its panel.
pub(super) fn rate_of(
    panel: &Panel,
    table: &Collocation,
    local: usize,
    turns: &[Vector3<f64>],
) -> Vector3<f64> {
    let points = turns.len();
    weighted(&table.derivative[local * points..(local + 1) * points], turns) / panel.length
}

/// Sum of vectors by their weights.
pub(super) fn weighted(weights: &[f64], vectors: &[Vector3<f64>]) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for (weight, vector) in weights.iter().zip(vectors) {
        sum += *weight * vector;
    }
    sum
}

impl Sweep {
    /// Poses of cuts and nodes by the turns and strains of the mesh.
    pub(super) fn place(&mut self, mesh: &mut Mesh, tables: &Tables) {
        self.shapes.resize_with(mesh.data.len(), Shape::default);
        self.paths.clear();
        self.panels.clear();
        let (mut blocks, mut rows) = (0, 0);
        for k in 0..mesh.panels.len() {
            let panel = &mesh.panels[k];
            let table = tables.of(panel.nodes.len());
            let (start, mut position) = (mesh.rotations[k], mesh.positions[k]);
            for (local, node) in panel.nodes.clone().enumerate() {
                let rate = rate_of(panel, table, local, &mesh.turn[panel.nodes.clone()]);
                let shape = &mut self.shapes[node];
                let mut turn = mesh.turn[node];
                if mesh.bows {
                    turn += table.bow[local] * panel.length * panel.bow;
                }
                shape.place(&start, turn, rate, mesh.v[node]);
                for passing in &mesh.passing[mesh.data[node].passing.clone()] {
                    self.paths.push(passing.slack.path(&shape.v, &shape.u));
                }
                position += mesh.data[node].weight * (shape.rotation * shape.v);
            }
            let turn = RotationVector::new(mesh.end_turn(panel, table));
            let since_start = turn.rotation();
            let end = End { across: since_start.transpose(), jacobian: turn.jacobian(), turn };
            let (points, begins) = (panel.nodes.len(), mesh.begins_gap(k));
            let start_at = points + if panel.gap.is_some() { GAP } else { 0 };
            let first_plate = usize::from(panel.gap.is_some() && !begins);
            self.panels.push(PanelFront {
                blocks,
                rows,
                size: start_at + 1 + first_plate + usize::from(mesh.follows),
                pivots: if begins { start_at } else { points },
                start: start_at,
                end,
                slope: Vector3::zeros(),
            });
            let size = self.panels[k].size;
            (blocks, rows) = (blocks + size * size, rows + size);
            mesh.rotations[k + 1] = start * since_start;
            mesh.positions[k + 1] = position;
        }
        self.spans.clear();
        for gap in &mesh.gaps {
            for chord in &mesh.chords[gap.chords.clone()] {
                let span = mesh.chord(gap, &chord.holes);
                let length = span.norm();
                self.spans.push((span / length, length));
            }
        }
        self.fronts.resize(blocks, Matrix3::zeros());
        self.right.resize(rows, Vector3::zeros());
        self.models.resize_with(mesh.data.len(), Linearised::default);
    }

    /// The energy of the placed shape, theory (30): elastic, tensions times lengths, work of the dead forces.
    pub(super) fn energy(&self, problem: &Problem, mesh: &Mesh, lengths: &[f64]) -> f64 {
        let mut energy = 0.0;
        for (data, shape) in mesh.data.iter().zip(&self.shapes) {
            let (stretch, bending) = (shape.v - Vector3::z(), shape.u - data.rest_curvature);
            let elastic = 0.5 * stretch.dot(&data.shear.component_mul(&stretch))
                + 0.5 * bending.dot(&data.bend.component_mul(&bending));
            let lowered = data.force.dot(&(shape.rotation * shape.v))
                + problem.gravity.dot(&(shape.rotation * data.mass_moment));
            energy += data.weight * (elastic - problem.factor * lowered);
        }
        for (k, panel) in mesh.panels.iter().enumerate().filter(|(_, panel)| panel.ends_span) {
            let hung = problem.chain.spans[panel.span].jump.hung;
            energy -= problem.factor * problem.gravity.dot(&(mesh.rotations[k + 1] * hung));
        }
        energy + problem.tensions.iter().zip(lengths).map(|(tension, length)| tension * length).sum::<f64>()
    }

    /// Internal moment at the end of a panel, on its base side, body frame, as [`Sweep::gradient`] found it.
    pub(super) fn end_moment(&self, k: usize) -> Vector3<f64> {
        -self.panels[k].slope
    }

    /// Force that the chords beside a panel take from the backbone, world frame.
    pub(super) fn chord_force(&self, panel: &Panel) -> Vector3<f64> {
        panel.gap.map_or(Vector3::zeros(), |gap| self.gaps[gap].force)
    }

    /// Whether there are factors of the Hessian on this mesh.
    pub(super) fn holds_factors(&self, mesh: &Mesh) -> bool {
        self.factored.is_some() && self.models.len() == mesh.data.len()
    }

    /// Begins to count how far the shape moves away from the factors.
    pub(super) fn mark_factored(&mut self) {
        self.moved = 0.0;
        self.factored_at.clear();
        self.factored_at.extend(self.shapes.iter().map(|shape| shape.rotation));
    }

    /// Takes the largest turn of a node since then for the sum of the steps, which may have led back. Shear, stretch and the tensions of
    /// held tendons go with the turns.
    pub(super) fn measure_moved(&mut self) {
        if self.factored_at.len() == self.shapes.len() {
            let turns = self.shapes.iter().zip(&self.factored_at).map(|(shape, at)| {
                // of a turn by the angle a the norm is sqrt(8) sin(a / 2)
                (shape.rotation - at).norm_squared()
            });
            let turn = (0.5 * turns.fold(0.0, larger)).sqrt();
            self.moved = self.moved.min(TURN_OF_CHORD * turn);
        }
    }

    /// Solves with the factors: Hessian x step = right.
    pub(super) fn solve(&mut self, mesh: &Mesh, tables: &Tables, right: &Column, step: &mut Step) {
        self.tip_to_base(mesh, tables, right);
        self.base_to_tip(mesh, tables, right, step);
    }

    fn tip_to_base(&mut self, mesh: &Mesh, tables: &Tables, right: &Column) {
        // of nu and d, and of the gap's first plate
        let (mut state, mut in_gap, mut plate) =
            (Vector3::zeros(), [Vector3::zeros(); GAP], Vector3::zeros());
        // the following force is what was carried of the unknowns less this
        let mut follows = Vector3::zeros();
        for k in (0..mesh.panels.len()).rev() {
            let panel = &mesh.panels[k];
            let PanelFront { blocks, rows, size, pivots, start: start_at, end, .. } = self.panels[k];
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            state += right.cuts[k + 1];
            if let Some(gap) = panel.gap.filter(|gap| mesh.gaps[*gap].panels.end == k + 1) {
                let [displacement, of_plate] = right.gaps[gap];
                (in_gap, plate) = ([Vector3::zeros(), displacement], of_plate);
            }
            let rows = &mut self.right[rows..rows + size];
            let mut start = end.across.tr_mul(&state);
            let through_end = end.jacobian.tr_mul(&state);
            for (row, e) in rows.iter_mut().zip(&table.end) {
                *row = *e * through_end;
            }
            for (local, node) in panel.nodes.clone().enumerate() {
                let mut form = self.models[node].condense(&self.shapes[node], &right.nodes[node]);
                if mesh.follows {
                    let (model, weighted) = (&self.models[node], mesh.data[node].weight * follows);
                    form.turn += model.turn_force * weighted;
                    form.rate += model.rate_force * weighted;
                    form.start += model.start_force * weighted;
                    form.force += model.force_force * weighted;
                }
                rows[local] += form.turn;
                let rate = form.rate / panel.length;
                for (row, d) in rows.iter_mut().zip(&table.derivative[local * points..(local + 1) * points]) {
                    *row += *d * rate;
                }
                start += form.start;
                in_gap[0] += form.force;
            }
            rows[start_at] = start;
            let begins = mesh.begins_gap(k);
            if panel.gap.is_some() {
                rows[points..start_at].copy_from_slice(&in_gap);
                rows[start_at + usize::from(!begins)] = if begins { start + plate } else { plate };
            }
            if mesh.follows {
                rows[size - 1] = follows;
            }
            blocks::forward(&self.fronts[blocks..blocks + size * size], size, pivots, rows);
            state = rows[start_at];
            if mesh.follows {
                follows = rows[size - 1];
            }
            if panel.gap.is_some() && !begins {
                in_gap.copy_from_slice(&rows[points..start_at]);
                plate = rows[start_at + 1];
            }
        }
        self.at_base = -follows;
    }

    fn base_to_tip(&mut self, mesh: &Mesh, tables: &Tables, right: &Column, step: &mut Step) {
        step.turn.resize(mesh.data.len(), Vector3::zeros());
        step.v.resize(mesh.data.len(), Vector3::zeros());
        step.cuts.resize(mesh.panels.len() + 1, Vector3::zeros());
        step.cuts[0] = Vector3::zeros();
        step.size = 0.0;
        let (mut in_gap, mut plate) = ([Vector3::zeros(); GAP], Vector3::zeros());
        let (mut follows, mut following) = (self.at_base, [Vector3::zeros(); MOST]);
        for k in 0..mesh.panels.len() {
            let panel = &mesh.panels[k];
            let PanelFront { blocks, rows, size, pivots, start: start_at, end, .. } = self.panels[k];
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let start = step.cuts[k];
            let rows = &mut self.right[rows..rows + size];
            rows[start_at] = start;
            let begins = mesh.begins_gap(k);
            if panel.gap.is_some() && !begins {
                rows[points..start_at].copy_from_slice(&in_gap);
                rows[start_at + 1] = plate;
            }
            if mesh.follows {
                rows[size - 1] = Vector3::zeros();
            }
            blocks::backward(&self.fronts[blocks..blocks + size * size], size, pivots, rows);
            if panel.gap.is_some() && begins {
                in_gap.copy_from_slice(&rows[points..start_at]);
                plate = start;
            }
            step.turn[panel.nodes.clone()].copy_from_slice(&rows[..points]);
            if mesh.follows {
                self.follow_step(mesh, tables, k, step, &mut follows, &mut following[..points]);
            }
            let turns = &step.turn[panel.nodes.clone()];
            let force = if panel.gap.is_some() { in_gap[0] } else { Vector3::zeros() };
            let mut turned = Vector3::zeros();
            for (local, node) in panel.nodes.clone().enumerate() {
                let (turn, shape) = (turns[local], &self.shapes[node]);
                let solved = Form {
                    v: Vector3::zeros(),
                    turn,
                    rate: rate_of(panel, table, local, turns),
                    start,
                    force: force + following[local],
                };
                // the model is per unit weight
                let form = right.nodes[node].v / mesh.data[node].weight;
                let by_turns = shape.turned(&start, &turn);
                step.v[node] = self.models[node].recover_v(shape, &form, &solved, &by_turns);
                let size = by_turns.norm_squared().max(step.v[node].norm_squared());
                step.size = larger(step.size, size);
                turned += table.end[local] * turn;
            }
            step.cuts[k + 1] = end.across * start + end.jacobian * turned;
            step.size = larger(step.size, step.cuts[k + 1].norm_squared());
            if mesh.follows {
                follows += self.follow_end(mesh, k, step);
            }
        }
        step.size = step.size.sqrt();
    }
}
