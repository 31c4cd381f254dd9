//! What `verify` prints: the table of the thesis, the errors, what they mean.

use crate::text::{MM, aligned, fixed};
use hydrostat::verify::{Experiment, Point, PointError, Summary, Verification};
use std::fmt::Write;

/// The default output of `verify`.
pub(crate) fn table(experiment: &Experiment, verification: &Verification) -> String {
    let length = experiment.robot.length();
    let mut text = format!("{}, {:.1} mm long\n", experiment.name, length * MM);
    if let Some(source) = &experiment.source {
        let _ = writeln!(text, "{source}");
    }
    text.push('\n');
    text += &aligned(&points(experiment, verification, length));
    text.push('\n');
    text += &aligned(&errors(verification));
    for (heading, sentences) in [("Findings", &verification.findings), ("Verdict", &verification.verdict)] {
        if !sentences.is_empty() {
            let _ = writeln!(text, "\n{heading}\n  {}", sentences.join("\n  "));
        }
    }
    text
}

/// One line per measured point.
fn points(experiment: &Experiment, verification: &Verification, length: f64) -> Vec<Vec<String>> {
    let several = experiment.points.len() > 1;
    let mut header: Vec<String> =
        experiment.inputs.iter().map(|input| format!("{} [{}]", input.column, input.unit.0)).collect();
    if several {
        header.push("at [mm]".into());
    }
    // the axes that any point has
    let axes: Vec<usize> =
        (0..3).filter(|axis| experiment.points.iter().any(|point| point.axes.contains(axis))).collect();
    let names = axes.iter().map(|&axis| ["x", "y", "z"][axis]).collect::<Vec<_>>().join(" ");
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
            cells.extend(point_cells(point, &axes, error, length));
            table.push(cells);
        }
    }
    table
}

fn point_cells(point: &Point, axes: &[usize], error: &PointError, length: f64) -> [String; 4] {
    let read = |v: &[f64]| {
        let component = |axis: &usize| match point.axes.contains(axis) {
            true => format!("{:>8}", fixed(v[*axis] * MM, 2)),
            false => format!("{:>8}", "-"),
        };
        axes.iter().map(component).collect::<Vec<_>>().join(" ")
    };
    [
        read(error.predicted.as_slice()),
        read(error.observed.as_slice()),
        format!("{:.2}", error.error * MM),
        format!("{:.2}", error.error / length * 100.0),
    ]
}

/// One line per model.
fn errors(verification: &Verification) -> Vec<Vec<String>> {
    let header =
        ["errors", "mean [mm]", "rms [mm]", "largest [mm]", "mean [% of length]", "rms [reading errors]"];
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
        line("constant curvature, weight ignored", &verification.constant_curvature_weightless),
    ];
    table.extend(verification.variants.iter().map(|(name, errors)| line(name, errors)));
    table
}
