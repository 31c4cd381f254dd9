//! Reads `[[section]]`: length, profile, rest curvature and guides.

use super::materials;
use super::quantity::{CURVATURE, LENGTH, MASS, rounded};
use super::reader::{Node, Table};
use super::robot::read_name;
use crate::Error;
use crate::model::{CrossSection, Guides, Material, Profile, Section};
use nalgebra::Vector3;

pub(super) const SECTION_KEYS: &[&str] =
    &["name", "length", "material", "profile", "rest_curvature", "guides"];
pub(super) const PROFILE_KEYS: &[&str] = &[
    "diameter",
    "inner_diameter",
    "width",
    "height",
    "tip_diameter",
    "tip_inner_diameter",
    "tip_width",
    "tip_height",
    "shear_coefficient",
];
pub(super) const GUIDE_KEYS: &[&str] = &["spacing", "positions", "mass", "center_of_mass", "diameter"];

const MOST_GUIDES: usize = 10_000;
const LEAST_SLENDERNESS: f64 = 3.0; // below it a beam theory is the wrong theory

pub(super) fn read(
    robot: &Table,
    materials: &[Material],
    warnings: &mut Vec<Error>,
) -> Result<Vec<Section>, Error> {
    let nodes = robot.require("section", "at least one table [[section]]")?.tables("section")?;
    let mut sections: Vec<Section> = Vec::new();
    for node in nodes {
        let taken: Vec<&str> = sections.iter().map(|section| section.name.as_str()).collect();
        let section = read_section(node, &taken, materials, warnings)?;
        sections.push(section);
    }
    let length: f64 = sections.iter().map(|section| section.length).sum();
    if nodes.is_empty() || !length.is_finite() {
        return Err(robot.node.error("the sections have no finite length together"));
    }
    for (node, section) in nodes.iter().zip(&sections) {
        let thickness = thickness(section);
        if length < LEAST_SLENDERNESS * thickness {
            let message =
                format!("the robot is only {} times as long as it is thick", rounded(length / thickness));
            warnings
                .push(node.error(message).hint("rod theory is made for slender bodies, 10 times and more"));
        }
    }
    Ok(sections)
}

fn read_section(
    node: &Node,
    taken: &[&str],
    materials: &[Material],
    warnings: &mut Vec<Error>,
) -> Result<Section, Error> {
    let table = node.table(SECTION_KEYS)?;
    let name = match table.get("name") {
        Some(node) => read_name(node, taken)?.to_string(),
        None => format!("section{}", taken.len() + 1),
    };
    let length = table.quantity("length", &LENGTH)?.positive(&LENGTH)?;
    let material = materials::find(materials, table.require("material", "a material, such as \"nitinol\"")?)?;
    let profile =
        read_profile(table.require("profile", "a table, such as { diameter = \"1.5 mm\" }")?, warnings)?;
    let rest_curvature = read_rest_curvature(&table, &profile)?;
    let guides = table.get("guides").map(|node| read_guides(node, length)).transpose()?;
    Ok(Section { name, length, material, profile, rest_curvature, guides })
}

fn read_profile(node: &Node, warnings: &mut Vec<Error>) -> Result<Profile, Error> {
    let table = node.table(PROFILE_KEYS)?;
    let strip = ["width", "height", "tip_width", "tip_height"].iter().any(|key| table.get(key).is_some());
    let (base, tip) = if strip { read_strip(&table)? } else { read_round(&table)? };
    let shear_coefficient = match table.get("shear_coefficient") {
        Some(node) => read_shear_coefficient(node, warnings)?,
        None => 1.0,
    };
    Ok(Profile { base, tip, shear_coefficient })
}

/// Cross-sections at base and tip of a solid rod or a tube.
fn read_round(table: &Table) -> Result<(CrossSection, CrossSection), Error> {
    let diameter = table.require("diameter", &format!("{}, or width and height", LENGTH.expected()))?;
    let (diameter, tip_diameter) = (diameter.positive(&LENGTH)?, positive(table, "tip_diameter")?);
    let (inner, tip_inner) = (positive(table, "inner_diameter")?, positive(table, "tip_inner_diameter")?);
    let Some(inner) = inner else {
        if let Some(node) = table.get("tip_inner_diameter") {
            return Err(node.error("\"tip_inner_diameter\" needs \"inner_diameter\""));
        }
        let round = |diameter| CrossSection::Round { diameter };
        return Ok((round(diameter), round(tip_diameter.unwrap_or(diameter))));
    };
    let (tip_diameter, tip_inner) = (tip_diameter.unwrap_or(diameter), tip_inner.unwrap_or(inner));
    for (inner, outer, place) in [(inner, diameter, "base"), (tip_inner, tip_diameter, "tip")] {
        if inner >= outer {
            let node = table.get(if place == "tip" { "tip_inner_diameter" } else { "inner_diameter" });
            let (inner, outer) = (in_mm(inner), in_mm(outer));
            return Err(node.unwrap_or(table.node).error(format!(
                "the inner diameter at the section's {place}, {inner}, must be below the outer diameter, {outer}"
            )));
        }
    }
    let tube = |diameter, inner_diameter| CrossSection::Tube { diameter, inner_diameter };
    Ok((tube(diameter, inner), tube(tip_diameter, tip_inner)))
}

fn read_strip(table: &Table) -> Result<(CrossSection, CrossSection), Error> {
    for key in ["diameter", "inner_diameter", "tip_diameter", "tip_inner_diameter"] {
        if let Some(node) = table.get(key) {
            return Err(node.error("a profile is either round (diameter) or a strip (width and height)"));
        }
    }
    let width = table.quantity("width", &LENGTH)?.positive(&LENGTH)?;
    let height = table.quantity("height", &LENGTH)?.positive(&LENGTH)?;
    let strip = |width, height| CrossSection::Strip { width, height };
    let tip_width = positive(table, "tip_width")?.unwrap_or(width);
    let tip_height = positive(table, "tip_height")?.unwrap_or(height);
    Ok((strip(width, height), strip(tip_width, tip_height)))
}

fn positive(table: &Table, key: &str) -> Result<Option<f64>, Error> {
    table.get(key).map(|node| node.positive(&LENGTH)).transpose()
}

fn read_shear_coefficient(node: &Node, warnings: &mut Vec<Error>) -> Result<f64, Error> {
    let value = node.number("a number above 0, such as 0.9")?;
    if value <= 0.0 {
        return Err(node.refuse("a number above 0, such as 0.9"));
    }
    if value > 1.0 {
        warnings.push(
            node.error(format!("a shear coefficient of {value} is implausible"))
                .hint("0.9 for a round rod, 5/6 for a strip, 1 as in the thesis"),
        );
    }
    Ok(value)
}

fn read_rest_curvature(table: &Table, profile: &Profile) -> Result<Vector3<f64>, Error> {
    let Some(node) = table.get("rest_curvature") else {
        return Ok(Vector3::zeros());
    };
    let curvature = node.vector(&CURVATURE)?;
    let strain = [profile.base, profile.tip]
        .iter()
        .map(|end| end.bending_strain([curvature.x, curvature.y]))
        .fold(0.0, f64::max);
    if strain >= 1.0 {
        return Err(node
            .error("a rod this thick cannot be bent this much: its inner side would overlap itself")
            .hint(format!("curvature times half the thickness must be below 1, and is {strain:.3}")));
    }
    Ok(curvature)
}

/// Largest thickness of a section.
pub(super) fn thickness(section: &Section) -> f64 {
    section.profile.base.thickness().max(section.profile.tip.thickness())
}

fn read_guides(node: &Node, length: f64) -> Result<Guides, Error> {
    let table = node.table(GUIDE_KEYS)?;
    table.either("spacing", "positions")?;
    let positions = match (table.get("spacing"), table.get("positions")) {
        (Some(spacing), _) => spaced(spacing, length)?,
        (None, Some(positions)) => listed(positions, length)?,
        (None, None) => {
            return Err(node.error(format!(
                "missing key \"spacing\", expected {} (or \"positions\")",
                LENGTH.expected()
            )));
        }
    };
    let mass = table.get("mass").map_or(Ok(0.0), |node| node.not_negative(&MASS))?;
    let mass_center = match table.get("center_of_mass") {
        Some(node) => match node.list(&LENGTH)?[..] {
            [x, y] => [x, y],
            ref other => {
                let expected = "two components along d1 and d2, such as \"[1, 0] mm\"";
                return Err(node.error(format!("found a list of {}, expected {expected}", other.len())));
            }
        },
        None => [0.0; 2],
    };
    let radius = positive(&table, "diameter")?.map(|diameter| 0.5 * diameter);
    Ok(Guides { positions, mass, mass_center, radius })
}

/// At one spacing, two spacings, ... from the section's base, its tip included.
fn spaced(node: &Node, length: f64) -> Result<Vec<f64>, Error> {
    let range = format!("above 0 m and at most the section's length, {}", in_mm(length));
    let spacing =
        node.quantity_where(&LENGTH, &range, |spacing| spacing > 0.0 && spacing <= length * (1.0 + 1e-9))?;
    let count = length / spacing * (1.0 + 1e-9);
    if count > MOST_GUIDES as f64 {
        return Err(node.error(format!("this spacing makes {count:.0} guides, more than {MOST_GUIDES}")));
    }
    Ok((1..=count as usize).map(|i| (i as f64 * spacing).min(length)).collect())
}

fn listed(node: &Node, length: f64) -> Result<Vec<f64>, Error> {
    let positions = node.list(&LENGTH)?;
    if let Some(outside) = positions.iter().find(|at| !(0.0..=length).contains(*at)) {
        let (outside, length) = (in_mm(*outside), in_mm(length));
        return Err(node.error(format!("a guide at {outside} is outside its section, 0 mm to {length}")));
    }
    if let Some(pair) = positions.windows(2).find(|pair| pair[1] <= pair[0]) {
        let (first, second) = (in_mm(pair[0]), in_mm(pair[1]));
        return Err(node.error(format!("guides must go from base to tip, but {second} follows {first}")));
    }
    if positions.len() > MOST_GUIDES {
        return Err(node.error(format!("found {} guides, more than {MOST_GUIDES}", positions.len())));
    }
    Ok(positions)
}

/// A length for a message.
pub(super) fn in_mm(length: f64) -> String {
    format!("{} mm", rounded(length * 1e3))
}
