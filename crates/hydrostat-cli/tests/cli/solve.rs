//! `hydrostat solve`.

use crate::{Folder, ROD, json, keys};
use std::path::Path;

#[test]
fn the_summary_is_for_people() {
    let text = Folder::with("summary", "rod.toml", ROD).run("solve rod.toml").succeeds();
    for words in [
        "tip position",
        "mm",
        "backbone force at base",
        "N mm",
        "strain",
        "limit",
        "error estimate",
        "iterations",
        "stable",
    ] {
        assert!(text.contains(words), "expected {words:?} in:\n{text}");
    }
}

#[test]
fn json_has_the_keys_of_the_format() {
    let text = Folder::with("json", "rod.toml", ROD).run("solve rod.toml --json --stations 11").succeeds();
    let value = json(&text);
    assert_eq!(keys(&value), ["robot", "tip", "stations", "tendons", "checks", "report"]);
    assert_eq!(keys(&value["tip"]), ["position_m", "rotation"]);
    let columns = ["s_m", "position_m", "rotation", "v", "u_per_m", "force_n", "moment_nm"];
    assert_eq!(keys(&value["stations"]), columns);
    for column in columns {
        assert_eq!(value["stations"][column].as_array().unwrap().len(), 11, "{column}");
    }
    assert_eq!(keys(&value["checks"][0]), ["name", "value", "limit", "ok", "at_m"]);
    let report = [
        "method",
        "iterations",
        "residual",
        "error_estimate_m",
        "stable",
        "smallest_eigenvalue",
        "unstable_from",
        "snapped_from",
        "solve_time_us",
    ];
    assert_eq!(keys(&value["report"]), report);
    assert_eq!((&value["robot"], &value["report"]["method"]), (&"rod".into(), &"energy".into()));
    assert_eq!(value["tip"]["position_m"], value["stations"]["position_m"][10]);
    assert!(value["report"]["solve_time_us"].as_f64().unwrap() > 0.0);
}

/// Columns d1 d2 d3: at the base d3 lies along x and d1 along y.
#[test]
fn rotations_are_rows_of_the_matrix() {
    let text = Folder::with("rows", "rod.toml", ROD).run("solve rod.toml --json").succeeds();
    let base = &json(&text)["stations"]["rotation"][0];
    let number = |row: usize, column: usize| base[row][column].as_f64().unwrap().round();
    assert_eq!([number(0, 2), number(1, 0), number(2, 1)], [1.0, 1.0, 1.0]);
}

/// The base carries the hung mass and the rod's own weight.
#[test]
fn the_base_force_is_the_weight() {
    let text = Folder::with("weight", "rod.toml", ROD).run("solve rod.toml --json").succeeds();
    let force = json(&text)["stations"]["force_n"][0][1].as_f64().unwrap();
    let area = std::f64::consts::PI / 4.0 * 1.56e-3_f64.powi(2);
    let weight = 9.81 * (0.020 + 6450.0 * area * 0.390);
    assert!((force + weight).abs() < 1e-12, "{force} against {weight}");
}

#[test]
fn csv_has_units_in_the_header() {
    let text = Folder::with("csv", "rod.toml", ROD).run("solve rod.toml --csv --stations 5").succeeds();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 6);
    for unit in ["s [m]", "x [m]", "u1 [1/m]", "force x [N]", "moment x [N m]"] {
        assert!(lines[0].split(',').any(|column| column == unit), "{unit} in {}", lines[0]);
    }
    for line in &lines[1..] {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(numbers.len(), lines[0].split(',').count());
    }
    assert!(lines[5].starts_with("0.39,"));
}

#[test]
fn a_failing_check_is_exit_code_1() {
    let folder = Folder::with("strain", "rod.toml", ROD.replace("\"1 %\"", "\"0.01 %\""));
    let run = folder.run("solve rod.toml");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{run:?}");
    assert!(run.stdout.contains("FAILS"), "{}", run.stdout);

    let run = folder.run("solve rod.toml --json");
    assert_eq!(run.code, 1);
    assert!(run.stderr.starts_with("warning: check strain fails"), "{}", run.stderr);
    assert_eq!(json(&run.stdout)["checks"][0]["ok"], false);
}

/// The rods of ../shared/data/reference_cases, solved by another program; agreement to 1e-7 of the length is promised there.
#[test]
fn reference_rods_agree() {
    const AGREEMENT: f64 = 1e-7;
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/reference_cases");
    let Ok(entries) = std::fs::read_dir(&cases) else {
        println!("skipped: no folder {}", cases.display());
        return;
    };
    let names = entries.map(|entry| entry.unwrap().path());
    let rods = names.filter(|path| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with('r') && name.ends_with(".toml")
    });
    let folder = Folder::new("reference_rods");
    for rod in rods {
        let expected: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(rod.with_extension("json")).unwrap()).unwrap();
        let found = json(&folder.run(&format!("solve {} --json --stations 21", rod.display())).succeeds());
        let length = expected["length_m"].as_f64().unwrap();
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            let rows = value.as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap());
            rows.map(|number| number.as_f64().unwrap()).collect()
        };
        for (expected, found, unit) in [
            (&expected["position_m"], &found["stations"]["position_m"], length),
            (&expected["tip_rotation"], &found["tip"]["rotation"], 1.0),
        ] {
            let (expected, found) = (numbers(expected), numbers(found));
            // some cases repeat the tip behind the 21 stations
            assert!(expected.len() >= found.len() && found.len() >= 9, "{}", rod.display());
            for (expected, found) in expected.iter().zip(&found) {
                assert!(
                    (expected - found).abs() <= AGREEMENT * unit,
                    "{}: {expected} {found}",
                    rod.display()
                );
            }
        }
    }
}

/// A robot with tendons: commands of the line, round trip, wrong ones.
#[test]
fn tendons_are_commanded_from_the_line() {
    let scr = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/scr.toml");
    let tension = |run: &serde_json::Value| run["tendons"][0]["tension_n"].as_f64().expect("a number");
    let json = |args: &[&str]| -> serde_json::Value {
        let mut all = vec!["solve", scr, "--json"];
        all.extend(args);
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_hydrostat")).args(all).output();
        serde_json::from_slice(&output.expect("runs").stdout).expect("is JSON")
    };
    let pulled = json(&["--tension", "a=2N"]);
    let displacement = pulled["tendons"][0]["displacement_m"].as_f64().expect("a number");
    let held = json(&["--displacement", &format!("a={displacement}m")]);
    assert!((tension(&pulled) - 2.0).abs() < 1e-12 && (tension(&held) - 2.0).abs() < 1e-6);
    for (args, message) in [
        (["--tension", "a=-2N"], "a tension of -2 N"),
        (["--tension", "z=2N"], "there is no tendon \"z\""),
        (["--tension", "a=2"], "without a unit"),
        (["--tension", "a"], "such as a=2N"),
        (["--tension", "a=1N,a=2N"], "commanded twice"),
        (["--displacement", "a=2N"], "expected a length"),
    ] {
        let mut all = vec!["solve", scr];
        all.extend(args);
        let output =
            std::process::Command::new(env!("CARGO_BIN_EXE_hydrostat")).args(all).output().expect("runs");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        let nothing_shown = output.stdout.is_empty();
        assert!(output.status.code() == Some(2) && nothing_shown, "{args:?}: {stderr}");
        assert!(stderr.contains(message), "{args:?}: {stderr}");
    }
}

/// Of the largest entry: central differences of printed results, each to 1e-12 of the length over steps of 1e-3.
const CLOSE: f64 = 1e-5;

/// `--jacobian` and `--compliance` against central differences of the program's own output, with both kinds of command.
#[test]
fn derivatives_are_differences_of_the_programs_own_output() {
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots");
    let text = std::fs::read_to_string(format!("{robots}/scr_two_section.toml")).unwrap();
    let folder = Folder::with("derivatives", "robot.toml", &text);
    let at = |a: f64, b: f64, load: [f64; 3], more: &str| {
        let force = format!("[{}, {}, {}] N", load[0], load[1], load[2]);
        let loaded = format!("{text}\n[[load]]\nat = \"tip\"\nforce = \"{force}\"\n");
        std::fs::write(folder.path("loaded.toml"), loaded).unwrap();
        let command = format!(
            "solve loaded.toml --json --stations 2 --tolerance 1e-12 --tension a={a}N,e=2.5N --displacement b={b}m,c=-5mm {more}"
        );
        json(&folder.run(&command).succeeds())
    };
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let tip = |run: &serde_json::Value, axis: usize| number(&run["tip"]["position_m"][axis]);
    let found = at(6.0, 1e-3, [0.0; 3], "--jacobian --compliance");
    let jacobian = &found["jacobian"];
    assert_eq!(jacobian["tension"]["tendons"], serde_json::json!(["a", "d", "e", "f"]));
    assert_eq!(jacobian["displacement"]["tendons"], serde_json::json!(["b", "c"]));

    let (force, pulled, load) = (6e-3, 2e-6, 1e-4);
    let columns = [
        (
            &jacobian["tension"]["tip_position_m_per_n"],
            &jacobian["tension"]["tension_n_per_n"],
            force,
            [at(6.0 - force, 1e-3, [0.0; 3], ""), at(6.0 + force, 1e-3, [0.0; 3], "")],
        ),
        (
            &jacobian["displacement"]["tip_position_m_per_m"],
            &jacobian["displacement"]["tension_n_per_m"],
            pulled,
            [at(6.0, 1e-3 - pulled, [0.0; 3], ""), at(6.0, 1e-3 + pulled, [0.0; 3], "")],
        ),
        (
            &found["compliance"]["force"]["tip_position_m_per_n"],
            &found["compliance"]["force"]["tension_n_per_n"],
            load,
            [at(6.0, 1e-3, [-load, 0.0, 0.0], ""), at(6.0, 1e-3, [load, 0.0, 0.0], "")],
        ),
    ];
    for (position, tension, step, [behind, ahead]) in columns {
        let close = |found: &serde_json::Value, difference: f64, size: f64| {
            let found = number(&found[0]);
            assert!(
                (found - difference / (2.0 * step)).abs() < CLOSE * size,
                "{found} {}",
                difference / (2.0 * step)
            );
        };
        let largest = |matrix: &serde_json::Value| {
            matrix.as_array().unwrap().iter().map(|row| number(&row[0]).abs()).fold(0.0, f64::max)
        };
        for axis in 0..3 {
            close(&position[axis], tip(&ahead, axis) - tip(&behind, axis), largest(position));
        }
        for tendon in 0..6 {
            let of = |run: &serde_json::Value| number(&run["tendons"][tendon]["tension_n"]);
            close(&tension[tendon], of(&ahead) - of(&behind), largest(tension));
        }
    }
}

#[test]
fn derivatives_in_the_summary_have_their_units() {
    let folder = Folder::with("summary_derivatives", "rod.toml", ROD);
    let text = folder.run("solve rod.toml --jacobian --compliance").succeeds();
    assert!(
        text.contains("  tip per N y             [")
            && text.contains(" mm/N, [")
            && text.contains(" deg/N\n"),
        "{text}"
    );
    let moment = text.lines().find(|line| line.contains("tip per N mm y")).unwrap();
    assert!(moment.contains("] mm/(N mm), [") && moment.ends_with("] deg/(N mm)"), "{moment}");
}

/// A rod so stiff that its answers per N are below a micrometre.
#[test]
fn derivatives_in_the_summary_keep_four_digits() {
    let stiff = ROD.replace("diameter = \"1.56 mm\"", "diameter = \"30 mm\"").replace("54 GPa", "540 GPa");
    let folder = Folder::with("significant_derivatives", "rod.toml", stiff);
    let text = folder.run("solve rod.toml --compliance").succeeds();
    let found = json(&folder.run("solve rod.toml --compliance --json").succeeds());
    let along = found["compliance"]["force"]["tip_position_m_per_n"][1][1].as_f64().unwrap() * 1e3;
    let line = text.lines().find(|line| line.starts_with("  tip per N y ")).unwrap();
    let shown: f64 = line.split(['[', ',', ']']).nth(2).unwrap().trim().parse().unwrap();
    assert!(along < 1e-2 && (shown / along - 1.0).abs() < 5e-4, "{shown} {along} in {line}");
}

/// Numbers that rounding leaves have an exponent, not sixteen zeros.
#[test]
fn csv_writes_tiny_numbers_with_an_exponent() {
    let bent =
        ROD.replace("tangent = [1, 0, 0]", "tangent = [1, 0, 0.3]").replace("[0, 1, 0]", "[0, 1, 0.1]");
    let folder = Folder::with("csv_exponent", "rod.toml", bent);
    let csv = folder.run("solve rod.toml --csv --stations 11").succeeds();
    let cells = || csv.lines().skip(1).flat_map(|line| line.split(','));
    assert!(cells().all(|cell| !cell.trim_start_matches('-').starts_with("0.00000")), "{csv}");
    assert!(cells().any(|cell| cell.contains("e-")), "nothing is tiny in\n{csv}");
    assert!(cells().all(|cell| cell != "-0.0"), "{csv}");
}

/// The hint leads to a method that does it.
#[test]
fn what_shooting_cannot_do_the_energy_method_can() {
    let rubbing = SCR.replace("ends = \"trunk\"", "ends = \"trunk\"\nfriction = 0.1");
    let folder = Folder::with("shooting_friction", "scr.toml", &rubbing);
    let run = folder.run("solve scr.toml --method shooting");
    let hint = "hint: use the energy method, which is the default";
    assert_eq!(run.stderr, format!("error: shooting knows no friction of tendons\n{hint}\n"));
    folder.run("solve scr.toml").succeeds();
}

#[test]
fn shooting_says_that_it_does_not_judge_held_tendons() {
    let folder = Folder::with("shooting_held", "scr.toml", SCR);
    let run = "solve scr.toml --displacement a=5mm,b=0mm,c=0mm --method shooting";
    let report = &json(&folder.run(&format!("{run} --json")).succeeds())["report"];
    assert_eq!((&report["smallest_eigenvalue"], &report["stable"]), (&serde_json::Value::Null, &true.into()));
    let text = folder.run(run).succeeds();
    assert!(text.contains(&format!("  {:<23} stable\n", "stability")), "{text}");
}

const SCR: &str = include_str!("../../../../robots/scr.toml");

#[test]
fn an_unknown_tendon_is_answered_with_the_tendons() {
    let run = Folder::with("unknown_tendon", "scr.toml", SCR).run("solve scr.toml --tension q=2N");
    let hint = "hint: tendons of this robot: a, b, c\n";
    assert_eq!(run.stderr, format!("error: --tension q=2N: there is no tendon \"q\"\n{hint}"));
    let long = SCR.replace("name = \"b\"", "name = \"left\"");
    let run = Folder::with("misspelt_tendon", "scr.toml", long).run("solve scr.toml --tension lefd=2N");
    assert!(run.stderr.ends_with("\nhint: did you mean \"left\"?\n"), "{}", run.stderr);
}

/// Of tendons held by displacement; c in the hole of a, but pulled in less, has to push.
#[test]
fn slack_tendons_are_named() {
    let folder = Folder::with("slack", "scr.toml", SCR);
    let line = |command: &str| {
        let run = folder.run(&format!("solve {command}"));
        assert!(!run.stdout.contains(" -0.000 mm"), "{}", run.stdout);
        let line = run.stdout.lines().find(|line| line.starts_with("  slack")).unwrap().to_owned();
        (run.code, line)
    };
    let of = |code: i32, words: &str| (code, format!("  {:<23} {words}", "slack"));
    let taut = line("scr.toml --displacement a=5mm,b=-2.4mm,c=-2.4mm");
    assert_eq!(taut, of(0, "no tendon held by displacement is slack"));
    let home = line("scr.toml --displacement a=5mm,b=2mm,c=0mm");
    assert_eq!(home, of(0, "no tendon held by displacement is slack"));
    let out = line("scr.toml --displacement a=5mm,b=-5mm,c=-5mm");
    assert_eq!(out, of(0, "b, c slack, none of them pulled in"));
    let text = folder.run("solve scr.toml --displacement a=5mm,b=-5mm,c=-5mm --plot scr.svg").succeeds();
    let drawn = std::fs::read_to_string(folder.path("scr.svg")).unwrap();
    assert!(drawn.contains("0.00 N, let out 5.00 mm, slack by 2."), "{drawn}");
    let b = text.lines().find(|line| line.starts_with("  tendon b")).unwrap();
    assert!(b.contains(" 0.0000 N, held at -5.000 mm, slack by 2."), "{b}");
    assert!(text.contains(" N, pulled in 5.000 mm, "), "{text}");
    let by_tension = folder.run("solve scr.toml --tension a=2N,b=0N,c=0N").succeeds();
    assert!(!by_tension.contains("slack"), "{by_tension}");
    std::fs::write(folder.path("twice.toml"), SCR.replace("240 deg", "0 deg")).unwrap();
    let fails = line("twice.toml --displacement a=5mm,b=-5mm,c=1mm");
    assert_eq!(fails, of(1, "c slack although pulled in: FAILS"));
    let run = folder.run("solve twice.toml --displacement a=5mm,b=-5mm,c=1mm --csv");
    assert_eq!(run.stderr, "warning: check slack fails: c slack although pulled in: FAILS\n");
}

/// The file's command of a is above the breaking load, and its release is without friction.
#[test]
fn doubts_are_about_the_commands_in_force() {
    let weak = SCR.replace("500 N\"", "1 N\"") + "released = [\"a\"]\n";
    let folder = Folder::with("in_force", "scr.toml", weak);
    let doubts = |flags: &str| folder.run(&format!("solve scr.toml {flags}")).stderr;
    let file = doubts("");
    for words in
        ["key actuation.tension.a", "key actuation.released.a", "above the tendon's breaking load of 1 N"]
    {
        assert!(file.contains(words), "expected {words:?} in:\n{file}");
    }
    assert_eq!(doubts("--tension b=0.5N"), file, "the command of a is still in force");
    assert_eq!(doubts("--tension a=0.5N"), "");
    assert_eq!(doubts("--displacement a=0.5mm"), "");

    let run = folder.run("solve scr.toml --tension a=0.5N,b=2N");
    let doubt = "--tension b=2N: a tension of 2 N is above the tendon's breaking load of 1 N";
    assert_eq!((run.code, run.stderr), (1, format!("warning: {doubt}\n")));
    let check = "2.000 N in tendon b, limit 1.000 N: FAILS";
    assert!(run.stdout.contains(&format!("  {:<23} {check}\n", "tension")), "{}", run.stdout);
}
