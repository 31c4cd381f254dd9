//! The verdict in words, from the numbers of the table.

use super::{Experiment, PointError, Row, Summary, VerifiedRow};
use crate::solution::Check;

/// Is the model within the reading error, is the residual systematic, what does the simpler model say.
pub(super) fn verdict(
    experiment: &Experiment,
    rows: &[VerifiedRow],
    model: &Summary,
    constant_curvature: &Summary,
) -> Vec<String> {
    let mut verdict = failed_checks(experiment, rows);
    verdict.push(within_reading_error(experiment, rows, model));
    verdict.extend(largest_error(experiment, rows));
    let inputs: Vec<&[f64]> = rows.iter().map(|row| row.inputs.as_slice()).collect();
    let points: Vec<&[PointError]> = rows.iter().map(|row| row.points.as_slice()).collect();
    let judged: Vec<String> =
        systematic(experiment, &inputs, &points).into_iter().map(|found| found.sentence).collect();
    if judged.is_empty() {
        verdict.push(format!(
            "Whether the residual is systematic was not tested: that takes {FEWEST_FOR_RUNS} rows in which one input \
             alone varies."
        ));
    }
    verdict.extend(judged);
    let (ours, simpler) = (1e3 * model.mean, 1e3 * constant_curvature.mean);
    verdict.push(if simpler > ours {
        format!(
            "The constant-curvature model errs by {simpler:.2} mm on average, {:.1} times as much.",
            simpler / ours.max(f64::MIN_POSITIVE)
        )
    } else {
        format!("The constant-curvature model errs by {simpler:.2} mm on average, no more than this model.")
    });
    verdict
}

/// Rows whose prediction fails a check of its own: one sentence a check, about the row farthest beyond its limit.
fn failed_checks(experiment: &Experiment, rows: &[VerifiedRow]) -> Vec<String> {
    let failed: Vec<(&Row, &Check)> = experiment
        .rows
        .iter()
        .zip(rows)
        .flat_map(|(row, verified)| verified.failed.iter().map(move |check| (row, check)))
        .collect();
    let mut names: Vec<&str> = failed.iter().map(|(_, check)| check.name).collect();
    names.sort_unstable();
    names.dedup();
    let sentence = |name: &&str| {
        let of_name = || failed.iter().filter(|(_, check)| check.name == *name);
        let beyond = |check: &Check| check.value - check.limit;
        let worst = of_name().max_by(|a, b| beyond(a.1).total_cmp(&beyond(b.1)))?;
        let more = match of_name().count() - 1 {
            0 => String::new(),
            1 => " It is the worse of two rows that do.".to_owned(),
            others => format!(" It is the worst of {} rows that do.", others + 1),
        };
        Some(format!("{}{more}", failed_check(&experiment.inputs_of(worst.0), worst.1)))
    };
    names.iter().filter_map(sentence).collect()
}

fn failed_check(inputs: &str, check: &Check) -> String {
    let Check { name, value, limit, .. } = check;
    let tendons = check.tendons.join(", ");
    match *name {
        "stability" => format!(
            "The prediction for {inputs} is UNSTABLE: the rod would not stay so, and its errors say nothing."
        ),
        "slack" => {
            format!(
                "The prediction for {inputs} fails its check of slack: pulled in and yet slack: {tendons}."
            )
        }
        "tension" => format!(
            "The prediction for {inputs} fails its check of tension: {value:.3} N in {tendons} against a limit of {limit:.3} N."
        ),
        name => format!(
            "The prediction for {inputs} fails its check of {name}: {:.3} % against a limit of {:.3} %.",
            100.0 * value,
            100.0 * limit
        ),
    }
}

/// Where to look first.
fn largest_error(experiment: &Experiment, rows: &[VerifiedRow]) -> Option<String> {
    let all = experiment.rows.iter().zip(rows);
    let errors = all.flat_map(|(row, verified)| verified.points.iter().map(move |point| (row, point)));
    let (row, point) = errors.max_by(|a, b| a.1.error.total_cmp(&b.1.error))?;
    let inputs = experiment.inputs_of(row);
    Some(format!("The largest error, {:.2} mm, is at {inputs}.", 1e3 * point.error))
        .filter(|_| rows.len() > 1)
}

/// Chi-square test of the weighted residuals against reading alone, theory (21).
fn within_reading_error(experiment: &Experiment, rows: &[VerifiedRow], model: &Summary) -> String {
    let per_row: usize = experiment.points.iter().map(|point| point.axes.len()).sum();
    let n = (per_row * rows.len()) as f64;
    let limit = (chi_square_95(n) / n).sqrt();
    let ratio = model.in_reading_errors;
    if ratio <= limit {
        format!(
            "The model is within the reading error: its coordinates are off by {ratio:.2} reading errors (root mean \
             square), and reading alone would exceed {limit:.2} in one case of twenty."
        )
    } else {
        format!(
            "The model is not within the reading error: its coordinates are off by {ratio:.1} reading errors (root \
             mean square), where reading alone would stay below {limit:.2} in nineteen cases of twenty."
        )
    }
}

/// What the runs test says of one input.
pub(crate) struct Systematic {
    pub(crate) is: bool,
    pub(crate) sentence: String,
    /// Such as `7 runs of sign over 11 rows, chance 0.62`.
    pub(crate) runs: String,
}

/// Runs test of the residual along the way the last point moves, for every input that can be judged; `inputs` and `points` row
/// by row.
pub(crate) fn systematic(
    experiment: &Experiment,
    inputs: &[&[f64]],
    points: &[&[PointError]],
) -> Vec<Systematic> {
    (0..experiment.inputs.len())
        .filter_map(|input| systematic_with(experiment, inputs, points, input))
        .collect()
}

fn systematic_with(
    experiment: &Experiment,
    inputs: &[&[f64]],
    points: &[&[PointError]],
    input: usize,
) -> Option<Systematic> {
    let point = experiment.points.len().checked_sub(1)?;
    let mut order: Vec<usize> = (0..inputs.len()).collect();
    order.sort_by(|&a, &b| inputs[a][input].total_cmp(&inputs[b][input]));
    let value = |k: usize| inputs[order[k]][input];
    let distinct = (1..order.len()).filter(|&k| value(k) > value(k - 1)).count() + 1;
    // other inputs that vary would show as runs of their own
    let alone = (0..experiment.inputs.len())
        .all(|other| other == input || inputs.iter().all(|row| same(row[other], inputs[0][other])));
    if distinct < FEWEST_FOR_RUNS || !alone {
        return None;
    }
    // residual along the motion of the predicted point: positive where the bench moved farther than the model
    let residual: Vec<f64> = (0..order.len())
        .map(|k| {
            let at = |k: usize| points[order[k]][point].predicted;
            let motion = at((k + 1).min(order.len() - 1)) - at(k.saturating_sub(1));
            let off = points[order[k]][point].observed - at(k);
            off.dot(&motion.try_normalize(0.0).unwrap_or_default())
        })
        .collect();
    let farther: Vec<bool> = residual.iter().map(|&r| r > 0.0).collect();
    let runs = 1 + farther.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let plus = farther.iter().filter(|&&sign| sign).count();
    let chance = at_most_runs(runs, plus, farther.len() - plus);
    let column = &experiment.inputs[input].column;
    let of = if experiment.points.len() > 1 { "last point" } else { "point" };
    let of_sign = if runs == 1 { "run" } else { "runs" };
    let counted = format!("{runs} {of_sign} of sign over {} rows", farther.len());
    let short = format!("{counted}, chance {chance:.2}");
    if chance >= 0.05 {
        let sentence = format!(
            "The residual is not shown to be systematic with {column}: {counted} (chance {chance:.2})."
        );
        return Some(Systematic { is: false, sentence, runs: short });
    }
    let mut stretches: Vec<String> = Vec::new();
    for run in split_runs(&farther) {
        let (from, to) = (run.0, run.1);
        let unit = &experiment.inputs[input].unit;
        let show = |k: usize| format!("{}", (value(k) / unit.1 * 1e9).round() / 1e9);
        let range = if from == to { show(from) } else { format!("{} to {}", show(from), show(to)) };
        let way = if farther[from] { "farther" } else { "less" };
        stretches.push(format!("{way} at {range} {}", unit.0));
    }
    let sentence = format!(
        "The residual is systematic with {column}: the {of} moved {} than predicted ({counted}; chance alone gives so few in \
         {:.1} % of cases). No change of reading would remove that; look for what the model lacks.",
        stretches.join(", "),
        100.0 * chance
    );
    Some(Systematic { is: true, sentence, runs: short })
}

/// With fewer rows no number of runs is improbable.
const FEWEST_FOR_RUNS: usize = 6;

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// First and last index of each run of equal signs.
fn split_runs(signs: &[bool]) -> Vec<(usize, usize)> {
    let mut runs = Vec::new();
    let mut from = 0;
    for k in 1..=signs.len() {
        if k == signs.len() || signs[k] != signs[from] {
            runs.push((from, k - 1));
            from = k;
        }
    }
    runs
}

/// Probability of at most `runs` runs among `plus` and `minus` signs in random order, theory (22) (Wald & Wolfowitz 1940).
///
/// ```text
/// P(R = 2k) = 2 C(a-1, k-1) C(b-1, k-1) / C(a+b, a)
/// P(R = 2k+1) = (C(a-1, k) C(b-1, k-1) + C(a-1, k-1) C(b-1, k)) / C(a+b, a)
/// ```
fn at_most_runs(runs: usize, plus: usize, minus: usize) -> f64 {
    if plus == 0 || minus == 0 {
        // one sign throughout: 2 of 2^n sequences of fair signs
        return 2.0_f64.powi(1 - (plus + minus) as i32);
    }
    let (a, b) = (plus - 1, minus - 1);
    let favourable: f64 = (2..=runs)
        .map(|r| {
            let k = r / 2;
            if r % 2 == 0 {
                2.0 * choose(a, k - 1) * choose(b, k - 1)
            } else {
                choose(a, k) * choose(b, k - 1) + choose(a, k - 1) * choose(b, k)
            }
        })
        .sum();
    favourable / choose(plus + minus, plus)
}

fn choose(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
}

/// 95 % point of chi-square with `n` degrees of freedom (Wilson & Hilferty 1931; within 1 % for n >= 2).
fn chi_square_95(n: f64) -> f64 {
    let c = 2.0 / (9.0 * n);
    n * (1.0 - c + 1.644_853_627 * c.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Swed & Eisenhart 1943, table I: P(R <= 4) for 5 and 6 signs is 26 / 231 ... by direct count.
    #[test]
    fn runs_agree_with_counting_every_order() {
        let (plus, minus) = (5, 4);
        let n = plus + minus;
        for limit in 1..=n {
            let mut favourable = 0;
            let mut all = 0;
            for mask in 0..1_u32 << n {
                if mask.count_ones() as usize != plus {
                    continue;
                }
                all += 1;
                let signs: Vec<bool> = (0..n).map(|i| mask >> i & 1 == 1).collect();
                favourable += usize::from(split_runs(&signs).len() <= limit);
            }
            let counted = favourable as f64 / f64::from(all);
            assert!((at_most_runs(limit, plus, minus) - counted).abs() < 1e-12, "{limit} runs");
        }
    }

    #[test]
    fn chi_square_agrees_with_its_table() {
        // Abramowitz & Stegun, table 26.8
        for (n, exact) in [(2.0, 5.99146), (10.0, 18.3070), (22.0, 33.9244), (100.0, 124.342)] {
            assert!((chi_square_95(n) / exact - 1.0).abs() < 0.01, "{n}");
        }
    }
}
