//! Reads `[budget]` of an experiment file, and the same from flags.

use super::Parsed;
use super::calibration::CalibrationFlags;
use super::experiment;
use super::quantity::{self, Kind};
use super::reader::Table;
use super::unit::quoted;
use crate::Error;
use crate::budget::{GRID_TILT, Source, Tolerance, usual};
use crate::calibrate::{Parameter, Problem, start};
use crate::verify::Experiment;

pub(super) const BUDGET_KEYS: &[&str] = &["tolerance"];

/// Reads an experiment with its tolerances: those of `[budget]`, with flags such as `length=0.5 mm` in their place or beside them, or
/// the usual ones where neither gives any.
///
/// # Errors
/// As `parse_experiment`; names of nothing, values of another kind.
pub fn parse_budget(
    text: &str,
    file: &str,
    load: &mut dyn FnMut(&str) -> Result<String, Error>,
    flags: &[String],
) -> Result<Parsed<(Experiment, Vec<Tolerance>)>, Error> {
    let Parsed { value: (experiment, asked), warnings } =
        experiment::read(text, file, load, &CalibrationFlags::default())?;
    let mut tolerances = asked.tolerances;
    for flag in flags {
        let (name, value) = flag.split_once('=').ok_or_else(|| {
            Error::new(format!("found --tolerance {}, expected NAME=VALUE", quoted(flag)))
                .hint("such as --tolerance \"length=0.5 mm\" or --tolerance \"youngs_modulus=2 %\"")
        })?;
        let new = tolerance(&experiment, name.trim(), value).map_err(|error| error.within("--tolerance"))?;
        tolerances.retain(|old| old.of != new.of);
        tolerances.push(new);
    }
    if tolerances.is_empty() {
        tolerances = usual(&experiment)?;
    }
    Ok(Parsed { value: (experiment, tolerances), warnings })
}

pub(super) fn read(experiment: &Experiment, table: &Table) -> Result<Vec<Tolerance>, Error> {
    let Some(node) = table.get("budget") else { return Ok(Vec::new()) };
    let expected = "a table, such as { length = \"0.5 mm\", youngs_modulus = \"2 %\" }";
    let node = node.table(BUDGET_KEYS)?.require("tolerance", expected)?;
    let read = |entry: &super::reader::Entry| {
        let text = entry.node.text("a standard deviation, such as \"0.5 mm\" or \"2 %\"")?;
        tolerance(experiment, &entry.name, text).map_err(|error| error.at(entry.node.place()))
    };
    node.entries(expected)?.iter().map(read).collect()
}

/// The tolerance of a name and a text.
fn tolerance(experiment: &Experiment, name: &str, text: &str) -> Result<Tolerance, Error> {
    if name == "reading_error" {
        return Err(Error::new(
            "the reading error is always part of the budget, as the experiment states it",
        )
        .hint("change reading_error under [[measure]]"));
    }
    if name == GRID_TILT {
        return Err(Error::new(format!("\"{GRID_TILT}\" is the name of 3 tolerances"))
            .hint("give one of grid_tilt.x, grid_tilt.y, grid_tilt.z, about that axis of the bench"));
    }
    let axis =
        name.strip_prefix(GRID_TILT).and_then(|rest| [".x", ".y", ".z"].iter().position(|a| *a == rest));
    let (of, kind) = match axis {
        Some(axis) => (Source::GridTilt { axis }, quantity::ANGLE),
        None => {
            let parameter = Parameter::named(experiment, name)?;
            let kind = parameter.parts[0].kind();
            (Source::Parameter(parameter), kind)
        }
    };
    let deviation = deviation(experiment, &of, &kind, text)?;
    if deviation <= 0.0 {
        return Err(Error::new(format!(
            "found {}, expected a standard deviation above 0",
            quoted(text.trim())
        ))
        .hint("what is known exactly has no place in the budget"));
    }
    Ok(Tolerance { name: name.to_owned(), of, deviation })
}

/// A quantity of the parameter's kind, or a part of its value.
fn deviation(experiment: &Experiment, of: &Source, kind: &Kind, text: &str) -> Result<f64, Error> {
    let part = quantity::scalar(text, &quantity::FRACTION).ok().filter(|_| *kind != quantity::FRACTION);
    let (Some(part), Source::Parameter(parameter)) = (part, of) else {
        return super::calibration::scalar(text, kind);
    };
    let problem = Problem::new(experiment.clone(), vec![parameter.clone()]);
    let value = start(&problem)?[0];
    if value == 0.0 {
        return Err(Error::new(format!("found {}, but the value is 0", quoted(text.trim())))
            .hint(format!("give {}", kind.expected())));
    }
    Ok(part * value.abs())
}
