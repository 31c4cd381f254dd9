//! Random rods and tendon robots: every one ends as an equilibrium that passes an independent check, or as an explained refusal.

mod branch;
mod check;
mod chords;
mod commands;
mod law;
mod random;
mod tendon_robots;
mod tendon_sweep;

use super::{Case, Group};
use crate::solution::Method;
use crate::statics::{self, Settings};
use crate::{Equilibrium, Robot};
use branch::{Branch, branch};
pub use check::{Defects, defects};
pub use random::robot;
use std::collections::BTreeMap;
use std::fmt;
pub use tendon_robots::tendon_robot;
pub use tendon_sweep::{TendonSweep, solve_with_plates, tendon_sweep};

/// What became of the rods of a sweep.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweep {
    pub count: usize,
    /// Equilibria that passed the check.
    pub converged: usize,
    /// Of these, those that the solver calls unstable.
    pub unstable: usize,
    /// Refusals: message up to its first number, with the indices of the rods.
    pub refused: BTreeMap<String, Vec<usize>>,
    /// Of the rods followed in small load steps: those that end on the same branch, and the others.
    pub followed: usize,
    pub other_branch: Vec<usize>,
    /// Rods whose answer did not pass the check.
    pub faults: Vec<usize>,
    /// Largest defect of an answer, and its rod.
    pub worst: (f64, usize),
    /// Largest distance from a solution at a hundredth of the tolerance, as a fraction of the length, and its rod.
    pub worst_error: (f64, usize),
}

/// Largest defect of a converged answer: see [`Defects`]. The check's own Runge-Kutta error is below 1e-7.
const LARGEST_DEFECT: f64 = 1e-6;
/// One rod in so many is solved again at a hundredth of the tolerance, and in a hundred load steps.
const SUBSAMPLE: usize = 10;

/// Solves by shooting and checks the rods 0 to count - 1 of a seed.
pub fn sweep(count: usize, seed: u64) -> Sweep {
    let settings = Settings { method: Method::Shooting, eigenvalue: false, ..Settings::default() };
    let mut sweep = Sweep { count, ..Sweep::default() };
    for index in 0..count {
        let robot = robot(seed, index);
        match statics::solve(&robot, &settings) {
            Ok(found) => sweep.add(index, &robot, &found, &settings),
            Err(error) => sweep.refused.entry(kind(&error.to_string())).or_default().push(index),
        }
    }
    sweep
}

impl Sweep {
    fn add(&mut self, index: usize, robot: &Robot, found: &Equilibrium, settings: &Settings) {
        let defect = defects(robot, found).largest();
        self.worst = worse(self.worst, (defect, index));
        let mut error = 0.0;
        if index.is_multiple_of(SUBSAMPLE) {
            error = distance_from_finer(robot, found, settings);
            match branch(robot, found, settings) {
                Branch::Same => self.followed += 1,
                Branch::Other => self.other_branch.push(index),
                Branch::Ends => {}
            }
        }
        self.worst_error = worse(self.worst_error, (error, index));
        if defect <= LARGEST_DEFECT && error <= settings.tolerance {
            self.converged += 1;
            self.unstable += usize::from(found.report.stable == Some(false));
        } else {
            self.faults.push(index);
        }
    }

    /// As rows of the validation table.
    pub fn cases(&self) -> Vec<Case> {
        let group = Group {
            title: "Random rods",
            source: "slenderness 10 to 1000, F L^2/EI to 10, w L^3/EI to 20, every direction, rest curvature, tapers, up \
                     to three sections, some follower loads; each answer integrated again station by station",
            reason: "1 in 1000 may be refused with an explanation; none may be wrong; 1e-6 covers the error of the check",
        };
        let share = 100.0 * self.converged as f64 / self.count.max(1) as f64;
        vec![
            group.case(format!("converged and checked of {} [%]", self.count), 100.0, Ok(share), 0.1),
            group.case("answers that fail the check", 0.0, Ok(self.faults.len() as f64), 0.0),
            group.case(
                format!("answers on another branch than {} small load steps", branch::STEPS),
                0.0,
                Ok(self.other_branch.len() as f64),
                0.0,
            ),
            group.case("largest defect of an answer", 0.0, Ok(self.worst.0), LARGEST_DEFECT),
            group.case(
                "largest distance from a finer solution / L",
                0.0,
                Ok(self.worst_error.0),
                Settings::default().tolerance,
            ),
        ]
    }
}

impl fmt::Display for Sweep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} of {} rods converged and checked", self.converged, self.count)?;
        writeln!(f, "{} of them unstable equilibria", self.unstable)?;
        let (same, other) = (self.followed, &self.other_branch);
        writeln!(f, "small load steps: {same} on the same branch, others: rods {other:?}")?;
        for (message, rods) in &self.refused {
            writeln!(f, "{} refused: {message}.. (rods {:?})", rods.len(), &rods[..rods.len().min(10)])?;
        }
        writeln!(
            f,
            "{} fail the check (rods {:?})",
            self.faults.len(),
            &self.faults[..self.faults.len().min(10)]
        )?;
        writeln!(f, "largest defect {:.1e} (rod {})", self.worst.0, self.worst.1)?;
        write!(
            f,
            "largest distance from a finer solution {:.1e} L (rod {})",
            self.worst_error.0, self.worst_error.1
        )
    }
}

/// Largest distance between two solutions over the stations, as a fraction of the length; NaN where the finer is refused.
fn distance_from_finer(robot: &Robot, found: &Equilibrium, settings: &Settings) -> f64 {
    let finer = Settings { tolerance: 0.01 * settings.tolerance, ..settings.clone() };
    let Ok(finer) = statics::solve(robot, &finer) else {
        return f64::NAN;
    };
    branch::distance(found, &finer) / robot.length()
}

/// The larger of two; NaN is the worst of all.
fn worse(a: (f64, usize), b: (f64, usize)) -> (f64, usize) {
    if a.0.is_nan() || b.0 <= a.0 { a } else { b }
}

/// A message up to its first number.
fn kind(message: &str) -> String {
    let end = message.find(|c: char| c.is_ascii_digit()).unwrap_or(message.len());
    message[..end].trim_end().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tenth of `hydrostat validate --full`.
    #[test]
    fn a_thousand_random_rods() {
        let sweep = sweep(1000, 1);
        assert!(sweep.cases().iter().all(Case::ok), "{sweep}");
    }

    /// The check must see what it is there for: a wrench, a strain, a position that is off by 1e-5.
    #[test]
    fn the_check_sees_small_faults() {
        let robot = robot(1, 0);
        let found = {
            let settings = Settings { method: Method::Shooting, ..Settings::default() };
            statics::solve(&robot, &settings).expect("rod 0 has an answer")
        };
        let spoil: [fn(&mut Equilibrium, f64); 4] = [
            |e, length| e.stations[50].position.x += 1e-5 * length,
            |e, _| e.stations[50].moment *= 1.0 + 1e-4,
            |e, _| e.stations[50].u *= 1.0 + 1e-4,
            |e, _| e.stations[100].force *= 1.0 + 1e-4,
        ];
        assert!(defects(&robot, &found).largest() <= LARGEST_DEFECT);
        for (i, spoil) in spoil.into_iter().enumerate() {
            let mut spoiled = found.clone();
            spoil(&mut spoiled, robot.length());
            assert!(defects(&robot, &spoiled).largest() > LARGEST_DEFECT, "fault {i}");
        }
    }
}
