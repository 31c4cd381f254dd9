//! Whether an answer lies on the branch that starts at the unloaded shape.

use crate::model::LoadKind;
use crate::statics::{Settings, Workspace, solve_near};
use crate::{Equilibrium, Robot};

/// Load steps of the reference.
pub(super) const STEPS: usize = 100;
/// A station that moves by more than this fraction of the length in one load step has left the branch.
const JUMP: f64 = 0.2;

/// What small load steps lead to.
pub(super) enum Branch {
    Same,
    Other,
    /// The branch turns back before the full load: there is nothing to compare with.
    Ends,
}

/// Follows all loads in a hundred steps and compares the end with a solution.
pub(super) fn branch(robot: &Robot, found: &Equilibrium, settings: &Settings) -> Branch {
    let length = robot.length();
    let mut workspace = Workspace::default();
    let mut last: Option<Equilibrium> = None;
    for step in 1..=STEPS {
        let part = with_loads_times(robot, step as f64 / STEPS as f64);
        let Ok(next) = solve_near(&part, settings, &mut workspace) else {
            return Branch::Ends;
        };
        if last.is_some_and(|last| distance(&last, &next) > JUMP * length) {
            return Branch::Ends;
        }
        last = Some(next);
    }
    // two solutions on one branch differ by their tolerances; two branches by far more
    match last {
        Some(last) if distance(&last, found) <= 1e-6 * length => Branch::Same,
        _ => Branch::Other,
    }
}

/// Largest distance over the stations.
pub(super) fn distance(a: &Equilibrium, b: &Equilibrium) -> f64 {
    let pairs = a.stations.iter().zip(&b.stations);
    pairs.map(|(a, b)| (a.position - b.position).norm()).fold(0.0, crate::numeric::larger)
}

fn with_loads_times(robot: &Robot, factor: f64) -> Robot {
    let mut robot = robot.clone();
    robot.gravity *= factor;
    for load in &mut robot.loads {
        match &mut load.kind {
            LoadKind::Point { force, moment, .. } => {
                *force *= factor;
                *moment *= factor;
            }
            LoadKind::Distributed { force_per_length, moment_per_length, .. } => {
                *force_per_length *= factor;
                *moment_per_length *= factor;
            }
            LoadKind::Mass { .. } => {} // its weight comes with gravity
        }
    }
    robot
}
