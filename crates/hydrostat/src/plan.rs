//! Which measurements would tell most about parameters that are free.

mod exchange;

use crate::Error;
use crate::calibrate::{Expected, Parameter, Problem, expected, sensitivities, start};
use crate::numeric::random::Random;
use crate::statics::{Settings, solve};
use crate::verify::{Experiment, Input, Row};
use exchange::{Criterion, Information};
use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

/// What is free, what was measured, and what could be.
#[derive(Clone, Debug)]
pub struct Request {
    pub problem: Problem,
    /// Of every input of the experiment, in its order, then of what else may be varied.
    pub limits: Vec<Limit>,
    /// How many rows to plan.
    pub measurements: usize,
    /// Of the random candidates, where there are too many inputs for a grid.
    pub seed: u64,
}

/// An input between two values, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    pub input: Input,
    pub range: [f64; 2],
}

/// The outcome of [`plan`].
#[derive(Clone, Debug)]
pub struct Plan {
    /// In the order of the problem.
    pub parameters: Vec<Planned>,
    /// Makes the volume of the confidence region smallest.
    pub d_optimal: Design,
    /// Makes the sum of relative variances smallest.
    pub a_optimal: Design,
    /// Candidates that could be measured, and others: reason and number.
    pub candidates: usize,
    pub left_out: Vec<(String, usize)>,
    /// Half a 95 % interval over its standard error.
    pub quantile: f64,
    /// In words: what is won, what stays undetermined, what it rests on.
    pub verdict: Vec<String>,
}

/// A parameter with its standard errors: of the rows at hand, and expected after each design; None where not determined.
#[derive(Clone, Debug)]
pub struct Planned {
    pub parameter: Parameter,
    /// That of the files, at which derivatives are taken.
    pub value: f64,
    pub now: Option<f64>,
    pub after_d: Option<f64>,
    pub after_a: Option<f64>,
}

/// Rows to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The one that tells most first; the same row may come several times, each set up anew.
    pub rows: Vec<PlannedRow>,
    /// Volume of the confidence region over that of the rows at hand; None where those leave it without end.
    pub volume: Option<f64>,
}

/// A row to measure, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRow {
    /// In the order of the limits.
    pub inputs: Vec<f64>,
    /// One per point, bench axes; axes that are not read are zero.
    pub predicted: Vec<Vector3<f64>>,
}

/// Rows that one plan may have.
const MOST_MEASUREMENTS: usize = 100;

/// Chooses rows from within the limits, theory (63) and (64), starting from the rows at hand.
///
/// # Errors
/// Nothing free, impossible limits, no candidate that can be measured; a row at hand that cannot be solved.
pub fn plan(request: &Request, settings: &Settings) -> Result<Plan, Error> {
    check(request)?;
    let problem = &request.problem;
    let measured = sensitivities(problem, settings)?.1;
    let (candidates, left_out) = candidates(request, settings)?;
    let scale = scale(problem)?;
    let errors = reading_errors(&problem.experiment);
    let priors: Vec<Option<f64>> = problem
        .parameters
        .iter()
        .zip(&scale)
        .map(|(parameter, scale)| Some(parameter.prior?.standard_error / scale))
        .collect();
    let weighted = |jacobian: &DMatrix<f64>| {
        DMatrix::from_fn(jacobian.nrows(), scale.len(), |k, j| {
            jacobian[(k, j)] * scale[j] / errors[k % errors.len()]
        })
    };
    let of_candidates: Vec<DMatrix<f64>> =
        candidates.iter().map(|candidate| weighted(&candidate.jacobian)).collect();
    let information = Information::new(&weighted(&measured), &priors, &of_candidates);

    let now = expected(problem, &measured)?;
    let design = |criterion: Criterion| -> Result<(Design, Expected), Error> {
        let chosen = information.choose(criterion, request.measurements);
        let rows: Vec<&Candidate> = chosen.iter().map(|&k| &candidates[k]).collect();
        let after = after(problem, &measured, &rows)?;
        let design = Design {
            volume: now.standard_errors.iter().all(Option::is_some).then(|| information.volume(&chosen)),
            rows: rows.into_iter().map(|candidate| candidate.row.clone()).collect(),
        };
        Ok((design, after))
    };
    let (d_optimal, after_d) = design(Criterion::Determinant)?;
    let (a_optimal, after_a) = design(Criterion::Trace)?;

    let values = start(problem)?;
    let parameters = problem.parameters.iter().enumerate().map(|(j, parameter)| Planned {
        parameter: parameter.clone(),
        value: values[j],
        now: now.standard_errors[j],
        after_d: after_d.standard_errors[j],
        after_a: after_a.standard_errors[j],
    });
    let mut plan = Plan {
        parameters: parameters.collect(),
        d_optimal,
        a_optimal,
        candidates: candidates.len(),
        left_out,
        quantile: now.quantile,
        verdict: Vec::new(),
    };
    plan.verdict = verdict(request, &plan, after_d.told_apart);
    Ok(plan)
}

fn check(request: &Request) -> Result<(), Error> {
    if request.problem.parameters.is_empty() {
        return Err(Error::new("nothing is free, so that there is nothing to plan for"));
    }
    if !(1..=MOST_MEASUREMENTS).contains(&request.measurements) {
        return Err(Error::new(format!(
            "found {} measurements to plan, expected 1 to {MOST_MEASUREMENTS}",
            request.measurements
        )));
    }
    for Limit { input, range: [low, high] } in &request.limits {
        if !(low <= high && low.is_finite() && high.is_finite()) {
            return Err(Error::new(format!(
                "the limits of {} are {} to {} {}, expected the lower one first",
                input.column,
                low / input.unit.1,
                high / input.unit.1,
                input.unit.0
            )));
        }
    }
    Ok(())
}

/// A change of each parameter that matters.
fn scale(problem: &Problem) -> Result<Vec<f64>, Error> {
    let values = start(problem)?;
    let pairs = problem.parameters.iter().zip(values);
    Ok(pairs.map(|(parameter, value)| parameter.parts[0].scale(&problem.experiment, value)).collect())
}

/// Of one row, per coordinate.
fn reading_errors(experiment: &Experiment) -> Vec<f64> {
    let points = experiment.points.iter();
    points.flat_map(|point| point.axes.iter().map(|_| point.reading_error)).collect()
}

/// A row that could be measured, and its derivatives, SI (coordinates x parameters).
struct Candidate {
    row: PlannedRow,
    jacobian: DMatrix<f64>,
}

/// Candidates of a grid, at most.
const GRID: usize = 400;
/// Fewest values of an input on a grid, and random candidates where there would be fewer.
const LEVELS: usize = 3;
const RANDOM: usize = 400;

/// All combinations of evenly spaced values between the limits, or random ones that often lie on them.
fn inputs(request: &Request) -> Vec<Vec<f64>> {
    let ranges: Vec<[f64; 2]> = request.limits.iter().map(|limit| limit.range).collect();
    let free = ranges.iter().filter(|[low, high]| low < high).count();
    let levels = match free {
        0 => 1,
        _ => (1..=GRID)
            .rev()
            .find(|levels| levels.checked_pow(free as u32).is_some_and(|n| n <= GRID))
            .unwrap_or(1),
    };
    if free > 0 && levels < LEVELS {
        let mut random = Random::new(request.seed, 0);
        let value = |random: &mut Random, [low, high]: [f64; 2]| match random.below(4) {
            0 => low,
            1 => high,
            _ => random.uniform(low, high),
        };
        return (0..RANDOM)
            .map(|_| ranges.iter().map(|range| value(&mut random, *range)).collect())
            .collect();
    }
    let mut all: Vec<Vec<f64>> = vec![Vec::new()];
    for [low, high] in ranges {
        // from both ends, so that both are exact
        let at = |i: usize| {
            let part = i as f64 / (levels - 1).max(1) as f64;
            low * (1.0 - part) + high * part
        };
        let count = if low < high { levels } else { 1 };
        let longer = |row: &Vec<f64>| (0..count).map(|i| [&row[..], &[at(i)]].concat()).collect::<Vec<_>>();
        all = all.iter().flat_map(longer).collect();
    }
    all
}

/// Rows within the limits that can be solved and keep the robot whole, each by itself; the others by reason.
#[allow(clippy::type_complexity, reason = "two lists")]
fn candidates(
    request: &Request,
    settings: &Settings,
) -> Result<(Vec<Candidate>, Vec<(String, usize)>), Error> {
    let problem = &request.problem;
    let mut bench = problem.clone();
    bench.experiment.inputs = request.limits.iter().map(|limit| limit.input.clone()).collect();
    bench.experiment.variants.clear();
    bench.experiment.published = None;
    bench.holdout.clear();
    let observed = vec![Vector3::zeros(); bench.experiment.points.len()];
    let candidate = |inputs: Vec<f64>| -> Result<Candidate, String> {
        let mut one = bench.clone();
        one.experiment.rows = vec![Row { inputs: inputs.clone(), observed: observed.clone() }];
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

/// What a fit would know with these rows as well.
fn after(problem: &Problem, measured: &DMatrix<f64>, rows: &[&Candidate]) -> Result<Expected, Error> {
    let mut longer = problem.clone();
    let mut jacobian = measured.clone();
    for candidate in rows {
        let first = jacobian.nrows();
        jacobian = jacobian.insert_rows(first, candidate.jacobian.nrows(), 0.0);
        jacobian.rows_mut(first, candidate.jacobian.nrows()).copy_from(&candidate.jacobian);
        let inputs = candidate.row.inputs[..longer.experiment.inputs.len()].to_vec();
        longer.experiment.rows.push(Row { inputs, observed: candidate.row.predicted.clone() });
    }
    expected(&longer, &jacobian)
}

/// Ratio of the A-optimal to the D-optimal standard error from which the two designs are worth telling apart.
const DIFFERS: f64 = 1.05;
/// Part of a standard error that the plan must take away to be worth its work.
const WORTH: f64 = 0.1;

fn verdict(request: &Request, plan: &Plan, told_apart: Vec<String>) -> Vec<String> {
    let mut sentences = vec![gain(plan)];
    let undetermined: Vec<&str> = plan
        .parameters
        .iter()
        .filter(|planned| planned.after_d.is_none() && planned.after_a.is_none())
        .map(|planned| planned.parameter.name.as_str())
        .collect();
    if !undetermined.is_empty() {
        sentences.push(format!(
            "Nothing within the limits determines {}: widen them, vary something else, mark another point, or give a prior.",
            undetermined.join(", ")
        ));
    }
    sentences.extend(told_apart);
    sentences.push(if same_rows(&plan.d_optimal, &plan.a_optimal) {
        "Both criteria choose the same rows.".to_owned()
    } else {
        let worse =
            plan.parameters.iter().filter_map(|p| Some((p.parameter.name.as_str(), p.after_d? / p.after_a?)));
        let named: Vec<String> = worse
            .filter(|(_, ratio)| *ratio > DIFFERS || *ratio < 1.0 / DIFFERS)
            .map(|(name, ratio)| format!("{name} is known {ratio:.2} times as well"))
            .collect();
        if named.is_empty() {
            "The two criteria choose other rows, which tell about as much of every parameter.".to_owned()
        } else {
            format!("After the A-optimal rows instead of the D-optimal ones, {}.", named.join(", "))
        }
    });
    sentences.push(assumptions(request));
    sentences
}

fn gain(plan: &Plan) -> String {
    let newly: Vec<&str> = plan
        .parameters
        .iter()
        .filter(|planned| planned.now.is_none() && planned.after_d.is_some())
        .map(|planned| planned.parameter.name.as_str())
        .collect();
    let falls: Vec<(f64, &str)> = plan
        .parameters
        .iter()
        .filter_map(|planned| Some((planned.after_d? / planned.now?, planned.parameter.name.as_str())))
        .collect();
    let mut text = String::new();
    if !newly.is_empty() {
        text += &format!("The planned rows determine {}, which the rows at hand do not. ", newly.join(", "));
    }
    let best = falls.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((ratio, name)) if *ratio < 1.0 - WORTH => {
            text += &format!(
                "They take most from the standard error of {name}: {:.0} % of it are left.",
                100.0 * ratio
            );
        }
        Some((ratio, name)) => {
            text += &format!(
                "They change little: {:.0} % of the standard error of {name} are left, and more of all others. Wider limits or something \
                 else to vary would help more than such rows.",
                100.0 * ratio
            );
        }
        None => {}
    }
    text.trim_end().replace("They", if newly.is_empty() { "The planned rows" } else { "They" })
}

fn same_rows(a: &Design, b: &Design) -> bool {
    let sorted = |design: &Design| {
        let mut rows: Vec<Vec<f64>> = design.rows.iter().map(|row| row.inputs.clone()).collect();
        rows.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        rows
    };
    sorted(a) == sorted(b)
}

fn assumptions(request: &Request) -> String {
    let points = &request.problem.experiment.points;
    let mut errors: Vec<String> =
        points.iter().map(|point| format!("{:.2} mm", 1e3 * point.reading_error)).collect();
    errors.dedup();
    let memory = request.limits.iter().any(|limit| limit.input.quantity.tendon().is_some());
    let memory = if memory {
        " Each planned row is taken by itself, tendons pulled to it from rest, without backlash or friction of an earlier row."
    } else {
        ""
    };
    format!(
        "This rests on derivatives at the values of the files, on the reading error as stated ({}), and on a model that is right: where \
         calibrate finds larger residuals, all intervals grow by its factor, now and after.{memory}",
        errors.join(", ")
    )
}
