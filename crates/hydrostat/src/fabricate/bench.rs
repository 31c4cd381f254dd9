//! The verification bench: a grid to read tips on, and clamps that hold a rod at 0, 30 and 60 degrees.

use super::lettering;
use super::part::{Group, Part};
use super::workshop::{Workshop, short};
use crate::Robot;
use crate::planar::{Contour, Point, direction};

const MM: f64 = 1e-3;
const FINE: f64 = 1.0 * MM;
/// Along the lower and left edge without fine lines, for the numbers.
const STRIP: f64 = 5.0 * MM;
/// Every so many lines is a heavy one, and every so many have a number beside them.
const HEAVY: usize = 10;
const NUMBERED: usize = 20;
const LETTERS: f64 = 3.0 * MM;
const NUMBERS: f64 = 2.4 * MM;
/// Puts letters of 3 mm, whose raster is 0.5 mm, between the fine lines.
const BETWEEN: f64 = 0.25 * MM;
/// Sets of holes for a clamp, one below the other.
const SETS: usize = 7;
const CLAMP: f64 = 40.0 * MM;
const CLAMP_HOLES: f64 = 30.0 * MM;
const ANGLES: [f64; 3] = [0.0, 30.0, 60.0];
/// Of the channel, as a part of the rod's thickness: the counterpart presses on the rest.
const CHANNEL: f64 = 0.8;

/// Grid, clamps with a channel, and their plain counterparts.
pub(super) fn bench(robot: &Robot, workshop: &Workshop) -> Vec<Part> {
    let mut parts = vec![grid(workshop)];
    let rod = robot.sections[0].cross_section(0.0).thickness();
    parts.extend(ANGLES.map(|angle| clamp(workshop, rod, angle)));
    let mut plain = clamp_plate(workshop, "clamp-plain", "counterpart of a clamp");
    plain.count = ANGLES.len();
    parts.push(plain);
    parts
}

fn clamp_holes(workshop: &Workshop, center: Point) -> [Contour; 4] {
    let half = 0.5 * CLAMP_HOLES;
    let radius = 0.5 * workshop.screw_hole(workshop.screw_diameter);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| Contour::circle(center + half * Point::new(x, y), radius))
}

fn clamp_plate(workshop: &Workshop, name: &str, title: &str) -> Part {
    let outline = Contour::rounded_rectangle(Point::zeros(), Point::repeat(CLAMP), 3.0 * MM);
    let mut part = Part::new(name, title, Group::Bench, outline);
    part.holes.extend(clamp_holes(workshop, Point::zeros()));
    part
}

fn clamp(workshop: &Workshop, rod: f64, degrees: f64) -> Part {
    let title = format!("clamp with a channel at {degrees} degrees, {} mm deep", short(CHANNEL * rod / MM));
    let mut part = clamp_plate(workshop, &format!("clamp-{degrees:02}"), &title);
    let (along, across) = (direction(degrees.to_radians()), direction((degrees + 90.0).to_radians()));
    // ends where the axis leaves the plate
    let reach = 0.5 * CLAMP / along.amax();
    let corner = |i: f64, j: f64| i * reach * along + j * 0.5 * rod * across;
    let channel =
        Contour::polygon([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    part.pockets.push((channel, CHANNEL * rod));
    part.engrave(&format!("{degrees} DEG"), Point::new(-8.0 * MM, 9.0 * MM), LETTERS); // clear of every channel
    part
}

/// Fine lines are scored, heavy ones engraved; the origin of the numbers is the lower left corner.
fn grid(workshop: &Workshop) -> Part {
    let [width, height] = workshop.bench_size;
    let outline = Contour::rectangle(0.5 * Point::new(width, height), Point::new(width, height));
    let mut part = Part::new("grid", "verification grid of 1 mm", Group::Bench, outline);
    for (length, other, point) in [
        (width, height, (|along, across| Point::new(along, across)) as fn(f64, f64) -> Point),
        (height, width, |along, across| Point::new(across, along)),
    ] {
        let count = (length / FINE - 1e-9).ceil() as usize;
        for i in 1..count {
            let at = i as f64 * FINE;
            if i % HEAVY == 0 {
                part.engravings.push(vec![point(at, 0.0), point(at, other)]);
            } else if at > STRIP {
                part.scores.push(vec![point(at, STRIP), point(at, other)]);
            }
        }
    }
    let numbers =
        |length: f64| (1..).map(|i| i * NUMBERED).take_while(move |i| *i as f64 * FINE < length - 10.0 * MM);
    // beside their line, not on it
    let beside = |i: usize| i as f64 * FINE + 0.5 * lettering::width(&i.to_string(), NUMBERS) + 0.6 * MM;
    for i in numbers(width) {
        part.engrave(&i.to_string(), Point::new(beside(i), 0.5 * STRIP), NUMBERS);
    }
    for i in numbers(height) {
        part.engrave_upright(&i.to_string(), Point::new(0.5 * STRIP, beside(i)), NUMBERS);
    }
    sets(workshop, &mut part);
    levels(&mut part);
    part
}

/// Seven sets of holes along the left edge, their middles on lines of 10 mm.
fn sets(workshop: &Workshop, part: &mut Part) {
    let [_, height] = workshop.bench_size;
    let margin = 0.5 * CLAMP + 10.0 * MM;
    let ten = HEAVY as f64 * FINE;
    let x = (margin / ten).round() * ten;
    for i in 0..SETS {
        let ideal = margin + (height - 2.0 * margin) * i as f64 / (SETS - 1) as f64;
        let y = (ideal / ten).round() * ten;
        part.holes.extend(clamp_holes(workshop, Point::new(x, y)));
        part.engrave(
            &(i + 1).to_string(),
            Point::new(x + 4.0 * MM, y + 4.5 * MM).add_scalar(BETWEEN),
            LETTERS,
        );
    }
}

/// Two marks on one height and two on one plumb line, to set the grid level.
fn levels(part: &mut Part) {
    let size = part.bounds().size();
    let (x, y) = (0.5 * size.x, 0.5 * size.y);
    let marks = [
        (Point::new(0.0, y), Point::new(5.0 * MM, 0.0)),
        (Point::new(size.x, y), Point::new(-5.0 * MM, 0.0)),
        (Point::new(x, 0.0), Point::new(0.0, 5.0 * MM)),
        (Point::new(x, size.y), Point::new(0.0, -5.0 * MM)),
    ];
    for (edge, inward) in marks {
        let across = 0.5 * Point::new(-inward.y, inward.x);
        part.engravings.push(vec![edge + inward + across, edge, edge + inward - across]);
    }
    let label = Point::new(((size.x - 16.0 * MM) / FINE).floor(), (y / FINE).floor() + 3.5) * FINE;
    part.engrave("LEVEL", label.add_scalar(BETWEEN), LETTERS);
}
