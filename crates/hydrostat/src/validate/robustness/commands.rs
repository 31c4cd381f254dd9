//! Whether the tendons do what they were commanded.

use super::check::{Check, State, larger};
use super::chords::Chords;
use crate::model::{Command, Routing};
use crate::{Equilibrium, Robot};
use nalgebra::Vector3;

/// The largest departure of the tendons from shape and command: lengths in units of L, tensions of EI/L^2.
pub(super) fn defect(check: &Check, tip: &State, found: &Equilibrium) -> f64 {
    let robot = check.robot;
    if robot.tendons.is_empty() {
        return 0.0;
    }
    let home = home_lengths(robot);
    let mut worst = 0.0;
    for (i, (tendon, state)) in robot.tendons.iter().zip(&found.tendons).enumerate() {
        let (length, share) = match tendon.routing {
            Routing::Channel => (tip.paths[i], (check.capstan[i] * tip.turned[i]).exp()),
            Routing::Guides => (check.chords.lengths[i], check.chords.tip_shares[i]),
        };
        let stretch = tendon.stiffness.map_or(0.0, |stiffness| home[i] * state.tension / stiffness);
        let pulled_in = home[i] - length + stretch;
        let of_command = match robot.actuation[i] {
            Command::Tension { tension, .. } => check.force(state.tension - tension),
            Command::Displacement { displacement, .. } if state.slack => {
                check.force(state.tension) + (displacement - pulled_in).max(0.0) / check.length
            }
            Command::Displacement { displacement, .. } => (displacement - pulled_in).abs() / check.length,
        };
        let pushes = if state.tension >= 0.0 { 0.0 } else { f64::INFINITY };
        let of_state = ((length - state.length).abs() + (pulled_in - state.displacement).abs())
            / check.length
            + check.force(state.tip_tension - share * state.tension);
        worst = larger(worst, of_command + of_state + pushes);
    }
    worst
}

/// Of the paths on the unloaded robot.
fn home_lengths(robot: &Robot) -> Vec<f64> {
    let unloaded = Robot { loads: Vec::new(), gravity: Vector3::zeros(), ..robot.clone() };
    let tensions = vec![0.0; robot.tendons.len()];
    let check = Check::new(&unloaded, &tensions);
    let mut state = State::clamped(robot);
    let mut at = 0.0;
    let mut poses = Vec::new();
    for s in robot.plates().into_iter().chain([check.length]) {
        state = check.integrate(at, s, state);
        poses.push((s, state.position, state.rotation));
        at = s;
    }
    poses.truncate(robot.plates().len());
    let chords = Chords::new(robot, poses, &tensions, &tensions);
    chords.lengths.iter().zip(state.paths.iter()).map(|(chords, path)| chords + path).collect()
}
