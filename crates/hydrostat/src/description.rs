//! Text in, a robot or an experiment out. The format is `docs/format.md`.

mod budget;
pub mod builtin;
mod calibration;
mod commands;
mod data;
mod experiment;
mod fabrication;
mod load;
pub mod materials;
mod plan;
pub mod quantity;
mod reader;
mod rewrite;
mod robot;
mod section;
pub mod templates;
mod tendon;
pub mod unit;

#[cfg(test)]
mod format_test;

pub use budget::parse_budget;
pub use calibration::CalibrationFlags;
pub use commands::parse_command_table;
pub use experiment::{parse_calibration, parse_experiment};
pub use fabrication::parse_workshop;
pub use plan::{PlanFlags, parse_plan};
pub use rewrite::write_calibrated;
pub use robot::parse_robot;
pub use tendon::parse_commands;

use crate::Error;

/// What a text describes, with what is implausible about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Parsed<T> {
    pub value: T,
    /// To be shown to the user; none of them prevents a solution.
    pub warnings: Vec<Error>,
}
