//! `hydrostat budget` and `hydrostat plan`.

use crate::{Folder, json, keys, refusals::bench};
use std::fs;

#[test]
fn the_built_in_bench_has_a_budget() {
    let folder = Folder::new("budget_gray");
    let text = folder.run("budget --samples 20 --plot bars.svg").succeeds();
    for words in ["grid_tilt.z", "1.1 GPa", "all together", "error found by verify", "row by row they do not"]
    {
        assert!(text.contains(words), "expected {words:?} in:\n{text}");
    }
    let svg = fs::read_to_string(folder.path("bars.svg")).unwrap();
    assert!(svg.contains("diameter, 0.010 mm") && svg.contains("all together"), "{svg}");
    assert_eq!(text, folder.run("budget --samples 20").succeeds());
    let value = json(&folder.run("budget --samples 20 --tolerance length=1mm --json").succeeds());
    let names = ["experiment", "samples", "seed", "failed_samples", "tolerances", "total", "rows", "verify"];
    assert_eq!(keys(&value)[..8], names);
    assert_eq!(value["tolerances"][0]["name"], "length");
    assert_eq!(value["rows"].as_array().unwrap().len(), 11);
}

#[test]
fn the_built_in_bench_has_a_plan() {
    let folder = Folder::new("plan_gray");
    let text = folder.run("plan").succeeds();
    for words in
        ["youngs_modulus, length; 11 rows at hand, 3 to plan", "D-optimal rows", "A-optimal rows", "+- "]
    {
        assert!(text.contains(words), "expected {words:?} in:\n{text}");
    }
    let value = json(&folder.run("plan --free density --measurements 2 --json").succeeds());
    assert_eq!(value["d_optimal"]["rows"].as_array().unwrap().len(), 2);
    let [now, after] = ["standard_error_now", "standard_error_after_d_optimal"]
        .map(|key| value["parameters"][0][key].as_f64().unwrap());
    assert!(after < now, "{after} {now}");
    // as many as rows are planned are as many as can be
    let all = json(&folder.run("plan --repeats 1000000000000 --json").succeeds());
    let three = json(&folder.run("plan --repeats 3 --json").succeeds());
    assert_eq!(all["d_optimal"], three["d_optimal"]);
    assert_eq!(all["warnings"].as_array().unwrap().len(), 0);
}

/// A table in grams whose header says kilograms.
#[test]
fn a_plan_for_a_wrong_unit_is_an_error() {
    let folder = bench("plan_unit");
    let table = fs::read_to_string(folder.path("try.csv")).unwrap().replace("[g]", "[kg]");
    fs::write(folder.path("try.csv"), table).unwrap();
    folder
        .run("plan try.toml --free youngs_modulus --limit mass=0g,20g")
        .refuses(&["probably a unit is wrong", "divided by 1000"]);
}

#[test]
fn refusals_write_nothing() {
    let folder = bench("budget_refusals");
    for (command, words) in [
        ("budget try.toml --tolerance length=1g --plot bars.svg", "found a mass, expected a length"),
        ("budget try.toml --plot bars.pdf", "expected a file .svg or .png"),
        ("budget try.toml --plot try.csv", "expected a file .svg or .png"),
        ("plan try.toml", "nothing is free"),
        ("plan try.toml --free youngs_modulus --limit mass=5", "expected two values"),
    ] {
        folder.run(command).refuses(&[words]);
    }
    assert!(!folder.path("bars.svg").exists());
}
