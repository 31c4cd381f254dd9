//! The bow of the backbone between guides: the first coefficient of its curvature that the points of a panel do not see, theory (65).

use super::mesh::{Mesh, Panel, Tables};
use super::newton::{Begin, Converged, Equations};
use super::search::{FINE_TOLERANCE, LARGEST_REDUCTION_IN_GAPS, SAFETY, SLOWEST_REDUCTION, Search};
use super::sweep::Column;
use super::{Energy, Memory};
use crate::numeric::collocation::FEWEST;
use crate::numeric::larger;
use nalgebra::Vector3;

/// Panels that turn further are not described by bows alone, rad.
pub(super) const MOST_BOWED: f64 = 0.15;

impl Search<'_> {
    /// Lets every panel bow, from the solution without. Returns the estimated error, too, by how much that has moved the shape; None where
    /// something else than bows may be missing, and the shape is as it was.
    pub(super) fn let_bow(&mut self) -> Option<(Converged, f64)> {
        let tolerance = self.settings.tolerance;
        let Energy { coarse, .. } = &*self.energy;
        let fits = |panel: &Panel| {
            let uniform = self.chain.spans[panel.span].is_uniform();
            panel.nodes.len() == FEWEST && panel.gap.is_some() && uniform
        };
        let known = tolerance >= FINE_TOLERANCE && coarse.bows.is_none() && !self.rubs();
        if !(known && coarse.passing.is_empty() && coarse.panels.iter().all(fits)) {
            return None;
        }
        let Energy { tables, coarse, fine, memory, .. } = &mut *self.energy;
        if coarse.largest_turn(tables) > MOST_BOWED {
            return None;
        }
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        let target = 0.1 * tolerance;
        if self.left > 0.5 * tolerance {
            equations.newton(memory, coarse, target, Begin::Placed, &mut self.iterations).ok()?;
        }
        let without = coarse.tail(tables);
        let straight = (coarse.turn.clone(), coarse.v.clone());
        fine.middles.clone_from(&coarse.middles);
        fine.positions.clone_from(&coarse.positions);
        equations.evaluate_placed(memory, coarse);
        coarse.bows = Some(1.0);
        let turned = coarse.find_bows(tables, &memory.linear.downhill, &mut memory.linear.bows);
        coarse.take_bows(&memory.linear.bows);
        let end = equations.newton(memory, coarse, target, Begin::WithFactors, &mut self.iterations);
        let difference = self.difference();
        let Energy { tables, coarse, memory: Memory { sweep, .. }, .. } = &mut *self.energy;
        let reduction = (without / coarse.tail(tables)).clamp(SLOWEST_REDUCTION, LARGEST_REDUCTION_IN_GAPS);
        let left = SAFETY * difference / (reduction - 1.0);
        match end {
            Ok(mut end) if left.is_finite() => {
                // under the same load
                end.moved = sweep.moved;
                coarse.bows = Some(difference / (self.chain.length * turned.max(f64::MIN_POSITIVE)));
                let rounding = end.residual.min(1e-3 * tolerance) + f64::EPSILON * coarse.data.len() as f64;
                Some((end, left + rounding * self.chain.length))
            }
            _ => {
                coarse.bows = None;
                (coarse.turn, coarse.v) = straight;
                sweep.place(coarse, tables);
                None
            }
        }
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
