//! Gradient and Hessian of the energy at a placed shape, and the block elimination of the Hessian from tip to base.

use super::following::PanelParts;
use super::mesh::{Mesh, Panel};
use super::node::{self, Acting, Linearised, Local};
use super::sweep::{Column, End, GAP, GAP_PIVOTS, IN_GAP, Problem, Sweep};
use crate::geometry::hat;
use crate::numeric::blocks::{Front, symmetric};
use crate::numeric::collocation::Collocation;
use crate::numeric::larger;
use nalgebra::{Matrix3, Vector3};
use std::ops::{Index, IndexMut};

/// What has been eliminated beyond a cut, as a quadratic form in the rotation of the cut and, in a gap, in nu, d and the rotation
/// of the gap's first plate, and the following force there as a linear function of them. Of a symmetric form only the blocks on
/// and above the diagonal count.
#[derive(Clone, Copy, Default)]
struct Carried([Matrix3<f64>; (IN_GAP + 1) * IN_GAP]);

/// Row of the following force.
const FOLLOWING: usize = IN_GAP;

impl Index<(usize, usize)> for Carried {
    type Output = Matrix3<f64>;

    fn index(&self, (row, column): (usize, usize)) -> &Matrix3<f64> {
        &self.0[row * IN_GAP + column]
    }
}

impl IndexMut<(usize, usize)> for Carried {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut Matrix3<f64> {
        &mut self.0[row * IN_GAP + column]
    }
}

impl Carried {
    fn following(&self) -> &[Matrix3<f64>] {
        &self.0[FOLLOWING * IN_GAP..]
    }
}

impl Sweep {
    /// The energy's gradient at the placed shape. Returns the largest in units of stiffness / length.
    pub(super) fn gradient(&mut self, problem: &Problem, mesh: &Mesh, gradient: &mut Column) -> f64 {
        gradient.clear(mesh);
        self.locals.clear();
        self.follow(problem, mesh);
        self.pull_chords(problem, mesh, gradient);
        for (node, data) in mesh.data.iter().enumerate() {
            let passing = &mesh.passing[data.passing.clone()];
            let acting = Acting {
                force: problem.factor * data.force
                    + data.gap.map_or(Vector3::zeros(), |gap| self.gaps[gap].force)
                    + if mesh.follows { self.following_forces[node] } else { Vector3::zeros() },
                moment_per_length: problem.factor * data.moment_per_length,
                following_moment: problem.factor * data.following_moment,
                gravity: problem.factor * problem.gravity,
            };
            let shape = &self.shapes[node];
            let local = Local::new(data, passing, problem.tensions, shape, &acting);
            gradient.nodes[node] = local.gradient(data, shape);
            self.locals.push(local);
        }
        let mut residual = 0.0;
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
            residual =
                larger(residual, turns_residual(panel, problem.tables.of(forms.len()), end, &slope, forms));
            slope = end.across.tr_mul(&slope) + forms.iter().map(|form| form.start).sum::<Vector3<f64>>();
            if let Some((front, _)) = gap.filter(|(_, panels)| panels.start == k) {
                slope += front.first_plate;
            }
        }
        let unit = problem.chain.length / problem.chain.stiffness;
        for (data, form) in mesh.data.iter().zip(&gradient.nodes) {
            let strain = form.v.component_div(&data.shear).amax() / data.weight;
            residual = larger(residual, strain / unit);
        }
        residual * unit
    }

    /// Forces of the chords on the plates of their gaps, theory (33).
    fn pull_chords(&mut self, problem: &Problem, mesh: &Mesh, gradient: &mut Column) {
        self.gaps.resize_with(mesh.gaps.len(), Default::default);
        for (number, (gap, front)) in mesh.gaps.iter().zip(&mut self.gaps).enumerate() {
            (front.force, front.first_plate, front.second_plate) = Default::default();
            let [first, second] = [&mesh.rotations[gap.panels.start], &mesh.rotations[gap.panels.end]];
            let chords = gap.chords.clone();
            for (chord, (direction, _)) in mesh.chords[chords.clone()].iter().zip(&self.spans[chords]) {
                let pull = problem.tensions[chord.tendon] * chord.share * direction;
                front.force -= pull;
                front.first_plate -= chord.holes[0].cross(&first.tr_mul(&pull));
                front.second_plate += chord.holes[1].cross(&second.tr_mul(&pull));
            }
            // the energy's slope in d is what the chords carry, and closes by itself
            gradient.gaps[number][1] = front.first_plate;
        }
    }

    /// Eliminates the Hessian at the shape of [`Sweep::gradient`], with `shift` times the elastic part added. Returns the
    /// number of directions in which the energy falls; None where the elimination broke down.
    pub(super) fn factor(&mut self, problem: &Problem, mesh: &Mesh, shift: f64) -> Option<usize> {
        (self.factored, self.moved) = (None, 0.0);
        let mut negative = 0;
        let mut carried = Carried::default();
        for k in (0..mesh.panels.len()).rev() {
            let panel = &mesh.panels[k];
            if panel.ends_span {
                carried[(0, 0)] += point_loads(problem, mesh, k).1;
            }
            if let Some(gap) = panel.gap.filter(|gap| mesh.gaps[*gap].panels.end == k + 1) {
                self.enter_gap(problem, mesh, gap, &mut carried);
            }
            negative += self.eliminate_panel(problem, mesh, k, shift, &mut carried)?;
            if let Some(gap) = panel.gap.filter(|gap| mesh.gaps[*gap].panels.start == k) {
                negative += self.leave_gap(problem, mesh, gap, &mut carried)?;
            }
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

    /// The chords at the end of their gap: energy tau |c| with c from hole to hole, theory (33).
    fn enter_gap(&self, problem: &Problem, mesh: &Mesh, number: usize, carried: &mut Carried) {
        let gap = &mesh.gaps[number];
        let [first, second] = [&mesh.rotations[gap.panels.start], &mesh.rotations[gap.panels.end]];
        carried[(1, 2)] += Matrix3::identity();
        carried[(2, 1)] += Matrix3::identity();
        let chords = gap.chords.clone();
        for (chord, (t, length)) in mesh.chords[chords.clone()].iter().zip(&self.spans[chords]) {
            let tension = problem.tensions[chord.tendon] * chord.share;
            if tension == 0.0 {
                continue;
            }
            // (I - t t^T) tau/|c| between the changes of c by the second plate, by d and by the first plate
            let across = (Matrix3::identity() - t * t.transpose()) * (tension / length);
            let (pull_first, pull_second) = (first.tr_mul(&(tension * t)), second.tr_mul(&(tension * t)));
            let [hole_first, hole_second] = chord.holes.map(|hole| hat(&hole));
            let by_second = -(second * hole_second);
            let by_first = first * hole_first;
            let (across_second, across_first) = (across * by_second, across * by_first);
            let of_first_second = by_second.tr_mul(&across_first);
            carried[(0, 0)] +=
                by_second.tr_mul(&across_second) + symmetric(&(hat(&pull_second) * hole_second));
            carried[(0, 2)] += across_second.transpose();
            carried[(0, 3)] += of_first_second;
            carried[(2, 2)] += across;
            carried[(2, 3)] += across_first;
            carried[(3, 3)] += by_first.tr_mul(&across_first) - symmetric(&(hat(&pull_first) * hole_first));
            if !problem.chain.symmetric {
                carried[(2, 0)] += across_second;
                carried[(3, 0)] += of_first_second.transpose();
                carried[(3, 2)] += across_first.transpose();
            }
        }
    }

    /// Adds what is carried from beyond to the model of a panel, and eliminates its turns.
    fn eliminate_panel(
        &mut self,
        problem: &Problem,
        mesh: &Mesh,
        k: usize,
        shift: f64,
        carried: &mut Carried,
    ) -> Option<usize> {
        let panel = &mesh.panels[k];
        let (points, of) = (panel.nodes.len(), &self.panels[k]);
        let table = problem.tables.of(points);
        let blocks = &mut self.fronts[of.blocks..of.blocks + of.size * of.size];
        blocks.fill(Matrix3::zeros());
        let mut front = Front { blocks, size: of.size, symmetric: problem.chain.symmetric };
        let unknown = panel.gap.is_some() || mesh.follows;
        for node in panel.nodes.clone() {
            let (data, shape, local) = (&mesh.data[node], &self.shapes[node], &self.locals[node]);
            self.models[node] = node::linearise(data, shape, local, shift, unknown);
            assemble(&mut front, panel, table, node - panel.nodes.start, data.weight, &self.models[node]);
        }
        add_beyond(&mut front, table, &of.end, &of.slope, carried, panel.gap.is_some());
        if mesh.follows {
            let nodes = panel.nodes.clone();
            let parts = PanelParts {
                panel,
                table,
                end: &of.end,
                end_rotation: &mesh.rotations[k + 1],
                data: &mesh.data[nodes.clone()],
                shapes: &self.shapes[nodes.clone()],
                models: &self.models[nodes],
                following: &self.following[k],
            };
            parts.add(&mut front, carried.following());
        }
        let negative = front.eliminate(points)?;
        let state = of.size - points - usize::from(mesh.follows);
        for i in 0..state {
            for j in 0..state {
                carried[(i, j)] = front.blocks[(points + i) * of.size + points + j];
            }
        }
        if mesh.follows {
            for j in 0..state {
                carried[(FOLLOWING, j)] = front.blocks[(points + state) * of.size + points + j];
            }
        }
        Some(negative)
    }

    /// Joins the panel's start with the gap's first plate and eliminates nu and d.
    fn leave_gap(
        &mut self,
        problem: &Problem,
        mesh: &Mesh,
        number: usize,
        carried: &mut Carried,
    ) -> Option<usize> {
        let symmetric = problem.chain.symmetric;
        if symmetric {
            for i in 1..IN_GAP {
                for j in 0..i {
                    carried[(i, j)] = carried[(j, i)].transpose();
                }
            }
        }
        // rows of the gap's front among the carried ones; the rotation appears twice there
        const ROWS: [&[usize]; GAP + 1] = [&[1], &[2], &[0, 3], &[FOLLOWING]];
        let size = GAP + usize::from(mesh.follows);
        let blocks = &mut self.gaps[number].blocks[..size * size];
        blocks.fill(Matrix3::zeros());
        for (i, rows) in ROWS[..size].iter().enumerate() {
            for (j, columns) in ROWS[..GAP].iter().enumerate() {
                let entries =
                    rows.iter().flat_map(|row| columns.iter().map(|column| carried[(*row, *column)]));
                blocks[i * size + j] = entries.sum();
            }
        }
        let negative = Front { blocks, size, symmetric }.eliminate(GAP_PIVOTS);
        *carried = Carried::default();
        carried[(0, 0)] = blocks[GAP_PIVOTS * size + GAP_PIVOTS];
        if mesh.follows {
            carried[(FOLLOWING, 0)] = blocks[GAP * size + GAP_PIVOTS];
        }
        negative
    }
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
    let mut largest = 0.0;
    for l in 0..points {
        let mut sum = table.end[l] * through_end + forms[l].turn;
        for (local, form) in forms.iter().enumerate() {
            sum += (table.derivative[local * points + l] / panel.length) * form.rate;
        }
        largest = larger(largest, sum.amax());
    }
    largest
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

/// Adds what lies beyond the end of a panel to its front.
fn add_beyond(
    front: &mut Front,
    table: &Collocation,
    end: &End,
    slope: &Vector3<f64>,
    carried: &Carried,
    in_gap: bool,
) {
    let (points, start) = (table.points.len(), table.points.len());
    let beyond = &carried[(0, 0)];
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
        front.add_pair(i, start, *row, &turn_start, || start_turn);
    }
    front.add(start, start, 1.0, &end.across.tr_mul(&across));
    if !in_gap {
        return;
    }
    for gap in 1..IN_GAP {
        let (right, left) = (&carried[(0, gap)], &carried[(gap, 0)]);
        let turn_gap = end.jacobian.tr_mul(right);
        let gap_turn = if front.symmetric { Matrix3::zeros() } else { left * end.jacobian };
        for (i, e) in table.end.iter().enumerate() {
            front.add_pair(i, points + gap, *e, &turn_gap, || gap_turn);
        }
        front.add_pair(start, points + gap, 1.0, &end.across.tr_mul(right), || left * end.across);
        for other in gap..IN_GAP {
            front.add(points + gap, points + other, 1.0, &carried[(gap, other)]);
            if !front.symmetric && other > gap {
                front.add(points + other, points + gap, 1.0, &carried[(other, gap)]);
            }
        }
    }
}

/// Adds the model of one node to the front of its panel.
fn assemble(
    front: &mut Front,
    panel: &Panel,
    table: &Collocation,
    local: usize,
    weight: f64,
    model: &Linearised,
) {
    let (points, start) = (panel.nodes.len(), panel.nodes.len());
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
        let nu = start + 1;
        if model.rate_force != Matrix3::zeros() {
            let rate_force = model.rate_force * (weight / panel.length);
            for (i, row) in rates.iter().enumerate() {
                front.add_pair(i, nu, *row, &rate_force, || rate_force.transpose());
            }
        }
        front.add_pair(local, nu, weight, &model.turn_force, || model.turn_force.transpose());
        front.add_pair(start, nu, weight, &model.start_force, || model.start_force.transpose());
        front.add(nu, nu, weight, &model.force_force);
    }
}
