//! Gradient and Hessian of the energy at a placed shape, and the block elimination of the Hessian from tip to base.

use super::following::PanelParts;
use super::mesh::{Mesh, NodeData, Panel};
use super::node::{self, Acting, Linearised, Local};
use super::sweep::{Column, End, PanelFront, Problem, STATE, Sweep};
use crate::geometry::hat;
use crate::numeric::blocks::{Front, symmetric};
use crate::numeric::collocation::{Collocation, MOST};
use crate::numeric::larger;
use crate::statics::section::{Path, Pull, Pulled, Stiffened};
use nalgebra::{Matrix3, Vector3};
use std::ops::{Index, IndexMut};

/// What has been eliminated beyond a cut, as a quadratic form in the rotation of the cut and, in a gap, in nu, d and the rotation
/// of the gap's first plate, in the order of a front, and the following force there as a linear function of them. Of a symmetric form only
/// the blocks on and above the diagonal count.
#[derive(Clone, Copy, Default)]
pub(super) struct Carried([Matrix3<f64>; (STATE + 1) * STATE]);

/// Rows and columns of what is carried, and the row of the following force.
pub(super) const NU: usize = 0;
pub(super) const D: usize = 1;
pub(super) const ROTATION: usize = 2;
pub(super) const FIRST_PLATE: usize = 3;
pub(super) const FOLLOWING: usize = STATE;

impl Index<(usize, usize)> for Carried {
    type Output = Matrix3<f64>;

    fn index(&self, (row, column): (usize, usize)) -> &Matrix3<f64> {
        &self.0[row * STATE + column]
    }
}

impl IndexMut<(usize, usize)> for Carried {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut Matrix3<f64> {
        &mut self.0[row * STATE + column]
    }
}

impl Carried {
    fn following(&self) -> &[Matrix3<f64>] {
        &self.0[FOLLOWING * STATE..]
    }
}

impl Sweep {
    /// The energy's gradient at the placed shape.
    pub(super) fn gradient(&mut self, problem: &Problem, mesh: &Mesh, gradient: &mut Column) {
        gradient.clear_but_nodes(mesh);
        gradient.nodes.clear();
        self.locals.clear();
        self.follow(problem, mesh);
        self.pull_chords(problem, mesh, gradient);
        for (node, data) in mesh.data.iter().enumerate() {
            let acting = Acting {
                force: problem.factor * data.force
                    + data.gap.map_or(Vector3::zeros(), |gap| self.gaps[gap].force)
                    + if mesh.follows { self.following_forces[node] } else { Vector3::zeros() },
                moment_per_length: problem.factor * data.moment_per_length,
                following_moment: problem.factor * data.following_moment,
                gravity: problem.factor * problem.gravity,
            };
            let shape = &self.shapes[node];
            let pulled = (!data.passing.is_empty()).then(|| {
                Pulled::new(pulls(problem, mesh, &self.paths, data), &data.bend, &shape.v, &shape.u)
            });
            let local = Local::new(data, pulled.as_ref(), shape, &acting);
            gradient.nodes.push(local.gradient(data, shape));
            self.locals.push(local);
        }
        let mut slope = Vector3::zeros();
        for k in (0..mesh.panels.len()).rev() {
            let panel = &mesh.panels[k];
            if panel.ends_span {
                let moment = point_loads(problem, mesh, k).0;
                slope += moment;
                gradient.cuts[k + 1] += moment;
            }
            let gap = panel.gap.map(|gap| (&self.gaps[gap], &mesh.gaps[gap].panels));
            if let Some((front, _)) = gap.filter(|(_, panels)| panels.end == k + 1) {
                slope += front.second_plate;
                gradient.cuts[k + 1] += front.second_plate;
            }
            self.panels[k].slope = slope;
            let end = &self.panels[k].end;
            let forms = &gradient.nodes[panel.nodes.clone()];
            slope = end.across.tr_mul(&slope) + forms.iter().map(|form| form.start).sum::<Vector3<f64>>();
            if let Some((front, _)) = gap.filter(|(_, panels)| panels.start == k) {
                slope += front.first_plate;
            }
        }
    }

    /// The largest of [`Sweep::gradient`], in units of stiffness / length.
    pub(super) fn largest_of(&self, problem: &Problem, mesh: &Mesh, gradient: &Column) -> f64 {
        let mut residual = 0.0;
        for (panel, PanelFront { end, slope, .. }) in mesh.panels.iter().zip(&self.panels) {
            let forms = &gradient.nodes[panel.nodes.clone()];
            let of_turns = turns_residual(panel, problem.tables.of(forms.len()), end, slope, forms);
            residual = larger(residual, of_turns);
        }
        let unit = problem.chain.length / problem.chain.stiffness;
        for (data, form) in mesh.data.iter().zip(&gradient.nodes) {
            let strain = form.v.component_div(&data.shear).amax() / data.weight;
            residual = larger(residual, strain / unit);
        }
        residual * unit
    }

    /// Eliminates the Hessian at the shape of [`Sweep::gradient`], with `shift` times the elastic part added. Returns the
    /// number of directions in which the energy falls; None where the elimination broke down.
    pub(super) fn factor(&mut self, problem: &Problem, mesh: &Mesh, shift: f64) -> Option<usize> {
        self.factored = None;
        self.mark_factored();
        let mut negative = 0;
        let mut carried = Carried::default();
        for k in (0..mesh.panels.len()).rev() {
            let panel = &mesh.panels[k];
            if panel.ends_span {
                carried[(ROTATION, ROTATION)] += point_loads(problem, mesh, k).1;
            }
            if let Some(gap) = panel.gap.filter(|gap| mesh.gaps[*gap].panels.end == k + 1) {
                self.bend_chords(problem, mesh, gap, &mut carried);
            }
            negative += self.eliminate_panel(problem, mesh, k, shift, &mut carried)?;
        }
        // every gap's nu is a multiplier, with three negative pivots of its own
        let multipliers = 3 * mesh.gaps.iter().filter(|gap| !gap.panels.is_empty()).count();
        let negative = if problem.chain.symmetric {
            negative.checked_sub(multipliers)?
        } else {
            negative.saturating_sub(multipliers)
        };
        self.factored = Some(negative).filter(|_| shift == 0.0);
        Some(negative)
    }

    /// Adds what is carried from beyond to the model of a panel and eliminates its turns, at the start of a gap nu and d, too.
    fn eliminate_panel(
        &mut self,
        problem: &Problem,
        mesh: &Mesh,
        k: usize,
        shift: f64,
        carried: &mut Carried,
    ) -> Option<usize> {
        let panel = &mesh.panels[k];
        let of = &self.panels[k];
        let (size, start) = (of.size, of.start);
        let table = problem.tables.of(panel.nodes.len());
        let blocks = &mut self.fronts[of.blocks..of.blocks + size * size];
        blocks.fill(Matrix3::zeros());
        let mut front = Front { blocks, size, symmetric: problem.chain.symmetric };
        let unknown = panel.gap.is_some() || mesh.follows;
        for node in panel.nodes.clone() {
            let (data, shape, local) = (&mesh.data[node], &self.shapes[node], &self.locals[node]);
            let stiffened = (!data.passing.is_empty()).then(|| {
                Stiffened::new(pulls(problem, mesh, &self.paths, data), &data.bend, &shape.v, &shape.u)
            });
            self.models[node] = node::linearise(data, shape, local, stiffened.as_ref(), shift, unknown);
            assemble(&mut front, of, panel, table, node - panel.nodes.start, data.weight, &self.models[node]);
        }
        add_beyond(&mut front, of, table, carried);
        if panel.gap.is_some() {
            add_beyond_in_gap(&mut front, of, table, carried, mesh.begins_gap(k));
        }
        if mesh.follows {
            let nodes = panel.nodes.clone();
            let parts = PanelParts {
                panel,
                table,
                of,
                end_rotation: &mesh.rotations[k + 1],
                data: &mesh.data[nodes.clone()],
                shapes: &self.shapes[nodes.clone()],
                models: &self.models[nodes],
                following: &self.following[k],
            };
            parts.add(&mut front, carried.following());
        }
        let negative = front.eliminate(of.pivots)?;
        // what is left, from the rotation of the start where nu and d are gone
        let (state, first) = (size - of.pivots - usize::from(mesh.follows), ROTATION + of.pivots - start);
        for i in 0..state {
            for j in 0..state {
                carried[(first + i, first + j)] = front.blocks[(of.pivots + i) * size + of.pivots + j];
            }
        }
        if mesh.follows {
            for j in 0..state {
                carried[(FOLLOWING, first + j)] = front.blocks[(size - 1) * size + of.pivots + j];
            }
        }
        Some(negative)
    }
}

/// The tendons that pass a node, and their paths.
fn pulls<'a>(
    problem: &'a Problem,
    mesh: &'a Mesh,
    paths: &'a [Path],
    data: &NodeData,
) -> impl Iterator<Item = (Pull, Path)> + 'a {
    let passing = mesh.passing[data.passing.clone()].iter().zip(&paths[data.passing.clone()]);
    passing.map(|(of, path)| (of.pull(problem.tensions), *path))
}

/// Largest gradient with respect to the turns of a panel.
fn turns_residual(
    panel: &Panel,
    table: &Collocation,
    end: &End,
    slope: &Vector3<f64>,
    forms: &[node::Form],
) -> f64 {
    let (points, through_end) = (forms.len(), end.jacobian.tr_mul(slope));
    let mut sums = [Vector3::zeros(); MOST];
    for ((sum, end), form) in sums.iter_mut().zip(&table.end).zip(forms) {
        *sum = *end * through_end + form.turn;
    }
    for (form, derivatives) in forms.iter().zip(table.derivative.chunks_exact(points)) {
        let rate = form.rate / panel.length;
        for (sum, d) in sums.iter_mut().zip(derivatives) {
            *sum += *d * rate;
        }
    }
    sums[..points].iter().map(Vector3::amax).fold(0.0, larger)
}

/// Gradient and Hessian of the point loads at the end of panel `k` with respect to the rotation there.
fn point_loads(problem: &Problem, mesh: &Mesh, k: usize) -> (Vector3<f64>, Matrix3<f64>) {
    let jump = &problem.chain.spans[mesh.panels[k].span].jump;
    if [jump.moment, jump.hung, jump.following_moment].iter().all(|load| *load == Vector3::zeros()) {
        return (Vector3::zeros(), Matrix3::zeros());
    }
    let to_body = problem.factor * mesh.rotations[k + 1].transpose();
    let (moment, weight) = (to_body * jump.moment, to_body * problem.gravity);
    let following = problem.factor * jump.following_moment;
    let slope = -moment - following - jump.hung.cross(&weight);
    (slope, 0.5 * hat(&(following - moment)) - symmetric(&(hat(&weight) * hat(&jump.hung))))
}

/// Adds what lies beyond the end of a panel to its front, as far as it depends on the rotation of the end.
fn add_beyond(front: &mut Front, of: &PanelFront, table: &Collocation, carried: &Carried) {
    let PanelFront { start, end, slope, .. } = of;
    let beyond = &carried[(ROTATION, ROTATION)];
    let across = beyond * end.across;
    let half = 0.5 * end.jacobian.tr_mul(&(hat(slope) * end.across));
    let turn_turn =
        end.jacobian.tr_mul(&(beyond * end.jacobian)) + symmetric(&end.turn.transpose_differential(slope));
    let turn_start = end.jacobian.tr_mul(&across) + half;
    let start_turn = if front.symmetric {
        Matrix3::zeros()
    } else {
        end.across.tr_mul(&(beyond * end.jacobian)) + half.transpose()
    };
    for (i, row) in table.end.iter().enumerate() {
        let first = if front.symmetric { i } else { 0 };
        for (j, column) in table.end.iter().enumerate().skip(first) {
            front.add(i, j, row * column, &turn_turn);
        }
        front.add_pair(i, *start, *row, &turn_start, || start_turn);
    }
    front.add(*start, *start, 1.0, &end.across.tr_mul(&across));
}

/// The same with nu, d and the rotation of the gap's first plate, which is that of the start where the gap begins.
fn add_beyond_in_gap(
    front: &mut Front,
    of: &PanelFront,
    table: &Collocation,
    carried: &Carried,
    begins: bool,
) {
    let PanelFront { start, end, .. } = of;
    let start = *start;
    let symmetric = front.symmetric;
    let first_plate = if begins { start } else { start + 1 };
    let places = [(NU, start - 2), (D, start - 1), (FIRST_PLATE, first_plate)];
    for (i, (row, at)) in places.into_iter().enumerate() {
        // with the rotation of the end, to its right and across the diagonal
        let right = if row < ROTATION || !symmetric {
            carried[(row, ROTATION)]
        } else {
            carried[(ROTATION, row)].transpose()
        };
        let left = if symmetric { right.transpose() } else { carried[(ROTATION, row)] };
        let turn_row = end.jacobian.tr_mul(&left);
        let row_turn = if symmetric { Matrix3::zeros() } else { right * end.jacobian };
        for (turn, e) in table.end.iter().enumerate() {
            front.add_pair(turn, at, *e, &turn_row, || row_turn);
        }
        let (row_start, start_row) = (right * end.across, end.across.tr_mul(&left));
        if at < start {
            front.add_pair(at, start, 1.0, &row_start, || start_row);
        } else if at > start {
            front.add_pair(start, at, 1.0, &start_row, || row_start);
        } else {
            front.add(start, start, 1.0, &(row_start + start_row));
        }
        for (column, other) in places.into_iter().skip(i) {
            front.add(at, other, 1.0, &carried[(row, column)]);
            if !symmetric && column > row {
                front.add(other, at, 1.0, &carried[(column, row)]);
            }
        }
    }
}

/// Adds the model of one node to the front of its panel.
fn assemble(
    front: &mut Front,
    of: &PanelFront,
    panel: &Panel,
    table: &Collocation,
    local: usize,
    weight: f64,
    model: &Linearised,
) {
    let (points, start) = (panel.nodes.len(), of.start);
    let rates = &table.derivative[local * points..(local + 1) * points];
    let rate_rate = model.rate_rate * (weight / (panel.length * panel.length));
    let turn_rate = model.turn_rate * (weight / panel.length);
    let rate_turn = turn_rate.transpose();
    let start_rate = model.start_rate * (weight / panel.length);
    for (i, row) in rates.iter().enumerate() {
        let first = if front.symmetric { i } else { 0 };
        for (j, column) in rates.iter().enumerate().skip(first) {
            front.add(i, j, row * column, &rate_rate);
        }
        // the turn of this node with the rates of all
        if i >= local || !front.symmetric {
            front.add(local, i, *row, &turn_rate);
        }
        if i <= local || !front.symmetric {
            front.add(i, local, *row, &rate_turn);
        }
        if model.start_rate != Matrix3::zeros() {
            front.add_pair(i, start, *row, &start_rate.transpose(), || start_rate);
        }
    }
    front.add(local, local, weight, &model.turn_turn);
    front.add_pair(local, start, weight, &model.turn_start, || model.start_turn);
    front.add(start, start, weight, &model.start_start);
    if panel.gap.is_some() {
        let nu = points;
        if model.rate_force != Matrix3::zeros() {
            let rate_force = model.rate_force * (weight / panel.length);
            for (i, row) in rates.iter().enumerate() {
                front.add_pair(i, nu, *row, &rate_force, || rate_force.transpose());
            }
        }
        front.add_pair(local, nu, weight, &model.turn_force, || model.turn_force.transpose());
        front.add_pair(nu, start, weight, &model.start_force.transpose(), || model.start_force);
        front.add(nu, nu, weight, &model.force_force);
    }
}
