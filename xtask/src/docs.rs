//! Documents that the program writes: `cargo xtask docs`, and a check that they are up to date.

use crate::{capture, hydrostat, root, run};
use std::fs;

/// The validation chapter, and the arguments that print it; the check leaves the long part out.
const CHAPTER: &str = "docs/validation.md";
const PRINT: &[&str] = &["validate", "--markdown"];
const IN_FULL: &[&str] = &["--full"];
/// Reference data beside the project, where there are any.
const DATA: &str = "../shared/data";

/// File, and the arguments that write it; the file's name follows.
const DRAWN: [(&str, &[&str]); 7] = [
    ("docs/gray2009.svg", &["verify", "--plot"]),
    ("docs/robots/scr.svg", &["solve", "robots/scr.toml", "--plot"]),
    ("docs/robots/scr_two_section.svg", &["solve", "robots/scr_two_section.toml", "--plot"]),
    ("docs/robots/till2019.svg", &["solve", "robots/till2019.toml", "--plot"]),
    ("docs/robots/rucker2011_helical.svg", &["solve", "robots/rucker2011_helical.toml", "--plot"]),
    ("docs/robots/rao2021.svg", &["solve", "robots/rao2021.toml", "--plot"]),
    ("docs/robots/elephant_trunk.svg", &["solve", "robots/elephant_trunk.toml", "--plot"]),
];

/// Builds the program with the features of the tests.
pub(crate) fn build() -> Result<(), String> {
    run(&["cargo", "build", "--package", "hydrostat-cli", "--all-features", "--locked"])
}

pub(crate) fn write() -> Result<(), String> {
    let data = root().join(DATA);
    let data = data.is_dir().then(|| data.to_string_lossy().into_owned());
    let with_data: Vec<&str> = data.iter().flat_map(|data| ["--data", data]).collect();
    for (file, text) in documents(&[IN_FULL, &with_data].concat())? {
        let path = root().join(file);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)
                .map_err(|error| format!("cannot make {}: {error}", folder.display()))?;
        }
        fs::write(&path, text).map_err(|error| format!("cannot write {file}: {error}"))?;
        println!("wrote {file}");
    }
    Ok(())
}

/// Fails if a document lacks a line that the program writes now, except for the size of rounding errors.
pub(crate) fn check() -> Result<(), String> {
    for (file, text) in documents(&[])? {
        let stored = fs::read_to_string(root().join(file)).unwrap_or_default();
        if let Some(line) = first_missing(&stored, &text) {
            return Err(format!(
                "{file} is out of date: it lacks `{line}`\nhint: run `cargo xtask docs` and commit the result"
            ));
        }
        println!("{file} is up to date");
    }
    Ok(())
}

/// The first line of `text` that does not follow in `stored`, which may hold more.
fn first_missing<'a>(stored: &str, text: &'a str) -> Option<&'a str> {
    let mut stored = stored.lines().map(without_small_numbers);
    text.lines().find(|line| !stored.any(|have| have == without_small_numbers(line)))
}

/// With further arguments for the chapter.
fn documents(further: &[&str]) -> Result<Vec<(&'static str, String)>, String> {
    let program = hydrostat()?.to_string_lossy().into_owned();
    let mut documents = Vec::new();
    documents.push((CHAPTER, capture(&[&[program.as_str()], PRINT, further].concat())?));
    for (file, arguments) in DRAWN {
        let drawing = std::env::temp_dir().join(format!("hydrostat-{}.svg", std::process::id()));
        capture(&[&[program.as_str()], arguments, &[&drawing.to_string_lossy()]].concat())?;
        let text = fs::read_to_string(&drawing)
            .map_err(|error| format!("cannot read {}: {error}", drawing.display()));
        let _ = fs::remove_file(&drawing);
        documents.push((file, text?));
    }
    Ok(documents)
}

/// The words of a line; a number with a negative exponent is a rounding error and differs between machines.
fn without_small_numbers(line: &str) -> Vec<&str> {
    let small = |word: &str| word.contains("e-") && word.parse::<f64>().is_ok();
    line.split_whitespace().map(|word| if small(word) { "small" } else { word }).collect()
}

#[test]
fn only_small_numbers_may_differ() {
    assert_eq!(
        without_small_numbers("| tip | 3.2e-13 | ok |"),
        without_small_numbers("| tip | -4e-12 | ok |")
    );
    assert_ne!(without_small_numbers("| tip | 0.32 |"), without_small_numbers("| tip | 0.33 |"));
}

#[test]
fn a_document_may_hold_more_but_not_less() {
    assert_eq!(first_missing("a\nb\nc\n", "a\nc\n"), None);
    assert_eq!(first_missing("a\nc\n", "a\nb\n"), Some("b"));
}
