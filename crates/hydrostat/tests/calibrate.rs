//! Calibration against the thesis's bench and against benches whose truth is known.

mod rods;

use hydrostat::Error;
use hydrostat::calibrate::{Calibration, Loss, Prior, Problem, calibrate, sensitivities};
use hydrostat::description::{CalibrationFlags, builtin, parse_calibration};
use hydrostat::statics::Settings;
use nalgebra::Vector3;
use rods::{files, rod};

/// A short rod in two sections.
fn short_rod() -> String {
    rod("60 GPa", &[["a", "60 mm", "0.8 mm"], ["b", "40 mm", "0.6 mm"]])
}

const BENCH: &str = r#"
name = "bench"
robot = "rod.toml"
data = "data.csv"
[[vary]]
quantity = "hung_mass"
column = "mass"
at = "tip"
[[measure]]
at = "tip"
x = "x"
y = "y"
reading_error = "0.2 mm"
"#;

const MASSES: [f64; 6] = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0];

fn table(readings: &[f64]) -> String {
    let rows = MASSES.iter().zip(readings.chunks(2));
    let rows = rows.map(|(mass, read)| format!("{mass},{:.9},{:.9}\n", 1e3 * read[0], 1e3 * read[1]));
    "mass [g],x [mm],y [mm]\n".to_owned() + &rows.collect::<String>()
}

fn flags(free: &str) -> CalibrationFlags {
    CalibrationFlags { free: vec![free.to_owned()], ..CalibrationFlags::default() }
}

fn problem_of(robot: &str, bench: &str, data: &str, flags: &CalibrationFlags) -> Result<Problem, Error> {
    parse_calibration(bench, "bench.toml", &mut files(robot.to_owned(), data), flags)
        .map(|parsed| parsed.value)
}

fn problem(readings: &[f64], free: &str) -> Problem {
    problem_of(&short_rod(), BENCH, &table(readings), &flags(free)).expect("is valid")
}

/// What the rod does without any error.
fn exact() -> Vec<f64> {
    let nothing: Vec<f64> = [0.09, -0.01].repeat(MASSES.len());
    let (predicted, _) =
        sensitivities(&problem(&nothing, "youngs_modulus"), &Settings::default()).expect("solves");
    predicted.iter().copied().collect()
}

fn fit(problem: &Problem) -> Calibration {
    calibrate(problem, &Settings::default()).expect("fits")
}

/// Normal numbers from a linear congruence (Knuth's MMIX) by the sum of twelve: enough for 95 % intervals.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

fn gray(free: &str) -> Calibration {
    fit(&builtin::calibration(&flags(free)).expect("is valid").value)
}

/// mechanics.md, section 6, which rounds so: fits of the observed column with 6.80 g/cm^3.
#[test]
fn the_thesis_bench() {
    let found = gray(builtin::FREED[0]);
    let e = &found.parameters[0];
    assert!((54.3e9..54.65e9).contains(&e.value), "{}", e.value);
    assert!((e.standard_error.expect("is determined") - 0.24e9).abs() < 0.02e9, "{e:?}");
    assert!((found.after.mean - 2.27e-3).abs() < 0.01e-3, "{:?}", found.after);
    let found = gray(builtin::FREED[1]);
    assert!((found.parameters[0].value - 54.96e9).abs() < 0.02e9, "{:?}", found.parameters);
    assert!((found.parameters[1].value - 391.4e-3).abs() < 0.06e-3, "{:?}", found.parameters);
    assert!((found.after.mean - 1.9e-3).abs() < 0.05e-3, "{:?}", found.after);
    assert!((1e-3..2e-3).contains(&found.unexplained) && found.systematic == Some(true), "{found:?}");
    let words = found.verdict.join(" ");
    assert!(words.contains("stay unexplained; since the residuals are systematic"), "{words}");
}

/// Every kind of parameter, against differences of solves, on a rod and on a tendon robot that is not planar.
#[test]
fn sensitivities_are_differences_of_solves() {
    const CLOSE: f64 = 2e-5;
    let bench = BENCH.replace("y = \"y\"", "y = \"y\"\nz = \"z\"")
        + "[[measure]]\nat = \"45 mm\"\nx = \"x\"\nz = \"z\"\nreading_error = \"1 mm\"\n";
    let data = "mass [g],x [mm],y [mm],z [mm]\n5,1,1,1\n15,1,1,1\n";
    let scr = include_str!("../../../robots/scr.toml")
        .replace("[[tendon]]", "[[tendon]]\nstiffness = \"3 kN\"\nfriction = 0.1");
    let scr = scr.replace("[actuation]", "[actuation]\n# pulled");
    let of_rod = "youngs_modulus,shear_modulus,density,section.a.length,section.2.length,section.a.profile.diameter,section.b.rest_curvature.x,\
                  section.a.rest_curvature.y,section.*.rest_curvature.z,base.position.y,base.rotation.z,mount_angle,mass_offset,\
                  measure.1.marker_offset.x,measure.2.marker_offset.z";
    let of_scr = "youngs_modulus,length,diameter,tendon.1.radius,tendon.b.hole_angle,tendon.*.stiffness,tendon.*.friction,base.rotation.x,mass_offset,measure.2.marker_offset.x";
    for (robot, free) in [(short_rod().as_str(), of_rod.to_owned()), (scr.as_str(), of_scr.to_owned())] {
        let first = free;
        let problem =
            problem_of(robot, &bench, data, &flags(&first)).unwrap_or_else(|error| panic!("{error}"));
        let (_, jacobian) = sensitivities(&problem, &Settings::default()).expect("solves");
        let values = hydrostat::calibrate::start(&problem).expect("has values");
        for (j, parameter) in problem.parameters.iter().enumerate() {
            let change = 2e-4 * if values[j] == 0.0 { 0.05 } else { values[j].abs() };
            let side = |change: f64| {
                let moved =
                    hydrostat::calibrate::predict(&problem, j, values[j] + change, &Settings::default());
                moved.unwrap_or_else(|error| panic!("{}: {error}", parameter.name))
            };
            let expected = (side(change) - side(-change)) / (2.0 * change);
            let largest = expected.amax();
            let off = (jacobian.column(j) - &expected).amax();
            assert!(off <= CLOSE * largest + 1e-9 / change, "{}: {off:e} of {largest:e}", parameter.name);
        }
    }
}

/// How often the 95 % interval holds the truth, in percent.
fn coverage(error: f64, seed: u64) -> Vec<f64> {
    const BENCHES: usize = 1000;
    let truth = [60e9, 0.04];
    let exact = exact();
    let mut noise = Noise(seed);
    let mut hits = vec![0; truth.len()];
    for _ in 0..BENCHES {
        let readings: Vec<f64> = exact.iter().map(|x| x + error * noise.next()).collect();
        let found = fit(&problem(&readings, "youngs_modulus,section.b.length"));
        for (j, estimate) in found.parameters.iter().enumerate() {
            let [low, high] = estimate.interval_95.expect("is determined");
            hits[j] += usize::from(low <= truth[j] && truth[j] <= high);
        }
    }
    hits.iter().map(|&hits| 100.0 * hits as f64 / BENCHES as f64).collect()
}

/// With errors as stated, and with errors three times as large, which chi-square has to find out.
#[test]
fn intervals_cover_the_truth() {
    for (error, seed) in [(0.2e-3, 1), (0.6e-3, 2)] {
        for percent in coverage(error, seed) {
            assert!((93.0..=97.0).contains(&percent), "{percent} % with errors of {error} m");
        }
    }
}

#[test]
fn exact_data_give_the_truth_back() {
    let mut start = problem(&exact(), "youngs_modulus,section.b.length");
    for section in &mut start.experiment.robot.sections {
        section.material.youngs_modulus *= 1.4;
        section.material.shear_modulus *= 1.4;
    }
    let found = fit(&start);
    assert!((found.parameters[0].value / 60e9 - 1.0).abs() < 1e-6, "{:?}", found.parameters);
    assert!((found.parameters[1].value / 0.04 - 1.0).abs() < 1e-6, "{:?}", found.parameters);
    assert_eq!(found.warnings, Vec::<String>::new());
}

fn noisy() -> Vec<f64> {
    let mut noise = Noise(7);
    exact().iter().map(|x| x + 0.2e-3 * noise.next()).collect()
}

#[test]
fn an_outlier_is_named_and_huber_withstands_it() {
    let mut readings = noisy();
    readings[7] -= 0.01;
    let squares = fit(&problem(&readings, "youngs_modulus"));
    assert!(
        squares.warnings.iter().any(|w| w.starts_with("row 4 (mass 20 g): y") && w.contains("outlier")),
        "{:?}",
        squares.warnings
    );
    let mut robust = problem(&readings, "youngs_modulus");
    robust.loss = Loss::Huber;
    let robust = fit(&robust);
    let off = |found: &Calibration| (found.parameters[0].value - 60e9).abs();
    assert!(off(&robust) < 0.35 * off(&squares), "{} {}", off(&robust), off(&squares));
}

/// Rows 4 and 5 are disturbed, and inputs have more digits than anyone wants to read.
#[test]
fn neighbouring_outliers_are_one_sentence() {
    let masses: Vec<f64> = (0..40).map(|i| 5.0 + f64::from(i) / 3.0).collect();
    let mut bench = problem(&exact(), "youngs_modulus");
    let still = bench.experiment.rows[0].clone();
    bench.experiment.rows = masses
        .iter()
        .map(|mass| hydrostat::verify::Row { inputs: vec![1e-3 * mass], ..still.clone() })
        .collect();
    let (predicted, _) = sensitivities(&bench, &Settings::default()).expect("solves");
    let mut noise = Noise(3);
    for (i, row) in bench.experiment.rows.iter_mut().enumerate() {
        let mut read = |k: usize| predicted[2 * i + k] + 0.2e-3 * noise.next();
        row.observed[0] = Vector3::new(read(0), read(1), 0.0);
    }
    for row in [3, 4] {
        bench.experiment.rows[row].observed[0].y -= 3e-3;
    }
    let found = fit(&bench);
    let told: Vec<&String> = found.warnings.iter().filter(|warning| warning.contains("outlier")).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].starts_with("rows 4 to 5: 2 coordinates look like outliers, the largest in row "),
        "{told:?}"
    );
    assert!(told[0].contains("(mass 6.333 g)") || told[0].contains("(mass 6 g)"), "{told:?}");
}

#[test]
fn collinear_parameters_are_named() {
    let found = fit(&problem(&noisy(), "youngs_modulus,section.*.profile.diameter"));
    let words = found.verdict.join(" ");
    assert!(words.contains("youngs_modulus") && words.contains("told apart"), "{words}");
    let found = fit(&problem(&noisy(), "youngs_modulus,density,mount_angle,mass_offset"));
    let words = found.verdict.join(" ");
    assert!(words.contains("cannot be told apart by these measurements: correlation"), "{words}");
}

#[test]
fn leaving_a_row_out_is_as_fitting_the_others() {
    let readings = noisy();
    let whole = fit(&problem(&readings, "youngs_modulus"));
    let mut sum = 0.0;
    for i in 0..MASSES.len() {
        let mut others = problem(&readings, "youngs_modulus");
        let row = others.experiment.rows.remove(i);
        let value = fit(&others).parameters[0].value;
        let mut one = problem(&readings, "youngs_modulus");
        one.experiment.rows = vec![row];
        let at = hydrostat::calibrate::predict(&one, 0, value, &Settings::default()).expect("solves");
        sum += (at[0] - readings[2 * i]).hypot(at[1] - readings[2 * i + 1]);
    }
    let mean = whole.left_out.expect("is determined").mean;
    // second order in the change of E
    assert!((mean / (sum / MASSES.len() as f64) - 1.0).abs() < 1e-3, "{mean} {sum}");
}

/// Refits of Gray's bench without each of its rows, with weights as they are; to first order in what a row changes.
#[test]
fn leaving_a_row_of_gray_out_is_as_fitting_the_others() {
    for (loss, close) in [(Loss::Squares, 0.02), (Loss::Huber, 0.05)] {
        let mut whole = builtin::calibration(&flags("youngs_modulus,length")).expect("is valid").value;
        whole.loss = loss;
        let rows = whole.experiment.rows.clone();
        let found = fit(&whole).left_out.expect("is determined");
        let errors = (0..rows.len()).map(|i| {
            let mut others = whole.clone();
            others.experiment.rows.remove(i);
            others.holdout = vec![rows[i].clone()];
            fit(&others).holdout.expect("is held out")[1].mean
        });
        let mean = errors.sum::<f64>() / rows.len() as f64;
        assert!((found.mean / mean - 1.0).abs() < close, "{loss:?}: {} {mean}", found.mean);
    }
}

/// Two independent sources of one value: weights are inverse variances.
#[test]
fn a_prior_counts_by_its_error() {
    let alone = fit(&problem(&noisy(), "youngs_modulus"));
    let (value, error) =
        (alone.parameters[0].value, alone.parameters[0].standard_error.expect("is determined"));
    let mut with = flags("youngs_modulus");
    with.prior = vec![format!("youngs_modulus={} Pa +- {} Pa", value + error, error)];
    let found = fit(&problem_of(&short_rod(), BENCH, &table(&noisy()), &with).expect("is valid"));
    let together = &found.parameters[0];
    assert!(((together.value - value) / error - 0.5).abs() < 0.01, "{together:?}");
    assert!(
        (together.standard_error.expect("is determined") / error * 2_f64.sqrt() - 1.0).abs() < 0.01,
        "{together:?}"
    );
}

#[test]
fn a_bound_holds_and_is_said() {
    let mut bounded = flags("youngs_modulus,section.b.length");
    bounded.bounds = vec!["youngs_modulus=61 GPa to 70 GPa".to_owned()];
    let found = fit(&problem_of(&short_rod(), BENCH, &table(&exact()), &bounded).expect("is valid"));
    assert!(
        (found.parameters[0].value / 61e9 - 1.0).abs() < 1e-12 && found.parameters[0].interval_95.is_none(),
        "{found:?}"
    );
    assert!(found.parameters[1].interval_95.is_some());
    assert!(found.warnings[0].contains("lies on its bound"), "{:?}", found.warnings);
    let outside = "lies outside its bounds: 61.000 GPa is taken in its place";
    assert!(found.warnings.iter().any(|warning| warning.contains(outside)), "{:?}", found.warnings);
    // alone on its bound it leaves nothing to be sure of
    let mut alone = flags("youngs_modulus");
    alone.bounds = bounded.bounds;
    let found = fit(&problem_of(&short_rod(), BENCH, &table(&exact()), &alone).expect("is valid"));
    assert!(found.parameters[0].standard_error.is_none(), "{found:?}");
}

#[test]
fn an_interval_ends_at_the_bounds() {
    let free = fit(&problem(&noisy(), "youngs_modulus"));
    let [low, high] = free.parameters[0].interval_95.expect("is determined");
    let mut bounded = flags("youngs_modulus");
    let bound = 0.5 * (free.parameters[0].value + high);
    bounded.bounds = vec![format!("youngs_modulus=1 GPa to {bound} Pa")];
    let found = fit(&problem_of(&short_rod(), BENCH, &table(&noisy()), &bounded).expect("is valid"));
    let estimate = &found.parameters[0];
    let cut = estimate.interval_95.expect("is determined");
    assert!((cut[0] / low - 1.0).abs() < 1e-6 && cut[1] == bound, "{cut:?} {low}");
    assert_eq!(estimate.cut, [false, true]);
    let told = "The 95 % interval of youngs_modulus is cut at its bound, ";
    assert!(found.warnings.iter().any(|warning| warning.starts_with(told)), "{:?}", found.warnings);
    assert_eq!(free.parameters[0].cut, [false, false]);
}

/// Nothing hangs at 0 g, and nothing is too heavy there.
#[test]
fn a_mass_offset_needs_a_mass() {
    let mut bench = problem(&exact(), "mass_offset");
    bench.experiment.rows[0].inputs[0] = 0.0;
    let (_, jacobian) = sensitivities(&bench, &Settings::default()).expect("solves");
    assert_eq!(jacobian.rows(0, 2).amax(), 0.0);
    assert!(jacobian.rows(2, 2).amax() > 0.0);
    let with =
        |offset| hydrostat::calibrate::predict(&bench, 0, offset, &Settings::default()).expect("solves");
    let (without, heavier) = (with(0.0), with(2e-3));
    assert!((heavier.rows(0, 2) - without.rows(0, 2)).amax() < 1e-9);
    assert!((heavier.rows(2, 2) - without.rows(2, 2)).amax() > 1e-4);
}

/// A thousand times too much or too little, in the table's masses or readings, whatever is free.
#[test]
fn a_wrong_unit_is_an_error() {
    let bench = |free: &str, mass: f64, reading: f64| {
        let mut problem = builtin::calibration(&flags(free)).expect("is valid").value;
        for row in &mut problem.experiment.rows {
            row.inputs[0] *= mass;
            row.observed[0] *= reading;
        }
        calibrate(&problem, &Settings::default())
    };
    for free in [
        "youngs_modulus",
        "youngs_modulus,length",
        "density",
        "diameter",
        "youngs_modulus,density,mount_angle",
    ] {
        assert!(bench(free, 1.0, 1.0).is_ok(), "{free}");
        for (mass, reading, words) in [
            (1e3, 1.0, "the column mass [g] divided by 1000"),
            (1e-3, 1.0, "the column mass [g] multiplied by 1000"),
            (1.0, 1e-3, "the measured coordinates multiplied by 1000"),
            (1.0, 0.1, "the measured coordinates multiplied by 10"),
        ] {
            let error = bench(free, mass, reading).expect_err(words).to_string();
            assert!(
                error.contains("probably a unit is wrong: with ") && error.contains(words),
                "{free}: {error}"
            );
            assert!(error.contains("check the unit in the header"), "{error}");
        }
    }
    // a rod that is ten times as stiff or as soft as stated is a rod
    for factor in [0.1, 10.0] {
        let found = bench("youngs_modulus", factor, 1.0);
        assert!(found.is_ok(), "{factor}: {found:?}");
    }
}

/// Who says what may come out, or has a fit that fails, is told no less.
#[test]
fn a_wrong_unit_may_be_meant() {
    let words = "a unit is wrong: with the column mass [g] divided by 1000";
    let heavy = |set: &dyn Fn(&mut CalibrationFlags)| {
        let mut flags = flags("youngs_modulus");
        set(&mut flags);
        let mut problem = builtin::calibration(&flags).expect("is valid").value;
        problem.experiment.rows.iter_mut().for_each(|row| row.inputs[0] *= 1e3);
        calibrate(&problem, &Settings::default())
    };
    let bounded = heavy(&|flags| flags.bounds = vec!["youngs_modulus=1 GPa to 1000000 GPa".to_owned()]);
    let prior = heavy(&|flags| flags.prior = vec!["youngs_modulus=50000 GPa +- 10000 GPa".to_owned()]);
    for found in [bounded, prior] {
        let found = found.expect("is meant");
        assert!(found.warnings[0].contains(&format!("Probably {words}")), "{:?}", found.warnings);
    }
    let error =
        heavy(&|flags| flags.free = vec!["density".to_owned()]).expect_err("is not meant").to_string();
    assert!(error.contains(words) && error.contains("(--bounds, --prior) of density"), "{error}");
    let error = heavy(&|_| ()).expect_err("ends on a bound").to_string();
    assert!(error.contains("1500.0 GPa, which no robot has") && error.contains(words), "{error}");
    let error =
        heavy(&|flags| flags.free = vec!["base.position.z".to_owned()]).expect_err("fails").to_string();
    assert!(
        error.starts_with("base.position.z has no influence") && error.contains("do not free it"),
        "{error}"
    );
    assert!(error.contains(&format!("probably {words}")), "{error}");
}

/// The data alone say 60 GPa, with an error of a few hundredths: a prior far off neither wins nor goes unnoticed.
#[test]
fn a_prior_does_not_excuse_itself() {
    let alone = fit(&problem(&noisy(), "youngs_modulus"));
    let (value, error) =
        (alone.parameters[0].value, alone.parameters[0].standard_error.expect("is determined"));
    let mut told = problem(&noisy(), "youngs_modulus");
    told.parameters[0].prior = Some(Prior { value: value - 30.0 * error, standard_error: 3.0 * error });
    let found = fit(&told);
    // weights of the data and the prior are 9 to 1
    let expected = value - 30.0 * error / 10.0;
    assert!((found.parameters[0].value - expected).abs() < 0.1 * error, "{:?} {expected}", found.parameters);
    assert!(
        found.warnings.iter().any(|warning| warning.contains("standard errors from its prior")),
        "{found:?}"
    );
    assert_eq!(found.error_scale, alone.error_scale);
    assert!(found.verdict[0].contains("contradict the data"), "{:?}", found.verdict);
    assert!(found.steps > 0);
}

#[test]
fn swapped_columns_are_an_error() {
    let mut swapped = problem(&exact(), "section.a.length+section.b.length");
    for row in &mut swapped.experiment.rows {
        row.observed[0] = Vector3::new(row.observed[0].y, row.observed[0].x, 0.0);
    }
    let error = calibrate(&swapped, &Settings::default()).expect_err("is no length").to_string();
    assert!(error.contains("which no robot has") && error.contains("swapped columns"), "{error}");
}

#[test]
fn bounds_and_slips_are_named_as_causes() {
    let mut bounded = flags("youngs_modulus");
    bounded.bounds = vec!["youngs_modulus=70 GPa to 80 GPa".to_owned()];
    let words = fit(&problem_of(&short_rod(), BENCH, &table(&noisy()), &bounded).expect("is valid"))
        .verdict
        .join(" ");
    assert!(words.contains("the bounds of youngs_modulus keep the fit from a better one"), "{words}");
    for loss in [Loss::Squares, Loss::Huber] {
        let mut slip = noisy();
        slip[4] += 5e-3;
        let mut slip = problem(&slip, "youngs_modulus");
        slip.loss = loss;
        let found = fit(&slip);
        let words = [found.verdict, found.warnings].concat().join(" ");
        assert!(words.contains("looks like an outlier") && !words.contains(" inf "), "{words}");
        assert!(!words.contains("readings are less exact than stated"), "{words}");
    }
}

/// A fit keeps to what solids have unless it is told; what only asks for derivatives takes the file's value.
#[test]
fn a_start_that_no_solid_has_is_an_error() {
    let stiff = short_rod().replace("60 GPa", "5000 GPa");
    let bench = |flags| problem_of(&stiff, BENCH, &table(&exact()), &flags).expect("is valid");
    let told = bench(flags("youngs_modulus"));
    let error = calibrate(&told, &Settings::default()).expect_err("no solid").to_string();
    for words in ["the files have youngs_modulus = 5000.0 GPa", "to 1500.0 GPa", "--bounds \"youngs_modulus="]
    {
        assert!(error.contains(words), "expected {words:?} in {error}");
    }
    assert_eq!(hydrostat::calibrate::start(&told).expect("has values"), [5000e9]);
    let bounded = CalibrationFlags {
        bounds: vec!["youngs_modulus=500.00 GPa to 50000 GPa".to_owned()],
        ..flags("youngs_modulus")
    };
    let found = calibrate(&bench(bounded), &Settings::default()).expect("fits");
    assert_eq!((found.parameters[0].before, found.parameters[0].value), (5000e9, 500e9));
}

/// One sentence for both tests.
#[test]
fn signs_and_sizes_are_told_together() {
    for found in
        [gray("youngs_modulus"), gray("youngs_modulus,length"), fit(&problem(&noisy(), "youngs_modulus"))]
    {
        let told = found.verdict.iter().filter(|sentence| sentence.contains("systematic with mass"));
        assert_eq!(told.count(), 1, "{:?}", found.verdict);
        assert!(
            found.verdict[1].contains("runs of sign") && found.verdict[1].contains("of all orders"),
            "{:?}",
            found.verdict
        );
    }
}

/// From a stated value twenty times too large, steps that were a part of it would leave what is possible.
#[test]
fn a_far_start_leads_to_the_truth() {
    let stiff = short_rod().replace("60 GPa", "1200 GPa");
    let found =
        fit(&problem_of(&stiff, BENCH, &table(&exact()), &flags("youngs_modulus")).expect("is valid"));
    assert!((found.parameters[0].value / 60e9 - 1.0).abs() < 1e-6, "{:?}", found.parameters);
    assert!(
        found.warnings.iter().any(|warning| warning.contains("is 0.05 times the stated")),
        "{:?}",
        found.warnings
    );
}

#[test]
fn doubtful_data_and_values_are_said() {
    let warned = |readings: &[f64], free: &str, words: &str| {
        let found = fit(&problem(readings, free));
        assert!(
            found.warnings.iter().any(|warning| warning.contains(words)),
            "{words}: {:?}",
            found.warnings
        );
    };
    let mut constant = exact();
    constant.iter_mut().skip(1).step_by(2).for_each(|y| *y = -0.03);
    warned(&constant, "youngs_modulus", "reads the same in every row");
    let mut same = problem(&noisy(), "youngs_modulus");
    same.experiment.rows.iter_mut().for_each(|row| row.inputs[0] = 15e-3);
    let found = fit(&same);
    assert!(
        found.warnings.iter().any(|warning| warning.starts_with("All rows have the same inputs (mass 15 g)")),
        "{:?}",
        found.warnings
    );
    let mut twice = problem(&noisy(), "youngs_modulus");
    twice.experiment.rows[3] = twice.experiment.rows[2].clone();
    assert!(fit(&twice).warnings.iter().any(|warning| warning.contains("row 4 repeats row 3")));
    // a rod that is light for its readings
    let heavy = short_rod().replace("6.5 g/cm^3", "65 g/cm^3");
    let found = fit(&problem_of(&heavy, BENCH, &table(&exact()), &flags("density")).expect("is valid"));
    assert!(found.warnings.iter().any(|warning| warning.contains("implausible")), "{:?}", found.warnings);
}

#[test]
fn refusals() {
    let readings = exact();
    let refused = |free: &str, words: &[&str]| {
        let error = problem_of(&short_rod(), BENCH, &table(&readings), &flags(free))
            .and_then(|problem| calibrate(&problem, &Settings::default()).map(|_| ()))
            .expect_err(free)
            .to_string();
        for word in words {
            assert!(error.contains(word), "expected {word:?} in {error}");
        }
    };
    refused(
        "shear_modulus",
        &["shear_modulus has no influence on what was measured", "hint: do not free it"],
    );
    refused("youngs_modulos", &["there is no parameter", "did you mean \"youngs_modulus\"?"]);
    refused("poisson_ratio", &["there is no parameter \"poisson_ratio\"", "name shear_modulus"]);
    refused("length", &["is the name of 2 parameters", "section.a.length+section.b.length"]);
    refused("density+youngs_modulus", &["ties material.wire.density to material.wire.youngs_modulus"]);
    refused("density,material.wire.density", &["free the same quantity"]);
    let mut few = problem(&readings, "youngs_modulus,density,section.a.length");
    few.experiment.rows.truncate(1);
    let error = calibrate(&few, &Settings::default()).expect_err("too few").to_string();
    assert!(error.contains("3 free parameters, but only 2 measured coordinates"), "{error}");
    // one row that no rod can follow
    let mut wild = problem(&readings, "youngs_modulus");
    wild.experiment.rows[4].inputs[0] = f64::NAN;
    let error = calibrate(&wild, &Settings::default()).expect_err("row").to_string();
    assert!(error.contains("row 5"), "{error}");
}
