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
fn a_starter_tendon_robot_can_be_solved() {
    let folder = Folder::new("new_tendon");
    let text = folder.run("new tendon mine").succeeds();
    assert_eq!(text, "wrote mine.toml; next: hydrostat solve mine.toml\n");
    let text = folder.run("solve mine.toml").succeeds();
    for words in
        ["mine  ", "tendon a                2.0000 N", "tendon b                0.5000 N", "guide_spacing"]
    {
        assert!(text.contains(words), "expected {words:?} in:\n{text}");
    }
    folder.run("solve mine.toml --tension a=3N --displacement c=-0.5mm").succeeds();
}

/// The keys that its comments offer are right.
#[test]
fn a_starter_tendon_robot_can_be_extended() {
    let folder = Folder::new("new_tendon_keys");
    folder.run("new tendon mine").succeeds();
    let file = std::fs::read_to_string(folder.path("mine.toml")).unwrap();
    let offered = |line: &&str| line.starts_with("# ") && line.contains(" = ");
    let keys: Vec<&str> =
        file.lines().filter(offered).map(|line| line[2..].split(' ').next().unwrap()).collect();
    assert_eq!(keys, ["stiffness", "friction", "displacement", "released"]);
    let all =
        keys.iter().fold(file.clone(), |file, key| file.replace(&format!("# {key} ="), &format!("{key} =")));
    std::fs::write(folder.path("mine.toml"), all).unwrap();
    let text = folder.run("solve mine.toml").succeeds();
    assert!(text.contains("tendon c        ") && text.contains("pulled in -0.500 mm"), "{text}");
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
