//! No robot file makes the reader panic.
#![no_main]

use hydrostat::description::parse_robot;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(error) = parse_robot(text, "robot.toml") {
        assert!(!error.to_string().is_empty());
    }
});
