//! The readable output: millimetres, degrees, aligned columns.

use crate::json::method;
use hydrostat::solution::Check;
use hydrostat::verify::{Experiment, Point, PointError, Summary, Verification};
use hydrostat::{Equilibrium, Robot};
use std::fmt::Write;
use std::time::Duration;

/// Millimetres per metre.
const MM: f64 = 1e3;

/// The default output of `solve`.
pub(crate) fn solution(robot: &Robot, shape: &Equilibrium, took: Duration) -> String {
    let report = &shape.report;
    let mut lines = vec![(robot.name.clone(), format!("{:.1} mm long", robot.length() * MM))];
    let mut line = |name: &str, value: String| lines.push((format!("  {name}"), value));
    let direction: Vec<f64> = shape.tip.rotation.matrix().column(2).iter().copied().collect();
    let angles: Vec<f64> = direction
        .iter()
        .map(|cosine| cosine.clamp(-1.0, 1.0).acos().to_degrees())
        .collect();
    line(
        "tip position",
        format!("{} mm", components(shape.tip.position.as_slice(), MM, 3)),
    );
    line(
        "tip direction",
        format!("{} deg to the axes x y z", components(&angles, 1.0, 2)),
    );
    if let Some(base) = shape.stations.first() {
        line(
            "base force",
            format!("{} N", components(base.force.as_slice(), 1.0, 6)),
        );
        line(
            "base moment",
            format!("{} N mm", components(base.moment.as_slice(), MM, 4)),
        );
    }
    for check in &shape.checks {
        line(check.name, check_in_words(check));
    }
    line("stability", stability(report.stable, report.smallest_eigenvalue));
    line(
        "error estimate",
        format!(
            "{:.1e} mm (residual {:.1e})",
            report.error_estimate * MM,
            report.residual
        ),
    );
    let (name, time) = (method(report.method), took.as_secs_f64() * 1e6);
    line(
        "found by",
        format!("{name}, {} iterations, {time:.0} us", report.iterations),
    );
    lines
        .iter()
        .map(|(name, value)| format!("{name:<17} {value}\n"))
        .collect()
}

/// Every check that fails, in words.
pub(crate) fn failures(shape: &Equilibrium) -> Vec<String> {
    let failed = shape.checks.iter().filter(|check| !check.ok);
    let mut failures: Vec<String> = failed
        .map(|check| format!("check {} fails: {}", check.name, check_in_words(check)))
        .collect();
    if shape.report.stable == Some(false) {
        failures.push("the equilibrium is unstable".to_owned());
    }
    failures
}

/// The stations as CSV, SI units in the header.
pub(crate) fn stations(shape: &Equilibrium) -> String {
    let mut csv = String::from(
        "s [m],x [m],y [m],z [m],R11,R12,R13,R21,R22,R23,R31,R32,R33,v1,v2,v3,u1 [1/m],u2 [1/m],u3 [1/m],\
         force x [N],force y [N],force z [N],moment x [N m],moment y [N m],moment z [N m]\n",
    );
    for station in &shape.stations {
        let rotation = station.rotation.transpose(); // nalgebra stores columns
        let vectors = [&station.v, &station.u, &station.force, &station.moment];
        let numbers = station
            .position
            .iter()
            .chain(rotation.iter())
            .chain(vectors.into_iter().flatten());
        let numbers: Vec<String> = numbers.map(|number| format!(",{number}")).collect();
        let _ = writeln!(csv, "{}{}", station.s, numbers.concat());
    }
    csv
}

/// The default output of `verify`: the table of the thesis, the errors, what they mean.
pub(crate) fn verification(experiment: &Experiment, verification: &Verification) -> String {
    let length = experiment.robot.length();
    let mut text = format!("{}, {:.1} mm long\n", experiment.name, length * MM);
    if let Some(source) = &experiment.source {
        let _ = writeln!(text, "{source}");
    }
    text.push('\n');
    text += &aligned(&comparison(experiment, verification, length));
    text.push('\n');
    text += &aligned(&errors(verification));
    for (heading, sentences) in [
        ("Findings", &verification.findings),
        ("Verdict", &verification.verdict),
    ] {
        if !sentences.is_empty() {
            let _ = writeln!(text, "\n{heading}\n  {}", sentences.join("\n  "));
        }
    }
    text
}

/// One line per measured point.
fn comparison(experiment: &Experiment, verification: &Verification, length: f64) -> Vec<Vec<String>> {
    let several = experiment.points.len() > 1;
    let mut header: Vec<String> = experiment
        .inputs
        .iter()
        .map(|input| format!("{} [{}]", input.column, input.unit.0))
        .collect();
    if several {
        header.push("at [mm]".into());
    }
    let axes = |point: Option<&Point>| point.map_or(String::new(), axis_names);
    let names = axes(experiment.points.first());
    header.push(format!("predicted {names} [mm]"));
    header.push(format!("observed {names} [mm]"));
    header.extend(["error [mm]".into(), "error [% of length]".into()]);

    let mut table = vec![header];
    for row in &verification.rows {
        for (point, error) in experiment.points.iter().zip(&row.points) {
            let mut cells: Vec<String> = experiment
                .inputs
                .iter()
                .zip(&row.inputs)
                .map(|(input, value)| format!("{:.2}", value / input.unit.1))
                .collect();
            if several {
                cells.push(format!("{:.1}", error.at * MM));
            }
            cells.extend(point_cells(point, error, length));
            table.push(cells);
        }
    }
    table
}

fn point_cells(point: &Point, error: &PointError, length: f64) -> [String; 4] {
    let read = |v: &[f64]| {
        let components: Vec<String> = point
            .axes
            .iter()
            .filter_map(|&axis| v.get(axis))
            .map(|x| format!("{:>8}", fixed(x * MM, 2)))
            .collect();
        components.join(" ")
    };
    [
        read(error.predicted.as_slice()),
        read(error.observed.as_slice()),
        format!("{:.2}", error.error * MM),
        format!("{:.2}", error.error / length * 100.0),
    ]
}

fn axis_names(point: &Point) -> String {
    point
        .axes
        .iter()
        .filter_map(|&axis| ["x", "y", "z"].get(axis).copied())
        .collect::<Vec<_>>()
        .join(" ")
}

/// One line per model.
fn errors(verification: &Verification) -> Vec<Vec<String>> {
    let header = [
        "errors",
        "mean [mm]",
        "rms [mm]",
        "largest [mm]",
        "mean [% of length]",
        "rms [reading errors]",
    ];
    let line = |name: &str, errors: &Summary| {
        vec![
            name.to_owned(),
            format!("{:.2}", errors.mean * MM),
            format!("{:.2}", errors.rms * MM),
            format!("{:.2}", errors.max * MM),
            format!("{:.2}", errors.mean_fraction * 100.0),
            format!("{:.1}", errors.in_reading_errors),
        ]
    };
    let mut table = vec![
        header.map(str::to_owned).to_vec(),
        line("this model", &verification.model),
        line("constant curvature", &verification.constant_curvature),
        line(
            "constant curvature, weight ignored",
            &verification.constant_curvature_weightless,
        ),
    ];
    table.extend(
        verification
            .variants
            .iter()
            .map(|(name, errors)| line(name, errors)),
    );
    table
}

/// Columns two spaces apart; the first to the left if it holds words, numbers to the right.
pub(crate) fn aligned(table: &[Vec<String>]) -> String {
    let columns = table.iter().map(Vec::len).max().unwrap_or(0);
    let cells = |column: usize| table.iter().filter_map(move |row| row.get(column));
    let widths: Vec<usize> = (0..columns)
        .map(|c| cells(c).map(|cell| cell.chars().count()).max().unwrap_or(0))
        .collect();
    let words: Vec<bool> = (0..columns)
        .map(|c| {
            cells(c)
                .skip(1)
                .any(|cell| cell.chars().any(|letter| letter.is_alphabetic() && letter != 'e'))
        })
        .collect();
    let mut text = String::new();
    for row in table {
        let mut line = String::new();
        for (c, cell) in row.iter().enumerate() {
            let width = widths[c];
            let _ = if words[c] {
                write!(line, "  {cell:<width$}")
            } else {
                write!(line, "  {cell:>width$}")
            };
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

fn components(vector: &[f64], unit: f64, digits: usize) -> String {
    let components: Vec<String> = vector.iter().map(|x| fixed(x * unit, digits)).collect();
    format!("[{}]", components.join(", "))
}

/// Fixed decimals, and no sign on what rounds to zero.
fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_owned(),
        _ => text,
    }
}

fn check_in_words(check: &Check) -> String {
    // a strain is a fraction
    let show = |value: f64| {
        if check.name == "strain" {
            format!("{:.3} %", value * 100.0)
        } else {
            format!("{value:.6}")
        }
    };
    let place = check
        .at
        .map_or(String::new(), |at| format!(" at s = {:.1} mm", at * MM));
    let word = if check.ok { "" } else { ": TOO LARGE" };
    format!("{}{place}, limit {}{word}", show(check.value), show(check.limit))
}

fn stability(stable: Option<bool>, smallest_eigenvalue: Option<f64>) -> String {
    let word = match stable {
        Some(true) => "stable",
        Some(false) => "UNSTABLE",
        None => return "not known: the loads follow the backbone".to_owned(),
    };
    smallest_eigenvalue.map_or(word.to_owned(), |value| {
        format!("{word}, smallest eigenvalue {value:.4}")
    })
}
