//! Budgets of tolerances against closed forms, differences of `verify`, and benches drawn at random.

mod rods;

use hydrostat::Error;
use hydrostat::budget::{Budget, Contribution, budget};
use hydrostat::description::{builtin, parse_budget, parse_experiment};
use hydrostat::statics::Settings;
use hydrostat::verify::{Experiment, verify};
use rods::{files, rod};

/// As long as that of the thesis.
fn long_rod() -> String {
    rod("54 GPa", &[["rod", "390 mm", "1.56 mm"]])
}

const BENCH: &str = r#"
name = "bench"
robot = "rod.toml"
data = "data.csv"
set = { "material.wire.density" = "6.5 g/cm^3" }
[bench]
x = [1, 0, 0]
y = [0, 1, 0]
mount_angle = "0 deg"
[[vary]]
quantity = "hung_mass"
column = "mass"
at = "tip"
[[measure]]
at = "tip"
x = "x"
y = "y"
reading_error = "0.5 mm"
[[measure]]
at = "200 mm"
y = "half"
reading_error = "0.5 mm"
"#;

const DATA: &str = "mass [g],x [mm],y [mm],half [mm]\n0,380,-50,-20\n20,320,-200,-80\n40,270,-260,-120\n";

/// Straight, without weight, loaded by little.
const SMALL: &str = r#"
name = "small load"
robot = "rod.toml"
data = "data.csv"
set = { "material.wire.density" = "0 g/cm^3" }
[[vary]]
quantity = "force"
direction = [0, -1, 0]
column = "force"
at = "tip"
[[measure]]
at = "tip"
y = "y"
reading_error = "0.1 mm"
"#;

fn load(data: &str) -> impl FnMut(&str) -> Result<String, Error> {
    files(long_rod(), data)
}

fn computed(bench: &str, data: &str, tolerances: &[&str], samples: usize) -> Result<Budget, Error> {
    let flags: Vec<String> = tolerances.iter().map(|text| (*text).to_owned()).collect();
    let (experiment, tolerances) = parse_budget(bench, "bench.toml", &mut load(data), &flags)?.value;
    budget(&experiment, &tolerances, samples, 1, &Settings::default())
}

fn experiment(bench: &str, data: &str) -> Experiment {
    parse_experiment(bench, "bench.toml", &mut load(data)).expect("is valid").value
}

fn part<'b>(budget: &'b Budget, name: &str) -> &'b Contribution {
    let found = budget.contributions.iter().find(|part| part.name() == name);
    found.unwrap_or_else(|| panic!("{name} is in the budget"))
}

/// w = F L^3 / 3 E I: relative errors of 1 dE/E, 3 dL/L, 4 dd/d; a tilt by a small angle moves the tip by L times it.
#[test]
fn a_slightly_bent_rod_in_closed_form() {
    /// Slopes (w/L)^2 and shear, (d/L)^2, are below 2e-5; stratified samples leave 1 % of their size.
    const CLOSE: f64 = 1e-4;
    const SAMPLED: f64 = 0.01;
    let (force, length, diameter) = (1e-3, 0.39_f64, 1.56e-3_f64);
    let stiffness = 54e9 * std::f64::consts::PI * diameter.powi(4) / 64.0;
    let w = force * length.powi(3) / (3.0 * stiffness);
    let data = "force [mN],y [mm]\n1,-1.2\n";
    let tolerances = [
        "youngs_modulus=2 %",
        "length=0.5 mm",
        "diameter=0.01 mm",
        "mount_angle=0.1 deg",
        "grid_tilt.z=0.2 deg",
    ];
    let found = computed(SMALL, data, &tolerances, 400).expect("solves");
    let angle = 0.1_f64.to_radians();
    let expected = [
        ("youngs_modulus", 0.02 * w),
        ("length", 3.0 * 0.5e-3 / length * w),
        ("diameter", 4.0 * 0.01e-3 / diameter * w),
        ("mount_angle", angle * length),
        ("grid_tilt.z", 2.0 * angle * length),
        ("reading_error", 0.1e-3),
    ];
    for (name, expected) in expected {
        let part = &part(&found, name).displacement;
        let (first_order, sampled) = (part.first_order[0][0], part.monte_carlo[0][0]);
        assert!((first_order / expected - 1.0).abs() < CLOSE, "{name}: {first_order:e} {expected:e}");
        assert!((sampled / expected - 1.0).abs() < SAMPLED, "{name}: {sampled:e} {expected:e}");
    }
    let total = expected.iter().map(|(_, part)| part * part).sum::<f64>().sqrt();
    assert!((found.total.rms_first_order / total - 1.0).abs() < CLOSE, "{:?}", found.total);
    let off = (found.total.rms_monte_carlo - total).abs();
    assert!(off < 4.0 * found.total.sampling_error, "{off:e} of {:?}", found.total);
    let order: Vec<&str> = found.contributions.iter().map(Contribution::name).collect();
    assert_eq!(order[..2], ["grid_tilt.z", "mount_angle"]);
    let shares: f64 = found.contributions.iter().map(|part| part.share).sum();
    assert!((shares - 1.0).abs() < 1e-12, "{shares}");
}

/// The same bench with one file changed on both sides, through `verify`.
#[test]
fn first_order_is_a_difference_of_verify() {
    /// Second differences of the changes taken.
    const CLOSE: f64 = 1e-5;
    let names =
        ["youngs_modulus", "density", "length", "diameter", "mount_angle", "grid_tilt.z", "mass_offset"];
    let tolerances = [
        "youngs_modulus=1 GPa",
        "density=0.1 g/cm^3",
        "length=1 mm",
        "diameter=0.01 mm",
        "mount_angle=1 deg",
        "grid_tilt.z=1 deg",
        "mass_offset=0.1 g",
    ];
    let found = computed(BENCH, DATA, &tolerances, 20).expect("solves");
    // a hundredth of the deviation to each side
    let changed = |name: &str, side: f64| -> (String, String) {
        let h = 0.01 * side;
        let set = |key: &str, value: String| {
            BENCH.replace("\"material.wire.density\" = \"6.5 g/cm^3\"", &format!("\"{key}\" = \"{value}\""))
        };
        let bench = match name {
            "youngs_modulus" => set("material.wire.youngs_modulus", format!("{} GPa", 54.0 + h)),
            "density" => set("material.wire.density", format!("{} g/cm^3", 6.5 + 0.1 * h)),
            "length" => set("section.rod.length", format!("{} mm", 390.0 + h)),
            "diameter" => set("section.rod.profile.diameter", format!("{} mm", 1.56 + 0.01 * h)),
            "mount_angle" => BENCH.replace("\"0 deg\"", &format!("\"{h} deg\"")),
            "grid_tilt.z" => {
                let (sin, cos) = h.to_radians().sin_cos();
                BENCH
                    .replace("[1, 0, 0]", &format!("[{cos}, {sin}, 0]"))
                    .replace("[0, 1, 0]", &format!("[{}, {cos}, 0]", -sin))
            }
            _ => BENCH.to_owned(),
        };
        let data = match name {
            "mass_offset" => {
                let row = |line: &str| {
                    let (mass, rest) = line.split_once(',').expect("has cells");
                    format!(
                        "{},{rest}",
                        mass.parse::<f64>()
                            .map_or(mass.to_owned(), |mass| (mass + 1.0 + 0.1 * h).to_string())
                    )
                };
                DATA.lines().map(row).collect::<Vec<_>>().join("\n")
            }
            _ => DATA.to_owned(),
        };
        (bench, data)
    };
    // a negative mass cannot be in a table: all of them are a gram more for that one
    let shifted = DATA.replace("\n0,", "\n1,").replace("\n20,", "\n21,").replace("\n40,", "\n41,");
    let heavier = computed(BENCH, &shifted, &["mass_offset=0.1 g"], 20).expect("solves");
    for name in names {
        let sides = [-1.0, 1.0].map(|side| {
            let (bench, data) = changed(name, side);
            verify(&experiment(&bench, &data), &Settings::default()).expect("solves")
        });
        let found = if name == "mass_offset" { &heavier } else { &found };
        let part = &part(found, name).displacement;
        for row in 0..3 {
            for point in 0..2 {
                let difference =
                    sides[1].rows[row].points[point].predicted - sides[0].rows[row].points[point].predicted;
                let (expected, first_order) = (difference.norm() / 0.02, part.first_order[row][point]);
                assert!(
                    (first_order - expected).abs() < CLOSE * expected + 1e-8,
                    "{name}, row {row}, point {point}: {first_order:e} {expected:e}"
                );
            }
        }
    }
}

/// Where tolerances are small, samples tell what first order tells.
#[test]
fn monte_carlo_converges_to_first_order() {
    let tolerances = [
        "youngs_modulus=0.1 %",
        "density=0.1 %",
        "length=0.02 mm",
        "diameter=0.001 mm",
        "mount_angle=0.02 deg",
        "mass_offset=0.01 g",
    ];
    let found = computed(BENCH, DATA, &tolerances, 400).expect("solves");
    for part in &found.contributions {
        let (first_order, sampled) = (part.displacement.rms_first_order, part.displacement.rms_monte_carlo);
        // what strata leave of the spread of 400 samples
        assert!((sampled / first_order - 1.0).abs() < 0.01, "{}: {sampled:e} {first_order:e}", part.name());
    }
    let total = &found.total;
    assert!((total.rms_monte_carlo - total.rms_first_order).abs() < 4.0 * total.sampling_error, "{total:?}");
    assert!(total.sampling_error < 0.05 * total.rms_monte_carlo, "{total:?}");
    assert!(found.verdict[1].starts_with("First order and Monte Carlo agree"), "{:?}", found.verdict);
}

/// E[(1 - cos a)^2 + sin^2 a] = 2 (1 - exp(-sigma^2/2)) for a grid that is tilted by a normal angle.
#[test]
fn a_curved_answer_is_said() {
    let found = computed(BENCH, DATA, &["grid_tilt.z=60 deg"], 2000).expect("solves");
    let part = &part(&found, "grid_tilt.z").displacement;
    let sigma = 60_f64.to_radians();
    let bench = experiment(BENCH, DATA);
    let tip = verify(&bench, &Settings::default()).expect("solves").rows[1].points[0].predicted.norm();
    let expected = tip * (2.0 * (1.0 - (-0.5 * sigma * sigma).exp())).sqrt();
    assert!((part.first_order[1][0] / (sigma * tip) - 1.0).abs() < 1e-6, "{part:?}");
    assert!((part.monte_carlo[1][0] / expected - 1.0).abs() < 2e-3, "{part:?} {expected}");
    assert!(found.verdict[1].contains("Monte Carlo is to be taken, for grid_tilt.z"), "{:?}", found.verdict);
}

#[test]
fn threads_change_nothing() {
    let tolerances = ["youngs_modulus=2 %", "length=0.5 mm"];
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
        pool.install(|| computed(BENCH, DATA, &tolerances, 50)).expect("solves")
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.total.monte_carlo, three.total.monte_carlo);
    assert_eq!(one.total.first_order, three.total.first_order);
    assert_eq!(one.chance_of_mean.to_bits(), three.chance_of_mean.to_bits());
}

/// Benches whose readings are drawn from the tolerances are refuted at 5 % in 5 % of all cases, theory (62).
#[test]
fn what_tolerances_explain_is_not_refuted() {
    const BENCHES: usize = 200;
    let masses = [5.0, 10.0, 20.0, 30.0];
    let exact = |turn: f64, stiffer: f64| {
        let set = format!("\"material.wire.youngs_modulus\" = \"{} GPa\"", 54.0 * stiffer);
        let bench = BENCH
            .replace("\"material.wire.density\" = \"6.5 g/cm^3\"", &set)
            .replace("\"0 deg\"", &format!("\"{turn} deg\""));
        let data = "mass [g],x [mm],y [mm],half [mm]\n".to_owned()
            + &masses.map(|mass| format!("{mass},300,-100,-50\n")).concat();
        let verified = verify(&experiment(&bench, &data), &Settings::default()).expect("solves");
        let rows = verified.rows.into_iter();
        rows.flat_map(|row| [row.points[0].predicted.x, row.points[0].predicted.y, row.points[1].predicted.y])
            .collect::<Vec<f64>>()
    };
    let mut state = 3_u64;
    let mut normal = || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    let (mut by_shape, mut by_mean) = (0, 0);
    for _ in 0..BENCHES {
        let readings = exact(0.3 * normal(), 1.0 + 0.01 * normal());
        let read: Vec<f64> = readings.iter().map(|x| 1e3 * x + 0.5 * normal()).collect();
        let rows = masses.iter().zip(read.chunks(3));
        let rows = rows.map(|(mass, read)| format!("{mass},{},{},{}\n", read[0], read[1], read[2]));
        let data = "mass [g],x [mm],y [mm],half [mm]\n".to_owned() + &rows.collect::<String>();
        let found =
            computed(BENCH, &data, &["mount_angle=0.3 deg", "youngs_modulus=1 %"], 60).expect("solves");
        by_shape += usize::from(found.chance_of_shape < 0.05);
        by_mean += usize::from(found.chance_of_mean < 0.05);
    }
    // 10 are expected, with a standard deviation of 3.1
    for count in [by_shape, by_mean] {
        assert!((2..=20).contains(&count), "{by_shape} by shape, {by_mean} by mean");
    }
}

/// In size the tolerances explain the thesis's errors, but not how those change with the mass.
#[test]
fn the_thesis_bench() {
    let (experiment, tolerances) = builtin::budget(&[]).expect("is valid").value;
    let found = budget(&experiment, &tolerances, 60, 1, &Settings::default()).expect("solves");
    let verified = verify(&experiment, &Settings::default()).expect("solves");
    // tolerances of the solutions
    assert!((found.verified.mean - verified.model.mean).abs() < 1e-8, "{:?}", found.verified);
    assert!(found.chance_of_mean > 0.2 && found.chance_of_shape < 1e-4, "{found:?}");
    for name in [
        "youngs_modulus",
        "density",
        "diameter",
        "length",
        "mount_angle",
        "mass_offset",
        "grid_tilt.z",
        "base.rotation.y",
    ] {
        part(&found, name);
    }
    assert!(
        found
            .contributions
            .is_sorted_by(|a, b| a.displacement.rms_monte_carlo >= b.displacement.rms_monte_carlo)
    );
}

#[test]
fn refusals() {
    let refused = |bench: &str, tolerances: &[&str], samples: usize, words: &[&str]| {
        let error =
            computed(bench, DATA, tolerances, samples).expect_err(&format!("{tolerances:?}")).to_string();
        for word in words {
            assert!(error.contains(word), "expected {word:?} in {error}");
        }
    };
    refused(
        BENCH,
        &["lenght=1 mm"],
        20,
        &["--tolerance: there is no parameter \"lenght\"", "did you mean \"length\"?"],
    );
    refused(BENCH, &["length"], 20, &["found --tolerance \"length\", expected NAME=VALUE"]);
    refused(BENCH, &["length=1 g"], 20, &["found a mass, expected a length"]);
    refused(BENCH, &["length=-1 mm"], 20, &["found \"-1 mm\", expected a standard deviation above 0"]);
    refused(BENCH, &["mount_angle=2 %"], 20, &["found \"2 %\", but the value is 0", "hint: give an angle"]);
    refused(BENCH, &["reading_error=1 mm"], 20, &["reading_error under [[measure]]"]);
    refused(BENCH, &["grid_tilt=1 deg"], 20, &["the name of 3 tolerances", "grid_tilt.z"]);
    refused(
        BENCH,
        &["youngs_modulus=30 %"],
        20,
        &["youngs_modulus", "= 54 GPa", "a quarter of the value at most"],
    );
    refused(BENCH, &["length=1 mm"], 5, &["found 5 samples, expected 20 to 1000000"]);
    let in_file = format!("{BENCH}[budget]\ntolerance = {{ lenght = \"1 mm\" }}\n");
    refused(
        &in_file,
        &[],
        20,
        &["bench.toml:24:24, key budget.tolerance.lenght", "did you mean \"length\"?"],
    );
    let twice =
        format!("{BENCH}[budget]\ntolerance = {{ length = \"1 mm\", \"section.rod.length\" = \"2 mm\" }}\n");
    refused(&twice, &[], 20, &["\"length\" and \"section.rod.length\" are tolerances of the same quantity"]);
    let unknown = format!("{BENCH}[budget]\ntolerances = {{ length = \"1 mm\" }}\n");
    refused(&unknown, &[], 20, &["unknown key \"tolerances\"", "did you mean \"tolerance\"?"]);
}

/// Flags replace the tolerance of the same quantity, and stand beside the others of the file.
#[test]
fn flags_come_in_place_of_the_file() {
    let bench = format!("{BENCH}[budget]\ntolerance = {{ length = \"1 mm\", density = \"2 %\" }}\n");
    let found = computed(&bench, DATA, &["length=2 mm"], 20).expect("solves");
    let deviation = |name| part(&found, name).tolerance.as_ref().expect("is a tolerance").deviation;
    assert_eq!(found.contributions.len(), 3);
    assert!((deviation("length") - 2e-3).abs() < 1e-15 && (deviation("density") - 130.0).abs() < 1e-9);
}
