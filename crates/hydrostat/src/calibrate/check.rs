//! Whether a problem asks for what can be.

use super::Problem;
use super::setup::Setup;
use crate::Error;

/// Factor on both sides of a value by which bounds for it are proposed.
const ROOM: f64 = 10.0;

impl Problem {
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.experiment.refuse_impossible_readings()?;
        if self.folds == 1 || self.folds > self.experiment.rows.len() {
            let (folds, rows) = (self.folds, self.experiment.rows.len());
            return Err(Error::new(format!("{rows} rows in {folds} folds, expected 2 to {rows} folds")));
        }
        if self.experiment.rows.is_empty() {
            return Err(Error::new("the experiment has no rows"));
        }
        if self.parameters.is_empty() {
            return Err(Error::new("nothing is free, so that there is nothing to calibrate"));
        }
        for (j, parameter) in self.parameters.iter().enumerate() {
            let earlier = self.parameters[..j]
                .iter()
                .find(|other| other.parts.iter().any(|part| parameter.parts.contains(part)));
            if let Some(other) = earlier {
                return Err(Error::new(format!(
                    "\"{}\" and \"{}\" free the same quantity",
                    other.name, parameter.name
                )));
            }
        }
        self.refuse_start_outside()?;
        let priors = self.parameters.iter().filter(|parameter| parameter.prior.is_some()).count();
        let (free, coordinates) = (self.parameters.len(), self.coordinates());
        if free > coordinates + priors {
            return Err(Error::new(format!(
                "{free} free parameters, but only {coordinates} measured coordinates"
            ))
            .hint("free fewer, tie some (a+b), give priors, or measure more"));
        }
        Ok(())
    }

    /// Where the user gives no bounds, a value of the files that no solid has is no start.
    pub(crate) fn refuse_start_outside(&self) -> Result<(), Error> {
        let files = Setup::new(&self.experiment);
        for parameter in self.parameters.iter().filter(|parameter| !parameter.bounded) {
            let (value, [low, high]) = (parameter.start(&files)?, parameter.bounds);
            if (low..=high).contains(&value) {
                continue;
            }
            let show = |value: f64| parameter.show(value, None);
            return Err(Error::new(format!(
                "the files have {} = {}, where a fit keeps it within {} to {} unless it is told otherwise",
                parameter.name,
                show(value),
                show(low),
                show(high)
            ))
            .hint(format!(
                "check that value and its unit; if it is meant, give bounds that hold it, such as --bounds \"{}={} to {}\"",
                parameter.name,
                show(value / ROOM),
                show(value * ROOM)
            )));
        }
        Ok(())
    }

    /// In words: parameters whose bounds of the user leave the files' value out.
    pub(crate) fn moved_starts(&self) -> Result<Vec<String>, Error> {
        let files = Setup::new(&self.experiment);
        let mut sentences = Vec::new();
        for parameter in self.parameters.iter().filter(|parameter| parameter.bounded) {
            let (stated, [low, high]) = (parameter.start(&files)?, parameter.bounds);
            if !(low..=high).contains(&stated) {
                sentences.push(format!(
                    "The file's {} = {} lies outside its bounds: {} is taken in its place.",
                    parameter.name,
                    parameter.show(stated, None),
                    parameter.show(stated.clamp(low, high), None)
                ));
            }
        }
        Ok(sentences)
    }
}
