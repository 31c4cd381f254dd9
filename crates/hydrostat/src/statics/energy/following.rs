//! Loads that follow the shape: the force beyond a section depends on how everything beyond it is turned, theory (43).
//!
//! Such loads have no energy. Their force beyond a cut is one more unknown that the elimination carries towards the base, as a linear
//! function of what the cut's other unknowns are.

use super::factor::{FIRST_PLATE, ROTATION};
use super::mesh::{Mesh, NodeData, Panel, Tables};
use super::node::{Linearised, Shape};
use super::sweep::{GAP, PanelFront, Problem, STATE, Step, Sweep};
use crate::geometry::hat;
use crate::numeric::blocks::Front;
use crate::numeric::collocation::{Collocation, MOST};
use nalgebra::{Matrix3, Vector3};

/// The loads of a panel with the load factor in them, body frame, and the following force at its end, world frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Following {
    per_length: Vector3<f64>,
    at_end: Vector3<f64>,
    /// Of all that acts at the end and beyond.
    pub(super) beyond: Vector3<f64>,
}

/// A linear function of a panel's unknowns, turns first, then those of its front's state.
type Coefficients = [Matrix3<f64>; MOST + STATE];

impl Sweep {
    /// The following forces beyond all nodes and panels of the placed shape.
    pub(super) fn follow(&mut self, problem: &Problem, mesh: &Mesh) {
        self.following.clear();
        if !mesh.follows {
            return;
        }
        self.following.resize(mesh.panels.len(), Following::default());
        self.following_forces.clear();
        self.following_forces.resize(mesh.data.len(), Vector3::zeros());
        let mut beyond = Vector3::zeros();
        for (k, panel) in mesh.panels.iter().enumerate().rev() {
            let (span, factor) = (&problem.chain.spans[panel.span], problem.factor);
            let of = &mut self.following[k];
            if panel.ends_span {
                of.at_end = factor * span.jump.following_force;
                beyond += mesh.rotations[k + 1] * of.at_end;
            }
            of.per_length = factor * span.following_force;
            of.beyond = beyond;
            let shapes = &self.shapes[panel.nodes.clone()];
            let table = problem.tables.of(shapes.len());
            let forces = &mut self.following_forces[panel.nodes.clone()];
            forces.fill(beyond);
            if of.per_length == Vector3::zeros() {
                continue;
            }
            for (j, shape) in shapes.iter().enumerate() {
                let force = panel.length * (shape.rotation * of.per_length);
                for (i, beyond) in forces.iter_mut().enumerate() {
                    *beyond += beyond_point(table, i, j) * force;
                }
                beyond += table.weights[j] * force;
            }
        }
    }

    /// How the following forces change along a step, panel by panel from the base: `force` is the change at the panel's start on entry
    /// and at its end, beyond the loads there, on return; `changes` gets those at the nodes.
    pub(super) fn follow_step(
        &self,
        mesh: &Mesh,
        tables: &Tables,
        k: usize,
        step: &Step,
        force: &mut Vector3<f64>,
        changes: &mut [Vector3<f64>],
    ) {
        let (panel, of) = (&mesh.panels[k], &self.following[k]);
        changes.fill(*force);
        if of.per_length == Vector3::zeros() {
            return;
        }
        let table = tables.of(panel.nodes.len());
        for (j, node) in panel.nodes.clone().enumerate() {
            let shape = &self.shapes[node];
            let turned = shape.turned(&step.cuts[k], &step.turn[node]);
            let change = panel.length * (shape.rotation * turned.cross(&of.per_length));
            for (i, of_node) in changes.iter_mut().enumerate() {
                *of_node -= table.to_point[i * panel.nodes.len() + j] * change;
            }
            *force -= table.weights[j] * change;
        }
    }

    /// Change of the following force at the end of panel `k` from its base side to beyond the load there.
    pub(super) fn follow_end(&self, mesh: &Mesh, k: usize, step: &Step) -> Vector3<f64> {
        -(mesh.rotations[k + 1] * step.cuts[k + 1].cross(&self.following[k].at_end))
    }
}

/// What a panel's part of the elimination is made of.
pub(super) struct PanelParts<'a> {
    pub(super) panel: &'a Panel,
    pub(super) table: &'a Collocation,
    pub(super) of: &'a PanelFront,
    pub(super) end_rotation: &'a Matrix3<f64>,
    pub(super) data: &'a [NodeData],
    pub(super) shapes: &'a [Shape],
    pub(super) models: &'a [Linearised],
    pub(super) following: &'a Following,
}

impl PanelParts<'_> {
    /// Adds to the front what the forces beyond the panel's nodes do as they follow its unknowns; its last row becomes the force beyond
    /// the start. `carried` is the same row of what lies beyond the panel.
    pub(super) fn add(&self, front: &mut Front, carried: &[Matrix3<f64>]) {
        let PanelParts { panel, table, of, following, .. } = self;
        let PanelFront { size, start: start_at, end, .. } = of;
        let (points, start_at, unknowns) = (self.shapes.len(), *start_at, size - 1);
        let mut beyond: Coefficients = [Matrix3::zeros(); MOST + STATE];
        let by_end = carried[ROTATION] - self.end_rotation * hat(&following.at_end);
        let through_end = by_end * end.jacobian;
        for (column, e) in beyond.iter_mut().zip(&table.end) {
            *column = *e * through_end;
        }
        beyond[start_at] = by_end * end.across;
        if panel.gap.is_some() {
            beyond[points..start_at].copy_from_slice(&carried[..GAP]);
            // where the gap begins its first plate is the start
            beyond[unknowns - 1] += carried[FIRST_PLATE];
        }

        let spread = following.per_length != Vector3::zeros();
        let mut by_node = [(Matrix3::zeros(), Matrix3::zeros()); MOST];
        if spread {
            for (by, shape) in by_node.iter_mut().zip(self.shapes) {
                let turned = -panel.length * (shape.rotation * hat(&following.per_length));
                *by = (turned * shape.jacobian, turned * shape.since_start.transpose());
            }
        }
        let of_node = |weight: &dyn Fn(usize) -> f64| {
            let mut force = beyond;
            if spread {
                for (j, (turn, start)) in by_node[..points].iter().enumerate() {
                    force[j] += weight(j) * turn;
                    force[start_at] += weight(j) * start;
                }
            }
            force
        };
        for (i, (data, model)) in self.data.iter().zip(self.models).enumerate() {
            let force = of_node(&|j| beyond_point(table, i, j));
            let mut add = |row: usize, of_force: Matrix3<f64>| {
                let row = &mut front.blocks[row * front.size..(row + 1) * front.size];
                row.iter_mut().zip(&force[..unknowns]).for_each(|(entry, force)| *entry += of_force * force);
            };
            if model.rate_force != Matrix3::zeros() {
                let rate_force = model.rate_force * (data.weight / panel.length);
                let rates = &table.derivative[i * points..(i + 1) * points];
                rates.iter().enumerate().for_each(|(l, rate)| add(l, *rate * rate_force));
            }
            add(i, data.weight * model.turn_force);
            add(start_at, data.weight * model.start_force);
            if panel.gap.is_some() {
                add(points, data.weight * model.force_force);
            }
        }
        let start = of_node(&|j| table.weights[j]);
        front.blocks[unknowns * front.size..][..unknowns].copy_from_slice(&start[..unknowns]);
    }
}

/// Weight of node `j` in the integral from node `i` to the panel's end.
fn beyond_point(table: &Collocation, i: usize, j: usize) -> f64 {
    table.weights[j] - table.to_point[i * table.weights.len() + j]
}
