//! No table of measurements makes the reader panic.
#![no_main]

use hydrostat::description::{builtin, parse_experiment};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|table: &str| {
    let mut load = |path: &str| Ok(if path.ends_with("csv") { table } else { builtin::ROBOT }.to_string());
    if let Err(error) = parse_experiment(builtin::EXPERIMENT, "experiment.toml", &mut load) {
        assert!(!error.to_string().is_empty());
    }
});
