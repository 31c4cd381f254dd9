//! A small test piece that tells kerf, press fit and slot clearance before acrylic is cut for real.

use super::part::{Group, Part};
use super::workshop::Workshop;
use crate::Robot;
use crate::planar::{Contour, Point};

const MM: f64 = 1e-3;
/// Cuts of the kerf window: its two ends and the lines between its strips.
pub const KERF_CUTS: usize = 11;
/// Length of the window.
pub const KERF_WINDOW: f64 = 100.0 * MM;
const STRIP: f64 = 15.0 * MM;
const LETTERS: f64 = 2.2 * MM;
/// Diameters of the press-fit holes and widths of the slots, against rod and sheet, in 1/100 mm.
pub const FITS: [f64; 7] = [-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0];
const SLOT: f64 = 12.0 * MM;

/// Slots and holes are cut with the kerf of the file; the strips tell what it really is: pushed together they leave a gap of
/// [`KERF_CUTS`] kerfs in their window, as every cut takes one.
pub(super) fn coupon(robot: &Robot, workshop: &Workshop) -> Part {
    let size = Point::new(KERF_WINDOW + 20.0 * MM, 72.0 * MM);
    let outline = Contour::rectangle(0.5 * size, size);
    let mut part =
        Part::new("coupon", "coupon: tells kerf, press fit and slot clearance", Group::Coupon, outline);
    strips(&mut part, Point::new(10.0 * MM, size.y - 10.0 * MM - STRIP));
    part.engrave("KERF = GAP / 11", Point::new(0.5 * size.x, size.y - 5.0 * MM), LETTERS);
    let rod = robot.sections[0].cross_section(0.0).thickness();
    part.engrave("ROD HOLES (MM)", Point::new(0.5 * size.x, 42.0 * MM), LETTERS);
    part.engrave("SHEET SLOTS (MM)", Point::new(0.5 * size.x, 27.0 * MM), LETTERS);
    for (i, fit) in FITS.iter().enumerate() {
        let x = 0.5 * size.x + (i as f64 - 3.0) * 15.0 * MM;
        let fit = fit / 100.0 * MM;
        if rod + fit > workshop.kerf {
            part.holes.push(Contour::circle(Point::new(x, 37.5 * MM), 0.5 * (rod + fit)));
            part.engrave(&format!("{:.3}", (rod + fit) / MM), Point::new(x, 32.5 * MM), LETTERS);
        }
        let slot = Point::new(workshop.sheet_thickness + fit, SLOT);
        part.holes.push(Contour::rectangle(Point::new(x, 17.0 * MM), slot));
        part.engrave(&format!("{:.3}", slot.x / MM), Point::new(x, 7.0 * MM), LETTERS);
    }
    part
}

/// A window cut along its line, and the lines that part its strips; they do not touch it, so that no cut is made twice.
fn strips(part: &mut Part, corner: Point) {
    let point = |x: f64, y: f64| corner + Point::new(x, y);
    let width = KERF_WINDOW / (KERF_CUTS - 1) as f64;
    let frame = [point(0.0, 0.0), point(KERF_WINDOW, 0.0), point(KERF_WINDOW, STRIP), point(0.0, STRIP)];
    part.slits.extend((0..4).map(|i| [frame[i], frame[(i + 1) % 4]]));
    for i in 1..KERF_CUTS - 1 {
        let x = i as f64 * width;
        part.slits.push([point(x, 0.0), point(x, STRIP)]);
    }
}
