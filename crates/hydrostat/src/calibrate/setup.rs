//! The robot and the bench with the parameters of a fit.

use super::Parameter;
use super::part::Part;
use crate::model::Robot;
use crate::verify::{Acting, Experiment};
use nalgebra::{Rotation3, Vector3};

/// The robot and the bench with their parameters set.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub(super) robot: Robot,
    pub(super) turn: Vector3<f64>,
    pub(super) mount_angle: f64,
    /// Per input.
    pub(super) mass_offsets: Vec<f64>,
    pub(super) backlash: Vec<f64>,
    /// Per point, body frame.
    pub(super) marker_offsets: Vec<Vector3<f64>>,
}

impl Setup {
    /// As the files have it.
    pub(super) fn new(experiment: &Experiment) -> Setup {
        Setup {
            robot: experiment.robot.clone(),
            turn: Vector3::zeros(),
            mount_angle: 0.0,
            mass_offsets: vec![0.0; experiment.inputs.len()],
            backlash: experiment.inputs.iter().map(|input| input.quantity.backlash()).collect(),
            marker_offsets: vec![Vector3::zeros(); experiment.points.len()],
        }
    }

    /// With these values; E before G, which keeps its ratio to it.
    pub(super) fn with(&self, parameters: &[Parameter], values: &[f64]) -> Setup {
        let mut setup = self.clone();
        for shear in [false, true] {
            for (parameter, &value) in parameters.iter().zip(values) {
                for part in &parameter.parts {
                    if matches!(part, Part::ShearModulus { .. }) == shear {
                        part.set(&mut setup, self.tied(&parameter.parts[0], part, value));
                    }
                }
            }
        }
        setup
    }

    /// Value of a part whose tie has this value: as the files have them, tied parts keep their ratios, and their differences where any
    /// sign is possible.
    fn tied(&self, first: &Part, part: &Part, value: f64) -> f64 {
        match (first.get(self), part.get(self)) {
            (Ok(a), Ok(b)) if a == b => value,
            (Ok(a), Ok(b)) if first.lowest().is_none() => value + (b - a),
            // `Parameter::start` refuses a tie whose first part is 0
            (Ok(a), Ok(b)) => value * b / a,
            _ => value,
        }
    }

    /// What the inputs of every row do.
    pub(super) fn acting(&self, experiment: &Experiment) -> Vec<Vec<Acting>> {
        experiment.acting_with(&self.mass_offsets, &self.backlash)
    }

    /// The robot in a row in which nothing is varied.
    pub(super) fn mounted(&self, experiment: &Experiment) -> Robot {
        let mut robot = self.turned();
        robot.base = robot.base.turned(&experiment.axes, self.mount_angle);
        robot
    }

    /// The robot with its base turned, without the mount angle, which is the bench's.
    pub(super) fn turned(&self) -> Robot {
        let mut robot = self.robot.clone();
        robot.base.rotation = Rotation3::new(self.turn) * robot.base.rotation;
        robot
    }
}
