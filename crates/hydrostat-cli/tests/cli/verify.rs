//! `hydrostat verify`.

use crate::{Folder, json, keys, refusals::bench};

/// Printed digits of the figures that mechanics.md recomputes from the thesis's table.
const ROUNDING: f64 = 0.5e-5;

#[test]
fn the_built_in_bench_prints_the_table() {
    let text = Folder::new("gray").run("verify").succeeds();
    for words in
        ["mass [g]", "predicted x y [mm]", "observed x y [mm]", "error [mm]", "constant curvature", "Verdict"]
    {
        assert!(text.contains(words), "expected {words:?} in:\n{text}");
    }
}

#[test]
fn json_has_the_keys_of_the_format() {
    let value = json(&Folder::new("gray_json").run("verify --json").succeeds());
    let expected = [
        "experiment",
        "length_m",
        "rows",
        "mean_error_m",
        "rms_error_m",
        "max_error_m",
        "mean_error_percent",
        "constant_curvature",
        "verdict",
    ];
    for key in expected {
        assert!(keys(&value).contains(&key), "{key} in {:?}", keys(&value));
    }
    for key in &expected[3..7] {
        assert!(value["constant_curvature"][*key].is_number(), "{key}");
    }
    let rows = value["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 11);
    assert_eq!(keys(&rows[0]), ["mass_kg", "at_m", "predicted_m", "observed_m", "error_m", "failed_checks"]);
    assert_eq!(rows[0]["observed_m"], serde_json::json!([0.39, -0.023]));
    assert!(value["verdict"].as_str().is_some_and(|verdict| !verdict.is_empty()));
}

#[test]
fn the_stated_density_gives_the_known_error() {
    let value = json(&Folder::new("gray_error").run("verify --json").succeeds());
    let mean = value["mean_error_m"].as_f64().unwrap();
    assert!((mean - 0.00279).abs() <= ROUNDING, "{mean}");
    assert_eq!(value["length_m"], 0.39);
}

#[test]
fn a_starter_bench_can_be_verified() {
    let run = bench("bench").run("verify try.toml --json");
    assert_eq!(run.code, 0, "{run:?}");
    assert!(!json(&run.stdout)["rows"].as_array().unwrap().is_empty());
}

/// A variant of another length carries its mass, and is compared, at its own tip.
#[test]
fn a_variant_of_another_length_is_the_rod_of_that_length() {
    let folder = bench("variant");
    let edited = |name: &str, set: &str| {
        let text = std::fs::read_to_string(folder.path("try.toml")).unwrap();
        std::fs::write(folder.path(name), format!("{set}{text}")).unwrap();
        json(&folder.run(&format!("verify {name} --json")).succeeds())
    };
    let length = r#"{ "section.rod.length" = "380 mm" }"#;
    let whole = edited("whole.toml", &format!("set = {length}\n"));
    let text = std::fs::read_to_string(folder.path("try.toml")).unwrap();
    let variant = format!("{text}\n[[variant]]\nname = \"short\"\nset = {length}\n");
    std::fs::write(folder.path("variant.toml"), variant).unwrap();
    let variant = json(&folder.run("verify variant.toml --json").succeeds());
    let difference =
        variant["variants"][0]["mean_error_m"].as_f64().unwrap() - whole["mean_error_m"].as_f64().unwrap();
    assert!(difference.abs() < ROUNDING, "{difference}");
}

#[test]
fn a_prediction_over_the_strain_limit_is_said_and_counts() {
    let folder = bench("strain");
    let rod = std::fs::read_to_string(folder.path("try_rod.toml")).unwrap().replace("\"1 %\"", "\"0.1 %\"");
    std::fs::write(folder.path("try_rod.toml"), rod).unwrap();
    let run = folder.run("verify try.toml");
    assert!(run.code == 1 && run.stdout.contains("fails its check of strain"), "{run:?}");
}
