//! A verification as one page that needs nothing else: to read, to print, to hand in.

use crate::chart::{error_svg, residual_svg, row_names};
use crate::describe;
use crate::overlay::{AXES, planes, shapes_svgs};
use crate::text::{decimals_of, fixed, millimetres, short, significant};
use hydrostat::verify::{Experiment, Summary, Verification};
use minijinja::{Environment, Value, context};

const TEMPLATE: &str = include_str!("page.html");

/// How a result came about; printed at the end of the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Of Hydrostat.
    pub version: String,
    /// In words, such as "special Cosserat rod, multiple shooting".
    pub method: String,
    /// Largest estimated position error, as a fraction of the length.
    pub tolerance: f64,
    /// The files that were read.
    pub files: Vec<String>,
    /// What to type to get this page again.
    pub command: Option<String>,
    pub date: Option<String>,
}

/// One self-contained HTML page (inline CSS and SVG, no scripts) that also prints on A4.
pub fn verification_page(
    experiment: &Experiment,
    verification: &Verification,
    provenance: &Provenance,
) -> String {
    let names = row_names(experiment, verification);
    let planes = planes(experiment, verification);
    let svg = |s: String| Value::from_safe_string(s);
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
    let page = context! {
        title => if experiment.name.trim().is_empty() { "Experiment without a name" } else { &experiment.name },
        source => experiment.source.clone(),
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
        tables => describe::tables(experiment),
        computed => computed(provenance),
    };
    // names with `<` or `&` are escaped because the template's name ends in .html
    Environment::new()
        .render_named_str("page.html", TEMPLATE, page)
        .expect("the template is part of the program")
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

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") }
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

/// Two decimals, three below a tenth of a millimetre.
fn error_mm(m: f64) -> String {
    fixed(1e3 * m, if m.abs() < 1e-4 && m != 0.0 { 3 } else { 2 })
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

fn computed(provenance: &Provenance) -> Vec<Value> {
    let mut facts = vec![
        context! { name => "program", value => format!("Hydrostat {}", provenance.version) },
        context! { name => "method", value => provenance.method.clone() },
        context! { name => "tolerance", value =>
        format!("{} of the length, estimated largest position error", significant(provenance.tolerance)) },
    ];
    if !provenance.files.is_empty() {
        facts.push(context! { name => "files", value => provenance.files.join(", "), code => true });
    }
    if let Some(command) = &provenance.command {
        facts.push(context! { name => "command", value => command, code => true });
    }
    if let Some(date) = &provenance.date {
        facts.push(context! { name => "date", value => date });
    }
    facts
}
