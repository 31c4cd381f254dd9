//! `hydrostat fabricate` and `hydrostat check`, as a user drives them.

use super::Folder;
use std::fs;

const SCR: &str = include_str!("../../../../robots/scr.toml");
const TWO_SECTIONS: &str = include_str!("../../../../robots/scr_two_section.toml");

fn scr(test: &str, fabrication: &str) -> Folder {
    Folder::with(test, "scr.toml", format!("{SCR}\n[fabrication]\n{fabrication}\n"))
}

/// Every file below a folder, with what is in it.
fn tree(folder: &std::path::Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
                files.push((name, fs::read(&path).unwrap()));
            }
        }
    }
    files.sort();
    files
}

#[test]
fn the_kit_is_complete_and_the_same_every_time() {
    let folder = Folder::with("fabricate-twice", "two.toml", TWO_SECTIONS);
    let said = folder.run("fabricate two.toml --out one").succeeds();
    folder.run("fabricate two.toml --out kits").succeeds();
    assert!(said.contains("  kerf             0.15 mm\n"), "{said}");
    assert!(said.contains("open one/index.html and cut the coupon first"), "{said}");
    let (one, other) = (tree(&folder.path("one")), tree(&folder.path("kits")));
    assert!(one == other, "the same input gives the same bytes");
    let names: Vec<&str> = one.iter().map(|(name, _)| name.as_str()).collect();
    for name in [
        "index.html",
        "bill-of-materials.csv",
        "cut-list.csv",
        "wiring.csv",
        "motion.csv",
        "sheets/guides.dxf",
        "sheets/guides.svg",
        "parts/guide-30.dxf",
        "solids/guide-30.stl",
        "solids/clamp-60.stl",
    ] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    assert_eq!(folder.files(), ["kits", "one", "two.toml"], "nothing is left beside them");
    let text = |name: &str| {
        let (_, bytes) = one.iter().find(|file| file.0 == name).unwrap();
        String::from_utf8(bytes.clone()).unwrap()
    };
    // all guides of the cut list, six motors, and what the solver itself says of the first test
    let guides = text("cut-list.csv").lines().filter(|line| line.starts_with("guide-")).count();
    assert_eq!(guides, 30);
    assert_eq!(text("wiring.csv").lines().count(), 1 + 6);
    let page = text("index.html");
    assert!(!page.contains("<script") && !page.contains("src=") && !page.contains("href="), "self-contained");
    let others = "--tension b=0N,c=0N,d=0N,e=0N,f=0N --displacement a=5mm --json";
    let solved = super::json(&folder.run(&format!("solve two.toml {others}")).stdout);
    let tip = solved["tip"]["position_m"].as_array().unwrap();
    let tip: Vec<String> = tip.iter().map(|x| format!("{:.1}", x.as_f64().unwrap() * 1e3)).collect();
    for x in tip.iter().map(|x| x.trim_end_matches(".0").replace("-0", "0")) {
        assert!(page.contains(&x), "{x} of {tip:?}");
    }
}

#[test]
fn a_full_folder_is_kept_without_force() {
    let folder = scr("fabricate-full", "");
    fs::create_dir(folder.path("kit")).unwrap();
    fs::write(folder.path("kit/mine.txt"), "work").unwrap();
    folder.run("fabricate scr.toml --out kit").refuses(&[
        "the folder kit is not empty and is left as it is",
        "hint: name another folder, or replace this one with all that is in it by --force",
    ]);
    assert_eq!(tree(&folder.path("kit")), [("mine.txt".to_owned(), b"work".to_vec())]);
    folder.run("fabricate scr.toml --out kit --force").succeeds();
    assert!(!folder.path("kit/mine.txt").exists() && folder.path("kit/index.html").exists());
    // but never the robot itself, nor the folder that one stands in
    for (out, what) in [(".", "--force would remove the robot file"), ("kit/..", "--force would remove")] {
        folder.run(&format!("fabricate scr.toml --out {out} --force")).refuses(&[what]);
    }
    assert_eq!(folder.files(), ["kit", "scr.toml"]);
}

#[test]
fn an_empty_folder_is_filled() {
    let folder = scr("fabricate-empty", "");
    fs::create_dir(folder.path("kit")).unwrap();
    folder.run("fabricate scr.toml --out kit").succeeds();
    assert!(folder.path("kit/index.html").exists());
}

#[test]
fn what_cannot_be_built_leaves_nothing_behind() {
    for (i, (fabrication, words)) in [
        (
            "sheet_size = \"[300, 10] mm\"",
            "sheet size: coupon of 120 x 72 mm and 46 more cannot be cut from a sheet of 300 x 10 mm",
        ),
        ("spool_diameter = \"4 mm\"", "spool: spool of 4 mm on a shaft of 5 mm (NEMA 17); least 8 mm"),
        ("kerf = \"0.15\"", "found a number without a unit, expected a length"),
        ("kerv = \"0.15 mm\"", "did you mean \"kerf\"?"),
        (
            "motor_frame = \"NEMA 18\"",
            "found \"NEMA 18\", expected one of \"NEMA 14\", \"NEMA 17\", \"NEMA 23\"",
        ),
        ("microsteps = 1.5", "found 1.5, expected a whole number from 1 to 256"),
        ("bench_size = \"[1, 2, 3] mm\"", "expected a width and a height above 0 m"),
    ]
    .into_iter()
    .enumerate()
    {
        let folder = scr(&format!("fabricate-refused-{i}"), fabrication);
        folder.run("fabricate scr.toml --out kit").refuses(&[words]);
        assert_eq!(folder.files(), ["scr.toml"]);
    }
    let overlapping = SCR.replace("angle = \"120 deg\"", "angle = \"5 deg\"");
    let folder = Folder::with("fabricate-overlap", "scr.toml", overlapping);
    folder.run("fabricate scr.toml --out kit").refuses(&["holes and edges", "overlaps another hole"]);
    assert_eq!(folder.files(), ["scr.toml"]);
}

#[test]
fn a_place_that_cannot_be_written_is_said() {
    let folder = scr("fabricate-place", "");
    folder
        .run("fabricate scr.toml --out none/kit")
        .refuses(&["cannot write none/kit: its folder does not exist"]);
    folder.run("fabricate scr.toml --out scr.toml").refuses(&["scr.toml exists and is not a folder"]);
    assert_eq!(folder.files(), ["scr.toml"]);
}

#[test]
fn check_judges_alone() {
    let folder = scr("check", "minimum_web = \"1.2 mm\"");
    let said = folder.run("check scr.toml").succeeds();
    assert!(said.contains("good   strain            as commanded the rod is strained by 0.389 %"), "{said}");
    assert!(!said.contains("  minimum_web  "), "only defaults are listed: {said}");
    let folder = scr("check-fails", "spool_diameter = \"4 mm\"");
    let run = folder.run("check scr.toml");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""));
    assert!(
        run.stdout.contains("FAILS  spool             spool of 4 mm on a shaft of 5 mm"),
        "{}",
        run.stdout
    );
    assert_eq!(folder.files(), ["scr.toml"]);
}
