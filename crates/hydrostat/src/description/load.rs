//! Reads `[[load]]`.

use super::quantity::{FORCE, FORCE_PER_LENGTH, LENGTH, MASS, MOMENT, MOMENT_PER_LENGTH};
use super::reader::{Node, Table, Value};
use super::robot::read_name;
use super::section::in_mm;
use crate::Error;
use crate::model::{Frame, Load, LoadKind};
use nalgebra::Vector3;

pub(super) const LOAD_KEYS: &[&str] = &[
    "name",
    "at",
    "force",
    "moment",
    "mass",
    "frame",
    "from",
    "to",
    "force_per_length",
    "moment_per_length",
];

const POINT: &[&str] = &["at", "force", "moment", "mass"];
const DISTRIBUTED: &[&str] = &["from", "to", "force_per_length", "moment_per_length"];

pub(super) fn read(robot: &Table, length: f64) -> Result<Vec<Load>, Error> {
    let Some(node) = robot.get("load") else {
        return Ok(Vec::new());
    };
    let mut loads: Vec<Load> = Vec::new();
    for node in node.tables("load")? {
        let table = node.table(LOAD_KEYS)?;
        let taken: Vec<&str> = loads.iter().filter_map(|load| load.name.as_deref()).collect();
        let name = table.get("name").map(|node| read_name(node, &taken).map(str::to_string)).transpose()?;
        let kind = read_kind(&table, length)?;
        loads.push(Load { name, kind });
    }
    Ok(loads)
}

fn read_kind(table: &Table, length: f64) -> Result<LoadKind, Error> {
    let first = |keys: &[&str]| keys.iter().find_map(|key| table.get(key));
    match (first(POINT), first(DISTRIBUTED)) {
        (Some(_), Some(node)) => {
            Err(node.error("a load acts either at a point (at) or along a stretch (from, to)"))
        }
        (None, Some(_)) => read_distributed(table, length),
        _ if table.get("mass").is_some() => read_mass(table, length),
        _ => read_point(table, length),
    }
}

fn read_point(table: &Table, length: f64) -> Result<LoadKind, Error> {
    if table.get("force").is_none() && table.get("moment").is_none() {
        return Err(table
            .node
            .error("this load has no force, moment, mass, force_per_length or moment_per_length"));
    }
    let vector = |key, kind| table.get(key).map_or(Ok(Vector3::zeros()), |node| node.vector(kind));
    Ok(LoadKind::Point {
        at: read_at(table, length)?,
        force: vector("force", &FORCE)?,
        moment: vector("moment", &MOMENT)?,
        frame: read_frame(table)?,
    })
}

fn read_mass(table: &Table, length: f64) -> Result<LoadKind, Error> {
    for key in ["force", "moment", "frame"] {
        if let Some(node) = table.get(key) {
            return Err(node
                .error(format!(
                    "\"mass\" and \"{key}\" cannot stand in one load: a hung mass acts by its weight"
                ))
                .hint("loads add up: write a second [[load]]"));
        }
    }
    let mass = table.quantity("mass", &MASS)?.not_negative(&MASS)?;
    let at = read_at(table, length)?;
    Ok(LoadKind::Mass { at, mass })
}

fn read_distributed(table: &Table, length: f64) -> Result<LoadKind, Error> {
    if table.get("force_per_length").is_none() && table.get("moment_per_length").is_none() {
        return Err(table.node.error("a load along a stretch needs force_per_length or moment_per_length"));
    }
    let end = |key, default| table.get(key).map_or(Ok(default), |node| read_arc_length(node, length));
    let (from, to) = (end("from", 0.0)?, end("to", length)?);
    if from >= to {
        let node = table.get("from").or(table.get("to")).unwrap_or(table.node);
        return Err(node.error(format!(
            "the load's stretch, {} to {}, has no length",
            in_mm(from),
            in_mm(to)
        )));
    }
    let vector = |key, kind| table.get(key).map_or(Ok(Vector3::zeros()), |node| node.vector(kind));
    Ok(LoadKind::Distributed {
        from,
        to,
        force_per_length: vector("force_per_length", &FORCE_PER_LENGTH)?,
        moment_per_length: vector("moment_per_length", &MOMENT_PER_LENGTH)?,
        frame: read_frame(table)?,
    })
}

fn read_at(table: &Table, length: f64) -> Result<f64, Error> {
    read_arc_length(table.require("at", "\"tip\" or an arc length, such as \"120 mm\"")?, length)
}

/// `"tip"`, or an arc length from the base.
pub(super) fn read_arc_length(node: &Node, length: f64) -> Result<f64, Error> {
    match &node.value {
        Value::Text(text) if text.trim() == "tip" => return Ok(length),
        Value::Text(text) if text.trim_start().starts_with(char::is_alphabetic) => {
            return Err(node.refuse("\"tip\" or an arc length, such as \"120 mm\""));
        }
        _ => (),
    }
    let range = format!("from 0 mm to the robot's length, {}", in_mm(length));
    // A sum of sections may be short by rounding.
    let at = node.quantity_where(&LENGTH, &range, |at| at >= 0.0 && at <= length * (1.0 + 1e-9))?;
    Ok(at.min(length))
}

fn read_frame(table: &Table) -> Result<Frame, Error> {
    let Some(node) = table.get("frame") else {
        return Ok(Frame::World);
    };
    match &node.value {
        Value::Text(text) if text == "world" => Ok(Frame::World),
        Value::Text(text) if text == "body" => Ok(Frame::Body),
        _ => Err(node.refuse("\"world\" (a dead load) or \"body\" (follows the section)")),
    }
}
