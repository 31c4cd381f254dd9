//! Outliers in words, neighbouring rows together.

use super::{Loss, Problem};

/// Groups that are named one by one.
const NAMED: usize = 10;
/// Inputs that a reader takes in; of more, the number of the row is enough.
const MOST_INPUTS: usize = 4;

/// A coordinate that lies off.
struct Outlier {
    row: usize,
    point: usize,
    axis: usize,
    /// Standard errors.
    off: f64,
}

/// One sentence for each group of rows next to each other; `found` has numbers of coordinates, ascending, and standard errors off.
pub(super) fn sentences(problem: &Problem, found: &[(usize, f64)]) -> Vec<String> {
    let points = problem.experiment.points.iter().enumerate();
    let places: Vec<(usize, usize)> =
        points.flat_map(|(i, point)| point.axes.iter().map(move |&axis| (i, axis))).collect();
    let outliers = found.iter().map(|&(k, off)| {
        let (point, axis) = places[k % places.len()];
        Outlier { row: k / places.len(), point, axis, off }
    });
    let mut groups: Vec<Vec<Outlier>> = Vec::new();
    for outlier in outliers {
        match groups.last_mut() {
            Some(group) if group.last().is_some_and(|last| outlier.row <= last.row + 1) => {
                group.push(outlier)
            }
            _ => groups.push(vec![outlier]),
        }
    }
    let mut sentences: Vec<String> =
        groups.iter().take(NAMED).map(|group| sentence(problem, group)).collect();
    if groups.len() > NAMED {
        let coordinates: usize = groups[NAMED..].iter().map(Vec::len).sum();
        sentences.push(format!(
            "{coordinates} more coordinates in {} other places look like outliers.",
            groups.len() - NAMED
        ));
    }
    sentences
}

fn sentence(problem: &Problem, group: &[Outlier]) -> String {
    let experiment = &problem.experiment;
    let largest = group.iter().max_by(|a, b| a.off.total_cmp(&b.off)).expect("a group has an outlier");
    let row = |number: usize| match experiment.varied_inputs_of(&experiment.rows[number]) {
        inputs if (1..=MOST_INPUTS).contains(&inputs.len()) => {
            format!("row {} ({})", number + 1, inputs.join(", "))
        }
        _ => format!("row {}", number + 1),
    };
    let (axis, at) = (["x", "y", "z"][largest.axis], 1e3 * experiment.points[largest.point].at);
    let off = format!("{axis} of the point at {at:.0} mm lies {:.1} standard errors off", largest.off);
    let (first, last) = (group[0].row, group[group.len() - 1].row);
    if first == last {
        let advice = match problem.loss {
            Loss::Squares => "check it, or fit with --loss huber",
            Loss::Huber => "it pulls little here",
        };
        return format!("{}: {off} and looks like an outlier; {advice}.", row(first));
    }
    let advice = match problem.loss {
        Loss::Squares => "check what happened there, or fit with --loss huber",
        Loss::Huber => "check what happened there; they pull little here",
    };
    format!(
        "rows {} to {}: {} coordinates look like outliers, the largest in {}: {off}; neighbours that err together are rarely slips of \
         reading: {advice}.",
        first + 1,
        last + 1,
        group.len(),
        row(largest.row)
    )
}
