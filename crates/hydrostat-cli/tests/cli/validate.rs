//! `hydrostat validate`.

use crate::Folder;

#[test]
fn every_case_agrees() {
    let text = Folder::new("validate").run("validate").succeeds();
    assert!(text.contains("tolerance") && text.contains("cases agree"), "{text}");
    assert!(!text.contains("FAILS"), "{text}");
}

#[test]
fn markdown_is_tables() {
    let text = Folder::new("markdown").run("validate --markdown").succeeds();
    assert!(text.contains("\n## ") && text.contains("| case |"), "{text}");
}
