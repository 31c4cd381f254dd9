//! Reads `[plan]` of an experiment file, and the same from flags.

use super::calibration::{self, CalibrationFlags};
use super::quantity::{self, Kind};
use super::reader::{Node, Table, Value};
use super::unit::{Unit, quoted};
use super::{Parsed, experiment, tendon};
use crate::Error;
use crate::plan::{Choice, Limit, Request};
use crate::verify::{Experiment, Input, Varied};

pub(super) const PLAN_KEYS: &[&str] = &["limit", "measurements", "repeats"];

/// What the flags say; what they leave empty is the file's.
#[derive(Clone, Debug, Default)]
pub struct PlanFlags {
    /// Such as `mass=0 g to 100 g` or `mass=0 g, 20 g, 50 g`.
    pub limits: Vec<String>,
    pub measurements: Option<usize>,
    pub repeats: Option<usize>,
    pub seed: u64,
}

/// `[plan]` without flags.
#[derive(Clone, Debug, Default)]
pub(super) struct Wanted {
    limits: Vec<Limit>,
    measurements: Option<usize>,
    repeats: Option<usize>,
}

/// Rows to plan where nothing says how many.
const MEASUREMENTS: usize = 3;

/// Reads an experiment with what is free, by `[calibrate]`, and between which limits rows may be measured, by `[plan]`; flags come in
/// their place. A varied column without limits has those of its data.
///
/// # Errors
/// As `parse_calibration`; limits of nothing, of another kind, or impossible ones.
pub fn parse_plan(
    text: &str,
    file: &str,
    load: &mut dyn FnMut(&str) -> Result<String, Error>,
    free: &CalibrationFlags,
    flags: &PlanFlags,
) -> Result<Parsed<Request>, Error> {
    let Parsed { value: (experiment, asked), warnings } = experiment::read(text, file, load, free)?;
    let mut limits: Vec<Limit> =
        experiment.inputs.iter().enumerate().map(|(i, input)| of_data(&experiment, i, input)).collect();
    asked.plan.limits.into_iter().for_each(|limit| put(&mut limits, limit));
    for flag in &flags.limits {
        let (name, range) = flag.split_once('=').ok_or_else(|| {
            Error::new(format!(
                "found --limit {}, expected NAME=LOW to HIGH, or NAME=VALUE, VALUE",
                quoted(flag)
            ))
            .hint("such as --limit \"mass=0 g to 100 g\" or --limit \"mount_angle=0 deg, 30 deg, 60 deg\"")
        })?;
        let limit = limit(&experiment, name.trim(), range)
            .map_err(|error| error.within(&format!("--limit {}", quoted(flag))))?;
        put(&mut limits, limit);
    }
    let measurements = flags.measurements.or(asked.plan.measurements).unwrap_or(MEASUREMENTS);
    let repeats = flags.repeats.or(asked.plan.repeats).unwrap_or(1);
    let problem = calibration::problem(experiment, asked.calibration, free)?;
    Ok(Parsed { value: Request { problem, limits, measurements, repeats, seed: flags.seed }, warnings })
}

pub(super) fn read(experiment: &Experiment, table: &Table) -> Result<Wanted, Error> {
    let Some(node) = table.get("plan") else { return Ok(Wanted::default()) };
    let table = node.table(PLAN_KEYS)?;
    let mut limits = Vec::new();
    if let Some(node) = table.get("limit") {
        for entry in node.entries("a table, such as { mass = \"0 g to 100 g\" }")? {
            let limit = input(experiment, &entry.name)
                .and_then(|input| checked(experiment, input, |kind| chosen(&entry.node, kind)));
            put(&mut limits, limit.map_err(|error| error.or_at(|| entry.node.place()))?);
        }
    }
    let whole = |key: &str, expected: &str| {
        let Some(node) = table.get(key) else { return Ok(None) };
        let number = node.number(expected)?;
        let whole = number >= 1.0 && number.fract() == 0.0;
        if whole { Ok(Some(number as usize)) } else { Err(node.refuse(expected)) }
    };
    let measurements = whole("measurements", "a whole number above 0, such as 3")?;
    let repeats = whole("repeats", "a whole number above 0, such as 1")?;
    Ok(Wanted { limits, measurements, repeats })
}

/// A range as a text, or a list of values.
fn chosen(node: &Node, kind: &Kind) -> Result<Choice, Error> {
    let Value::List(items) = &node.value else {
        return choice(
            node.text("two values, such as \"0 g to 60 g\", or a list such as [\"0 g\", \"20 g\"]")?,
            kind,
        );
    };
    if items.is_empty() {
        return Err(node.refuse("one value at least"));
    }
    let value = |item: &Node| {
        let text = item.text("a value, such as \"20 g\"")?;
        if text.contains(" to ") {
            return Err(item.refuse("a value, such as \"20 g\": a range stands without brackets"));
        }
        quantity::scalar(text, kind).map_err(|error| error.at(item.place()))
    };
    Ok(values(items.iter().map(value).collect::<Result<_, Error>>()?))
}

/// Later limits of an input replace earlier ones.
fn put(limits: &mut Vec<Limit>, new: Limit) {
    match limits.iter_mut().find(|old| old.input.column == new.input.column) {
        Some(old) => *old = new,
        None => limits.push(new),
    }
}

fn of_data(experiment: &Experiment, i: usize, input: &Input) -> Limit {
    let values = || experiment.rows.iter().map(|row| row.inputs[i]);
    let range = [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)];
    Limit { input: input.clone(), choice: Choice::Range(range) }
}

fn limit(experiment: &Experiment, name: &str, text: &str) -> Result<Limit, Error> {
    checked(experiment, input(experiment, name)?, |kind| choice(text, kind))
}

/// What an input may be set to, unless that is impossible.
fn checked(
    experiment: &Experiment,
    input: Input,
    choose: impl Fn(&Kind) -> Result<Choice, Error>,
) -> Result<Limit, Error> {
    let kind = kind(input.quantity);
    let choice = choose(&kind)?;
    let [low, high] = choice.range();
    let lowest_is_zero = matches!(input.quantity, Varied::HungMass { .. } | Varied::Tension { .. });
    if lowest_is_zero && low < 0.0 {
        let (unit, size) = &input.unit;
        return Err(Error::new(format!("found {} {unit}, expected {} of at least 0", low / size, kind.name)));
    }
    if let Varied::Displacement { tendon, .. } = input.quantity {
        let of = &experiment.robot.tendons[tendon];
        tendon::check_displacement(high, of, experiment.robot.tendon_end(of))?;
    }
    Ok(Limit { input, choice })
}

/// Two values with `to` between them, or several with commas.
fn choice(text: &str, kind: &Kind) -> Result<Choice, Error> {
    let Some((low, high)) = text.split_once(" to ") else {
        if !text.contains(',') {
            return Err(Error::new(format!(
                "found {}, expected two values, such as \"{} to {}\", or a list of them with commas",
                quoted(text.trim()),
                kind.example,
                kind.example
            )));
        }
        let listed = text.split(',').map(|value| quantity::scalar(value, kind));
        return Ok(values(listed.collect::<Result<_, Error>>()?));
    };
    let range = [quantity::scalar(low, kind)?, quantity::scalar(high, kind)?];
    if range[0] > range[1] {
        return Err(Error::new(format!("found {}, expected the lower value first", quoted(text.trim()))));
    }
    Ok(Choice::Range(range))
}

/// Each once, in order.
fn values(mut values: Vec<f64>) -> Choice {
    values.sort_by(f64::total_cmp);
    values.dedup();
    Choice::Values(values)
}

/// A varied column, or what the bench could vary as well.
fn input(experiment: &Experiment, name: &str) -> Result<Input, Error> {
    if let Some(input) = experiment.inputs.iter().find(|input| input.column == name) {
        return Ok(input.clone());
    }
    let new = |quantity: Varied, unit: &str| -> Result<Input, Error> {
        let size = Unit::parse(unit)?.size();
        Ok(Input { column: name.to_owned(), unit: (unit.to_owned(), size), quantity })
    };
    let varied = |same: &dyn Fn(&Varied) -> bool| {
        experiment.inputs.iter().find(|input| same(&input.quantity)).cloned()
    };
    if name == "mount_angle" {
        let column = varied(&|quantity| *quantity == Varied::MountAngle);
        return column.map_or_else(|| new(Varied::MountAngle, "deg"), Ok);
    }
    if let Some((command, of)) = name.split_once('.').filter(|(c, _)| ["tension", "displacement"].contains(c))
    {
        let index = tendon::find(&experiment.robot.tendons, of)?;
        if let Some(column) = varied(&|quantity| quantity.tendon() == Some(index)) {
            return Err(Error::new(format!("tendon {} is varied already", quoted(of)))
                .hint(format!("its column: \"{}\"", column.column)));
        }
        return match command {
            "tension" => new(Varied::Tension { tendon: index }, "N"),
            _ => new(Varied::Displacement { tendon: index, backlash: 0.0 }, "mm"),
        };
    }
    let mut known: Vec<String> = experiment.inputs.iter().map(|input| input.column.clone()).collect();
    known.push("mount_angle".to_owned());
    let free = |i: &usize| !experiment.inputs.iter().any(|input| input.quantity.tendon() == Some(*i));
    known.extend(
        (0..experiment.robot.tendons.len())
            .filter(free)
            .map(|i| format!("tension.{0} or displacement.{0}", experiment.robot.tendons[i].name)),
    );
    Err(Error::new(format!("{} is nothing that is or could be varied here", quoted(name)))
        .hint(format!("what can be: {}", known.join(", "))))
}

fn kind(quantity: Varied) -> Kind {
    match quantity {
        Varied::HungMass { .. } => quantity::MASS,
        Varied::MountAngle => quantity::ANGLE,
        Varied::Force { .. } | Varied::Tension { .. } => quantity::FORCE,
        Varied::Displacement { .. } => quantity::LENGTH,
    }
}
