//! Robots with guides by way of the averaged robot, theory (67) to (70): it finds the shape, the gaps show what it leaves out.

use super::bow::points_for;
use super::gaps::Gaps;
use super::mesh::{Layout, Mesh};
use super::newton::{Begin, Converged, Equations};
use super::search::{FINE_TOLERANCE, Found, SAFETY, Search, Seen, Start};
use super::{Averaged, Energy, Memory};
use crate::Robot;
use crate::numeric::larger;
use crate::statics::chain::Chain;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

// Where a number below has no derivation it is the smallest, as a round one, with which `tests/averaged.rs` held on twenty times as many robots.

/// Gaps that turn further are not averaged, rad.
const MOST_TURNED: f64 = 0.3;
/// How often the gaps are measured, and by how much a measurement is taken to reduce the error at most.
const MOST_ROUNDS: usize = 8;
const LARGEST_REDUCTION: f64 = 10.0;
/// What one change is taken to be of the one before where that was not seen.
const UNSEEN: f64 = 0.5;
/// Part of one change that may not be seen in the next: the tensions of held tendons follow a turn later.
const LAG: f64 = 0.1;
const LAG_OF_HELD: f64 = 0.3;
/// Points in a gap at most, and the part of the tolerance that what these leave out may take.
const MOST_POINTS: usize = 4;
const OF_POINTS: f64 = 0.25;
/// Part of what gaps and averaged robot do against each other that may come to light farther on.
const OF_CHANGE: f64 = 0.2;
/// Factor on the drift, for other directions than that in which it was seen.
const OF_DRIFT: f64 = 10.0;
/// Part of the first drift that is assumed whatever later measurements show, and the part of the bend from which on one tells it.
const LEAST_DRIFT: f64 = 0.2;
const LEAST_MOVED: f64 = 1e-4;
/// Part of the bend up to which what was left out is a start for the next measurement.
const FARTHEST: f64 = 0.15;
/// A robot that bends less, rad, has not shown how it drifts.
const LEAST_BEND: f64 = 1e-3;
/// Force times h^2/K up to which gaps are averaged: what (67) leaves out of their softening is s^3/30240 of the stiffness.
const MOST_SOFTENED: f64 = 2.0;
/// Bending in the gaps may be so many times that of the averaged robot, and is compared where this is above so much of the largest.
const MOST_MORE: f64 = 2.0;
const NEXT_TO_NOTHING: f64 = 1e-3;

/// What the averaged robot leaves out, as the gaps showed it.
#[derive(Clone, Debug, Default)]
pub(super) struct Measured {
    /// Where the averaged robot stood, its bending in all, rad, under which tensions, and the way from its tip to that of the gaps.
    averaged: Mesh,
    bend: f64,
    tensions: Vec<f64>,
    offset: Vector3<f64>,
    /// Largest bending in the gaps over that of the averaged robot, and distance of a tendon from its channel, per panel of that robot.
    pub(super) more: Vec<Largest>,
    error_estimate: f64,
    /// How fast the error grows with the way from there, as [`Measured::way`] tells, and the first time that was seen, m/rad.
    drift: f64,
    first_drift: f64,
}

/// Bending of the backbone, 1/m, and distance of a tendon from its channel over the radius of its hole.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Largest {
    pub(super) bending: f64,
    pub(super) deviation: f64,
}

impl Largest {
    /// Parts of another; 1 where that is next to nothing beside the largest of all.
    fn over(&self, other: &Self, most: &Self) -> Self {
        let part = |of: f64, other: f64, most: f64| {
            if other > NEXT_TO_NOTHING * most { (of / other).clamp(1.0 / MOST_MORE, MOST_MORE) } else { 1.0 }
        };
        Largest {
            bending: part(self.bending, other.bending, most.bending),
            deviation: part(self.deviation, other.deviation, most.deviation),
        }
    }

    fn or(self, other: &Self) -> Self {
        Largest {
            bending: larger(self.bending, other.bending),
            deviation: larger(self.deviation, other.deviation),
        }
    }
}

impl Measured {
    /// How far a shape is from there, rad: by its turn, or by the part of the tensions that has changed, which bends the gaps apart.
    fn way(&self, averaged: &Mesh, tensions: &[f64]) -> f64 {
        let changes = tensions.iter().zip(&self.tensions).map(|(now, then)| (now - then).abs());
        let (change, whole) = (changes.sum::<f64>(), self.tensions.iter().sum::<f64>());
        let part = if change > 0.0 { change / whole } else { 0.0 };
        averaged.turned_from(&self.averaged).max(part * self.bend)
    }

    /// The drift by what this measurement and one `before` it have brought to light, m.
    fn find_drift(&mut self, before: Option<&Self>, held: bool, left_out: f64) {
        self.drift = match before {
            // of tensions to be found, and of a straight robot, the first measurement tells too little
            None if held || self.bend < LEAST_BEND => f64::INFINITY,
            None => left_out / self.bend,
            Some(before) => {
                let way = before.way(&self.averaged, &self.tensions).max(LEAST_MOVED * self.bend);
                let floor = if self.first_drift.is_finite() { LEAST_DRIFT * self.first_drift } else { 0.0 };
                (left_out / way).max(floor)
            }
        };
        if !self.first_drift.is_normal() {
            self.first_drift = self.drift;
        }
    }
}

/// How far measurements in a row have led, and what may still come.
struct Rounds {
    /// Part of one change that may not be seen in the next, and the least that one is taken to be of the one before.
    lag: f64,
    slowest: f64,
    /// What the first change is taken to be of one before.
    unseen: f64,
    last: Option<f64>,
    /// What they have brought to light, and the changes expected beyond, m.
    left_out: f64,
    to_come: f64,
}

impl Rounds {
    /// Of gaps with so much of `softening`, as [`Search::softening`] tells, `known` where they have been measured before: what the nodes
    /// give way by at first shows in the next turn only, as do the tensions of held tendons.
    fn new(held: bool, softening: f64, known: bool) -> Self {
        Rounds {
            lag: if held { LAG_OF_HELD } else { LAG },
            slowest: (softening / PI.powi(2)).max(1.0 / LARGEST_REDUCTION),
            unseen: if known && !held { UNSEEN } else { 1.0 },
            last: None,
            left_out: 0.0,
            to_come: f64::INFINITY,
        }
    }

    /// `seen`: by how much averaged robot and gaps have changed, each for itself; `together`: by how much the tip has, m.
    fn add(&mut self, seen: f64, together: f64) {
        let change = seen.max(self.last.map_or(0.0, |last| self.lag * last));
        self.left_out += together + OF_CHANGE * seen;
        let ratio = self.last.map_or(self.unseen, |last| change / last).max(self.slowest);
        self.to_come = if ratio < 1.0 { change * ratio / (1.0 - ratio) } else { f64::INFINITY };
        self.last = Some(change);
    }
}

impl Energy {
    /// The largest on each panel of the averaged robot.
    fn largest(&self, robot: &Robot, chain: &Chain, averaged: &Mesh) -> Vec<Largest> {
        let mut largest = vec![Largest::default(); averaged.panels.len()];
        self.visit_strains(chain, |span, s, _, u| {
            let bending = u - robot.sections[span.section].rest_curvature;
            let of_panel = &mut largest[averaged.panel_at(s)].bending;
            *of_panel = larger(*of_panel, bending.xy().norm());
        });
        self.visit_deviations(robot, |s, away, radius| {
            let of_panel = &mut largest[averaged.panel_at(s)].deviation;
            *of_panel = larger(*of_panel, away / radius);
        });
        largest
    }

    /// The averaged robot, where it holds the last solution.
    pub(super) fn read_averaged(&self) -> Option<(&Averaged, &Measured)> {
        let averaged = self.averaged.as_deref().filter(|averaged| averaged.holds_solution)?;
        Some((averaged, averaged.measured.as_ref()?))
    }

    /// Brings the gaps to where the averaged robot stands, where that holds the last solution.
    pub(super) fn bring_gaps(&mut self, robot: &Robot, chain: &Chain) {
        let Some(mut averaged) = self.averaged.take() else { return };
        if std::mem::take(&mut averaged.holds_solution) && averaged.measured.is_some() {
            let Averaged { gaps, energy, .. } = &mut *averaged;
            self.place_gaps(robot, chain, gaps, energy);
        }
        self.averaged = Some(averaged);
    }

    /// Places the gaps beside the averaged robot, and finds the gradient there.
    fn place_gaps(&mut self, robot: &Robot, chain: &Chain, gaps: &mut Gaps, averaged: &Energy) {
        let Energy { tables, coarse, memory, .. } = self;
        gaps.place(&averaged.coarse, &averaged.memory.sweep, coarse, tables);
        memory.drive.tensions.clone_from(&averaged.memory.drive.tensions);
        memory.drive.taut.clone_from(&averaged.memory.drive.taut);
        memory.sweep.factored = None;
        let equations = Equations { robot, chain, tables, factor: 1.0 };
        equations.place(&mut memory.sweep, &mut memory.drive, coarse);
        let Memory { sweep, linear, drive } = memory;
        sweep.gradient(&equations.problem(&drive.tensions), coarse, &mut linear.downhill);
        linear.downhill.negate();
    }

    /// Lets the nodes in the gaps give way to what they lack, as far as the averaged robot cannot take it over.
    fn relax_gaps(&mut self, gaps: &mut Gaps, averaged: &Mesh) {
        let Energy { tables, coarse, memory, .. } = self;
        let Memory { sweep, linear, .. } = memory;
        gaps.find_lacking(sweep, coarse, tables, &linear.downhill);
        gaps.make_up(sweep, coarse, tables);
        gaps.share(coarse, averaged);
        gaps.give_way(coarse, sweep, tables);
        coarse.find_bows(tables, &linear.downhill, &mut linear.bows);
        coarse.take_bows(&linear.bows);
    }
}

impl Search<'_> {
    /// Whether the averaged robot may stand for the one with guides.
    fn may_average(&self) -> bool {
        self.settings.tolerance >= FINE_TOLERANCE
            && self.settings.largest_load_step == 1.0
            && self.bows_alone()
            && !self.chain.follower
            && self.chain.has_even_gaps()
    }

    /// The equilibrium by way of the averaged robot; None where that does not surely lead to it.
    pub(super) fn by_averaging(&mut self, start: Start) -> Option<Found> {
        // the last solution may be on another branch than the averaged robot finds
        let led = self.energy.averaged.as_ref().is_some_and(|averaged| averaged.led);
        let averages = self.may_average()
            && match start {
                Start::Rest => true,
                Start::Last { .. } => led,
                Start::Shape(_) => false,
            };
        if !averages && matches!(start, Start::Last { changed: false }) {
            self.energy.bring_gaps(self.robot, self.chain);
        }
        let mut averaged = match self.energy.averaged.take() {
            None if !averages => return None,
            of_before => of_before.unwrap_or_default(),
        };
        averaged.holds_solution = false;
        let found = if averages { self.find_averaged(&mut averaged, start) } else { None };
        averaged.led = found.is_some();
        if found.is_none() {
            (averaged.measured, averaged.holds_solution) = (None, false);
        }
        self.energy.averaged = Some(averaged);
        found
    }

    fn find_averaged(&mut self, averaged: &mut Averaged, start: Start) -> Option<Found> {
        // stations and the eigenvalue are those of the gaps
        let in_gaps = self.settings.stations > 0 || self.settings.eigenvalue;
        let nearby =
            if matches!(start, Start::Last { changed: false }) { self.near_measured(averaged) } else { None };
        if let Some((end, error_estimate)) = nearby
            && !in_gaps
            && error_estimate <= self.settings.tolerance * self.chain.length
        {
            return self.judge_averaged(averaged, end, error_estimate);
        }
        if nearby.is_none() {
            averaged.measured = None;
            averaged.chain.rebuild_averaged(self.robot);
            let mut search = self.averaged_search(&mut averaged.energy, &averaged.chain);
            let found = search.start_at_once();
            self.iterations = search.iterations;
            found.then_some(())?;
        }
        let before = averaged.measured.take();
        let mut search = self.averaged_search(&mut averaged.energy, &averaged.chain);
        let measured = self.measure(&mut search, &mut averaged.gaps, before);
        self.iterations = search.iterations;
        let (mut end, now) = measured?;
        let error_estimate = now.error_estimate;
        averaged.measured = Some(now);
        // factors of other loads tell nothing of the stability under these
        if nearby.is_none_or(|(end, _)| end.moved.is_finite()) {
            end.moved = averaged.energy.memory.sweep.moved;
        }
        if in_gaps {
            self.energy.place_gaps(self.robot, self.chain, &mut averaged.gaps, &averaged.energy);
            self.energy.coarse.find_middles(&self.energy.memory.sweep, &self.energy.tables);
            if self.settings.stability {
                end.moved = f64::INFINITY; // that of the gaps themselves
            }
            return self.judge(end, error_estimate, None).ok();
        }
        self.judge_averaged(averaged, end, error_estimate)
    }

    /// A search for the averaged robot, which goes on counting.
    fn averaged_search<'b>(&self, energy: &'b mut Energy, chain: &'b Chain) -> Search<'b>
    where
        Self: 'b,
    {
        let Search { robot, settings, iterations, .. } = *self;
        Search { iterations, ..Search::new(energy, robot, chain, settings) }
    }

    /// The averaged robot from where it was measured last, and the estimated error; None where that is too far away.
    fn near_measured(&mut self, averaged: &mut Averaged) -> Option<(Converged, f64)> {
        let Averaged { chain, energy, measured, .. } = averaged;
        let measured = measured.as_ref().filter(|_| energy.memory.drive.is_of(self.robot))?;
        let mut search = self.averaged_search(energy, chain);
        let end = search.averaged_nearby();
        self.iterations = search.iterations;
        let way = measured.way(&energy.coarse, &energy.memory.drive.tensions);
        let grown = OF_DRIFT * measured.drift * way;
        let end = end.filter(|_| way <= FARTHEST * measured.bend)?;
        Some((end, measured.error_estimate + grown + end.residual * self.chain.length))
    }

    fn judge_averaged(&self, averaged: &mut Averaged, end: Converged, error_estimate: f64) -> Option<Found> {
        averaged.holds_solution = true;
        let mut search = self.averaged_search(&mut averaged.energy, &averaged.chain);
        search.judge(end, error_estimate, None).ok()
    }

    /// Measures what averaging leaves out until neither shape answers any more: from what is known `before`, where that was measured at a
    /// shape nearby.
    fn measure(
        &mut self,
        averaged: &mut Search,
        gaps: &mut Gaps,
        mut before: Option<Measured>,
    ) -> Option<(Converged, Measured)> {
        let (length, asked) = (self.chain.length, self.settings.tolerance * self.chain.length);
        let softening = self.softening(averaged.compression());
        if softening > MOST_SOFTENED {
            return None;
        }
        let points = points_for(softening);
        if before.is_none() || self.energy.layouts[0].points < points {
            before = None;
            self.begin_gaps(averaged, gaps, points)?;
        }
        let held = !self.energy.memory.drive.held.is_empty();
        let mut now = before.clone().unwrap_or_default();
        let mut rounds = Rounds::new(held, softening, before.is_some());
        for _ in 0..MOST_ROUNDS {
            self.energy.place_gaps(self.robot, self.chain, gaps, averaged.energy);
            let of_points = self.energy.error_of_points(true) * length;
            if of_points > OF_POINTS * asked {
                let points = self.energy.layouts[0].points + 1;
                (before, now, rounds) = (None, Measured::default(), Rounds::new(held, softening, false));
                self.begin_gaps(averaged, gaps, points)?;
                continue;
            }
            let end = self.exchange(averaged, gaps, &mut now, &mut rounds)?;
            now.error_estimate = of_points + SAFETY * rounds.to_come + end.residual * length;
            if now.error_estimate <= asked {
                now.find_drift(before.as_ref(), held, rounds.left_out);
                now.more = self.bent_more(averaged, &now.averaged);
                return Some((end, now));
            }
        }
        None
    }

    /// The placed gaps give way and tell the averaged robot what it leaves out, which answers.
    fn exchange(
        &mut self,
        averaged: &mut Search,
        gaps: &mut Gaps,
        now: &mut Measured,
        rounds: &mut Rounds,
    ) -> Option<Converged> {
        self.energy.relax_gaps(gaps, &averaged.energy.coarse);
        let Energy { coarse, memory, .. } = &mut *averaged.energy;
        gaps.leave_out(coarse);
        let lengths = &self.energy.memory.drive;
        memory.drive.home.clone_from(&lengths.home);
        memory.drive.take_lengths(&lengths.lengths);
        now.averaged.clone_from(coarse);
        now.bend = coarse.bend(&memory.sweep);
        now.tensions.clone_from(&memory.drive.tensions);
        let end = averaged.newton_here(Begin::Placed).ok()?;
        let answered = &averaged.energy.coarse;
        let offset = self.energy.coarse.tip() - now.averaged.tip();
        let of_gaps = offset - std::mem::replace(&mut now.offset, offset);
        let together = answered.tip() - now.averaged.tip() + of_gaps;
        rounds.add(answered.farthest_from(&now.averaged) + of_gaps.norm(), together.norm());
        Some(end)
    }

    /// How much more the gaps bend than the averaged robot, panel by panel.
    fn bent_more(&mut self, averaged: &Search, panels: &Mesh) -> Vec<Largest> {
        self.energy.coarse.find_middles(&self.energy.memory.sweep, &self.energy.tables);
        let of = |energy: &Energy, chain| energy.largest(self.robot, chain, panels);
        let of_averaged = of(averaged.energy, averaged.chain);
        let most = of_averaged.iter().fold(Largest::default(), Largest::or);
        let pairs = of(self.energy, self.chain).into_iter().zip(of_averaged);
        pairs.map(|(gaps, of)| gaps.over(&of, &most)).collect()
    }

    /// Lays panels of so many points in the gaps, and lets these give way as far as they do without moving anything. None where they turn
    /// too far, or would have too many.
    fn begin_gaps(&mut self, averaged: &Search, gaps: &mut Gaps, points: usize) -> Option<()> {
        if points > MOST_POINTS {
            return None;
        }
        self.energy.layouts.clear();
        self.energy.layouts.resize(self.chain.spans.len(), Layout { parts: 1, points });
        self.lay();
        // of this mesh by itself nothing is known
        self.energy.seen = Seen { error_estimate: f64::INFINITY, ..Seen::default() };
        self.energy.coarse.bows = true;
        gaps.lay(&self.energy.coarse, &averaged.energy.coarse, &self.energy.tables);
        self.energy.place_gaps(self.robot, self.chain, gaps, averaged.energy);
        let turn = self.energy.coarse.largest_turn(&self.energy.tables);
        self.energy.relax_gaps(gaps, &averaged.energy.coarse);
        (turn <= MOST_TURNED).then_some(())
    }

    /// The averaged robot from its last solution, where the mesh of that will do.
    fn averaged_nearby(&mut self) -> Option<Converged> {
        let laid = self.energy.layouts.clone();
        self.first_layout();
        let asked = std::mem::replace(&mut self.energy.layouts, laid);
        let coarser = |(a, b): (&Layout, &Layout)| a.parts < b.parts || a.points < b.points;
        if self.energy.layouts.iter().zip(&asked).any(coarser) {
            return None;
        }
        let Energy { coarse, reached, .. } = &mut *self.energy;
        reached.rotations.clone_from(&coarse.rotations);
        let begin = self.begin_nearby(true);
        let before = self.iterations;
        let end = self.newton_here(begin).ok()?;
        self.judge_factors(&end, self.iterations - before);
        (!self.strayed(&end)).then_some(end)
    }
}

impl Mesh {
    fn tip(&self) -> Vector3<f64> {
        self.positions[self.panels.len()]
    }

    /// Largest distance between the cuts of two shapes.
    fn farthest_from(&self, other: &Mesh) -> f64 {
        let pairs = self.positions.iter().zip(&other.positions);
        pairs.map(|(a, b)| (a - b).norm()).fold(0.0, larger)
    }

    /// Chord of the largest turn between the cuts of two shapes.
    fn turned_from(&self, other: &Mesh) -> f64 {
        let turn = |(a, b): (&Matrix3<f64>, &Matrix3<f64>)| (a - b).norm_squared();
        (0.5 * self.rotations.iter().zip(&other.rotations).map(turn).fold(0.0, larger)).sqrt()
    }
}
