//! `hydrostat verify`: the model against a measured bench.

use crate::plot::Format;
use crate::provenance::provenance;
use crate::{End, Outcome, comparison, files, json, warn};
use hydrostat::Error;
use hydrostat::description::{self, Parsed, builtin};
use hydrostat::statics::Settings;
use hydrostat::verify::{Experiment, verify};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Experiment file [default: the built-in bench of Gray 2009]
    experiment: Option<PathBuf>,
    /// Print everything as JSON
    #[arg(long)]
    json: bool,
    /// Write a page to print, DIR/index.html
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Draw the predicted shapes and the observed points over a 1 mm grid into a file .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    if let Some(folder) = &args.report {
        files::refuse_file(folder)?;
    }
    let plot = args.plot.as_deref().map(|path| Format::of(path).map(|format| (path, format))).transpose()?;
    let page_path = args.report.as_deref().map(|folder| folder.join("index.html"));
    let mut files = Vec::new();
    let parsed = read(args.experiment.as_deref(), &mut files)?;
    let words = std::iter::once("the bench").chain(std::iter::repeat("a file that the bench names"));
    let inputs: Vec<_> = words.zip(files.iter().map(|file| Some(file.as_path()))).collect();
    for (flag, output) in [("--plot", args.plot.as_deref()), ("--report", page_path.as_deref())] {
        output.map_or(Ok(()), |output| files::refuse_replacing(flag, output, &inputs))?;
    }
    warn(&parsed.warnings);
    let experiment = parsed.value;
    let settings = Settings::default();
    let verification = verify(&experiment, &settings)?;
    if let Some((path, format)) = plot {
        let drawing = hydrostat_report::verification_svg(&experiment, &verification);
        files::write(path, &format.encode(drawing)?)?;
    }
    if let (Some(folder), Some(path)) = (&args.report, &page_path) {
        let provenance = provenance(&settings, &files);
        let page = hydrostat_report::verification_page(&experiment, &verification, &provenance);
        files::make_folder(folder)?;
        files::write(path, page.as_bytes())?;
    }
    let stdout = if args.json {
        format!("{}\n", json::verification(&experiment, &verification))
    } else {
        comparison::table(&experiment, &verification)
    };
    // the verdict on the model is a result; a prediction that fails its own check is not one to trust
    let passed = verification.rows.iter().all(|row| row.failed.is_empty());
    Ok(Outcome { stdout, end: End::passed(passed) })
}

/// Reads an experiment and what it names, relative to its own folder; notes the paths. None is the built-in one.
fn read(path: Option<&Path>, read: &mut Vec<PathBuf>) -> Result<Parsed<Experiment>, Error> {
    let Some(path) = path else { return builtin::experiment() };
    let text = files::read_text(path)?;
    let name = path.to_string_lossy().into_owned();
    read.push(path.to_owned());
    let folder = path.parent().unwrap_or(Path::new(""));
    description::parse_experiment(&text, &name, &mut |file| {
        let linked = folder.join(file);
        read.push(linked.clone());
        files::read_text(&linked)
    })
}
