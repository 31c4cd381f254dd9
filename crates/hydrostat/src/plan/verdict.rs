//! What a plan means, in words.

use super::candidates::{alone, bench};
use super::{Design, Plan, Request};
use crate::Error;
use crate::calibrate::{predict, sensitivities};
use crate::statics::Settings;

/// Ratio of the A-optimal to the D-optimal standard error from which the two designs are worth telling apart.
const DIFFERS: f64 = 1.05;
/// Part of a standard error that the plan must take away to be worth its work.
const WORTH: f64 = 0.1;

pub(super) fn verdict(
    request: &Request,
    plan: &Plan,
    told_apart: Vec<String>,
    errors: &str,
    settings: &Settings,
) -> Result<Vec<String>, Error> {
    let mut sentences = vec![gain(plan)];
    let planned = plan.d_optimal.rows.len();
    if planned < request.measurements {
        let each =
            if request.repeats == 1 { "once".to_owned() } else { format!("{} times", request.repeats) };
        sentences.push(format!(
            "Only {planned} of {} rows are planned: with each taken {each} at most, there are no more candidates. Allow more repeats, or \
             more values.",
            request.measurements
        ));
    }
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
    let told_apart = told_apart.into_iter().map(|sentence| format!("After the D-optimal rows: {sentence}"));
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
    sentences.extend(without_intervals(plan));
    sentences.extend(curved(request, plan, settings)?);
    sentences.push(assumptions(request, errors));
    Ok(sentences)
}

fn without_intervals(plan: &Plan) -> Option<String> {
    let times = ["now", "after the D-optimal rows", "after the A-optimal rows"];
    let missing = times.into_iter().zip(plan.quantiles).filter(|(_, quantile)| quantile.is_none());
    let missing: Vec<&str> = missing.map(|(time, _)| time).collect();
    (!missing.is_empty()).then(|| {
        format!(
            "No 95 % interval is known {}: errors are larger than stated, and as many parameters as coordinates leave nothing to tell by how \
             much.",
            missing.join(" and ")
        )
    })
}

/// Part of a first-order change by which the true one may differ.
const CURVED: f64 = 0.2;

/// Planned rows that answer otherwise than their derivatives say when a parameter is off by its present standard error.
fn curved(request: &Request, plan: &Plan, settings: &Settings) -> Result<Vec<String>, Error> {
    let bench = bench(request);
    let mut rows: Vec<&[f64]> = Vec::new();
    for row in plan.d_optimal.rows.iter().chain(&plan.a_optimal.rows) {
        if !rows.contains(&row.inputs.as_slice()) {
            rows.push(&row.inputs);
        }
    }
    let mut sentences = Vec::new();
    for inputs in rows {
        let one = alone(&bench, inputs);
        let (here, jacobian) = sensitivities(&one, settings)?;
        for (j, planned) in plan.parameters.iter().enumerate() {
            let Some(error) = planned.now.or(planned.after_d) else { continue };
            let first_order = jacobian.column(j) * error;
            let seen = one.experiment.points.iter().map(|p| p.reading_error).fold(f64::INFINITY, f64::min);
            let true_change = predict(&one, j, planned.value + error, settings).map(|there| there - &here);
            let off = true_change.as_ref().map_or(f64::INFINITY, |change| (change - &first_order).norm());
            if off > seen && off > CURVED * first_order.norm() {
                let does = match true_change {
                    Ok(change) => format!("moves it by {:.1} mm", 1e3 * change.norm()),
                    Err(_) => "leaves it without equilibrium".to_owned(),
                };
                sentences.push(format!(
                    "Doubt the row {}: its derivatives do not hold as far as {} is known now: one standard error more {does}, where to first \
                     order it is {:.1} mm. Narrow the limits, or measure the other rows, calibrate, and plan again.",
                    one.experiment.inputs_of(&one.experiment.rows[0]),
                    planned.parameter.name,
                    1e3 * first_order.norm()
                ));
            }
        }
    }
    Ok(sentences)
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
                "They take most from the standard error of {name}: {:.0} % of it is left.",
                100.0 * ratio
            );
        }
        Some((ratio, name)) => {
            text += &format!(
                "They change little: {:.0} % of the standard error of {name} is left{}. Wider limits or something else to vary would help \
                 more than such rows.",
                100.0 * ratio,
                if falls.len() > 1 { ", and more of all others" } else { "" }
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

fn assumptions(request: &Request, errors: &str) -> String {
    let points = &request.problem.experiment.points;
    let mut stated: Vec<String> =
        points.iter().map(|point| format!("{:.2} mm", 1e3 * point.reading_error)).collect();
    stated.dedup();
    let memory = request.limits.iter().any(|limit| limit.input.quantity.tendon().is_some());
    let memory = if memory {
        " Each planned row is taken by itself, tendons pulled to it from rest, without backlash or friction of an earlier row."
    } else {
        ""
    };
    format!(
        "This rests on derivatives at the values of the files, on {errors} (stated: {}), and on a model that is right.{memory}",
        stated.join(", ")
    )
}
