//! How an equilibrium answers small changes of commands, loads and parameters.

use super::{Workspace, energy};
use crate::solution::Derivative;
use crate::{Error, Robot};
use nalgebra::Vector3;

/// What changes a little.
#[derive(Clone, Copy, Debug)]
pub enum Input<'a> {
    /// The command of the tendon of this number: its tension, per N, or its displacement, per m.
    Command(usize),
    /// A dead force and moment at the tip, world frame; per so much.
    TipWrench { force: Vector3<f64>, moment: Vector3<f64> },
    /// A parameter `step` below and `step` above its value in the robot that was solved; per its unit. About 1e-4 of the value
    /// is a good step: the shape stays as it is, so that nothing is differenced that was solved for.
    Parameter { behind: &'a Robot, ahead: &'a Robot, step: f64 },
}

impl Input<'static> {
    /// Every tendon's command, in their order.
    pub fn commands(robot: &Robot) -> Vec<Self> {
        (0..robot.tendons.len()).map(Input::Command).collect()
    }

    /// Forces, then moments, along the axes of the world.
    pub fn tip_wrench() -> [Self; 6] {
        let axis = |i: usize| Vector3::ith(i % 3, 1.0);
        std::array::from_fn(|i| match i {
            0..3 => Input::TipWrench { force: axis(i), moment: Vector3::zeros() },
            _ => Input::TipWrench { force: Vector3::zeros(), moment: axis(i) },
        })
    }
}

impl Input<'_> {
    fn check(&self, robot: &Robot) -> Result<(), Error> {
        let count = robot.tendons.len();
        match *self {
            Input::Command(tendon) if tendon >= count => {
                Err(Error::new(format!("the command of tendon {} of {count}", tendon + 1)))
            }
            Input::Parameter { step, .. } if !(step > 0.0 && step.is_finite()) => {
                Err(Error::new(format!("a parameter's step of {step}, expected a finite number above 0")))
            }
            Input::Parameter { behind, ahead, .. } => behind.check().and_then(|()| ahead.check()),
            Input::Command(_) | Input::TipWrench { .. } => Ok(()),
        }
    }
}

/// Derivatives of the solution last found in the workspace with respect to each input: of the pose at every place (arc lengths;
/// the robot's length is its tip, whatever its length) and of the tendons. One more solve with the factors of the Hessian each, theory
/// (38) to (42).
///
/// Taut tendons stay taut and slack ones slack: where a tension passes zero this is one side of a kink, and the displacement of a slack
/// tendon moves nothing. `robot` as it was solved.
///
/// # Errors
/// No solution of the energy method for this robot in the workspace, an equilibrium that is about to snap, or a robot of a
/// parameter with other breakpoints.
pub fn derivatives(
    robot: &Robot,
    workspace: &mut Workspace,
    places: &[f64],
    inputs: &[Input],
) -> Result<Vec<Derivative>, Error> {
    if !workspace.warm {
        return Err(Error::new("derivatives need a solution, and the workspace has none"));
    }
    let Workspace { chain, energy, by_energy, .. } = workspace;
    if !*by_energy {
        return Err(Error::new("derivatives come from the energy method, and this was solved by shooting")
            .hint("solve with the energy method, which is the default"));
    }
    let length = chain.length;
    if let Some(s) = places.iter().find(|s| !(0.0..=length * (1.0 + 1e-12)).contains(*s)) {
        return Err(Error::new(format!("s = {s} m is not on the backbone of 0 to {length} m")));
    }
    inputs.iter().try_for_each(|input| input.check(robot))?;
    energy::derivatives(energy, robot, chain, places, inputs)
}
