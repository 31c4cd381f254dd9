//! Stability without an elimination: where the energy is convex in the strains.

use super::mesh::Mesh;
use super::sweep::{Problem, Sweep};

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
    /// shape and the loads alone; None with chords, and where there is no energy.
    pub(super) fn curvature_bound(&self, problem: &Problem, mesh: &Mesh) -> Option<f64> {
        let pulls = problem.tensions.iter().all(|tension| *tension >= 0.0);
        if !(problem.chain.conservative && mesh.chords.is_empty() && pulls) {
            return None;
        }
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
                let shearing = force * force / (OF_SHEAR * data.shear.min());
                softening += data.weight * flexibility * (turning + shearing);
            }
            if panel.ends_span {
                let hung = problem.chain.spans[panel.span].jump.hung.norm();
                softening += 1.5 * gravity * hung * flexibility;
            }
        }
        Some((1.0 - softening).min(OF_SHEAR))
    }
}
