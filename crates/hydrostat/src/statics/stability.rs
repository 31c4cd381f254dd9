//! The smallest eigenvalue of the energy's second variation, scaled by the elastic stiffness, theory (19).
//!
//! `mu` is an eigenvalue where the second variation minus `mu` times its elastic part is singular, which is the
//! second variation of a rod `1 / (1 - mu)` times as compliant under the same internal forces. The number of
//! eigenvalues below `mu` is its number of conjugate points; bisection finds where the first appears.

use super::chain::Chain;
use super::shooting::{Mesh, Sweep};
use crate::Robot;

/// Longest step, as the angle of `Span::largest_angle` or of the shape, for the transitions' fourth order to find
/// a critical load to 1e-6.
const LONGEST_STEP: f64 = 0.08;
/// .. but no more than so many altogether, which bounds the time.
const MOST_STEPS: usize = 10_000;
/// The eigenvalues accumulate at 1, which stands for itself.
const NEARLY_ONE: f64 = 0.999;
/// Accuracy of the eigenvalue.
const ACCURACY: f64 = 1e-7;
/// Far below any stable or usable equilibrium.
const LOWEST: f64 = -1e6;

/// The second variation of a solution on a mesh fine enough to judge it.
pub(super) struct SecondVariation<'a> {
    chain: &'a Chain,
    mesh: Mesh,
    sweep: &'a mut Sweep<2>,
}

impl<'a> SecondVariation<'a> {
    /// Of a solution with `steps` per span.
    pub(super) fn new(
        robot: &Robot,
        tensions: &[f64],
        chain: &'a Chain,
        solution: &Mesh,
        steps: &[usize],
        sweep: &'a mut Sweep<2>,
    ) -> Self {
        let of_load = chain
            .spans
            .iter()
            .zip(steps)
            .map(|(span, &count)| span.largest_angle(robot) * (span.to - span.from) / count as f64)
            .fold(solution.largest_turn(), f64::max);
        let most = (MOST_STEPS / solution.steps.len()).max(1) as f64;
        let parts = (of_load / LONGEST_STEP).ceil().clamp(1.0, most) as usize;
        let steps: Vec<usize> = steps.iter().map(|count| count * parts).collect();
        let mut mesh = Mesh::default();
        mesh.rebuild(robot, chain, tensions, &steps, usize::MAX);
        mesh.prolong(solution, 1.0, parts);
        SecondVariation { chain, mesh, sweep }
    }

    /// Number of eigenvalues below `mu` < 1.
    pub(super) fn eigenvalues_below(&mut self, mu: f64) -> usize {
        self.mesh.linearise(self.chain, 1.0, 1.0 / (1.0 - mu), self.sweep).conjugate_points
    }

    /// Positive for a stable equilibrium.
    pub(super) fn smallest_eigenvalue(&mut self) -> f64 {
        let mut below = |mu: f64| self.eigenvalues_below(mu) > 0;
        if !below(NEARLY_ONE) {
            return 1.0;
        }
        let (mut low, mut high) = if below(0.0) { (-1.0, 0.0) } else { (0.0, NEARLY_ONE) };
        while below(low) {
            (low, high) = (2.0 * low, low);
            if low < LOWEST {
                return low;
            }
        }
        while high - low > ACCURACY * (1.0 - low) {
            let middle = 0.5 * (low + high);
            if below(middle) { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    }
}
