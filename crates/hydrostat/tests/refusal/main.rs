//! What the readers refuse or doubt, and the whole message that they give.

use hydrostat::Error;
use hydrostat::description::{parse_experiment, parse_robot};

const ROD: &str = r#"name = "trunk"
gravity = "[0, -9.81, 0] m/s^2"

[base]
tangent = [1, 0, 0]
normal = [0, 1, 0]

[material.niti]
youngs_modulus = "54 GPa"
poisson_ratio = 0.33
density = "6.45 g/cm^3"
strain_limit = "1 %"

[[section]]
name = "rod"
length = "390 mm"
material = "niti"
profile = { diameter = "1.5 mm" }
# guides

[[load]]
at = "tip"
moment = "[0, 0, 0.01] N m"
# more
"#;

const EXPERIMENT: &str = r#"name = "bench"
robot = "rod.toml"
data = "table.csv"

[[vary]]
quantity = "hung_mass"
column = "mass"
at = "tip"

[[measure]]
at = "tip" # point
x = "tip x"
y = "tip y"
reading_error = "0.5 mm"

[[variant]]
name = "shorter"
set = { "section.rod.length" = "380 mm" }
# bench
"#;

const TABLE: &str = r#"# hung masses
mass [g],tip x [mm],tip y [mm],error [mm],error [%],angle [deg]
0,350.5,-20.00,1,2,0
10,300.5,-100.25,1,2,0
"#;

fn edited(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "the edit must fit one place: {from}");
    text.replace(from, to)
}

fn robot_error(text: &str) -> String {
    parse_robot(text, "rod.toml").expect_err("is refused").to_string()
}

fn robot_warning(text: &str) -> String {
    let parsed = parse_robot(text, "rod.toml").expect("is only doubted");
    assert_eq!(parsed.warnings.len(), 1);
    parsed.warnings[0].to_string()
}

fn experiment_error(experiment: &str, table: &str, rod: &str) -> String {
    let mut load = |path: &str| match path {
        "rod.toml" => Ok(rod.to_string()),
        "table.csv" => Ok(table.to_string()),
        _ => Err(Error::new(format!("cannot read {path}: no such file"))),
    };
    parse_experiment(experiment, "lab/bench.toml", &mut load).expect_err("is refused").to_string()
}

#[test]
fn the_unedited_files_are_accepted() {
    assert_eq!(parse_robot(ROD, "rod.toml").expect("is valid").warnings, []);
    let mut load = |path: &str| Ok(if path == "rod.toml" { ROD } else { TABLE }.to_string());
    assert_eq!(parse_experiment(EXPERIMENT, "bench.toml", &mut load).expect("is valid").warnings, []);
}

/// One test per edit: name, what is replaced by what, the message.
macro_rules! edits {
    ($message:ident $text:ident: $($name:ident $from:literal => $to:literal, $expected:literal;)*) => {
        $(#[test]
        fn $name() {
            assert_eq!(format!("{}\n", $message(&edited($text, $from, $to))), $expected);
        })*
    };
}

mod doubts;
mod experiments;
mod linked_robots;
mod loads;
mod quantities;
mod robots;
mod sections;
mod tables;
mod tendons;

fn in_experiment(text: &str) -> String {
    experiment_error(text, TABLE, ROD)
}

fn in_table(text: &str) -> String {
    experiment_error(EXPERIMENT, text, ROD)
}

fn in_rod(text: &str) -> String {
    experiment_error(EXPERIMENT, TABLE, text)
}

#[test]
fn empty_files() {
    for text in ["", "  \n", "# only a comment\n"] {
        let first = text.lines().next().unwrap_or("").trim_end();
        let expected = format!(
            "the file is empty\n --> rod.toml:1:1\n  |\n1 | {first}\n  | ^\n\
             hint: `hydrostat new rod NAME`, `hydrostat new tendon NAME` and `hydrostat new bench NAME` write first files"
        );
        assert_eq!(robot_error(text), expected);
    }
    let expected = "the file has no rows of data\n --> lab/table.csv:1:1\n  |\n1 | \n  | ^";
    assert_eq!(in_table(""), expected);
}

#[test]
fn places_count_characters_not_bytes() {
    let text = "name = \"Rüssel\" # größer\nname2 = \"µ\"";
    let expected = "unknown key \"name2\"\n --> rod.toml:2:1, key name2\n  |\n2 | name2 = \"µ\"\n  | ^^^^^\nhint: did you mean \"name\"?";
    assert_eq!(robot_error(text), expected);
}
