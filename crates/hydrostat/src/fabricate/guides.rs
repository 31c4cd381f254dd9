//! Guides: where they sit, and each as a part.

use super::lettering;
use super::part::{Group, Part};
use super::workshop::Workshop;
use crate::Error;
use crate::model::{CrossSection, Robot};
use crate::planar::{Contour, Point, direction};
use std::f64::consts::TAU;

const MM: f64 = 1e-3;
/// Of the numbers on the guides, where there is room.
const LETTERS: f64 = 2.5 * MM;
const SMALLEST_LETTERS: f64 = 0.8 * MM;
/// Of the mark that shows the angle 0.
const MARK: f64 = 2.0 * MM;
/// Of material outside the outermost hole, where the file gives no diameter.
const RIM: f64 = 4.0 * MM;
/// Arc lengths nearer than this part of the length are one place.
const SAME: f64 = 1e-9;

/// A guide of the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    /// From 1 at the base.
    pub number: usize,
    /// Index of its section.
    pub section: usize,
    /// Arc length of its middle.
    pub s: f64,
    pub radius: f64,
    pub holes: Vec<TendonHole>,
    pub part: Part,
}

/// Where a tendon passes a guide, or is tied to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonHole {
    /// Index of the tendon.
    pub tendon: usize,
    /// Along d1 and d2.
    pub center: Point,
    pub ends: bool,
}

/// All guides from base to tip: those of the sections, and one at every section's tip where a tendon ends.
///
/// # Errors
/// A robot without tendons or guides, or a rod that no hole can hold.
pub(super) fn guides(robot: &Robot, workshop: &Workshop) -> Result<Vec<Guide>, Error> {
    let places = places(robot);
    if robot.tendons.is_empty() || places.is_empty() {
        let lacks = if robot.tendons.is_empty() { "tendons" } else { "guides" };
        return Err(Error::new(format!("the robot \"{}\" has no {lacks}, so there is no kit to make", robot.name))
            .hint("add [[tendon]] and guides = { spacing = \"10 mm\" }; `hydrostat new tendon NAME` writes such a robot"));
    }
    places
        .into_iter()
        .enumerate()
        .map(|(i, (section, s))| guide(robot, workshop, i + 1, section, s))
        .collect()
}

/// Section and arc length of each guide.
fn places(robot: &Robot) -> Vec<(usize, f64)> {
    let (mut places, mut start) = (Vec::new(), 0.0);
    let same = SAME * robot.length();
    for (i, section) in robot.sections.iter().enumerate() {
        let positions = section.guides.iter().flat_map(|guides| &guides.positions);
        places.extend(positions.map(|position| (i, start + position)));
        start += section.length;
        if robot.tendons.iter().any(|tendon| tendon.ends == i) {
            places.push((i, start));
        }
    }
    places.retain(|(_, s)| *s > same); // the base's own plate is there
    places.sort_by(|a, b| a.1.total_cmp(&b.1));
    places.dedup_by(|later, kept| later.1 - kept.1 <= same);
    places
}

fn guide(robot: &Robot, workshop: &Workshop, number: usize, section: usize, s: f64) -> Result<Guide, Error> {
    let holes = tendon_holes(robot, s);
    let given = robot.sections[section].guides.as_ref().and_then(|guides| guides.radius);
    let outermost = holes.iter().map(|hole| hole.center.norm()).fold(0.0, f64::max);
    let radius = given.unwrap_or(outermost + 0.5 * workshop.tendon_hole() + RIM);
    let name = format!("guide-{number:02}");
    let title = format!("guide {number}, {} at s = {:.1} mm", robot.sections[section].name, s / MM);
    let mut part = Part::new(name, title, Group::Guides, Contour::circle(Point::zeros(), radius));
    part.holes.push(rod_hole(robot, workshop, section, s)?);
    let hole = |hole: &TendonHole| Contour::circle(hole.center, 0.5 * workshop.tendon_hole());
    part.holes.extend(holes.iter().map(hole));
    mark(&mut part, radius);
    number_it(&mut part, number, radius);
    Ok(Guide { number, section, s, radius, holes, part })
}

/// The tendons that pass at `s` or end there.
pub(super) fn tendon_holes(robot: &Robot, s: f64) -> Vec<TendonHole> {
    let same = SAME * robot.length();
    let hole = |(i, tendon): (usize, &crate::model::Tendon)| {
        let end = robot.tendon_end(tendon);
        let center = tendon.path.hole((s / end).min(1.0), end).0.xy();
        (s <= end + same).then_some(TendonHole { tendon: i, center, ends: (s - end).abs() <= same })
    };
    robot.tendons.iter().enumerate().filter_map(hole).collect()
}

/// The hole that holds the rod by its press fit.
///
/// # Errors
/// Nothing is left of the hole.
pub(super) fn rod_hole(robot: &Robot, workshop: &Workshop, section: usize, s: f64) -> Result<Contour, Error> {
    let start: f64 = robot.sections[..section].iter().map(|section| section.length).sum();
    let of = &robot.sections[section];
    let fraction = ((s - start) / of.length).clamp(0.0, 1.0);
    let (size, hole) = match of.cross_section(fraction) {
        CrossSection::Round { diameter } | CrossSection::Tube { diameter, .. } => {
            let hole = Contour::circle(Point::zeros(), 0.5 * (diameter - workshop.press_fit));
            (diameter, hole)
        }
        CrossSection::Strip { width, height } => {
            let size = Point::new(width, height).add_scalar(-workshop.press_fit);
            (width.min(height), Contour::rectangle(Point::zeros(), size))
        }
    };
    if size <= workshop.press_fit + workshop.kerf {
        let (mm, kerf, fit) = (size / MM, workshop.kerf / MM, workshop.press_fit / MM);
        return Err(Error::new(format!(
            "rod and hole: at s = {:.1} mm the rod is {mm:.3} mm thick, and the hole that holds it would be {:.3} mm, which a kerf of {kerf:.3} mm cannot cut",
            s / MM,
            mm - fit
        ))
        .hint(format!("press_fit is {fit:.3} mm; 0.02 to 0.1 mm holds a rod of 1 to 3 mm")));
    }
    Ok(hole)
}

/// A short line at angle 0 from the rim inwards, as far as the holes let it.
fn mark(part: &mut Part, radius: f64) {
    let tip = |length: f64| Point::new(radius - length, 0.0);
    let free = |length: &f64| {
        let end = Contour::circle(tip(*length), 0.1 * MM);
        part.holes.iter().all(|hole| hole.gap(&end) > 0.1 * MM && !hole.contains(tip(*length)))
    };
    let length = [1.0, 0.75, 0.5, 0.25].map(|part| part * MARK).into_iter().find(free).unwrap_or(0.1 * MM);
    part.scores.push(vec![tip(length), Point::new(radius, 0.0)]);
}

/// Puts the number where it is farthest from holes and rim.
fn number_it(part: &mut Part, number: usize, radius: f64) {
    let text = number.to_string();
    let candidates =
        (1..24).flat_map(|i| (0..72).map(move |j| (f64::from(i) / 24.0, TAU * f64::from(j) / 72.0)));
    let room = |p: Point| {
        let holes = part.holes.iter().map(|hole| match hole {
            Contour::Circle { center, radius } => (p - center).norm() - radius,
            Contour::Polygon(_) => hole.gap(&Contour::circle(p, 0.01 * MM)),
        });
        let mark = (p.x - (radius - MARK)).max(0.0).hypot(p.y);
        holes.chain([radius - p.norm(), mark]).fold(f64::INFINITY, f64::min)
    };
    let places = candidates.map(|(part, angle)| part * radius * direction(angle));
    // near ties go to the first, so that one number more does not move it
    let better = |(best, most): (Point, f64), p: Point| {
        let here = room(p);
        if here > most + 1e-9 { (p, here) } else { (best, most) }
    };
    let (place, room) = places.fold((Point::zeros(), 0.0), better);
    let half = |height: f64| 0.5 * lettering::width(&text, height).hypot(height);
    let fits = LETTERS.min(LETTERS * 0.9 * room / half(LETTERS));
    if fits >= SMALLEST_LETTERS {
        part.engrave(&text, place, fits);
    }
}
