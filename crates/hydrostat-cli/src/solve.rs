//! `hydrostat solve`: the shape of a robot under its loads.

use crate::derivatives::Derivatives;
use crate::plot::Format;
use crate::{End, Outcome, batch, files, json, summary, warn};
use clap::ValueEnum;
use hydrostat::statics::{self, Settings, Workspace};
use hydrostat::{Equilibrium, Error};
use hydrostat::{description, solution};
use std::path::PathBuf;
use std::time::Instant;

const STATIONS: usize = 101;
/// Points of a drawn backbone.
const PLOTTED: usize = 1001;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Robot file
    robot: PathBuf,
    /// Print everything as JSON
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the stations as CSV
    #[arg(long)]
    csv: bool,
    /// Draw side and front view to scale into a file .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Output stations, evenly spaced in arc length, both ends included [default: 101; in a batch none]
    #[arg(long, value_name = "K", value_parser = station_count)]
    stations: Option<usize>,
    /// Largest estimated position error, as a fraction of the length
    #[arg(long, value_name = "FRACTION", default_value_t = 1e-9, value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: f64,
    /// Tensions at the base, such as a=2N,b=0.5N; they replace the file's commands of these tendons
    #[arg(long, value_name = "TENDON=FORCE,..")]
    tension: Vec<String>,
    /// Lengths pulled in at the base, such as a=5mm; they replace the file's commands of these tendons
    #[arg(long, value_name = "TENDON=LENGTH,..")]
    displacement: Vec<String>,
    /// Tendons that were last paid out, such as a,b; matters with friction
    #[arg(long, value_name = "TENDON,..")]
    released: Vec<String>,
    /// Start from the shape in the JSON of an earlier solution, and follow its branch
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// Add how the tip moves with each tendon's command
    #[arg(long, conflicts_with = "csv")]
    jacobian: bool,
    /// Add how the tip gives way to a force and a moment on it
    #[arg(long, conflicts_with = "csv")]
    compliance: bool,
    /// Solve every row of a table with columns such as tension.a [N], displacement.a [mm], load.NAME.force x [N]
    #[arg(long, value_name = "FILE", requires = "out", conflicts_with_all = ["json", "csv", "plot", "from", "jacobian", "compliance"])]
    batch: Option<PathBuf>,
    /// Where the rows go, a file .parquet or .csv
    #[arg(long, value_name = "FILE", requires = "batch")]
    out: Option<PathBuf>,
    /// How the shape is found
    #[arg(long, value_enum, default_value_t = Method::Energy)]
    method: Method,
    /// Shooting intervals, with --method shooting; 1 is single shooting [default: one per integration step]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    shooting_intervals: Option<u16>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// Finds where the energy is stationary
    Energy,
    /// Integrates from the base and corrects the base wrench
    Shooting,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    let plot = args.plot.as_deref().map(|path| Format::of(path).map(|format| (path, format))).transpose()?;
    let inputs = [
        ("the robot file", Some(args.robot.as_path())),
        ("the solution to start from", args.from.as_deref()),
        ("the table of commands", args.batch.as_deref()),
    ];
    for (flag, output) in [("--plot", &args.plot), ("--out", &args.out)] {
        output.as_deref().map_or(Ok(()), |output| files::refuse_replacing(flag, output, &inputs))?;
    }
    if let (Some(intervals), Method::Energy) = (args.shooting_intervals, args.method) {
        return Err(Error::new(format!("--shooting-intervals {intervals} without --method shooting"))
            .hint("the energy method, which is the default, has no intervals"));
    }
    let parsed = description::parse_robot(&files::read_text(&args.robot)?, &args.robot.to_string_lossy())?;
    let (mut robot, mut warnings) = (parsed.value, parsed.warnings);
    description::parse_commands(
        &mut robot,
        &mut warnings,
        &args.tension,
        &args.displacement,
        &args.released,
    )?;
    warn(&warnings);
    let from = args.from.as_deref().map(json::read_stations).transpose()?;

    let method = match args.method {
        Method::Energy => solution::Method::Energy,
        Method::Shooting => solution::Method::Shooting,
    };
    let settings = Settings {
        method,
        tolerance: args.tolerance,
        stations: args.stations.unwrap_or(STATIONS),
        shooting_intervals: args.shooting_intervals.map(usize::from),
        ..Settings::default()
    };
    if let (Some(commands), Some(out)) = (&args.batch, &args.out) {
        let settings = Settings { stations: args.stations.unwrap_or(0), eigenvalue: false, ..settings };
        let flags = args.tension.iter().chain(&args.displacement).flat_map(|flag| flag.split(','));
        let flagged: Vec<&str> = flags.filter_map(|flag| Some(flag.split_once('=')?.0.trim())).collect();
        return batch::run(commands, out, &robot, &settings, &flagged);
    }
    let mut workspace = Workspace::default();
    let solve = |settings: &Settings, workspace: &mut Workspace| match &from {
        Some(stations) => statics::solve_from_in(&robot, settings, stations, workspace),
        None => statics::solve_in(&robot, settings, workspace),
    };
    // the time is that of the shape alone; the eigenvalue takes longer
    let start = Instant::now();
    solve(&Settings { eigenvalue: false, ..settings.clone() }, &mut Workspace::default())?;
    let took = start.elapsed();
    let shape = solve(&settings, &mut workspace)?;
    let derivatives = Derivatives::find(&robot, &mut workspace, args.jacobian, args.compliance)?;

    if let Some((path, format)) = plot {
        // a coil needs more points than a table
        let smooth =
            Settings { stations: settings.stations.max(PLOTTED), eigenvalue: false, ..settings.clone() };
        let smooth = Equilibrium { stations: solve(&smooth, &mut workspace)?.stations, ..shape.clone() };
        files::write(path, &format.encode(hydrostat_report::shape_svg(&robot, &smooth))?)?;
    }
    let failures = summary::failures(&shape);
    let stdout = if args.json {
        let mut all = json::solution(&robot, &shape, took);
        derivatives.add_to(&mut all, &robot);
        format!("{all}\n")
    } else if args.csv {
        summary::stations(&shape)
    } else {
        summary::text(&robot, &shape, took) + &derivatives.text(&robot)
    };
    if args.json || args.csv {
        warn(&failures);
    }
    Ok(Outcome { stdout, end: End::passed(failures.is_empty()) })
}

fn station_count(text: &str) -> Result<usize, String> {
    let count = text.parse().map_err(|_| "expected a whole number".to_owned())?;
    if (2..=1_000_001).contains(&count) { Ok(count) } else { Err("expected 2 to 1000001".to_owned()) }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value = text.parse().map_err(|_| "expected a number such as 1e-9".to_owned())?;
    if (1e-12..=1e-2).contains(&value) { Ok(value) } else { Err("expected 1e-12 to 1e-2".to_owned()) }
}
