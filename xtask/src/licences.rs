//! Every dependency must be under a licence that lets MIT OR Apache-2.0 stand.
//!
//! `cargo deny` would do more, but compiling it takes longer than all the tests.

use crate::capture;

const ALLOWED: [&str; 13] = [
    "MIT",
    "MIT-0",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "0BSD",
    "ISC",
    "Unicode-3.0",
    "Unicode-DFS-2016",
    "Unlicense",
    "Zlib",
];

/// Reads the licence of every package for every target.
pub(crate) fn check() -> Result<(), String> {
    let tree = capture(&[
        "cargo",
        "tree",
        "--workspace",
        "--all-features",
        "--target",
        "all",
        "--locked",
        "--prefix",
        "none",
        "--format",
        "{l}|{p}",
    ])?;
    let mut lines: Vec<&str> =
        tree.lines().map(|line| line.trim_end_matches(" (*)")).filter(|line| !line.is_empty()).collect();
    lines.sort_unstable();
    lines.dedup();
    let refused: Vec<String> = lines
        .iter()
        .filter_map(|line| line.split_once('|'))
        .filter(|(licence, _)| !allowed(licence))
        .map(|(licence, package)| {
            format!("\n  {package}: {}", if licence.is_empty() { "none stated" } else { licence })
        })
        .collect();
    if !refused.is_empty() {
        return Err(format!("licences not in the allow-list of xtask/src/licences.rs:{}", refused.concat()));
    }
    println!("{} packages", lines.len());
    Ok(())
}

/// Whether an SPDX expression can be satisfied; `/` is the old way to write OR.
fn allowed(expression: &str) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let mut words = spaced.split_whitespace().peekable();
    any_of(&mut words) && words.next().is_none()
}

type Words<'a> = std::iter::Peekable<std::str::SplitWhitespace<'a>>;

fn any_of(words: &mut Words) -> bool {
    let mut ok = all_of(words);
    while words.next_if_eq(&"OR").is_some() {
        ok |= all_of(words);
    }
    ok
}

fn all_of(words: &mut Words) -> bool {
    let mut ok = one(words);
    while words.next_if_eq(&"AND").is_some() {
        ok &= one(words);
    }
    ok
}

fn one(words: &mut Words) -> bool {
    match words.next() {
        Some("(") => any_of(words) & (words.next() == Some(")")),
        Some(name) => {
            // an exception only adds permissions
            if words.next_if_eq(&"WITH").is_some() {
                words.next();
            }
            ALLOWED.contains(&name)
        }
        None => false,
    }
}

#[test]
fn expressions_are_evaluated() {
    for yes in [
        "MIT",
        "MIT OR GPL-3.0",
        "MIT/Apache-2.0",
        "(MIT OR Apache-2.0) AND Unicode-3.0",
        "Apache-2.0 WITH LLVM-exception",
        "GPL-3.0 OR (MIT AND Zlib)",
    ] {
        assert!(allowed(yes), "{yes}");
    }
    for no in [
        "",
        "GPL-3.0",
        "MIT AND MPL-2.0",
        "(MIT OR Apache-2.0",
        "MIT Apache-2.0",
        "GPL-3.0 AND MIT OR LGPL-2.1",
    ] {
        assert!(!allowed(no), "{no}");
    }
}
