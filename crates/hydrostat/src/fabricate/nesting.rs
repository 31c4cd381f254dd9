//! Parts on sheets: rows from the lower edge, the tallest first, each part with its longer side along the row.

use super::part::{Group, Part};
use super::workshop::Workshop;
use crate::planar::Point;

/// For the line of text that states thickness and kerf.
const LABEL: f64 = 8e-3;

/// A sheet to be cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// As its files are called.
    pub name: String,
    pub size: [f64; 2],
    pub placed: Vec<OnSheet>,
    /// Whether there is room for a label below the parts.
    pub labelled: bool,
}

/// A part on a sheet: turned to the left by quarters, then shifted.
#[derive(Clone, Debug, PartialEq)]
pub struct OnSheet {
    /// Index among the kit's parts.
    pub part: usize,
    pub quarter_turns: usize,
    pub shift: Point,
}

/// Whether a part fills a sheet, so that the sheet's own edge is its outline.
pub fn fills_sheet(part: &Part, workshop: &Workshop) -> bool {
    let (size, [w, h]) = (part.bounds().size(), workshop.sheet_size);
    let same = |a: f64, b: f64| (a - b).abs() < 1e-6;
    (same(size.x, w) && same(size.y, h)) || (same(size.x, h) && same(size.y, w))
}

/// Room for parts on a sheet: width and height.
pub(super) fn room(workshop: &Workshop) -> [f64; 2] {
    let [w, h] = workshop.sheet_size;
    let edges = 2.0 * workshop.part_spacing;
    [w - edges, h - edges - LABEL]
}

/// Whether it can be cut from a sheet.
pub(super) fn fits(part: &Part, workshop: &Workshop) -> bool {
    let size = part.bounds().size().add_scalar(workshop.kerf);
    let [w, h] = room(workshop);
    fills_sheet(part, workshop) || (size.x <= w && size.y <= h) || (size.y <= w && size.x <= h)
}

/// Every part as often as it is needed, sheets per group; parts that [`fits`] refuses must not be there.
pub(super) fn nest(parts: &[Part], workshop: &Workshop) -> Vec<Sheet> {
    let mut sheets = Vec::new();
    for group in Group::ALL {
        let of_group = |i: &usize| parts[*i].group == group;
        let (whole, small): (Vec<usize>, Vec<usize>) =
            (0..parts.len()).filter(of_group).partition(|&i| fills_sheet(&parts[i], workshop));
        let mut of_this = shelves(parts, &small, workshop);
        for part in whole {
            of_this.extend((0..parts[part].count).map(|_| filled(parts, part, workshop)));
        }
        let several = of_this.len() > 1;
        for (i, sheet) in of_this.iter_mut().enumerate() {
            let number = if several { format!("-{}", i + 1) } else { String::new() };
            sheet.name = format!("{}{number}", group.name());
        }
        sheets.extend(of_this);
    }
    sheets
}

fn filled(parts: &[Part], part: usize, workshop: &Workshop) -> Sheet {
    let bounds = parts[part].bounds();
    let quarter_turns = usize::from((bounds.size().x - workshop.sheet_size[0]).abs() > 1e-6);
    let low = if quarter_turns == 1 { Point::new(-bounds.high.y, bounds.low.x) } else { bounds.low };
    let placed = vec![OnSheet { part, quarter_turns, shift: -low }];
    Sheet { name: String::new(), size: workshop.sheet_size, placed, labelled: false }
}

fn shelves(parts: &[Part], chosen: &[usize], workshop: &Workshop) -> Vec<Sheet> {
    let gap = workshop.part_spacing + workshop.kerf;
    let [room_x, room_y] = room(workshop);
    let edge = Point::new(workshop.part_spacing, workshop.part_spacing + LABEL);
    // lying: the longer side along the row, where it fits
    let lying = |i: &usize| {
        let size = parts[*i].bounds().size().add_scalar(workshop.kerf);
        let turned = (size.y > size.x && size.y <= room_x) || size.x > room_x || size.y > room_y;
        let size = if turned { Point::new(size.y, size.x) } else { size };
        (*i, usize::from(turned), size)
    };
    let mut items: Vec<_> =
        chosen.iter().map(lying).flat_map(|item| vec![item; parts[item.0].count]).collect();
    items.sort_by(|a, b| b.2.y.total_cmp(&a.2.y)); // stable: the same input, the same sheet
    let mut sheets: Vec<Sheet> = Vec::new();
    let (mut cursor, mut row, mut row_height) = (f64::INFINITY, f64::INFINITY, 0.0);
    for (part, quarter_turns, size) in items {
        if cursor + size.x > room_x + 1e-9 {
            (row, cursor) = (row + row_height + gap, 0.0);
            row_height = size.y;
        }
        if row + size.y > room_y + 1e-9 {
            sheets.push(Sheet {
                name: String::new(),
                size: workshop.sheet_size,
                placed: Vec::new(),
                labelled: true,
            });
            (row, cursor, row_height) = (0.0, 0.0, size.y);
        }
        let bounds = parts[part].bounds();
        let low = if quarter_turns == 1 { Point::new(-bounds.high.y, bounds.low.x) } else { bounds.low };
        let corner = edge + Point::new(cursor, row).add_scalar(0.5 * workshop.kerf);
        let sheet = sheets.last_mut().expect("one was begun");
        sheet.placed.push(OnSheet { part, quarter_turns, shift: corner - low });
        cursor += size.x + gap;
    }
    sheets
}
