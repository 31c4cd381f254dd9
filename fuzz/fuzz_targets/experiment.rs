//! No experiment file makes the reader panic.
#![no_main]

use hydrostat::description::{builtin, parse_experiment};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let mut load = |path: &str| Ok(if path.ends_with("csv") { builtin::TABLE } else { builtin::ROBOT }.to_string());
    if let Err(error) = parse_experiment(text, "experiment.toml", &mut load) {
        assert!(!error.to_string().is_empty());
    }
});
