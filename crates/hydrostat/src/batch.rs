//! Many commands of one robot, on all cores.
//!
//! Rows are solved in chunks of a fixed size, each in memory of its own, so that the answers are the same to the last bit
//! whatever the number of threads. Within a chunk a row starts from the shape of the row before, if no cross-section turns
//! further than in a load step and the shape is stable, and from rest otherwise. The last row of a chunk that did not start
//! from rest is solved from there, too; where that finds another shape, the whole chunk is solved from rest. A branch left and
//! found again within one chunk is not seen. Where threads do not exist (wasm32) one does the work.

use crate::model::{Command, LoadKind, Pose};
use crate::statics::{self, Settings, Workspace};
use crate::{Equilibrium, Error, Robot};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What a column of commands sets; indices into the robot's tendons and loads, axes 0 to 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// N.
    Tension { tendon: usize },
    /// m.
    Displacement { tendon: usize },
    /// N, or N/m of a distributed load.
    Force { load: usize, axis: usize },
    /// N m, or N of a distributed load.
    Moment { load: usize, axis: usize },
    /// kg.
    Mass { load: usize },
}

/// Commands of one robot; what no column sets stays as the robot has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Commands {
    pub inputs: Vec<Input>,
    /// SI, row by row (rows x inputs).
    pub values: Vec<f64>,
    /// Rows that could not be read, ascending, and why; their values are not looked at.
    pub broken: Vec<(usize, Error)>,
}

/// Consecutive rows, solved.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// Index of the first row.
    pub first: usize,
    pub rows: Vec<Result<Shape, Error>>,
    /// (rows x tendons); not to be read where the row is an error.
    pub tendons: Vec<Pull>,
    /// Positions of the stations, world frame (rows x stations); not to be read where the row is an error.
    pub stations: Vec<Vector3<f64>>,
}

/// What is kept of a row's equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    pub tip: Pose,
    /// Names of the checks that fail.
    pub failed: Vec<&'static str>,
    pub stable: Option<bool>,
    /// Estimated largest error of a position, m.
    pub error_estimate: f64,
}

/// A tendon at the equilibrium, as [`crate::solution::TendonState`] has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pull {
    pub tension: f64,
    pub displacement: f64,
    pub length: f64,
    pub slack: bool,
}

/// Rows that are solved one after the other.
pub const CHUNK: usize = 64;
/// Chunks per thread between two deliveries: threads wait for each other for about half a chunk of these.
const WAVE: usize = 16;

impl Commands {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.values.len() / self.inputs.len().max(1)
    }

    fn check(&self, robot: &Robot) -> Result<(), Error> {
        let (inputs, values) = (self.inputs.len(), self.values.len());
        if inputs == 0 || values % inputs != 0 {
            return Err(Error::new(format!("{values} values of {inputs} inputs"))
                .hint("expected one input or more, and as many values in every row"));
        }
        let mut trial = robot.clone();
        self.inputs.iter().try_for_each(|input| match input.set(&mut trial, 0.0) {
            Some(()) => Ok(()),
            None => Err(Error::new(format!("the robot has nothing that {input:?} sets"))),
        })
    }
}

impl Input {
    /// Puts a value into the robot; None where the robot has no such thing.
    fn set(self, robot: &mut Robot, value: f64) -> Option<()> {
        use LoadKind::{Distributed, Mass, Point};
        match self {
            Input::Tension { tendon } => {
                let command = robot.actuation.get_mut(tendon)?;
                *command = Command::Tension { tension: value, motion: command.motion() };
            }
            Input::Displacement { tendon } => {
                let command = robot.actuation.get_mut(tendon)?;
                *command = Command::Displacement { displacement: value, motion: command.motion() };
            }
            Input::Force { load, axis } => match &mut robot.loads.get_mut(load)?.kind {
                Point { force: vector, .. } | Distributed { force_per_length: vector, .. } => {
                    *vector.get_mut(axis)? = value;
                }
                Mass { .. } => return None,
            },
            Input::Moment { load, axis } => match &mut robot.loads.get_mut(load)?.kind {
                Point { moment: vector, .. } | Distributed { moment_per_length: vector, .. } => {
                    *vector.get_mut(axis)? = value;
                }
                Mass { .. } => return None,
            },
            Input::Mass { load } => match &mut robot.loads.get_mut(load)?.kind {
                Mass { mass, .. } => *mass = value,
                Point { .. } | Distributed { .. } => return None,
            },
        }
        Some(())
    }
}

/// Solves every row and gives the chunks to `take`, in order. `stop` is asked before each chunk; once it says yes, no
/// further one is begun, and those that have been are finished and given.
///
/// # Errors
/// Inputs that the robot does not have, or impossible settings. A row that fails is an error of its own in its chunk.
pub fn solve_many(
    robot: &Robot,
    commands: &Commands,
    settings: &Settings,
    stop: impl Fn() -> bool + Sync,
    mut take: impl FnMut(Chunk),
) -> Result<(), Error> {
    commands.check(robot)?;
    settings.check()?;
    let chunks = commands.rows().div_ceil(CHUNK);
    let wave = WAVE * rayon::current_num_threads();
    for from in (0..chunks).step_by(wave) {
        // begun in order, so that nothing is missing between those that are done
        let next = AtomicUsize::new(from);
        let solve = |_| {
            let begin = || next.fetch_add(1, Ordering::Relaxed) * CHUNK;
            (!stop()).then(|| solve_chunk(robot, commands, settings, begin()))
        };
        let range = from..chunks.min(from + wave);
        let all = range.len();
        let mut solved: Vec<Chunk> = range.into_par_iter().with_max_len(1).filter_map(solve).collect();
        solved.sort_by_key(|chunk| chunk.first);
        let stopped = solved.len() < all;
        solved.into_iter().for_each(&mut take);
        if stopped {
            break;
        }
    }
    Ok(())
}

fn solve_chunk(robot: &Robot, commands: &Commands, settings: &Settings, first: usize) -> Chunk {
    let warm = try_chunk(robot, commands, settings, first, Start::Previous);
    warm.unwrap_or_else(|| {
        try_chunk(robot, commands, settings, first, Start::Rest).expect("from rest nothing is to be compared")
    })
}

/// Where a row's solve begins.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    Rest,
    /// The row before, if that is stable.
    Previous,
}

/// None where the last row shows that another branch than from rest was followed.
fn try_chunk(
    robot: &Robot,
    commands: &Commands,
    settings: &Settings,
    first: usize,
    start: Start,
) -> Option<Chunk> {
    let mut robot = robot.clone();
    let mut workspace = Workspace::default();
    let end = commands.rows().min(first + CHUNK);
    let mut chunk = Chunk::with_capacity(&robot, settings, first, end - first);
    let mut stable = false;
    for row in first..end {
        let mut solve = |robot: &Robot| {
            if start == Start::Previous && stable {
                let near = statics::solve_near(robot, settings, &mut workspace);
                if near.as_ref().is_ok_and(|shape| shape.report.stable == Some(true)) {
                    return near;
                }
            }
            statics::solve_in(robot, settings, &mut workspace)
        };
        let solved = commands.put(row, &mut robot).and_then(|()| solve(&robot));
        if row + 1 == end && stable && !found_from_rest(&robot, settings, &solved, &mut workspace) {
            return None;
        }
        stable =
            start == Start::Previous && solved.as_ref().is_ok_and(|shape| shape.report.stable == Some(true));
        chunk.push(&robot, settings, solved);
    }
    Some(chunk)
}

/// Whether a shape is the one that the unloaded robot leads to; true for an error, which was tried from rest.
fn found_from_rest(
    robot: &Robot,
    settings: &Settings,
    found: &Result<Equilibrium, Error>,
    workspace: &mut Workspace,
) -> bool {
    let Ok(found) = found else { return true };
    let bare = Settings { stations: 0, ..settings.clone() };
    statics::solve_in(robot, &bare, workspace).is_ok_and(|shape| {
        let apart = (shape.tip.position - found.tip.position).norm();
        apart <= shape.report.error_estimate + found.report.error_estimate + SAME * robot.length()
    })
}

/// Two shapes closer than this, of the length, are one.
const SAME: f64 = 1e-6;

impl Commands {
    /// Puts a row into the robot.
    fn put(&self, row: usize, robot: &mut Robot) -> Result<(), Error> {
        if let Ok(at) = self.broken.binary_search_by_key(&row, |(row, _)| *row) {
            return Err(self.broken[at].1.clone());
        }
        let values = &self.values[row * self.inputs.len()..];
        for (input, &value) in self.inputs.iter().zip(values) {
            input.set(robot, value).expect("checked before the first row");
        }
        Ok(())
    }
}

impl Chunk {
    fn with_capacity(robot: &Robot, settings: &Settings, first: usize, rows: usize) -> Chunk {
        Chunk {
            first,
            rows: Vec::with_capacity(rows),
            tendons: Vec::with_capacity(rows * robot.tendons.len()),
            stations: Vec::with_capacity(rows * settings.stations),
        }
    }

    fn push(&mut self, robot: &Robot, settings: &Settings, solved: Result<Equilibrium, Error>) {
        let row = solved.map(|shape| {
            self.tendons.extend(shape.tendons.iter().map(|tendon| Pull {
                tension: tendon.tension,
                displacement: tendon.displacement,
                length: tendon.length,
                slack: tendon.slack,
            }));
            self.stations.extend(shape.stations.iter().map(|station| station.position));
            Shape {
                tip: shape.tip,
                failed: shape.checks.iter().filter(|check| !check.ok).map(|check| check.name).collect(),
                stable: shape.report.stable,
                error_estimate: shape.report.error_estimate,
            }
        });
        self.rows.push(row);
        self.tendons.resize(self.rows.len() * robot.tendons.len(), Pull::default());
        self.stations.resize(self.rows.len() * settings.stations, Vector3::zeros());
    }
}
