//! Holds the model against a measured bench.

use crate::{Error, Robot, model::Pose, statics::Settings};
use nalgebra::Vector3;

/// A bench: a robot, what was varied, and what was measured.
#[derive(Clone, Debug)]
pub struct Experiment {
    pub name: String,
    /// Where the data come from.
    pub source: Option<String>,
    /// The robot as mounted for a row in which nothing is varied.
    pub robot: Robot,
    /// The bench's own axes in the world; measured coordinates are along its columns, from its origin.
    pub axes: Pose,
    /// One per varied quantity, in the order of `Row::inputs`.
    pub inputs: Vec<Input>,
    /// One per measured point, in the order of `Row::observed`.
    pub points: Vec<Point>,
    pub rows: Vec<Row>,
    /// What the source itself printed, to be checked against its own data.
    pub published: Option<Published>,
    /// Other robots to hold against the same data: name and robot.
    pub variants: Vec<(String, Robot)>,
}

/// What was varied from row to row.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Header of the column, without its unit.
    pub column: String,
    /// Unit of the column, for display, and its size in SI.
    pub unit: (String, f64),
    pub quantity: Varied,
}

/// How an input changes the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Varied {
    /// A mass hung at an arc length.
    HungMass { at: f64 },
    /// Turns the base about the bench's z axis, from x to y, against its pose in the robot file.
    MountAngle,
    /// A dead force along a unit direction given in the bench's axes, at an arc length.
    Force { at: f64, direction: Vector3<f64> },
}

/// A marked point on the backbone whose coordinates were read.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub at: f64,
    /// Which of the bench's axes were read: 0 x, 1 y, 2 z.
    pub axes: Vec<usize>,
    /// Standard reading error of one coordinate.
    pub reading_error: f64,
}

/// One measurement; SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub inputs: Vec<f64>,
    /// Bench axes; the axes that were not read are zero. One per point.
    pub observed: Vec<Vector3<f64>>,
}

/// The source's own predictions and errors, where it prints them.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Published {
    /// Per row, first point, bench axes.
    pub predicted: Vec<Vector3<f64>>,
    /// Per row, m; empty where not printed.
    pub error: Vec<f64>,
    /// Per row, fraction of the length; empty where not printed.
    pub error_fraction: Vec<f64>,
    /// Half a unit of the last printed digit: of a predicted coordinate (m), of an error (m), of a fraction.
    pub rounding: [f64; 3],
    /// Statements such as "mean error in the text" with their value in m.
    pub mean_errors: Vec<(String, f64)>,
}

/// The outcome of [`verify`].
#[derive(Clone, Debug)]
pub struct Verification {
    pub rows: Vec<VerifiedRow>,
    pub model: Summary,
    /// The constant-curvature model, with the weight and with the weight ignored.
    pub constant_curvature: Summary,
    pub constant_curvature_weightless: Summary,
    /// Name and errors of every variant.
    pub variants: Vec<(String, Summary)>,
    /// In words: is the model within the reading error, is the residual systematic.
    pub verdict: Vec<String>,
    /// In words: where the source's printed numbers disagree with each other.
    pub findings: Vec<String>,
}

/// One row of the table.
#[derive(Clone, Debug)]
pub struct VerifiedRow {
    pub inputs: Vec<f64>,
    /// One per measured point, bench axes.
    pub points: Vec<PointError>,
    /// The predicted backbone, base to tip, bench axes.
    pub shape: Vec<Vector3<f64>>,
    /// The constant-curvature model's backbone, base to tip, bench axes.
    pub constant_curvature_shape: Vec<Vector3<f64>>,
}

/// Prediction and observation of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointError {
    pub at: f64,
    /// Axes that were not read are zero.
    pub predicted: Vector3<f64>,
    pub observed: Vector3<f64>,
    /// Distance over the axes that were read, m.
    pub error: f64,
}

/// Errors over all rows and points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    pub mean: f64,
    pub rms: f64,
    pub max: f64,
    /// Mean error as a fraction of the length.
    pub mean_fraction: f64,
    /// Root mean square over all coordinates of error / reading error.
    pub in_reading_errors: f64,
}

/// Solves every row and compares.
pub fn verify(_experiment: &Experiment, _settings: &Settings) -> Result<Verification, Error> {
    Err(Error::new("not written yet"))
}
