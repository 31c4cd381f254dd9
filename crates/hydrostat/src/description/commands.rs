//! Reads tables of commands: CSV with a column for each input, as in `tension.a [N]` or `load.gripper.force x [N]`.

use super::data::{self, split_header, unit_of};
use super::quantity::{FORCE, FORCE_PER_LENGTH, Kind, LENGTH, MASS, MOMENT, MOMENT_PER_LENGTH, rounded};
use super::reader::{Source, nearest};
use super::tendon;
use super::unit::{Unit, quoted};
use crate::batch::{Commands, Input};
use crate::model::LoadKind;
use crate::{Error, Robot};
use std::ops::Range;

const AXES: [&str; 3] = ["x", "y", "z"];

struct Column {
    header: String,
    input: Input,
    unit: Unit,
}

/// Reads a table of commands for a robot; `file` is the name that messages show. A row that cannot be read is kept as broken.
///
/// # Errors
/// No rows, or a column that the robot does not have, of the wrong unit, or that sets what another one sets.
pub fn parse_command_table(text: &str, file: &str, robot: &Robot) -> Result<Commands, Error> {
    let source = Source::new(file, text);
    let mut lines = data::lines(text);
    let columns = read_columns(&source, &mut lines, robot)?;
    let width = columns.len();
    let inputs = columns.iter().map(|column| column.input).collect();
    let (mut values, mut broken) = (Vec::new(), Vec::new());
    for (row, line) in lines.enumerate() {
        if let Err(error) = read_row(&source, line, &columns, robot, &mut values) {
            broken.push((row, error));
        }
        values.resize((row + 1) * width, f64::NAN);
    }
    if values.is_empty() {
        return Err(data::no_rows(&source));
    }
    Ok(Commands { inputs, values, broken })
}

fn read_columns(
    source: &Source,
    lines: &mut impl Iterator<Item = Range<usize>>,
    robot: &Robot,
) -> Result<Vec<Column>, Error> {
    let known = known(robot);
    let mut columns: Vec<Column> = Vec::new();
    for cell in data::headers(source, lines)? {
        let at = |error: Error| error.at(source.place(cell.span.clone(), ""));
        let name = split_header(&cell.text).0;
        let (_, input, kind) =
            known.iter().find(|(known, ..)| known == name).ok_or_else(|| at(unknown(name, &known, robot)))?;
        if let Some(other) = columns.iter().find(|other| clash(other.input, *input)) {
            return Err(at(Error::new(format!(
                "the columns \"{}\" and \"{}\" set the same",
                other.header, cell.text
            ))
            .hint("keep one of them; a tendon has a tension or a displacement")));
        }
        let unit = unit_of(&cell.text, kind).map_err(at)?;
        columns.push(Column { header: cell.text, input: *input, unit });
    }
    Ok(columns)
}

/// Every column that a table for this robot may have.
fn known(robot: &Robot) -> Vec<(String, Input, &'static Kind)> {
    let mut known = Vec::new();
    for (tendon, at) in robot.tendons.iter().zip(0..) {
        known.push((format!("tension.{}", tendon.name), Input::Tension { tendon: at }, &FORCE));
        known.push((format!("displacement.{}", tendon.name), Input::Displacement { tendon: at }, &LENGTH));
    }
    for (number, load) in robot.loads.iter().enumerate() {
        let name = load.name.clone().unwrap_or_else(|| (number + 1).to_string());
        let [force, moment] = match load.kind {
            LoadKind::Point { .. } => [("force", &FORCE), ("moment", &MOMENT)],
            LoadKind::Distributed { .. } => {
                [("force_per_length", &FORCE_PER_LENGTH), ("moment_per_length", &MOMENT_PER_LENGTH)]
            }
            LoadKind::Mass { .. } => {
                known.push((format!("load.{name}.mass"), Input::Mass { load: number }, &MASS));
                continue;
            }
        };
        for (axis, letter) in AXES.into_iter().enumerate() {
            let column = |quantity: &str| format!("load.{name}.{quantity} {letter}");
            known.push((column(force.0), Input::Force { load: number, axis }, force.1));
            known.push((column(moment.0), Input::Moment { load: number, axis }, moment.1));
        }
    }
    known
}

fn unknown(name: &str, known: &[(String, Input, &Kind)], robot: &Robot) -> Error {
    let tendon = name.strip_prefix("tension.").or(name.strip_prefix("displacement."));
    if let Some(Err(error)) = tendon.map(|tendon| tendon::find(&robot.tendons, tendon)) {
        return error;
    }
    let names: Vec<&str> = known.iter().map(|(name, ..)| name.as_str()).collect();
    let error = Error::new(format!("unknown column {}", quoted(name)));
    match nearest(name, &names) {
        Some(near) => error.hint(format!("did you mean \"{near}\"?")),
        None if names.is_empty() => error.hint("this robot has no tendons and no loads to command"),
        None => error.hint(format!("columns of this robot: {}", names.join(", "))),
    }
}

/// Whether two columns set the same thing.
fn clash(one: Input, other: Input) -> bool {
    let tendon = |input| match input {
        Input::Tension { tendon } | Input::Displacement { tendon } => Some(tendon),
        _ => None,
    };
    one == other || (tendon(one).is_some() && tendon(one) == tendon(other))
}

/// Appends the values of one line, SI.
fn read_row(
    source: &Source,
    line: Range<usize>,
    columns: &[Column],
    robot: &Robot,
    values: &mut Vec<f64>,
) -> Result<(), Error> {
    let text = &source.text[line.clone()];
    let quoted_cells;
    let cells: &mut dyn Iterator<Item = &str> = if text.contains('"') {
        quoted_cells = data::cells(source, line)?;
        &mut quoted_cells.iter().map(|cell| cell.text.as_str())
    } else {
        &mut text.split(',').map(str::trim)
    };
    let mut found = 0;
    for cell in cells {
        if let Some(column) = columns.get(found) {
            let value = column.read(cell, robot);
            values.push(value.map_err(|error| error.within(&format!("column \"{}\"", column.header)))?);
        }
        found += 1;
    }
    if found != columns.len() {
        return Err(Error::new(format!("found {found} cells, but the header has {}", columns.len())));
    }
    Ok(())
}

impl Column {
    fn read(&self, cell: &str, robot: &Robot) -> Result<f64, Error> {
        let value = match cell.parse::<f64>() {
            Ok(value) if value.is_finite() => self.unit.to_si(cell),
            _ => f64::NAN,
        };
        if !value.is_finite() {
            let found = if cell.is_empty() { "an empty cell".to_string() } else { quoted(cell) };
            return Err(Error::new(format!("found {found}, expected a number")));
        }
        match self.input {
            Input::Tension { .. } => tendon::check_tension(value)?,
            Input::Displacement { tendon } => {
                let tendon = &robot.tendons[tendon];
                tendon::check_displacement(value, tendon, robot.tendon_end(tendon))?;
            }
            Input::Mass { .. } if value < 0.0 => {
                let found = rounded(value);
                return Err(Error::new(format!("found a mass of {found} kg, expected 0 kg or more")));
            }
            _ => {}
        }
        Ok(value)
    }
}
