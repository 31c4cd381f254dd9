//! What the readers make of valid files, and that no text makes them panic.

use hydrostat::description::{builtin, parse_experiment, parse_robot, quantity, templates};
use hydrostat::model::{CrossSection, Frame, LoadKind};
use hydrostat::verify::Varied;
use hydrostat::{Error, Robot};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use std::path::Path;

const EPSILON: f64 = 1e-15; // a few roundings of numbers of size 1

/// A one-section robot with more lines at the top and in the section.
fn robot(top: &str, section: &str) -> Robot {
    let text = format!(
        "name = \"test\"\n{top}\n[[section]]\nname = \"rod\"\nlength = \"200 mm\"\nmaterial = \"nitinol\"\n{section}\n"
    );
    match parse_robot(&text, "test.toml") {
        Ok(parsed) => parsed.value,
        Err(error) => panic!("{error}"),
    }
}

fn vector(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

const ROUND: &str = "profile = { diameter = \"1.5 mm\" }";

#[test]
fn defaults() {
    let robot = robot("", ROUND);
    assert_eq!(robot.gravity, vector(0.0, 0.0, -9.81));
    assert_eq!(robot.base.position, Vector3::zeros());
    assert_eq!(robot.base.rotation.matrix(), &Matrix3::identity());
    assert_eq!(robot.sections[0].rest_curvature, Vector3::zeros());
    assert_eq!(robot.sections[0].profile.shear_coefficient, 1.0);
    assert_eq!((robot.sections[0].guides.clone(), robot.loads.len()), (None, 0));
}

#[test]
fn the_base_is_a_rotation_with_the_tangent_as_d3() {
    for tangent in
        ["[1, 0, 0]", "[0, -3, 0]", "[0, 0, -1]", "[1, 2, 3]", "[1e200, 1e200, 0]", "[-1, 1e-9, 0]"]
    {
        let robot = robot(&format!("[base]\ntangent = {tangent}"), ROUND);
        let rotation = robot.base.rotation.matrix();
        assert!((rotation.transpose() * rotation - Matrix3::identity()).amax() < EPSILON, "{tangent}");
        assert!((rotation.determinant() - 1.0).abs() < EPSILON, "{tangent}");
    }
    let robot = robot("[base]\ntangent = [2, 0, 0]\nnormal = [1, 1, 0]", ROUND);
    let expected = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    assert!((robot.base.rotation.matrix() - expected).amax() < EPSILON);
}

#[test]
fn profiles() {
    let profile = |text: &str| robot("", &format!("profile = {{ {text} }}")).sections[0].profile;
    let tube = |diameter, inner_diameter| CrossSection::Tube { diameter, inner_diameter };
    let strip = |width, height| CrossSection::Strip { width, height };
    let round = |diameter| CrossSection::Round { diameter };
    let cases = [
        (r#"diameter = "2 mm""#, round(2e-3), round(2e-3)),
        (r#"diameter = "2 mm", tip_diameter = "1 mm""#, round(2e-3), round(1e-3)),
        (r#"diameter = "2 mm", inner_diameter = "1 mm""#, tube(2e-3, 1e-3), tube(2e-3, 1e-3)),
        (
            r#"diameter = "3 mm", inner_diameter = "1 mm", tip_diameter = "2 mm""#,
            tube(3e-3, 1e-3),
            tube(2e-3, 1e-3),
        ),
        (r#"width = "3 mm", height = "1 mm", tip_height = "0.5 mm""#, strip(3e-3, 1e-3), strip(3e-3, 0.5e-3)),
    ];
    for (text, base, tip) in cases {
        assert_eq!((profile(text).base, profile(text).tip), (base, tip), "{text}");
    }
    assert_eq!(profile(r#"diameter = "2 mm", shear_coefficient = 0.9"#).shear_coefficient, 0.9);
}

#[test]
fn guides_at_a_spacing_reach_the_tip() {
    let robot = robot("", &format!("{ROUND}\nguides = {{ spacing = \"10 mm\", mass = \"0.9 g\" }}"));
    let guides = robot.sections[0].guides.clone().expect("guides");
    assert_eq!((guides.positions.len(), guides.mass), (20, 0.9e-3));
    for (i, at) in guides.positions.iter().enumerate() {
        assert!((at - 0.01 * (i + 1) as f64).abs() < EPSILON);
    }
}

#[test]
fn loads() {
    let text = r#"
[[load]]
at = "tip"
force = "[0, -0.2, 0] N"
frame = "body"
[[load]]
name = "weight"
at = "120 mm"
mass = "20 g"
[[load]]
from = "50 mm"
force_per_length = "[0, 0, -0.5] N/m"
moment_per_length = "[1, 0, 0] mN"
"#;
    let robot = robot("", &format!("{ROUND}{text}"));
    let kinds: Vec<LoadKind> = robot.loads.iter().map(|load| load.kind).collect();
    let expected = [
        LoadKind::Point {
            at: 0.2,
            force: vector(0.0, -0.2, 0.0),
            moment: Vector3::zeros(),
            frame: Frame::Body,
        },
        LoadKind::Mass { at: 0.12, mass: 0.02 },
        LoadKind::Distributed {
            from: 0.05,
            to: 0.2,
            force_per_length: vector(0.0, 0.0, -0.5),
            moment_per_length: vector(1e-3, 0.0, 0.0),
            frame: Frame::World,
        },
    ];
    assert_eq!(kinds, expected);
    assert_eq!(robot.loads[1].name.as_deref(), Some("weight"));
}

#[test]
fn the_shipped_files_say_what_the_thesis_says() {
    let robot = builtin::robot().expect("is valid");
    assert_eq!(robot.warnings, []);
    assert_eq!((robot.value.length(), robot.value.gravity), (0.39, vector(0.0, -9.81, 0.0)));
    let stated = builtin::experiment().expect("is valid");
    assert_eq!(stated.warnings, []);
    let experiment = stated.value;
    assert_eq!(experiment.inputs[0].quantity, Varied::HungMass { at: 0.39 });
    assert_eq!(experiment.inputs[0].unit, ("g".to_string(), 1e-3));
    assert_eq!((experiment.rows.len(), experiment.variants.len()), (11, 3));
    assert_eq!(experiment.rows[10].inputs, [0.0417]);
    assert_eq!(experiment.rows[10].observed, [vector(0.258, -0.269, 0.0)]);
    let published = experiment.published.expect("is given");
    assert_eq!(published.predicted[10], vector(0.2577, -0.2648, 0.0));
    assert_eq!((published.error[10], published.error_fraction[10]), (0.0042, 0.0107));
    // Half a unit of 0.01 cm, of 0.1 mm, of 0.01 %.
    assert_eq!(published.rounding, [5e-5, 5e-5, 5e-5]);
    let printed = [("mean error in the text", 0.0021), ("mean error in the table", 0.0024)];
    assert_eq!(published.mean_errors, printed.map(|(name, value)| (name.to_string(), value)));
}

#[test]
fn the_fitted_weight_is_the_one_of_the_predicted_column() {
    let fitted = builtin::fitted_experiment().expect("is valid").value;
    let section = &fitted.robot.sections[0];
    let area = std::f64::consts::PI / 4.0 * 1.56e-3f64.powi(2);
    let weight = section.material.density * area * 9.81;
    assert!((weight - 0.1176).abs() < 5e-5); // the fit's last digit
}

/// The robot turns on the bench; gravity does not turn with it.
#[test]
fn a_fixed_mount_angle_turns_the_base_from_x_to_y() {
    let text =
        format!("{}\n[bench]\norigin = \"[1, 0, 0] m\"\nmount_angle = \"90 deg\"\n", builtin::EXPERIMENT);
    let mut load =
        |path: &str| Ok(if path == "table.csv" { builtin::TABLE } else { builtin::ROBOT }.to_string());
    let text = text.replace("table2.csv", "table.csv");
    let experiment = parse_experiment(&text, "bench.toml", &mut load).expect("is valid").value;
    for robot in experiment.variants.iter().map(|(_, robot)| robot).chain([&experiment.robot]) {
        assert!((robot.base.rotation * Vector3::z() - Vector3::y()).norm() < EPSILON);
        assert!((robot.base.position - vector(1.0, -1.0, 0.0)).norm() < EPSILON);
        assert_eq!(robot.gravity, vector(0.0, -9.81, 0.0));
    }
}

#[test]
fn templates_are_accepted_under_any_name() {
    for name in ["trunk", "my rod", "a\"b\\c\n", "größe"] {
        let [experiment, table, bench_rod] = templates::bench(name);
        let mut load = |path: &str| {
            let file = [&table, &bench_rod].into_iter().find(|file| file.name == path);
            file.map(|file| file.text.clone()).ok_or_else(|| Error::new(format!("no file {path}")))
        };
        let rod = parse_robot(&templates::rod(name).text, "rod.toml").expect("is valid");
        let bench = parse_experiment(&experiment.text, "bench.toml", &mut load).expect("is valid");
        assert_eq!((rod.warnings, bench.warnings), (vec![], vec![]));
        assert_eq!((rod.value.loads.len(), bench.value.rows.len()), (1, 12));
    }
}

#[test]
#[expect(clippy::print_stderr, reason = "a skipped test says so")]
fn reference_cases_are_accepted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/reference_cases");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        eprintln!("skipped: no {}", folder.display());
        return;
    };
    let mut rods = 0;
    for path in entries.map(|entry| entry.expect("readable").path()) {
        let Some(name) =
            path.file_name().and_then(|name| name.to_str()).filter(|name| name.ends_with(".toml"))
        else {
            continue;
        };
        let parsed = parse_robot(&std::fs::read_to_string(&path).expect("readable"), name);
        let parsed = parsed.expect("is valid");
        // one of them has a tendon inside its thick backbone
        let inside = |warning: &Error| warning.message().contains("inside the backbone");
        assert!(parsed.warnings.iter().all(inside), "{name}: {:?}", parsed.warnings);
        rods += usize::from(name.starts_with('r'));
    }
    assert!(rods > 0);
}

fn read_all(text: &str) {
    let kinds = [quantity::LENGTH, quantity::DENSITY, quantity::FRACTION];
    for kind in &kinds {
        let _ = quantity::scalar(text, kind);
        let _ = quantity::vector(text, kind);
        let _ = quantity::list(text, kind);
    }
    for result in
        [parse_robot(text, "f").map(|_| ()), read_experiment(text, builtin::TABLE), read_table(text)]
    {
        if let Err(error) = result {
            assert!(!error.to_string().is_empty());
        }
    }
}

fn read_table(table: &str) -> Result<(), Error> {
    read_experiment(builtin::EXPERIMENT, table)
}

fn read_experiment(experiment: &str, table: &str) -> Result<(), Error> {
    let mut load = |path: &str| Ok(if path.ends_with("csv") { table } else { builtin::ROBOT }.to_string());
    parse_experiment(experiment, "f", &mut load).map(|_| ())
}

/// A valid file with a piece replaced.
fn mutated() -> impl Strategy<Value = String> {
    let files = [builtin::ROBOT, builtin::EXPERIMENT, builtin::TABLE].map(str::to_string);
    let rod = templates::rod("rod").text;
    let piece = prop_oneof![
        "\\PC{0,8}",
        "[-+0-9.eE]{0,6} ?[a-zA-Z%/^*µ°]{0,4}",
        "[\\[\\]{}=\"',.#\n\r\t-]{0,6}",
        Just("name = \"x\"\n[[section]]\n".to_string()),
    ];
    (prop::sample::select([&files[..], &[rod]].concat()), any::<[prop::sample::Index; 2]>(), piece).prop_map(
        |(text, [from, length], piece)| {
            let chars: Vec<char> = text.chars().collect();
            let from = from.index(chars.len());
            let to = (from + length.index(12)).min(chars.len());
            chars[..from].iter().copied().chain(piece.chars()).chain(chars[to..].iter().copied()).collect()
        },
    )
}

proptest! {
    #[test]
    fn no_text_makes_the_readers_panic(text in "\\PC*") {
        read_all(&text);
    }

    #[test]
    fn no_bytes_make_the_readers_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read_all(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn no_mutation_makes_the_readers_panic(text in mutated()) {
        read_all(&text);
    }

    #[test]
    fn a_written_number_is_read_back(value in -1e6..1e6f64) {
        prop_assert_eq!(quantity::scalar(&format!("{value} m"), &quantity::LENGTH), Ok(value));
        prop_assert_eq!(quantity::scalar(&format!("{value:e} m"), &quantity::LENGTH), Ok(value));
    }
}
