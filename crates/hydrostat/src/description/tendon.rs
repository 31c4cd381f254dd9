//! Reads `[[tendon]]` and `[actuation]`, and commands from the command line.

use super::quantity::{self, ANGLE, FORCE, Kind, LENGTH, MASS_PER_LENGTH, rounded};
use super::reader::{Node, Table, Value, nearest};
use super::robot::read_name;
use super::section::{in_mm, thickness};
use super::unit::quoted;
use crate::Error;
use crate::error::Place;
use crate::model::{Command, Motion, Path, Robot, Routing, Section, Tendon};

pub(super) const TENDON_KEYS: &[&str] = &[
    "name",
    "ends",
    "radius",
    "angle",
    "tip_radius",
    "turns",
    "routing",
    "stiffness",
    "friction",
    "breaking_load",
    "mass_per_length",
    "home",
];
pub(super) const ACTUATION_KEYS: &[&str] = &["tension", "displacement", "released"];

const LARGEST_FRICTION: f64 = 1.0; // steel on steel, dry, is below it

pub(super) fn read(
    robot: &Table,
    sections: &[Section],
    warnings: &mut Vec<Error>,
) -> Result<Vec<Tendon>, Error> {
    let Some(node) = robot.get("tendon") else {
        return Ok(Vec::new());
    };
    let mut tendons: Vec<Tendon> = Vec::new();
    for node in node.tables("tendon")? {
        let taken: Vec<&str> = tendons.iter().map(|tendon| tendon.name.as_str()).collect();
        let tendon = read_tendon(node, &taken, sections, warnings)?;
        tendons.push(tendon);
    }
    Ok(tendons)
}

fn read_tendon(
    node: &Node,
    taken: &[&str],
    sections: &[Section],
    warnings: &mut Vec<Error>,
) -> Result<Tendon, Error> {
    let table = node.table(TENDON_KEYS)?;
    let name = read_name(table.require("name", "a name, such as \"a\"")?, taken)?.to_string();
    let ends =
        read_end(table.require("ends", "the name of the section at whose tip it is fixed")?, sections)?;
    let radius_node = table.quantity("radius", &LENGTH)?;
    let radius = radius_node.not_negative(&LENGTH)?;
    let tip_radius = table.get("tip_radius").map_or(Ok(radius), |node| node.not_negative(&LENGTH))?;
    let angle = table.get("angle").map_or(Ok(0.0), |node| node.quantity(&ANGLE))?;
    let turns = table.get("turns").map_or(Ok(0.0), |node| node.number("a number of turns, such as 0.5"))?;
    let passed = &sections[..=ends];
    let guided = passed.iter().any(|section| section.guides.is_some());
    let routing = match table.get("routing") {
        Some(node) => read_routing(node)?,
        None if guided => Routing::Guides,
        None => Routing::Channel,
    };
    if let Some(node) = table.get("routing").filter(|_| routing == Routing::Guides && !guided) {
        warnings.push(
            node.error("this tendon passes no guide: it runs straight from the base to its end")
                .hint("give its sections guides, or use routing = \"channel\""),
        );
    }
    let friction = match table.get("friction") {
        Some(node) => read_friction(node, warnings)?,
        None => 0.0,
    };
    let positive = |key: &str| table.get(key).map(|node| node.positive(&FORCE)).transpose();
    let tendon = Tendon {
        name,
        ends,
        path: Path { radius, tip_radius, angle, turns },
        routing,
        stiffness: positive("stiffness")?,
        friction,
        breaking_load: positive("breaking_load")?,
        mass_per_length: table
            .get("mass_per_length")
            .map_or(Ok(0.0), |node| node.not_negative(&MASS_PER_LENGTH))?,
        home: table.get("home").map_or(Ok(0.0), |node| node.quantity(&LENGTH))?,
    };
    check_holes(&table, radius_node, &tendon, passed, warnings)?;
    Ok(tendon)
}

fn read_end(node: &Node, sections: &[Section]) -> Result<usize, Error> {
    let name = node.text("the name of a section")?;
    let names: Vec<&str> = sections.iter().map(|section| section.name.as_str()).collect();
    names.iter().position(|known| *known == name).ok_or_else(|| {
        node.error(format!("there is no section {} for the tendon to end at", quoted(name)))
            .hint(near_or_all(name, &names, "sections"))
    })
}

/// The name that was meant, or all there are: names of a letter or two are all near each other.
fn near_or_all(name: &str, names: &[&str], kind: &str) -> String {
    match nearest(name, names).filter(|near| near.chars().count() > 2) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None => format!("{kind} of this robot: {}", names.join(", ")),
    }
}

fn read_routing(node: &Node) -> Result<Routing, Error> {
    match &node.value {
        Value::Text(text) if text == "channel" => Ok(Routing::Channel),
        Value::Text(text) if text == "guides" => Ok(Routing::Guides),
        _ => {
            Err(node
                .refuse("\"channel\" (follows the hole everywhere) or \"guides\" (straight between guides)"))
        }
    }
}

fn read_friction(node: &Node, warnings: &mut Vec<Error>) -> Result<f64, Error> {
    let expected = "a coefficient of 0 or more, such as 0.1";
    let friction = node.number(expected)?;
    if friction < 0.0 {
        return Err(node.refuse(expected));
    }
    if friction > LARGEST_FRICTION {
        warnings.push(
            node.error(format!("a friction coefficient of {friction} is implausible"))
                .hint("Dyneema or steel in acrylic holes: 0.05 to 0.3"),
        );
    }
    Ok(friction)
}

/// Holes must lie within the guides, and should lie outside the backbone.
fn check_holes(
    table: &Table,
    radius: &Node,
    tendon: &Tendon,
    passed: &[Section],
    warnings: &mut Vec<Error>,
) -> Result<(), Error> {
    let end: f64 = passed.iter().map(|section| section.length).sum();
    let at = |s: f64| {
        let path = &tendon.path;
        path.radius + s / end * (path.tip_radius - path.radius)
    };
    let mut start = 0.0;
    for section in passed {
        for (guides, outer) in
            section.guides.iter().filter_map(|guides| guides.radius.map(|radius| (guides, radius)))
        {
            if let Some(position) = guides.positions.iter().find(|position| at(start + **position) >= outer) {
                let node =
                    table.get("tip_radius").filter(|_| at(start + position) > at(0.0)).unwrap_or(radius);
                let (hole, outer, s) = (in_mm(at(start + position)), in_mm(outer), in_mm(start + position));
                return Err(node
                    .error(format!(
                        "the hole at a radius of {hole} lies outside the guide at s = {s}, whose radius is {outer}"
                    ))
                    .hint("use larger guides or a smaller radius"));
            }
        }
        let inside = [start, start + section.length].into_iter().any(|s| at(s) < 0.5 * thickness(section));
        if inside {
            let name = &section.name;
            warnings.push(
                radius
                    .error(format!("the tendon runs inside the backbone of section \"{name}\""))
                    .hint("the radius is measured from the backbone's axis"),
            );
            break;
        }
        start += section.length;
    }
    Ok(())
}

/// The file's default command, one per tendon.
pub(super) fn read_actuation(
    robot: &Table,
    tendons: &[Tendon],
    length: impl Fn(&Tendon) -> f64,
    warnings: &mut Vec<Error>,
) -> Result<Vec<Command>, Error> {
    let zero = Command::Tension { tension: 0.0, motion: Motion::Pulled };
    let mut commands = vec![zero; tendons.len()];
    let Some(node) = robot.get("actuation") else {
        return Ok(commands);
    };
    let table = node.table(ACTUATION_KEYS)?;
    if table.get("displacement").is_some() {
        commands.fill(Command::Displacement { displacement: 0.0, motion: Motion::Pulled });
    }
    let mut commanded = vec![false; tendons.len()];
    for key in ["tension", "displacement"] {
        let Some(node) = table.get(key) else { continue };
        for entry in node.entries("a table, such as { a = \"2 N\" }")? {
            let tendon = find(tendons, &entry.name).map_err(|error| error.at(entry.node.place()))?;
            if commanded[tendon] {
                return Err(entry
                    .node
                    .error(format!(
                        "tendon \"{}\" is commanded twice, by tension and by displacement",
                        entry.name
                    ))
                    .hint("keep one of them"));
            }
            commanded[tendon] = true;
            let Value::Text(text) = &entry.node.value else {
                return Err(entry.node.refuse(&kind_of(key).expected()));
            };
            let command = command(key, text, &tendons[tendon], length(&tendons[tendon]));
            commands[tendon] = command.map_err(|error| error.at(entry.node.place()))?;
            let doubt = above_breaking_load(&commands[tendon], &tendons[tendon]);
            warnings.extend(doubt.map(|error| error.at(entry.node.place())));
        }
    }
    if let Some(node) = table.get("released") {
        let Value::List(names) = &node.value else {
            return Err(node.refuse("a list of tendons, such as [\"a\"]"));
        };
        for name in names {
            let tendon =
                find(tendons, name.text("the name of a tendon")?).map_err(|error| error.at(name.place()))?;
            set_motion(&mut commands[tendon], Motion::Released);
            if tendons[tendon].friction == 0.0 {
                let place = Place { key: format!("{}.{}", node.key, tendons[tendon].name), ..name.place() };
                let message = "without friction it does not matter that the tendon was released";
                warnings.push(Error::new(message).at(place));
            }
        }
    }
    Ok(commands)
}

fn above_breaking_load(command: &Command, tendon: &Tendon) -> Option<Error> {
    let (&Command::Tension { tension, .. }, Some(limit)) = (command, tendon.breaking_load) else {
        return None;
    };
    let (shown, shown_limit) = (rounded(tension), rounded(limit));
    let message = format!("a tension of {shown} N is above the tendon's breaking load of {shown_limit} N");
    (tension > limit).then(|| Error::new(message))
}

/// Whether a warning is about the file's command of this tendon: its key ends with the tendon's name.
fn is_about_command(warning: &Error, tendon: &Tendon) -> bool {
    let key = warning.place().and_then(|place| place.key.strip_prefix("actuation."));
    key.and_then(|key| key.split_once('.')).is_some_and(|(_, name)| name == tendon.name)
}

fn kind_of(key: &str) -> &'static Kind {
    if key == "tension" { &FORCE } else { &LENGTH }
}

pub(super) fn find(tendons: &[Tendon], name: &str) -> Result<usize, Error> {
    let names: Vec<&str> = tendons.iter().map(|tendon| tendon.name.as_str()).collect();
    names.iter().position(|known| *known == name).ok_or_else(|| {
        let error = Error::new(format!("there is no tendon {}", quoted(name)));
        error.hint(match names[..] {
            [] => "this robot has no tendons".to_owned(),
            _ => near_or_all(name, &names, "tendons"),
        })
    })
}

/// One command from its quantity; `length` is that of the backbone the tendon passes.
fn command(key: &str, text: &str, tendon: &Tendon, length: f64) -> Result<Command, Error> {
    let value = quantity::scalar(text, kind_of(key))?;
    let motion = Motion::Pulled;
    if key == "tension" {
        check_tension(value)?;
        return Ok(Command::Tension { tension: value, motion });
    }
    check_displacement(value, tendon, length)?;
    Ok(Command::Displacement { displacement: value, motion })
}

pub(super) fn check_tension(tension: f64) -> Result<(), Error> {
    if tension < 0.0 {
        return Err(Error::new(format!("found a tension of {} N, expected 0 N or more", rounded(tension)))
            .hint("a tendon only pulls"));
    }
    Ok(())
}

pub(super) fn check_displacement(displacement: f64, tendon: &Tendon, length: f64) -> Result<(), Error> {
    if displacement >= length {
        let (pulled, length) = (in_mm(displacement), in_mm(length));
        return Err(Error::new(format!(
            "tendon \"{}\" cannot be pulled in by {pulled}: it is about {length} long",
            tendon.name
        )));
    }
    Ok(())
}

fn set_motion(command: &mut Command, new: Motion) {
    match command {
        Command::Tension { motion, .. } | Command::Displacement { motion, .. } => *motion = new,
    }
}

/// Replaces commands of the robot by those of flags: `tension` and `displacement` such as `a=2N,b=0.5N`, and the names of
/// the tendons whose last motion was a release, such as `a,b`. Of `warnings`, those about commands that are replaced go, and those
/// about the new ones come.
///
/// # Errors
/// Unknown tendons, one that is commanded twice, values that are no tension or displacement.
pub fn parse_commands(
    robot: &mut Robot,
    warnings: &mut Vec<Error>,
    tension: &[String],
    displacement: &[String],
    released: &[String],
) -> Result<(), Error> {
    let mut commanded = vec![false; robot.tendons.len()];
    for (key, texts) in [("tension", tension), ("displacement", displacement)] {
        let example = if key == "tension" { "a=2N,b=0.5N" } else { "a=5mm" };
        for text in texts.iter().flat_map(|text| text.split(',')) {
            let within = |error: Error| error.within(&format!("--{key} {text}"));
            let (name, value) = text.split_once('=').ok_or_else(|| {
                Error::new(format!(
                    "found {}, expected tendons with their {key}, such as {example}",
                    quoted(text)
                ))
                .within(&format!("--{key}"))
            })?;
            let tendon = find(&robot.tendons, name.trim()).map_err(within)?;
            if std::mem::replace(&mut commanded[tendon], true) {
                return Err(within(
                    Error::new(format!("tendon \"{}\" is commanded twice", name.trim()))
                        .hint("give each tendon one tension or one displacement"),
                ));
            }
            let of = &robot.tendons[tendon];
            let command = command(key, value, of, robot.tendon_end(of)).map_err(within)?;
            warnings.retain(|warning| !is_about_command(warning, of));
            warnings.extend(above_breaking_load(&command, of).map(within));
            robot.actuation[tendon] = command;
        }
    }
    for name in released.iter().flat_map(|text| text.split(',')) {
        let tendon = find(&robot.tendons, name.trim()).map_err(|error| error.within("--released"))?;
        set_motion(&mut robot.actuation[tendon], Motion::Released);
    }
    Ok(())
}
