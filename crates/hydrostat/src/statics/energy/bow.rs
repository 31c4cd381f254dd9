//! The bow of the backbone between guides: the first coefficient of its curvature that the points of a panel do not see, theory (65).

use super::mesh::{Mesh, Panel, Tables};
use super::newton::{Begin, Converged, Equations, Stuck};
use super::refine::{LARGEST_REDUCTION_IN_GAPS, SLOWEST_REDUCTION};
use super::search::{FINE_TOLERANCE, SAFETY, Search};
use super::sweep::Column;
use super::{Energy, Memory};
use crate::model::Routing;
use crate::numeric::collocation::FEWEST;
use crate::numeric::larger;
use nalgebra::Vector3;

/// Panels that turn further are not described by bows alone, rad.
pub(super) const MOST_BOWED: f64 = 0.15;
/// Part of the tolerance that the shape without bows may be off by where they are judged by how far they move it.
const SETTLED: f64 = 0.5;

impl Search<'_> {
    /// Whether bows are all that two points a panel leave out: straight tendons alone, without friction, on sections without taper.
    pub(super) fn bows_alone(&self) -> bool {
        let straight = self.robot.tendons.iter().all(|tendon| tendon.routing == Routing::Guides);
        let uniform = self.chain.spans.iter().all(|span| span.is_uniform());
        straight && uniform && !self.robot.tendons.is_empty() && !self.rubs()
    }

    /// Whether the shape at hand is one whose panels bows describe.
    pub(super) fn may_bow(&self) -> bool {
        let Energy { tables, coarse, .. } = &*self.energy;
        let fits = |panel: &Panel| panel.nodes.len() == FEWEST && panel.gap.is_some();
        self.bows_alone() && coarse.panels.iter().all(fits) && coarse.largest_turn(tables) <= MOST_BOWED
    }

    /// Lets every panel bow, from the solution without. Returns the estimated error, too, by how much that has moved the shape; None where
    /// something else than bows may be missing, and the shape is as it was.
    pub(super) fn let_bow(&mut self) -> Option<(Converged, f64)> {
        let tolerance = self.settings.tolerance;
        if tolerance < FINE_TOLERANCE || self.energy.coarse.bows || !self.may_bow() {
            return None;
        }
        // factors of other loads tell nothing of the stability under these
        let mut of_these_loads = self.last.is_some_and(|last| last.moved.is_finite());
        if self.last.is_none_or(|last| last.residual > SETTLED * tolerance) {
            of_these_loads |= self.newton_here(Begin::Placed).ok()?.moved.is_finite();
        }
        let Energy { tables, coarse, fine, memory, .. } = &mut *self.energy;
        let without = coarse.tail(tables);
        fine.clone_from(coarse);
        let (tensions, taut) = (memory.drive.tensions.clone(), memory.drive.taut.clone());
        let Ok(mut end) = self.bow_from_here() else {
            // back to the shape without
            let Energy { tables, coarse, fine, memory, .. } = &mut *self.energy;
            std::mem::swap(coarse, fine);
            (memory.drive.tensions, memory.drive.taut) = (tensions, taut);
            let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
            equations.place(&mut memory.sweep, &mut memory.drive, coarse);
            return None;
        };
        let Energy { tables, coarse, memory: Memory { sweep, .. }, .. } = &*self.energy;
        if of_these_loads {
            end.moved = end.moved.min(sweep.moved);
        }
        let reduction = (without / coarse.tail(tables)).clamp(SLOWEST_REDUCTION, LARGEST_REDUCTION_IN_GAPS);
        let rounding = end.residual.min(1e-3 * tolerance) + f64::EPSILON * coarse.data.len() as f64;
        Some((end, SAFETY * self.difference() / (reduction - 1.0) + rounding * self.chain.length))
    }

    /// The equilibrium with the bows that the gradient at the placed shape asks for.
    fn bow_from_here(&mut self) -> Result<Converged, Stuck> {
        let Energy { tables, coarse, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        equations.evaluate_placed(memory, coarse);
        coarse.bows = true;
        coarse.find_bows(tables, &memory.linear.downhill, &mut memory.linear.bows);
        coarse.take_bows(&memory.linear.bows);
        self.newton_here(Begin::WithFactors)
    }

    /// Newton's method at the full load on the coarse mesh, without friction.
    pub(super) fn newton_here(&mut self, begin: Begin) -> Result<Converged, Stuck> {
        let Energy { tables, coarse, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        let target = 0.1 * self.settings.tolerance;
        let end = equations.newton(memory, coarse, target, begin, &mut self.iterations)?;
        self.last = Some(end);
        Ok(end)
    }
}

impl Mesh {
    /// The bows that the gradient asks for, theory (65). Returns by how much that turns a node further, rad.
    pub(super) fn find_bows(&self, tables: &Tables, downhill: &Column, bows: &mut Vec<Vector3<f64>>) -> f64 {
        bows.clear();
        let mut largest = 0.0;
        for panel in &self.panels {
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let mut sum = Vector3::zeros();
            for (form, bow) in downhill.nodes[panel.nodes.clone()].iter().zip(&table.bow) {
                sum += *bow * form.turn;
            }
            let stiffness = self.data[panel.nodes.start].bend;
            let bow = (2 * points + 1) as f64 * sum.component_div(&stiffness);
            largest = larger(largest, (bow - panel.bow).amax() * panel.length * table.bow[0].abs());
            bows.push(bow);
        }
        largest
    }

    pub(super) fn take_bows(&mut self, bows: &[Vector3<f64>]) {
        for (panel, bow) in self.panels.iter_mut().zip(bows) {
            panel.bow = *bow;
        }
    }

    /// Largest coefficient of a turn that bows add, times the panel's part of the length.
    pub(super) fn largest_bow(&self) -> f64 {
        let of = |panel: &Panel| {
            let part = panel.length / (2 * (2 * panel.nodes.len() + 1)) as f64;
            panel.bow.norm() * part * panel.length
        };
        self.panels.iter().map(of).fold(0.0, larger)
    }
}
