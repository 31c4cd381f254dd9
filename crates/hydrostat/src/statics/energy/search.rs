//! From the unloaded shape to the loaded one: at once or by load continuation, then finer meshes.

use super::bow::MOST_BOWED;
use super::mesh::Layout;
use super::newton::{Begin, Converged, Equations, Stuck};
use super::{Energy, Memory, friction, tendons};
use crate::numeric::anderson::Anderson;
use crate::numeric::larger;
use crate::solution::Station;
use crate::statics::Settings;
use crate::statics::chain::Chain;
use crate::{Error, Robot};

/// What the search found, beside the shape in `Energy::coarse`.
#[derive(Clone, Debug)]
pub(in crate::statics) struct Found {
    pub(in crate::statics) residual: f64,
    pub(in crate::statics) error_estimate: f64,
    /// Directions in which the energy falls; None where that was not judged.
    pub(in crate::statics) negative: Option<usize>,
    pub(in crate::statics) smallest_eigenvalue: Option<f64>,
    pub(in crate::statics) unstable_from: Option<f64>,
    pub(in crate::statics) snapped_from: Option<f64>,
    pub(in crate::statics) iterations: usize,
}

/// Largest turn that a panel is laid out for, and with which it is cut in two, rad.
const FIRST_TURN: f64 = 0.8;
const FIRST_TURN_AVERAGED: f64 = 1.2;
pub(super) const LARGEST_TURN: f64 = 1.3;
/// Points of the first mesh, one more for tolerances below the second number; two less where panels turn little.
const FIRST_POINTS: usize = 4;
pub(super) const FINE_TOLERANCE: f64 = 1e-7;
/// Factor on the error estimate, for what two or three solutions cannot tell.
pub(super) const SAFETY: f64 = 3.0;
const MOST_NODES: usize = 20_000;
/// A load step may turn no cross-section by more (radians), or by the second where Newton's corrections shrink at least by
/// the third at once.
const LARGEST_LOAD_TURN: f64 = 0.7;
const LARGEST_QUICK_TURN: f64 = 1.6;
const QUICK: f64 = 0.3;
/// Load steps are measured in parts of the load that they lead to. A first unstable shape is accepted only where they are this small.
const UNSTABLE_BELOW: f64 = 1.0 / 4096.0;
const SMALLEST_LOAD_STEP: f64 = 1.0 / 65_536.0;
const SMALLEST_LOAD: f64 = 1e-9;
/// A search gives up after so many nodes linearised.
const MOST_WORK: usize = 1_000_000;
/// By how much the loads grow where the robot snaps, and how often it may.
const SNAP: f64 = 1e-3;
const MOST_SNAPS: usize = 20;
/// How often the way is begun anew on the panels that its end needed.
const MOST_RESTARTS: usize = 3;
const MOST_BISECTIONS: usize = 6;
/// Turns of Newton's method and friction.
const MOST_TURNS: usize = 50;
/// Accuracy on the way to the full load: enough to start the next step.
pub(super) const ON_THE_WAY: f64 = 1e-5;

/// What the last refinement found: the highest coefficients, and the estimated error, m; both on the mesh before, too, where that is
/// fine enough for the next solution.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    pub(super) tail: f64,
    pub(super) error_estimate: f64,
    /// Force along the backbone there, of loads and tendons, as [`Search::compression`] tells.
    pub(super) compression: f64,
    pub(super) before: Option<Before>,
    /// Steps that the last solution nearby took for which factors were made.
    pub(super) steps_of_new_factors: usize,
    /// Whether the factors at hand are those of the solution, within what its own error makes of them.
    pub(super) factors_fit: bool,
}

/// The same on one mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Before {
    pub(super) tail: f64,
    pub(super) error_estimate: f64,
}

/// Where a search begins.
#[derive(Clone, Copy)]
pub(in crate::statics) enum Start<'a> {
    /// The unloaded shape.
    Rest,
    /// The last solution, where it fits; `changed` where more than the commands has changed since then.
    Last { changed: bool },
    /// A given shape, base to tip.
    Shape(&'a [Station]),
}

/// Finds an equilibrium: on the primary branch from the unloaded shape, on that of the start otherwise.
pub(in crate::statics) fn find(
    energy: &mut Energy,
    robot: &Robot,
    chain: &Chain,
    settings: &Settings,
    start: Start,
) -> Result<Found, Error> {
    Search::new(energy, robot, chain, settings).run(start)
}

pub(super) struct Search<'a> {
    pub(super) energy: &'a mut Energy,
    pub(super) robot: &'a Robot,
    pub(super) chain: &'a Chain,
    pub(super) settings: &'a Settings,
    pub(super) iterations: usize,
    /// How the last iteration ended.
    pub(super) last: Option<Converged>,
    /// Part of the loads at which the branch ended and the robot snapped.
    pub(super) snapped_from: Option<f64>,
    /// Whether panels were cut in two on the way.
    pub(super) relaid: bool,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        energy: &'a mut Energy,
        robot: &'a Robot,
        chain: &'a Chain,
        settings: &'a Settings,
    ) -> Self {
        Search {
            energy,
            robot,
            chain,
            settings,
            iterations: 0,
            last: None,
            snapped_from: None,
            relaid: false,
        }
    }

    fn run(&mut self, start: Start) -> Result<Found, Error> {
        self.refuse_too_much()?;
        let tolerance = self.settings.tolerance;
        if let Some(found) = self.by_averaging(start) {
            return Ok(found);
        }
        let mut unstable_from = None;
        match start {
            Start::Shape(shape) => {
                self.start_from(shape)?;
                self.newton(1.0, tolerance).map_err(|stuck| self.not_converged(1.0, &stuck))?;
            }
            Start::Last { changed } => match self.continue_last(changed) {
                Some((end, estimate)) if estimate <= tolerance * self.chain.length => {
                    return self.judge(end, estimate, None);
                }
                // a finer mesh than the last one is needed, or with friction perhaps a coarser one will do
                Some(_) if !self.rubs() || self.begin_anew_here().is_some() => {}
                _ => unstable_from = self.start_from_rest()?,
            },
            Start::Rest => unstable_from = self.start_from_rest()?,
        }
        if let Some((end, error_estimate)) = self.let_bow()
            && error_estimate <= tolerance * self.chain.length
        {
            let tail = self.energy.coarse.tail(&self.energy.tables);
            let compression = self.compression();
            self.energy.seen = Seen { tail, error_estimate, compression, ..Seen::default() };
            return self.judge(end, error_estimate, unstable_from);
        }
        let mut last_difference: Option<f64> = None;
        let mut restarts = 0;
        loop {
            let tail = self.energy.coarse.tail(&self.energy.tables);
            let added = self.refine();
            let end = match self.newton(1.0, 0.1 * tolerance) {
                Ok(end) => end,
                Err(_) if restarts < MOST_RESTARTS && !matches!(start, Start::Shape(_)) => {
                    // the panels were too long to believe where they led
                    restarts += 1;
                    (self.snapped_from, self.relaid) = (None, false);
                    let points = self.first_points();
                    self.energy.layouts.iter_mut().for_each(|layout| {
                        *layout = Layout { parts: 2 * layout.parts, points };
                    });
                    self.lay();
                    unstable_from = self.follow_load()?;
                    last_difference = None;
                    continue;
                }
                Err(stuck) => return Err(self.not_converged(1.0, &stuck)),
            };
            let difference = self.difference();
            let finer = self.energy.coarse.tail(&self.energy.tables);
            let reduction =
                self.reduction(added, (tail, finer), last_difference.map(|last| last / difference));
            last_difference = added.then_some(difference);
            let nodes = self.energy.coarse.data.len();
            let rounding =
                (end.residual.min(1e-3 * tolerance) + f64::EPSILON * nodes as f64) * self.chain.length;
            let straight = !self.energy.coarse.chords.is_empty();
            let lost = if straight { self.energy.lost_by_points() * self.chain.length } else { 0.0 };
            let error_estimate = SAFETY * difference / (reduction - 1.0) + lost + rounding;
            if error_estimate <= tolerance * self.chain.length && self.sees_softening() {
                let before = SAFETY * difference + rounding;
                self.energy.seen = Seen {
                    tail: finer,
                    error_estimate,
                    compression: self.compression(),
                    before: added.then_some(Before { tail, error_estimate: before }),
                    ..Seen::default()
                };
                return self.judge(end, error_estimate, unstable_from);
            }
            if nodes > MOST_NODES || !error_estimate.is_finite() {
                let asked = tolerance * self.chain.length;
                return Err(Error::new(format!(
                    "the shape is known to {error_estimate:.1e} m only, on {nodes} nodes, not to {asked:.1e} m"
                ))
                .hint("ask for a larger tolerance"));
            }
        }
    }

    fn start_from_rest(&mut self) -> Result<Option<f64>, Error> {
        if self.settings.largest_load_step == 1.0 && self.start_at_once() {
            return Ok(None);
        }
        self.first_layout();
        self.lay();
        self.follow_load()
    }

    /// The equilibrium near a given shape: by Newton's method, or downhill from it.
    fn start_from(&mut self, shape: &[Station]) -> Result<(), Error> {
        self.first_layout();
        self.lay();
        for _ in 0..MOST_BISECTIONS {
            let Energy { tables, coarse, .. } = &mut *self.energy;
            coarse.take_shape(tables, shape);
            if coarse.largest_turn(tables) <= LARGEST_TURN {
                break;
            }
            for layout in &mut self.energy.layouts {
                layout.parts *= 2;
            }
            self.lay();
        }
        let given = self.energy.coarse.clone();
        if self.newton(1.0, ON_THE_WAY).is_ok() {
            return Ok(());
        }
        self.energy.coarse = given;
        self.energy.memory.drive.tensions.fill(0.0);
        self.snap(1.0, &mut 0).map_err(|stuck| {
            Error::new(format!(
                "no equilibrium found from the given shape: {} iterations, last correction {:.1e}",
                self.iterations, stuck.correction
            ))
            .hint("start from a shape of the same robot, or from the unloaded one")
        })
    }

    fn first_points(&self) -> usize {
        FIRST_POINTS + usize::from(self.settings.tolerance < FINE_TOLERANCE)
    }

    /// Panels for the first mesh.
    pub(super) fn first_layout(&mut self) {
        self.energy.layouts.clear();
        let first_points = self.first_points();
        // between guides bows stand for further points
        let bows = self.settings.tolerance >= FINE_TOLERANCE && self.bows_alone();
        let little = if bows { MOST_BOWED } else { 0.1 * FIRST_TURN };
        // of averaged gaps the gaps tell what a panel leaves out
        let first_turn = if self.chain.is_averaged() { FIRST_TURN_AVERAGED } else { FIRST_TURN };
        for span in &self.chain.spans {
            let turn = span.largest_angle(self.robot) * (span.to - span.from);
            let parts = (turn / first_turn - 1e-9).ceil().clamp(1.0, 1e4) as usize;
            let points = if turn < little { first_points - 2 } else { first_points };
            self.energy.layouts.push(Layout { parts, points });
        }
    }

    /// The coarse mesh at rest, and the tendons with it.
    pub(super) fn lay(&mut self) {
        let Energy { tables, layouts, coarse, reached_drive, memory, .. } = &mut *self.energy;
        // those of another robot
        reached_drive.tensions.clear();
        coarse.rebuild(self.robot, self.chain, layouts, tables);
        memory.drive.rest(self.robot);
        tendons::at_rest(coarse, &mut memory.drive.home, self.robot.tendons.len());
    }

    /// Newton's method on the coarse mesh; with friction in turns with the tensions along the tendons, accelerated by what the tangent is
    /// seen to be.
    pub(super) fn newton(&mut self, factor: f64, target: f64) -> Result<Converged, Stuck> {
        let rubs = self.rubs();
        let (mut anderson, mut last, mut contraction) = (Anderson::default(), f64::INFINITY, None);
        for turn in 0..MOST_TURNS {
            let Energy { tables, coarse, memory, .. } = &mut *self.energy;
            let equations = Equations { robot: self.robot, chain: self.chain, tables, factor };
            let begin = if turn > 0 { Begin::WithFactors } else { Begin::Anew };
            let mut converged = equations.newton(memory, coarse, target, begin, &mut self.iterations)?;
            self.last = Some(converged);
            if !rubs {
                return Ok(converged);
            }
            // how surely the branch was kept is told by the first turn
            converged.contraction = *contraction.get_or_insert(converged.contraction);
            let Memory { sweep, drive, .. } = memory;
            let (means, ends) = (&mut drive.mean_shares, &mut drive.end_shares);
            let mut before = coarse.shares();
            if means.is_empty() {
                means.resize(self.robot.tendons.len(), 1.0);
            }
            before.extend_from_slice(means);
            let change = friction::update(self.robot, coarse, sweep, tables, means, ends);
            if change <= target {
                return Ok(converged);
            }
            if change > last {
                anderson.restart();
            }
            let mut after = coarse.shares();
            let count = after.len();
            after.extend_from_slice(means);
            let next = anderson.next(&before, &after);
            coarse.set_shares(&next[..count]);
            means.copy_from_slice(&next[count..]);
            last = change;
        }
        Err(Stuck { correction: last })
    }

    pub(super) fn rubs(&self) -> bool {
        self.robot.tendons.iter().any(|tendon| tendon.friction > 0.0)
    }

    /// Follows the primary branch as the loads grow from 0 to 1. Returns the part at which it first turned unstable.
    fn follow_load(&mut self) -> Result<Option<f64>, Error> {
        let largest_step = self.settings.largest_load_step;
        let (mut reached, mut step) = (0.0_f64, largest_step);
        let mut unstable_from = None;
        self.mark();
        let (mut snaps, mut restarts) = (0, 0);
        let mut begun = self.iterations;
        while reached < 1.0 {
            let factor = (reached + step).min(1.0);
            let part = (factor - reached) / factor;
            let target = if factor < 1.0 { ON_THE_WAY } else { ON_THE_WAY.min(self.settings.tolerance) };
            let outcome = self.newton(factor, target);
            let work = (self.iterations - begun) * self.energy.coarse.data.len();
            let strayed = matches!(&outcome, Ok(end) if self.strayed(end));
            let unstable = matches!(outcome, Ok(end) if end.negative > 0) && unstable_from.is_none();
            if outcome.is_ok() && !strayed && (!unstable || part < UNSTABLE_BELOW) {
                reached = factor;
                unstable_from = unstable_from.or(unstable.then_some(factor));
                step = (2.0 * step).min(largest_step);
                if self.energy.coarse.largest_turn(&self.energy.tables) > LARGEST_TURN {
                    self.bisect();
                }
                self.mark();
            } else {
                self.energy.coarse.clone_from(&self.energy.reached);
                self.energy.memory.drive.clone_from(&self.energy.reached_drive);
                step *= 0.5;
                if work > MOST_WORK {
                    return Err(self.not_converged(reached, &outcome.err().unwrap_or_default()));
                }
                let ends = step < SMALLEST_LOAD_STEP * factor.max(SMALLEST_LOAD);
                if ends && self.relaid && restarts < MOST_RESTARTS {
                    // the panels were too long to believe where they led
                    (restarts, snaps, self.relaid, self.snapped_from) = (restarts + 1, 0, false, None);
                    (reached, step, unstable_from, begun) = (0.0, largest_step, None, self.iterations);
                    self.lay();
                    self.mark();
                } else if ends {
                    // the branch ends here: the robot snaps to a minimum of its energy
                    let beyond = (reached * (1.0 + SNAP)).clamp(SMALLEST_LOAD, 1.0);
                    let way = self.snap(beyond, &mut snaps);
                    way.map_err(|stuck| self.not_converged(reached, &outcome.err().unwrap_or(stuck)))?;
                    self.snapped_from = self.snapped_from.or(Some(reached));
                    (reached, step) = (beyond, largest_step);
                    self.mark();
                }
            }
        }
        Ok(unstable_from)
    }

    /// Remembers the shape and the tensions to go back to.
    fn mark(&mut self) {
        self.energy.reached.clone_from(&self.energy.coarse);
        self.energy.reached_drive.clone_from(&self.energy.memory.drive);
    }

    /// Minimises the energy at a part of the loads, from the shape of the coarse mesh.
    fn snap(&mut self, factor: f64, snaps: &mut usize) -> Result<(), Stuck> {
        *snaps += 1;
        if *snaps > MOST_SNAPS || !self.chain.conservative {
            return Err(Stuck::default());
        }
        for _ in 0..MOST_BISECTIONS {
            let Energy { tables, coarse, memory, .. } = &mut *self.energy;
            let equations = Equations { robot: self.robot, chain: self.chain, tables, factor };
            let outcome = equations.minimise(memory, coarse, &mut self.iterations);
            memory.drive.springs.give.clear();
            outcome?;
            if self.energy.coarse.largest_turn(&self.energy.tables) <= LARGEST_TURN {
                break;
            }
            self.bisect();
        }
        self.newton(factor, ON_THE_WAY).map(|_| ())
    }

    /// Whether a step has turned further than one that surely stays on its branch.
    pub(super) fn strayed(&self, end: &Converged) -> bool {
        let quick = end.contraction <= QUICK;
        self.turned() > if quick { LARGEST_QUICK_TURN } else { LARGEST_LOAD_TURN }
    }

    /// Largest angle between a cut and what it was at the last load step.
    fn turned(&self) -> f64 {
        let pairs = self.energy.coarse.rotations.iter().zip(&self.energy.reached.rotations);
        pairs.map(|(a, b)| ((a.dot(b) - 1.0) / 2.0).clamp(-1.0, 1.0).acos()).fold(0.0, larger)
    }
}
