//! Project tasks: `cargo xtask test` does all set-up and runs every check.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it talks to a developer")]

mod count;
mod docs;
mod drawings;
mod licences;
mod test;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const USAGE: &str = "\
usage: cargo xtask TASK
  test            set up and run every check
  docs            rewrite the documents that the program writes
  docs --check    fail if one of them is out of date
  drawings        kits of two robots, read by other programs
  count           instructions per solve, by valgrind (docs/performance.md)";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["test"] => test::run(),
        ["docs"] => docs::build().and_then(|()| docs::write()),
        ["docs", "--check"] => docs::build().and_then(|()| docs::check()),
        ["drawings"] => docs::build().and_then(|()| drawings::check()),
        ["count"] => count::count(),
        _ => Err(USAGE.to_owned()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// The workspace's folder.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace")
}

/// A command in the workspace's folder.
fn command(words: &[&str]) -> Command {
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).current_dir(root());
    command
}

/// Runs a command, its output shown.
fn run(words: &[&str]) -> Result<(), String> {
    match command(words).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{}` ended with {status}", words.join(" "))),
        Err(error) => Err(format!("cannot run `{}`: {error}", words[0])),
    }
}

/// Runs a command and returns what it prints.
fn capture(words: &[&str]) -> Result<String, String> {
    let output = command(words).output().map_err(|error| format!("cannot run `{}`: {error}", words[0]))?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr);
        return Err(format!("`{}` ended with {}\n{message}", words.join(" "), output.status));
    }
    String::from_utf8(output.stdout).map_err(|_| format!("`{}` does not print text", words.join(" ")))
}

/// The `hydrostat` program of the development profile; it lies beside this one.
fn hydrostat() -> Result<PathBuf, String> {
    let here = std::env::current_exe().map_err(|error| format!("cannot find this program: {error}"))?;
    Ok(here.with_file_name(format!("hydrostat{}", std::env::consts::EXE_SUFFIX)))
}
