//! `hydrostat budget`: how much each tolerance moves what is measured.

use crate::plot::Format;
use crate::text::{MM, aligned, fixed};
use crate::{End, Outcome, files, json, warn};
use hydrostat::Error;
use hydrostat::budget::{Budget, Contribution, Displacement, Tolerance, budget};
use hydrostat::description::{self, Parsed, builtin};
use hydrostat::statics::Settings;
use hydrostat::verify::Experiment;
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Experiment file [default: the built-in bench of Gray 2009]
    experiment: Option<PathBuf>,
    /// Standard deviation of a quantity, such as "length=0.5 mm", "youngs_modulus=2 %" or "grid_tilt.z=0.5 deg", in place of or beside
    /// those of the file [default: usual ones, where neither gives any]
    #[arg(long, value_name = "NAME=VALUE")]
    tolerance: Vec<String>,
    /// Samples of the Monte Carlo method
    #[arg(long, value_name = "N", default_value_t = 400)]
    samples: usize,
    /// Start of the random numbers; the same seed gives the same figures
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print everything as JSON
    #[arg(long)]
    json: bool,
    /// Draw the budget as bars into a file .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    let plot = args.plot.as_deref().map(|path| Format::of(path).map(|format| (path, format))).transpose()?;
    let mut read_files = Vec::new();
    let parsed = read(args.experiment.as_deref(), &args.tolerance, &mut read_files)?;
    if let Some((path, _)) = plot {
        let words = std::iter::once("the bench").chain(std::iter::repeat("a file that the bench names"));
        let inputs: Vec<_> = words.zip(read_files.iter().map(|file| Some(file.as_path()))).collect();
        files::refuse_replacing("--plot", path, &inputs)?;
    }
    warn(&parsed.warnings);
    let (experiment, tolerances) = parsed.value;
    let budget = budget(&experiment, &tolerances, args.samples, args.seed, &Settings::default())?;
    if let Some((path, format)) = plot {
        let drawing = hydrostat_report::budget_svg(&experiment, &budget);
        files::write(path, &format.encode(drawing)?)?;
    }
    let stdout = if args.json {
        format!("{}\n", json::budget(&experiment, &budget))
    } else {
        text(&experiment, &budget)
    };
    Ok(Outcome { stdout, end: End::Passed })
}

/// Reads an experiment and what it names, relative to its own folder; notes the paths. None is the built-in one.
fn read(
    path: Option<&Path>,
    flags: &[String],
    read: &mut Vec<PathBuf>,
) -> Result<Parsed<(Experiment, Vec<Tolerance>)>, Error> {
    let Some(path) = path else { return builtin::budget(flags) };
    let text = files::read_text(path)?;
    read.push(path.to_owned());
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut load = |file: &str| {
        let linked = folder.join(file);
        read.push(linked.clone());
        files::read_text(&linked)
    };
    description::parse_budget(&text, &path.to_string_lossy(), &mut load, flags)
}

/// Contributions below this are told in one line, m.
const SMALL: f64 = 5e-6;
/// Rows whose contributions are shown.
const MOST_ROWS: usize = 12;

fn text(experiment: &Experiment, budget: &Budget) -> String {
    let mut text = format!("{}\n", experiment.name);
    if let Some(source) = &experiment.source {
        let _ = writeln!(text, "{source}");
    }
    let _ = writeln!(
        text,
        "\nStandard deviations of the predicted points by those of the inputs; {} samples, seed {}. What has no line counts as exact.\n",
        budget.samples, budget.seed
    );
    text += &aligned(&contributions(budget));
    let small: Vec<&str> =
        budget.contributions.iter().filter(|part| is_small(part)).map(Contribution::name).collect();
    if !small.is_empty() {
        let _ = writeln!(text, "\n  Below {} mm each: {}", SMALL * MM, small.join(", "));
    }
    let _ = writeln!(text, "\nRow by row, Monte Carlo [mm]\n");
    text += &aligned(&rows(experiment, budget));
    if experiment.rows.len() > MOST_ROWS {
        let _ = writeln!(text, "  {MOST_ROWS} of {} rows; --json has all.", experiment.rows.len());
    }
    let _ = writeln!(text, "\nVerdict\n  {}", budget.verdict.join("\n  "));
    text
}

fn is_small(part: &Contribution) -> bool {
    part.displacement.rms_monte_carlo < SMALL && part.displacement.rms_first_order < SMALL
}

/// One line per tolerance.
fn contributions(budget: &Budget) -> Vec<Vec<String>> {
    let header = [
        "tolerance",
        "value",
        "standard deviation",
        "first order [mm]",
        "Monte Carlo [mm]",
        "largest [mm]",
        "share [%]",
    ];
    let line = |name: &str, value: [String; 2], part: &Displacement, share: f64| {
        let largest = part.monte_carlo.iter().flatten().copied().fold(0.0, f64::max);
        let mut cells = vec![name.to_owned()];
        cells.extend(value);
        cells.extend([part.rms_first_order, part.rms_monte_carlo, largest].map(|x| fixed(x * MM, 2)));
        cells.push(fixed(share * 100.0, 1));
        cells
    };
    let mut table = vec![header.map(str::to_owned).to_vec()];
    for part in budget.contributions.iter().filter(|part| !is_small(part)) {
        let value = match (&part.tolerance, part.value) {
            (Some(tolerance), Some(value)) => [tolerance.show(value), tolerance.show(tolerance.deviation)],
            _ => [String::new(), "as stated".to_owned()],
        };
        table.push(line(part.name(), value, &part.displacement, part.share));
    }
    table.push(line("all together", [String::new(), String::new()], &budget.total, 1.0));
    table
}

/// One line per tolerance and one column per row and point, then the total and the error that verify finds.
fn rows(experiment: &Experiment, budget: &Budget) -> Vec<Vec<String>> {
    let shown = shown(experiment.rows.len());
    let points = experiment.points.len();
    let columns: Vec<(usize, usize)> =
        shown.iter().flat_map(|&row| (0..points).map(move |point| (row, point))).collect();
    let mut table = Vec::new();
    for (i, input) in experiment.inputs.iter().enumerate() {
        let mut cells = vec![format!("{} [{}]", input.column, input.unit.0)];
        cells.extend(columns.iter().map(|(row, _)| {
            let value = experiment.rows[*row].inputs[i] / input.unit.1;
            fixed(value, 1)
        }));
        table.push(cells);
    }
    if table.is_empty() {
        let mut cells = vec!["row".to_owned()];
        cells.extend(columns.iter().map(|(row, _)| (row + 1).to_string()));
        table.push(cells);
    }
    if points > 1 {
        let mut cells = vec!["at [mm]".to_owned()];
        cells.extend(columns.iter().map(|(_, point)| fixed(experiment.points[*point].at * MM, 0)));
        table.push(cells);
    }
    let line = |name: &str, values: &[Vec<f64>]| {
        let mut cells = vec![name.to_owned()];
        cells.extend(columns.iter().map(|(row, point)| fixed(values[*row][*point] * MM, 2)));
        cells
    };
    for part in budget.contributions.iter().filter(|part| !is_small(part)) {
        table.push(line(part.name(), &part.displacement.monte_carlo));
    }
    table.push(line("all together", &budget.total.monte_carlo));
    table.push(line("error found by verify", &budget.errors));
    table
}

/// Rows of a table that is not too wide: all, or some evenly apart, the first and the last among them.
fn shown(count: usize) -> Vec<usize> {
    match count {
        0..=MOST_ROWS => (0..count).collect(),
        _ => (0..MOST_ROWS).map(|i| i * (count - 1) / (MOST_ROWS - 1)).collect(),
    }
}
