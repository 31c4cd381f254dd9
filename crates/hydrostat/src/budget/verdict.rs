//! What a budget means, in words.

use super::{Budget, Contribution, Displacement};
use crate::verify::Experiment;

/// Parts of the total by squares that are named together as what dominates.
const MOST: f64 = 0.9;
/// Disagreement of first order with the samples, as a part of the larger, and in sampling errors, from which it is said.
const DISAGREES: f64 = 0.1;
const SAMPLING_ERRORS: f64 = 3.0;
/// Part of the total below which nobody looks.
const SEEN: f64 = 0.01;
/// Below this chance, tolerances do not explain what was found.
const SIGNIFICANCE: f64 = 0.05;

pub(super) fn verdict(experiment: &Experiment, budget: &Budget) -> Vec<String> {
    let mut sentences = vec![dominating(budget)];
    sentences.push(nonlinear(experiment, budget));
    sentences.extend(failures(budget));
    sentences.push(size(budget));
    sentences.push(shape(budget));
    sentences
}

fn mm(length: f64) -> String {
    format!("{:.2} mm", 1e3 * length)
}

fn described(contribution: &Contribution) -> String {
    match &contribution.tolerance {
        Some(tolerance) => format!("{} ({})", tolerance.name, tolerance.show(tolerance.deviation)),
        None => "the reading error".to_owned(),
    }
}

fn dominating(budget: &Budget) -> String {
    let total = &budget.total;
    let mut by_share: Vec<&Contribution> = budget.contributions.iter().collect();
    by_share.sort_by(|a, b| b.share.total_cmp(&a.share));
    let (mut sum, mut count) = (0.0, 0);
    while count < by_share.len() && sum < MOST {
        sum += by_share[count].share;
        count += 1;
    }
    let Some(first) = by_share.first() else { return String::new() };
    let rest = total.rms_first_order * (1.0 - first.share).max(0.0).sqrt();
    let others: Vec<String> = by_share[1..count]
        .iter()
        .map(|part| format!("{} {:.0} %", described(part), 100.0 * part.share))
        .collect();
    let others = if others.is_empty() { String::new() } else { format!(", then {}", others.join(", ")) };
    format!(
        "{} {} with {:.0} % of the total's square{others}. If it were exact, the total of {} would fall to {}.",
        described(first),
        if first.share > 0.5 { "dominates" } else { "is the largest" },
        100.0 * first.share,
        mm(total.rms_first_order),
        mm(rest)
    )
}

/// Whether samples tell other sizes than first order.
fn disagrees(part: &Displacement, total: &Displacement) -> bool {
    let off = (part.rms_monte_carlo - part.rms_first_order).abs();
    let larger = part.rms_monte_carlo.max(part.rms_first_order);
    larger > SEEN * total.rms_monte_carlo
        && off > DISAGREES * larger
        && off > SAMPLING_ERRORS * part.sampling_error
}

fn nonlinear(experiment: &Experiment, budget: &Budget) -> String {
    let total = &budget.total;
    let all = budget.contributions.iter().map(|part| (part.name(), &part.displacement));
    let named: Vec<String> = all
        .chain([("all together", total)])
        .filter(|(_, part)| disagrees(part, total))
        .map(|(name, part)| format!("{name} ({} and {})", mm(part.rms_first_order), mm(part.rms_monte_carlo)))
        .collect();
    if named.is_empty() {
        return format!(
            "First order and Monte Carlo agree: {} and {} for all together; the answers are straight over these tolerances.",
            mm(total.rms_first_order),
            mm(total.rms_monte_carlo)
        );
    }
    let off = |row: usize, i: usize| (total.monte_carlo[row][i] - total.first_order[row][i]).abs();
    let cells =
        (0..total.first_order.len()).flat_map(|row| (0..total.first_order[row].len()).map(move |i| (row, i)));
    let most = cells.max_by(|a, b| off(a.0, a.1).total_cmp(&off(b.0, b.1)));
    let place = most.map_or_else(String::new, |(row, i)| {
        let inputs = experiment.inputs_of(&experiment.rows[row]);
        let inputs = if inputs.is_empty() { format!("row {}", row + 1) } else { inputs };
        format!(
            "; the totals are farthest apart at {inputs}: {} and {}",
            mm(total.first_order[row][i]),
            mm(total.monte_carlo[row][i])
        )
    });
    format!(
        "First order and Monte Carlo disagree, so that the answer is curved over the tolerance and Monte Carlo is to be taken, for {}{place}.",
        named.join(", ")
    )
}

fn failures(budget: &Budget) -> Option<String> {
    (budget.failed > 0).then(|| {
        format!(
            "{} of {} samples of all together have no solution and are left out: the total is of the others, and too small.",
            budget.failed, budget.samples
        )
    })
}

fn size(budget: &Budget) -> String {
    let found = &budget.verified;
    let chance = budget.chance_of_mean;
    let says = if chance < SIGNIFICANCE {
        "in size the tolerances do not explain the model's error"
    } else {
        "in size the tolerances are enough to explain the model's error"
    };
    format!(
        "verify finds a mean error of {} ({} rms), against a total of {} rms; {:.0} % of benches drawn with these tolerances err as much on average: {says}.",
        mm(found.mean),
        mm(found.rms),
        mm(budget.total.rms_monte_carlo),
        100.0 * chance
    )
}

fn shape(budget: &Budget) -> String {
    let Budget { chi_square, degrees_of_freedom, chance_of_shape, .. } = budget;
    let chance = if *chance_of_shape < 1e-4 {
        "below 0.01 %".to_owned()
    } else {
        format!("{:.2} %", 100.0 * chance_of_shape)
    };
    let says = if *chance_of_shape < SIGNIFICANCE {
        "row by row they do not: a tolerance errs alike in all rows, and the residuals change with the rows in a way that none of these \
         has. Some is from elsewhere, or readings are less exact than stated"
    } else {
        "row by row they explain it, too"
    };
    format!(
        "To first order, {says} (chi-square {chi_square:.1} with {degrees_of_freedom} degrees of freedom, chance {chance})."
    )
}
