//! The calibrations of a bench as one page that needs nothing else: to read, to print, to hand in.

use crate::correlation::correlation_svg;
use crate::interval::interval_svg;
use crate::overlay::AXES;
use crate::page::{Provenance, computed, error_mm, render, svg, with_unit};
use crate::residuals::residual_svgs;
use crate::text::{decimals_of, escape, fixed, short};
use hydrostat::calibrate::{Calibration, Estimate, Loss, Problem, in_common};
use hydrostat::verify::{Experiment, Summary};
use minijinja::{Value, context};

const MAIN: &str = include_str!("calibration.html");

/// Parameters whose correlations are a grid, and pairs that are listed of more.
const MOST_IN_GRID: usize = 12;
const PAIRS: usize = 10;
/// Rows that a table shows, and those of a longer one: the largest errors.
const MOST_ROWS: usize = 40;
const LARGEST: usize = 10;
/// Places that are named of those that a pattern stands for.
const MOST_PATHS: usize = 4;

/// One self-contained HTML page (inline CSS and SVG, no scripts) that also prints on A4, of one or more calibrations of one
/// bench; None where there is none.
pub fn calibration_page(done: &[(Problem, Calibration)], provenance: &Provenance) -> Option<String> {
    let (Problem { experiment, .. }, _) = done.first()?;
    let calibrations: Vec<&Calibration> = done.iter().map(|(_, calibration)| calibration).collect();
    let content = context! {
        calibrations => done.iter().map(|(problem, calibration)| section(problem, calibration)).collect::<Vec<_>>(),
        together => in_common(&calibrations),
    };
    Some(render("Calibration", experiment, computed(provenance, settings(done)), MAIN, content))
}

/// What the template shows of one calibration.
fn section(problem: &Problem, calibration: &Calibration) -> Value {
    let names: Vec<&str> = problem.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let grid = (2..=MOST_IN_GRID).contains(&names.len());
    let (row_heads, rows) = rows(problem, calibration);
    context! {
        heading => heading(&names),
        size => size(&problem.experiment, calibration),
        parameters => calibration.parameters.iter().map(|estimate| parameter(problem, estimate)).collect::<Vec<_>>(),
        errors => errors(problem, calibration),
        residuals => residual_svgs(&problem.experiment, calibration).into_iter().map(svg).collect::<Vec<_>>(),
        grid => grid.then(|| svg(correlation_svg(&names, &calibration.correlation))),
        pairs => if names.len() > MOST_IN_GRID { pairs(&names, calibration) } else { Vec::new() },
        verdict => calibration.verdict.clone(),
        warnings => calibration.warnings.clone(),
        row_heads => row_heads.iter().map(|head| breakable(head, '_')).collect::<Vec<_>>(),
        rows,
        largest => (calibration.rows.len() > MOST_ROWS).then_some(LARGEST),
        of => calibration.rows.len(),
    }
}

fn heading(names: &[&str]) -> String {
    match names {
        [] | [_] | [_, _] | [_, _, _] => format!("Free: {}", names.join(", ")),
        more => format!("Free: {} parameters", more.len()),
    }
}

/// `11 rows, 22 coordinates, 2 steps; chi-square 222.3 with 20 degrees of freedom`
fn size(experiment: &Experiment, calibration: &Calibration) -> String {
    let per_row: usize = experiment.points.iter().map(|point| point.axes.len()).sum();
    format!(
        "{} rows, {} coordinates, {} steps; chi-square {} with {} degrees of freedom",
        calibration.rows.len(),
        calibration.rows.len() * per_row,
        calibration.steps,
        fixed(calibration.chi_square, 1),
        calibration.degrees_of_freedom
    )
}

fn parameter(problem: &Problem, estimate: &Estimate) -> Value {
    let Estimate { parameter, before, value, standard_error, interval_95, cut } = estimate;
    let show = |value: f64| pretty(&parameter.show(value, *standard_error));
    let places = parameter.paths(&problem.experiment);
    let mut notes = Vec::new();
    if places != [parameter.name.as_str()] {
        notes.push(listed(&places));
    }
    if let Some(prior) = parameter.prior {
        let [value, error] = [prior.value, prior.standard_error]
            .map(|x| pretty(&parameter.show(x, Some(prior.standard_error))));
        notes.push(format!("prior {value} ± {error}"));
    }
    if parameter.bounded {
        let [low, high] = parameter.bounds.map(|bound| pretty(&parameter.show(bound, None)));
        notes.push(format!("bounds {}", between(&low, &high)));
    }
    if cut.contains(&true) {
        notes.push("interval cut at its bound".to_owned());
    }
    context! {
        name => breakable(&parameter.name, '.'),
        notes => notes.iter().map(|note| breakable(note, '.')).collect::<Vec<_>>(),
        before => pretty(&parameter.show(*before, None)),
        value => show(*value),
        error => standard_error.map_or_else(|| "–".to_owned(), show),
        interval => interval_95.map_or_else(|| "not determined".to_owned(), |[low, high]| between(&show(low), &show(high))),
        drawing => svg(interval_svg(estimate)),
    }
}

fn listed(places: &[String]) -> String {
    match places.len().checked_sub(MOST_PATHS + 1) {
        None => places.join(", "),
        Some(more) => format!("{} and {} more", places[..MOST_PATHS].join(", "), more + 1),
    }
}

/// A long name that may break behind a sign, and is copied without the break.
fn breakable(name: &str, sign: char) -> Value {
    Value::from_safe_string(escape(name).replace(sign, &format!("{sign}<wbr/>")))
}

/// `54.12 to 55.10 GPa`: one unit for both.
fn between(low: &str, high: &str) -> String {
    let low = low.split_once(' ').map_or(low, |(number, _)| number);
    format!("{low} to {high}")
}

/// A true minus sign and raised powers.
fn pretty(quantity: &str) -> String {
    let raised = quantity.replace("^2", "²").replace("^3", "³");
    raised.strip_prefix('-').map(|size| format!("\u{2212}{size}")).unwrap_or(raised)
}

fn errors(problem: &Problem, calibration: &Calibration) -> Vec<Value> {
    let line = |name: String, s: &Summary, ours: bool| {
        let mut cells: Vec<String> =
            [s.mean, s.rms, s.rms_without_offset, s.max].into_iter().map(error_mm).collect();
        cells.push(fixed(100.0 * s.mean_fraction, 2));
        context! { name, cells, ours }
    };
    let mut lines = vec![
        line("before".to_owned(), &calibration.before, false),
        line("calibrated".to_owned(), &calibration.after, true),
    ];
    lines.extend(calibration.left_out.iter().map(|s| line("each row from all others".to_owned(), s, false)));
    lines.extend(
        calibration
            .folds
            .iter()
            .map(|s| line(format!("each of {} folds from all others", problem.folds), s, false)),
    );
    if let Some([before, after]) = &calibration.holdout {
        let held = format!("{} rows held out", problem.holdout.len());
        lines.push(line(format!("{held}, before"), before, false));
        lines.push(line(format!("{held}, calibrated"), after, false));
    }
    lines
}

fn pairs(names: &[&str], calibration: &Calibration) -> Vec<[String; 3]> {
    let strongest = calibration.pairs_by_correlation().into_iter().take(PAIRS);
    strongest
        .map(|(i, j)| [names[i].to_owned(), names[j].to_owned(), fixed(calibration.correlation[(i, j)], 2)])
        .collect()
}

/// Heads, and one line per measured point: residuals and errors, before and after.
fn rows(problem: &Problem, calibration: &Calibration) -> (Vec<String>, Vec<Vec<String>>) {
    let experiment = &problem.experiment;
    let several = experiment.points.len() > 1;
    let read = |axis: &usize| experiment.points.iter().any(|point| point.axes.contains(axis));
    let axes: Vec<usize> = (0..3).filter(read).collect();
    let mut heads = vec!["row".to_owned()];
    heads.extend(experiment.inputs.iter().map(|input| with_unit(&input.column, &input.unit.0)));
    heads.extend(several.then(|| "at [mm]".to_owned()));
    heads.extend(axes.iter().map(|&axis| format!("{} off [mm]", AXES[axis])));
    heads.extend(["error [mm]".to_owned(), "before [mm]".to_owned()]);
    let value =
        |inputs: &[f64], k: usize| inputs.get(k).copied().unwrap_or(f64::NAN) / experiment.inputs[k].unit.1;
    let digits_of = |k: usize| decimals_of(calibration.rows.iter().map(move |row| value(&row.inputs, k)));
    let digits: Vec<usize> = (0..experiment.inputs.len()).map(digits_of).collect();

    let mut numbers: Vec<usize> = (0..calibration.rows.len()).collect();
    if numbers.len() > MOST_ROWS {
        numbers = calibration.rows_by_error();
        numbers.truncate(LARGEST);
    }
    let mut table = Vec::new();
    for number in numbers {
        let row = &calibration.rows[number];
        for (j, ((before, after), point)) in
            row.before.iter().zip(&row.after).zip(&experiment.points).enumerate()
        {
            let mut cells = vec![(number + 1).to_string()];
            cells.extend(digits.iter().enumerate().map(|(k, &digits)| fixed(value(&row.inputs, k), digits)));
            if j > 0 {
                cells.iter_mut().for_each(String::clear);
            }
            cells.extend(several.then(|| short(1e3 * point.at, 1)));
            let off = after.predicted - after.observed;
            cells.extend(axes.iter().map(|axis| match point.axes.contains(axis) {
                true => fixed(1e3 * off[*axis], 2),
                false => "–".to_owned(),
            }));
            cells.extend([error_mm(after.error), error_mm(before.error)]);
            table.push(cells);
        }
    }
    (heads, table)
}

/// How the fits were made; what differs between them is listed.
fn settings(done: &[(Problem, Calibration)]) -> Vec<Value> {
    let each = |fact: &dyn Fn(&Problem) -> String| {
        let mut facts: Vec<String> = done.iter().map(|(problem, _)| fact(problem)).collect();
        facts.dedup();
        facts.join("; ")
    };
    let loss = |problem: &Problem| match problem.loss {
        Loss::Squares => "squares of residuals over reading errors".to_owned(),
        Loss::Huber => {
            "Huber's: squares of small residuals over reading errors, sizes of large ones".to_owned()
        }
    };
    let starts = |problem: &Problem| match problem.starts {
        0 | 1 => "1, the values of the files".to_owned(),
        starts => format!("{starts}: the values of the files, and others between the bounds"),
    };
    vec![
        context! { name => "loss", value => each(&loss) },
        context! { name => "starts", value => each(&starts) },
    ]
}
