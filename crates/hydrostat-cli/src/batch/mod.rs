//! `hydrostat solve --batch`: many commands of one robot into one file.
//!
//! Rows are solved on all cores while a thread writes those that are done. Ctrl-C ends the file after the last of them.

#[cfg(feature = "parquet")]
mod parquet;
mod table;
mod writer;

use crate::{End, Outcome, files, warn};
use hydrostat::batch::{Chunk, Commands, Input, solve_many};
use hydrostat::statics::Settings;
use hydrostat::{Error, Robot, description};
use indicatif::{ProgressBar, ProgressStyle};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;
use std::time::Instant;
use table::{Table, status};
use writer::Writer;

/// Failing rows that are named.
const NAMED: usize = 5;
/// Chunks that may wait for the writer, and that it takes together.
const QUEUE: usize = 256;
const TOGETHER: usize = 32;

/// What became of the rows.
#[derive(Default)]
struct Tally {
    rows: usize,
    errors: usize,
    /// Rows of which a check fails.
    failing: usize,
    first: Vec<String>,
}

/// `flagged`: tendons that flags command.
pub(crate) fn run(
    commands: &Path,
    out: &Path,
    robot: &Robot,
    settings: &Settings,
    flagged: &[&str],
) -> Result<Outcome, Error> {
    writer::check_name(out, settings.stations)?;
    let text = files::read_table(commands)?;
    let commands = description::parse_command_table(&text, &commands.to_string_lossy(), robot)?;
    drop(text);
    warn(replaced(&commands, robot, flagged));
    let mut writer = Writer::create(out, &Table::new(robot, settings.stations, &[]))?;
    let stop = stop_at_ctrl_c(writer.beside().to_owned())?;
    let bar = progress(commands.rows());

    let began = Instant::now();
    let (send, receive) = sync_channel(QUEUE);
    let (solved, written) = thread::scope(|scope| {
        let writing = scope.spawn(|| write(receive, robot, settings.stations, &mut writer));
        let solved = solve_many(
            robot,
            &commands,
            settings,
            || stop.load(Ordering::Relaxed),
            |chunk: Chunk| {
                bar.inc(chunk.rows.len() as u64);
                if send.send(chunk).is_err() {
                    stop.store(true, Ordering::Relaxed); // the writer has failed
                }
            },
        );
        drop(send);
        (solved, writing.join().expect("the writer does not panic"))
    });
    bar.finish_and_clear();
    solved?;
    let tally = written?;
    writer.finish()?;
    Ok(tally.outcome(out, commands.rows(), began.elapsed().as_secs_f64()))
}

/// A warning where columns replace what flags command.
fn replaced(commands: &Commands, robot: &Robot, flagged: &[&str]) -> Option<String> {
    let tendon = |input: &Input| match input {
        Input::Tension { tendon } | Input::Displacement { tendon } => {
            Some(robot.tendons[*tendon].name.as_str())
        }
        _ => None,
    };
    let names: Vec<&str> =
        commands.inputs.iter().filter_map(tendon).filter(|name| flagged.contains(name)).collect();
    (!names.is_empty())
        .then(|| format!("the table's columns replace the flags' commands of {}", names.join(", ")))
}

/// A flag that Ctrl-C sets; the second time it ends the program and removes the unfinished file.
fn stop_at_ctrl_c(unfinished: PathBuf) -> Result<Arc<AtomicBool>, Error> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            let _ = fs::remove_file(&unfinished); // gone already where it is complete
            std::process::exit(crate::INTERRUPTED.into());
        }
    };
    ctrlc::set_handler(handler).map_err(|error| Error::new(format!("cannot listen for Ctrl-C: {error}")))?;
    Ok(stop)
}

/// Drawn where stderr is a terminal.
fn progress(rows: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} rows, {per_sec}, {eta} left");
    ProgressBar::new(rows as u64).with_style(style.expect("the template is valid"))
}

/// Writes chunks as they come.
fn write(
    chunks: Receiver<Chunk>,
    robot: &Robot,
    stations: usize,
    writer: &mut Writer,
) -> Result<Tally, Error> {
    let mut tally = Tally::default();
    loop {
        let together: Vec<Chunk> = chunks.iter().take(TOGETHER).collect();
        if together.is_empty() {
            return Ok(tally);
        }
        together.iter().for_each(|chunk| tally.add(chunk));
        writer.write(&Table::new(robot, stations, &together))?;
    }
}

impl Tally {
    fn add(&mut self, chunk: &Chunk) {
        self.rows += chunk.rows.len();
        for (number, row) in (chunk.first + 1..).zip(&chunk.rows) {
            if row.as_ref().is_ok_and(|shape| shape.failed.is_empty()) {
                continue;
            }
            *(if row.is_ok() { &mut self.failing } else { &mut self.errors }) += 1;
            if self.first.len() < NAMED {
                self.first.push(format!("row {number}: {}", status(row)));
            }
        }
    }

    fn outcome(&self, out: &Path, all: usize, seconds: f64) -> Outcome {
        let Tally { rows, errors, failing, first } = self;
        let out = out.display();
        let mut end = End::passed(errors + failing == 0);
        if end == End::Fails {
            let more = if errors + failing > first.len() { ", the first of them" } else { "" };
            warn(&[format!(
                "{errors} of {rows} rows have no solution, {failing} fail a check{more}:\n  {}",
                first.join("\n  ")
            )]);
        }
        if *rows < all {
            warn(&[format!("interrupted: {rows} of {all} rows are in {out}")]);
            end = End::Interrupted;
        }
        let speed = *rows as f64 / seconds;
        Outcome { stdout: format!("{out}: {rows} rows in {seconds:.2} s, {speed:.0} per second\n"), end }
    }
}
