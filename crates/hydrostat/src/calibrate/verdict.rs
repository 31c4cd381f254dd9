//! What the numbers mean, in words.

use super::neighbours::Alike;
use super::statistics::{SIGNIFICANCE, Statistics};
use super::{Calibration, Estimate, Loss, Problem, outliers, plausible};
use crate::numeric::least_squares::Evaluation;
use crate::verify::{Row, Systematic};
use nalgebra::DVector;

/// Goodness of fit, systematic residuals, prediction, what the data can tell.
pub(super) fn verdict(
    problem: &Problem,
    calibration: &Calibration,
    statistics: &Statistics,
    at: &Evaluation,
    scale: &[f64],
) -> Vec<String> {
    let mut verdict = vec![goodness(problem, calibration)];
    let stand_out = !statistics.outliers(problem, at).is_empty();
    verdict.extend(unexplained(problem, calibration, stand_out));
    verdict.push(match &calibration.left_out {
        Some(errors) => format!(
            "A row that the fit has not seen is predicted, to first order, within {:.2} mm on average ({:.2} mm at most), against \
             {:.2} mm for those that it has.",
            1e3 * errors.mean,
            1e3 * errors.max,
            1e3 * calibration.after.mean
        ),
        None => "How well an unseen row would be predicted is not known: one row alone determines a parameter.".to_owned(),
    });
    verdict.extend(calibration.folds.as_ref().map(|errors| {
        format!(
            "Rows of a part of the table that the fit has not seen are predicted within {:.2} mm on average ({:.2} mm at most).",
            1e3 * errors.mean,
            1e3 * errors.max
        )
    }));
    verdict.extend(calibration.holdout.as_ref().map(|[_, errors]| {
        format!(
            "The rows that were held out are predicted within {:.2} mm on average ({:.2} mm at most); {:.2} mm root mean square, {:.2} mm \
             about their mean.",
            1e3 * errors.mean,
            1e3 * errors.max,
            1e3 * errors.rms,
            1e3 * errors.rms_without_offset
        )
    }));
    verdict.extend(calibration.starts.clone());
    verdict.extend(identifiability(problem, statistics, at, scale));
    verdict
}

/// Whether the residuals follow an input: runs of their sign, and the likeness of neighbours, in one sentence.
pub(super) fn follows(runs: Option<Systematic>, alike: Option<Alike>) -> Option<String> {
    let Some(Alike { along, chance, .. }) = alike else { return runs.map(|found| found.sentence) };
    let sizes = format!("rows next to each other err as much alike in {} of all orders", percent(chance));
    let by_size = chance < SIGNIFICANCE;
    let Some(Systematic { is: by_sign, sentence, runs }) = runs else {
        let shown = if by_size { "is systematic" } else { "is not shown to be systematic" };
        return Some(format!("By sizes the residual {shown} with {along}: {sizes}."));
    };
    let sentence = sentence.trim_end_matches('.');
    Some(match (by_sign, by_size) {
        (true, true) => format!("{sentence}. Its sizes say the same: {sizes}."),
        (false, false) => format!("{sentence}, and its sizes do not show it either: {sizes}."),
        (true, false) => format!("{sentence}. Its signs alone show it, its sizes do not: {sizes}."),
        (false, true) => format!(
            "The residual is systematic with {along}: its signs alone do not show it ({runs}), but its sizes do: {sizes}."
        ),
    })
}

/// Rows and correlation of neighbours from which intervals count as too narrow.
const MANY_ROWS: usize = 30;
const CORRELATED: f64 = 0.3;

/// How many times as wide intervals should be that take rows to be independent where neighbours err alike, theory (54).
pub(super) fn widening(alike: &Alike, rows: usize) -> Option<f64> {
    let correlation = alike.correlation;
    let counts = rows >= MANY_ROWS && correlation > CORRELATED && alike.chance < SIGNIFICANCE;
    counts.then(|| ((1.0 + correlation) / (1.0 - correlation)).sqrt())
}

/// The same in words.
pub(super) fn narrow(alike: &Alike, rows: usize) -> Option<String> {
    let correlation = alike.correlation;
    widening(alike, rows).map(|wider| {
        format!(
            "Rows next to each other err alike (correlation {correlation:.2}), so that {rows} rows tell as much as about {:.0} that do not: \
             the intervals should be about {wider:.1} times as wide, and errors of folds or of held-out rows say more than those of single rows.",
            (rows as f64 / wider.powi(2)).max(1.0)
        )
    })
}

/// Of a fit that ended on the floor of a valley.
pub(super) const CREPT: &str = "The fit gained next to nothing in its last steps and was ended: other values along some combination of the parameters fit as well, \
    and the values are one choice among them.";

fn goodness(problem: &Problem, calibration: &Calibration) -> String {
    let Calibration { chi_square, degrees_of_freedom, error_scale, .. } = calibration;
    let Some(chance) = calibration.chance else {
        return "There are as many free parameters as coordinates: the fit is exact, and nothing is left to judge it by.".to_owned();
    };
    let test = format!(
        "chi-square {chi_square:.1} with {degrees_of_freedom} degrees of freedom, chance {}",
        percent(chance)
    );
    if chance >= SIGNIFICANCE {
        return format!(
            "The reading error explains the residuals ({test}); the intervals rest on it as stated."
        );
    }
    let loss = if problem.loss == Loss::Huber { "the bulk of the residuals" } else { "the residuals" };
    if *error_scale == 1.0 && problem.loss == Loss::Squares {
        format!(
            "The reading error explains what the data leave, but not with the priors as well ({test}): these contradict the data."
        )
    } else if *error_scale > 1.0 {
        format!(
            "The reading error does not explain the residuals ({test}): the intervals rest on {loss}, {error_scale:.1} times as \
             large, with Student's t, as if those were of chance."
        )
    } else {
        format!(
            "The reading error does not explain some of the residuals ({test}), but it does explain their bulk."
        )
    }
}

fn percent(chance: f64) -> String {
    if chance < 1e-4 { "below 0.01 %".to_owned() } else { format!("{:.2} %", 100.0 * chance) }
}

fn unexplained(problem: &Problem, calibration: &Calibration, stand_out: bool) -> Option<String> {
    let of_priors = calibration.error_scale == 1.0 && problem.loss == Loss::Squares;
    if of_priors || calibration.chance.is_none_or(|chance| chance >= SIGNIFICANCE) {
        return None;
    }
    let names: Vec<&str> = problem.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let smallest =
        problem.experiment.points.iter().map(|point| point.reading_error).fold(f64::INFINITY, f64::min);
    let on_bound = |estimate: &&Estimate| estimate.parameter.bounds.contains(&estimate.value);
    let on_bound = calibration.parameters.iter().filter(on_bound);
    let on_bound: Vec<&str> = on_bound.map(|estimate| estimate.parameter.name.as_str()).collect();
    let why = match calibration.systematic {
        _ if !on_bound.is_empty() => {
            format!("the bounds of {} keep the fit from a better one", and(&on_bound))
        }
        Some(false) | None if stand_out => {
            "single readings stand out, which the warnings name, and the others may be as exact as stated"
                .to_owned()
        }
        Some(true) => format!(
            "since the residuals are systematic, no value of {} removes that: the model or the bench has something else in it",
            and(&names)
        ),
        Some(false) => "the residuals look like chance: readings are less exact than stated".to_owned(),
        None => "whether that is systematic cannot be told from these rows".to_owned(),
    };
    Some(format!(
        "Beyond the reading error of {:.2} mm, {:.1} mm per coordinate stay unexplained; {why}.",
        1e3 * smallest,
        1e3 * calibration.unexplained
    ))
}

/// What several calibrations of one bench leave alike, where there are several and they leave something.
pub fn in_common(calibrations: &[&Calibration]) -> Option<String> {
    let unexplained = || calibrations.iter().map(|calibration| 1e3 * calibration.unexplained);
    let refuted = |calibration: &&Calibration| calibration.chance.is_some_and(|chance| chance < SIGNIFICANCE);
    if calibrations.len() < 2 || !calibrations.iter().all(refuted) {
        return None;
    }
    let (low, high) =
        unexplained().fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    let systematic = calibrations.iter().all(|calibration| calibration.systematic == Some(true));
    let why = if systematic { ": the residuals are systematic, and not of reading" } else { "" };
    Some(format!(
        "Whichever of these is freed, {} to {} mm per coordinate ({low:.1} to {high:.1} mm) stay unexplained by the reading error{why}.",
        low.floor(),
        high.ceil()
    ))
}

/// `a, b and c`
fn and(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

/// Multiple correlations from which parameters are hardly, and not at all told apart: their errors are 3 and 7 times those of each
/// alone.
const HARDLY: f64 = 0.95;
const NOT: f64 = 0.99;
/// Part of a direction from which a parameter takes part in it.
const TAKES_PART: f64 = 0.2;
/// The change by which a direction is shown, of the parameter that changes most.
const SHOWN: f64 = 0.1;

/// Which combination the data cannot tell, theory (47).
pub(super) fn identifiability(
    problem: &Problem,
    statistics: &Statistics,
    at: &Evaluation,
    scale: &[f64],
) -> Vec<String> {
    let count = problem.parameters.len();
    if count < 2 {
        return Vec::new();
    }
    let mut sentences = Vec::new();
    for (value, direction) in &statistics.eigen {
        let members: Vec<usize> = (0..count).filter(|&j| direction[j].abs() >= TAKES_PART).collect();
        let correlation = members.iter().map(|&j| statistics.multiple_correlation(j)).fold(0.0, f64::max);
        // a well-determined direction of parameters that are badly determined in another one says nothing
        if members.len() < 2 || correlation < HARDLY || *value > 1.0 - HARDLY {
            continue;
        }
        let names: Vec<&str> = members.iter().map(|&j| problem.parameters[j].name.as_str()).collect();
        let told = match () {
            () if statistics.is_singular(*value) => {
                "cannot be told apart at all by these measurements".to_owned()
            }
            () if correlation >= NOT => {
                format!("cannot be told apart by these measurements: correlation {correlation:.3}")
            }
            () => format!("can hardly be told apart by these measurements: correlation {correlation:.2}"),
        };
        let step = DVector::from_fn(count, |j, _| direction[j] / statistics.norms[j].max(f64::MIN_POSITIVE));
        let step = &step * (SHOWN / step.amax().max(f64::MIN_POSITIVE));
        let largest = step.iamax();
        let step = &step * step[largest].signum();
        let changes: Vec<String> = members
            .iter()
            .map(|&j| {
                let text =
                    problem.parameters[j].show(step[j] * scale[j], Some(0.05 * (step[j] * scale[j]).abs()));
                format!(
                    "{} {}{text}",
                    problem.parameters[j].name,
                    if text.starts_with('-') { "" } else { "+" }
                )
            })
            .collect();
        let changes: Vec<&str> = changes.iter().map(String::as_str).collect();
        let moved = (&at.jacobian * &step).rows(0, problem.coordinates()).norm()
            / (problem.coordinates() as f64).sqrt();
        sentences.push(format!(
            "{} {told}. Together {} move what was measured by only {moved:.2} standard errors (root mean square); measure what \
             separates them, or fix one, or give a prior.",
            and(&names),
            and(&changes)
        ));
    }
    if sentences.is_empty() {
        let correlation = statistics.correlation();
        let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (j, i)));
        let largest = pairs.max_by(|a, b| correlation[*a].abs().total_cmp(&correlation[*b].abs()));
        sentences.extend(largest.filter(|pair| correlation[*pair].is_finite()).map(|(i, j)| {
            format!(
                "The data tell all parameters apart; the largest correlation is {:.2}, of {} with {}.",
                correlation[(i, j)],
                problem.parameters[i].name,
                problem.parameters[j].name
            )
        }));
    }
    sentences
}

/// What to doubt: parameters, then rows, then columns.
pub(super) fn warnings(
    problem: &Problem,
    calibration: &Calibration,
    statistics: &Statistics,
    at: &Evaluation,
    held: &[bool],
) -> Vec<String> {
    let mut warnings = Vec::new();
    for (estimate, held) in calibration.parameters.iter().zip(held) {
        if *held {
            warnings.push(format!(
                "{} lies on its bound, {}: the data ask for a value beyond it, and it has no interval.",
                estimate.parameter.name,
                estimate.parameter.show(estimate.value, None)
            ));
        }
        warnings.extend(cut(estimate));
        warnings.extend(plausible::doubts(problem, estimate));
    }
    warnings.extend(outliers::sentences(problem, &statistics.outliers(problem, at)));
    warnings.extend(repeated_rows(problem));
    warnings.extend(same_inputs(problem));
    warnings.extend(constant_columns(problem, calibration));
    warnings
}

/// An interval that ends at a bound.
fn cut(estimate: &Estimate) -> Option<String> {
    let Estimate { parameter, standard_error, interval_95, cut, .. } = estimate;
    let ends = interval_95.iter().flatten().zip(cut).filter(|(_, cut)| **cut);
    let ends: Vec<String> = ends.map(|(end, _)| parameter.show(*end, *standard_error)).collect();
    (!ends.is_empty()).then(|| {
        format!(
            "The 95 % interval of {} is cut at its bound, {}: the data alone allow values beyond it.",
            parameter.name,
            ends.join(" and ")
        )
    })
}

fn repeated_rows(problem: &Problem) -> Vec<String> {
    let rows = &problem.experiment.rows;
    let earlier = |i: usize| (0..i).find(|&j| rows[j] == rows[i]).map(|j| (j, i));
    (0..rows.len())
        .filter_map(earlier)
        .map(|(j, i)| {
            format!(
                "row {} repeats row {} to the last digit: if it is no measurement of its own, the intervals are too narrow.",
                i + 1,
                j + 1
            )
        })
        .collect()
}

/// Reading errors by which a prediction moves while its reading stays.
const MOVES: f64 = 5.0;

/// Rows that differ in what was read alone.
fn same_inputs(problem: &Problem) -> Option<String> {
    let experiment = &problem.experiment;
    let (first, others) = experiment.rows.split_first()?;
    let differs = |row: &Row| {
        let points = experiment.points.iter().zip(row.observed.iter().zip(&first.observed));
        let mut off =
            points.flat_map(|(point, (a, b))| point.axes.iter().map(move |&i| (a[i] - b[i], point)));
        off.any(|(off, point)| off.abs() > MOVES * point.reading_error)
    };
    let same = others.iter().all(|row| row.inputs == first.inputs);
    (same && others.iter().any(differs)).then(|| {
        format!(
            "All rows have the same inputs ({}), and other readings: is that column what was set?",
            experiment.inputs_of(first)
        )
    })
}

fn constant_columns(problem: &Problem, calibration: &Calibration) -> Vec<String> {
    let mut sentences = Vec::new();
    for (i, point) in problem.experiment.points.iter().enumerate() {
        for &axis in &point.axes {
            let range = |of: &dyn Fn(usize) -> f64| {
                let values = (0..calibration.rows.len()).map(of);
                let (low, high) =
                    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                high - low
            };
            let observed = range(&|k| calibration.rows[k].before[i].observed[axis]);
            let predicted = range(&|k| calibration.rows[k].before[i].predicted[axis]);
            if calibration.rows.len() > 1 && observed == 0.0 && predicted > MOVES * point.reading_error {
                sentences.push(format!(
                    "The {} of the point at {:.0} mm reads the same in every row, where the model moves it by {:.1} mm: is that column \
                     a measurement?",
                    ["x", "y", "z"][axis],
                    1e3 * point.at,
                    1e3 * predicted
                ));
            }
        }
    }
    sentences
}
