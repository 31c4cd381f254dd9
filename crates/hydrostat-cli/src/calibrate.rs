//! `hydrostat calibrate`: parameters fitted to a measured bench, and how sure they are.

use crate::free::FreeArgs;
use crate::provenance::provenance;
use crate::text::{MM, aligned};
use crate::{End, Outcome, files, json, warn};
use hydrostat::Error;
use hydrostat::calibrate::{CalibratedRow, Calibration, Loss, Problem, Progress, calibrate_watched};
use hydrostat::description::{self, CalibrationFlags, Parsed, builtin};
use hydrostat::statics::Settings;
use hydrostat::verify::{PointError, Summary};
use indicatif::ProgressBar;
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Experiment file [default: the built-in bench of Gray 2009, E alone and then E and length]
    experiment: Option<PathBuf>,
    #[command(flatten)]
    free: FreeArgs,
    /// How residuals count [default: squares]
    #[arg(long, value_enum)]
    loss: Option<LossName>,
    /// Points to start from: the files' values and others between the bounds [default: 1]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: Option<u16>,
    /// Predict each of K parts of the rows from a fit to all others
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(2..=1000))]
    folds: Option<u16>,
    /// A table like that of the experiment that the fit does not see, to tell the error of predictions
    #[arg(long, value_name = "TABLE.csv")]
    holdout: Option<PathBuf>,
    /// Print everything as JSON
    #[arg(long)]
    json: bool,
    /// Save the calibrated robot, with the comments and units of its file
    #[arg(long, value_name = "ROBOT.toml")]
    write: Option<PathBuf>,
    /// Write a page to print, DIR/index.html
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Let --write replace a file
    #[arg(long, requires = "write")]
    force: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum LossName {
    Squares,
    /// Outliers pull less
    Huber,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    let loss = args.loss.map(|loss| match loss {
        LossName::Squares => Loss::Squares,
        LossName::Huber => Loss::Huber,
    });
    // the flag's path is relative to where the user is, those of the experiment to its file
    let holdout = args.holdout.as_deref().map(std::path::absolute).transpose();
    let holdout = holdout.map_err(|error| Error::new(format!("--holdout has no absolute path: {error}")))?;
    let holdout = holdout.map(|path| path.to_string_lossy().into_owned());
    let flags = |free: &[String]| CalibrationFlags {
        loss,
        starts: args.starts.map(usize::from),
        folds: args.folds.map(usize::from),
        holdout: holdout.clone(),
        ..args.free.flags(free)
    };
    if let Some(path) = args.write.as_deref().filter(|path| path.exists() && !args.force) {
        return Err(Error::new(format!("{} exists already and is left as it is", path.display()))
            .hint("choose another name, or replace it with --force"));
    }
    let page_path = args.report.as_deref().map(|folder| folder.join("index.html"));
    if let Some(folder) = &args.report {
        files::refuse_file(folder)?;
    }
    let mut freed = vec![args.free.names.clone()];
    if args.experiment.is_none() && args.free.names.is_empty() {
        if args.write.is_some() {
            return Err(Error::new("--write saves one calibration, and without --free there are two")
                .hint("name what is free, such as --free youngs_modulus"));
        }
        freed = builtin::FREED.iter().map(|free| vec![(*free).to_owned()]).collect();
    }
    let mut files = Vec::new();
    let mut done = Vec::new();
    let settings = Settings { tolerance: COARSEST, ..Settings::default() };
    for free in &freed {
        let parsed = read(args.experiment.as_deref(), &flags(free), &mut files)?;
        if let Some(page) = &page_path {
            refuse_replacing(page, &files, args.write.as_deref())?;
        }
        if done.is_empty() {
            warn(&parsed.warnings);
        }
        let bar = progress();
        let mut watch = |progress: &Progress| {
            bar.set_message(format!(
                "{}, {} evaluations, residuals {:.2} reading errors",
                progress.stage, progress.evaluations, progress.residual
            ));
            bar.tick();
        };
        let calibration = calibrate_watched(&parsed.value, &settings, &mut watch);
        bar.finish_and_clear();
        let calibration = calibration?;
        done.push((parsed.value, calibration));
    }
    if let (Some(path), [(problem, calibration)]) = (&args.write, &done[..]) {
        let text = calibrated_robot(args.experiment.as_deref(), problem, calibration)?;
        files::write(path, text.as_bytes())?;
    }
    if let (Some(folder), Some(path)) = (&args.report, &page_path)
        && let Some(page) = hydrostat_report::calibration_page(&done, &provenance(&settings, &files))
    {
        files::make_folder(folder)?;
        files::write(path, page.as_bytes())?;
    }
    let stdout = if args.json {
        format!("{}\n", json::calibrations(&done))
    } else {
        text(&done, args.write.as_deref())
    };
    Ok(Outcome { stdout, end: End::Passed })
}

/// Of the length; a fit solves finer where the reading error asks for it.
const COARSEST: f64 = 1e-6;

/// Drawn where stderr is a terminal.
fn progress() -> ProgressBar {
    ProgressBar::new_spinner()
}

/// A page may replace an older one, but neither what is read nor the robot that is saved.
fn refuse_replacing(page: &Path, read: &[PathBuf], saved: Option<&Path>) -> Result<(), Error> {
    let words = std::iter::once("the bench").chain(std::iter::repeat("a file that the bench names"));
    let mut inputs: Vec<_> = words.zip(read.iter().map(|file| Some(file.as_path()))).collect();
    inputs.push(("the robot that --write saves", saved));
    let full = |path: &Path| std::path::absolute(path).ok();
    if saved.is_some_and(|saved| full(saved) == full(page)) {
        return Err(
            Error::new("--report would replace the robot that --write saves").hint("name another file")
        );
    }
    files::refuse_replacing("--report", page, &inputs)
}

/// Reads an experiment and what it names, relative to its own folder; notes the paths. None is the built-in one.
fn read(
    path: Option<&Path>,
    flags: &CalibrationFlags,
    read: &mut Vec<PathBuf>,
) -> Result<Parsed<Problem>, Error> {
    let Some(path) = path else {
        return builtin::calibration(flags);
    };
    let text = files::read_text(path)?;
    read.push(path.to_owned());
    let fetch = &mut linked(path, read);
    description::parse_calibration(&text, &path.to_string_lossy(), fetch, flags)
}

/// Reads what an experiment names, and notes the paths.
fn linked(experiment: &Path, read: &mut Vec<PathBuf>) -> impl FnMut(&str) -> Result<String, Error> {
    let folder = experiment.parent().unwrap_or(Path::new("")).to_owned();
    move |file| {
        let path = folder.join(file);
        read.push(path.clone());
        files::read_text(&path)
    }
}

/// The robot file with the values found, and above it where they come from.
fn calibrated_robot(
    path: Option<&Path>,
    problem: &Problem,
    calibration: &Calibration,
) -> Result<String, Error> {
    let experiment = &problem.experiment;
    let mut note = vec![
        format!("Calibrated by hydrostat {} on {}", env!("CARGO_PKG_VERSION"), experiment.name),
        match path {
            Some(path) => format!("({}).", path.display()),
            None => "(the built-in bench of Gray 2009).".to_owned(),
        },
    ];
    note.extend(experiment.source.iter().map(|source| format!("Source: {source}")));
    for line in parameters(calibration).iter().skip(1) {
        note.push(format!("  {}", line.join("  ")));
    }
    note.push(format!(
        "Mean error {:.2} mm, before {:.2} mm.",
        calibration.after.mean * MM,
        calibration.before.mean * MM
    ));
    note.extend(calibration.warnings.iter().map(|warning| format!("Warning: {warning}")));
    match path {
        Some(path) => {
            let text = files::read_text(path)?;
            description::write_calibrated(
                &text,
                &path.to_string_lossy(),
                &mut linked(path, &mut Vec::new()),
                calibration,
                &note,
            )
        }
        None => builtin::write_calibrated(calibration, &note),
    }
}

/// The default output: each calibration, then what they have in common.
fn text(done: &[(Problem, Calibration)], written: Option<&Path>) -> String {
    let mut text = String::new();
    for (problem, calibration) in done {
        let experiment = &problem.experiment;
        if text.is_empty() {
            let _ = writeln!(text, "{}", experiment.name);
            if let Some(source) = &experiment.source {
                let _ = writeln!(text, "{source}");
            }
        }
        let names: Vec<&str> = problem.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let _ = writeln!(
            text,
            "\nFree: {}; {} rows, {} coordinates, {} steps\n",
            names.join(", "),
            experiment.rows.len(),
            problem.experiment.rows.len()
                * experiment.points.iter().map(|point| point.axes.len()).sum::<usize>(),
            calibration.steps
        );
        text += &aligned(&parameters(calibration));
        if (2..=MOST_COLUMNS).contains(&names.len()) {
            text.push('\n');
            text += &aligned(&correlation(&names, calibration));
        } else if names.len() > MOST_COLUMNS {
            text.push('\n');
            text += &aligned(&strongest(&names, calibration));
        }
        text.push('\n');
        text += &aligned(&errors(calibration));
        text.push('\n');
        if calibration.rows.len() > MOST_ROWS {
            let _ = writeln!(text, "The {LARGEST} rows with the largest errors; --json has all.");
        }
        text += &aligned(&rows(problem, calibration));
        let sections = [("Verdict", &calibration.verdict), ("Warnings", &calibration.warnings)];
        for (heading, sentences) in sections.into_iter().filter(|(_, sentences)| !sentences.is_empty()) {
            let _ = writeln!(text, "\n{heading}\n  {}", sentences.join("\n  "));
        }
    }
    let several: Vec<&Calibration> = done.iter().map(|(_, calibration)| calibration).collect();
    if let Some(sentence) = hydrostat::calibrate::in_common(&several) {
        let _ = writeln!(text, "\nTogether\n  {sentence}");
    }
    if let Some(path) = written {
        let _ = writeln!(text, "\nThe calibrated robot is in {}.", path.display());
    }
    text
}

fn parameters(calibration: &Calibration) -> Vec<Vec<String>> {
    let interval = match calibration.too_narrow {
        Some(wider) => format!("95 % interval (should be {wider:.1} x as wide, see warnings)"),
        None => "95 % interval".to_owned(),
    };
    let mut header = ["parameter", "before", "value", "standard error"].map(str::to_owned).to_vec();
    header.push(interval);
    let mut table = vec![header];
    for estimate in &calibration.parameters {
        let error = estimate.standard_error;
        let show = |value: f64| estimate.parameter.show(value, error);
        let unknown = || "not determined".to_owned();
        table.push(vec![
            estimate.parameter.name.clone(),
            estimate.parameter.show(estimate.before, None),
            show(estimate.value),
            error.map_or_else(unknown, show),
            estimate.interval_95.map_or_else(unknown, |[low, high]| {
                let cut = if estimate.cut.contains(&true) { ", cut at its bound" } else { "" };
                format!("{} to {}{cut}", show(low), show(high))
            }),
        ]);
    }
    table
}

/// Parameters whose correlations are shown as a matrix, and pairs that are shown of more.
const MOST_COLUMNS: usize = 8;
const PAIRS: usize = 5;

fn strongest(names: &[&str], calibration: &Calibration) -> Vec<Vec<String>> {
    let pairs = calibration.pairs_by_correlation();
    let mut table = vec![vec!["strongest correlations".to_owned(), String::new(), String::new()]];
    table.extend(pairs.iter().take(PAIRS).map(|&(i, j)| {
        vec![names[i].to_owned(), names[j].to_owned(), format!("{:.2}", calibration.correlation[(i, j)])]
    }));
    table
}

fn correlation(names: &[&str], calibration: &Calibration) -> Vec<Vec<String>> {
    let mut header = vec!["correlation".to_owned()];
    header.extend(names.iter().map(|name| (*name).to_owned()));
    let mut table = vec![header];
    for (i, name) in names.iter().enumerate() {
        let mut row = vec![(*name).to_owned()];
        row.extend((0..names.len()).map(|j| {
            let value = calibration.correlation[(i, j)];
            if value.is_finite() { format!("{value:.2}") } else { "-".to_owned() }
        }));
        table.push(row);
    }
    table
}

fn errors(calibration: &Calibration) -> Vec<Vec<String>> {
    let header = [
        "errors",
        "mean [mm]",
        "rms [mm]",
        "rms about their mean [mm]",
        "largest [mm]",
        "mean [% of length]",
    ];
    let line = |name: &str, errors: &Summary| {
        vec![
            name.to_owned(),
            format!("{:.2}", errors.mean * MM),
            format!("{:.2}", errors.rms * MM),
            format!("{:.2}", errors.rms_without_offset * MM),
            format!("{:.2}", errors.max * MM),
            format!("{:.2}", errors.mean_fraction * 100.0),
        ]
    };
    let mut table = vec![header.map(str::to_owned).to_vec()];
    table.push(line("before", &calibration.before));
    table.push(line("calibrated", &calibration.after));
    table.extend(calibration.left_out.iter().map(|errors| line("each row from all others", errors)));
    table.extend(calibration.folds.iter().map(|errors| line("each fold from all others", errors)));
    if let Some([before, after]) = &calibration.holdout {
        table.extend([line("held out, before", before), line("held out, calibrated", after)]);
    }
    table
}

/// Rows that a table shows, and those of a longer one: the largest errors.
const MOST_ROWS: usize = 40;
const LARGEST: usize = 10;

/// Rows of the table, with their numbers.
fn shown(calibration: &Calibration) -> Vec<(usize, &CalibratedRow)> {
    let mut numbers: Vec<usize> = (0..calibration.rows.len()).collect();
    if numbers.len() > MOST_ROWS {
        numbers = calibration.rows_by_error();
        numbers.truncate(LARGEST);
    }
    numbers.into_iter().map(|number| (number, &calibration.rows[number])).collect()
}

/// One line per measured point: residuals before and after.
fn rows(problem: &Problem, calibration: &Calibration) -> Vec<Vec<String>> {
    let experiment = &problem.experiment;
    let several = experiment.points.len() > 1;
    let mut header = vec!["row".to_owned()];
    header.extend(experiment.inputs.iter().map(|input| format!("{} [{}]", input.column, input.unit.0)));
    header.extend(several.then(|| "at [mm]".to_owned()));
    let axes: Vec<usize> =
        (0..3).filter(|axis| experiment.points.iter().any(|point| point.axes.contains(axis))).collect();
    header.extend(axes.iter().map(|&axis| format!("{} off [mm]", ["x", "y", "z"][axis])));
    header.extend(["error [mm]".to_owned(), "before [mm]".to_owned()]);
    let mut table = vec![header];
    let errors = |errors: &[PointError]| errors.iter().map(|error| error.error * MM).collect::<Vec<f64>>();
    for (number, row) in shown(calibration) {
        let (after, before) = (errors(&row.after), errors(&row.before));
        for (i, point) in experiment.points.iter().enumerate() {
            let inputs = experiment.inputs.iter().zip(&row.inputs);
            let mut cells = vec![(number + 1).to_string()];
            cells.extend(inputs.map(|(input, value)| format!("{:.2}", value / input.unit.1)));
            cells.extend(several.then(|| format!("{:.1}", point.at * MM)));
            let off = row.after[i].predicted - row.after[i].observed;
            cells.extend(axes.iter().map(|axis| match point.axes.contains(axis) {
                true => format!("{:.2}", off[*axis] * MM),
                false => "-".to_owned(),
            }));
            cells.extend([format!("{:.2}", after[i]), format!("{:.2}", before[i])]);
            table.push(cells);
        }
    }
    table
}
