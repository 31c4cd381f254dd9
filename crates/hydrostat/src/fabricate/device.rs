//! The assembly device: two combs that hold every guide at its place on the rod, upright in plates across them.
//!
//! Axes of a comb: x along the backbone, y up from the table. Across: x from the rod, y up.

use super::guides::Guide;
use super::part::{Group, Part};
use super::workshop::{Workshop, short};
use crate::planar::{Contour, Point};
use crate::{Error, Robot};

const MM: f64 = 1e-3;
/// Under the lowest guide.
const FLOOR: f64 = 8.0 * MM;
/// Beyond the robot's ends, for the plates across.
const END: f64 = 15.0 * MM;
/// Of the combs from the rod, and of their upper edge below it, as parts of the smallest guide's radius.
const BESIDE: f64 = 0.55;
const BELOW: f64 = 0.25;
const LETTERS: f64 = 2.0 * MM;
/// Of the hole and slots that rod and tendon pass freely.
const FREE: f64 = 0.5 * MM;

/// One piece of each comb.
#[derive(Clone, Debug, PartialEq)]
pub struct Comb {
    /// Arc lengths that it covers.
    pub from: f64,
    pub to: f64,
    /// Arc length at its left edge.
    pub starts: f64,
    /// Arc lengths of the plates across it.
    pub across: Vec<f64>,
    /// Arc lengths of its slots.
    pub slots: Vec<f64>,
}

/// The device.
#[derive(Clone, Debug, PartialEq)]
pub struct Device {
    pub combs: Vec<Comb>,
    /// Of the rod above the table.
    pub axis_height: f64,
    pub comb_height: f64,
    /// Of the combs' middles from the rod.
    pub beside: f64,
    /// Index of the tendon whose holes a taut wire aligns, at the top.
    pub aligned: usize,
    pub parts: Vec<Part>,
}

/// # Errors
/// Guides too small or too near each other to be held.
pub(super) fn device(robot: &Robot, workshop: &Workshop, guides: &[Guide]) -> Result<Device, Error> {
    let (t, slot) = (workshop.sheet_thickness, workshop.sheet_thickness + workshop.slot_clearance);
    let largest = guides.iter().map(|guide| guide.radius).fold(0.0, f64::max);
    let smallest = guides.iter().map(|guide| guide.radius).fold(f64::INFINITY, f64::min);
    let beside = BESIDE * smallest;
    let rod = robot.sections.iter().map(|section| section.cross_section(0.0).thickness()).fold(0.0, f64::max);
    if beside - 0.5 * slot < 0.5 * rod + FREE + 2.0 * workshop.minimum_web {
        return Err(Error::new(format!(
            "guide size: guides of {} mm are too small for two combs of {} mm beside a rod of {} mm",
            short(2.0 * smallest / MM),
            short(t / MM),
            short(rod / MM)
        ))
        .hint("make the guides larger or take a thinner sheet"));
    }
    for pair in guides.windows(2) {
        let apart = pair[1].s - pair[0].s;
        if apart < slot + workshop.minimum_web {
            return Err(Error::new(format!(
                "guide spacing: guides {} and {} are {} mm apart, less than the sheet of {} mm with its clearance and a tooth of {} mm",
                pair[0].number, pair[1].number, short(apart / MM), short(t / MM), short(workshop.minimum_web / MM)
            ))
            .hint("space the guides wider or take a thinner sheet"));
        }
    }
    let aligned = aligned(robot, guides);
    let axis_height = FLOOR + largest;
    let comb_height = axis_height - BELOW * smallest;
    let mut device = Device {
        combs: combs(robot, workshop, guides),
        axis_height,
        comb_height,
        beside,
        aligned,
        parts: Vec::new(),
    };
    for (i, comb) in device.combs.iter().enumerate() {
        let part = comb_part(workshop, guides, &device, comb, i + 1, robot.length());
        device.parts.push(part);
    }
    let cradle = cradle(robot, workshop, &device, rod, largest);
    device.parts.push(cradle);
    Ok(device)
}

/// The first tendon that is parallel to the rod and passes every guide; else the first that passes them.
fn aligned(robot: &Robot, guides: &[Guide]) -> usize {
    let mut passing = guides.last().into_iter().flat_map(|guide| &guide.holes).map(|hole| hole.tendon);
    let first = passing.clone().next().unwrap_or(0);
    passing.find(|&tendon| parallel(robot, tendon)).unwrap_or(first)
}

/// Whether a wire through its holes is straight and parallel to the rod.
pub(super) fn parallel(robot: &Robot, tendon: usize) -> bool {
    let path = &robot.tendons[tendon].path;
    path.turns == 0.0 && path.radius == path.tip_radius
}

/// As few pieces as the sheet's width allows, cut in the middle between guides.
fn combs(robot: &Robot, workshop: &Workshop, guides: &[Guide]) -> Vec<Comb> {
    let length = robot.length();
    let longest =
        workshop.sheet_size[0].max(workshop.sheet_size[1]) - 2.0 * workshop.part_spacing - 2.0 * END;
    let pieces = (length / longest).ceil().max(1.0) as usize;
    let gaps: Vec<f64> = guides.windows(2).map(|pair| 0.5 * (pair[0].s + pair[1].s)).collect();
    let mut cuts = vec![0.0];
    for i in 1..pieces {
        let ideal = length * i as f64 / pieces as f64;
        let nearest = gaps.iter().copied().min_by(|a, b| (a - ideal).abs().total_cmp(&(b - ideal).abs()));
        cuts.extend(nearest.filter(|cut| cuts.last().is_some_and(|last| cut > last)));
    }
    cuts.push(length);
    let piece = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        let inside: Vec<f64> = gaps.iter().copied().filter(|gap| *gap > from && *gap < to).collect();
        let first = if from == 0.0 { Some(-0.5 * END) } else { inside.first().copied() };
        let last = if to == length { Some(length + 0.5 * END) } else { inside.last().copied() };
        Comb {
            from,
            to,
            starts: if from == 0.0 { -END } else { from },
            across: first.into_iter().chain(last).collect(),
            slots: guides.iter().map(|guide| guide.s).filter(|s| (from..=to).contains(s)).collect(),
        }
    };
    cuts.windows(2).map(piece).collect()
}

fn comb_part(
    workshop: &Workshop,
    guides: &[Guide],
    device: &Device,
    comb: &Comb,
    number: usize,
    length: f64,
) -> Part {
    let slot = workshop.sheet_thickness + workshop.slot_clearance;
    let ends = if comb.to == length { comb.to + END } else { comb.to };
    let (height, x) = (device.comb_height, |s: f64| s - comb.starts);
    // along the table, with notches from below, then back with the guides' slots
    let mut corners = vec![Point::new(0.0, 0.0)];
    for at in comb.across.iter().map(|s| x(*s)) {
        let [left, right] = [at - 0.5 * slot, at + 0.5 * slot];
        let half = 0.5 * height;
        corners
            .extend([(left, 0.0), (left, half), (right, half), (right, 0.0)].map(|(x, y)| Point::new(x, y)));
    }
    corners.extend([Point::new(x(ends), 0.0), Point::new(x(ends), height)]);
    let held = |s: f64| guides.iter().find(|guide| guide.s == s).map_or(0.0, |guide| guide.radius);
    for s in comb.slots.iter().rev() {
        let [left, right] = [x(*s) - 0.5 * slot, x(*s) + 0.5 * slot];
        let bottom = bottom(workshop, device, held(*s));
        corners.extend(
            [(right, height), (right, bottom), (left, bottom), (left, height)].map(|(x, y)| Point::new(x, y)),
        );
    }
    corners.push(Point::new(0.0, height));
    let title =
        format!("comb {number}: guides from s = {} to {} mm", short(comb.from / MM), short(comb.to / MM));
    let mut part = Part::new(format!("comb-{number}"), title, Group::Device, Contour::polygon(corners));
    part.count = 2;
    // distances under the slots, as far apart as their letters
    let mut last = f64::NEG_INFINITY;
    for s in &comb.slots {
        if s - last < 1.6 * LETTERS {
            continue;
        }
        last = *s;
        let low = bottom(workshop, device, held(*s));
        let text = short(s / MM);
        let width = super::lettering::width(&text, LETTERS);
        let clear = comb.across.iter().all(|across| (across - s).abs() > 0.5 * slot + LETTERS)
            || low - width > 0.5 * height + 2.0 * MM;
        if clear && low > width + 1.0 * MM {
            part.engrave_upright(&text, Point::new(x(*s), low - 0.5 * width - 0.8 * MM), LETTERS);
        }
    }
    if comb.from == 0.0 {
        part.scores.push(vec![Point::new(x(0.0), 0.5 * MM), Point::new(x(0.0), height - 0.5 * MM)]);
        part.engrave("0", Point::new(x(0.0) + 2.0 * MM, 2.5 * MM), 2.5 * MM);
    }
    if comb.to == length {
        part.engrave("TIP", Point::new(x(length) + 0.5 * END, 0.75 * height), 2.5 * MM);
    }
    part
}

/// Of a slot: a guide of this radius sits on the inner edges of both combs with its middle on the rod.
fn bottom(workshop: &Workshop, device: &Device, radius: f64) -> f64 {
    let inner = device.beside - 0.5 * workshop.sheet_thickness;
    device.axis_height - (radius.powi(2) - inner.powi(2)).sqrt()
}

/// A plate across both combs, with a hole for the rod and a slot from above for the wire that aligns the guides.
fn cradle(robot: &Robot, workshop: &Workshop, device: &Device, rod: f64, largest: f64) -> Part {
    let slot = workshop.sheet_thickness + workshop.slot_clearance;
    let path = &robot.tendons[device.aligned].path;
    let wire = 0.5 * workshop.tendon_hole();
    let bottom = device.axis_height + path.radius - wire;
    let top = device.axis_height + path.radius.max(0.5 * largest) + 6.0 * MM;
    let half = device.beside + 0.5 * slot + 10.0 * MM;
    let notch = |middle: f64, width: f64, bottom: f64| {
        [
            (middle + 0.5 * width, top),
            (middle + 0.5 * width, bottom),
            (middle - 0.5 * width, bottom),
            (middle - 0.5 * width, top),
        ]
    };
    let mut corners = vec![(-half, 0.0), (half, 0.0), (half, top)];
    corners.extend(notch(device.beside, slot, 0.5 * device.comb_height));
    corners.extend(notch(0.0, 2.0 * wire, bottom));
    corners.extend(notch(-device.beside, slot, 0.5 * device.comb_height));
    corners.push((-half, top));
    let outline = Contour::polygon(corners.into_iter().map(|(x, y)| Point::new(x, y)));
    let title = format!(
        "plate across the combs: rod through the hole, a wire through the holes of tendon {} in the slot",
        robot.tendons[device.aligned].name
    );
    let mut part = Part::new("cradle", title, Group::Device, outline);
    part.holes.push(Contour::circle(Point::new(0.0, device.axis_height), 0.5 * (rod + FREE)));
    part.engrave(
        &robot.tendons[device.aligned].name.to_uppercase(),
        Point::new(half - 5.0 * MM, 5.0 * MM),
        3.0 * MM,
    );
    part.count = device.combs.iter().map(|comb| comb.across.len()).sum();
    part
}
