//! The whole load at once, from the bend of the tendons.

use super::newton::{Converged, Equations};
use super::search::{LARGEST_TURN, ON_THE_WAY, Search};
use super::{Energy, Memory};
use crate::numeric::collocation::FEWEST;

/// Points that the first shape has less, and its accuracy.
const POINTS_LESS: usize = 2;
const ROUGH: f64 = 1e-3;

impl Search<'_> {
    /// The full load at once, on few points first, from the bend that the tendons alone would give: for those in channels the only
    /// equilibrium without loads, as its energy is convex in the strains. False where that does not surely lead to a stable shape
    /// nearby.
    pub(super) fn start_at_once(&mut self) -> bool {
        self.first_layout();
        let few = |points: usize| (points - POINTS_LESS).max(FEWEST);
        let more = self.energy.layouts.iter().any(|layout| few(layout.points) < layout.points);
        self.energy.layouts.iter_mut().for_each(|layout| layout.points = few(layout.points));
        self.lay();
        self.bend_by_tendons();
        let target = if more { ROUGH } else { ON_THE_WAY };
        let nearby = |search: &Self, end: &Converged| {
            let turn = search.energy.coarse.largest_turn(&search.energy.tables);
            end.negative == 0 && turn <= LARGEST_TURN && !search.strayed(end)
        };
        let Ok(end) = self.newton(1.0, target) else { return false };
        if !nearby(self, &end) {
            return false;
        }
        if more {
            self.first_layout();
            self.relay();
        }
        !more || self.newton(1.0, ON_THE_WAY.min(self.settings.tolerance)).is_ok_and(|end| nearby(self, &end))
    }

    /// Places the coarse mesh as bent by the tendons, with the tensions that a first step finds for those held.
    fn bend_by_tendons(&mut self) {
        let Energy { tables, coarse, reached, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        memory.drive.apply(self.robot, 1.0);
        if !memory.drive.held.is_empty() {
            equations.linearise(memory, coarse, 0.0);
            self.iterations += 1;
            let Memory { linear, drive, .. } = memory;
            for (&tendon, &tension) in drive.held.iter().zip(&linear.tensions) {
                drive.tensions[tendon] = tension;
            }
        }
        coarse.bend_by(self.robot, &memory.drive.tensions, tables);
        memory.sweep.place(coarse, tables);
        reached.rotations.clone_from(&coarse.rotations);
    }
}
