//! `cargo xtask test`: one line per check. All share the development profile, so that nothing is compiled twice.

use crate::{capture, docs, drawings, hydrostat, licences, root};
use std::path::Path;
use std::time::{Duration, Instant};

const WASM: &str = "wasm32-unknown-unknown";

/// Sets up, runs every check even after a failure, and sums up.
pub(crate) fn run() -> Result<(), String> {
    let mut steps = Steps::default();
    steps.step("set-up", set_up);
    if steps.failed() {
        return steps.sum_up(); // without the tools every check would fail for the same reason
    }
    steps.cargo("format", "fmt --all --check");
    steps.step("licences", licences::check);
    steps.cargo("clippy", "clippy --workspace --all-targets --all-features --locked -- -D warnings");
    steps.cargo("tests", "test --workspace --all-features --locked --no-fail-fast");
    steps.cargo("wasm32", &format!("build -p hydrostat --target {WASM} --locked"));
    if root().join("fuzz").is_dir() {
        steps.cargo("fuzz targets", "check --manifest-path fuzz/Cargo.toml --target-dir target");
    }
    steps.step("main job", || crate::run(&[&hydrostat()?.to_string_lossy(), "verify"]));
    steps.step("drawings", drawings::check);
    steps.step("documents", docs::check);
    steps.sum_up()
}

/// Installs what the checks need and rustup can give.
fn set_up() -> Result<(), String> {
    for (tool, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        if capture(&["cargo", tool, "--version"]).is_err() {
            install(&["rustup", "component", "add", component], &format!("`cargo {tool}` is missing"))?;
        }
    }
    let library = capture(&["rustc", "--print", "target-libdir", "--target", WASM])?;
    if !Path::new(library.trim()).is_dir() {
        install(&["rustup", "target", "add", WASM], &format!("the standard library for {WASM} is missing"))?;
    }
    Ok(())
}

fn install(words: &[&str], reason: &str) -> Result<(), String> {
    println!("{reason}; running `{}`", words.join(" "));
    crate::run(words).map_err(|error| {
        format!(
            "{reason} and could not be installed: {error}\nhint: run `{}` with a network",
            words.join(" ")
        )
    })
}

/// What has run so far.
#[derive(Default)]
struct Steps {
    done: Vec<(String, Duration, Result<(), String>)>,
}

impl Steps {
    fn cargo(&mut self, name: &str, arguments: &str) {
        println!("\n== {name}: cargo {arguments}");
        let words: Vec<&str> = ["cargo"].into_iter().chain(arguments.split(' ')).collect();
        self.time(name, || crate::run(&words));
    }

    fn step(&mut self, name: &str, check: impl FnOnce() -> Result<(), String>) {
        println!("\n== {name}");
        self.time(name, check);
    }

    fn time(&mut self, name: &str, check: impl FnOnce() -> Result<(), String>) {
        let start = Instant::now();
        let outcome = check();
        let took = start.elapsed();
        match &outcome {
            Ok(()) => println!("ok, {:.1} s", took.as_secs_f64()),
            Err(message) => println!("FAILED after {:.1} s: {message}", took.as_secs_f64()),
        }
        self.done.push((name.to_owned(), took, outcome));
    }

    fn failed(&self) -> bool {
        self.done.iter().any(|(_, _, outcome)| outcome.is_err())
    }

    fn sum_up(&self) -> Result<(), String> {
        println!("\n== summary");
        for (name, took, outcome) in &self.done {
            let word = if outcome.is_ok() { "ok" } else { "FAILED" };
            println!("{name:<14} {:>7.1} s  {word}", took.as_secs_f64());
        }
        let total: Duration = self.done.iter().map(|(_, took, _)| *took).sum();
        println!("{:<14} {:>7.1} s", "together", total.as_secs_f64());
        if self.failed() { Err("at least one check failed".to_owned()) } else { Ok(()) }
    }
}
