//! Holds `docs/format.md` to what the readers accept.

use super::quantity::rounded;
use super::{
    budget, calibration, experiment as e, fabrication, load, materials, parse_command_table,
    parse_experiment, parse_robot, plan, robot, section, templates, tendon,
};
use crate::Error;

const DOCUMENT: &str = include_str!("../../../../docs/format.md");

const TABLES: &[(&str, &[&str])] = &[
    ("robot", robot::ROBOT_KEYS),
    ("base", robot::BASE_KEYS),
    ("material", materials::MATERIAL_KEYS),
    ("section", section::SECTION_KEYS),
    ("profile", section::PROFILE_KEYS),
    ("guides", section::GUIDE_KEYS),
    ("load", load::LOAD_KEYS),
    ("tendon", tendon::TENDON_KEYS),
    ("actuation", tendon::ACTUATION_KEYS),
    ("fabrication", fabrication::FABRICATION_KEYS),
    ("experiment", e::EXPERIMENT_KEYS),
    ("bench", e::BENCH_KEYS),
    ("vary", e::VARY_KEYS),
    ("measure", e::MEASURE_KEYS),
    ("published", e::PUBLISHED_KEYS),
    ("variant", e::VARIANT_KEYS),
    ("calibrate", calibration::CALIBRATE_KEYS),
    ("budget", budget::BUDGET_KEYS),
    ("plan", plan::PLAN_KEYS),
];

/// First cells, without backticks, of the table that has this header.
fn first_cells<'t>(text: &'t str, header: &str) -> Vec<&'t str> {
    let rows = text.lines().skip_while(|line| !line.starts_with(header)).skip(2);
    rows.map_while(|line| line.strip_prefix("| `")?.split('`').next()).collect()
}

fn blocks<'t>(language: &str) -> Vec<&'t str> {
    let fence = format!("```{language}\n");
    DOCUMENT.split(fence.as_str()).skip(1).filter_map(|block| block.split("```").next()).collect()
}

#[test]
fn documented_keys_are_the_known_keys() {
    let chapters: Vec<(&str, &str)> =
        DOCUMENT.split("\n### `").skip(1).filter_map(|chapter| chapter.split_once('`')).collect();
    let documented: Vec<(&str, Vec<&str>)> =
        chapters.iter().map(|(name, text)| (*name, first_cells(text, "| key "))).collect();
    let known: Vec<(&str, Vec<&str>)> = TABLES.iter().map(|(name, keys)| (*name, keys.to_vec())).collect();
    assert_eq!(documented, known);
}

#[test]
fn documented_materials_are_the_built_in_ones() {
    let giga =
        |pascal: f64| format!("{} GPa", format!("{:.2e}", pascal / 1e9).parse::<f64>().expect("a number"));
    let rows: Vec<String> = materials::BUILT_IN
        .iter()
        .map(|material| {
            format!(
                "| `{}` | {} | {} | {} g/cm^3 | {} % | {} |",
                material.id,
                giga(material.youngs_modulus),
                giga(material.shear_modulus),
                material.density / 1e3,
                rounded(material.strain_limit * 100.0),
                material.description
            )
        })
        .collect();
    let documented: Vec<&str> = DOCUMENT
        .lines()
        .skip_while(|line| !line.starts_with("| material "))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .collect();
    assert_eq!(documented, rows);
}

#[test]
fn documented_examples_are_accepted() {
    let blocks_of_toml = blocks("toml");
    let [robot, experiment] = blocks_of_toml[..] else {
        panic!("a new example needs a line here");
    };
    let [data] = blocks("csv")[..] else {
        panic!("a new example needs a line here");
    };
    let robot = parse_robot(robot, "format.md").expect("is valid");
    assert_eq!(robot.warnings, []);
    assert_eq!(first_cells(DOCUMENT, "| column | unit").len(), 7);
    for column in [
        "tension.a [N]",
        "displacement.b [mm]",
        "load.gripper.mass [g]",
        "load.2.force_per_length y [N/m]",
        "load.2.moment_per_length z [N]",
    ] {
        let commands = parse_command_table(&format!("{column}\n1\n"), "format.md", &robot.value);
        assert_eq!(commands.expect("is valid").broken, [], "{column}");
    }
    let [_, _, rod] = templates::bench("example");
    let mut load = |path: &str| match path {
        "rod.toml" => Ok(rod.text.clone()),
        "data.csv" => Ok(data.to_string()),
        _ => Err(Error::new("no such file")),
    };
    let parsed = parse_experiment(experiment, "format.md", &mut load).expect("is valid");
    assert_eq!(parsed.warnings, []);
    assert_eq!((parsed.value.rows.len(), parsed.value.variants.len()), (2, 1));
}
