//! `hydrostat calibrate`.

use crate::{Folder, json, keys, refusals::bench};
use std::fs;

#[test]
fn the_built_in_bench_is_calibrated_twice() {
    let text = Folder::new("calibrate_gray").run("calibrate").succeeds();
    for words in [
        "54.61 GPa",
        "54.96 GPa",
        "391.35 mm",
        "2.27",
        "1.91",
        "stay unexplained",
        "are systematic",
        "1 to 2 mm",
    ] {
        assert!(text.contains(words), "expected {words:?} in:\n{text}");
    }
}

#[test]
fn json_has_the_keys_of_the_format() {
    let folder = Folder::new("calibrate_json");
    let value = json(&folder.run("calibrate --free youngs_modulus,length --json").succeeds());
    for key in [
        "parameters",
        "correlation",
        "mean_error_m",
        "rms_error_m",
        "max_error_m",
        "before",
        "chi_square",
        "degrees_of_freedom",
        "holdout",
        "warnings",
    ] {
        assert!(keys(&value).contains(&key), "{key} in {:?}", keys(&value));
    }
    let first = &value["parameters"][0];
    assert_eq!(
        keys(first)[..6],
        ["name", "value", "unit", "standard_error", "interval_95", "interval_95_cut"]
    );
    assert_eq!((first["name"].as_str(), first["unit"].as_str()), (Some("youngs_modulus"), Some("Pa")));
    assert_eq!(value["correlation"][1][1], 1.0);
    for key in ["mean_error_m", "rms_error_m", "max_error_m"] {
        assert!(value["before"][key].as_f64() > value[key].as_f64(), "{key}");
    }
    assert_eq!(value["degrees_of_freedom"], 20);
    let both = json(&folder.run("calibrate --json").succeeds());
    assert_eq!(both["further"][0]["parameters"][1]["name"], "length");
}

#[test]
fn an_interval_that_its_bound_cuts_says_so() {
    let folder = Folder::new("calibrate_cut");
    let bench = hydrostat::description::builtin::EXPERIMENT
        .replace("../../robots/gray2009_rod.toml", "rod.toml")
        + "\n[calibrate]\nfree = [\"youngs_modulus\"]\nbounds = { youngs_modulus = \"50 GPa to 54.8 GPa\" }\n";
    fs::write(folder.path("rod.toml"), hydrostat::description::builtin::ROBOT).unwrap();
    fs::write(folder.path("table2.csv"), hydrostat::description::builtin::TABLE).unwrap();
    fs::write(folder.path("bench.toml"), bench).unwrap();
    let text = folder.run("calibrate bench.toml").succeeds();
    assert!(text.contains("54.12 GPa to 54.80 GPa, cut at its bound"), "{text}");
    assert!(text.contains("The 95 % interval of youngs_modulus is cut at its bound, 54.80 GPa"), "{text}");
}

/// The written robot is the calibrated one: `verify` finds its error, and the comments are there.
#[test]
fn the_written_robot_is_the_calibrated_one() {
    let folder = bench("calibrate_write");
    let rod = fs::read_to_string(folder.path("try_rod.toml")).unwrap();
    let fitted = "calibrate try.toml --free youngs_modulus,section.rod.length --write fitted.toml --json";
    let value = json(&folder.run(fitted).succeeds());
    let written = fs::read_to_string(folder.path("fitted.toml")).unwrap();
    for comment in rod.lines().filter_map(|line| line.split_once('#')).map(|(_, comment)| comment) {
        assert!(written.contains(comment), "{comment} in\n{written}");
    }
    assert!(written.starts_with("# Calibrated by hydrostat"), "{written}");
    let experiment =
        fs::read_to_string(folder.path("try.toml")).unwrap().replace("try_rod.toml", "fitted.toml");
    fs::write(folder.path("again.toml"), experiment).unwrap();
    let again = json(&folder.run("verify again.toml --json").succeeds());
    let difference = again["mean_error_m"].as_f64().unwrap() - value["mean_error_m"].as_f64().unwrap();
    assert!(difference.abs() < 1e-6, "{difference}");
    folder.run(fitted).refuses(&["fitted.toml exists already", "--force"]);
    let forced = folder.run(&format!("{fitted} --force"));
    assert_eq!(forced.code, 0, "{forced:?}");
}

#[test]
fn refusals() {
    let folder = bench("calibrate_refusals");
    folder.run("calibrate try.toml").refuses(&["nothing is free", "--free youngs_modulus"]);
    folder.run("calibrate try.toml --free youngs_modulos").refuses(&["did you mean \"youngs_modulus\"?"]);
    folder.run("calibrate try.toml --free shear_modulus").refuses(&["no influence"]);
    folder.run("calibrate --write x.toml").refuses(&["there are two"]);
    folder.run("calibrate --free length --prior length=390mm").refuses(&["--prior", "standard error"]);
    folder
        .run("calibrate --free length --bounds density=1")
        .refuses(&["--bounds", "\"density\" is not free"]);
    let table = fs::read_to_string(folder.path("try.csv")).unwrap();
    fs::write(folder.path("try.csv"), table.replace("[g]", "[kg]")).unwrap();
    folder.run("calibrate try.toml --free youngs_modulus").refuses(&[
        "a unit is wrong: with the column mass [kg] divided by 1000",
        "check the unit in the header",
    ]);
    folder.run("calibrate nothing.toml --free length").refuses(&["no file named nothing.toml"]);
    let bad = fs::read_to_string(folder.path("try.toml")).unwrap() + "\n[calibrate]\nfree = [\"weight\"]\n";
    fs::write(folder.path("bad.toml"), bad).unwrap();
    folder.run("calibrate bad.toml").refuses(&["bad.toml:", "there is no parameter \"weight\""]);
}

#[test]
fn a_report_is_one_page_of_all_calibrations() {
    let folder = Folder::new("calibrate_report");
    let text = folder.run("calibrate --report out/gray").succeeds();
    let page = fs::read_to_string(folder.path("out/gray/index.html")).unwrap();
    for words in [
        "Free: youngs_modulus<",
        "Free: youngs_modulus, length<",
        "54.12 to 55.10 GPa",
        "391.35 mm",
        "1 to 2 mm per coordinate",
        "hydrostat calibrate --report",
        "energy method",
        "built-in bench",
    ] {
        assert!(page.contains(words), "{words}");
    }
    for outside in ["<script", "src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(outside), "the page loads something: {outside}");
    }
    assert_eq!(folder.run("calibrate").succeeds(), text, "a page changes what is printed");
}

/// A fit that fails, or a page in the place of another output, leaves nothing behind.
#[test]
fn a_report_is_written_after_the_fit_or_not_at_all() {
    let folder = bench("calibrate_report_refused");
    let before = folder.contents();
    folder.run("calibrate try.toml --free shear_modulus --report out").refuses(&["no influence"]);
    let both = "calibrate try.toml --free youngs_modulus --write out/index.html --report out";
    folder.run(both).refuses(&["--report would replace the robot that --write saves"]);
    assert!(folder.contents() == before && !folder.path("out").exists());
    folder.run("calibrate try.toml --free youngs_modulus --report out").succeeds();
    let page = fs::read_to_string(folder.path("out/index.html")).unwrap();
    assert!(page.contains("try.toml, try_rod.toml, try.csv"), "the files that were read");
}
