//! Calibration of a robot that is driven by its tendons, against benches whose truth is known.

use hydrostat::Error;
use hydrostat::calibrate::{Calibration, Problem, calibrate, predict, sensitivities};
use hydrostat::description::{CalibrationFlags, parse_calibration, parse_robot, write_calibrated};
use hydrostat::model::Command;
use hydrostat::statics::{Settings, solve};
use nalgebra::DVector;

const ROBOT: &str = r#"
name = "two tendons"
[material.wire]
youngs_modulus = "60 GPa"
poisson_ratio = 0.3
density = "6.5 g/cm^3"
[[section]]
name = "only"
length = "100 mm"
material = "wire"
profile = { diameter = "0.8 mm" }
guides = { spacing = "25 mm", mass = "0.5 g" }
[[tendon]]
name = "a"
ends = "only"
radius = "5 mm"
routing = "channel"
stiffness = "2 kN"
home = "HOME_A"
[[tendon]]
name = "b"
ends = "only"
radius = "4 mm"
angle = "150 deg"
routing = "channel"
stiffness = "2 kN"
home = "HOME_B"
"#;

const BENCH: &str = r#"
name = "bench"
robot = "robot.toml"
data = "data.csv"
[[vary]]
quantity = "displacement"
tendon = "a"
column = "drive a"
unit = "mm"
backlash = "BACKLASH"
[[vary]]
quantity = "displacement"
tendon = "b"
column = "drive b"
unit = "mm"
backlash = "BACKLASH"
[[measure]]
at = "tip"
x = "x"
y = "y"
z = "z"
unit = "mm"
reading_error = "0.1 mm"
"#;

/// One tendon is pulled in while the other is paid out, there and back, past both ends.
const DRIVES: [[f64; 2]; 14] = [
    [0.0, 0.0],
    [1.0, -0.5],
    [2.0, -1.2],
    [3.0, -2.0],
    [4.0, -3.0],
    [3.0, -2.2],
    [2.0, -1.4],
    [1.0, -0.6],
    [0.0, 0.2],
    [-1.0, 1.2],
    [-2.0, 2.2],
    [-1.0, 1.4],
    [0.5, 0.0],
    [2.5, -1.6],
];

const TRUTH: [&str; 3] = ["0.3 mm", "0.15 mm", "0.2 mm"];
const BELIEVED: [&str; 3] = ["0 mm", "0 mm", "0.1 mm"];

fn table(readings: &[f64]) -> String {
    let rows = DRIVES.iter().zip(readings.chunks(3));
    let row = |(drive, read): (&[f64; 2], &[f64])| {
        let [a, b] = drive;
        format!("{a},{b},{:.9},{:.9},{:.9}\n", 1e3 * read[0], 1e3 * read[1], 1e3 * read[2])
    };
    "drive a,drive b,x,y,z\n".to_owned() + &rows.map(row).collect::<String>()
}

fn problem(values: [&str; 3], readings: &[f64], flags: &CalibrationFlags) -> Result<Problem, Error> {
    let [home_a, home_b, backlash] = values;
    let robot = ROBOT.replace("HOME_A", home_a).replace("HOME_B", home_b);
    let bench = BENCH.replace("BACKLASH", backlash);
    let data = table(readings);
    let mut load = |path: &str| Ok(if path.ends_with(".csv") { data.clone() } else { robot.clone() });
    parse_calibration(&bench, "bench.toml", &mut load, flags).map(|parsed| parsed.value)
}

fn flags(free: &str) -> CalibrationFlags {
    CalibrationFlags { free: vec![free.to_owned()], ..CalibrationFlags::default() }
}

/// What the true robot does, without any error of reading.
fn exact() -> Vec<f64> {
    let nothing = [0.0, 0.0, 0.1].repeat(DRIVES.len());
    let problem = problem(TRUTH, &nothing, &flags("tendon.a.home")).expect("is valid");
    sensitivities(&problem, &Settings::default()).expect("solves").0.iter().copied().collect()
}

fn fit(problem: &Problem) -> Calibration {
    calibrate(problem, &Settings::default()).expect("fits")
}

const FREE: &str = "tendon.a.home,tendon.b.home,vary.1.backlash+vary.2.backlash";

#[test]
fn home_and_backlash_are_found_from_exact_data() {
    let found = fit(&problem(BELIEVED, &exact(), &flags(FREE)).expect("is valid"));
    for (estimate, truth) in found.parameters.iter().zip([0.3e-3, 0.15e-3, 0.2e-3]) {
        assert!((estimate.value - truth).abs() < 2e-8, "{estimate:?}");
    }
    assert!(found.before.rms > 1e-3 && found.after.rms < 1e-6, "{:?} {:?}", found.before, found.after);
}

/// The step is small against what bends the curve and large against the tolerance of a solve.
#[test]
fn sensitivities_are_differences_of_solves() {
    const STEP: f64 = 1e-3;
    let names = "tendon.a.home,vary.2.backlash,guides.mass,tendon.a.angle+tendon.b.angle,tendon.*.stiffness,marker_offset.x";
    let problem = problem(TRUTH, &exact(), &flags(names)).expect("is valid");
    let settings = Settings::default();
    let (_, jacobian) = sensitivities(&problem, &settings).expect("solves");
    let start = hydrostat::calibrate::start(&problem).expect("has values");
    for (j, parameter) in problem.parameters.iter().enumerate() {
        let step = if start[j] == 0.0 { 1e-5 } else { STEP * start[j].abs() };
        let at = |side: f64| predict(&problem, j, start[j] + side * step, &settings).expect("solves");
        let difference: DVector<f64> = (at(1.0) - at(-1.0)) / (2.0 * step);
        let off = (&difference - jacobian.column(j)).amax() / jacobian.column(j).amax();
        assert!(off < 1e-3, "{}: {off:.1e}", parameter.name);
    }
}

/// A home of 0.3 mm and a command of 1 mm pull the tendon in as far as a command of 1.3 mm; commands are counted from home.
#[test]
fn displacements_are_counted_from_home() {
    let solved = |home: &str, displacement: f64| {
        let text = ROBOT.replace("HOME_A", home).replace("HOME_B", "0 mm");
        let mut robot = parse_robot(&text, "robot.toml").expect("is valid").value;
        robot.actuation[0] = Command::Displacement { displacement, motion: Default::default() };
        solve(&robot, &Settings::default()).expect("solves")
    };
    let (with, without) = (solved("0.3 mm", 1e-3), solved("0 mm", 1.3e-3));
    assert!((with.tip.position - without.tip.position).norm() < 1e-9);
    assert!((with.tendons[0].displacement - 1e-3).abs() < 1e-9, "{:?}", with.tendons[0]);
    assert!((without.tendons[0].displacement - 1.3e-3).abs() < 1e-9, "{:?}", without.tendons[0]);
}

#[test]
fn tied_parts_keep_their_differences_and_ratios() {
    let found = fit(&problem(TRUTH, &exact(), &flags("tendon.*.angle,tendon.*.radius")).expect("is valid"));
    // exact data of the file's robot leave both where they are
    assert!(found.before.rms < 1e-7, "{:?}", found.before);
    let tendons = &found.robot.tendons;
    assert!((tendons[1].path.angle - tendons[0].path.angle - 150_f64.to_radians()).abs() < 1e-12);
    assert!((tendons[1].path.radius / tendons[0].path.radius - 0.8).abs() < 1e-12);
}

#[test]
fn folds_starts_and_what_is_held_out_agree_on_exact_data() {
    let mut flags = flags(FREE);
    (flags.starts, flags.folds, flags.holdout) = (Some(3), Some(7), Some("unseen.csv".to_owned()));
    let found = fit(&problem(BELIEVED, &exact(), &flags).expect("is valid"));
    assert!(found.folds.expect("was asked for").max < 1e-5, "{:?}", found.folds);
    let [before, after] = found.holdout.expect("was asked for");
    assert!(before.rms > 1e-3 && after.rms < 1e-6, "{before:?} {after:?}");
    assert_eq!(found.starts.as_deref(), Some("3 of 3 starts lead to this fit."));
}

/// What is written is what was found, also where tied parts differ.
#[test]
fn tied_values_are_written_part_by_part() {
    let robot = ROBOT.replace("HOME_A", "0.1 mm").replace("HOME_B", "0.3 mm");
    let bench = BENCH.replace("BACKLASH", "0.2 mm");
    let data = table(&exact());
    let mut load = |path: &str| Ok(if path.ends_with(".csv") { data.clone() } else { robot.clone() });
    let problem =
        parse_calibration(&bench, "bench.toml", &mut load, &flags("tendon.*.home")).expect("is valid").value;
    let found = fit(&problem);
    let written = write_calibrated(&bench, "bench.toml", &mut load, &found, &[]).expect("is written");
    let written = parse_robot(&written, "written.toml").expect("is valid").value;
    for (written, found) in written.tendons.iter().zip(&found.robot.tendons) {
        assert!((written.home - found.home).abs() < 1e-6, "{} {}", written.home, found.home);
    }
    assert!((written.tendons[1].home - written.tendons[0].home - 0.2e-3).abs() < 2e-6);
}

/// A reading that is off everywhere by the same is an offset, and nothing is left about the mean.
#[test]
fn an_offset_is_told_from_scatter() {
    let offset = [1e-3, 0.0, -2e-3];
    let shifted: Vec<f64> = exact().iter().enumerate().map(|(k, x)| x + offset[k % 3]).collect();
    let mut flags = flags("tendon.a.home");
    flags.holdout = Some("unseen.csv".to_owned());
    let problem = problem(TRUTH, &shifted, &flags).expect("is valid");
    let [before, _] = fit(&problem).holdout.expect("was asked for");
    assert!((before.rms - 5_f64.sqrt() * 1e-3).abs() < 1e-8, "{before:?}");
    assert!(before.rms_without_offset < 1e-7, "{before:?}");
    assert!((before.offset[0] + 1e-3).abs() < 1e-8 && (before.offset[2] - 2e-3).abs() < 1e-8, "{before:?}");
}

#[test]
fn refusals() {
    let refused = |bench: String, free: &str| {
        let robot = ROBOT.replace("HOME_A", "0 mm").replace("HOME_B", "0 mm");
        let data = table(&exact());
        let mut load = |path: &str| Ok(if path.ends_with(".csv") { data.clone() } else { robot.clone() });
        let parsed = parse_calibration(&bench, "bench.toml", &mut load, &flags(free));
        parsed
            .and_then(|parsed| calibrate(&parsed.value, &Settings::default()))
            .expect_err("is wrong")
            .to_string()
    };
    let bench = BENCH.replace("BACKLASH", "0.1 mm");
    let message = refused(bench.replacen("tendon = \"b\"", "tendon = \"a\"", 1), "tendon.a.home");
    assert!(message.contains("tendon \"a\" is varied twice"), "{message}");
    let message = refused(bench.replacen("tendon = \"a\"", "tendon = \"c\"", 1), "tendon.a.home");
    assert!(message.contains("there is no tendon \"c\""), "{message}");
    let message = refused(bench.replacen("unit = \"mm\"\nbacklash", "backlash", 1), "tendon.a.home");
    assert!(message.contains("the column \"drive a\" has no unit"), "{message}");
    let message = refused(bench.replacen("unit = \"mm\"", "unit = \"g\"", 1), "tendon.a.home");
    assert!(message.contains("\"g\""), "{message}");
    let message = refused(bench.replace("0.1 mm\"\n[[vary]]", "-1 mm\"\n[[vary]]"), "tendon.a.home");
    assert!(message.contains("-1 mm"), "{message}");
    let message = refused(bench, "tendon.a.friction,tendon.a.friction");
    assert!(message.contains("free the same quantity"), "{message}");
}
