//! `hydrostat validate`.

use crate::Folder;
use std::path::Path;

/// With the shapes computed by SoRoSim where ../shared/data is beside the project.
#[test]
fn every_case_agrees() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let command = if data.is_dir() {
        format!("validate --data {}", data.display())
    } else {
        println!("without SoRoSim's shapes: no folder {}", data.display());
        "validate".to_owned()
    };
    let text = Folder::new("validate").run(&command).succeeds();
    assert!(text.contains("tolerance") && text.contains("cases agree"), "{text}");
    assert!(!text.contains("FAILS"), "{text}");
}

#[test]
fn markdown_is_tables() {
    let text = Folder::new("markdown").run("validate --markdown").succeeds();
    assert!(text.contains("\n## ") && text.contains("| case |"), "{text}");
}
