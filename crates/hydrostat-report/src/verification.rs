//! A verification as one page that needs nothing else: to read, to print, to hand in.

use crate::chart::{error_svg, residual_svg, row_names};
use crate::overlay::{AXES, planes, shapes_svgs};
use crate::page::{Provenance, computed, error_mm, render, svg, with_unit};
use crate::text::{decimals_of, fixed, millimetres, short};
use hydrostat::verify::{Experiment, Summary, Verification};
use minijinja::{Value, context};

const MAIN: &str = include_str!("verification.html");

/// One self-contained HTML page (inline CSS and SVG, no scripts) that also prints on A4.
pub fn verification_page(
    experiment: &Experiment,
    verification: &Verification,
    provenance: &Provenance,
) -> String {
    let names = row_names(experiment, verification);
    let planes = planes(experiment, verification);
    let drawings: Vec<Value> =
        shapes_svgs(experiment, verification, &planes, &names).into_iter().map(svg).collect();
    let read = |axis| experiment.points.iter().any(|p| p.axes.contains(&axis));
    let residuals: Vec<Value> = planes
        .iter()
        .filter(|p| read(p.right) && read(p.up))
        .map(|&p| svg(residual_svg(experiment, verification, p, &names)))
        .collect();

    let several_points = experiment.points.len() > 1;
    let axes: Vec<usize> = (0..3).filter(|&a| read(a)).collect();
    let row_head = numbered(experiment).then(|| "row".to_owned());
    let units = experiment.inputs.iter().map(|i| with_unit(&i.column, &i.unit.0));
    let input_heads: Vec<String> = row_head.into_iter().chain(units).collect();
    let published = experiment.published.iter().flat_map(|p| &p.mean_errors);
    let published =
        published.map(|(what, m)| format!("{what} {}", millimetres(*m))).collect::<Vec<_>>().join("; ");
    let content = context! {
        verdict => verification.verdict.clone(),
        numbers => headline(&verification.model),
        drawings,
        lead => input_heads.len() + usize::from(several_points),
        input_heads,
        numbered => numbered(experiment),
        several_points,
        axes => axes.iter().map(|&a| AXES[a]).collect::<Vec<_>>(),
        rows => rows(experiment, verification, &axes),
        summaries => summaries(verification),
        error_chart => svg(error_svg(experiment, verification)),
        residuals,
        findings => verification.findings.clone(),
        published,
    };
    render("Verification", experiment, computed(provenance, Vec::new()), MAIN, content)
}

/// The drawing of that page alone: predicted shapes and observed points over the grid, in the plane in which they differ
/// most.
pub fn verification_svg(experiment: &Experiment, verification: &Verification) -> String {
    let spread = |axis: usize| {
        let ends = verification.rows.iter().filter_map(|row| row.shape.last()).map(|end| end[axis]);
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |r, x| [r[0].min(x), r[1].max(x)]);
        high - low
    };
    let mut planes = planes(experiment, verification);
    planes.sort_by(|a, b| spread(b.right).total_cmp(&spread(a.right)));
    shapes_svgs(experiment, verification, &planes[..1], &row_names(experiment, verification)).concat()
}

/// Whether rows are named by their number: unless one varied input tells them apart.
fn numbered(experiment: &Experiment) -> bool {
    experiment.inputs.len() != 1
}

fn headline(model: &Summary) -> Vec<Value> {
    let number = |name: &str, value: String| context! { name, value };
    vec![
        number("mean error", format!("{} mm", error_mm(model.mean))),
        number("of the length", format!("{} %", fixed(100.0 * model.mean_fraction, 2))),
        number("RMS error", format!("{} mm", error_mm(model.rms))),
        number("largest error", format!("{} mm", error_mm(model.max))),
        number("times the reading error", fixed(model.in_reading_errors, 1)),
    ]
}

/// The table of the thesis: inputs, predicted, observed, error in mm and in percent.
fn rows(experiment: &Experiment, verification: &Verification, axes: &[usize]) -> Vec<Vec<String>> {
    let input_digits: Vec<usize> = (0..experiment.inputs.len())
        .map(|k| {
            let size = experiment.inputs[k].unit.1;
            decimals_of(
                verification.rows.iter().map(move |r| r.inputs.get(k).copied().unwrap_or(f64::NAN) / size),
            )
        })
        .collect();
    let finest = experiment.points.iter().map(|p| p.reading_error).fold(f64::INFINITY, f64::min);
    let digits = if finest < 5e-5 {
        3
    } else if finest < 2e-4 {
        2
    } else {
        1
    };
    let length = experiment.robot.length();
    let mut table = Vec::new();
    for (i, row) in verification.rows.iter().enumerate() {
        for (j, point) in row.points.iter().enumerate() {
            let inputs = row.inputs.iter().zip(&experiment.inputs).zip(&input_digits);
            let mut cells: Vec<String> =
                numbered(experiment).then(|| (i + 1).to_string()).into_iter().collect();
            cells.extend(inputs.map(|((x, input), d)| fixed(x / input.unit.1, *d)));
            if j > 0 {
                cells.iter_mut().for_each(String::clear);
            }
            if experiment.points.len() > 1 {
                cells.push(short(1e3 * point.at, 1));
            }
            let read = |a: usize| experiment.points.get(j).is_none_or(|p| p.axes.contains(&a));
            for position in [&point.predicted, &point.observed] {
                let cell = |&a: &usize| {
                    if read(a) { fixed(1e3 * position[a], digits) } else { "–".to_owned() }
                };
                cells.extend(axes.iter().map(cell));
            }
            cells.push(error_mm(point.error));
            cells.push(fixed(100.0 * point.error / length, 2));
            table.push(cells);
        }
    }
    table
}

fn summaries(verification: &Verification) -> Vec<Value> {
    let line = |name: &str, s: &Summary| {
        let cells = vec![
            error_mm(s.mean),
            fixed(100.0 * s.mean_fraction, 2),
            error_mm(s.rms),
            error_mm(s.max),
            fixed(s.in_reading_errors, 1),
        ];
        context! { name, cells }
    };
    let mut lines = vec![
        line("this robot, Cosserat rod", &verification.model),
        line("constant curvature", &verification.constant_curvature),
        line("constant curvature, weight ignored", &verification.constant_curvature_weightless),
    ];
    lines.extend(verification.variants.iter().map(|(name, s)| line(&format!("variant: {name}"), s)));
    lines
}
