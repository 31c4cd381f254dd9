//! The bow of the backbone between guides: the first coefficient of its curvature that the points of a panel do not see, theory (65).

use super::mesh::{Mesh, NodeData, Panel, Tables};
use super::newton::{Begin, Converged, Equations, Stuck};
use super::node::Shape;
use super::refine::{LARGEST_REDUCTION_IN_GAPS, SLOWEST_REDUCTION};
use super::search::{FINE_TOLERANCE, SAFETY, Search};
use super::sweep::{Column, Sweep};
use super::{Energy, Memory};
use crate::model::Routing;
use crate::numeric::collocation::{Collocation, FEWEST};
use crate::numeric::larger;
use crate::statics::span::Span;
use nalgebra::Vector3;

/// Panels that turn further are not described by bows alone, rad.
pub(super) const MOST_BOWED: f64 = 0.15;
/// What points leave out, as a part of the bend: per part of the elastic energy in the bows and turn^2, and of that in the highest
/// coefficient that the points see per turn^2 more.
const OF_ENERGY: f64 = 5.0;
const OF_TOP: f64 = 5.0;
/// Part of the tolerance that the shape without bows may be off by where they are judged by how far they move it.
const SETTLED: f64 = 0.5;

impl Search<'_> {
    /// Whether bows are all that two points a panel leave out: straight tendons alone, without friction, on sections without taper.
    pub(super) fn bows_alone(&self) -> bool {
        let straight = self.robot.tendons.iter().all(|tendon| tendon.routing == Routing::Guides);
        let uniform = self.chain.spans.iter().all(|span| span.is_uniform());
        straight && uniform && !self.robot.tendons.is_empty() && !self.rubs()
    }

    /// Largest force times h^2/K in a gap, under so much force: at pi^2 it buckles between its guides.
    pub(super) fn softening(&self, force: f64) -> f64 {
        let flexibility = |span: &Span| {
            let (_, bend) = span.stiffness(self.robot, span.from);
            (span.to - span.from).powi(2) / bend.min()
        };
        force * self.chain.spans.iter().map(flexibility).fold(0.0, larger)
    }

    /// Whether the points of every panel see how the gap softens, which a straight backbone does not show.
    pub(super) fn sees_softening(&self) -> bool {
        let Energy { coarse, .. } = &*self.energy;
        let fewest = coarse.panels.iter().map(|panel| panel.nodes.len()).min();
        coarse.chords.is_empty()
            || fewest.is_some_and(|fewest| fewest >= points_for(self.softening(self.compression())))
    }

    /// Whether the shape at hand is one whose panels bows describe.
    pub(super) fn may_bow(&self) -> bool {
        let Energy { tables, coarse, .. } = &*self.energy;
        let fits = |panel: &Panel| panel.nodes.len() == FEWEST && panel.gap.is_some();
        self.bows_alone()
            && self.sees_softening()
            && coarse.panels.iter().all(fits)
            && coarse.largest_turn(tables) <= MOST_BOWED
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
        let of_points = self.energy.error_of_points(false);
        Some((
            end,
            SAFETY * self.difference() / (reduction - 1.0) + (of_points + rounding) * self.chain.length,
        ))
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

impl Energy {
    /// By what part of the length points and bows may leave the tip off, theory (69); `made_up` where what the sums lose of the highest
    /// coefficient was made up for.
    pub(super) fn error_of_points(&self, made_up: bool) -> f64 {
        let Energy { tables, coarse, memory: Memory { sweep, .. }, .. } = self;
        let highest = coarse.highest(tables, sweep);
        let turn_squared = coarse.largest_turn(tables).powi(2);
        let of_turn =
            OF_ENERGY * turn_squared * larger(highest.of_bows, OF_TOP * turn_squared * highest.of_top);
        let lost = highest.lost_of_bows + if made_up { highest.still_lost } else { highest.lost };
        (of_turn + SAFETY * lost) / highest.whole * coarse.bend(sweep)
    }

    /// The same of points without bows, as far as one point more would not tell: the sums lose what they lost of a bow.
    pub(super) fn lost_by_points(&self) -> f64 {
        let Energy { tables, coarse, memory: Memory { sweep, .. }, .. } = self;
        let highest = coarse.highest(tables, sweep);
        SAFETY * highest.lost / highest.whole * coarse.bend(sweep)
    }
}

/// Elastic energies: of the whole, of the bows, of the highest coefficient that the points see, and how much less the force along the
/// backbone does on the latter two than it should, theory (70), still so once that was made up for.
struct Highest {
    whole: f64,
    of_bows: f64,
    of_top: f64,
    lost: f64,
    lost_of_bows: f64,
    still_lost: f64,
}

/// Points that see how a gap softens, s being the force times h^2/K, to 1e-4 of its stiffness: two leave out s^2/720, three
/// s^3/100800, four s^4/(9 1680^2).
pub(super) fn points_for(softening: f64) -> usize {
    if softening <= 0.25 {
        2
    } else if softening <= 2.0 {
        3
    } else if softening <= 6.0 {
        4
    } else {
        5
    }
}

/// Part of force h^2/K times the elastic energy of the highest coefficient that the sums over so many points lose, theory (70).
pub(super) fn lost_by_sums(points: usize) -> f64 {
    1.0 / (4 * (4 * points * points - 1)) as f64
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

    fn highest(&self, tables: &Tables, sweep: &Sweep) -> Highest {
        let mut sum = Highest {
            whole: f64::MIN_POSITIVE,
            of_bows: 0.0,
            of_top: 0.0,
            lost: 0.0,
            lost_of_bows: 0.0,
            still_lost: 0.0,
        };
        for panel in &self.panels {
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let stiffness = &self.data[panel.nodes.start].bend;
            let of = |u: &Vector3<f64>| u.dot(&stiffness.component_mul(u));
            let mut force = 0.0;
            for node in panel.nodes.clone() {
                let bent = sweep.shapes[node].u - self.data[node].rest_curvature;
                sum.whole += self.data[node].weight * of(&bent);
                force = larger(force, sweep.locals[node].force().norm());
            }
            // of a polynomial of Legendre's
            let of_degree = |degree: usize, u: &Vector3<f64>| panel.length / (2 * degree + 1) as f64 * of(u);
            let of_top = of_degree(points - 1, &self.highest_bend(panel, table, sweep));
            let of_bow = of_degree(points, &panel.bow);
            let softening = force * panel.length * panel.length / stiffness.min();
            let lost = softening * lost_by_sums(points) * of_top;
            sum.of_top += of_top;
            sum.of_bows += of_bow;
            sum.lost += lost;
            sum.still_lost += softening * lost;
            sum.lost_of_bows += softening * lost_by_sums(points + 1) * of_bow;
        }
        sum
    }

    /// Highest coefficient of a panel's bending that its points see.
    pub(super) fn highest_bend(&self, panel: &Panel, table: &Collocation, sweep: &Sweep) -> Vector3<f64> {
        let mut top = Vector3::zeros();
        for (node, part) in panel.nodes.clone().zip(&table.top_of_rate) {
            top += *part * (sweep.shapes[node].u - self.data[node].rest_curvature);
        }
        top
    }

    /// Integral of the bending over the backbone, rad.
    pub(super) fn bend(&self, sweep: &Sweep) -> f64 {
        let of = |(data, shape): (&NodeData, &Shape)| data.weight * (shape.u - data.rest_curvature).norm();
        self.data.iter().zip(&sweep.shapes).map(of).sum::<f64>().max(f64::MIN_POSITIVE)
    }
}
