//! What is said of a converged shape, and of one that was not found.

use super::newton::{Converged, Equations, Stuck};
use super::search::{Found, Search};
use super::{Energy, tendons};
use crate::Error;
use crate::model::{Command, Tendon};
use crate::statics::span::Span;
use crate::statics::stability;
use std::f64::consts::TAU;

/// Turns of the whole backbone, by a bound of its curvature, that no robot makes.
const MOST_TURNS: f64 = 100.0;
/// Of a shape this far from the one at which the Hessian was eliminated, under the same loads, stability is the same, rad.
const SAME_STABILITY: f64 = 1e-2;
/// This far away, rad, factors give derivatives that are as accurate as the shape, for finer tolerances than the second so much less.
const SAME_DERIVATIVES: f64 = 3e-6;
const OF_TOLERANCE: f64 = 1e-6;

impl Search<'_> {
    pub(super) fn judge(
        &mut self,
        end: Converged,
        error_estimate: f64,
        unstable_from: Option<f64>,
    ) -> Result<Found, Error> {
        if let Some(folded) = self.folded(1.0) {
            return Err(folded);
        }
        // bows change the shape without being counted
        let near = end.moved <= SAME_DERIVATIVES * (self.settings.tolerance / OF_TOLERANCE).min(1.0);
        self.energy.seen.factors_fit = near && !self.energy.coarse.bows;
        let Energy { tables, coarse, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        let residual = equations.residual(memory, coarse);
        let negative = if end.moved <= SAME_STABILITY && !self.settings.eigenvalue {
            Some(end.negative)
        } else if self.settings.eigenvalue {
            self.falling(0.0)
        } else if self.settings.stability {
            let problem = equations.problem(&memory.drive.tensions);
            if memory.sweep.surely_convex(&problem, coarse) { Some(0) } else { self.falling(0.0) }
        } else {
            None
        };
        // of loads that follow there is no energy whose eigenvalues would tell
        let judges = self.settings.eigenvalue && !self.chain.follower;
        let smallest_eigenvalue = judges.then(|| stability::smallest(|mu| self.falling(-mu) != Some(0)));
        Ok(Found {
            residual,
            error_estimate,
            negative,
            smallest_eigenvalue,
            unstable_from: unstable_from.or(negative.is_some_and(|count| count > 0).then_some(1.0)),
            snapped_from: self.snapped_from,
            iterations: self.iterations,
        })
    }

    /// Number of directions in which the energy with a stiffer elastic part falls while taut tendons keep their lengths; None where the
    /// elimination breaks down.
    fn falling(&mut self, shift: f64) -> Option<usize> {
        let Energy { tables, coarse, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        if memory.drive.held.is_empty() {
            return memory.sweep.factor(&equations.problem(&memory.drive.tensions), coarse, shift);
        }
        let taut = memory.drive.taut.clone();
        let negative = equations.linearise(memory, coarse, shift).negative;
        memory.drive.taut = taut;
        negative
    }

    /// Refuses what would wind the robot up, before it costs memory and time.
    pub(super) fn refuse_too_much(&self) -> Result<(), Error> {
        let pull = |(tendon, command): (&Tendon, &Command)| match command {
            Command::Tension { tension, .. } => {
                tension.abs() * tendon.path.radius.max(tendon.path.tip_radius)
            }
            Command::Displacement { .. } => 0.0,
        };
        let pull: f64 = self.robot.tendons.iter().zip(&self.robot.actuation).map(pull).sum();
        let bound = |span: &Span| (span.to - span.from) * span.bound_of_angle(self.robot, pull);
        let parallel = self.robot.tendons.iter().all(|tendon| tendon.path.turns == 0.0);
        if parallel && self.chain.spans.iter().map(bound).sum::<f64>() <= MOST_TURNS * TAU {
            return Ok(());
        }
        let turn = |span: &Span| {
            let (angle, at_rest) =
                (span.largest_angle(self.robot), self.robot.sections[span.section].rest_curvature);
            if angle == at_rest.norm() { 0.0 } else { angle * (span.to - span.from) }
        };
        let turns = self.chain.spans.iter().map(turn).sum::<f64>() / TAU;
        if turns <= MOST_TURNS {
            return Ok(());
        }
        let given = |(tendon, command): (&Tendon, &Command)| match command {
            Command::Tension { tension, .. } => Some((tendon.name.clone(), *tension)),
            Command::Displacement { .. } => None,
        };
        let tensions = self.robot.tendons.iter().zip(&self.robot.actuation).filter_map(given);
        let hint = match tensions.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((name, tension)) => format!(
                "check the units of loads, commands and stiffness: the largest tension is {tension} N, of tendon \"{name}\""
            ),
            None => "check the units of loads and stiffness".to_owned(),
        };
        Err(Error::new(format!("loads and commands would wind the robot up, by about {turns:.0} full turns"))
            .hint(hint))
    }

    /// Tendons that the robot has bent around so far that nothing is left of their way.
    fn folded(&self, reached: f64) -> Option<Error> {
        let (tendon, s) = tendons::folded(&self.energy.coarse, &self.energy.memory.sweep)?;
        let name = &self.robot.tendons[tendon].name;
        let message = format!(
            "the robot folds about tendon \"{name}\" near s = {s:.4} m at {:.3} % of the loads: the way from hole to hole \
             shrinks to nothing there",
            100.0 * reached
        );
        Some(Error::new(message).hint("pull less, set the guides closer, or stiffen the backbone"))
    }

    /// A tendon whose tension at the last shape found on the way is above its breaking load.
    fn torn(&self, reached: f64) -> Option<Error> {
        let tensions = self.energy.reached_drive.tensions.iter();
        let (tendon, tension, limit) =
            self.robot.tendons.iter().zip(tensions).find_map(|(tendon, tension)| {
                tendon.breaking_load.filter(|limit| tension > limit).map(|limit| (tendon, tension, limit))
            })?;
        let message = format!(
            "tendon \"{}\" tears: already at {:.3} % of the loads its tension is {tension:.3} N, its breaking load {limit:.3} N",
            tendon.name,
            100.0 * reached
        );
        Some(Error::new(message).hint("pull less, or let the tendons on the other side out"))
    }

    pub(super) fn not_converged(&self, reached: f64, stuck: &Stuck) -> Error {
        if let Some(known) = self.folded(reached).or_else(|| self.torn(reached)) {
            return known;
        }
        Error::new(format!(
            "no equilibrium found beyond {:.3} % of the loads: {} Newton iterations, last correction {:.1e}",
            100.0 * reached,
            self.iterations,
            stuck.correction
        ))
        .hint("the robot probably snaps or buckles there: lower the loads, or stiffen or shorten the robot")
    }
}
