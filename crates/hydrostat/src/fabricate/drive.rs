//! Tendons, motors and the first test: what goes where, how far a step pulls, and what the tip should do.

use super::base::Base;
use super::design::longest_pull;
use super::workshop::Workshop;
use crate::model::{Command, Motion, Robot};
use crate::statics::{self, Settings};
use crate::{Equilibrium, Error};
use nalgebra::Vector3;

const MM: f64 = 1e-3;
const FIRST_PULL: f64 = 5.0 * MM;

/// A tendon with its motor.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Index of the tendon.
    pub tendon: usize,
    pub name: String,
    /// Name of the section at whose tip it is tied.
    pub ends: String,
    /// Of its hole at the base, rad.
    pub angle: f64,
    pub axis: char,
    /// From the base plate's face to its end on the straight robot.
    pub on_robot: f64,
    /// To cut, with knots and the turns that stay on the spool.
    pub cut_length: f64,
    /// At the command of the file, N.
    pub tension: f64,
    /// To the rod's strain limit; None without one.
    pub longest_pull: Option<f64>,
}

/// What to see when one tendon alone is pulled.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstTest {
    /// Index of the tendon.
    pub tendon: usize,
    pub pull: f64,
    pub steps: f64,
    /// World frame.
    pub at_rest: Vector3<f64>,
    pub tip: Vector3<f64>,
    pub tension: f64,
    /// Largest strain of the rod.
    pub strain: f64,
    /// The backbone, world frame, base to tip.
    pub shape: Vec<Vector3<f64>>,
}

pub(super) fn lines(robot: &Robot, workshop: &Workshop, base: &Base) -> Result<Vec<Line>, Error> {
    let shape = statics::solve(robot, &coarse())?;
    let line = |(i, tendon): (usize, &crate::model::Tendon)| {
        let place =
            base.places.iter().find(|place| place.tendon == Some(i)).expect("every tendon has a motor");
        let state = &shape.tendons[i];
        let stretched = tendon.stiffness.map_or(1.0, |stiffness| 1.0 + state.tension / stiffness);
        let on_robot = (state.length + state.displacement) / stretched;
        Line {
            tendon: i,
            name: tendon.name.clone(),
            ends: robot.sections[tendon.ends].name.clone(),
            angle: tendon.path.angle,
            axis: place.axis,
            on_robot,
            cut_length: base.cut_length(workshop, place, on_robot),
            tension: state.tension,
            longest_pull: longest_pull(robot, i),
        }
    };
    Ok(robot.tendons.iter().enumerate().map(line).collect())
}

fn coarse() -> Settings {
    Settings { stations: 2, eigenvalue: false, ..Settings::default() }
}

/// The first tendon by 5 mm, or by half of what the rod bears, the others without tension.
pub(super) fn first_test(robot: &Robot, workshop: &Workshop) -> Result<FirstTest, Error> {
    let half = longest_pull(robot, 0).map_or(FIRST_PULL, |most| 0.5 * most);
    let pull = if half < FIRST_PULL { (half / MM).floor().max(1.0) * MM } else { FIRST_PULL };
    let free = Command::Tension { tension: 0.0, motion: Motion::Pulled };
    let mut pulled = robot.clone();
    pulled.actuation.fill(free);
    let settings = Settings { stations: 101, ..coarse() };
    let solve = |robot: &Robot| {
        statics::solve(robot, &settings).map_err(|error| error.within("the first test of the assembly guide"))
    };
    let at_rest = solve(&pulled)?.tip.position;
    pulled.actuation[0] = Command::Displacement { displacement: pull, motion: Motion::Pulled };
    let shape = solve(&pulled)?;
    Ok(FirstTest {
        tendon: 0,
        pull,
        steps: (pull * workshop.steps_per_length()).round(),
        at_rest,
        tip: shape.tip.position,
        tension: shape.tendons[0].tension,
        strain: strain(&shape),
        shape: shape.stations.iter().map(|station| station.position).collect(),
    })
}

fn strain(shape: &Equilibrium) -> f64 {
    shape.checks.iter().find(|check| check.name == "strain").map_or(0.0, |check| check.value)
}
