//! From the last solution to one nearby: on its mesh, with the factors of its Hessian.

use super::newton::{Begin, Converged, NEAR};
use super::search::{Before, Search, Seen};
use super::tendons::Drive;
use super::{Energy, Memory};
use crate::model::Command;
use crate::numeric::larger;

/// Highest coefficients below are rounding.
const SMALLEST_TAIL: f64 = 1e-13;
/// Part of the tolerance that the error of a mesh may have for the next solution to be found on it.
const ROOM: f64 = 0.5;
/// Steps to a solution nearby that no new factors would save.
const FEW_STEPS: usize = 2;

impl Search<'_> {
    /// The equilibrium at the full load nearest to the last solution; `changed` where more than the commands has changed. Returns the
    /// estimated error, too, which grows with the highest coefficient; None where Newton's method did not converge.
    pub(super) fn continue_last(&mut self, changed: bool) -> Option<(Converged, f64)> {
        let target = 0.1 * self.settings.tolerance;
        if self.energy.layouts.len() != self.chain.spans.len() || self.energy.coarse.panels.is_empty() {
            return None;
        }
        let coarser = self.take_mesh_before();
        let same = !changed && !coarser && self.energy.memory.drive.is_of(self.robot);
        if same {
            let Energy { coarse, reached, .. } = &mut *self.energy;
            reached.rotations.clone_from(&coarse.rotations);
        } else {
            self.lay_under_last()?;
        }
        if self.rubs() {
            let end = self.newton(1.0, target).ok()?;
            return (!self.strayed(&end)).then_some((end, f64::INFINITY));
        }
        let begin = self.begin_nearby(same);
        let before = self.iterations;
        let end = self.newton_here(begin).ok()?;
        self.judge_factors(&end, self.iterations - before);
        if self.strayed(&end) || self.energy.coarse.bows && !self.may_bow() {
            return None;
        }
        let Seen { tail, error_estimate, compression, .. } = self.energy.seen;
        let mut growth = (self.energy.coarse.tail(&self.energy.tables) / tail.max(SMALLEST_TAIL)).max(1.0);
        let mut of_points = 0.0;
        if !self.energy.coarse.chords.is_empty() {
            // the backbone bends unevenly between guides as its force times what two points see
            growth = growth.max(self.compression() / compression);
            let bows = self.energy.coarse.bows;
            of_points = if bows { self.energy.error_of_points(false) } else { self.energy.lost_by_points() };
        }
        if !self.sees_softening() {
            return Some((end, f64::INFINITY));
        }
        let grown = larger(error_estimate * growth * growth, of_points * self.chain.length);
        Some((end, grown + end.residual.min(target) * self.chain.length))
    }

    /// Bound of the force along the backbone, N: tensions and dead loads together.
    pub(super) fn compression(&self) -> f64 {
        let loads =
            self.chain.spans.first().map_or(0.0, |span| span.dead_force(self.robot, span.from).norm());
        loads + self.energy.memory.drive.tensions.iter().sum::<f64>()
    }

    /// With what the way from the last solution begins, `placed` if the shape still is; bends that further where the factors would not do.
    pub(super) fn begin_nearby(&mut self, placed: bool) -> Begin {
        let sweep = &mut self.energy.memory.sweep;
        if placed && sweep.moved > 0.5 * NEAR {
            sweep.measure_moved();
        }
        let bend = self.bend_by_change();
        if bend > NEAR {
            Begin::Anew
        } else if placed && bend == 0.0 {
            Begin::Placed
        } else {
            Begin::WithFactors
        }
    }

    /// Forgets factors with which a solution nearby has taken more steps than new ones would.
    pub(super) fn judge_factors(&mut self, end: &Converged, steps: usize) {
        let of_new = &mut self.energy.seen.steps_of_new_factors;
        if end.moved.is_finite() {
            *of_new = steps;
        } else if steps > FEW_STEPS.max(*of_new) {
            self.energy.memory.sweep.factored = None;
        }
    }

    /// Lays the mesh anew, for a robot that has changed, under the shape and the tensions of the last solution. None where it has become
    /// another mesh.
    fn lay_under_last(&mut self) -> Option<()> {
        let Energy { coarse, fine, memory, .. } = &mut *self.energy;
        std::mem::swap(coarse, fine);
        let Drive { tensions, taut, held, mean_shares, .. } = &mut memory.drive;
        let means = std::mem::take(mean_shares);
        let last = (std::mem::take(tensions), std::mem::take(taut), std::mem::take(held));
        self.lay();
        let rubs = self.rubs();
        let Energy { coarse, fine, reached, memory, .. } = &mut *self.energy;
        let same = fine.data.len() == coarse.data.len()
            && fine.follows == coarse.follows
            && fine.gaps.len() == coarse.gaps.len()
            && fine.panels.len() == coarse.panels.len()
            && fine.panels.iter().zip(&coarse.panels).all(|(a, b)| a.nodes == b.nodes && a.gap == b.gap)
            && last.2 == memory.drive.held
            && last.0.len() == memory.drive.tensions.len();
        if !same {
            return None;
        }
        coarse.copy_shape(fine);
        reached.rotations.clone_from(&fine.rotations);
        (memory.drive.tensions, memory.drive.taut, _) = last;
        if rubs {
            coarse.set_shares(&fine.shares());
            memory.drive.mean_shares = means;
        }
        Some(())
    }

    /// Where the tensions have changed by so much that the last factors would not do, bends the shape as this alone would. Returns a
    /// bound of the turn.
    fn bend_by_change(&mut self) -> f64 {
        let Energy { tables, coarse, memory: Memory { sweep, drive, .. }, .. } = &mut *self.energy;
        let Drive { tensions, changes, .. } = drive;
        let (robot, mut bending) = (self.robot, 0.0);
        changes.clear();
        for ((tendon, command), last) in robot.tendons.iter().zip(&robot.actuation).zip(tensions) {
            let change = match command {
                Command::Tension { tension, .. } => tension - *last,
                Command::Displacement { .. } => 0.0,
            };
            changes.push(change);
            bending += change.abs() * tendon.path.radius.max(tendon.path.tip_radius);
        }
        if bending * self.chain.length <= NEAR * self.chain.stiffness {
            return 0.0;
        }
        let turn = coarse.bend_further(robot, changes, tables);
        sweep.moved += turn;
        turn
    }

    /// Goes back to the mesh before the last refinement, where that was fine enough. Returns whether it did.
    fn take_mesh_before(&mut self) -> bool {
        let Energy { layouts, coarse, fine, memory: Memory { sweep, .. }, seen, .. } = &mut *self.energy;
        let Some(Before { tail, error_estimate }) = seen.before.take() else { return false };
        if error_estimate > ROOM * self.settings.tolerance * self.chain.length {
            return false;
        }
        std::mem::swap(coarse, fine);
        layouts.iter_mut().for_each(|layout| layout.points -= 1);
        sweep.factored = None;
        *seen = Seen { tail, error_estimate, compression: seen.compression, ..Seen::default() };
        true
    }

    /// From the shape that was reached on a fine mesh to the same on the first one, to be refined again.
    pub(super) fn begin_anew_here(&mut self) -> Option<Converged> {
        self.first_layout();
        self.relay();
        self.newton(1.0, self.settings.tolerance).ok()
    }
}
