//! Stability without an elimination: where the energy is convex in the strains.

use super::mesh::Mesh;
use super::sweep::{Problem, Sweep};
use crate::numeric::larger;

/// Where the bound is believed: the integrals are sums over nodes.
const SURELY: f64 = 0.1;

/// Part of the elastic energy's curvature that shear and stretch keep in any case.
const OF_SHEAR: f64 = 0.5;

impl Sweep {
    /// Whether every direction surely leads uphill.
    pub(super) fn surely_convex(&self, problem: &Problem, mesh: &Mesh) -> bool {
        self.curvature_bound(problem, mesh).is_some_and(|bound| bound >= SURELY)
    }

    /// Lower bound of the smallest eigenvalue of the energy's Hessian over its elastic part, theory (51), from the strains of the placed
    /// shape and the loads alone; None where there is no energy.
    pub(super) fn curvature_bound(&self, problem: &Problem, mesh: &Mesh) -> Option<f64> {
        let pulls = problem.tensions.iter().all(|tension| *tension >= 0.0);
        if !(problem.chain.conservative && pulls) {
            return None;
        }
        // dead loads and chords share what shear and stretch keep
        let straight = !mesh.chords.is_empty() || mesh.passing.iter().any(|passing| passing.slack.gap > 0.0);
        let of_shear = if straight { 0.5 * OF_SHEAR } else { OF_SHEAR };
        let gravity = problem.factor * problem.gravity.norm();
        let (mut flexibility, mut softening) = (0.0, 0.0);
        for panel in &mesh.panels {
            let nodes = panel.nodes.clone();
            let (data, shapes) = (&mesh.data[nodes.clone()], &self.shapes[nodes]);
            // that of the panel's end, which is the largest in it
            flexibility += data.iter().map(|data| data.weight / data.bend.min()).sum::<f64>();
            for (data, shape) in data.iter().zip(shapes) {
                let force = problem.factor * data.force.norm();
                let turning = 1.5 * (force * shape.v.norm() + gravity * data.mass_moment.norm());
                let shearing = force * force / (of_shear * data.shear.min());
                softening += data.weight * flexibility * (turning + shearing);
            }
            if panel.ends_span {
                let hung = problem.chain.spans[panel.span].jump.hung.norm();
                softening += 1.5 * gravity * hung * flexibility;
            }
        }
        let of_chords =
            (0..mesh.gaps.len()).map(|gap| self.softening_by_chords(problem, mesh, gap, of_shear));
        let averaged = (0..mesh.data.len()).map(|node| self.softening_in_gap(problem, mesh, node, of_shear));
        Some((1.0 - softening - of_chords.chain(averaged).fold(0.0, larger)).min(OF_SHEAR))
    }

    /// The same of a gap around a node, where gaps are averaged.
    fn softening_in_gap(&self, problem: &Problem, mesh: &Mesh, node: usize, of_shear: f64) -> f64 {
        let (data, stretch) = (&mesh.data[node], self.shapes[node].v.norm());
        let (mut tension, mut turning, mut across) = (0.0, 0.0, 0.0_f64);
        for passing in mesh.passing[data.passing.clone()].iter().filter(|passing| passing.slack.gap > 0.0) {
            let of_tendon = problem.tensions[passing.tendon] * passing.share;
            across = (24.0 * passing.slack.gap).sqrt();
            tension += of_tendon;
            turning += 1.5 * of_tendon * (passing.slack.hole.norm() + across * stretch);
        }
        across / data.bend.min() * (turning + across * tension * tension / (of_shear * data.shear.min()))
    }

    /// Part of a gap's elastic energy that its chords may take, theory (66): their lengths depend on the strains of the gap alone.
    fn softening_by_chords(&self, problem: &Problem, mesh: &Mesh, gap: usize, of_shear: f64) -> f64 {
        let gap = &mesh.gaps[gap];
        let (mut tension, mut turning) = (0.0, 0.0);
        for chord in &mesh.chords[gap.chords.clone()] {
            let of_chord = problem.tensions[chord.tendon] * chord.share;
            tension += of_chord;
            turning += 1.5 * of_chord * chord.holes[1].norm();
        }
        let (mut flexibility, mut shearing) = (0.0, 0.0);
        for panel in &mesh.panels[gap.panels.clone()] {
            let nodes = panel.nodes.clone();
            for (data, shape) in mesh.data[nodes.clone()].iter().zip(&self.shapes[nodes]) {
                flexibility += data.weight / data.bend.min();
                turning += 1.5 * data.weight * tension * shape.v.norm();
                shearing += data.weight * tension * tension / (of_shear * data.shear.min());
            }
        }
        flexibility * (turning + shearing)
    }
}
