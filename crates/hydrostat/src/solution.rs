//! What a solver returns.

use crate::model::Pose;
use nalgebra::{Matrix3, Vector3};

/// An equilibrium shape with everything that says how far to trust it.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    pub tip: Pose,
    /// Evenly spaced in s, both ends included.
    pub stations: Vec<Station>,
    /// In the order of the robot's.
    pub tendons: Vec<TendonState>,
    pub checks: Vec<Check>,
    pub report: Report,
}

/// The state of the backbone at one arc length.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    pub s: f64,
    /// World frame.
    pub position: Vector3<f64>,
    /// Columns d1 d2 d3, world frame.
    pub rotation: Matrix3<f64>,
    /// Shear and stretch, body frame.
    pub v: Vector3<f64>,
    /// Bending and twist, body frame, 1/m.
    pub u: Vector3<f64>,
    /// Internal force n, world frame; limit from the base side at a jump.
    pub force: Vector3<f64>,
    /// Internal moment m, world frame; limit from the base side at a jump.
    pub moment: Vector3<f64>,
}

/// A tendon at the equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct TendonState {
    pub name: String,
    /// At the base.
    pub tension: f64,
    /// At its end; the same without friction.
    pub tip_tension: f64,
    /// Pulled in at the base, from the unloaded robot: length at rest - length + stretch.
    pub displacement: f64,
    /// Of its path on the deformed robot.
    pub length: f64,
    /// Whether it would have to push to be as long as commanded.
    pub slack: bool,
}

/// A quantity held against its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    pub name: &'static str,
    pub value: f64,
    pub limit: f64,
    pub ok: bool,
    /// Arc length of the worst place.
    pub at: Option<f64>,
    /// Names of the tendons that it is about: of the one nearest to its limit, or of all that fail.
    pub tendons: Vec<String>,
}

/// How the answer was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    pub method: Method,
    /// Newton iterations on all meshes together.
    pub iterations: usize,
    /// Largest gap left between steps: radians, moments in units of stiffness / length, forces of stiffness / length^2.
    pub residual: f64,
    /// Estimated largest error of a position, m.
    pub error_estimate: f64,
    /// None where it is not known: loads other than dead forces have no energy.
    pub stable: Option<bool>,
    /// Of the energy's second variation scaled by the elastic stiffness, theory (19); 1 for an unloaded rod, None with
    /// follower loads.
    pub smallest_eigenvalue: Option<f64>,
    /// Part of the loads at which the branch from the unloaded shape first turned unstable; not looked for where the
    /// solver started from a solution.
    pub unstable_from: Option<f64>,
    /// Part of the loads at which that branch ended in a fold; the shape is the minimum of the energy to which it snapped.
    pub snapped_from: Option<f64>,
}

/// How an equilibrium answers one small change, per unit of that change.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Derivative {
    /// At each observed place, in their order.
    pub poses: Vec<PoseDerivative>,
    /// In the order of the robot's.
    pub tendons: Vec<TendonDerivative>,
}

/// Change of a pose, world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseDerivative {
    pub position: Vector3<f64>,
    /// Rotation vector w with dR = hat(w) R, rad.
    pub rotation: Vector3<f64>,
}

/// Change of a tendon, its quantities as in [`TendonState`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TendonDerivative {
    pub tension: f64,
    pub displacement: f64,
    pub length: f64,
}

/// The solver that found it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Stationary energy in strain coordinates.
    Energy,
    /// Integration from the base, total wrench.
    Shooting,
}
