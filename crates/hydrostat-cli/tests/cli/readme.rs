//! What the README shows.

use super::*;

const README: &str = include_str!("../../../../README.md");

/// The first fenced block of a language.
fn block(language: &str) -> &'static str {
    let (_, from) = README.split_once(&format!("```{language}\n")).unwrap();
    from.split_once("```").unwrap().0
}

#[test]
fn its_rod_prints_what_it_shows() {
    let folder = Folder::with("readme", "rod.toml", block("toml"));
    let printed = folder.run("solve rod.toml").succeeds();
    assert!(printed.starts_with(block("text")), "the README shows\n{}but it is\n{printed}", block("text"));
}

#[test]
fn its_links_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for document in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"] {
        let text = fs::read_to_string(root.join(document)).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            assert!(link.starts_with("https://") || root.join(link).exists(), "{document}: {link}");
        }
    }
}
