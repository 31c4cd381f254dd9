//! The smallest eigenvalue of the energy's second variation, scaled by the elastic stiffness, theory (19).
//!
//! `mu` is an eigenvalue where the second variation minus `mu` times its elastic part is singular, which is the
//! second variation of a rod `1 / (1 - mu)` times as compliant under the same internal forces. The number of
//! eigenvalues below `mu` is its number of conjugate points; bisection finds where the first appears. A gap between plates is
//! one step of shooting, which counts nothing within: whether the rod gives way there between two held plates is found apart.

use super::chain::Chain;
use super::rod::{self, Transition};
use super::shooting::{Mesh, Sweep};
use crate::Robot;
use crate::model::Routing;
use nalgebra::{Matrix3, Matrix6, Vector3};
use std::ops::Range;

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
    gaps: Vec<Gap>,
    sweep: &'a mut Sweep<2>,
}

/// Between two plates.
struct Gap {
    steps: Range<usize>,
    /// Of the chords: d(force)/d(displacement of the second plate), world frame.
    stiffness: Matrix3<f64>,
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
        // between plates the rod bears what the tendons pull
        let of_chords = solution.steps.iter().zip(&solution.own).map(|(step, own)| {
            let stage = &step.stages[rod::START];
            ((stage.force + own.force).norm() * stage.bend.amax()).sqrt() * step.length
        });
        let of_load = of_chords.fold(of_load, f64::max);
        let most = (MOST_STEPS / solution.steps.len()).max(1) as f64;
        let parts = (of_load / LONGEST_STEP).ceil().clamp(1.0, most) as usize;
        let steps: Vec<usize> = steps.iter().map(|count| count * parts).collect();
        let mut mesh = Mesh::default();
        mesh.rebuild(robot, chain, tensions, &steps, usize::MAX);
        mesh.prolong(solution, 1.0, parts);
        mesh.own_states(1.0);
        let gaps = gaps(robot, tensions, &mesh);
        SecondVariation { chain, mesh, gaps, sweep }
    }

    /// Whether an eigenvalue is below `mu` < 1.
    pub(super) fn falls_below(&mut self, mu: f64) -> bool {
        let softening = 1.0 / (1.0 - mu);
        self.mesh.linearise(self.chain, 1.0, softening, self.sweep).conjugate_points > 0
            || self.gaps.iter().any(|gap| gap.falls(&self.mesh, softening))
    }

    /// Positive for a stable equilibrium.
    pub(super) fn smallest_eigenvalue(&mut self) -> f64 {
        smallest(|mu| self.falls_below(mu))
    }
}

/// The smallest eigenvalue by bisection, theory (19); `below` tells whether one lies under a value. From nearly 1 on the answer is 1.
pub(super) fn smallest(mut below: impl FnMut(f64) -> bool) -> f64 {
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

/// The gaps that tendons cross in chords, on a mesh whose own states are known.
fn gaps(robot: &Robot, tensions: &[f64], mesh: &Mesh) -> Vec<Gap> {
    let same = 1e-9 * robot.length();
    let gap = |pair: &[f64]| {
        let [from, to] = [pair[0], pair[1]].map(|s| mesh.steps.partition_point(|step| step.from < s - same));
        let plates = [from, to].map(|k| (mesh.positions[k], mesh.nodes[k].rotation));
        let mut stiffness = Matrix3::zeros();
        for (tendon, tension) in robot.tendons.iter().zip(tensions) {
            let end = robot.tendon_end(tendon);
            if tendon.routing == Routing::Guides && pair[1] <= end + same {
                let hole =
                    |k: usize| plates[k].0 + plates[k].1 * tendon.path.hole((pair[k] / end).min(1.0), end).0;
                let chord: Vector3<f64> = hole(1) - hole(0);
                let along = chord.normalize();
                stiffness += (Matrix3::identity() - along * along.transpose()) * (tension / chord.norm());
            }
        }
        Gap { steps: from..to, stiffness }
    };
    robot.plates().windows(2).map(gap).collect()
}

impl Gap {
    /// Whether the energy falls in some direction that leaves both plates' rotations as they are.
    ///
    /// ```text
    /// pivots T12^-1 t12+ t12^-1 of the nodes,   then [-D 1; 1 K] of (dn, dd) with dd = D dn by the rod, K by the chords
    /// ```
    /// with t the transition from the first plate and dn the rod's own force, whose block -D takes three negative eigenvalues.
    fn falls(&self, mesh: &Mesh, softening: f64) -> bool {
        let mut t: Transition<3> = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { Matrix3::identity() } else { Matrix3::zeros() })
        });
        let mut p = [Matrix3::zeros(); 3];
        for k in self.steps.clone() {
            let (step, start) = (&mesh.steps[k], &mesh.own[k]);
            let (end, _) = rod::integrate(step, 1.0, start);
            let mut one = rod::transition::<3>(step, 1.0, softening, start, &end);
            let shift = rod::displacement_transition(step, 1.0, softening, start, &end, &one);
            if k + 1 < self.steps.end {
                rod::pass_transition(&mesh.jumps[k], 1.0, &end.rotation, &mut one);
            }
            for (j, p) in p.iter_mut().enumerate() {
                *p += (0..3).map(|i| shift[i] * t[i][j]).sum::<Matrix3<f64>>();
            }
            let next: Transition<3> =
                std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|l| one[i][l] * t[l][j]).sum()));
            if k > self.steps.start {
                let pivot = product_of_inverses(&one[0][1], &next[0][1], &t[0][1]);
                if pivot.is_none_or(|pivot| (pivot + pivot.transpose()).symmetric_eigenvalues().min() <= 0.0)
                {
                    return true;
                }
            }
            t = next;
        }
        let Some(held) = t[0][1].try_inverse() else { return true };
        let give = p[2] - p[1] * held * t[0][2];
        let unit = give.amax();
        let mut last = Matrix6::zeros();
        last.fixed_view_mut::<3, 3>(0, 0).copy_from(&(-(give + give.transpose()) / (2.0 * unit)));
        last.fixed_view_mut::<3, 3>(0, 3).copy_from(&Matrix3::identity());
        last.fixed_view_mut::<3, 3>(3, 0).copy_from(&Matrix3::identity());
        last.fixed_view_mut::<3, 3>(3, 3).copy_from(&(unit * self.stiffness));
        last.symmetric_eigenvalues().iter().filter(|value| **value <= 0.0).count() > 3
    }
}

/// a^-1 b c^-1.
fn product_of_inverses(a: &Matrix3<f64>, b: &Matrix3<f64>, c: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    Some(a.try_inverse()? * b * c.try_inverse()?)
}
