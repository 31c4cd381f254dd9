//! Documents that the program writes: `cargo xtask docs`, and a check that they are up to date.

use crate::{capture, hydrostat, root, run};
use std::fs;

/// File, and the arguments whose output it is.
const PRINTED: [(&str, &[&str]); 1] = [("docs/validation.md", &["validate", "--markdown"])];

/// File, and the arguments that write it; the file's name follows.
const DRAWN: [(&str, &[&str]); 1] = [("docs/gray2009.svg", &["verify", "--plot"])];

/// Builds the program with the features of the tests.
pub(crate) fn build() -> Result<(), String> {
    run(&["cargo", "build", "--package", "hydrostat-cli", "--all-features", "--locked"])
}

pub(crate) fn write() -> Result<(), String> {
    for (file, text) in documents()? {
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

/// Fails if a document differs from what the program writes now, except in the size of rounding errors.
pub(crate) fn check() -> Result<(), String> {
    for (file, text) in documents()? {
        let stored = fs::read_to_string(root().join(file)).unwrap_or_default();
        let differs = |(old, new): &(&str, &str)| without_small_numbers(old) != without_small_numbers(new);
        let line = stored.lines().zip(text.lines()).position(|pair| differs(&pair));
        if line.is_some() || stored.lines().count() != text.lines().count() {
            let line = line.map_or(String::new(), |line| format!(" from line {}", line + 1));
            return Err(format!(
                "{file} is out of date{line}\nhint: run `cargo xtask docs` and commit the result"
            ));
        }
        println!("{file} is up to date");
    }
    Ok(())
}

fn documents() -> Result<Vec<(&'static str, String)>, String> {
    let program = hydrostat()?.to_string_lossy().into_owned();
    let mut documents = Vec::new();
    for (file, arguments) in PRINTED {
        documents.push((file, capture(&[&[program.as_str()], arguments].concat())?));
    }
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
