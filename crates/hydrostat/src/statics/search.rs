//! From the unloaded shape to the loaded one: load continuation, Newton's method, finer meshes.

use super::Settings;
use super::chain::Chain;
use super::shooting::{Mesh, Sweep};
use crate::numeric::butcher6;
use crate::{Error, Robot};

/// The search for one equilibrium.
pub(super) struct Search<'a> {
    pub(super) robot: &'a Robot,
    pub(super) settings: &'a Settings,
    pub(super) chain: &'a Chain,
    pub(super) steps_per_span: &'a mut Vec<usize>,
    pub(super) coarse: &'a mut Mesh,
    pub(super) fine: &'a mut Mesh,
    pub(super) iterations: usize,
}

/// What the search found, beside the nodes of the fine mesh.
pub(super) struct Found {
    pub(super) residual: f64,
    pub(super) error_estimate: f64,
    pub(super) conjugate_points: usize,
    /// Load factor at which the branch first lost its stability.
    pub(super) unstable_from: Option<f64>,
    pub(super) iterations: usize,
}

/// Length of a step of the first mesh, as a fraction of the backbone and as a rest angle.
const FIRST_STEP: f64 = 0.5;
const FIRST_ANGLE: f64 = 0.7;
/// The error estimate assumes the asymptotic order; this factor covers where it is not reached yet.
const SAFETY: f64 = 4.0;
const MAX_STEPS: usize = 20_000;
/// Newton's corrections must shrink at least by this factor, or the start is too far for the same branch.
const CONTRACTION: f64 = 0.5;
const MAX_ITERATIONS: usize = 50;
/// Newton's corrections are damped only where the load steps have become this small.
const DAMPED_BELOW: f64 = 1.0 / 64.0;
const SMALLEST_LOAD_STEP: f64 = 1.0 / 4096.0;
/// Accuracy on the way to the full load: enough to start the next step.
const ON_THE_WAY: f64 = 1e-3;

impl Search<'_> {
    pub(super) fn run<const N: usize>(&mut self, warm: bool, sweep: &mut Sweep<N>) -> Result<Found, Error> {
        let tolerance = self.settings.tolerance;
        let intervals = self.settings.shooting_intervals.unwrap_or(usize::MAX);
        if !warm {
            self.first_mesh();
        }
        self.coarse
            .rebuild(self.robot, self.chain, self.steps_per_span, intervals);
        let mut unstable_from = None;
        let arrived = warm && self.newton(Level::Coarse, sweep, 1.0, tolerance, false).is_ok();
        if !arrived {
            unstable_from = self.follow_load(sweep)?;
        }
        self.coarse.residual(self.chain, 1.0);
        loop {
            self.steps_per_span.iter_mut().for_each(|count| *count *= 2);
            self.fine
                .rebuild(self.robot, self.chain, self.steps_per_span, intervals);
            self.fine.prolong(self.coarse, 1.0);
            let end = self
                .newton(Level::Fine, sweep, 1.0, 0.01 * tolerance, true)
                .map_err(|stuck| self.not_converged(1.0, &stuck))?;
            // Richardson: the finer of two solutions of order p is off by 1 / (2^p - 1) of their difference
            let difference = (self.fine.positions.iter().step_by(2))
                .zip(&self.coarse.positions)
                .map(|(fine, coarse)| (fine - coarse).norm())
                .fold(0.0, f64::max);
            let error_estimate = SAFETY * difference / (2_f64.powi(butcher6::ORDER) - 1.0);
            if error_estimate <= tolerance * self.chain.length {
                self.steps_per_span.iter_mut().for_each(|count| *count /= 2);
                return Ok(Found {
                    residual: end.residual,
                    error_estimate,
                    conjugate_points: end.conjugate_points,
                    unstable_from,
                    iterations: self.iterations,
                });
            }
            if self.fine.steps.len() > MAX_STEPS {
                return Err(Error::new(format!(
                    "the shape is known to {error_estimate:.1e} m only, on {} steps, not to {:.1e} m",
                    self.fine.steps.len(),
                    tolerance * self.chain.length
                ))
                .hint("ask for a larger tolerance"));
            }
            std::mem::swap(self.coarse, self.fine);
        }
    }

    /// Steps per span for the first mesh.
    fn first_mesh(&mut self) {
        self.steps_per_span.clear();
        for span in &self.chain.spans {
            let length = span.to - span.from;
            let angle = length * self.robot.sections[span.section].rest_curvature.norm();
            let steps = (length / (FIRST_STEP * self.chain.length)).max(angle / FIRST_ANGLE);
            self.steps_per_span
                .push((steps - 1e-9).ceil().clamp(1.0, 1e4) as usize);
        }
    }

    /// Follows the equilibrium on the coarse mesh while all loads grow from zero together.
    fn follow_load<const N: usize>(&mut self, sweep: &mut Sweep<N>) -> Result<Option<f64>, Error> {
        self.coarse.rest();
        let (mut reached, mut step) = (0.0, 1.0_f64);
        let mut unstable_from = None;
        let mut nodes = self.coarse.nodes.clone();
        while reached < 1.0 {
            let factor = (reached + step).min(1.0);
            let target = if factor < 1.0 {
                ON_THE_WAY
            } else {
                self.settings.tolerance
            };
            match self.newton(Level::Coarse, sweep, factor, target, step < DAMPED_BELOW) {
                // a branch that turns unstable is met in small steps, so that none is jumped to by accident
                Ok(end) if end.conjugate_points == 0 || unstable_from.is_some() || step < DAMPED_BELOW => {
                    if end.conjugate_points > 0 && unstable_from.is_none() {
                        unstable_from = Some(factor);
                    }
                    reached = factor;
                    nodes.clone_from(&self.coarse.nodes);
                    step *= 2.0;
                }
                outcome => {
                    self.coarse.nodes.clone_from(&nodes);
                    step *= 0.5;
                    if step < SMALLEST_LOAD_STEP {
                        let stuck = outcome.err().unwrap_or_default();
                        return Err(self.not_converged(reached, &stuck));
                    }
                }
            }
        }
        Ok(unstable_from)
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
            let contraction = now.correction / last;
            let shrinks = contraction
                <= if scale < 1.0 {
                    1.0 - 0.25 * scale
                } else {
                    CONTRACTION
                };
            if !(shrinks || last == f64::INFINITY && now.correction.is_finite()) {
                scale *= 0.5;
                if !may_damp || scale < 1e-3 || last == f64::INFINITY {
                    return Err(Stuck {
                        correction: now.correction,
                    });
                }
                mesh.damp(scale);
                continue;
            }
            mesh.correct();
            // what the next correction will be, from the contraction so far
            let ahead = now.correction
                * contraction
                    .min(QUADRATIC * now.correction)
                    .max(1e-3 * now.correction);
            if scale == 1.0 && ahead <= target {
                let residual = mesh.residual(chain, factor);
                if residual <= target.max(ROUNDING) {
                    return Ok(Converged {
                        residual,
                        conjugate_points: now.conjugate_points,
                    });
                }
            }
            last = now.correction;
            scale = (2.0 * scale).min(1.0);
        }
        Err(Stuck { correction: last })
    }

    fn not_converged(&self, reached: f64, stuck: &Stuck) -> Error {
        Error::new(format!(
            "no equilibrium found beyond {:.1} % of the loads: {} Newton iterations on {} shooting steps, \
             load steps down to 1/{:.0}, last correction {:.1e}",
            100.0 * reached,
            self.iterations,
            self.coarse.steps.len(),
            1.0 / SMALLEST_LOAD_STEP,
            stuck.correction
        ))
        .hint("the rod probably snaps or buckles there: lower the loads, or stiffen or shorten the rod")
    }
}

/// Of two iterations, how much faster than linear: correction_(k+1) < QUADRATIC correction_k^2.
const QUADRATIC: f64 = 10.0;
/// Smallest residual that rounding allows.
const ROUNDING: f64 = 1e-12;

/// Which of the two meshes.
#[derive(Clone, Copy)]
enum Level {
    Coarse,
    Fine,
}

struct Converged {
    residual: f64,
    conjugate_points: usize,
}

#[derive(Default)]
struct Stuck {
    correction: f64,
}
