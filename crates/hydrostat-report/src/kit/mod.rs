//! The files of a kit: drawings, solids, tables and the assembly guide, as bytes with their paths.

mod dxf;
mod figure;
mod guide;
mod solid;
mod steps;
mod svg;
mod tables;

use hydrostat::Robot;
use hydrostat::fabricate::{Group, Kit, Workshop, cut_part, cut_sheet};

const MM: f64 = 1e3;

/// A file of the kit.
#[derive(Clone, Debug, PartialEq)]
pub struct KitFile {
    /// Below the kit's folder, parts joined by `/`.
    pub path: String,
    pub bytes: Vec<u8>,
}

/// Every file, in a fixed order; the same kit gives the same bytes.
pub fn kit_files(robot: &Robot, workshop: &Workshop, kit: &Kit, source: &str) -> Vec<KitFile> {
    let mut files = Vec::new();
    let mut add = |path: String, bytes: Vec<u8>| files.push(KitFile { path, bytes });
    add("index.html".to_owned(), guide::page(robot, workshop, kit, source).into_bytes());
    for (name, table) in tables::tables(workshop, kit) {
        add(name.to_owned(), table.into_bytes());
    }
    for sheet in &kit.sheets {
        let cut = cut_sheet(kit, sheet, workshop);
        add(format!("sheets/{}.dxf", sheet.name), dxf::dxf(&cut).into_bytes());
        add(format!("sheets/{}.svg", sheet.name), svg::svg(&cut).into_bytes());
    }
    for part in &kit.parts {
        let cut = cut_part(part, workshop);
        add(format!("parts/{}.dxf", part.name), dxf::dxf(&cut).into_bytes());
        add(format!("parts/{}.svg", part.name), svg::svg(&cut).into_bytes());
    }
    // a grid of lines and a test piece of the laser are nothing to print
    let printed = kit.parts.iter().filter(|part| part.group != Group::Coupon && part.name != "grid");
    for part in printed {
        add(format!("solids/{}.stl", part.name), solid::stl(part, workshop.sheet_thickness));
    }
    files
}

/// Millimetres with at most so many decimals, no zeros at the end, no minus zero.
fn decimal(metres: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", metres * MM);
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
