//! What a row measures with trial values of the parameters, and its derivatives by them.

use super::Parameter;
use super::part::Part;
use super::setup::Setup;
use crate::Error;
use crate::model::{Command, Robot};
use crate::statics::{self, Input, Workspace};
use crate::verify::{Acting, Experiment};
use nalgebra::{Matrix3, Vector3};

/// Step of a difference at a fixed shape, of the parameter's scale.
const STEP: f64 = 1e-4;

/// Trial values, and what all rows share.
pub(super) struct Trial<'a> {
    experiment: &'a Experiment,
    setup: Setup,
    mounted: Robot,
    acting: Vec<Vec<Acting>>,
    ways: Vec<Way>,
}

/// How a parameter moves what is measured.
enum Way {
    /// Through the robot: a little behind and ahead of its value, by a part of its scale.
    Robot(Box<[Side; 2]>, f64),
    /// Through commands alone: per row, tendons and the change of their displacement per scale.
    Commands(Vec<Vec<(usize, f64)>>),
    /// The points themselves: one offset per point, body frame, per scale.
    Points(Vec<Vector3<f64>>),
}

/// The mounted robot beside a value, and what the inputs of every row do there if it is not what they do at the value.
struct Side {
    mounted: Robot,
    acting: Option<Vec<Vec<Acting>>>,
}

/// Points of one row, bench axes, and their derivatives by every parameter, per its scale.
pub(super) struct Predicted {
    pub(super) points: Vec<Vector3<f64>>,
    /// (parameters x points)
    pub(super) derivatives: Vec<Vec<Vector3<f64>>>,
}

impl<'a> Trial<'a> {
    pub(super) fn new(
        experiment: &'a Experiment,
        parameters: &[Parameter],
        base: &Setup,
        values: &[f64],
        scale: &[f64],
    ) -> Trial<'a> {
        let setup = base.with(parameters, values);
        let (mounted, acting) = (setup.mounted(experiment), setup.acting(experiment));
        let first = experiment.robot_in(&mounted, &acting[0]);
        let way = |j: usize| {
            let lowest = parameters[j].parts[0].lowest_possible();
            // far below its scale a value that stays above 0 is its own
            let small = lowest > 0.0 && values[j] < scale[j];
            let part = if small { STEP * values[j] / scale[j] } else { STEP };
            let beside = |side: f64| {
                // where a value may not be negative the difference moves inside
                let step = part * scale[j];
                let middle = values[j].max(lowest + step);
                let mut values = values.to_vec();
                values[j] = middle + side * step;
                base.with(parameters, &values)
            };
            let parts = &parameters[j].parts;
            match parts[0] {
                Part::MarkerOffset { .. } => Way::Points(offsets(experiment, parts, scale[j])),
                Part::Home { .. } => Way::Commands(vec![homes(&first, parts, scale[j]); acting.len()]),
                Part::Backlash { .. } => Way::Commands(turns(
                    experiment,
                    &beside(-1.0).acting(experiment),
                    &beside(1.0).acting(experiment),
                )),
                Part::MassOffset { .. } => {
                    let side = |side| {
                        let beside = beside(side);
                        Side { mounted: beside.mounted(experiment), acting: Some(beside.acting(experiment)) }
                    };
                    Way::Robot(Box::new([-1.0, 1.0].map(side)), part)
                }
                _ => {
                    let side = |side| Side { mounted: beside(side).mounted(experiment), acting: None };
                    Way::Robot(Box::new([-1.0, 1.0].map(side)), part)
                }
            }
        };
        let ways = (0..parameters.len()).map(way).collect();
        Trial { experiment, setup, mounted, acting, ways }
    }

    /// Solves a row and differentiates it, theory (38) to (42).
    pub(super) fn row(
        &self,
        row: usize,
        settings: &statics::Settings,
        workspace: &mut Workspace,
    ) -> Result<Predicted, Error> {
        let Trial { experiment, setup, acting, .. } = self;
        let robot = experiment.robot_in(&self.mounted, &acting[row]);
        statics::solve_near(&robot, settings, workspace)?;
        let points = points_of(experiment, setup, &robot, workspace)?;
        let places: Vec<f64> =
            experiment.points.iter().map(|point| experiment.place(point.at, &robot)).collect();
        let turned = |i: usize| {
            workspace.station(&robot, places[i]).map_or_else(Matrix3::identity, |station| station.rotation)
        };
        let rotations: Vec<Matrix3<f64>> = (0..places.len()).map(turned).collect();

        // one more right-hand side for every parameter of the robot and every tendon that is moved
        let robots: Vec<([Robot; 2], f64)> =
            self.ways.iter().filter_map(|way| self.beside(row, way)).collect();
        let moved = self.moved(row);
        let mut inputs: Vec<Input> = moved.iter().map(|tendon| Input::Command(*tendon)).collect();
        let beside = robots.iter();
        inputs.extend(beside.map(|([behind, ahead], step)| Input::Parameter { behind, ahead, step: *step }));
        let found = statics::derivatives(&robot, workspace, &places, &inputs)?;
        let inverse = experiment.axes.rotation.inverse();
        let point = |derivative: &crate::solution::Derivative, i: usize| {
            let (pose, offset) = (&derivative.poses[i], rotations[i] * setup.marker_offsets[i]);
            inverse * (pose.position + pose.rotation.cross(&offset))
        };
        let mut of_robots = found[moved.len()..].iter();
        let derivatives = self.ways.iter().map(|way| match way {
            Way::Robot(..) => {
                let derivative = of_robots.next();
                let of = |i| derivative.map_or_else(Vector3::zeros, |derivative| point(derivative, i));
                (0..places.len()).map(of).collect()
            }
            Way::Commands(rows) => {
                let mut sum = vec![Vector3::zeros(); places.len()];
                for (tendon, change) in &rows[row] {
                    let Some(k) = moved.iter().position(|other| other == tendon) else { continue };
                    sum.iter_mut().enumerate().for_each(|(i, sum)| *sum += *change * point(&found[k], i));
                }
                sum
            }
            Way::Points(offsets) => offsets
                .iter()
                .zip(&rotations)
                .map(|(offset, rotation)| inverse * (rotation * offset))
                .collect(),
        });
        Ok(Predicted { derivatives: derivatives.collect(), points })
    }

    /// The robots on both sides of a parameter in a row, and how far away.
    fn beside(&self, row: usize, way: &Way) -> Option<([Robot; 2], f64)> {
        let Way::Robot(sides, part) = way else { return None };
        let robot = |Side { mounted, acting }: &Side| {
            self.experiment.robot_in(mounted, &acting.as_ref().unwrap_or(&self.acting)[row])
        };
        Some(([robot(&sides[0]), robot(&sides[1])], *part))
    }

    /// Tendons whose displacement a parameter changes in a row.
    fn moved(&self, row: usize) -> Vec<usize> {
        let mut moved: Vec<usize> = Vec::new();
        for way in &self.ways {
            let Way::Commands(rows) = way else { continue };
            moved.extend(rows[row].iter().map(|(tendon, _)| *tendon));
        }
        moved.sort_unstable();
        moved.dedup();
        moved
    }
}

fn offsets(experiment: &Experiment, parts: &[Part], scale: f64) -> Vec<Vector3<f64>> {
    let mut offsets = vec![Vector3::zeros(); experiment.points.len()];
    for part in parts {
        if let Part::MarkerOffset { point, axis } = *part {
            offsets[point][axis] = scale;
        }
    }
    offsets
}

/// A tendon that is held is pulled in farther by as much as its home moves.
fn homes(robot: &Robot, parts: &[Part], scale: f64) -> Vec<(usize, f64)> {
    let held = |tendon: &usize| matches!(robot.actuation[*tendon], Command::Displacement { .. });
    let tendons = parts.iter().filter_map(|part| match *part {
        Part::Home { tendon } => Some(tendon),
        _ => None,
    });
    tendons.filter(held).map(|tendon| (tendon, scale)).collect()
}

/// Per row, tendons whose drive the backlash holds back, and by how much per scale.
fn turns(experiment: &Experiment, behind: &[Vec<Acting>], ahead: &[Vec<Acting>]) -> Vec<Vec<(usize, f64)>> {
    let row = |(behind, ahead): (&Vec<Acting>, &Vec<Acting>)| {
        let change = |i: usize| (ahead[i].value - behind[i].value) / (2.0 * STEP);
        let tendon = |i: usize| Some((experiment.inputs[i].quantity.tendon()?, change(i)));
        (0..experiment.inputs.len()).filter_map(tendon).filter(|(_, change)| *change != 0.0).collect()
    };
    behind.iter().zip(ahead).map(row).collect()
}

/// Marked points of the solution in the workspace, bench axes.
pub(super) fn points_of(
    experiment: &Experiment,
    setup: &Setup,
    robot: &Robot,
    workspace: &Workspace,
) -> Result<Vec<Vector3<f64>>, Error> {
    let points = experiment.points.iter().zip(&setup.marker_offsets);
    points
        .map(|(point, offset)| {
            let station = workspace.station(robot, experiment.place(point.at, robot));
            let station = station
                .ok_or_else(|| Error::new(format!("no point at s = {} m on this backbone", point.at)))?;
            Ok(experiment.to_bench(&(station.position + station.rotation * offset)))
        })
        .collect()
}
