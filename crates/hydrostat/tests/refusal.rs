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
    ($module:ident $message:ident $text:ident: $($name:ident $from:literal => $to:literal, $expected:literal;)*) => {
        mod $module {
            use super::*;
            $(#[test]
            fn $name() {
                assert_eq!(format!("{}\n", $message(&edited($text, $from, $to))), $expected);
            })*
        }
    };
}

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
             hint: `hydrostat new rod NAME` and `hydrostat new bench NAME` write first files"
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

edits! { robots robot_error ROD:
    bare_number r#""390 mm""# => "390", r#"found a number without a unit, expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = 390
   |          ^^^
"#;

    wrong_dimension r#""6.45 g/cm^3""# => r#""6.80 mm""#, r#"found a length, expected mass per volume, such as "6450 kg/m^3"
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "6.80 mm"
   |           ^^^^^^^^^
"#;

    unknown_unit r#""390 mm""# => r#""390 mmm""#, r#"unknown unit "mmm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390 mmm"
   |          ^^^^^^^^^
hint: did you mean "mm"?
"#;

    units_run_together r#""[0, 0, 0.01] N m""# => r#""[0, 0, 0.01] Nm""#, r#"unknown unit "Nm"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = "[0, 0, 0.01] Nm"
   |          ^^^^^^^^^^^^^^^^^
hint: did you mean "N m"?
"#;

    wrong_case r#""54 GPa""# => r#""54 gpa""#, r#"unknown unit "gpa"
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "54 gpa"
  |                  ^^^^^^^^
hint: did you mean "GPa"?
"#;

    unit_nobody_knows r#""390 mm""# => r#""390 cubits""#, r#"unknown unit "cubits"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390 cubits"
   |          ^^^^^^^^^^^^
hint: known units: m in ft, g t lb oz, s min h, N kgf gf lbf, Pa bar psi, J W Hz, rad deg rev, %, 1; with prefixes as in mm, kN, GPa
"#;

    ambiguous_unit r#""6.45 g/cm^3""# => r#""6.45 kg/m s""#, r#""kg/m s" can be read in two ways
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "6.45 kg/m s"
   |           ^^^^^^^^^^^^^
hint: repeat the slash, as in "kg/m/s", or write the divided units last
"#;

    missing_unit r#""390 mm""# => r#""390""#, r#"found a number without a unit, expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390"
   |          ^^^^^
"#;

    decimal_comma r#""390 mm""# => r#""390,5 mm""#, r#"found ",5 mm" after a number, expected a unit
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390,5 mm"
   |          ^^^^^^^^^^
hint: write decimals with a point and thousands without a mark: 1.5, 2000
"#;

    no_number r#""390 mm""# => r#""long""#, r#"found "long", expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "long"
   |          ^^^^^^
"#;

    empty_quantity r#""390 mm""# => r#""""#, r#"found an empty text, expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = ""
   |          ^^
"#;

    not_a_number r#""390 mm""# => r#""NaN mm""#, r#""NaN mm" is not a finite number
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "NaN mm"
   |          ^^^^^^^^
"#;

    infinite r#""390 mm""# => r#""-inf mm""#, r#""-inf mm" is not a finite number
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "-inf mm"
   |          ^^^^^^^^^
"#;

    too_large r#""390 mm""# => r#""1e999 mm""#, r#""1e999 mm" is too large to compute with
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "1e999 mm"
   |          ^^^^^^^^^^
"#;

    negative_length r#""390 mm""# => r#""-390 mm""#, r#"found "-390 mm", expected a length above 0 m
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "-390 mm"
   |          ^^^^^^^^^
"#;

    zero_length r#""390 mm""# => r#""0 mm""#, r#"found "0 mm", expected a length above 0 m
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "0 mm"
   |          ^^^^^^
"#;

    negative_modulus r#""54 GPa""# => r#""-54 GPa""#, r#"found "-54 GPa", expected force per area above 0 Pa
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "-54 GPa"
  |                  ^^^^^^^^^
"#;

    negative_density r#""6.45 g/cm^3""# => r#""-6.45 g/cm^3""#, r#"found "-6.45 g/cm^3", expected mass per volume of at least 0 kg/m^3
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "-6.45 g/cm^3"
   |           ^^^^^^^^^^^^^^
"#;

    poisson_ratio_too_large "= 0.33" => "= 0.7", r#"found 0.7, expected a number above -1 and at most 0.5
  --> rod.toml:10:17, key material.niti.poisson_ratio
   |
10 | poisson_ratio = 0.7
   |                 ^^^
"#;

    poisson_ratio_in_quotes "= 0.33" => r#"= "0.33""#, r#"found "0.33", expected a number above -1 and at most 0.5
  --> rod.toml:10:17, key material.niti.poisson_ratio
   |
10 | poisson_ratio = "0.33"
   |                 ^^^^^^
hint: a number without a unit is written without quotes
"#;

    poisson_ratio_nan "= 0.33" => "= nan", r#"found nan, expected a number above -1 and at most 0.5
  --> rod.toml:10:17, key material.niti.poisson_ratio
   |
10 | poisson_ratio = nan
   |                 ^^^
"#;

    two_ways_to_the_shear_modulus "poisson_ratio = 0.33" => r#"poisson_ratio = 0.33
shear_modulus = "20 GPa""#, r#""poisson_ratio" and "shear_modulus" are two ways to give the same thing
  --> rod.toml:11:17, key material.niti.shear_modulus
   |
11 | shear_modulus = "20 GPa"
   |                 ^^^^^^^^
hint: keep one of them
"#;

    no_way_to_the_shear_modulus r#"poisson_ratio = 0.33
"# => "", r#"missing key "poisson_ratio", expected a number such as 0.33 (or "shear_modulus" instead)
 --> rod.toml:8:1, key material.niti
  |
8 | [material.niti]
  | ^^^^^^^^^^^^^^^
"#;

    unknown_key "density =" => "dencity =", r#"unknown key "dencity"
  --> rod.toml:11:1, key material.niti.dencity
   |
11 | dencity = "6.45 g/cm^3"
   | ^^^^^^^
hint: did you mean "density"?
"#;

    unknown_key_unlike_any "density =" => r#"colour = 3
density ="#, r#"unknown key "colour"
  --> rod.toml:11:1, key material.niti.colour
   |
11 | colour = 3
   | ^^^^^^
hint: known keys here: youngs_modulus, poisson_ratio, shear_modulus, density, strain_limit
"#;

    missing_key r#"density = "6.45 g/cm^3"
"# => "", r#"missing key "density", expected mass per volume, such as "6450 kg/m^3"
 --> rod.toml:8:1, key material.niti
  |
8 | [material.niti]
  | ^^^^^^^^^^^^^^^
"#;

    wrong_type r#"name = "trunk""# => "name = true", r#"found true or false, expected a name, such as "trunk"
 --> rod.toml:1:8, key name
  |
1 | name = true
  |        ^^^^
"#;

    empty_name r#"name = "trunk""# => r#"name = " ""#, r#"found an empty text, expected a name, such as "trunk"
 --> rod.toml:1:8, key name
  |
1 | name = " "
  |        ^^^
"#;

    section_in_single_brackets "[[section]]" => "[section]", r#"found a table, expected [[section]] in double brackets, since there can be several
  --> rod.toml:14:1, key section
   |
14 | [section]
   | ^^^^^^^^^
"#;

    profile_as_text r#"{ diameter = "1.5 mm" }"# => r#""1.5 mm""#, r#"found "1.5 mm", expected a table
  --> rod.toml:18:11, key section.rod.profile
   |
18 | profile = "1.5 mm"
   |           ^^^^^^^^
"#;

    duplicate_name "# more" => r#"[[section]]
name = "rod"
"#, r#"the name "rod" is given twice
  --> rod.toml:25:8, key section.rod.name
   |
25 | name = "rod"
   |        ^^^^^
"#;

    bad_name r#"name = "rod""# => r#"name = "rod 1""#, r#"found "rod 1", expected a name of letters, digits, - and _
  --> rod.toml:15:8, key section.1.name
   |
15 | name = "rod 1"
   |        ^^^^^^^
"#;

    unknown_material r#"material = "niti""# => r#"material = "spring_stel""#, r#"unknown material "spring_stel"
  --> rod.toml:17:12, key section.rod.material
   |
17 | material = "spring_stel"
   |            ^^^^^^^^^^^^^
hint: did you mean "spring_steel"?
"#;

    unknown_material_unlike_any r#"material = "niti""# => r#"material = "wood""#, r#"unknown material "wood"
  --> rod.toml:17:12, key section.rod.material
   |
17 | material = "wood"
   |            ^^^^^^
hint: define [material.wood], or take one of niti, nitinol, spring_steel, stainless_steel, fibreglass, carbon, peek, abs, pla, ecoflex_00_30, dragon_skin_30
"#;

    bore_too_wide r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", inner_diameter = "1.6 mm" }"#, r#"the inner diameter at the section's base, 1.6 mm, must be below the outer diameter, 1.5 mm
  --> rod.toml:18:51, key section.rod.profile.inner_diameter
   |
18 | profile = { diameter = "1.5 mm", inner_diameter = "1.6 mm" }
   |                                                   ^^^^^^^^
"#;

    bore_too_wide_at_the_tip r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", inner_diameter = "1 mm", tip_diameter = "0.8 mm" }"#, r#"the inner diameter at the section's tip, 1 mm, must be below the outer diameter, 0.8 mm
  --> rod.toml:18:11, key section.rod.profile
   |
18 | profile = { diameter = "1.5 mm", inner_diameter = "1 mm", tip_diameter = "0.8 mm" }
   |           ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
"#;

    round_and_strip r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", height = "1 mm" }"#, r#"a profile is either round (diameter) or a strip (width and height)
  --> rod.toml:18:24, key section.rod.profile.diameter
   |
18 | profile = { diameter = "1.5 mm", height = "1 mm" }
   |                        ^^^^^^^^
"#;

    negative_shear_coefficient r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", shear_coefficient = -1 }"#, r#"found -1, expected a number above 0, such as 0.9
  --> rod.toml:18:54, key section.rod.profile.shear_coefficient
   |
18 | profile = { diameter = "1.5 mm", shear_coefficient = -1 }
   |                                                      ^^
"#;

    rest_curvature_folds r#"material = "niti""# => r#"material = "niti"
rest_curvature = "[1400, 0, 0] 1/m""#, r#"a rod this thick cannot be bent this much: its inner side would overlap itself
  --> rod.toml:18:18, key section.rod.rest_curvature
   |
18 | rest_curvature = "[1400, 0, 0] 1/m"
   |                  ^^^^^^^^^^^^^^^^^^
hint: curvature times half the thickness must be below 1, and is 1.050
"#;

    vector_of_two r#""[0, 0, 0.01] N m""# => r#""[0, 0] N m""#, r#"found a list of 2, expected three components, such as "[0, 0, 1] N m"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = "[0, 0] N m"
   |          ^^^^^^^^^^^^
"#;

    vector_as_array r#""[0, 0, 0.01] N m""# => "[0, 0, 0.01]", r#"found a list, expected three components, such as "[0, 0, 1] N m"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = [0, 0, 0.01]
   |          ^^^^^^^^^^^^
"#;

    vector_expected r#""[0, 0, 0.01] N m""# => r#""0.01 N m""#, r#"found "0.01 N m", expected three components, such as "[0, 0, 1] N m"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = "0.01 N m"
   |          ^^^^^^^^^^
"#;

    guides_two_ways "# guides" => r#"guides = { spacing = "10 mm", positions = "[10, 20] mm" }"#, r#""spacing" and "positions" are two ways to give the same thing
  --> rod.toml:19:43, key section.rod.guides.positions
   |
19 | guides = { spacing = "10 mm", positions = "[10, 20] mm" }
   |                                           ^^^^^^^^^^^^^
hint: keep one of them
"#;

    guides_no_way "# guides" => r#"guides = { mass = "1 g" }"#, r#"missing key "spacing", expected a length, such as "390 mm" (or "positions")
  --> rod.toml:19:10, key section.rod.guides
   |
19 | guides = { mass = "1 g" }
   |          ^^^^^^^^^^^^^^^^
"#;

    guide_outside "# guides" => r#"guides = { positions = "[10, 400] mm" }"#, r#"a guide at 400 mm is outside its section, 0 mm to 390 mm
  --> rod.toml:19:24, key section.rod.guides.positions
   |
19 | guides = { positions = "[10, 400] mm" }
   |                        ^^^^^^^^^^^^^^
"#;

    guides_out_of_order "# guides" => r#"guides = { positions = "[20, 10] mm" }"#, r#"guides must go from base to tip, but 10 mm follows 20 mm
  --> rod.toml:19:24, key section.rod.guides.positions
   |
19 | guides = { positions = "[20, 10] mm" }
   |                        ^^^^^^^^^^^^^
"#;

    guide_spacing_too_long "# guides" => r#"guides = { spacing = "1 m" }"#, r#"found "1 m", expected a length above 0 m and at most the section's length, 390 mm
  --> rod.toml:19:22, key section.rod.guides.spacing
   |
19 | guides = { spacing = "1 m" }
   |                      ^^^^^
"#;

    guides_without_number "# guides" => r#"guides = { spacing = "1 nm" }"#, r#"this spacing makes 390000000 guides, more than 10000
  --> rod.toml:19:22, key section.rod.guides.spacing
   |
19 | guides = { spacing = "1 nm" }
   |                      ^^^^^^
"#;

    load_beyond_the_tip r#"at = "tip""# => r#"at = "400 mm""#, r#"found "400 mm", expected a length from 0 mm to the robot's length, 390 mm
  --> rod.toml:22:6, key load.1.at
   |
22 | at = "400 mm"
   |      ^^^^^^^^
"#;

    load_at_no_place r#"at = "tip""# => r#"at = "end""#, r#"found "end", expected "tip" or an arc length, such as "120 mm"
  --> rod.toml:22:6, key load.1.at
   |
22 | at = "end"
   |      ^^^^^
"#;

    load_without_place r#"at = "tip"
"# => "", r#"missing key "at", expected "tip" or an arc length, such as "120 mm"
  --> rod.toml:21:1, key load.1
   |
21 | [[load]]
   | ^^^^^^^^
"#;

    load_of_nothing r#"moment = "[0, 0, 0.01] N m"
"# => "", r#"this load has no force, moment, mass, force_per_length or moment_per_length
  --> rod.toml:21:1, key load.1
   |
21 | [[load]]
   | ^^^^^^^^
"#;

    load_mass_and_force r#"moment = "[0, 0, 0.01] N m""# => r#"mass = "20 g"
force = "[0, -0.2, 0] N""#, r#""mass" and "force" cannot stand in one load: a hung mass acts by its weight
  --> rod.toml:24:9, key load.1.force
   |
24 | force = "[0, -0.2, 0] N"
   |         ^^^^^^^^^^^^^^^^
hint: loads add up: write a second [[load]]
"#;

    load_at_and_along r#"at = "tip""# => r#"at = "tip"
from = "10 mm""#, r#"a load acts either at a point (at) or along a stretch (from, to)
  --> rod.toml:23:8, key load.1.from
   |
23 | from = "10 mm"
   |        ^^^^^^^
"#;

    load_along_nothing r#"at = "tip"
moment = "[0, 0, 0.01] N m""# => r#"from = "200 mm"
to = "100 mm"
force_per_length = "[0, 1, 0] N/m""#, r#"the load's stretch, 200 mm to 100 mm, has no length
  --> rod.toml:22:8, key load.1.from
   |
22 | from = "200 mm"
   |        ^^^^^^^^
"#;

    load_frame r#"at = "tip""# => r#"at = "tip"
frame = "tool""#, r#"found "tool", expected "world" (a dead load) or "body" (follows the section)
  --> rod.toml:23:9, key load.1.frame
   |
23 | frame = "tool"
   |         ^^^^^^
"#;

    negative_mass r#"moment = "[0, 0, 0.01] N m""# => r#"mass = "-20 g""#, r#"found "-20 g", expected a mass of at least 0 kg
  --> rod.toml:23:8, key load.1.mass
   |
23 | mass = "-20 g"
   |        ^^^^^^^
"#;

    normal_along_tangent "normal = [0, 1, 0]" => "normal = [2, 0, 0]", r#"the normal is parallel to the tangent
 --> rod.toml:6:10, key base.normal
  |
6 | normal = [2, 0, 0]
  |          ^^^^^^^^^
"#;

    tangent_zero "tangent = [1, 0, 0]" => "tangent = [0, 0, 0]", r#"found a direction of length zero
 --> rod.toml:5:11, key base.tangent
  |
5 | tangent = [0, 0, 0]
  |           ^^^^^^^^^
"#;

    tangent_of_two "tangent = [1, 0, 0]" => "tangent = [1, 0]", r#"found a list of 2, expected three numbers, such as [0, 0, 1]
 --> rod.toml:5:11, key base.tangent
  |
5 | tangent = [1, 0]
  |           ^^^^^^
"#;

    tendons "# more" => r#"[[tendon]]
name = "a""#, r#"tendons come with a later version; this one solves rods under loads
  --> rod.toml:24:1, key tendon
   |
24 | [[tendon]]
   | ^^^^^^^^^^
hint: take the tables [[tendon]] and [actuation] out
"#;

    actuation "# more" => r#"[actuation]
tension = { a = "2 N" }"#, r#"tendons come with a later version; this one solves rods under loads
  --> rod.toml:24:1, key actuation
   |
24 | [actuation]
   | ^^^^^^^^^^^
hint: take the tables [[tendon]] and [actuation] out
"#;

    syntax r#""390 mm""# => "390 mm", r#"not TOML: string values must be quoted, expected literal string
  --> rod.toml:16:10
   |
16 | length = 390 mm
   |          ^^^^^^
hint: texts and values with a unit stand in quotes: "390 mm"
"#;

    key_given_twice "density =" => r#"density = "1 g/cm^3"
density ="#, r#"not TOML: duplicate key
  --> rod.toml:12:1
   |
12 | density = "6.45 g/cm^3"
   | ^^^^^^^
"#;

}

edits! { doubts robot_warning ROD:
    density_in_the_wrong_unit r#""6.45 g/cm^3""# => r#""6.80 g/mm^3""#, r#"a density of 6800000 kg/m^3 is implausible
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "6.80 g/mm^3"
   |           ^^^^^^^^^^^^^
hint: "6.80 g/cm^3" was probably meant
"#;

    density_of_nothing r#""6.45 g/cm^3""# => r#""0.5 kg/m^3""#, r#"a density of 0.5 kg/m^3 is implausible
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "0.5 kg/m^3"
   |           ^^^^^^^^^^^^
hint: solids lie between 1 kg/m^3 (aerogels) and 22600 kg/m^3 (osmium)
"#;

    density_absurd r#""6.45 g/cm^3""# => r#""68 g/cm^3""#, r#"a density of 68000 kg/m^3 is implausible
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "68 g/cm^3"
   |           ^^^^^^^^^^^
hint: solids lie between 1 kg/m^3 (aerogels) and 22600 kg/m^3 (osmium)
"#;

    stiffer_than_diamond r#""54 GPa""# => r#""54000 GPa""#, r#"a Young's modulus of 5.4e13 Pa is implausible
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "54000 GPa"
  |                  ^^^^^^^^^^^
hint: solids lie between 1 kPa (gels) and 1200 GPa (diamond)
"#;

    softer_than_gel r#""54 GPa""# => r#""54 Pa""#, r#"a Young's modulus of 5.4e1 Pa is implausible
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "54 Pa"
  |                  ^^^^^^^
hint: solids lie between 1 kPa (gels) and 1200 GPa (diamond)
"#;

    thick_robot r#""390 mm""# => r#""4 mm""#, r#"the robot is only 2.6666666666666665 times as long as it is thick
  --> rod.toml:14:1, key section.rod
   |
14 | [[section]]
   | ^^^^^^^^^^^
hint: rod theory is made for slender bodies, 10 times and more
"#;

    gravity_absurd r#""[0, -9.81, 0] m/s^2""# => r#""[0, -981, 0] m/s^2""#, r#"a gravity of 981 m/s^2 is implausible
 --> rod.toml:2:11, key gravity
  |
2 | gravity = "[0, -981, 0] m/s^2"
  |           ^^^^^^^^^^^^^^^^^^^^
hint: the Earth's is 9.81 m/s^2
"#;

    rest_curvature_over_the_limit r#"material = "niti""# => r#"material = "niti"
rest_curvature = "[20, 0, 0] 1/m""#, r#"straightening this rest curvature strains the section by 1.5 %, over the limit of 1 %
  --> rod.toml:18:18, key section.rod.rest_curvature
   |
18 | rest_curvature = "[20, 0, 0] 1/m"
   |                  ^^^^^^^^^^^^^^^^
"#;

    shear_coefficient_absurd r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", shear_coefficient = 2 }"#, r#"a shear coefficient of 2 is implausible
  --> rod.toml:18:54, key section.rod.profile.shear_coefficient
   |
18 | profile = { diameter = "1.5 mm", shear_coefficient = 2 }
   |                                                      ^
hint: 0.9 for a round rod, 5/6 for a strip, 1 as in the thesis
"#;

    shear_modulus_absurd "poisson_ratio = 0.33" => r#"shear_modulus = "60 GPa""#, r#"a shear modulus of 1.111 E is implausible
  --> rod.toml:10:17, key material.niti.shear_modulus
   |
10 | shear_modulus = "60 GPa"
   |                 ^^^^^^^^
hint: an isotropic material has E/3 <= G < E/2 or so
"#;

}

edits! { experiments in_experiment EXPERIMENT:
    missing_column r#"column = "mass""# => r#"column = "mas""#, r#"lab/table.csv has no column "mas"
 --> lab/bench.toml:7:10, key vary.1.column
  |
7 | column = "mas"
  |          ^^^^^
hint: did you mean "mass"?
"#;

    missing_column_unlike_any r#"column = "mass""# => r#"column = "load""#, r#"lab/table.csv has no column "load"
 --> lab/bench.toml:7:10, key vary.1.column
  |
7 | column = "load"
  |          ^^^^^^
hint: its columns: mass [g], tip x [mm], tip y [mm], error [mm], error [%], angle [deg]
"#;

    column_of_another_kind r#"column = "mass""# => r#"column = "tip x""#, r#"found a length, expected a mass, such as "20 g"
 --> lab/table.csv:2:10
  |
2 | mass [g],tip x [mm],tip y [mm],error [mm],error [%],angle [deg]
  |          ^^^^^^^^^^
"#;

    column_named_twice r#"x = "tip x""# => r#"x = "error""#, r#"lab/table.csv has several columns "error"
  --> lab/bench.toml:12:5, key measure.1.x
   |
12 | x = "error"
   |     ^^^^^^^
hint: give the whole header: error [mm] or error [%]
"#;

    two_angles "# bench" => r#"[bench]
mount_angle = "30 deg"
[[vary]]
quantity = "mount_angle"
column = "angle""#, r#"the mount angle is both varied here and fixed in [bench]
  --> lab/bench.toml:22:12, key vary.2.quantity
   |
22 | quantity = "mount_angle"
   |            ^^^^^^^^^^^^^
"#;

    unknown_variation r#""hung_mass""# => r#""weight""#, r#"found "weight", expected "hung_mass", "mount_angle" or "force"
 --> lab/bench.toml:6:12, key vary.1.quantity
  |
6 | quantity = "weight"
  |            ^^^^^^^^
"#;

    direction_of_a_mass r#"quantity = "hung_mass""# => r#"quantity = "hung_mass"
direction = [0, 1, 0]"#, r#""direction" does not apply to hung_mass
 --> lab/bench.toml:7:13, key vary.1.direction
  |
7 | direction = [0, 1, 0]
  |             ^^^^^^^^^
"#;

    force_without_direction r#"quantity = "hung_mass""# => r#"quantity = "force""#, r#"missing key "direction", expected three numbers, such as [0, -1, 0]
 --> lab/bench.toml:5:1, key vary.1
  |
5 | [[vary]]
  | ^^^^^^^^
"#;

    point_beyond_the_tip r#"at = "tip" # point"# => r#"at = "1 m""#, r#"found "1 m", expected a length from 0 mm to the robot's length, 390 mm
  --> lab/bench.toml:11:6, key measure.1.at
   |
11 | at = "1 m"
   |      ^^^^^
"#;

    point_without_column r#"x = "tip x"
y = "tip y"
"# => "", r#"this point has no column: give one or more of x, y and z
  --> lab/bench.toml:10:1, key measure.1
   |
10 | [[measure]]
   | ^^^^^^^^^^^
"#;

    no_reading_error r#"reading_error = "0.5 mm"
"# => "", r#"missing key "reading_error", expected a length, such as "390 mm"
  --> lab/bench.toml:10:1, key measure.1
   |
10 | [[measure]]
   | ^^^^^^^^^^^
"#;

    bench_axes_parallel "# bench" => r#"[bench]
x = [0, 1, 0]"#, r#"the bench's x and y axes are parallel
  --> lab/bench.toml:20:5, key bench.x
   |
20 | x = [0, 1, 0]
   |     ^^^^^^^^^
"#;

    robot_file_missing r#"robot = "rod.toml""# => r#"robot = "rods.toml""#, r#"cannot read rods.toml: no such file
 --> lab/bench.toml:2:9, key robot
  |
2 | robot = "rods.toml"
  |         ^^^^^^^^^^^
"#;

    set_nowhere r#""section.rod.length""# => r#""section.bar.length""#, r#"the robot has no "bar" to set "section.bar.length" in
  --> lab/bench.toml:18:32, key variant.shorter.set.section.bar.length
   |
18 | set = { "section.bar.length" = "380 mm" }
   |                                ^^^^^^^^
"#;

    set_unknown_key r#""section.rod.length""# => r#""section.rod.lenght""#, r#"unknown key "lenght"
  --> lab/bench.toml:18:9, key variant.shorter.set.section.rod.lenght
   |
18 | set = { "section.rod.lenght" = "380 mm" }
   |         ^^^^^^^^^^^^^^^^^^^^
hint: did you mean "length"?
"#;

    set_impossible r#""section.rod.length" = "380 mm""# => r#""section.rod.length" = "-380 mm""#, r#"found "-380 mm", expected a length above 0 m
  --> lab/bench.toml:18:32, key variant.shorter.set.section.rod.length
   |
18 | set = { "section.rod.length" = "-380 mm" }
   |                                ^^^^^^^^^
"#;

}

edits! { tables in_table TABLE:
    unit_missing_in_header "mass [g]" => "mass", r#"the column "mass" has no unit, expected a mass, such as "20 g"
 --> lab/table.csv:2:1
  |
2 | mass,tip x [mm],tip y [mm],error [mm],error [%],angle [deg]
  | ^^^^
hint: write the unit in brackets, as in "mass [kg]"
"#;

    unknown_unit_in_header "mass [g]" => "mass [gr]", r#"unknown unit "gr"
 --> lab/table.csv:2:1
  |
2 | mass [gr],tip x [mm],tip y [mm],error [mm],error [%],angle [deg]
  | ^^^^^^^^^
hint: did you mean "gf"?
"#;

    cell_not_a_number "300.5" => "300,5", r#"found 7 cells, but the header has 6
 --> lab/table.csv:4:1
  |
4 | 10,300,5,-100.25,1,2,0
  | ^^^^^^^^^^^^^^^^^^^^^^
hint: cells are separated by commas; decimals are written with a point
"#;

    cell_text "300.5" => "n/a", r#"found "n/a" in column "tip x", expected a number
 --> lab/table.csv:4:4
  |
4 | 10,n/a,-100.25,1,2,0
  |    ^^^
"#;

    cell_nan "300.5" => "NaN", r#"found "NaN" in column "tip x", expected a number
 --> lab/table.csv:4:4
  |
4 | 10,NaN,-100.25,1,2,0
  |    ^^^
"#;

    cell_empty "300.5" => "", r#"found an empty cell in column "tip x", expected a number
 --> lab/table.csv:4:4
  |
4 | 10,,-100.25,1,2,0
  |    ^
"#;

    negative_mass "10," => "-10,", r#"found a negative mass, expected at least 0
 --> lab/table.csv:4:1
  |
4 | -10,300.5,-100.25,1,2,0
  | ^^^
"#;

    row_too_short ",300.5,-100.25" => ",300.5", r#"found 5 cells, but the header has 6
 --> lab/table.csv:4:1
  |
4 | 10,300.5,1,2,0
  | ^^^^^^^^^^^^^^
hint: cells are separated by commas; decimals are written with a point
"#;

    no_rows r#"0,350.5,-20.00,1,2,0
10,300.5,-100.25,1,2,0
"# => "", r#"the file has no rows of data
 --> lab/table.csv:1:1
  |
1 | # hung masses
  | ^
"#;

}

edits! { robots_of_experiments in_rod ROD:
    robot_wrong r#""390 mm""# => r#""390 N""#, r#"found a force, expected a length, such as "390 mm"
  --> lab/rod.toml:16:10, key section.rod.length
   |
16 | length = "390 N"
   |          ^^^^^^^
"#;

}
