//! Reads `[fabrication]`: how the kit of a robot is made.

use super::quantity::{ANGLE, DENSITY, LENGTH, MOMENT};
use super::reader::{Node, Source, Table};
use super::{Parsed, robot};
use crate::fabricate::{FRAMES, Frame, Workshop};
use crate::{Error, Robot};

pub(super) const FABRICATION_KEYS: &[&str] = &[
    "sheet_thickness",
    "sheet_size",
    "sheet_density",
    "kerf",
    "press_fit",
    "slot_clearance",
    "hole_clearance",
    "minimum_web",
    "part_spacing",
    "tendon_diameter",
    "screw_diameter",
    "motor_frame",
    "motor_length",
    "motor_torque",
    "motor_step",
    "microsteps",
    "spare_motors",
    "spool_diameter",
    "pulley_diameter",
    "rod_grip",
    "bench_size",
];

const MOST_MICROSTEPS: f64 = 256.0;
const MOST_SPARE_MOTORS: f64 = 12.0;

/// Reads a robot file with what it says of its making.
pub fn parse_workshop(text: &str, file: &str) -> Result<Parsed<(Robot, Workshop)>, Error> {
    let source = Source::new(file, text);
    let mut warnings = Vec::new();
    let root = source.parse()?;
    let robot = robot::read(&root, &mut warnings)?;
    let workshop = read(&root.table(robot::ROBOT_KEYS)?)?;
    Ok(Parsed { value: (robot, workshop), warnings })
}

/// The defaults where the table is missing.
pub(super) fn read(robot: &Table) -> Result<Workshop, Error> {
    let mut workshop = Workshop::default();
    let Some(node) = robot.get("fabrication") else { return Ok(workshop) };
    let table = node.table(FABRICATION_KEYS)?;
    workshop.given = FABRICATION_KEYS.iter().copied().filter(|key| table.get(key).is_some()).collect();
    for (key, length) in [
        ("sheet_thickness", &mut workshop.sheet_thickness),
        ("part_spacing", &mut workshop.part_spacing),
        ("tendon_diameter", &mut workshop.tendon_diameter),
        ("screw_diameter", &mut workshop.screw_diameter),
        ("motor_length", &mut workshop.motor.length),
        ("spool_diameter", &mut workshop.spool_diameter),
        ("pulley_diameter", &mut workshop.pulley_diameter),
        ("rod_grip", &mut workshop.rod_grip),
    ] {
        set(&table, key, length, |node| node.positive(&LENGTH))?;
    }
    for (key, length) in [
        ("kerf", &mut workshop.kerf),
        ("press_fit", &mut workshop.press_fit),
        ("slot_clearance", &mut workshop.slot_clearance),
        ("hole_clearance", &mut workshop.hole_clearance),
        ("minimum_web", &mut workshop.minimum_web),
    ] {
        set(&table, key, length, |node| node.not_negative(&LENGTH))?;
    }
    set(&table, "sheet_size", &mut workshop.sheet_size, read_size)?;
    set(&table, "bench_size", &mut workshop.bench_size, read_size)?;
    set(&table, "sheet_density", &mut workshop.sheet_density, |node| node.positive(&DENSITY))?;
    set(&table, "motor_frame", &mut workshop.motor.frame, read_frame)?;
    set(&table, "motor_torque", &mut workshop.motor.torque, |node| node.positive(&MOMENT))?;
    set(&table, "motor_step", &mut workshop.motor.step, read_step)?;
    set(&table, "microsteps", &mut workshop.motor.microsteps, |node| count(node, 1.0, MOST_MICROSTEPS))?;
    set(&table, "spare_motors", &mut workshop.spare_motors, |node| {
        Ok(Some(count(node, 0.0, MOST_SPARE_MOTORS)? as usize))
    })?;
    Ok(workshop)
}

/// Replaces a default by what the file has.
fn set<T>(
    table: &Table,
    key: &str,
    value: &mut T,
    read: impl Fn(&Node) -> Result<T, Error>,
) -> Result<(), Error> {
    if let Some(node) = table.get(key) {
        *value = read(node)?;
    }
    Ok(())
}

fn read_size(node: &Node) -> Result<[f64; 2], Error> {
    match node.list(&LENGTH)?[..] {
        [width, height] if width > 0.0 && height > 0.0 => Ok([width, height]),
        _ => Err(node.refuse("a width and a height above 0 m, such as \"[600, 300] mm\"")),
    }
}

fn read_step(node: &Node) -> Result<f64, Error> {
    let turn = std::f64::consts::TAU;
    node.quantity_where(&ANGLE, "above 0 rad and at most 90 deg", |step| step > 0.0 && step <= turn / 4.0)
}

fn read_frame(node: &Node) -> Result<Frame, Error> {
    let names = FRAMES.map(|frame| format!("\"{}\"", frame.name)).join(", ");
    let name = node.text(&names)?;
    FRAMES.into_iter().find(|frame| frame.name == name).ok_or_else(|| node.refuse(&format!("one of {names}")))
}

fn count(node: &Node, least: f64, most: f64) -> Result<f64, Error> {
    let expected = format!("a whole number from {least} to {most}");
    let number = node.number(&expected)?;
    let fits = number.fract() == 0.0 && (least..=most).contains(&number);
    if fits { Ok(number) } else { Err(node.refuse(&expected)) }
}
