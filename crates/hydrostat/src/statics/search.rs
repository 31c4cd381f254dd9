//! From the unloaded shape to the loaded one: load continuation, Newton's method, finer meshes.

use super::Settings;
use super::chain::Chain;
use super::rod::Node;
use super::shooting::{Mesh, Sweep};
use crate::numeric::{dop853, larger};
use crate::{Error, Robot};

/// The search for one equilibrium.
pub(super) struct Search<'a> {
    pub(super) robot: &'a Robot,
    pub(super) settings: &'a Settings,
    pub(super) chain: &'a Chain,
    /// At the base, per tendon.
    pub(super) tensions: &'a [f64],
    pub(super) steps_per_span: &'a mut Vec<usize>,
    pub(super) coarse: &'a mut Mesh,
    pub(super) fine: &'a mut Mesh,
    /// The coarse mesh's nodes at the last load step.
    pub(super) reached: &'a mut Vec<Node>,
    /// By how much halving the steps reduces the error; 2^8 in the limit.
    pub(super) order_factor: &'a mut f64,
    pub(super) iterations: usize,
    /// Steps linearised so far, and at most.
    pub(super) work: &'a mut usize,
    pub(super) most_work: usize,
}

/// What the search found, beside the nodes of the fine mesh.
pub(super) struct Found {
    pub(super) residual: f64,
    pub(super) error_estimate: f64,
    pub(super) conjugate_points: usize,
    /// Smallest determinant of the Riccati sweep: 1 without load, 0 at a critical load.
    pub(super) smallest_pivot: f64,
    /// Load factor at which the branch first lost its stability.
    pub(super) unstable_from: Option<f64>,
    pub(super) iterations: usize,
}

/// Largest angle of a step of the first mesh: of the rest shape, and of the load as sqrt(n / EI) h, which
/// keeps conjugate points (pi apart) on different steps.
const FIRST_ANGLE: f64 = 2.0;
/// .. and the tolerance that it suits; a smaller one begins with smaller steps.
const FIRST_TOLERANCE: f64 = 1e-6;
/// Factor on the error estimate, for what two or three solutions cannot tell. With it the error is below 0.55 of the
/// estimate for 99 random rods of 100, and none of 10,000 exceeds the tolerance.
const SAFETY: f64 = 3.0;
/// What is assumed of the reduction by halving before it has been seen.
const UNSEEN_ORDER_FACTOR: f64 = 128.0;
/// A search that has linearised so many steps (about a second's work) is given up.
pub(super) const MOST_WORK: usize = 1_000_000;
const MAX_STEPS: usize = 20_000;
/// Newton's corrections must shrink at least by this factor, or the start is too far for the same branch.
const CONTRACTION: f64 = 0.5;
const MAX_ITERATIONS: usize = 50;
// Load steps are measured in parts of the load that they lead to: a soft rod does all its turning at a small load.
/// Newton's corrections are damped only where the load steps have become this small.
const DAMPED_BELOW: f64 = 1.0 / 64.0;
/// A first unstable shape is accepted only where the load steps have become this small.
const UNSTABLE_BELOW: f64 = 1.0 / 4096.0;
const SMALLEST_LOAD_STEP: f64 = 1.0 / 65_536.0;
/// The first step may be as small as this times that, in parts of the whole load.
const SMALLEST_LOAD: f64 = 1e-9;
/// A load step may turn no cross-section by more (radians).
const LARGEST_LOAD_TURN: f64 = 0.7;
/// A mesh is halved where load steps become this small (so many times at most), and where a step turns by more (radians).
const REFINED_BELOW: f64 = 1.0 / 8.0;
const MOST_REFINEMENTS: usize = 5;
const LARGEST_TURN: f64 = 1.5;
/// Accuracy on the way to the full load: enough to start the next step.
const ON_THE_WAY: f64 = 1e-7;

impl Search<'_> {
    pub(super) fn run<const N: usize>(&mut self, warm: bool, sweep: &mut Sweep<N>) -> Result<Found, Error> {
        let tolerance = self.settings.tolerance;
        let intervals = self.settings.shooting_intervals.unwrap_or(usize::MAX);
        if !warm {
            self.first_mesh();
            *self.order_factor = UNSEEN_ORDER_FACTOR;
        }
        self.coarse.rebuild(self.robot, self.chain, self.tensions, self.steps_per_span, intervals);
        let mut unstable_from = None;
        let arrived = warm && self.newton(Level::Coarse, sweep, 1.0, self.coarse_target(), false).is_ok();
        if !arrived {
            unstable_from = self.follow_load(sweep)?;
        }
        let mut last_difference: Option<f64> = None;
        loop {
            self.halve_into_fine(1.0);
            let end = self
                .newton(Level::Fine, sweep, 1.0, 0.1 * tolerance, true)
                .map_err(|stuck| self.not_converged(1.0, &stuck))?;
            // Richardson, theory (17): the finer of two solutions of order p is off by 1 / (2^p - 1) of their difference
            let difference = (self.fine.positions.iter().step_by(2))
                .zip(&self.coarse.positions)
                .map(|(fine, coarse)| (fine - coarse).norm())
                .fold(0.0, larger);
            // .. and what p is, three solutions show
            *self.order_factor = match last_difference {
                Some(last) => (last / difference).clamp(2.0, 2_f64.powi(dop853::ORDER)),
                None => *self.order_factor,
            };
            last_difference = Some(difference);
            let rounding = (end.residual + f64::EPSILON * self.fine.steps.len() as f64) * self.chain.length;
            let error_estimate = SAFETY * difference / (*self.order_factor - 1.0) + rounding;
            if error_estimate <= tolerance * self.chain.length {
                self.steps_per_span.iter_mut().for_each(|count| *count /= 2);
                self.fine.own_states(1.0);
                return Ok(Found {
                    residual: end.residual,
                    error_estimate,
                    conjugate_points: end.conjugate_points,
                    smallest_pivot: end.smallest_pivot,
                    unstable_from,
                    iterations: self.iterations,
                });
            }
            if self.fine.steps.len() > MAX_STEPS || rounding > tolerance * self.chain.length {
                return Err(Error::new(format!(
                    "the shape is known to {error_estimate:.1e} m only, on {} steps, not to {:.1e} m",
                    self.fine.steps.len(),
                    tolerance * self.chain.length
                ))
                .hint(self.remedy("ask for a larger tolerance")));
            }
            std::mem::swap(self.coarse, self.fine);
        }
    }

    /// The coarse solution serves the error estimate, where its own error is divided by 2^p - 1.
    fn coarse_target(&self) -> f64 {
        (10.0 * self.settings.tolerance).min(1e-3)
    }

    /// Steps per span for the first mesh.
    fn first_mesh(&mut self) {
        self.steps_per_span.clear();
        let longest = FIRST_ANGLE
            * (self.settings.tolerance / FIRST_TOLERANCE).powf(1.0 / f64::from(dop853::ORDER)).min(1.0);
        for span in &self.chain.spans {
            let angle = span.largest_angle(self.robot) * (span.to - span.from);
            self.steps_per_span.push((angle / longest - 1e-9).ceil().clamp(1.0, 1e4) as usize);
        }
    }

    /// Follows the equilibrium on the coarse mesh while all loads grow from zero together, in steps small enough
    /// that Newton's method contracts from the start and the shape turns little. Returns the load factor at which
    /// the branch loses its stability.
    fn follow_load<const N: usize>(&mut self, sweep: &mut Sweep<N>) -> Result<Option<f64>, Error> {
        self.coarse.rest();
        let largest_step = self.settings.largest_load_step;
        let (mut reached, mut step) = (0.0, largest_step);
        let mut unstable_from = None;
        let (mut may_refine, mut refinements) = (true, 0);
        self.reached.clone_from(&self.coarse.nodes);
        while reached < 1.0 {
            let factor = (reached + step).min(1.0);
            let target = if factor < 1.0 { ON_THE_WAY } else { self.coarse_target() };
            let part = step / factor;
            let outcome = self.newton(Level::Coarse, sweep, factor, target, part < DAMPED_BELOW);
            // the load at which a branch turns unstable is met in small steps
            let unstable =
                outcome.as_ref().is_ok_and(|end| end.conjugate_points > 0) && unstable_from.is_none();
            let strayed = self.coarse.turned_since(self.reached) > LARGEST_LOAD_TURN;
            if outcome.is_ok() && !strayed && (!unstable || part < UNSTABLE_BELOW) {
                reached = factor;
                unstable_from = unstable_from.or(unstable.then_some(factor));
                may_refine = true;
                step = (2.0 * step).min(largest_step);
                if self.coarse.largest_turn() > LARGEST_TURN {
                    self.refine(reached);
                }
            } else {
                self.coarse.nodes.clone_from(self.reached);
                step *= 0.5;
                if 0.5 * part < REFINED_BELOW && may_refine && refinements < MOST_REFINEMENTS {
                    // the mesh may be what keeps Newton's method from contracting
                    may_refine = false;
                    refinements += 1;
                    self.refine(reached);
                    step *= 4.0;
                }
                if step < SMALLEST_LOAD_STEP * factor.max(SMALLEST_LOAD) || *self.work > self.most_work {
                    return Err(self.not_converged(reached, &outcome.err().unwrap_or_default()));
                }
            }
            self.reached.clone_from(&self.coarse.nodes);
        }
        Ok(unstable_from)
    }

    /// Halves the steps of the coarse mesh.
    fn refine(&mut self, factor: f64) {
        if self.coarse.steps.len() < MAX_STEPS {
            self.halve_into_fine(factor);
            std::mem::swap(self.coarse, self.fine);
        }
    }

    /// Makes the fine mesh, with every step of the coarse one halved, and starts it from the coarse solution.
    fn halve_into_fine(&mut self, factor: f64) {
        let intervals = self.settings.shooting_intervals.unwrap_or(usize::MAX);
        self.steps_per_span.iter_mut().for_each(|count| *count *= 2);
        self.fine.rebuild(self.robot, self.chain, self.tensions, self.steps_per_span, intervals);
        self.fine.prolong(self.coarse, factor, 2);
    }

    /// Newton's method on one mesh until the error it leaves is below `target` (radians and like units).
    fn newton<const N: usize>(
        &mut self,
        level: Level,
        sweep: &mut Sweep<N>,
        factor: f64,
        target: f64,
        may_damp: bool,
    ) -> Result<Converged, Stuck> {
        let chain = self.chain;
        let mesh = match level {
            Level::Coarse => &mut *self.coarse,
            Level::Fine => &mut *self.fine,
        };
        let mut last = f64::INFINITY;
        let mut scale = 1.0;
        for _ in 0..MAX_ITERATIONS {
            let now = mesh.linearise(chain, factor, 1.0, sweep);
            self.iterations += 1;
            *self.work += mesh.steps.len();
            if *self.work > self.most_work {
                return Err(Stuck { correction: now.correction });
            }
            let contraction = now.correction / last;
            // corrections that have come down to rounding shrink no more; the residual says what that leaves
            let rounding = now.correction <= ROUNDING_CORRECTION && contraction > CONTRACTION;
            let shrinks = contraction <= if scale < 1.0 { 1.0 - 0.25 * scale } else { CONTRACTION };
            if !(shrinks || rounding || last == f64::INFINITY && now.correction.is_finite()) {
                scale *= 0.5;
                if !may_damp || scale < 1e-3 || last == f64::INFINITY {
                    return Err(Stuck { correction: now.correction });
                }
                mesh.damp(scale);
                continue;
            }
            mesh.correct();
            // what the next correction will be, from the contraction so far
            let ahead =
                now.correction * contraction.min(QUADRATIC * now.correction).max(1e-3 * now.correction);
            if scale == 1.0 && (ahead <= target || rounding) {
                let residual = mesh.residual(chain, factor);
                if residual <= target.max(ROUNDING) || rounding && residual <= ROUNDING_CORRECTION {
                    // the linearisation was at the shape before the correction: a doubt is settled at the last
                    let conjugate_points = match now.conjugate_points {
                        0 => 0,
                        _ => mesh.linearise(chain, factor, 1.0, sweep).conjugate_points,
                    };
                    return Ok(Converged { residual, conjugate_points, smallest_pivot: now.smallest_pivot });
                }
            }
            last = now.correction;
            scale = (2.0 * scale).min(1.0);
        }
        Err(Stuck { correction: last })
    }

    fn not_converged(&self, reached: f64, stuck: &Stuck) -> Error {
        Error::new(format!(
            "no equilibrium found beyond {:.3} % of the loads: {} Newton iterations, on {} steps in the end, \
             last correction {:.1e}",
            100.0 * reached,
            self.iterations,
            self.coarse.steps.len(),
            stuck.correction
        ))
        .hint(self.remedy(if *self.work > self.most_work && self.most_work < MOST_WORK {
            "shooting was given up for the work it takes with these tendons: use the energy method, which is the default"
        } else if *self.work > self.most_work {
            "the search was given up after a million steps: the rod is very soft for its loads; check their units"
        } else {
            "the rod probably snaps or buckles there: lower the loads, or stiffen or shorten the rod"
        }))
    }

    /// Few shooting intervals are the likelier cause of a failure than anything else.
    fn remedy(&self, otherwise: &'static str) -> &'static str {
        match self.settings.shooting_intervals {
            Some(intervals) if intervals < self.coarse.steps.len() => {
                "so few shooting intervals may be ill-conditioned here: leave their number to the solver"
            }
            _ => otherwise,
        }
    }
}

/// Of two iterations, how much faster than linear: correction_(k+1) < QUADRATIC correction_k^2.
const QUADRATIC: f64 = 10.0;
/// Smallest residual that rounding allows, and size of the corrections that it may cause in few, long intervals.
const ROUNDING: f64 = 1e-12;
const ROUNDING_CORRECTION: f64 = 1e-10;

/// Which of the two meshes.
#[derive(Clone, Copy)]
enum Level {
    Coarse,
    Fine,
}

struct Converged {
    residual: f64,
    conjugate_points: usize,
    smallest_pivot: f64,
}

#[derive(Default)]
struct Stuck {
    correction: f64,
}
