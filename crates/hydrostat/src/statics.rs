//! How the shape is found.

use crate::{Equilibrium, Error, Robot};

/// How accurately to solve and how much to report.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Largest estimated position error, as a fraction of the length.
    pub tolerance: f64,
    /// Number of output stations, evenly spaced in s, both ends included.
    pub stations: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            tolerance: 1e-9,
            stations: 101,
        }
    }
}

/// Finds the equilibrium on the branch that starts at the unloaded shape.
pub fn solve(_robot: &Robot, _settings: &Settings) -> Result<Equilibrium, Error> {
    Err(Error::new("not written yet"))
}
