//! Tolerances of a bench in a student's laboratory, for where none are given.

use super::{Source, Tolerance};
use crate::Error;
use crate::calibrate::{Parameter, Problem, start};
use crate::model::{Command, CrossSection};
use crate::verify::{Experiment, Varied};

/// Of a data sheet's modulus or density.
const OF_MATERIAL: f64 = 0.02;
/// A drawn wire by micrometer, a rod by ruler, a hole by caliper, a cord's home, m.
const DIMENSION: f64 = 0.01e-3;
const LENGTH: f64 = 0.5e-3;
const HOLE: f64 = 0.1e-3;
const HOME: f64 = 0.1e-3;
/// Set by eye against a square or a spirit level; a hole about the backbone, degrees.
const ANGLE: f64 = 0.5;
const HOLE_ANGLE: f64 = 1.0;
/// A laboratory scale, kg.
const MASS: f64 = 0.1e-3;

/// Usual tolerances of what every bench has: material, dimensions, lengths, angles, masses, holes.
///
/// # Errors
/// None that a robot of the readers can have.
pub fn usual(experiment: &Experiment) -> Result<Vec<Tolerance>, Error> {
    let mut found = Vec::new();
    for (path, size) in places(experiment) {
        let parameter = shortest(experiment, &path)?;
        let deviation = match size {
            Size::Absolute(deviation) => deviation,
            Size::OfValue(part) => part * value(experiment, &parameter)?,
        };
        if deviation > 0.0 {
            found.push(Tolerance {
                name: parameter.name.clone(),
                of: Source::Parameter(parameter),
                deviation,
            });
        }
    }
    found.extend((0..3).map(|axis| Tolerance {
        name: format!("{GRID_TILT}.{}", ["x", "y", "z"][axis]),
        of: Source::GridTilt { axis },
        deviation: ANGLE.to_radians(),
    }));
    Ok(found)
}

/// Name of the grid's tilt about the bench's axes, before `.x`, `.y` or `.z`.
pub(crate) const GRID_TILT: &str = "grid_tilt";

enum Size {
    OfValue(f64),
    Absolute(f64),
}

/// Paths of parameters.
fn places(experiment: &Experiment) -> Vec<(String, Size)> {
    let robot = &experiment.robot;
    let mut places: Vec<(String, Size)> = Vec::new();
    for section in &robot.sections {
        let material = &section.material.name;
        let path = format!("material.{material}.youngs_modulus");
        if !places.iter().any(|(other, _)| *other == path) {
            places.push((path, Size::OfValue(OF_MATERIAL)));
            places.push((format!("material.{material}.density"), Size::OfValue(OF_MATERIAL)));
        }
    }
    for section in &robot.sections {
        places.push((format!("section.{}.length", section.name), Size::Absolute(LENGTH)));
        let keys: &[&str] = match section.profile.base {
            CrossSection::Round { .. } => &["diameter"],
            CrossSection::Tube { .. } => &["diameter", "inner_diameter"],
            CrossSection::Strip { .. } => &["width", "height"],
        };
        let path = |key| format!("section.{}.profile.{key}", section.name);
        places.extend(keys.iter().map(|key| (path(key), Size::Absolute(DIMENSION))));
    }
    for (i, tendon) in robot.tendons.iter().enumerate() {
        let path = |key| format!("tendon.{}.{key}", tendon.name);
        places.push((path("radius"), Size::Absolute(HOLE)));
        places.push((path("angle"), Size::Absolute(HOLE_ANGLE.to_radians())));
        let held = |input: &Varied| matches!(input, Varied::Displacement { tendon, .. } if *tendon == i);
        if matches!(robot.actuation[i], Command::Displacement { .. })
            || experiment.inputs.iter().any(|input| held(&input.quantity))
        {
            places.push((path("home"), Size::Absolute(HOME)));
        }
    }
    places.extend(angles(experiment).into_iter().map(|path| (path, Size::Absolute(ANGLE.to_radians()))));
    for (i, input) in experiment.inputs.iter().enumerate() {
        if matches!(input.quantity, Varied::HungMass { .. }) {
            places.push((format!("vary.{}.mass_offset", i + 1), Size::Absolute(MASS)));
        }
    }
    places
}

/// How the robot is mounted: about the bench's x and y axes where those are the world's, and the mount angle; else about all axes of
/// the world, which with one deviation is the same about any others.
fn angles(experiment: &Experiment) -> Vec<String> {
    let axes = experiment.axes.rotation.matrix();
    let along = |column: usize| (0..3).find(|&world| axes[(world, column)].abs() > 1.0 - 1e-9);
    let of = |axis: usize| format!("base.rotation.{}", ["x", "y", "z"][axis]);
    match (along(0), along(1)) {
        (Some(x), Some(y)) => vec!["bench.mount_angle".to_owned(), of(x), of(y)],
        _ => (0..3).map(of).collect(),
    }
}

/// The parameter of a path by the shortest end of it that is its alone; an axis needs the base that it is of.
fn shortest(experiment: &Experiment, path: &str) -> Result<Parameter, Error> {
    if path.starts_with("base.") {
        return Parameter::named(experiment, path);
    }
    let words: Vec<&str> = path.split('.').collect();
    let ends = (0..words.len()).rev().map(|from| words[from..].join("."));
    let mut found = ends.filter_map(|end| Parameter::named(experiment, &end).ok());
    found.next().map_or_else(|| Parameter::named(experiment, path), Ok)
}

fn value(experiment: &Experiment, parameter: &Parameter) -> Result<f64, Error> {
    let problem = Problem::new(experiment.clone(), vec![parameter.clone()]);
    Ok(start(&problem)?[0])
}
