//! Puts calibrated values into the robot file that the user wrote: the rest of the text stays, comments and units too.

use super::quantity::{self as quantities, LENGTH};
use super::reader::{Source, Value as Read};
use super::unit::Unit;
use super::{parse_experiment, parse_robot};
use crate::Error;
use crate::calibrate::{Calibration, Dimension, Estimate, Part};
use crate::model::CrossSection::{self, Round, Strip, Tube};
use crate::model::{Material, Pose, Robot, Section};
use nalgebra::Vector3;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// The text of the robot file with the experiment's `set` and the calibrated values; `note` goes above it, line by line.
///
/// # Errors
/// Those of reading the experiment, or a file whose tables are not where the values belong.
pub fn write_calibrated(
    experiment: &str,
    file: &str,
    load: &mut dyn FnMut(&str) -> Result<String, Error>,
    calibration: &Calibration,
    note: &[String],
) -> Result<String, Error> {
    let source = Source::new(file, experiment);
    let root = source.parse()?;
    let entries = root.entries("a table")?;
    let of = |key: &str| entries.iter().find(|entry| entry.name == key).map(|entry| &entry.node);
    let path = of("robot").ok_or_else(|| Error::new("the experiment names no robot"))?;
    let text = load(path.text("a robot file")?)?;
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        Error::new(format!("the robot file is not TOML: {}", error.message()))
    })?;

    // what the experiment sets comes first, as in a run
    for entry in of("set").map_or(Ok(&[][..]), |set| set.entries("a table"))? {
        let new = match &entry.node.value {
            Read::Text(text) => Value::from(text.as_str()),
            Read::Number(number) => Value::from(*number),
            Read::List(items) => items.iter().filter_map(|item| item.number("a number").ok()).collect(),
            Read::Other(_) | Read::Table(_) => {
                return Err(entry.node.error("this value cannot be written into the robot file"));
            }
        };
        put(&mut document, &entry.name, new)?;
    }
    let stated = parse_robot(&document.to_string(), "the robot file")?.value;
    let mounted = parse_experiment(experiment, file, load)?.value;
    for estimate in &calibration.parameters {
        for part in &estimate.parameter.parts {
            write_part(
                &mut document,
                part,
                estimate,
                &stated,
                &mounted.robot,
                &mounted.axes,
                &calibration.robot,
            )?;
        }
    }

    let mut written = String::new();
    for line in note {
        written += format!("# {line}").trim_end();
        written.push('\n');
    }
    written += "\n";
    written += &document.to_string();
    // what is written must be what was found
    parse_robot(&written, "the calibrated robot")?;
    Ok(written)
}

fn write_part(
    document: &mut DocumentMut,
    part: &Part,
    estimate: &Estimate,
    stated: &Robot,
    mounted: &Robot,
    axes: &Pose,
    robot: &Robot,
) -> Result<(), Error> {
    let error = estimate.standard_error;
    let (unit, _) = part.display_unit();
    let number =
        |document: &mut DocumentMut, path: String, value: f64| quantity(document, &path, value, error, unit);
    let section = |i: usize| format!("section.{}", i + 1);
    let tendon = |i: usize| format!("tendon.{}", i + 1);
    match part {
        Part::YoungsModulus { material } | Part::ShearModulus { material } | Part::Density { material } => {
            let found = robot.sections.iter().map(|section| &section.material).find(|m| m.name == *material);
            write_material(
                document,
                part,
                found.ok_or_else(|| Error::new("the robot lost a material"))?,
                error,
            )
        }
        Part::Length { section: i } => {
            number(document, format!("{}.length", section(*i)), robot.sections[*i].length)?;
            write_guides(document, &section(*i), &stated.sections[*i], &robot.sections[*i])
        }
        Part::Dimension { section: i, which } => {
            let key = which.key();
            let profile = &robot.sections[*i].profile;
            number(document, format!("{}.profile.{key}", section(*i)), dimension(&profile.base, *which))?;
            let tip = format!("{}.profile.tip_{key}", section(*i));
            if get(document, &tip).is_some() {
                quantity(document, &tip, dimension(&profile.tip, *which), error, unit)?;
            }
            Ok(())
        }
        Part::RestCurvature { section: i, .. } => vector(
            document,
            &format!("{}.rest_curvature", section(*i)),
            &robot.sections[*i].rest_curvature,
            "1/m",
        ),
        Part::HoleRadius { tendon: i } => {
            number(document, format!("{}.radius", tendon(*i)), robot.tendons[*i].path.radius)?;
            let tip = format!("{}.tip_radius", tendon(*i));
            if get(document, &tip).is_some() {
                quantity(document, &tip, robot.tendons[*i].path.tip_radius, error, unit)?;
            }
            Ok(())
        }
        Part::HoleAngle { tendon: i } => {
            number(document, format!("{}.angle", tendon(*i)), robot.tendons[*i].path.angle)
        }
        Part::Stiffness { tendon: i } => {
            let stiffness = robot.tendons[*i].stiffness.unwrap_or(estimate.value);
            number(document, format!("{}.stiffness", tendon(*i)), stiffness)
        }
        Part::Friction { tendon: i } => {
            put(document, &format!("{}.friction", tendon(*i)), plain(robot.tendons[*i].friction))
        }
        Part::Home { tendon: i } => number(document, format!("{}.home", tendon(*i)), robot.tendons[*i].home),
        Part::GuideMass { section: i } => {
            let mass = robot.sections[*i].guides.as_ref().map_or(estimate.value, |guides| guides.mass);
            number(document, format!("{}.guides.mass", section(*i)), mass)
        }
        Part::BasePosition { .. } | Part::BaseRotation { .. } => {
            // without the mount angle of [bench], which stays in the experiment
            let turn = mounted.base.rotation * stated.base.rotation.inverse();
            let position = axes.position + turn.inverse() * (robot.base.position - axes.position);
            let rotation = turn.inverse() * robot.base.rotation;
            vector(document, "base.position", &position, "m")?;
            for (key, column) in [("tangent", 2), ("normal", 0)] {
                let direction = rotation.matrix().column(column);
                put(document, &format!("base.{key}"), direction.iter().map(|x| rounded(*x, 1e-9)).collect())?;
            }
            Ok(())
        }
        // the bench's: they stand in the note
        Part::MountAngle | Part::MassOffset { .. } | Part::Backlash { .. } | Part::MarkerOffset { .. } => {
            Ok(())
        }
    }
}

fn dimension(shape: &CrossSection, which: Dimension) -> f64 {
    match (*shape, which) {
        (Tube { inner_diameter, .. }, Dimension::InnerDiameter) => inner_diameter,
        (Round { diameter } | Tube { diameter, .. }, _) => diameter,
        (Strip { width, .. }, Dimension::Width) => width,
        (Strip { height, .. }, _) => height,
    }
}

/// A built-in material becomes one of the file; Poisson's ratio follows G, and a given G follows E.
fn write_material(
    document: &mut DocumentMut,
    part: &Part,
    material: &Material,
    error: Option<f64>,
) -> Result<(), Error> {
    let path = |key: &str| format!("material.{}.{key}", material.name);
    if get(document, &format!("material.{}", material.name)).is_none() {
        let materials = document.entry("material").or_insert_with(|| {
            let mut table = Table::new();
            table.set_implicit(true);
            Item::Table(table)
        });
        let materials = materials
            .as_table_mut()
            .ok_or_else(|| Error::new("\"material\" in the robot file is not a table"))?;
        materials.insert(&material.name, Item::Table(Table::new()));
        quantity(document, &path("youngs_modulus"), material.youngs_modulus, None, "GPa")?;
        quantity(document, &path("shear_modulus"), material.shear_modulus, None, "GPa")?;
        quantity(document, &path("density"), material.density, None, "g/cm^3")?;
        if let Some(limit) = material.strain_limit {
            quantity(document, &path("strain_limit"), limit, None, "%")?;
        }
    }
    let ratio = material.youngs_modulus / (2.0 * material.shear_modulus) - 1.0;
    match part {
        Part::Density { .. } => {
            return quantity(document, &path("density"), material.density, error, "g/cm^3");
        }
        Part::YoungsModulus { .. } => {
            quantity(document, &path("youngs_modulus"), material.youngs_modulus, error, "GPa")?
        }
        _ => {}
    }
    if get(document, &path("shear_modulus")).is_some() {
        return quantity(document, &path("shear_modulus"), material.shear_modulus, error, "GPa");
    }
    if matches!(part, Part::ShearModulus { .. }) {
        if ratio > -1.0 && ratio <= 0.5 {
            return put(document, &path("poisson_ratio"), plain(ratio));
        }
        if let Some(table) = parent(document, &format!("material.{}", material.name)) {
            table.remove("poisson_ratio");
        }
        return quantity(document, &path("shear_modulus"), material.shear_modulus, error, "GPa");
    }
    Ok(())
}

/// Guides keep their places in proportion to the section's length.
fn write_guides(
    document: &mut DocumentMut,
    section: &str,
    stated: &Section,
    found: &Section,
) -> Result<(), Error> {
    let growth = found.length / stated.length;
    let spacing = format!("{section}.guides.spacing");
    if let Some(old) = get(document, &spacing).and_then(|item| item.as_str().map(str::to_owned)) {
        let old = quantities::scalar(&old, &LENGTH)?;
        return quantity(document, &spacing, old * growth, Some(1e-6 * old), "mm");
    }
    let positions = format!("{section}.guides.positions");
    if let (Some(_), Some(guides)) = (get(document, &positions), &found.guides) {
        let list: Vec<String> =
            guides.positions.iter().map(|position| format!("{}", rounded(1e3 * position, 1e-6))).collect();
        return put(document, &positions, Value::from(format!("[{}] mm", list.join(", "))));
    }
    Ok(())
}

/// A value in the unit that the user has written there, with digits far below its standard error.
fn quantity(
    document: &mut DocumentMut,
    path: &str,
    si: f64,
    error: Option<f64>,
    otherwise: &str,
) -> Result<(), Error> {
    let written = get(document, path).and_then(|item| item.as_str()).map(str::to_owned);
    let unit = written.as_deref().map(|text| {
        text.trim()
            .trim_start_matches(|c: char| c.is_ascii_digit() || "+-.".contains(c))
            .trim_start()
            .to_owned()
    });
    // an exponent stands before the unit and would be taken for one
    let unit = unit.filter(|unit| Unit::parse(unit).is_ok()).unwrap_or_else(|| otherwise.to_owned());
    let size = Unit::parse(&unit)?.size();
    let step = match error {
        Some(error) if error > 0.0 => error / size / 1e3,
        _ => (si / size).abs().max(1e-9) / 1e9,
    };
    put(document, path, Value::from(format!("{} {unit}", rounded(si / size, step))))
}

fn vector(document: &mut DocumentMut, path: &str, si: &Vector3<f64>, otherwise: &str) -> Result<(), Error> {
    let written = get(document, path).and_then(|item| item.as_str()).map(str::to_owned);
    let unit =
        written.as_deref().and_then(|text| text.split_once(']')).map(|(_, unit)| unit.trim().to_owned());
    let unit = unit.unwrap_or_else(|| otherwise.to_owned());
    let size = Unit::parse(&unit)?.size();
    let list: Vec<String> =
        si.iter().map(|x| format!("{}", rounded(x / size, 1e-9 * (1.0 / size).max(1.0)))).collect();
    put(document, path, Value::from(format!("[{}] {unit}", list.join(", "))))
}

fn plain(number: f64) -> Value {
    Value::from(rounded(number, 1e-6))
}

/// To a power of ten at or below `step`.
fn rounded(value: f64, step: f64) -> f64 {
    let digits = (-step.log10().floor()).clamp(0.0, 15.0) as usize;
    let text = format!("{value:.digits$}");
    text.parse::<f64>().map_or(value, |number| number + 0.0)
}

/// What stands at a dotted path; elements of a list by their name or number from 1.
fn get<'d>(document: &'d DocumentMut, path: &str) -> Option<&'d Item> {
    // the same walk as for writing, on a table that nothing changes
    let (parents, last) = path.rsplit_once('.').unwrap_or(("", path));
    let mut table: &dyn TableLike = document.as_table();
    let mut parts = parents.split('.').filter(|part| !part.is_empty());
    while let Some(part) = parts.next() {
        let item = table.get(part)?;
        table = match item {
            Item::ArrayOfTables(tables) => {
                let names: Vec<Option<&str>> = tables.iter().map(name_of).collect();
                tables.get(index(&names, parts.next()?)?)?
            }
            Item::Value(Value::Array(array)) => {
                let tables: Vec<_> = array.iter().filter_map(Value::as_inline_table).collect();
                let names: Vec<Option<&str>> = tables.iter().map(|table| name_of(*table)).collect();
                *tables.get(index(&names, parts.next()?)?)?
            }
            _ => item.as_table_like()?,
        };
    }
    table.get(last)
}

fn parent<'d>(document: &'d mut DocumentMut, parents: &str) -> Option<&'d mut dyn TableLike> {
    let mut table: &mut dyn TableLike = document.as_table_mut();
    let mut parts = parents.split('.').filter(|part| !part.is_empty());
    while let Some(part) = parts.next() {
        let item = table.get_mut(part)?;
        table = match item {
            Item::ArrayOfTables(tables) => {
                let names: Vec<Option<&str>> = tables.iter().map(name_of).collect();
                let index = index(&names, parts.next()?)?;
                tables.get_mut(index)?
            }
            Item::Value(Value::Array(array)) => {
                let tables: Vec<_> = array.iter_mut().filter_map(Value::as_inline_table_mut).collect();
                let names: Vec<Option<&str>> = tables.iter().map(|table| name_of(&**table)).collect();
                let index = index(&names, parts.next()?)?;
                tables.into_iter().nth(index)?
            }
            _ => item.as_table_like_mut()?,
        };
    }
    Some(table)
}

fn name_of<T: TableLike>(table: &T) -> Option<&str> {
    table.get("name").and_then(Item::as_str)
}

fn index(names: &[Option<&str>], part: &str) -> Option<usize> {
    let named = names.iter().position(|name| *name == Some(part));
    named.or_else(|| part.parse::<usize>().ok()?.checked_sub(1))
}

/// Puts a value at a dotted path whose parents are there; spaces and comments around an older value stay.
fn put(document: &mut DocumentMut, path: &str, mut new: Value) -> Result<(), Error> {
    let (parents, last) = path.rsplit_once('.').unwrap_or(("", path));
    let missing = || Error::new(format!("the robot file has no place to write {path}"));
    if parents == "base" && get(document, "base").is_none() {
        document.insert("base", Item::Table(Table::new()));
    }
    let table = parent(document, parents).ok_or_else(missing)?;
    match table.get_mut(last) {
        Some(Item::Value(old)) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        Some(_) => return Err(missing()),
        None => {
            table.insert(last, Item::Value(new));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keep_their_unit_and_what_stands_around_them() {
        let text = "a = 1 # one\n[[section]]\nname = \"rod\"\nprofile = { diameter = \".0445 in\" } # printed\n\
                    length =  \"40 cm\"   # of which 1 cm is in the clamp\n";
        let mut document: DocumentMut = text.parse().expect("is TOML");
        quantity(&mut document, "section.rod.length", 0.391_41, Some(2e-4), "mm").expect("is written");
        quantity(&mut document, "section.1.profile.diameter", 0.001_2, Some(1e-6), "mm").expect("is written");
        // a thousandth of the standard error: 1e-5 cm and 1e-8 in
        let expected = text.replace("40 cm", "39.141 cm").replace(".0445 in", "0.04724409 in");
        assert_eq!(document.to_string(), expected);
        assert!(put(&mut document, "section.other.length", plain(1.0)).is_err());
    }
}
