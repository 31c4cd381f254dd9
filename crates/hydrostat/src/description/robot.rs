//! Reads a robot file.

use super::quantity::{ACCELERATION, LENGTH, rounded};
use super::reader::{Node, Source, Table, is_name};
use super::{Parsed, fabrication, load, materials, section, tendon};
use crate::Error;
use crate::model::{LoadKind, Pose, Robot, Tendon};
use nalgebra::{Matrix3, Rotation3, Vector3};

pub(super) const ROBOT_KEYS: &[&str] =
    &["name", "gravity", "base", "material", "section", "load", "tendon", "actuation", "fabrication"];
pub(super) const BASE_KEYS: &[&str] = &["position", "tangent", "normal"];

const FASTEST_GRAVITY: f64 = 100.0; // ten times the Earth's
const SLOWEST_GRAVITY: f64 = 0.1; // a sixteenth of the Moon's

/// Reads a robot file; `file` is the name that messages show.
pub fn parse_robot(text: &str, file: &str) -> Result<Parsed<Robot>, Error> {
    let source = Source::new(file, text);
    let mut warnings = Vec::new();
    let robot = read(&source.parse()?, &mut warnings)?;
    Ok(Parsed { value: robot, warnings })
}

pub(super) fn read(root: &Node, warnings: &mut Vec<Error>) -> Result<Robot, Error> {
    let table = root.table(ROBOT_KEYS)?;
    let name =
        table.require("name", "the robot's name, such as \"trunk\"")?.text("a name, such as \"trunk\"")?;
    let gravity = read_gravity(&table, warnings)?;
    let base = read_base(&table)?;
    let materials = materials::read(&table, warnings)?;
    let sections = section::read(&table, &materials, warnings)?;
    let length = sections.iter().map(|section| section.length).sum();
    let loads = load::read(&table, length)?;
    let tendons = tendon::read(&table, &sections, warnings)?;
    let passed = |tendon: &Tendon| sections.iter().take(tendon.ends + 1).map(|section| section.length).sum();
    let actuation = tendon::read_actuation(&table, &tendons, passed, warnings)?;
    fabrication::read(&table)?; // held to the format by every command, used by one
    let hung = loads.iter().any(|load| matches!(load.kind, LoadKind::Mass { .. }));
    if let Some(node) = table.get("gravity").filter(|_| hung && gravity == Vector3::zeros()) {
        warnings.push(node.error("without gravity a hung mass weighs nothing"));
    }
    Ok(Robot { name: name.to_string(), gravity, base, sections, tendons, loads, actuation })
}

fn read_gravity(table: &Table, warnings: &mut Vec<Error>) -> Result<Vector3<f64>, Error> {
    let Some(node) = table.get("gravity") else {
        return Ok(Vector3::new(0.0, 0.0, -9.81));
    };
    let gravity = node.vector(&ACCELERATION)?;
    let size = gravity.norm();
    if size > FASTEST_GRAVITY || (size > 0.0 && size < SLOWEST_GRAVITY) {
        warnings.push(
            node.error(format!("a gravity of {} m/s^2 is implausible", rounded(gravity.norm())))
                .hint("the Earth's is 9.81 m/s^2"),
        );
    }
    Ok(gravity)
}

fn read_base(table: &Table) -> Result<Pose, Error> {
    let base = table.get("base").map(|node| node.table(BASE_KEYS)).transpose()?;
    let get = |key| base.and_then(|base| base.get(key));
    let position = get("position").map_or(Ok(Vector3::zeros()), |node| node.vector(&LENGTH))?;
    let tangent = get("tangent").map_or(Ok(Vector3::z()), Node::direction)?;
    let normal = get("normal").map_or_else(|| Ok(default_normal(&tangent)), Node::direction)?;
    let d1 = perpendicular(&normal, &tangent)
        .ok_or_else(|| get("normal").unwrap_or(table.node).error("the normal is parallel to the tangent"))?;
    let columns = [d1, tangent.cross(&d1), tangent];
    Ok(Pose { position, rotation: Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns)) })
}

/// World x, or world y for a backbone within 45 degrees of the x axis.
fn default_normal(tangent: &Vector3<f64>) -> Vector3<f64> {
    if tangent.x.abs() > std::f64::consts::FRAC_1_SQRT_2 { Vector3::y() } else { Vector3::x() }
}

/// The part of one unit vector that is perpendicular to another, with length 1; None within 1e-6 rad of it.
pub(super) fn perpendicular(vector: &Vector3<f64>, to: &Vector3<f64>) -> Option<Vector3<f64>> {
    let across = (vector - to * to.dot(vector)).try_normalize(1e-6)?;
    (across - to * to.dot(&across)).try_normalize(0.5) // once more against rounding
}

/// A name that can stand in a path, a column header and a flag.
pub(super) fn read_name<'n>(node: &'n Node, taken: &[&str]) -> Result<&'n str, Error> {
    let expected = "a name of letters, digits, - and _";
    let name = node.text(expected)?;
    if !is_name(name) {
        return Err(node.refuse(expected));
    }
    if taken.contains(&name) {
        return Err(node.error(format!("the name \"{name}\" is given twice")));
    }
    Ok(name)
}
