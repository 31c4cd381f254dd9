//! `hydrostat verify`: the model against a measured bench.

use crate::{Outcome, comparison, files, json, pending, warn};
use hydrostat::Error;
use hydrostat::statics::Settings;
use hydrostat::verify::{Experiment, Verification, verify};
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
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    if let Some(folder) = &args.report {
        files::refuse_file(folder)?;
    }
    let mut inputs = Vec::new();
    let parsed = read(args.experiment.as_deref(), &mut inputs)?;
    warn(&parsed.warnings);
    let experiment = parsed.value;
    let verification = verify(&experiment, &Settings::default())?;
    if let Some(folder) = &args.report {
        write_page(folder, &experiment, &verification, inputs)?;
    }
    let stdout = if args.json {
        format!("{}\n", json::verification(&experiment, &verification))
    } else {
        comparison::table(&experiment, &verification)
    };
    Ok(Outcome { stdout, passed: true })
}

/// Reads an experiment and what it names, relative to its own folder; keeps every text for the report.
fn read(
    path: Option<&Path>,
    inputs: &mut Vec<(String, String)>,
) -> Result<pending::Parsed<Experiment>, Error> {
    let name = path.map_or(pending::GRAY2009.into(), Path::to_string_lossy);
    let folder = path.and_then(Path::parent).unwrap_or(Path::new(""));
    let mut load = |file: &str| {
        let text = match path {
            Some(_) => files::read_text(&folder.join(file))?,
            None => built_in(file)?,
        };
        inputs.push((file.to_owned(), text.clone()));
        Ok(text)
    };
    let text = match path {
        Some(path) => files::read_text(path)?,
        None => built_in(pending::GRAY2009)?,
    };
    let parsed = pending::parse_experiment(&text, &name, &mut load)?;
    inputs.insert(0, (name.into_owned(), text));
    Ok(parsed)
}

fn built_in(file: &str) -> Result<String, Error> {
    let text = pending::gray2009(file);
    text.map(str::to_owned)
        .ok_or_else(|| Error::new(format!("no built-in file named {file}")))
}

fn write_page(
    folder: &Path,
    experiment: &Experiment,
    verification: &Verification,
    inputs: Vec<(String, String)>,
) -> Result<(), Error> {
    let provenance = pending::Provenance {
        command: std::env::args().collect::<Vec<_>>().join(" "),
        version: env!("CARGO_PKG_VERSION"),
        inputs,
    };
    let page = pending::verification_page(experiment, verification, &provenance);
    files::make_folder(folder)?;
    files::write(&folder.join("index.html"), page.as_bytes())
}
