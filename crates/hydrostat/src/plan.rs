//! Which measurements would tell most about parameters that are free.

mod candidates;
mod exchange;
mod verdict;

use crate::Error;
use crate::calibrate::{
    Expected, LEAST_INFLUENCE, Parameter, Problem, expected, judged, sensitivities, start,
};
use crate::statics::Settings;
use crate::verify::{Experiment, Input, Row};
use candidates::{Candidate, candidates};
use exchange::{Criterion, Information};
use nalgebra::{DMatrix, Vector3};

/// What is free, what was measured, and what could be.
#[derive(Clone, Debug)]
pub struct Request {
    pub problem: Problem,
    /// Of every input of the experiment, in its order, then of what else may be varied.
    pub limits: Vec<Limit>,
    /// How many rows to plan.
    pub measurements: usize,
    /// How often the same row may be planned; at least 1.
    pub repeats: usize,
    /// Of the random candidates, where there are too many inputs for a grid.
    pub seed: u64,
}

/// An input and what it may be set to.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    pub input: Input,
    pub choice: Choice,
}

/// Values that an input may take, SI.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    /// Any between two.
    Range([f64; 2]),
    /// Those that there are, such as weights; at least one.
    Values(Vec<f64>),
}

impl Choice {
    /// The lowest and the highest value.
    pub fn range(&self) -> [f64; 2] {
        match self {
            Choice::Range(range) => *range,
            Choice::Values(values) => [
                values.iter().copied().fold(f64::INFINITY, f64::min),
                values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            ],
        }
    }
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
    /// How many times as large as stated the reading errors are taken to be: what the fit to the rows at hand finds, else 1.
    pub error_scale: f64,
    /// Half a 95 % interval over its standard error: now, after the D-optimal rows, and after the A-optimal ones; None as in [`Expected`].
    pub quantiles: [Option<f64>; 3],
    /// In words: what is won, what stays undetermined, what it rests on.
    pub verdict: Vec<String>,
    /// In words: what to doubt before any row is measured.
    pub warnings: Vec<String>,
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
    /// The one that tells most first; fewer than asked for where candidates run out.
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
/// Nothing free, impossible limits, no candidate that can be measured; a row at hand that cannot be solved, or whose reading is impossible
/// or probably in a wrong unit.
pub fn plan(request: &Request, settings: &Settings) -> Result<Plan, Error> {
    check(request)?;
    let problem = &request.problem;
    let measured = sensitivities(problem, settings)?.1;
    let (candidates, left_out) = candidates(request, settings)?;
    let scale = scale(problem)?;
    let read = Reading::of(problem, &measured, &scale, settings)?;
    let errors: Vec<f64> =
        reading_errors(&problem.experiment).iter().map(|error| error * read.scale).collect();
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

    let now = expected(problem, &measured, read.scale)?;
    let design = |criterion: Criterion| -> Result<(Design, Expected), Error> {
        let chosen = information.choose(criterion, request.measurements, request.repeats);
        let rows: Vec<&Candidate> = chosen.iter().map(|&k| &candidates[k]).collect();
        let after = after(problem, &measured, &rows, read.scale)?;
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
        error_scale: read.scale,
        quantiles: [now.quantile, after_d.quantile, after_a.quantile],
        verdict: Vec::new(),
        warnings: problem.moved_starts()?,
    };
    plan.warnings.extend(read.doubt);
    plan.verdict = verdict::verdict(request, &plan, after_d.told_apart, &read.why, settings)?;
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
    if request.repeats == 0 {
        return Err(Error::new("found 0 repeats of a row, expected 1 at least"));
    }
    request.problem.refuse_start_outside()?;
    request.problem.experiment.refuse_impossible_readings()?;
    for Limit { input, choice } in &request.limits {
        let [low, high] = choice.range();
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

/// What a fit would know with these rows as well.
fn after(
    problem: &Problem,
    measured: &DMatrix<f64>,
    rows: &[&Candidate],
    error_scale: f64,
) -> Result<Expected, Error> {
    let mut longer = problem.clone();
    let mut jacobian = measured.clone();
    for candidate in rows {
        let first = jacobian.nrows();
        jacobian = jacobian.insert_rows(first, candidate.jacobian.nrows(), 0.0);
        jacobian.rows_mut(first, candidate.jacobian.nrows()).copy_from(&candidate.jacobian);
        let inputs = candidate.row.inputs[..longer.experiment.inputs.len()].to_vec();
        longer.experiment.rows.push(Row { inputs, observed: candidate.row.predicted.clone() });
    }
    expected(&longer, &jacobian, error_scale)
}

/// How large reading errors are taken to be.
struct Reading {
    /// Times the stated ones.
    scale: f64,
    /// Why so, as the end of a sentence.
    why: String,
    /// A fit to the rows at hand that has failed.
    doubt: Option<String>,
}

impl Reading {
    /// As a fit to the rows at hand finds them, of what shows there; as stated where there is none.
    fn of(
        problem: &Problem,
        measured: &DMatrix<f64>,
        scale: &[f64],
        settings: &Settings,
    ) -> Result<Reading, Error> {
        let shown = shown_at_hand(problem, measured, scale);
        if shown.parameters.is_empty() {
            return Ok(Reading::stated("since the rows at hand show nothing of what is free"));
        }
        let found = match shown.check() {
            Ok(()) => judged(&shown, settings, &mut |_| ())?,
            Err(error) => Err(error),
        };
        Ok(match found {
            Ok(found) if found.chance.is_none() => {
                Reading::stated("since the rows at hand leave nothing to judge it by")
            }
            Ok(found) if found.error_scale > 1.0 => Reading {
                scale: found.error_scale,
                why: format!(
                    "errors {:.1} times the stated reading error, as the fit to the {} rows at hand finds them",
                    found.error_scale,
                    shown.experiment.rows.len()
                ),
                doubt: None,
            },
            Ok(_) => Reading::stated("which the fit to the rows at hand does not refute"),
            Err(error) => Reading {
                doubt: Some(format!(
                    "The rows at hand have no fit, and reading errors are taken as stated: {}.",
                    error.message()
                )),
                ..Reading::stated("since the rows at hand have no fit")
            },
        })
    }

    fn stated(why: &str) -> Reading {
        Reading { scale: 1.0, why: format!("the reading error as stated, {why}"), doubt: None }
    }
}

/// The problem at hand, with what shows there alone free.
fn shown_at_hand(problem: &Problem, measured: &DMatrix<f64>, scale: &[f64]) -> Problem {
    let errors = reading_errors(&problem.experiment);
    let shows = |j: usize| {
        let column = measured.column(j);
        let seen = column.iter().enumerate().map(|(k, d)| (d * scale[j] / errors[k % errors.len()]).powi(2));
        seen.sum::<f64>().sqrt() >= LEAST_INFLUENCE
    };
    let parameters = problem.parameters.iter().enumerate();
    let shown = parameters.filter(|(j, parameter)| parameter.prior.is_some() || shows(*j));
    let parameters = shown.map(|(_, parameter)| parameter.clone()).collect();
    Problem { parameters, starts: 1, folds: 0, holdout: Vec::new(), ..problem.clone() }
}
