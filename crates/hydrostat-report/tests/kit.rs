//! The files of a kit: well-formed, complete, and solids that close.

use hydrostat::description::parse_workshop;
use hydrostat::fabricate::{Kit, Workshop, kit};
use hydrostat_report::{KitFile, kit_files};
use std::collections::{BTreeMap, BTreeSet};

const ROBOTS: [&str; 2] =
    [include_str!("../../../robots/scr.toml"), include_str!("../../../robots/scr_two_section.toml")];

fn kits() -> Vec<(Workshop, Kit, Vec<KitFile>)> {
    let make = |text| {
        let (robot, workshop) = parse_workshop(text, "robot.toml").expect("is valid").value;
        let kit = kit(&robot, &workshop).expect("can be built");
        let files = kit_files(&robot, &workshop, &kit, "robot.toml");
        (workshop, kit, files)
    };
    ROBOTS.map(make).into()
}

fn text(file: &KitFile) -> &str {
    std::str::from_utf8(&file.bytes).expect("is text")
}

#[test]
fn texts_have_no_number_that_is_none() {
    for (_, _, files) in kits() {
        for file in files.iter().filter(|file| !file.path.ends_with(".stl")) {
            for word in ["NaN", "inf\n", "inf ", "inf,"] {
                assert!(!text(file).contains(word), "{} has {word}", file.path);
            }
        }
    }
}

#[test]
fn drawings_are_xml_in_millimetres() {
    for (_, _, files) in kits() {
        for file in files.iter().filter(|file| file.path.ends_with(".svg")) {
            let document = roxmltree::Document::parse(text(file)).expect("is XML");
            let root = document.root_element();
            let [width, height] = ["width", "height"].map(|side| root.attribute(side).expect("has a size"));
            let size = format!("0 0 {} {}", width.trim_end_matches("mm"), height.trim_end_matches("mm"));
            assert_eq!(root.attribute("viewBox"), Some(size.as_str()), "{}", file.path);
            assert!(width.ends_with("mm") && height.ends_with("mm"));
            let layers: Vec<_> = root.children().filter_map(|child| child.attribute("id")).collect();
            assert!(layers.iter().all(|layer| ["ENGRAVE", "SCORE", "CUT"].contains(layer)), "{layers:?}");
            let described =
                root.descendants().find(|node| node.has_tag_name("desc")).and_then(|node| node.text());
            assert!(described.expect("is described").contains("kerf 0.15 mm"));
        }
        let page = files.iter().find(|file| file.path == "index.html").expect("there is a guide");
        let drawings = text(page).match_indices("<svg");
        let drawings: Vec<&str> =
            drawings.filter_map(|(at, _)| text(page)[at..].split_inclusive("</svg>").next()).collect();
        assert!(drawings.len() >= 12, "{} drawings", drawings.len());
        for drawing in drawings {
            roxmltree::Document::parse(drawing).expect("is XML");
        }
    }
}

/// Pairs of group code and value; every handle once.
#[test]
fn dxf_files_are_pairs_with_their_own_handles() {
    for (_, kit, files) in kits() {
        let mut count = 0;
        for file in files.iter().filter(|file| file.path.ends_with(".dxf")) {
            let lines: Vec<&str> = text(file).lines().collect();
            assert_eq!(lines.len() % 2, 0, "{}", file.path);
            let mut handles = BTreeSet::new();
            let mut seed = false;
            for pair in lines.chunks_exact(2) {
                let code: u16 = pair[0].parse().expect("a group code");
                if (code == 5 && !seed) || code == 105 {
                    assert!(handles.insert(pair[1]), "{} twice in {}", pair[1], file.path);
                }
                seed = pair[1] == "$HANDSEED"; // the next free one
            }
            assert!(lines.ends_with(&["0", "EOF"]));
            count += 1;
        }
        assert_eq!(count, kit.parts.len() + kit.sheets.len());
    }
}

/// Each directed edge meets its reverse once, and the volume is that of the part.
#[test]
fn solids_close() {
    for (workshop, kit, files) in kits() {
        for part in &kit.parts {
            let path = format!("solids/{}.stl", part.name);
            let Some(file) = files.iter().find(|file| file.path == path) else { continue };
            let triangles = triangles(&file.bytes);
            let mut edges: BTreeMap<_, i32> = BTreeMap::new();
            let mut volume = 0.0;
            for [a, b, c] in &triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((from.map(f32::to_bits), to.map(f32::to_bits))).or_default() += 1;
                }
                let [a, b, c] = [a, b, c].map(|p| nalgebra::Vector3::from(p.map(f64::from)));
                volume += a.dot(&b.cross(&c)) / 6.0;
            }
            for ((from, to), count) in &edges {
                assert_eq!((*count, edges.get(&(*to, *from))), (1, Some(&1)), "{path}");
            }
            if part.pockets.is_empty() {
                let expected = part.area() * workshop.sheet_thickness * 1e9;
                // facets lie within 1e-4 of an arc's radius
                assert!((volume / expected - 1.0).abs() < 5e-4, "{path}: {volume} {expected}");
            }
        }
    }
}

fn triangles(stl: &[u8]) -> Vec<[[f32; 3]; 3]> {
    let number = |at: usize| f32::from_le_bytes(stl[at..at + 4].try_into().expect("four bytes"));
    let count = u32::from_le_bytes(stl[80..84].try_into().expect("four bytes")) as usize;
    assert_eq!(stl.len(), 84 + 50 * count);
    let corner = |at: usize| [0, 4, 8].map(|offset| number(at + offset));
    (0..count).map(|i| [12, 24, 36].map(|offset| corner(84 + 50 * i + offset))).collect()
}
