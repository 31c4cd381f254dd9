//! One linearisation of the chain: gradient, Hessian, and their block elimination from tip to base.
//!
//! The unknowns of a panel are the turns of its nodes (v is eliminated node by node); its state is the small rotation of
//! its start. Chords couple the plates of a gap: there the elimination carries, besides the rotation, the force that the
//! chords take (nu), the displacement between the plates (d) and the rotation of the first plate, until the gap begins.

use super::mesh::{Mesh, Panel, Tables};
use super::node::{self, Acting, Form, Linearised, Shape};
use crate::geometry::{RotationVector, hat};
use crate::numeric::collocation::Collocation;
use crate::numeric::{front, larger};
use crate::statics::chain::Chain;
use nalgebra::{Matrix3, SMatrix, Vector3};

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

/// State and gap variables: rotation of the cut, then nu, d and the rotation of the gap's first plate.
const STATE: usize = 3;
const CARRIED: usize = 12;
type Carried = SMatrix<f64, CARRIED, CARRIED>;
/// Rows of the gap's own elimination: nu, d, then the rotation of the plate.
const GAP: usize = 9;
const GAP_PIVOTS: usize = 6;

/// Scratch memory of the linearisation, and its factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Sweep {
    pub(super) shapes: Vec<Shape>,
    models: Vec<Linearised>,
    /// Fronts of the panels, one behind the other, and where each begins.
    fronts: Vec<f64>,
    starts: Vec<usize>,
    ends: Vec<End>,
    /// Internal moment at the end of each panel, on its base side, body frame.
    moments: Vec<Vector3<f64>>,
    gaps: Vec<GapFront>,
    /// Right-hand sides on their way through the fronts.
    right: Vec<f64>,
    right_starts: Vec<usize>,
}

/// From the start of a panel to its end: `theta+ = across theta + jacobian d(turn)`.
#[derive(Clone, Copy, Debug)]
struct End {
    across: Matrix3<f64>,
    jacobian: Matrix3<f64>,
}

/// The elimination of a gap's nu and d, the force that its chords carry, and the gradient with respect to its plates.
#[derive(Clone, Debug)]
struct GapFront {
    matrix: [f64; GAP * GAP],
    right: [f64; GAP],
    force: Vector3<f64>,
    first_plate: Vector3<f64>,
    second_plate: Vector3<f64>,
}

/// A linear form on all variations: of the nodes, of the rotations of the cuts, of the gaps' displacements and first plates.
#[derive(Clone, Debug, Default)]
pub(super) struct Column {
    pub(super) nodes: Vec<Form>,
    pub(super) cuts: Vec<Vector3<f64>>,
    pub(super) gaps: Vec<[Vector3<f64>; 2]>,
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

/// What an elimination found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factored {
    /// Directions in which the energy falls; None where the elimination broke down.
    pub(super) negative: Option<usize>,
    /// Largest gradient in units of stiffness / length.
    pub(super) residual: f64,
}

impl Column {
    pub(super) fn clear(&mut self, mesh: &Mesh) {
        self.nodes.clear();
        self.nodes.resize(mesh.data.len(), Form::default());
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

    /// The form applied to a variation.
    pub(super) fn dot(&self, sweep: &Sweep, mesh: &Mesh, tables: &Tables, step: &Step) -> f64 {
        let mut sum = 0.0;
        for (k, panel) in mesh.panels.iter().enumerate() {
            let table = tables.of(panel.nodes.len());
            for (local, node) in panel.nodes.clone().enumerate() {
                let form = &self.nodes[node];
                let rate = rate_of(panel, table, local, &step.turn[panel.nodes.clone()]);
                sum += form.v.dot(&step.v[node]) + form.turn.dot(&step.turn[node]) + form.rate.dot(&rate);
                sum += form.start.dot(&step.cuts[k]);
            }
        }
        sum += self.cuts.iter().zip(&step.cuts).map(|(form, turn)| form.dot(turn)).sum::<f64>();
        for (gap, form) in mesh.gaps.iter().zip(&self.gaps) {
            sum += form[1].dot(&step.cuts[gap.panels.start]);
            sum += form[0].dot(&sweep.displacement_change(mesh, tables, gap.panels.clone(), step));
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
fn rate_of(panel: &Panel, table: &Collocation, local: usize, turns: &[Vector3<f64>]) -> Vector3<f64> {
    let points = turns.len();
    let row = &table.derivative[local * points..(local + 1) * points];
    row.iter().zip(turns).map(|(d, turn)| *d * turn).sum::<Vector3<f64>>() / panel.length
}

impl Sweep {
    /// Poses of cuts and nodes by the turns and strains of the mesh.
    pub(super) fn place(&mut self, mesh: &mut Mesh, tables: &Tables) {
        self.shapes.clear();
        for k in 0..mesh.panels.len() {
            let panel = mesh.panels[k].clone();
            let table = tables.of(panel.nodes.len());
            let (start, mut position) = (mesh.rotations[k], mesh.positions[k]);
            for (local, node) in panel.nodes.clone().enumerate() {
                let rate = mesh.turn_rate(&panel, table, local);
                let shape = Shape::new(&start, mesh.turn[node], rate, mesh.v[node]);
                position += mesh.data[node].weight * (shape.rotation * shape.v);
                self.shapes.push(shape);
            }
            mesh.rotations[k + 1] = start * RotationVector::new(mesh.end_turn(&panel, table)).rotation();
            mesh.positions[k + 1] = position;
        }
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

    /// Linearises at the placed shape and eliminates, with `shift` times the elastic part added to the Hessian; the gradient goes to `gradient`.
    pub(super) fn factor(
        &mut self,
        problem: &Problem,
        mesh: &Mesh,
        shift: f64,
        gradient: &mut Column,
    ) -> Factored {
        gradient.clear(mesh);
        self.reset(mesh);
        let mut negative = Some(0);
        let mut carried = Carried::zeros();
        let mut slope = Vector3::zeros();
        let mut residual = 0.0;
        for k in (0..mesh.panels.len()).rev() {
            let panel = &mesh.panels[k];
            if panel.ends_span {
                let (moment, hessian) = point_loads(problem, mesh, k);
                slope += moment;
                gradient.cuts[k + 1] += moment;
                add(&mut carried, 0, 0, &hessian);
            }
            let gap = panel.gap.map(|gap| (gap, &mesh.gaps[gap]));
            if let Some((number, _)) = gap.filter(|(_, gap)| gap.panels.end == k + 1) {
                self.enter_gap(problem, mesh, number, &mut carried);
                let of = &self.gaps[number];
                slope += of.second_plate;
                gradient.cuts[k + 1] += of.second_plate;
                // the energy's slope in d is what the chords carry, and closes by itself
                gradient.gaps[number][1] = of.first_plate;
            }
            self.moments[k] = -slope;
            let eliminated =
                self.eliminate_panel(problem, mesh, k, shift, &mut carried, &mut slope, gradient);
            residual = larger(residual, eliminated.1);
            negative = sum(negative, eliminated.0);
            if let Some((number, _)) = gap.filter(|(_, gap)| gap.panels.start == k) {
                slope += self.gaps[number].first_plate;
                let pivots = self.leave_gap(number, &mut carried);
                negative = sum(negative, pivots);
            }
        }
        // every gap's nu is a multiplier, with three negative pivots of its own
        let multipliers = 3 * mesh.gaps.iter().filter(|gap| !gap.panels.is_empty()).count();
        let negative = negative.and_then(|negative| negative.checked_sub(multipliers));
        let unit = problem.chain.length / problem.chain.stiffness;
        for (node, form) in gradient.nodes.iter().enumerate() {
            let strain = form.v.component_div(&mesh.data[node].shear) / mesh.data[node].weight;
            residual = larger(residual, strain.amax() / unit);
        }
        Factored { negative, residual: residual * unit }
    }

    fn reset(&mut self, mesh: &Mesh) {
        self.models.clear();
        self.fronts.clear();
        self.starts.clear();
        self.right_starts.clear();
        self.ends.clear();
        let (mut at, mut right) = (0, 0);
        for panel in &mesh.panels {
            self.starts.push(at);
            self.right_starts.push(right);
            let size = front_size(panel);
            at += size * size;
            right += size;
            self.ends.push(End { across: Matrix3::identity(), jacobian: Matrix3::identity() });
        }
        self.moments.resize(mesh.panels.len(), Vector3::zeros());
        self.fronts.resize(at, 0.0);
        self.right.resize(right, 0.0);
        self.gaps.clear();
        self.gaps.resize(
            mesh.gaps.len(),
            GapFront {
                matrix: [0.0; GAP * GAP],
                right: [0.0; GAP],
                force: Vector3::zeros(),
                first_plate: Vector3::zeros(),
                second_plate: Vector3::zeros(),
            },
        );
    }

    /// The chords at the end of their gap: energy tau |c| with c from hole to hole, theory (33).
    fn enter_gap(&mut self, problem: &Problem, mesh: &Mesh, number: usize, carried: &mut Carried) {
        let gap = &mesh.gaps[number];
        let (a, b) = (gap.panels.start, gap.panels.end);
        let (first, second) = (&mesh.rotations[a], &mesh.rotations[b]);
        let displacement = mesh.positions[b] - mesh.positions[a];
        let front = &mut self.gaps[number];
        for axis in 0..3 {
            carried[(3 + axis, 6 + axis)] += 1.0;
            carried[(6 + axis, 3 + axis)] += 1.0;
        }
        for chord in &mesh.chords[gap.chords.clone()] {
            let tension = problem.tensions[chord.tendon] * chord.share;
            let span = displacement + second * chord.holes[1] - first * chord.holes[0];
            let length = span.norm();
            let t = span / length;
            let across = (Matrix3::identity() - t * t.transpose()) * (tension / length);
            let (pull_a, pull_b) = (first.tr_mul(&(tension * t)), second.tr_mul(&(tension * t)));
            front.force -= tension * t;
            front.first_plate -= chord.holes[0].cross(&pull_a);
            front.second_plate += chord.holes[1].cross(&pull_b);
            // d(span) over the rotations of second plate, d, first plate
            let by = [
                (0, -(second * hat(&chord.holes[1]))),
                (6, Matrix3::identity()),
                (9, first * hat(&chord.holes[0])),
            ];
            for (row, left) in &by {
                for (column, right) in &by {
                    add(carried, *row, *column, &(left.tr_mul(&across) * right));
                }
            }
            add(carried, 0, 0, &symmetric(&(hat(&pull_b) * hat(&chord.holes[1]))));
            add(carried, 9, 9, &-symmetric(&(hat(&pull_a) * hat(&chord.holes[0]))));
        }
    }

    /// Joins the panel's start with the gap's first plate and eliminates nu and d.
    fn leave_gap(&mut self, number: usize, carried: &mut Carried) -> Option<usize> {
        // rows of the gap's front among the carried ones; the rotation appears twice there
        const ROWS: [[usize; 2]; GAP] =
            [[3, 3], [4, 4], [5, 5], [6, 6], [7, 7], [8, 8], [0, 9], [1, 10], [2, 11]];
        let front = &mut self.gaps[number].matrix;
        for (i, rows) in ROWS.iter().enumerate() {
            for (j, columns) in ROWS.iter().enumerate() {
                let mut sum = carried[(rows[0], columns[0])];
                if i >= GAP_PIVOTS {
                    sum += carried[(rows[1], columns[0])];
                }
                if j >= GAP_PIVOTS {
                    sum += carried[(rows[0], columns[1])];
                }
                if i >= GAP_PIVOTS && j >= GAP_PIVOTS {
                    sum += carried[(rows[1], columns[1])];
                }
                front[i * GAP + j] = sum;
            }
        }
        let negative = front::eliminate(front, GAP, GAP_PIVOTS);
        *carried = Carried::zeros();
        for i in 0..STATE {
            for j in 0..STATE {
                carried[(i, j)] = front[(GAP_PIVOTS + i) * GAP + GAP_PIVOTS + j];
            }
        }
        negative
    }

    /// Linearises a panel, adds what is carried from beyond, and eliminates its turns. Returns the negative pivots and the
    /// largest gradient.
    #[allow(clippy::too_many_arguments, reason = "one stage of `factor`, which owns what is carried")]
    fn eliminate_panel(
        &mut self,
        problem: &Problem,
        mesh: &Mesh,
        k: usize,
        shift: f64,
        carried: &mut Carried,
        slope: &mut Vector3<f64>,
        gradient: &mut Column,
    ) -> (Option<usize>, f64) {
        let panel = &mesh.panels[k];
        let table = problem.tables.of(panel.nodes.len());
        let points = panel.nodes.len();
        let size = front_size(panel);
        let state = 3 * points;
        let chords = panel.gap.map_or(Vector3::zeros(), |gap| self.gaps[gap].force);
        let front = &mut self.fronts[self.starts[k]..self.starts[k] + size * size];
        front.fill(0.0);
        let mut block = Block { entries: front, size };

        // what lies beyond the end
        let turn = RotationVector::new(mesh.end_turn(panel, table));
        let end = End { across: turn.rotation().transpose(), jacobian: turn.jacobian() };
        self.ends[k] = end;
        let beyond: Matrix3<f64> = carried.fixed_view::<3, 3>(0, 0).into();
        let curl = symmetric(&turn.transpose_differential(slope));
        let turn_turn = end.jacobian.tr_mul(&(beyond * end.jacobian)) + curl;
        let half = 0.5 * end.jacobian.tr_mul(&(hat(slope) * end.across));
        let turn_start = end.jacobian.tr_mul(&(beyond * end.across)) + half;
        let start_turn = end.across.tr_mul(&(beyond * end.jacobian)) + half.transpose();
        for (i, row) in table.end.iter().enumerate() {
            for (j, column) in table.end.iter().enumerate() {
                block.add(3 * i, 3 * j, row * column, &turn_turn);
            }
            block.add(3 * i, state, *row, &turn_start);
            block.add(state, 3 * i, *row, &start_turn);
        }
        block.add(state, state, 1.0, &(end.across.tr_mul(&(beyond * end.across))));
        if panel.gap.is_some() {
            for gap in (3..CARRIED).step_by(3) {
                let right: Matrix3<f64> = carried.fixed_view::<3, 3>(0, gap).into();
                let left: Matrix3<f64> = carried.fixed_view::<3, 3>(gap, 0).into();
                for (i, e) in table.end.iter().enumerate() {
                    block.add(3 * i, state + gap, *e, &end.jacobian.tr_mul(&right));
                    block.add(state + gap, 3 * i, *e, &(left * end.jacobian));
                }
                block.add(state, state + gap, 1.0, &end.across.tr_mul(&right));
                block.add(state + gap, state, 1.0, &(left * end.across));
                for other in (3..CARRIED).step_by(3) {
                    let entry: Matrix3<f64> = carried.fixed_view::<3, 3>(gap, other).into();
                    block.add(state + gap, state + other, 1.0, &entry);
                }
            }
        }

        // the nodes
        let mut largest = 0.0_f64;
        let first_model = self.models.len();
        let mut new_slope = end.across.tr_mul(slope);
        for (local, node) in panel.nodes.clone().enumerate() {
            let (data, shape) = (&mesh.data[node], &self.shapes[node]);
            let passing = &mesh.passing[data.passing.clone()];
            let acting = Acting {
                force: problem.factor * data.force + chords,
                moment_per_length: problem.factor * data.moment_per_length,
                gravity: problem.factor * problem.gravity,
            };
            let chords = panel.gap.is_some();
            let (form, model) = node::linearise(data, passing, problem.tensions, shape, &acting, shift, chords);
            let weight = data.weight;
            gradient.nodes[node] = Form {
                v: weight * form.v,
                turn: weight * form.turn,
                rate: weight * form.rate,
                start: weight * form.start,
                force: Vector3::zeros(),
            };
            new_slope += weight * form.start;
            assemble(&mut block, panel, table, local, weight, &model, chords);
            self.models.push(model);
        }
        debug_assert_eq!(first_model + points, self.models.len());

        // the gradient with respect to the turns, for the residual
        for l in 0..points {
            let mut sum = table.end[l] * end.jacobian.tr_mul(slope);
            for (local, node) in panel.nodes.clone().enumerate() {
                sum += table.derivative[local * points + l] / panel.length * gradient.nodes[node].rate;
                if local == l {
                    sum += gradient.nodes[node].turn;
                }
            }
            largest = larger(largest, sum.amax());
        }
        *slope = new_slope;

        let negative = front::eliminate(block.entries, size, state);
        for i in 0..size - state {
            for j in 0..size - state {
                carried[(i, j)] = block.entries[(state + i) * size + state + j];
            }
        }
        (negative, largest)
    }

    /// Internal moment at the end of a panel, on its base side, body frame, as [`Sweep::factor`] found it.
    pub(super) fn end_moment(&self, k: usize) -> Vector3<f64> {
        self.moments[k]
    }

    /// Force that the chords beside a panel take from the backbone, world frame.
    pub(super) fn chord_force(&self, panel: &Panel) -> Vector3<f64> {
        panel.gap.map_or(Vector3::zeros(), |gap| self.gaps[gap].force)
    }

    /// Solves with the factors: Hessian x step = right.
    pub(super) fn solve(&mut self, mesh: &Mesh, tables: &Tables, right: &Column, step: &mut Step) {
        self.tip_to_base(mesh, tables, right);
        self.base_to_tip(mesh, tables, right, step);
    }

    fn tip_to_base(&mut self, mesh: &Mesh, tables: &Tables, right: &Column) {
        let (mut state, mut gap_rows) = (Vector3::zeros(), [0.0; CARRIED]);
        for k in (0..mesh.panels.len()).rev() {
            let panel = &mesh.panels[k];
            let table = tables.of(panel.nodes.len());
            let (points, size, end) = (panel.nodes.len(), front_size(panel), self.ends[k]);
            let count = 3 * points;
            state += right.cuts[k + 1];
            if let Some(gap) = panel.gap.filter(|gap| mesh.gaps[*gap].panels.end == k + 1) {
                gap_rows = [0.0; CARRIED];
                for axis in 0..3 {
                    gap_rows[6 + axis] = right.gaps[gap][0][axis];
                    gap_rows[9 + axis] = right.gaps[gap][1][axis];
                }
            }
            let rows = &mut self.right[self.right_starts[k]..self.right_starts[k] + size];
            rows.fill(0.0);
            let mut start = end.across.tr_mul(&state);
            let through_end = end.jacobian.tr_mul(&state);
            for l in 0..points {
                put(rows, 3 * l, &(table.end[l] * through_end));
            }
            for (local, node) in panel.nodes.clone().enumerate() {
                let form = self.models[model_of(mesh, k, local)].condense(&self.shapes[node], &right.nodes[node]);
                put(rows, 3 * local, &form.turn);
                for l in 0..points {
                    put(rows, 3 * l, &(table.derivative[local * points + l] / panel.length * form.rate));
                }
                start += form.start;
                if panel.gap.is_some() {
                    for axis in 0..3 {
                        gap_rows[3 + axis] += form.force[axis];
                    }
                }
            }
            put(rows, count, &start);
            if panel.gap.is_some() {
                rows[count + 3..].copy_from_slice(&gap_rows[3..]);
            }
            let front = &self.fronts[self.starts[k]..self.starts[k] + size * size];
            front::forward(front, size, count, rows);
            state = Vector3::from_column_slice(&rows[count..count + 3]);
            if let Some(gap) = panel.gap {
                gap_rows[3..].copy_from_slice(&rows[count + 3..]);
                if mesh.gaps[gap].panels.start == k {
                    let front = &mut self.gaps[gap];
                    front.right[..6].copy_from_slice(&gap_rows[3..9]);
                    for axis in 0..3 {
                        front.right[6 + axis] = state[axis] + gap_rows[9 + axis];
                    }
                    front::forward(&front.matrix, GAP, GAP_PIVOTS, &mut front.right);
                    state = Vector3::from_column_slice(&front.right[6..]);
                }
            }
        }
    }

    fn base_to_tip(&mut self, mesh: &Mesh, tables: &Tables, right: &Column, step: &mut Step) {
        step.turn.resize(mesh.data.len(), Vector3::zeros());
        step.v.resize(mesh.data.len(), Vector3::zeros());
        step.cuts.resize(mesh.panels.len() + 1, Vector3::zeros());
        step.cuts[0] = Vector3::zeros();
        step.size = 0.0;
        let mut gap_values = [0.0; CARRIED];
        for k in 0..mesh.panels.len() {
            let panel = &mesh.panels[k];
            let table = tables.of(panel.nodes.len());
            let (points, size, end) = (panel.nodes.len(), front_size(panel), self.ends[k]);
            let count = 3 * points;
            let start = step.cuts[k];
            if let Some(gap) = panel.gap.filter(|gap| mesh.gaps[*gap].panels.start == k) {
                let front = &mut self.gaps[gap];
                let mut values = front.right;
                values[6..].copy_from_slice(start.as_slice());
                front::backward(&front.matrix, GAP, GAP_PIVOTS, &mut values);
                gap_values[3..9].copy_from_slice(&values[..6]);
                gap_values[9..].copy_from_slice(start.as_slice());
            }
            let rows = &mut self.right[self.right_starts[k]..self.right_starts[k] + size];
            rows[count..count + 3].copy_from_slice(start.as_slice());
            if panel.gap.is_some() {
                rows[count + 3..].copy_from_slice(&gap_values[3..]);
            }
            front::backward(&self.fronts[self.starts[k]..self.starts[k] + size * size], size, count, rows);
            for (local, node) in panel.nodes.clone().enumerate() {
                step.turn[node] = Vector3::from_column_slice(&rows[3 * local..3 * local + 3]);
            }
            let force = if panel.gap.is_some() {
                Vector3::from_column_slice(&gap_values[3..6])
            } else {
                Vector3::zeros()
            };
            for (local, node) in panel.nodes.clone().enumerate() {
                let turn = step.turn[node];
                let rate = rate_of(panel, table, local, &step.turn[panel.nodes.clone()]);
                let solved = Form { v: Vector3::zeros(), turn, rate, start, force };
                let model = &self.models[model_of(mesh, k, local)];
                // the model is per unit weight
                let shape = &self.shapes[node];
                step.v[node] = model.recover_v(shape, &(right.nodes[node].v / mesh.data[node].weight), &solved);
                let turned = shape.turned(&start, &turn);
                step.size = larger(step.size, larger(turned.norm(), step.v[node].norm()));
            }
            let turned: Vector3<f64> =
                table.end.iter().zip(&step.turn[panel.nodes.clone()]).map(|(e, turn)| *e * turn).sum();
            step.cuts[k + 1] = end.across * start + end.jacobian * turned;
            step.size = larger(step.size, step.cuts[k + 1].norm());
        }
    }

    /// Change of the displacement across some panels.
    fn displacement_change(
        &self,
        mesh: &Mesh,
        tables: &Tables,
        panels: std::ops::Range<usize>,
        step: &Step,
    ) -> Vector3<f64> {
        let _ = tables;
        let mut change = Vector3::zeros();
        for k in panels {
            for node in mesh.panels[k].nodes.clone() {
                let shape = &self.shapes[node];
                let turned = shape.turned(&step.cuts[k], &step.turn[node]);
                change += mesh.data[node].weight * (shape.rotation * (step.v[node] + turned.cross(&shape.v)));
            }
        }
        change
    }
}

/// Gradient and Hessian of the point loads at the end of panel `k` with respect to the rotation there.
fn point_loads(problem: &Problem, mesh: &Mesh, k: usize) -> (Vector3<f64>, Matrix3<f64>) {
    let jump = &problem.chain.spans[mesh.panels[k].span].jump;
    let to_body = problem.factor * mesh.rotations[k + 1].transpose();
    let (moment, weight) = (to_body * jump.moment, to_body * problem.gravity);
    let slope = -moment - jump.hung.cross(&weight);
    (slope, -0.5 * hat(&moment) - symmetric(&(hat(&weight) * hat(&jump.hung))))
}

/// Models are stored as they were made, from the tip's panel on.
fn model_of(mesh: &Mesh, k: usize, local: usize) -> usize {
    mesh.data.len() - mesh.panels[k].nodes.end + local
}

fn front_size(panel: &Panel) -> usize {
    3 * panel.nodes.len() + if panel.gap.is_some() { CARRIED } else { STATE }
}

fn sum(a: Option<usize>, b: Option<usize>) -> Option<usize> {
    Some(a? + b?)
}

fn symmetric(m: &Matrix3<f64>) -> Matrix3<f64> {
    0.5 * (m + m.transpose())
}

fn add(carried: &mut Carried, row: usize, column: usize, block: &Matrix3<f64>) {
    let mut view = carried.fixed_view_mut::<3, 3>(row, column);
    view += block;
}

fn put(rows: &mut [f64], at: usize, values: &Vector3<f64>) {
    for axis in 0..3 {
        rows[at + axis] += values[axis];
    }
}

/// A square matrix in 3 x 3 blocks.
struct Block<'a> {
    entries: &'a mut [f64],
    size: usize,
}

impl Block<'_> {
    #[inline(always)]
    fn add(&mut self, row: usize, column: usize, scale: f64, block: &Matrix3<f64>) {
        for (i, line) in self.entries[row * self.size..].chunks_exact_mut(self.size).take(3).enumerate() {
            let line = &mut line[column..column + 3];
            for (j, entry) in line.iter_mut().enumerate() {
                *entry += scale * block[(i, j)];
            }
        }
    }
}

/// Adds the model of one node to the front of its panel.
fn assemble(
    block: &mut Block,
    panel: &Panel,
    table: &Collocation,
    local: usize,
    weight: f64,
    model: &Linearised,
    in_gap: bool,
) {
    let points = panel.nodes.len();
    let state = 3 * points;
    let rates = &table.derivative[local * points..(local + 1) * points];
    let rate = |l: usize| rates[l] / panel.length;
    let rate_turn = model.turn_rate.transpose();
    for i in 0..points {
        for j in 0..points {
            block.add(3 * i, 3 * j, weight * rate(i) * rate(j), &model.rate_rate);
        }
        block.add(3 * local, 3 * i, weight * rate(i), &model.turn_rate);
        block.add(3 * i, 3 * local, weight * rate(i), &rate_turn);
        block.add(state, 3 * i, weight * rate(i), &model.start_rate);
        block.add(3 * i, state, weight * rate(i), &model.start_rate.transpose());
    }
    block.add(3 * local, 3 * local, weight, &model.turn_turn);
    block.add(3 * local, state, weight, &model.turn_start);
    block.add(state, 3 * local, weight, &model.start_turn);
    block.add(state, state, weight, &model.start_start);
    if in_gap {
        let nu = state + 3;
        for i in 0..points {
            block.add(3 * i, nu, weight * rate(i), &model.rate_force);
            block.add(nu, 3 * i, weight * rate(i), &model.rate_force.transpose());
        }
        block.add(3 * local, nu, weight, &model.turn_force);
        block.add(nu, 3 * local, weight, &model.turn_force.transpose());
        block.add(state, nu, weight, &model.start_force);
        block.add(nu, state, weight, &model.start_force.transpose());
        block.add(nu, nu, weight, &model.force_force);
    }
}
