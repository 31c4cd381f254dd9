//! The whole load at once, from the bend of the tendons.

use super::newton::{Converged, Equations};
use super::search::{LARGEST_TURN, ON_THE_WAY, Search};
use super::{Averaged, Energy, Memory};
use crate::numeric::collocation::FEWEST;

/// Points that the first shape has less, and its accuracy.
const POINTS_LESS: usize = 2;
const ROUGH: f64 = 1e-3;

impl Search<'_> {
    /// The full load at once, on few points first, from the bend that the tendons alone would give: for those in channels the only
    /// equilibrium without loads, as its energy is convex in the strains. False where that does not surely lead to a stable shape
    /// nearby.
    pub(super) fn start_at_once(&mut self) -> bool {
        let Some(more) = self.start_on_few_points() else { return false };
        if more {
            self.first_layout();
            self.relay();
        }
        !more
            || self.newton(1.0, ON_THE_WAY.min(self.settings.tolerance)).is_ok_and(|end| self.is_nearby(&end))
    }

    /// Returns whether the first mesh has more points; None where no shape nearby was found.
    fn start_on_few_points(&mut self) -> Option<bool> {
        self.first_layout();
        let few = |points: usize| (points - POINTS_LESS).max(FEWEST);
        let more = self.energy.layouts.iter().any(|layout| few(layout.points) < layout.points);
        self.energy.layouts.iter_mut().for_each(|layout| layout.points = few(layout.points));
        self.lay();
        if !self.bend_as_averaged() {
            self.bend_by_tendons();
        }
        let end = self.newton(1.0, if more { ROUGH } else { ON_THE_WAY }).ok()?;
        self.is_nearby(&end).then_some(more)
    }

    /// Where the energy fell in some direction on the way there is more than one shape to reach.
    fn is_nearby(&self, end: &Converged) -> bool {
        let turn = self.energy.coarse.largest_turn(&self.energy.tables);
        end.most_negative == 0 && turn <= LARGEST_TURN && !self.strayed(end)
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

    /// Places a mesh with chords as the same robot with averaged gaps would be, which takes few panels. False without chords, or where
    /// that shape was not found.
    fn bend_as_averaged(&mut self) -> bool {
        if self.energy.coarse.chords.is_empty() {
            return false;
        }
        let mut averaged = self.energy.averaged.take().unwrap_or_default();
        averaged.measured = None;
        let Averaged { chain, energy, .. } = &mut *averaged;
        chain.rebuild_averaged(self.robot);
        let mut search = Search::new(energy, self.robot, chain, self.settings);
        let found = search.start_at_once();
        self.iterations += search.iterations;
        if found {
            let Energy { tables, coarse, reached, memory, .. } = &mut *self.energy;
            coarse.prolong(&energy.coarse, tables);
            memory.drive.tensions.clone_from(&energy.memory.drive.tensions);
            memory.drive.taut.clone_from(&energy.memory.drive.taut);
            memory.sweep.place(coarse, tables);
            reached.rotations.clone_from(&coarse.rotations);
        }
        self.energy.averaged = Some(averaged);
        found
    }
}
