//! The way of the laser: contours moved by half a kerf, once, and everything else along its line.

use super::nesting::{Sheet, fills_sheet};
use super::part::Part;
use super::workshop::{Workshop, short};
use super::{Kit, lettering};
use crate::planar::{Contour, Point};

const MM: f64 = 1e-3;
const LABEL_LETTERS: f64 = 3.0 * MM;

/// What a drawing holds, m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cut {
    pub cuts: Vec<Contour>,
    /// Open cuts.
    pub slits: Vec<[Point; 2]>,
    pub scores: Vec<Vec<Point>>,
    pub engravings: Vec<Vec<Point>>,
    /// Closed engraved lines around areas.
    pub pockets: Vec<Contour>,
    /// Thickness and kerf in words.
    pub note: String,
    /// Lower left and upper right corner of what it shows.
    pub size: [f64; 2],
}

/// One part with its lower left corner near the origin.
pub fn cut_part(part: &Part, workshop: &Workshop) -> Cut {
    let mut cut = Cut { note: note(workshop), ..Cut::default() };
    let bounds = part.bounds();
    let margin = Point::repeat(workshop.kerf);
    add(&mut cut, part, workshop, 0, margin - bounds.low);
    let size = bounds.size() + 2.0 * margin;
    cut.size = [size.x, size.y];
    cut
}

/// A sheet with all its parts and a line that states thickness and kerf.
pub fn cut_sheet(kit: &Kit, sheet: &Sheet, workshop: &Workshop) -> Cut {
    let mut cut = Cut { note: note(workshop), size: sheet.size, ..Cut::default() };
    for on in &sheet.placed {
        add(&mut cut, &kit.parts[on.part], workshop, on.quarter_turns, on.shift);
    }
    let text = format!("{}: {}", sheet.name, cut.note).to_uppercase();
    let room = sheet.size[0] - 2.0 * workshop.part_spacing;
    let height = LABEL_LETTERS.min(LABEL_LETTERS * room / lettering::width(&text, LABEL_LETTERS));
    if sheet.labelled {
        let width = lettering::width(&text, height);
        let center =
            Point::new(workshop.part_spacing + 0.5 * width, workshop.part_spacing + 0.5 * LABEL_LETTERS);
        cut.engravings.extend(lettering::letters(&text, center, height));
    }
    cut
}

fn note(workshop: &Workshop) -> String {
    format!(
        "sheet {} mm, kerf {} mm allowed for: lines are {} mm outside what stays",
        short(workshop.sheet_thickness / MM),
        short(workshop.kerf / MM),
        short(0.5 * workshop.kerf / MM)
    )
}

fn add(cut: &mut Cut, part: &Part, workshop: &Workshop, quarter_turns: usize, shift: Point) {
    let half = 0.5 * workshop.kerf;
    let put = |point: &Point| {
        let turned = (0..quarter_turns % 4).fold(*point, |p, _| Point::new(-p.y, p.x));
        turned + shift
    };
    let strokes = |lines: &[Vec<Point>]| -> Vec<Vec<Point>> {
        lines.iter().map(|line| line.iter().map(put).collect()).collect()
    };
    if !fills_sheet(part, workshop) {
        cut.cuts.extend(part.outline.offset(half).map(|outline| outline.moved(quarter_turns, shift)));
    }
    let holes = part.holes.iter().filter_map(|hole| hole.offset(-half));
    cut.cuts.extend(holes.map(|hole| hole.moved(quarter_turns, shift)));
    cut.slits.extend(part.slits.iter().map(|[a, b]| [put(a), put(b)]));
    cut.pockets.extend(part.pockets.iter().map(|(pocket, _)| pocket.moved(quarter_turns, shift)));
    cut.scores.extend(strokes(&part.scores));
    cut.engravings.extend(strokes(&part.engravings));
}
