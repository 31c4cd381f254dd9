//! Random tendon robots, solved by the energy method: each answer checked, one in twenty solved by shooting, too.

use super::check::defects;
use super::tendon_robots::tendon_robot;
use super::{LARGEST_DEFECT, kind, worse};
use crate::solution::Method;
use crate::statics::{Settings, Workspace, solve, solve_in};
use crate::validate::{Case, Group};
use crate::{Equilibrium, Error, Robot};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt;

/// What became of the robots of a sweep.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TendonSweep {
    pub count: usize,
    /// Equilibria that passed the check.
    pub solved: usize,
    /// Of these, those that the solver calls unstable, and those to which the robot snapped.
    pub unstable: usize,
    pub snapped: usize,
    /// Refusals: message up to its first number, with the indices of the robots.
    pub refused: BTreeMap<String, Vec<usize>>,
    /// Robots whose answer did not pass the check.
    pub faults: Vec<usize>,
    /// Largest defect of an answer, and its robot.
    pub worst: (f64, usize),
    /// Robots that shooting solved, too, those of which it found another equilibrium, and those that it refused.
    pub compared: usize,
    pub elsewhere: Vec<usize>,
    pub refused_by_shooting: Vec<usize>,
    /// Largest distance between the two methods, as a fraction of the length, and its robot.
    pub apart: (f64, usize),
}

/// One robot in so many is solved by shooting.
const SUBSAMPLE: usize = 20;
/// Each method is asked for 1e-9 of the length, and held tendons turn an error of their length into ten of a position.
const AGREEMENT: f64 = 1e-8;

/// Robots that are solved one after the other in the same memory.
const CHUNK: usize = 20;

/// Solves and checks the tendon robots 0 to count - 1 of a seed, on all cores.
pub fn tendon_sweep(count: usize, seed: u64) -> TendonSweep {
    let of_chunk = |chunk: usize| {
        let (mut sweep, mut workspace) = (TendonSweep::default(), Workspace::default());
        for index in chunk * CHUNK..count.min((chunk + 1) * CHUNK) {
            sweep.try_one(index, &tendon_robot(seed, index), &mut workspace);
        }
        sweep
    };
    let chunks: Vec<TendonSweep> =
        (0..count.div_ceil(CHUNK)).into_par_iter().with_max_len(1).map(of_chunk).collect();
    chunks.into_iter().fold(TendonSweep { count, ..TendonSweep::default() }, TendonSweep::with)
}

/// The solution with a station at every plate, which the check needs.
pub fn solve_with_plates(
    robot: &Robot,
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Equilibrium, Error> {
    let mut found = solve_in(robot, settings, workspace)?;
    let known = found.stations.clone();
    let missing = |s: &f64| known.iter().all(|station| (station.s - s).abs() > 1e-13 * robot.length());
    let plates = robot.plates().into_iter().filter(missing);
    found.stations.extend(plates.filter_map(|s| workspace.station(robot, s)));
    found.stations.sort_by(|a, b| a.s.total_cmp(&b.s));
    Ok(found)
}

impl TendonSweep {
    /// Together with the next robots.
    fn with(mut self, next: TendonSweep) -> TendonSweep {
        self.solved += next.solved;
        self.unstable += next.unstable;
        self.snapped += next.snapped;
        self.compared += next.compared;
        for (message, robots) in next.refused {
            self.refused.entry(message).or_default().extend(robots);
        }
        self.faults.extend(next.faults);
        self.elsewhere.extend(next.elsewhere);
        self.refused_by_shooting.extend(next.refused_by_shooting);
        self.worst = worse(self.worst, next.worst);
        self.apart = worse(self.apart, next.apart);
        self
    }

    fn try_one(&mut self, index: usize, robot: &Robot, workspace: &mut Workspace) {
        let settings = Settings { eigenvalue: false, ..Settings::default() };
        let found = match solve_with_plates(robot, &settings, workspace) {
            Ok(found) => found,
            Err(error) => return self.refused.entry(kind(&error.to_string())).or_default().push(index),
        };
        let defect = defects(robot, &found).largest();
        self.worst = worse(self.worst, (defect, index));
        if defect <= LARGEST_DEFECT {
            self.solved += 1;
            self.unstable += usize::from(found.report.stable == Some(false));
            self.snapped += usize::from(found.report.snapped_from.is_some());
        } else {
            self.faults.push(index);
        }
        // shooting knows no friction
        let rubs = robot.tendons.iter().any(|tendon| tendon.friction > 0.0);
        if index.is_multiple_of(SUBSAMPLE) && !rubs {
            self.compare(index, robot, &found, &settings);
        }
    }

    fn compare(&mut self, index: usize, robot: &Robot, found: &Equilibrium, settings: &Settings) {
        let shooting = Settings { method: Method::Shooting, ..settings.clone() };
        let Ok(other) = solve(robot, &shooting) else {
            return self.refused_by_shooting.push(index);
        };
        let apart = (found.tip.position - other.tip.position).norm() / robot.length();
        // two solutions of one branch differ by their tolerances, two branches by far more
        if apart > 1e-4 {
            return self.elsewhere.push(index);
        }
        self.compared += 1;
        self.apart = worse(self.apart, (apart, index));
    }

    /// As rows of the validation table.
    pub fn cases(&self) -> Vec<Case> {
        let group = Group {
            title: "Random tendon robots",
            source: "1 to 4 sections, 1 to 12 tendons in channels and through guides, straight, converging, helical; by \
                     tension, by displacement, mixed; a total bend up to a full circle; all loads; each answer integrated \
                     again station by station, one in twenty solved by shooting, too, where nothing rubs",
            reason: "1 in 1000 may be refused with an explanation; none may be wrong; 1e-6 covers the error of the check; \
                     two methods of 1e-9 each",
        };
        let share = 100.0 * self.solved as f64 / self.count.max(1) as f64;
        let faults = (self.faults.len() + self.elsewhere.len()) as f64;
        vec![
            group.case(format!("solved and checked of {} [%]", self.count), 100.0, Ok(share), 0.1),
            group.case("answers that fail the check or that shooting contradicts", 0.0, Ok(faults), 0.0),
            group.case("largest defect of an answer", 0.0, Ok(self.worst.0), LARGEST_DEFECT),
            group.case(
                format!("largest distance between the methods / L, of {}", self.compared),
                0.0,
                Ok(self.apart.0),
                AGREEMENT,
            ),
        ]
    }
}

impl fmt::Display for TendonSweep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let some = |robots: &[usize]| format!("{:?}", &robots[..robots.len().min(10)]);
        writeln!(f, "{} of {} tendon robots solved and checked", self.solved, self.count)?;
        writeln!(f, "{} of them unstable equilibria, {} after a snap", self.unstable, self.snapped)?;
        for (message, robots) in &self.refused {
            writeln!(f, "{} refused: {message}.. (robots {})", robots.len(), some(robots))?;
        }
        writeln!(f, "{} fail the check (robots {})", self.faults.len(), some(&self.faults))?;
        writeln!(f, "largest defect {:.1e} (robot {})", self.worst.0, self.worst.1)?;
        let (elsewhere, refused) = (&self.elsewhere, &self.refused_by_shooting);
        writeln!(f, "shooting: {} agree, elsewhere {}", self.compared, some(elsewhere))?;
        writeln!(f, "shooting: {} refused {}", refused.len(), some(refused))?;
        write!(f, "largest distance between the methods {:.1e} L (robot {})", self.apart.0, self.apart.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part of `hydrostat validate --full`.
    #[test]
    fn three_hundred_random_tendon_robots() {
        let sweep = tendon_sweep(300, 1);
        assert!(sweep.faults.is_empty() && sweep.elsewhere.is_empty(), "{sweep}");
        assert!(sweep.solved >= 298 && sweep.apart.0 <= AGREEMENT, "{sweep}");
    }

    /// The check must see a length, a tension, a displacement, a wrench and a strain that are a little off.
    #[test]
    fn the_check_sees_small_faults_of_tendons() {
        let spoil: [fn(&mut Equilibrium, f64); 6] = [
            |e, length| e.tendons[0].length += 1e-5 * length,
            |e, length| e.tendons[0].displacement += 1e-5 * length,
            |e, _| e.tendons.iter_mut().for_each(|tendon| tendon.tension *= 1.0 + 1e-4),
            |e, _| e.tendons[0].tension = -1.0,
            |e, _| e.stations[50].moment *= 1.0 + 1e-3,
            |e, _| e.stations[50].u *= 1.0 + 1e-3,
        ];
        for index in [1, 23, 68, 312] {
            let robot = tendon_robot(1, index);
            let settings = Settings { eigenvalue: false, ..Settings::default() };
            let found =
                solve_with_plates(&robot, &settings, &mut Workspace::default()).expect("has an answer");
            assert!(defects(&robot, &found).largest() <= LARGEST_DEFECT, "robot {index}");
            for (i, spoil) in spoil.into_iter().enumerate() {
                let mut spoiled = found.clone();
                spoil(&mut spoiled, robot.length());
                let defect = defects(&robot, &spoiled).largest();
                assert!(
                    defect > LARGEST_DEFECT || defect.is_nan(),
                    "fault {i} of robot {index}: {defect:.1e}"
                );
            }
        }
    }
}
