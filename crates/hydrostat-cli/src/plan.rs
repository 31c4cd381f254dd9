//! `hydrostat plan`: which measurements would tell most about what is free.

use crate::free::FreeArgs;
use crate::text::{MM, aligned, fixed};
use crate::{End, Outcome, files, json, warn};
use hydrostat::Error;
use hydrostat::description::{self, CalibrationFlags, Parsed, PlanFlags, builtin};
use hydrostat::plan::{Choice, Design, Plan, Planned, Request, plan};
use hydrostat::statics::Settings;
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Experiment file [default: the built-in bench of Gray 2009, E and length]
    experiment: Option<PathBuf>,
    #[command(flatten)]
    free: FreeArgs,
    /// What a column can be set to, such as "mass=0 g to 100 g" or "mass=0 g, 20 g, 50 g"; also mount_angle, tension.NAME,
    /// displacement.NAME; may be repeated
    /// [default: the range of the data]
    #[arg(long, value_name = "NAME=RANGE")]
    limit: Vec<String>,
    /// How many rows to plan [default: 3]
    #[arg(long, value_name = "N")]
    measurements: Option<usize>,
    /// How often the same row may be planned [default: 1]
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// Start of the random candidates, which are taken where a grid would have more than 400 rows
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print everything as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    let names = match (&args.experiment, &args.free.names[..]) {
        (None, []) => vec![builtin::FREED[1].to_owned()],
        _ => args.free.names.clone(),
    };
    let free = args.free.flags(&names);
    let flags = PlanFlags {
        limits: args.limit.clone(),
        measurements: args.measurements,
        repeats: args.repeats,
        seed: args.seed,
    };
    let parsed = read(args.experiment.as_deref(), &free, &flags)?;
    warn(&parsed.warnings);
    let request = parsed.value;
    let plan = plan(&request, &Settings::default())?;
    warn(&plan.warnings);
    let stdout = if args.json { format!("{}\n", json::plan(&request, &plan)) } else { text(&request, &plan) };
    Ok(Outcome { stdout, end: End::Passed })
}

/// Reads an experiment and what it names, relative to its own folder. None is the built-in one.
fn read(path: Option<&Path>, free: &CalibrationFlags, flags: &PlanFlags) -> Result<Parsed<Request>, Error> {
    let Some(path) = path else { return builtin::plan(free, flags) };
    let text = files::read_text(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut load = |file: &str| files::read_text(&folder.join(file));
    description::parse_plan(&text, &path.to_string_lossy(), &mut load, free, flags)
}

fn text(request: &Request, plan: &Plan) -> String {
    let experiment = &request.problem.experiment;
    let mut text = format!("{}\n", experiment.name);
    if let Some(source) = &experiment.source {
        let _ = writeln!(text, "{source}");
    }
    let names: Vec<&str> = plan.parameters.iter().map(|planned| planned.parameter.name.as_str()).collect();
    let limits = request.limits.iter().map(|limit| {
        let (unit, size) = &limit.input.unit;
        let show = |value: &f64| fixed(value / size, 1);
        let values = match &limit.choice {
            Choice::Range([low, high]) => format!("{} to {}", show(low), show(high)),
            Choice::Values(values) => values.iter().map(show).collect::<Vec<_>>().join(", "),
        };
        format!("{} {values} {unit}", limit.input.column)
    });
    let _ = writeln!(
        text,
        "\nFree: {}; {} rows at hand, {} to plan\nLimits: {}",
        names.join(", "),
        experiment.rows.len(),
        request.measurements,
        limits.collect::<Vec<_>>().join(", ")
    );
    let left_out = plan.left_out.iter().map(|(reason, count)| format!(", {count} left out: {reason}"));
    let _ = writeln!(text, "Candidates: {}{}", plan.candidates, left_out.collect::<String>());
    for (name, design) in [("D-optimal", &plan.d_optimal), ("A-optimal", &plan.a_optimal)] {
        let volume = design.volume.map_or_else(String::new, |volume| {
            format!("; the confidence region shrinks to {:.1} % of its volume", 100.0 * volume)
        });
        let _ = writeln!(text, "\n{name} rows, the one that tells most first{volume}\n");
        text += &aligned(&rows(request, design));
    }
    text.push('\n');
    text += &aligned(&parameters(plan));
    let _ = writeln!(text, "\nVerdict\n  {}", plan.verdict.join("\n  "));
    text
}

/// One line per row, with the points as they are predicted.
fn rows(request: &Request, design: &Design) -> Vec<Vec<String>> {
    let points = &request.problem.experiment.points;
    let mut header = vec!["next".to_owned()];
    header.extend(
        request.limits.iter().map(|limit| format!("{} [{}]", limit.input.column, limit.input.unit.0)),
    );
    for point in points {
        let axes: Vec<&str> = point.axes.iter().map(|&axis| ["x", "y", "z"][axis]).collect();
        header.push(format!("predicted {} at {} mm [mm]", axes.join(" "), fixed(point.at * MM, 1)));
    }
    let mut table = vec![header];
    for (i, row) in design.rows.iter().enumerate() {
        let mut cells = vec![(i + 1).to_string()];
        let inputs = request.limits.iter().zip(&row.inputs);
        cells.extend(inputs.map(|(limit, value)| fixed(value / limit.input.unit.1, 2)));
        cells.extend(points.iter().zip(&row.predicted).map(|(point, predicted)| {
            let read = point.axes.iter().map(|&axis| format!("{:>8}", fixed(predicted[axis] * MM, 2)));
            read.collect::<Vec<_>>().join(" ")
        }));
        table.push(cells);
    }
    table
}

/// One line per parameter: standard errors and half a 95 % interval, now and expected.
fn parameters(plan: &Plan) -> Vec<Vec<String>> {
    let header =
        ["parameter", "value", "standard error now", "after D", "after A", "95 % now", "after D", "after A"];
    let mut table = vec![header.map(str::to_owned).to_vec()];
    for Planned { parameter, value, now, after_d, after_a } in &plan.parameters {
        let show = |error: &Option<f64>, times: f64| {
            let shown = |error: f64| parameter.show(error * times, Some(error * times));
            error.map_or_else(|| "not determined".to_owned(), shown)
        };
        let half = |error: &Option<f64>, quantile: Option<f64>| match (error, quantile) {
            (Some(_), Some(quantile)) => format!("+- {}", show(error, quantile)),
            (Some(_), None) => "not known".to_owned(),
            (None, _) => show(error, 1.0),
        };
        let mut cells = vec![parameter.name.clone(), parameter.show(*value, None)];
        cells.extend([now, after_d, after_a].map(|error| show(error, 1.0)));
        cells.extend(
            [now, after_d, after_a].iter().zip(plan.quantiles).map(|(error, times)| half(error, times)),
        );
        table.push(cells);
    }
    table
}
