//! `hydrostat new`.

use crate::Folder;

#[test]
fn a_starter_rod_can_be_solved() {
    let folder = Folder::new("new_rod");
    let text = folder.run("new rod mine").succeeds();
    assert!(text.contains("mine.toml"), "{text}");
    assert_eq!(folder.files(), ["mine.toml"]);
    assert!(
        std::fs::read_to_string(folder.path("mine.toml")).unwrap().contains('#'),
        "comments explain the keys"
    );
    folder.run("solve mine.toml").succeeds();
}

#[test]
fn a_starter_never_replaces_a_file() {
    let folder = Folder::with("new_over", "mine.csv", "my data");
    folder.run("new bench mine").refuses(&["mine.csv exists already"]);
    assert_eq!(folder.files(), ["mine.csv"], "nothing of the refused bench stays");
    assert_eq!(std::fs::read_to_string(folder.path("mine.csv")).unwrap(), "my data");
}

#[test]
fn a_name_stays_in_this_folder() {
    let folder = Folder::new("new_name");
    for name in ["../mine", "a/b", "mine.toml"] {
        folder.run(&format!("new rod {name}")).refuses(&[name, "expected letters"]);
    }
    assert!(folder.files().is_empty());
}
