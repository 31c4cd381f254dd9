//! Reads `[calibrate]` of an experiment file, and the same from flags.

use super::quantity::{self, Kind};
use super::reader::{Node, Table, Value};
use super::unit::quoted;
use crate::Error;
use crate::calibrate::{Loss, Parameter, Prior, Problem};
use crate::verify::{Experiment, Row};

pub(super) const CALIBRATE_KEYS: &[&str] = &["free", "prior", "bounds", "loss", "starts", "folds", "holdout"];

/// Starts, and folds, of which each is a fit of its own.
const MOST_FITS: usize = 1000;

/// What the flags say; what they leave empty is the file's.
#[derive(Clone, Debug, Default)]
pub struct CalibrationFlags {
    /// Names, such as `youngs_modulus`.
    pub free: Vec<String>,
    /// Such as `youngs_modulus=54 GPa +- 3 GPa`.
    pub prior: Vec<String>,
    /// Such as `length=380 mm to 400 mm`.
    pub bounds: Vec<String>,
    pub loss: Option<Loss>,
    pub starts: Option<usize>,
    pub folds: Option<usize>,
    /// A table like that of the experiment that the fit does not see, by its path relative to the experiment file.
    pub holdout: Option<String>,
}

/// `[calibrate]` as far as it can be read without flags.
#[derive(Clone, Debug, Default)]
pub(super) struct Wanted {
    parameters: Vec<Parameter>,
    loss: Loss,
    starts: Option<usize>,
    folds: Option<usize>,
    holdout: Vec<Row>,
}

/// The path of the table that is held out.
pub(super) fn holdout<'t>(table: &'t Table, flags: &'t CalibrationFlags) -> Result<Option<&'t str>, Error> {
    if flags.holdout.is_some() {
        return Ok(flags.holdout.as_deref());
    }
    let Some(node) = table.get("calibrate") else { return Ok(None) };
    let node = node.table(CALIBRATE_KEYS)?.get("holdout");
    node.map(|node| node.text("a table, such as \"holdout.csv\"")).transpose()
}

pub(super) fn read(experiment: &Experiment, table: &Table, holdout: Vec<Row>) -> Result<Wanted, Error> {
    let Some(node) = table.get("calibrate") else {
        return Ok(Wanted { holdout, ..Wanted::default() });
    };
    let table = node.table(CALIBRATE_KEYS)?;
    let expected = "a list of parameters, such as [\"youngs_modulus\"]";
    let free = table.require("free", expected)?;
    let Value::List(names) = &free.value else {
        return Err(free.refuse(expected));
    };
    let named = |node: &Node| {
        Parameter::named(experiment, node.text(expected)?).map_err(|error| error.at(node.place()))
    };
    let mut parameters = names.iter().map(named).collect::<Result<Vec<_>, Error>>()?;
    for (key, set) in [("prior", set_prior as SetText), ("bounds", set_bounds)] {
        let Some(node) = table.get(key) else { continue };
        for entry in node.entries("a table, such as { youngs_modulus = \"54 GPa +- 3 GPa\" }")? {
            let text = entry.node.text("a text, such as \"54 GPa +- 3 GPa\"")?;
            find(&mut parameters, &entry.name)
                .and_then(|parameter| set(parameter, text))
                .map_err(|error| error.at(entry.node.place()))?;
        }
    }
    let loss = match table.get("loss").map(|node| (node, &node.value)) {
        None => Loss::Squares,
        Some((_, Value::Text(text))) if text == "squares" => Loss::Squares,
        Some((_, Value::Text(text))) if text == "huber" => Loss::Huber,
        Some((node, _)) => return Err(node.refuse("\"squares\" or \"huber\"")),
    };
    let whole = |key: &str, least: usize| -> Result<Option<usize>, Error> {
        let Some(node) = table.get(key) else { return Ok(None) };
        let expected = format!("a whole number from {least} to {MOST_FITS}");
        let number = node.number(&expected)?;
        let whole = number.fract() == 0.0 && (least as f64..=MOST_FITS as f64).contains(&number);
        if whole { Ok(Some(number as usize)) } else { Err(node.refuse(&expected)) }
    };
    let (starts, folds) = (whole("starts", 1)?, whole("folds", 2)?);
    Ok(Wanted { parameters, loss, starts, folds, holdout })
}

type SetText = fn(&mut Parameter, &str) -> Result<(), Error>;

/// The file's wishes with those of the flags in their place.
pub(super) fn problem(
    experiment: Experiment,
    mut wanted: Wanted,
    flags: &CalibrationFlags,
) -> Result<Problem, Error> {
    if !flags.free.is_empty() {
        let names = flags.free.iter().flat_map(|text| text.split(',')).map(str::trim);
        let named = names.map(|name| {
            let same = wanted.parameters.iter().find(|parameter| parameter.name == name);
            same.cloned().map_or_else(
                || Parameter::named(&experiment, name).map_err(|error| error.within("--free")),
                Ok,
            )
        });
        wanted.parameters = named.collect::<Result<_, Error>>()?;
    }
    if wanted.parameters.is_empty() {
        return Err(Error::new("nothing is free").hint(
            "name what may change: --free youngs_modulus,length, or free = [\"youngs_modulus\"] under [calibrate] in the experiment file",
        ));
    }
    for (flag, texts, set) in
        [("--prior", &flags.prior, set_prior as SetText), ("--bounds", &flags.bounds, set_bounds)]
    {
        for text in texts {
            let (name, value) = text.split_once('=').ok_or_else(|| {
                Error::new(format!("found {flag} {}, expected NAME=VALUE", quoted(text)))
                    .hint("such as --prior \"youngs_modulus=54 GPa +- 3 GPa\" or --bounds \"length=380 mm to 400 mm\"")
            })?;
            find(&mut wanted.parameters, name.trim())
                .and_then(|parameter| set(parameter, value))
                .map_err(|error| error.within(&format!("{flag} {}", quoted(text))))?;
        }
    }
    let loss = flags.loss.unwrap_or(wanted.loss);
    Ok(Problem {
        experiment,
        parameters: wanted.parameters,
        loss,
        starts: flags.starts.or(wanted.starts).unwrap_or(1),
        folds: flags.folds.or(wanted.folds).unwrap_or(0),
        holdout: wanted.holdout,
    })
}

fn find<'p>(parameters: &'p mut [Parameter], name: &str) -> Result<&'p mut Parameter, Error> {
    let names: Vec<String> = parameters.iter().map(|parameter| parameter.name.clone()).collect();
    parameters.iter_mut().find(|parameter| parameter.name == name).ok_or_else(|| {
        Error::new(format!("{} is not free", quoted(name))).hint(format!("free are: {}", names.join(", ")))
    })
}

/// A quantity, or a pure number for what has no dimension.
pub(super) fn scalar(text: &str, kind: &Kind) -> Result<f64, Error> {
    match text.trim().parse::<f64>() {
        Ok(number) if *kind == quantity::FRACTION && number.is_finite() => Ok(number),
        _ => quantity::scalar(text, kind),
    }
}

fn set_prior(parameter: &mut Parameter, text: &str) -> Result<(), Error> {
    let kind = parameter.parts[0].kind();
    let (value, error) = text.split_once("+-").or_else(|| text.split_once('±')).ok_or_else(|| {
        Error::new(format!(
            "found {}, expected a value and its standard error, such as \"54 GPa +- 3 GPa\"",
            quoted(text)
        ))
    })?;
    let value = scalar(value, &kind)?;
    // a part of the value, or a quantity of its kind
    let relative = quantity::scalar(error, &quantity::FRACTION).ok().filter(|_| kind != quantity::FRACTION);
    let standard_error = match relative {
        Some(part) => part * value.abs(),
        None => scalar(error, &kind)?,
    };
    if standard_error <= 0.0 {
        return Err(Error::new(format!("found {}, expected a standard error above 0", quoted(text)))
            .hint("a parameter that is known exactly is not free"));
    }
    if !parameter.bounded {
        // what is known beforehand is no longer what any solid may have
        parameter.bounds = [parameter.parts[0].lowest_possible(), f64::INFINITY];
    }
    parameter.prior = Some(Prior { value, standard_error });
    Ok(())
}

fn set_bounds(parameter: &mut Parameter, text: &str) -> Result<(), Error> {
    let kind = parameter.parts[0].kind();
    let (low, high) = text.split_once(" to ").ok_or_else(|| {
        Error::new(format!("found {}, expected two values, such as \"380 mm to 400 mm\"", quoted(text)))
    })?;
    let (low, high) = (scalar(low, &kind)?, scalar(high, &kind)?);
    if low >= high {
        return Err(Error::new(format!("found {}, expected the lower bound first", quoted(text))));
    }
    let lowest = parameter.parts[0].lowest_possible();
    if high <= lowest {
        return Err(Error::new(format!("found {}, expected values above 0", quoted(text))));
    }
    parameter.bounds = [low.max(lowest), high];
    parameter.bounded = true;
    Ok(())
}
