//! What could be measured within the limits.

use super::{Choice, PlannedRow, Request};
use crate::Error;
use crate::calibrate::{Problem, sensitivities};
use crate::numeric::random::Random;
use crate::statics::{Settings, solve};
use crate::verify::Row;
use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

/// A row that could be measured, and its derivatives, SI (coordinates x parameters).
pub(super) struct Candidate {
    pub(super) row: PlannedRow,
    pub(super) jacobian: DMatrix<f64>,
}

/// Candidates of a grid, at most; random ones where it would have more.
const GRID: usize = 400;
/// Values of an input between limits on a grid: fewer see no curvature, more are hard to tell apart on a bench.
const LEVELS: [usize; 2] = [3, 21];
/// Draws; equal ones are one candidate.
const RANDOM: usize = 400;

/// All combinations of the values of a list and of evenly spaced ones between limits, or random ones that often lie on the limits; no two
/// alike.
fn inputs(request: &Request) -> Vec<Vec<f64>> {
    let choices: Vec<&Choice> = request.limits.iter().map(|limit| &limit.choice).collect();
    let size = |levels: usize| {
        let mut counts = choices.iter().map(|choice| choice.count(levels));
        counts.try_fold(1_usize, usize::checked_mul).unwrap_or(usize::MAX)
    };
    let Some(levels) = (LEVELS[0]..=LEVELS[1]).rev().find(|levels| size(*levels) <= GRID) else {
        let mut random = Random::new(request.seed, 0);
        let mut drawn: Vec<Vec<f64>> = Vec::new();
        for _ in 0..RANDOM {
            let row: Vec<f64> = choices.iter().map(|choice| choice.draw(&mut random)).collect();
            if !drawn.contains(&row) {
                drawn.push(row);
            }
        }
        return drawn;
    };
    let mut all: Vec<Vec<f64>> = vec![Vec::new()];
    for choice in choices {
        let longer = |row: &Vec<f64>| {
            let value = |i| [&row[..], &[choice.level(i, levels)]].concat();
            (0..choice.count(levels)).map(value).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}

impl Choice {
    /// Values on a grid of so many levels.
    fn count(&self, levels: usize) -> usize {
        match self {
            Choice::Range([low, high]) if low < high => levels,
            Choice::Range(_) => 1,
            Choice::Values(values) => values.len(),
        }
    }

    fn level(&self, i: usize, levels: usize) -> f64 {
        match self {
            // from both ends, so that both are exact
            Choice::Range([low, high]) => {
                let part = i as f64 / (levels - 1) as f64;
                low * (1.0 - part) + high * part
            }
            Choice::Values(values) => values[i],
        }
    }

    fn draw(&self, random: &mut Random) -> f64 {
        match self {
            Choice::Range([low, high]) => match random.below(4) {
                0 => *low,
                1 => *high,
                _ => random.uniform(*low, *high),
            },
            Choice::Values(values) => values[random.below(values.len() as u64) as usize],
        }
    }
}

/// Rows within the limits that can be solved and keep the robot whole, each by itself; the others by reason.
#[allow(clippy::type_complexity, reason = "two lists")]
pub(super) fn candidates(
    request: &Request,
    settings: &Settings,
) -> Result<(Vec<Candidate>, Vec<(String, usize)>), Error> {
    let bench = bench(request);
    let observed = vec![Vector3::zeros(); bench.experiment.points.len()];
    let candidate = |inputs: Vec<f64>| -> Result<Candidate, String> {
        let one = alone(&bench, &inputs);
        let acting = one.experiment.acting().swap_remove(0);
        let robot = one.experiment.robot_in(&one.experiment.robot, &acting);
        let settings = Settings { stations: 0, eigenvalue: false, ..settings.clone() };
        let shape = solve(&robot, &settings).map_err(|_| "no equilibrium".to_owned())?;
        if let Some(check) = shape.checks.iter().find(|check| !check.ok) {
            return Err(format!("check {} fails", check.name));
        }
        let (read, jacobian) = sensitivities(&one, &settings).map_err(|_| "no derivatives".to_owned())?;
        let mut predicted = observed.clone();
        let places = one.experiment.points.iter().enumerate();
        let places = places.flat_map(|(i, point)| point.axes.iter().map(move |&axis| (i, axis)));
        for ((i, axis), value) in places.zip(read.iter()) {
            predicted[i][axis] = *value;
        }
        Ok(Candidate { row: PlannedRow { inputs, predicted }, jacobian })
    };
    let tried: Vec<Result<Candidate, String>> = inputs(request).into_par_iter().map(candidate).collect();
    let (mut found, mut left_out) = (Vec::new(), Vec::<(String, usize)>::new());
    for outcome in tried {
        match outcome {
            Ok(candidate) => found.push(candidate),
            Err(reason) => match left_out.iter_mut().find(|(other, _)| *other == reason) {
                Some((_, count)) => *count += 1,
                None => left_out.push((reason, 1)),
            },
        }
    }
    if found.is_empty() {
        let reasons: Vec<String> =
            left_out.iter().map(|(reason, count)| format!("{count} times {reason}")).collect();
        return Err(Error::new(format!("nothing within the limits can be measured: {}", reasons.join(", ")))
            .hint("narrow the limits, such as --limit \"mass=0 g to 20 g\""));
    }
    Ok((found, left_out))
}

/// The bench with everything that may be varied as an input.
pub(super) fn bench(request: &Request) -> Problem {
    let mut bench = request.problem.clone();
    bench.experiment.inputs = request.limits.iter().map(|limit| limit.input.clone()).collect();
    bench.experiment.variants.clear();
    bench.experiment.published = None;
    bench.holdout.clear();
    bench
}

/// That bench with one row, which no earlier one precedes.
pub(super) fn alone(bench: &Problem, inputs: &[f64]) -> Problem {
    let mut one = bench.clone();
    let observed = vec![Vector3::zeros(); one.experiment.points.len()];
    one.experiment.rows = vec![Row { inputs: inputs.to_vec(), observed }];
    one
}
