//! Files and pipes: complete or not there.

use crate::{Folder, ROD, json};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

#[test]
fn help_and_version_are_no_errors() {
    let folder = Folder::new("help");
    assert!(folder.run("--help").succeeds().contains("Exit codes"));
    assert!(folder.run("solve --help").succeeds().contains("--stations"));
    assert!(folder.run("--version").succeeds().starts_with("hydrostat "));
}

#[test]
fn a_drawing_needs_a_known_ending() {
    let folder = Folder::with("ending", "rod.toml", ROD);
    folder.run("solve rod.toml --plot rod.pdf").refuses(&["rod.pdf", ".svg or .png"]);
    folder.run("solve rod.toml --plot rod").refuses(&[".svg or .png"]);
    assert_eq!(folder.files(), ["rod.toml"]);
}

#[test]
fn a_drawing_is_written_whole_or_not_at_all() {
    let folder = Folder::with("drawing", "rod.toml", ROD);
    folder
        .run("solve rod.toml --plot none/rod.svg")
        .refuses(&["cannot write none/rod.svg", "folder does not exist"]);
    std::fs::create_dir(folder.path("taken.svg")).unwrap();
    folder.run("solve rod.toml --plot taken.svg").refuses(&["cannot write taken.svg", "it is a folder"]);
    assert_eq!(folder.files(), ["rod.toml", "taken.svg"]);

    std::fs::write(folder.path("rod.svg"), "old").unwrap();
    folder.run("solve rod.toml --plot rod.svg").succeeds();
    let drawing = std::fs::read_to_string(folder.path("rod.svg")).unwrap();
    assert!(drawing.contains("<svg") && drawing.trim_end().ends_with("</svg>"), "{drawing}");
    assert_eq!(folder.files(), ["rod.svg", "rod.toml", "taken.svg"]);
}

/// By its own name, by way of its folder, and by a link.
#[test]
fn no_output_replaces_an_input() {
    let robot = format!("{ROD}name = \"hung\"\n");
    let table = "load.hung.mass [g]\n20\n";
    let folder = Folder::with("replaces", "rod.svg", robot);
    for name in ["c.csv", "from.svg"] {
        std::fs::write(folder.path(name), table).unwrap();
    }
    std::fs::write(folder.path("rod.csv"), std::fs::read(folder.path("rod.svg")).unwrap()).unwrap();
    folder.run("new bench bench").succeeds();
    let bench = std::fs::read_to_string(folder.path("bench.toml")).unwrap();
    std::fs::write(folder.path("bench.svg"), bench.replace("\"bench.csv\"", "\"table.svg\"")).unwrap();
    std::fs::rename(folder.path("bench.csv"), folder.path("table.svg")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("c.csv", folder.path("link.csv")).unwrap();
    let before = folder.contents();
    for (command, message) in [
        ("solve rod.svg --batch c.csv --out c.csv", "--out would replace the table of commands"),
        ("solve rod.svg --batch c.csv --out ./c.csv", "--out would replace the table of commands"),
        #[cfg(unix)]
        ("solve rod.svg --batch c.csv --out link.csv", "--out would replace the table of commands"),
        #[cfg(unix)]
        ("solve rod.svg --batch link.csv --out c.csv", "--out would replace the table of commands"),
        ("solve rod.csv --batch c.csv --out rod.csv", "--out would replace the robot file"),
        ("solve rod.svg --plot rod.svg", "--plot would replace the robot file"),
        ("solve rod.svg --plot from.svg --from from.svg", "--plot would replace the solution to start from"),
        ("verify bench.svg --plot bench.svg", "--plot would replace the bench"),
        ("verify bench.svg --plot table.svg", "--plot would replace a file that the bench names"),
    ] {
        let run = folder.run(command);
        assert_eq!(
            (run.code, run.stderr.as_str()),
            (2, format!("error: {message}\nhint: name another file\n").as_str()),
            "{command}"
        );
        assert!(run.stdout.is_empty() && folder.contents() == before, "{command}");
    }
    std::fs::rename(folder.path("bench.svg"), folder.path("index.html")).unwrap();
    let before = folder.contents();
    folder.run("verify index.html --report .").refuses(&["--report would replace the bench"]);
    folder
        .run("calibrate index.html --free youngs_modulus --report .")
        .refuses(&["--report would replace the bench"]);
    assert!(folder.contents() == before);
    // an older output is replaced
    folder.run("solve rod.svg --batch c.csv --out rows.csv").succeeds();
    folder.run("solve rod.svg --batch c.csv --out rows.csv").succeeds();
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_cannot_be_made_says_why() {
    let run = Folder::with("no_room", "rod.toml", ROD).run("solve rod.toml --plot /proc/x.svg");
    run.refuses(&["cannot write /proc/x.svg: ", "os error"]);
}

#[cfg(feature = "png")]
#[test]
fn a_drawing_can_be_a_png() {
    let folder = Folder::with("png", "rod.toml", ROD);
    folder.run("solve rod.toml --plot rod.PNG").succeeds();
    assert!(std::fs::read(folder.path("rod.PNG")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_report_is_one_page() {
    let folder = Folder::new("report");
    folder.run("verify --report out/gray").succeeds();
    let page = std::fs::read_to_string(folder.path("out/gray/index.html")).unwrap();
    assert!(page.contains("<html") && page.contains("<svg"));
    for outside in ["src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(outside), "the page loads something: {outside}");
    }
}

#[test]
fn a_report_folder_that_is_a_file() {
    let folder = Folder::with("report_refused", "out", "mine");
    folder.run("verify --report out").refuses(&["out", "exists and is not a folder"]);
    folder.run("verify --report out/inner").refuses(&["out/inner"]);
    folder.run("calibrate --report out").refuses(&["out", "exists and is not a folder"]);
    folder.run("calibrate --report out/inner").refuses(&["out/inner"]);
    assert_eq!(folder.files(), ["out"]);
    assert_eq!(std::fs::read_to_string(folder.path("out")).unwrap(), "mine");
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let folder = Folder::with("pipe", "rod.toml", ROD);
    let mut child = Command::new(env!("CARGO_BIN_EXE_hydrostat"))
        .args(["solve", "rod.toml", "--csv", "--stations", "20001"]) // far more than a pipe holds
        .current_dir(&folder.0)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut reader = BufReader::with_capacity(64, child.stdout.take().unwrap());
    let mut line = String::new();
    reader.read_line(&mut line).unwrap();
    assert!(line.starts_with("s [m],"), "{line}");
    drop(reader);
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), b"".as_slice()));
}

/// Every key of the two JSON outputs stands in docs/format.md, in code marks.
#[test]
fn the_format_documents_every_key() {
    fn collect(value: &serde_json::Value, found: &mut Vec<String>) {
        match value {
            serde_json::Value::Object(object) => {
                for (key, value) in object {
                    found.push(key.clone());
                    collect(value, found);
                }
            }
            serde_json::Value::Array(values) => values.iter().for_each(|value| collect(value, found)),
            _ => {}
        }
    }
    let folder = Folder::with("documented", "rod.toml", ROD);
    let mut found = Vec::new();
    for command in ["solve rod.toml --json --jacobian --compliance", "verify --json"] {
        collect(&json(&folder.run(command).succeeds()), &mut found);
    }
    let format = include_str!("../../../../docs/format.md");
    let missing: Vec<_> = found.iter().filter(|key| !format.contains(&format!("`{key}`"))).collect();
    assert!(missing.is_empty(), "not in docs/format.md: {missing:?}");
}

/// Bent out of the world's planes: directions in words, and a symbol of the legend as the guides of both views.
#[test]
fn a_picture_says_where_it_looks() {
    let scr = include_str!("../../../../robots/scr.toml");
    let folder = Folder::with("oblique", "scr.toml", scr);
    folder.run("solve scr.toml --tension a=3N,b=1N --plot scr.svg").succeeds();
    let svg = std::fs::read_to_string(folder.path("scr.svg")).unwrap();
    let looks = "The side view looks along +y turned 19.1° to \u{2212}x, the front view along \u{2212}x turned 19.1° to \u{2212}y.";
    for words in [looks, ">+x turned 19.1° to +y, in mm<", ">z in mm<"] {
        assert!(svg.contains(words), "expected {words:?} in:\n{svg}");
    }
    let rim = "stroke=\"#c2cad3\" stroke-width=\"0.9\"";
    assert_eq!(svg.matches(rim).count(), 2 * 30 + 1);
}
