//! No quantity makes the reader panic, and what it reads is finite.
#![no_main]

use hydrostat::description::quantity::{DENSITY, LENGTH, list, scalar, vector};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    for kind in [LENGTH, DENSITY] {
        assert!(scalar(text, &kind).is_ok_and(f64::is_finite) || scalar(text, &kind).is_err());
        let _ = vector(text, &kind);
        assert!(list(text, &kind).unwrap_or_default().iter().all(|value| value.is_finite()));
    }
});
