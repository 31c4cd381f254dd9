//! The `hydrostat` command: flags, files and exit codes around the core.
//!
//! A command returns everything it wants to print; only this file writes to stdout, so that nothing is there when a
//! command fails. Exit codes: 0 solved, 1 solved but a check fails, 2 error, 130 interrupted.

#![allow(clippy::print_stderr, reason = "the binary prints")]

mod batch;
mod budget;
mod calibrate;
mod check;
mod comparison;
mod derivatives;
mod fabricate;
mod files;
mod free;
mod json;
mod new;
mod plan;
mod plot;
mod provenance;
mod solve;
mod summary;
mod text;
mod validate;
mod verify;

use clap::{Parser, Subcommand};
use hydrostat::Error;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// Predicts the shape of continuum robots and verifies it against measurements.
#[derive(Parser)]
#[command(
    name = "hydrostat",
    version,
    after_help = "Exit codes: 0 solved, 1 solved but a check fails, 2 error (message on stderr), 130 interrupted."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Find the shape of a robot under its loads
    Solve(solve::Args),
    /// Hold the model against a measured bench
    Verify(verify::Args),
    /// Fit parameters to a measured bench, and say how sure they are
    Calibrate(calibrate::Args),
    /// Hold a robot's design against what can be cut, wound and bent
    Check(check::Args),
    /// Make the kit: drawings for the laser, solids, lists and the assembly guide
    Fabricate(fabricate::Args),
    /// Find how much each tolerance moves what is measured
    Budget(budget::Args),
    /// Choose the measurements that tell most about what is free
    Plan(plan::Args),
    /// Hold the solver against published and exact solutions
    Validate(validate::Args),
    /// Write commented starter files into the current folder
    New(new::Args),
}

/// What a command that ran to its end has to say.
struct Outcome {
    stdout: String,
    end: End,
}

/// How it ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    Passed,
    /// A check or a row fails.
    Fails,
    /// By Ctrl-C, what was done is kept.
    Interrupted,
}

impl End {
    fn passed(passed: bool) -> End {
        if passed { End::Passed } else { End::Fails }
    }
}

/// As a shell gives it for a program that Ctrl-C ended.
const INTERRUPTED: u8 = 130;

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Solve(args) => solve::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Calibrate(args) => calibrate::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Fabricate(args) => fabricate::run(&args),
        Command::Budget(args) => budget::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Validate(args) => validate::run(&args),
        Command::New(args) => new::run(&args),
    };
    match outcome.and_then(|outcome| print(&outcome.stdout).map(|()| outcome.end)) {
        Ok(End::Passed) => ExitCode::SUCCESS,
        Ok(End::Fails) => ExitCode::from(1),
        Ok(End::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Writes to stdout; a reader that has seen enough (`| head`) is no error.
fn print(text: &str) -> Result<(), Error> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::new(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Shows what is doubtful but not wrong.
fn warn<T: std::fmt::Display>(warnings: impl IntoIterator<Item = T>) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}
