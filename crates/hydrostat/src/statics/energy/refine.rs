//! Finer meshes, and what they tell of the error.

use super::mesh::Layout;
use super::search::{LARGEST_TURN, Search};
use super::{Energy, Memory, friction};
use crate::numeric::collocation::MOST;
use crate::numeric::larger;

/// What is assumed of the reduction by one more point before it has been seen, and the largest that is believed.
const UNSEEN_REDUCTION: f64 = 8.0;
const LARGEST_REDUCTION: f64 = 64.0;
pub(super) const SLOWEST_REDUCTION: f64 = 2.0;
/// Of it where tendons are straight between guides.
pub(super) const LARGEST_REDUCTION_IN_GAPS: f64 = 16.0;
/// Length, in parts of the whole, that an error of the part of a tension that friction leaves counts for.
const SHARES: f64 = 0.01;

impl Search<'_> {
    /// Cuts every panel that turns much in two.
    pub(super) fn bisect(&mut self) {
        let Energy { tables, layouts, coarse, .. } = &mut *self.energy;
        for panel in &coarse.panels {
            let turn = coarse.end_turn(panel, tables.of(panel.nodes.len())).norm();
            if turn > 0.5 * LARGEST_TURN && panel.ends_span {
                layouts[panel.span].parts *= 2;
                self.relaid = true;
            }
        }
        self.relay();
    }

    /// Lays the coarse mesh anew and keeps the shape.
    pub(super) fn relay(&mut self) {
        let tensions = self.energy.memory.drive.tensions.clone();
        let taut = self.energy.memory.drive.taut.clone();
        std::mem::swap(&mut self.energy.coarse, &mut self.energy.fine);
        self.lay();
        let rubs = self.rubs();
        let Energy { tables, coarse, fine, memory, .. } = &mut *self.energy;
        coarse.prolong(fine, tables);
        let Memory { sweep, drive, .. } = memory;
        sweep.place(coarse, tables);
        if rubs {
            // without what friction takes, Newton's method would lead to another shape
            let (means, ends) = (&mut drive.mean_shares, &mut drive.end_shares);
            friction::update(self.robot, coarse, sweep, tables, means, ends);
        }
        drive.tensions = tensions;
        drive.taut = taut;
    }

    /// One more point in every panel, or shorter panels; the mesh of before is in `fine`. Returns whether points were added.
    pub(super) fn refine(&mut self) -> bool {
        let add = self.energy.layouts.iter().all(|layout| layout.points < MOST);
        for layout in &mut self.energy.layouts {
            if add {
                layout.points += 1;
            } else {
                *layout = Layout { parts: 2 * layout.parts, points: MOST - 3 };
            }
        }
        self.relay();
        add
    }

    /// Largest distance between the shapes of the coarse mesh and the one before it.
    pub(super) fn difference(&self) -> f64 {
        let Energy { tables, coarse, fine, .. } = &*self.energy;
        let mut largest = 0.0;
        let same = fine.middles.len() == coarse.panels.len();
        for (k, panel) in coarse.panels.iter().enumerate() {
            let before = if same {
                [fine.middles[k].0, fine.positions[k + 1]]
            } else {
                [0.5, 1.0].map(|t| fine.at(tables, panel.from + t * panel.length).position)
            };
            for (position, before) in [coarse.middles[k].0, coarse.positions[k + 1]].iter().zip(before) {
                largest = larger(largest, (position - before).norm());
            }
        }
        if self.rubs() { larger(largest, self.difference_of_shares()) } else { largest }
    }

    /// Largest difference of the parts of the tensions that friction leaves, as a length.
    fn difference_of_shares(&self) -> f64 {
        let Energy { tables, coarse, fine, .. } = &*self.energy;
        let mut largest = 0.0;
        for (i, tendon) in self.robot.tendons.iter().enumerate().filter(|(_, tendon)| tendon.friction > 0.0) {
            let end = self.robot.tendon_end(tendon);
            for (k, panel) in coarse.panels.iter().enumerate().filter(|(_, panel)| panel.from < end) {
                let s = panel.from + 0.1 * panel.length;
                let shares = (coarse.share(tables, k, i, s), fine.share(tables, fine.panel_at(s), i, s));
                largest = larger(largest, (shares.0 - shares.1).abs());
            }
        }
        SHARES * largest * self.chain.length
    }

    /// By how much the last refinement reduced the error: as two differences tell, or as the highest coefficients on both meshes.
    pub(super) fn reduction(&self, added: bool, tails: (f64, f64), seen: Option<f64>) -> f64 {
        if self.rubs() {
            // the angle that a tendon turns by converges less fast than the shape
            return SLOWEST_REDUCTION;
        }
        let told = seen.filter(|_| added).or_else(|| added.then_some(tails.0 / tails.1));
        let straight = !self.energy.coarse.chords.is_empty();
        let largest = if straight { LARGEST_REDUCTION_IN_GAPS } else { LARGEST_REDUCTION };
        told.filter(|told| told.is_finite()).unwrap_or(UNSEEN_REDUCTION).clamp(SLOWEST_REDUCTION, largest)
    }
}
