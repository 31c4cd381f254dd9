//! The files that the program carries: the rod and the bench of Gray 2009.

use super::{
    CalibrationFlags, Parsed, PlanFlags, parse_budget, parse_calibration, parse_experiment, parse_plan,
    parse_robot,
};
use crate::budget::Tolerance;
use crate::calibrate::{Calibration, Problem};
use crate::plan::Request;
use crate::verify::Experiment;
use crate::{Error, Robot};

pub const ROBOT: &str = include_str!("../../../../robots/gray2009_rod.toml");
pub const EXPERIMENT: &str = include_str!("../../../../experiments/gray2009/stated.toml");
pub const FITTED_EXPERIMENT: &str = include_str!("../../../../experiments/gray2009/fitted_weight.toml");
pub const TABLE: &str = include_str!("../../../../experiments/gray2009/table2.csv");

const ROBOT_PATH: &str = "../../robots/gray2009_rod.toml";
const TABLE_PATH: &str = "table2.csv";

/// The rod of Gray 2009.
pub fn robot() -> Result<Parsed<Robot>, Error> {
    parse_robot(ROBOT, "robots/gray2009_rod.toml")
}

/// Table 2 of Gray 2009, with the values that the thesis states.
pub fn experiment() -> Result<Parsed<Experiment>, Error> {
    parse_experiment(EXPERIMENT, "experiments/gray2009/stated.toml", &mut load)
}

/// What `calibrate` frees of that table, one after the other, where nothing is named.
pub const FREED: [&str; 2] = ["youngs_modulus", "youngs_modulus,length"];

/// Table 2 of Gray 2009 with what is free.
pub fn calibration(flags: &CalibrationFlags) -> Result<Parsed<Problem>, Error> {
    parse_calibration(EXPERIMENT, "experiments/gray2009/stated.toml", &mut load, flags)
}

/// The same with the weight that the thesis's own prediction was made with.
pub fn fitted_experiment() -> Result<Parsed<Experiment>, Error> {
    parse_experiment(FITTED_EXPERIMENT, "experiments/gray2009/fitted_weight.toml", &mut load)
}

/// Table 2 of Gray 2009 with the tolerances of flags, or the usual ones.
pub fn budget(flags: &[String]) -> Result<Parsed<(Experiment, Vec<Tolerance>)>, Error> {
    parse_budget(EXPERIMENT, "experiments/gray2009/stated.toml", &mut load, flags)
}

/// Table 2 of Gray 2009 with what is free and what may be measured next.
pub fn plan(free: &CalibrationFlags, flags: &PlanFlags) -> Result<Parsed<Request>, Error> {
    parse_plan(EXPERIMENT, "experiments/gray2009/stated.toml", &mut load, free, flags)
}

/// The text of the rod's file with the values of a calibration.
pub fn write_calibrated(calibration: &Calibration, note: &[String]) -> Result<String, Error> {
    super::write_calibrated(EXPERIMENT, "experiments/gray2009/stated.toml", &mut load, calibration, note)
}

/// Fetches a carried file by the path that the carried experiments give it.
fn load(path: &str) -> Result<String, Error> {
    match path {
        ROBOT_PATH => Ok(ROBOT.to_string()),
        TABLE_PATH => Ok(TABLE.to_string()),
        _ => Err(Error::new(format!("no file \"{path}\" is built in"))),
    }
}
