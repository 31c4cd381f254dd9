//! Holds the rules of ARCHITECTURE.md against the text of the sources.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The headings of lib.rs, in data-flow order.
const HEADINGS: [&str; 4] = [
    "what the robot is",
    "how its shape is found",
    "what the shape is used for",
    "mathematics with no robot",
];
const MODEL: usize = 0;
const SOLVERS: usize = 1;
const USES: usize = 2;
const MATHEMATICS: usize = 3;

/// Known to every module.
const EVERYWHERE: &str = "error";

/// Imports against the rules, each with its reason.
const EXCEPTIONS: [(&str, &str, &str); 11] = [
    ("description", "verify", "an experiment file describes a bench"),
    ("description", "batch", "a table of commands describes a batch"),
    ("description", "calibrate", "an experiment file says what is free"),
    ("description", "fabricate", "a robot file says how its kit is made"),
    (
        "calibrate",
        "verify",
        "a calibration fits the bench that verify compares with, and judges by the same test",
    ),
    ("description", "budget", "an experiment file states tolerances"),
    ("description", "plan", "an experiment file limits what may be measured"),
    ("budget", "verify", "a budget is of a bench, and explains the error that verify finds"),
    (
        "budget",
        "calibrate",
        "tolerances are of the parameters that a calibration may free, with its sensitivities",
    ),
    ("plan", "verify", "a plan adds rows to a bench"),
    (
        "plan",
        "calibrate",
        "a plan serves the parameters that a calibration frees, with its sensitivities and its fit",
    ),
];

/// What would make the core depend on the machine it runs on.
const INPUT_OUTPUT: [&str; 12] = [
    "std::fs",
    "std::io",
    "std::net",
    "std::time",
    "std::env",
    "std::process",
    "std::os",
    "println!",
    "print!",
    "eprintln!",
    "eprint!",
    "dbg!",
];

#[test]
fn modules_know_only_what_their_heading_allows() {
    let map = Map::read();
    let mut broken = Vec::new();
    for (module, file, text) in sources() {
        for other in map.imports(&text) {
            if !map.may_use(&module, &other) {
                broken.push(format!("{}: {module} uses {other}", file.display()));
            }
        }
    }
    assert!(broken.is_empty(), "against ARCHITECTURE.md:\n{}", broken.join("\n"));
}

#[test]
fn the_core_does_no_input_or_output() {
    for (_, file, text) in sources() {
        for word in INPUT_OUTPUT {
            assert!(!text.contains(word), "{} contains {word}", file.display());
        }
    }
}

#[test]
fn every_module_stands_under_a_heading() {
    let map = Map::read();
    for (module, file, _) in sources() {
        assert!(map.heading.contains_key(&module), "{} is under no heading of lib.rs", file.display());
    }
}

#[test]
fn the_headings_stand_in_the_order_of_the_map() {
    let lib = fs::read_to_string(source_folder().join("lib.rs")).expect("lib.rs is readable");
    let places = HEADINGS.map(|heading| lib.find(&format!("// {heading}")).expect("a heading of lib.rs"));
    assert!(places.is_sorted(), "{HEADINGS:?} at {places:?}");
}

#[test]
fn every_cited_equation_is_in_the_theory_chapter() {
    let theory = source_folder().join("../../../docs/theory.md");
    let theory = fs::read_to_string(theory).expect("the theory chapter is readable");
    let equations: Vec<&str> = theory.lines().filter(|line| line.starts_with("    ")).collect();
    let mut files = Vec::new();
    collect(&source_folder(), &mut files);
    let mut citations = 0;
    for file in files {
        let text = fs::read_to_string(&file).expect("a source is readable");
        for (at, word) in text.match_indices("theory (") {
            let numbers = text[at + word.len()..].split(')').next().unwrap_or_default();
            let numbers = numbers.split(|c: char| !c.is_ascii_digit()).filter(|number| !number.is_empty());
            for number in numbers {
                citations += 1;
                let label = format!("   ({number})");
                assert!(
                    equations.iter().any(|line| line.contains(&label)),
                    "{} cites ({number})",
                    file.display()
                );
            }
        }
    }
    assert!(citations > 0);
}

#[test]
fn the_rules_catch_what_they_forbid() {
    let lib = "// what the robot is\npub mod model;\n// how its shape is found\npub mod statics;\n\
               // what the shape is used for\npub mod verify;\npub mod validate;\n\
               // mathematics with no robot\nmod numeric;\npub use model::{Robot, Pose};\n";
    let map = Map::parse(lib);
    assert_eq!(
        map.imports("use crate::{Pose, verify::{Row, Point}, statics};"),
        ["model", "verify", "statics"]
    );
    for (module, other) in
        [("numeric", "model"), ("model", "statics"), ("statics", "verify"), ("verify", "validate")]
    {
        assert!(!map.may_use(module, other), "{module} must not use {other}");
        assert!(map.may_use(module, "error") && map.may_use(module, "numeric"));
    }
    assert!(map.may_use("verify", "statics") && map.may_use("statics", "model"));
}

/// Which heading of lib.rs a module stands under, and which module a re-exported name comes from.
struct Map {
    heading: BTreeMap<String, usize>,
    exported: BTreeMap<String, String>,
}

impl Map {
    fn read() -> Map {
        Map::parse(&fs::read_to_string(source_folder().join("lib.rs")).expect("lib.rs is readable"))
    }

    fn parse(lib: &str) -> Map {
        let mut map = Map { heading: BTreeMap::new(), exported: BTreeMap::new() };
        let mut heading = None;
        for line in lib.lines().map(str::trim) {
            if let Some(comment) = line.strip_prefix("// ") {
                heading = HEADINGS.iter().position(|h| comment.starts_with(h)).or(heading);
            }
            if let (Some(heading), Some(module)) = (heading, declared_module(line)) {
                map.heading.insert(module.to_owned(), heading);
            }
            if let Some((module, names)) =
                line.strip_prefix("pub use ").and_then(|path| path.split_once("::"))
            {
                for name in names.split(|c: char| !is_word(c)).filter(|name| !name.is_empty()) {
                    map.exported.insert(name.to_owned(), module.to_owned());
                }
            }
        }
        map
    }

    /// The modules of this crate that a source text names, in order.
    fn imports(&self, text: &str) -> Vec<String> {
        text.match_indices("crate::")
            .flat_map(|(at, word)| first_words(&text[at + word.len()..]))
            .map(|name| self.exported.get(&name).cloned().unwrap_or(name))
            .collect()
    }

    fn may_use(&self, module: &str, other: &str) -> bool {
        if module == other || other == EVERYWHERE || EXCEPTIONS.iter().any(|e| (e.0, e.1) == (module, other))
        {
            return true;
        }
        match (self.heading.get(module), self.heading.get(other)) {
            (Some(&MATHEMATICS), to) => to == Some(&MATHEMATICS),
            (Some(&MODEL), to) => !matches!(to, Some(&SOLVERS | &USES)),
            (Some(&(SOLVERS | USES)), to) => to != Some(&USES),
            _ => true,
        }
    }
}

/// The first word after `crate::`, or of every branch of a `{...}` there.
fn first_words(path: &str) -> Vec<String> {
    let word = |text: &str| text.trim_start().chars().take_while(|&c| is_word(c)).collect::<String>();
    let Some(group) = path.strip_prefix('{') else {
        return vec![word(path)];
    };
    let (mut depth, mut start, mut words) = (0, 0, Vec::new());
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            ',' | '}' if depth == 0 => {
                words.push(word(&group[start..i]));
                start = i + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn declared_module(line: &str) -> Option<&str> {
    let line = line.strip_prefix("pub ").or(line.strip_prefix("pub(crate) ")).unwrap_or(line);
    line.strip_prefix("mod ")?.strip_suffix(';')
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn source_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Module, file and text (without comments and unit tests) of every source but lib.rs.
fn sources() -> Vec<(String, PathBuf, String)> {
    let mut files = Vec::new();
    collect(&source_folder(), &mut files);
    files.retain(|file| !file.ends_with("lib.rs") && !file.ends_with("tests.rs"));
    assert!(!files.is_empty(), "no sources found");
    let read = |file: PathBuf| {
        let inside = file.strip_prefix(source_folder()).expect("collected from there").with_extension("");
        let module = inside.iter().next().expect("not empty").to_string_lossy().into_owned();
        let text = fs::read_to_string(&file).expect("a source is readable");
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code: Vec<&str> = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        (module, file, code.join("\n"))
    };
    files.into_iter().map(read).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the source folder is readable") {
        let path = entry.expect("an entry is readable").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}
