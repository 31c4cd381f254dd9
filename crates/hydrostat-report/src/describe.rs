//! Parts of a robot in words.

use crate::overlay::AXES;
use crate::text::{fixed, mass, millimetres, prefixed, short, significant};
use crate::view::direction_name;
use hydrostat::Robot;
use hydrostat::model::{CrossSection, Frame, LoadKind, Material, Profile, Section};
use hydrostat::solution::Check;
use hydrostat::verify::{Experiment, Varied};
use minijinja::{Value, context};
use nalgebra::Vector3;

/// `Ø 1.56 mm`, `tube Ø 3 / 2.4 mm`, `strip 10 × 0.5 mm`; both ends where they differ.
pub(crate) fn profile(profile: &Profile) -> String {
    if profile.base == profile.tip {
        cross_section(&profile.base)
    } else {
        format!("{} tapering to {}", cross_section(&profile.base), cross_section(&profile.tip))
    }
}

fn cross_section(section: &CrossSection) -> String {
    let mm = |x: f64| short(1e3 * x, 3);
    match *section {
        CrossSection::Round { diameter } => format!("Ø {}", millimetres(diameter)),
        CrossSection::Tube { diameter, inner_diameter } => {
            format!("tube Ø {} / {} mm", mm(diameter), mm(inner_diameter))
        }
        CrossSection::Strip { width, height } => format!("strip {} × {} mm", mm(width), mm(height)),
    }
}

/// What a check found, where it failed.
pub(crate) fn failed_check(check: &Check) -> String {
    let tendons = check.tendons.join(", ");
    match check.name {
        "slack" => return format!("Check failed: {tendons} slack although pulled in."),
        "tension" => {
            let (value, limit) = (significant(check.value), significant(check.limit));
            return format!("Check failed: tension is {value} N in tendon {tendons}, its limit {limit} N.");
        }
        _ => {}
    }
    let (value, limit) = if check.name.contains("strain") {
        (format!("{} %", fixed(100.0 * check.value, 2)), format!("{} %", short(100.0 * check.limit, 2)))
    } else {
        (significant(check.value), significant(check.limit))
    };
    let place = check.at.map(|s| format!(" at {} from the base", millimetres(s))).unwrap_or_default();
    format!("Check failed: {} is {value}{place}, its limit {limit}.", check.name)
}

/// A gravity or other acceleration with its direction.
pub(crate) fn acceleration(v: &Vector3<f64>) -> String {
    let norm = v.norm();
    if norm == 0.0 {
        return "none".to_owned();
    }
    format!("{} along {}", prefixed(norm, "m/s²"), direction_name(&(v / norm)))
}

/// Everything a verification was computed from, as tables of facts for the page's template.
pub(crate) fn tables(experiment: &Experiment) -> Vec<Value> {
    let robot = &experiment.robot;
    let mut tables = vec![context! { name => format!("Robot: {}", robot.name), facts => robot_facts(robot) }];
    let mut seen: Vec<&Material> = Vec::new();
    for section in &robot.sections {
        tables
            .push(context! { name => format!("Section: {}", section.name), facts => section_facts(section) });
    }
    for material in robot.sections.iter().map(|s| &s.material) {
        if !seen.contains(&material) {
            seen.push(material);
            tables.push(context! { name => format!("Material: {}", material.name), facts => material_facts(material) });
        }
    }
    tables.push(context! { name => "Bench", facts => bench_facts(experiment) });
    tables
}

fn fact(name: &str, value: impl Into<String>) -> Value {
    context! { name, value => value.into() }
}

fn robot_facts(robot: &Robot) -> Vec<Value> {
    let axis = |i: usize| direction_name(&robot.base.rotation.matrix().column(i).into_owned());
    let mut facts = vec![
        fact("length", millimetres(robot.length())),
        fact("gravity", acceleration(&robot.gravity)),
        fact(
            "base",
            format!(
                "at {}, backbone along {}, d1 along {}",
                position(&robot.base.position),
                axis(2),
                axis(0)
            ),
        ),
    ];
    for load in &robot.loads {
        facts.push(fact(load.name.as_deref().unwrap_or("load"), load_text(&load.kind)));
    }
    facts
}

fn section_facts(section: &Section) -> Vec<Value> {
    let mut facts = vec![
        fact("length", millimetres(section.length)),
        fact("profile", profile(&section.profile)),
        fact("shear coefficient", significant(section.profile.shear_coefficient)),
        fact("material", section.material.name.as_str()),
    ];
    if section.rest_curvature.norm() > 0.0 {
        facts.push(fact(
            "curvature at rest",
            format!("{} 1/m, body frame", components(&section.rest_curvature)),
        ));
    }
    if let Some(guides) = &section.guides {
        facts.push(fact("guides", format!("{}, {} each", guides.positions.len(), mass(guides.mass))));
    }
    facts
}

fn material_facts(material: &Material) -> Vec<Value> {
    let limit = |x: f64| format!("{} %", short(100.0 * x, 3));
    vec![
        fact("Young's modulus", prefixed(material.youngs_modulus, "Pa")),
        fact("shear modulus", prefixed(material.shear_modulus, "Pa")),
        fact("density", format!("{} g/cm³", significant(material.density / 1000.0))),
        fact("strain limit", material.strain_limit.map_or("not given".to_owned(), limit)),
    ]
}

fn bench_facts(experiment: &Experiment) -> Vec<Value> {
    let axis = |i: usize| direction_name(&experiment.axes.rotation.matrix().column(i).into_owned());
    let mut facts = vec![fact(
        "axes in the world",
        format!(
            "x along {}, y along {}, z along {}, origin at {}",
            axis(0),
            axis(1),
            axis(2),
            position(&experiment.axes.position)
        ),
    )];
    for input in &experiment.inputs {
        let how = match input.quantity {
            Varied::HungMass { at } => format!("mass hung {} from the base", millimetres(at)),
            Varied::MountAngle => "angle by which the base is turned about the bench's z axis".to_owned(),
            Varied::Force { at, direction } => {
                format!(
                    "force along {} in the bench's axes, {} from the base",
                    direction_name(&direction),
                    millimetres(at)
                )
            }
            Varied::Displacement { tendon, backlash: 0.0 } => {
                format!("tendon {} pulled in", experiment.robot.tendons[tendon].name)
            }
            Varied::Displacement { tendon, backlash } => {
                let name = &experiment.robot.tendons[tendon].name;
                format!("tendon {name} pulled in, with a backlash of {:.2} mm", 1e3 * backlash)
            }
            Varied::Tension { tendon } => {
                format!("tension of tendon {}", experiment.robot.tendons[tendon].name)
            }
        };
        let unit = if input.unit.0.is_empty() { String::new() } else { format!(", in {}", input.unit.0) };
        facts.push(fact(&format!("varied: {}", input.column), format!("{how}{unit}")));
    }
    for point in &experiment.points {
        let axes: Vec<&str> = point.axes.iter().filter_map(|&a| AXES.get(a).copied()).collect();
        facts.push(fact(
            "read",
            format!(
                "{} of the point {} from the base, standard reading error {}",
                axes.join(", "),
                millimetres(point.at),
                millimetres(point.reading_error)
            ),
        ));
    }
    facts.push(fact("rows measured", experiment.rows.len().to_string()));
    for (name, robot) in &experiment.variants {
        facts.push(fact("variant", format!("{name} (robot {})", robot.name)));
    }
    facts
}

fn load_text(kind: &LoadKind) -> String {
    let frame = |frame: Frame| {
        if frame == Frame::Body { "body frame" } else { "world frame" }
    };
    match kind {
        LoadKind::Mass { at, mass: kg } => format!("{} hung {} from the base", mass(*kg), millimetres(*at)),
        LoadKind::Point { at, force, moment, frame: f } => format!(
            "force {} N, moment {} N m, {}, {} from the base",
            components(force),
            components(moment),
            frame(*f),
            millimetres(*at)
        ),
        LoadKind::Distributed { from, to, force_per_length, moment_per_length, frame: f } => format!(
            "force {} N/m, moment {} N, {}, from {} to {}",
            components(force_per_length),
            components(moment_per_length),
            frame(*f),
            millimetres(*from),
            millimetres(*to)
        ),
    }
}

fn components(v: &Vector3<f64>) -> String {
    format!("({}, {}, {})", significant(v.x), significant(v.y), significant(v.z))
}

fn position(v: &Vector3<f64>) -> String {
    let mm = |x: f64| short(1e3 * x, 3);
    if v.norm() == 0.0 {
        "the origin".to_owned()
    } else {
        format!("({}, {}, {}) mm", mm(v.x), mm(v.y), mm(v.z))
    }
}
