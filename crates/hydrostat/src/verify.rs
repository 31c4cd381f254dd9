//! Holds the model against a measured bench.

mod findings;
mod verdict;

use crate::model::{Command, Frame, Load, LoadKind, Motion, Pose};
use crate::solution::Check;
use crate::statics::{Arcs, Settings, Weight, Workspace, constant_curvature, solve_in};
use crate::{Error, Robot};
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
    /// Pulls a tendon in; after a turn its drive loses the backlash, m, before the tendon moves.
    Displacement { tendon: usize, backlash: f64 },
    /// Tension of a tendon at the base.
    Tension { tendon: usize },
}

/// What an input does in a row; rows stand in the order in which they were measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acting {
    /// With offset and backlash.
    pub value: f64,
    /// Its last direction.
    pub motion: Motion,
}

impl Varied {
    /// Index of the tendon that it moves.
    pub fn tendon(self) -> Option<usize> {
        match self {
            Varied::Displacement { tendon, .. } | Varied::Tension { tendon } => Some(tendon),
            _ => None,
        }
    }

    pub(crate) fn backlash(self) -> f64 {
        if let Varied::Displacement { backlash, .. } = self { backlash } else { 0.0 }
    }
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
    /// The constant-curvature model, with the weight of the backbone and with it ignored.
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
    /// Checks of the prediction that fail: strain, stability.
    pub failed: Vec<Check>,
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
    /// Mean of predicted less observed, bench axes, m.
    pub offset: Vector3<f64>,
    /// Root mean square error after that offset is taken away, m.
    pub rms_without_offset: f64,
}

/// Solves every row and compares.
///
/// # Errors
/// The first row that has no solution or an impossible reading, with its inputs.
pub fn verify(experiment: &Experiment, settings: &Settings) -> Result<Verification, Error> {
    experiment.refuse_impossible_readings()?;
    let mut rows = Vec::with_capacity(experiment.rows.len());
    let mut arcs = [Vec::new(), Vec::new()];
    for (number, (row, acting)) in experiment.rows.iter().zip(experiment.acting()).enumerate() {
        let in_row =
            |error: Error| error.within(&format!("row {} ({})", number + 1, experiment.inputs_of(row)));
        let robot = experiment.robot_in(&experiment.robot, &acting);
        let mut workspace = Workspace::default();
        let settings = Settings { stations: SHAPE_POINTS, eigenvalue: false, ..settings.clone() };
        let shape = solve_in(&robot, &settings, &mut workspace).map_err(in_row)?;
        let of_constant_curvature = constant_curvature(&robot, Weight::Included).map_err(in_row)?;
        arcs[1].push(constant_curvature(&robot, Weight::Ignored).map_err(in_row)?);
        rows.push(VerifiedRow {
            inputs: row.inputs.clone(),
            points: experiment.differences(row, &experiment.points_of(&workspace, &robot)?),
            failed: shape.checks.iter().filter(|check| !check.ok).cloned().collect(),
            shape: shape.stations.iter().map(|station| experiment.to_bench(&station.position)).collect(),
            constant_curvature_shape: of_constant_curvature
                .poses(SHAPE_POINTS)
                .iter()
                .map(|pose| experiment.to_bench(&pose.position))
                .collect(),
        });
        arcs[0].push(of_constant_curvature);
    }
    let length = experiment.robot.length();
    let of_arcs = |arcs: &[Arcs]| {
        let points = experiment.rows.iter().zip(arcs);
        experiment.summary(
            length,
            points.flat_map(|(row, arcs)| experiment.compare(row, |at| arcs.pose(at).position)),
        )
    };
    let mut variants = Vec::new();
    for (name, robot) in &experiment.variants {
        let predicted = experiment
            .predict(robot, settings)
            .map_err(|error| error.within(&format!("variant \"{name}\"")))?;
        let points = experiment.rows.iter().zip(&predicted);
        let points = points.flat_map(|(row, predicted)| experiment.differences(row, predicted));
        variants.push((name.clone(), experiment.summary(robot.length(), points)));
    }
    let model = experiment.summary(length, rows.iter().flat_map(|row| row.points.iter().copied()));
    let [constant_curvature, constant_curvature_weightless] = arcs.map(|arcs| of_arcs(&arcs));
    Ok(Verification {
        verdict: verdict::verdict(experiment, &rows, &model, &constant_curvature),
        findings: findings::findings(experiment, &rows, settings)?,
        rows,
        model,
        constant_curvature,
        constant_curvature_weightless,
        variants,
    })
}

pub(crate) use verdict::{Systematic, systematic};

/// A point cannot be farther from the base than the backbone is long up to it; twice that is beyond any stretch or error
/// of reading.
const FARTHEST: f64 = 2.0;

/// Points of a drawn shape.
const SHAPE_POINTS: usize = 101;

impl Experiment {
    /// Wrong units and slips of the pen are not measurements.
    pub(crate) fn refuse_impossible_readings(&self) -> Result<(), Error> {
        let base = self.to_bench(&self.robot.base.position);
        for (number, row) in self.rows.iter().enumerate() {
            for (point, observed) in self.points.iter().zip(&row.observed) {
                let away: f64 =
                    point.axes.iter().map(|&i| (observed[i] - base[i]).powi(2)).sum::<f64>().sqrt();
                if away > FARTHEST * point.at.max(0.1 * self.robot.length()) {
                    return Err(Error::new(format!(
                        "row {} ({}): the observed point at {:.0} mm lies {:.0} mm from the base, farther than the \
                         backbone reaches",
                        number + 1,
                        self.inputs_of(row),
                        1e3 * point.at,
                        1e3 * away
                    ))
                    .hint("check that cell, the unit in its header, and the bench's origin and axes"));
                }
            }
        }
        Ok(())
    }

    /// What the inputs of every row do.
    pub fn acting(&self) -> Vec<Vec<Acting>> {
        let backlash: Vec<f64> = self.inputs.iter().map(|input| input.quantity.backlash()).collect();
        self.acting_with(&vec![0.0; backlash.len()], &backlash)
    }

    /// The same with an offset and a backlash of each input; nothing is added where nothing hangs.
    pub(crate) fn acting_with(&self, offsets: &[f64], backlash: &[f64]) -> Vec<Vec<Acting>> {
        let mut rows: Vec<Vec<Acting>> = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            let before = rows.last();
            let act = |(i, value): (usize, &f64)| {
                let offset = if *value == 0.0 { 0.0 } else { offsets[i] };
                let (half, moved) = (0.5 * backlash[i], value + offset);
                let Some(before) = before.map(|before| before[i]) else {
                    return Acting { value: moved, motion: Motion::Pulled };
                };
                // theory (52)
                let value =
                    if moved.is_nan() { moved } else { before.value.clamp(moved - half, moved + half) };
                let motion = match value - before.value {
                    change if change > 0.0 => Motion::Pulled,
                    change if change < 0.0 => Motion::Released,
                    _ => before.motion,
                };
                Acting { value, motion }
            };
            let acting = row.inputs.iter().enumerate().map(act).collect();
            rows.push(acting);
        }
        rows
    }

    /// `robot` as it was loaded, mounted and pulled in a row.
    pub fn robot_in(&self, robot: &Robot, acting: &[Acting]) -> Robot {
        let mut robot = robot.clone();
        for (input, &Acting { value, motion }) in self.inputs.iter().zip(acting) {
            let kind = match input.quantity {
                Varied::Displacement { tendon, .. } => {
                    robot.actuation[tendon] = Command::Displacement { displacement: value, motion };
                    continue;
                }
                Varied::Tension { tendon } => {
                    robot.actuation[tendon] = Command::Tension { tension: value, motion };
                    continue;
                }
                Varied::MountAngle => {
                    robot.base = robot.base.turned(&self.axes, value);
                    continue;
                }
                Varied::HungMass { at } => LoadKind::Mass { at: self.place(at, &robot), mass: value },
                Varied::Force { at, direction } => LoadKind::Point {
                    at: self.place(at, &robot),
                    force: self.axes.rotation * (value * direction),
                    moment: Vector3::zeros(),
                    frame: Frame::World,
                },
            };
            robot.loads.push(Load { name: None, kind });
        }
        robot
    }

    /// The inputs of a row as the data file gives them: `mass 20 g`.
    pub fn inputs_of(&self, row: &Row) -> String {
        // nine digits drop what the conversion to SI and back adds
        let exact = |value: f64| (value * 1e9).round() / 1e9;
        let texts: Vec<String> = (0..self.inputs.len()).map(|i| self.input_of(row, i, exact)).collect();
        texts.join(", ")
    }

    /// The inputs that vary from row to row, with four digits.
    pub(crate) fn varied_inputs_of(&self, row: &Row) -> Vec<String> {
        let varies = |i: &usize| self.rows.iter().any(|other| other.inputs[*i] != row.inputs[*i]);
        let short = |value: f64| format!("{value:.3e}").parse().unwrap_or(value);
        (0..self.inputs.len()).filter(varies).map(|i| self.input_of(row, i, short)).collect()
    }

    /// An input of a row, its value in the unit of the file as it is to be shown.
    fn input_of(&self, row: &Row, i: usize, shown: impl Fn(f64) -> f64) -> String {
        let Input { column, unit: (unit, size), .. } = &self.inputs[i];
        format!("{column} {} {unit}", shown(row.inputs[i] / size))
    }

    /// Predicted points of every row, bench axes.
    fn predict(&self, robot: &Robot, settings: &Settings) -> Result<Vec<Vec<Vector3<f64>>>, Error> {
        let settings = Settings { stations: 0, eigenvalue: false, ..settings.clone() };
        let mut workspace = Workspace::default();
        let predict = |acting: Vec<Acting>| {
            let robot = self.robot_in(robot, &acting);
            solve_in(&robot, &settings, &mut workspace)?;
            self.points_of(&workspace, &robot)
        };
        self.acting().into_iter().map(predict).collect()
    }

    /// Predicted points of the solution in the workspace, bench axes.
    fn points_of(&self, workspace: &Workspace, robot: &Robot) -> Result<Vec<Vector3<f64>>, Error> {
        let position = |point: &Point| {
            let station = workspace.station(robot, self.place(point.at, robot));
            let missing = || Error::new(format!("no point at s = {} m on this backbone", point.at));
            station.map(|station| self.to_bench(&station.position)).ok_or_else(missing)
        };
        self.points.iter().map(position).collect()
    }

    /// A place on `robot`: the tip of the experiment's robot is the tip of every variant, whatever its length.
    pub(crate) fn place(&self, at: f64, robot: &Robot) -> f64 {
        let tip = self.robot.length();
        if (at - tip).abs() <= 1e-9 * tip { robot.length() } else { at }
    }

    pub(crate) fn to_bench(&self, position: &Vector3<f64>) -> Vector3<f64> {
        self.axes.rotation.inverse() * (position - self.axes.position)
    }

    /// Compares a row with positions in the world.
    fn compare(&self, row: &Row, position: impl Fn(f64) -> Vector3<f64>) -> Vec<PointError> {
        let predicted: Vec<_> = self.points.iter().map(|point| self.to_bench(&position(point.at))).collect();
        self.differences(row, &predicted)
    }

    /// Compares a row with positions in the bench's axes.
    pub(crate) fn differences(&self, row: &Row, predicted: &[Vector3<f64>]) -> Vec<PointError> {
        let points = self.points.iter().zip(predicted).zip(&row.observed);
        points
            .map(|((point, predicted), observed)| {
                let read = |v: &Vector3<f64>| {
                    Vector3::from_fn(|i, _| if point.axes.contains(&i) { v[i] } else { 0.0 })
                };
                let (predicted, observed) = (read(predicted), read(observed));
                PointError { at: point.at, predicted, observed, error: (predicted - observed).norm() }
            })
            .collect()
    }

    pub(crate) fn summary(&self, length: f64, errors: impl Iterator<Item = PointError>) -> Summary {
        let (mut count, mut coordinates) = (0.0, 0.0);
        let (mut sum, mut squares, mut max, mut weighted) = (0.0, 0.0, 0.0_f64, 0.0);
        // an axis that a point does not read says nothing of its offset
        let (mut sums, mut read): (Vector3<f64>, Vector3<f64>) = (Vector3::zeros(), Vector3::zeros());
        for (error, point) in errors.zip(self.points.iter().cycle()) {
            count += 1.0;
            coordinates += point.axes.len() as f64;
            sum += error.error;
            squares += error.error.powi(2);
            max = max.max(error.error);
            weighted += (error.error / point.reading_error).powi(2);
            sums += error.predicted - error.observed;
            point.axes.iter().for_each(|axis| read[*axis] += 1.0);
        }
        let offset = Vector3::from_fn(|axis, _| sums[axis] / read[axis].max(1.0));
        let common = sums.dot(&offset);
        Summary {
            mean: sum / count,
            rms: (squares / count).sqrt(),
            max,
            mean_fraction: sum / count / length,
            in_reading_errors: (weighted / coordinates).sqrt(),
            offset,
            rms_without_offset: ((squares - common) / count).max(0.0).sqrt(),
        }
    }
}
