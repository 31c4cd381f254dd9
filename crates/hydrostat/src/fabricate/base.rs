//! The base: a box with the rod's clamp and the tendon holes in its front plate, idle pulleys and motors on the motor plate.
//!
//! Each tendon comes straight back from its hole, turns outwards over an idle pulley and runs onto the spool of its motor, all in
//! the plane of that spool. Axes: z along the backbone, x and y its d1 and d2, z = 0 on the motor plate.

use super::guides::{TendonHole, rod_hole, tendon_holes};
use super::part::{Group, Part, Placed, tabbed};
use super::workshop::Workshop;
use crate::planar::{Contour, Point, direction};
use crate::{Error, Robot};
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, TAU};

const MM: f64 = 1e-3;
/// Of a ball bearing with a groove, 3 x 12 x 4 mm.
const PULLEY_WIDTH: f64 = 4.0 * MM;
/// Of the pulley's flange over its groove, and of the spool's.
const PULLEY_FLANGE: f64 = 1.0 * MM;
pub(super) const SPOOL_FLANGE: f64 = 4.0 * MM;
/// Between turning parts and what stands.
const AIR: f64 = 2.0 * MM;
const WASHER: f64 = 0.5 * MM;
const TAB: f64 = 20.0 * MM;
const BRACKET: f64 = 12.0 * MM;
const BRACKET_TAB: f64 = 8.0 * MM;
const WIRING_HOLE: f64 = 15.0 * MM;
/// Under the motors, for their cables.
const CABLES: f64 = 12.0 * MM;
const LETTERS: f64 = 5.0 * MM;
/// Turns that stay on the spool.
const TURNS_KEPT: f64 = 3.0;
/// Steps of 1 mm by which motors may be moved out.
const FARTHEST: usize = 500;
/// For the knots at both ends.
const KNOTS: f64 = 150.0 * MM;

/// A place for a motor.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorPlace {
    /// The motor's axis in the program that moves it, and its number from 1.
    pub axis: char,
    /// Direction in which the tendon leaves, rad.
    pub angle: f64,
    /// Index of its tendon; None for a spare one.
    pub tendon: Option<usize>,
    /// Where the tendon comes down.
    pub tendon_at: Point,
    /// Center of the idle pulley, as seen along the backbone.
    pub pulley: Point,
    /// The motor's shaft.
    pub shaft: Point,
}

/// Sizes of the base, and its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    pub places: Vec<MotorPlace>,
    /// Inner side of the square box.
    pub side: f64,
    /// Of the whole box, front plate included.
    pub height: f64,
    /// From the motor plate to the front plate.
    pub gap: f64,
    /// Middle of the spools, and centers of the pulleys, above the motor plate.
    pub spool_height: f64,
    pub pulley_height: f64,
    /// Radius of a tendon around its pulley.
    pub pulley_radius: f64,
    /// Plates behind the front plate that hold the rod with it.
    pub clamp_plates: usize,
    /// From the front face into the box.
    pub rod_in_base: f64,
    pub parts: Vec<Part>,
    pub placed: Vec<Placed>,
}

impl Base {
    /// Length of a tendon from the front plate's face to where it meets the spool.
    pub(super) fn way_inside(&self, workshop: &Workshop, place: &MotorPlace) -> f64 {
        let out = direction(place.angle);
        let run = (place.shaft - place.pulley).dot(&out);
        workshop.sheet_thickness + self.gap - self.pulley_height + FRAC_PI_2 * self.pulley_radius + run
    }

    /// Length to cut for a tendon that is so long on the straight robot.
    pub(super) fn cut_length(&self, workshop: &Workshop, place: &MotorPlace, on_robot: f64) -> f64 {
        on_robot + self.way_inside(workshop, place) + TURNS_KEPT * workshop.circumference() + 2.0 * KNOTS
    }
}

/// Lays out the base and its parts.
///
/// # Errors
/// A rod that no hole can hold.
pub(super) fn base(robot: &Robot, workshop: &Workshop) -> Result<Base, Error> {
    let t = workshop.sheet_thickness;
    let pulley_radius = 0.5 * (workshop.pulley_diameter + workshop.tendon_diameter);
    let places = places(robot, workshop, pulley_radius);
    let spool_height = AIR + 1.5 * t;
    let pulley_height = (spool_height + pulley_radius).max(pulley_flange(workshop) + AIR);
    let clamp_plates = ((workshop.rod_grip / t - 1e-9).ceil() as usize).saturating_sub(1).max(1);
    let screw_ends = clamp_plates as f64 * t + 2.0 * workshop.screw_diameter;
    let top = (pulley_height + pulley_flange(workshop)).max(workshop.motor.frame.shaft_length - t);
    let gap = ((top + AIR + screw_ends) / MM).ceil() * MM;
    let half_motor = 0.5 * workshop.motor.frame.side;
    let reach = |place: &MotorPlace| {
        let (out, across) = (direction(place.angle), direction(place.angle + FRAC_PI_2));
        let corner = |i: f64, j: f64| (place.shaft + half_motor * (i * out + j * across)).amax();
        corner(1.0, 1.0).max(corner(1.0, -1.0)).max(corner(-1.0, 1.0)).max(corner(-1.0, -1.0))
    };
    let reach = places.iter().map(reach).fold(0.0, f64::max);
    let side = (2.0 * (reach + AIR) / MM).ceil() * MM;
    let below = t + workshop.motor.length + CABLES;
    let mut base = Base {
        places,
        side,
        height: below + gap + t,
        gap,
        spool_height,
        pulley_height,
        pulley_radius,
        clamp_plates,
        rod_in_base: t * (1 + clamp_plates) as f64,
        parts: Vec::new(),
        placed: Vec::new(),
    };
    front(robot, workshop, &mut base)?;
    motor_plate(workshop, &mut base);
    walls(workshop, &mut base, below);
    brackets(robot, workshop, &mut base);
    spools(workshop, &mut base);
    Ok(base)
}

fn pulley_flange(workshop: &Workshop) -> f64 {
    0.5 * workshop.pulley_diameter + PULLEY_FLANGE
}

/// Motors evenly around the backbone, the first where the first tendon is; each tendon takes the nearest that is free.
fn places(robot: &Robot, workshop: &Workshop, pulley_radius: f64) -> Vec<MotorPlace> {
    let tendons = tendon_holes(robot, 0.0);
    let spare = if robot.sections.len() == 1 { tendons.len() } else { 0 };
    let count = tendons.len() + workshop.spare_motors.unwrap_or(spare);
    let first = angle_of(tendons[0].center);
    let angles: Vec<f64> =
        (0..count).map(|k| (first + TAU * k as f64 / count as f64).rem_euclid(TAU)).collect();
    let taken = assigned(&tendons, &angles);
    let usual = tendons[0].center.norm();
    let at = |k: usize| {
        let hole = tendons.iter().find(|hole| taken[k] == Some(hole.tendon));
        hole.map_or(usual * direction(angles[k]), |hole| hole.center)
    };
    // axes in the order of the tendons, spare ones last
    let number = |k: usize| match taken[k] {
        Some(tendon) => tendon,
        None => tendons.len() + taken[..k].iter().filter(|tendon| tendon.is_none()).count(),
    };
    let place = |k: usize, distance: f64| {
        let (out, across) = (direction(angles[k]), direction(angles[k] + FRAC_PI_2));
        MotorPlace {
            axis: axis(number(k)),
            angle: angles[k],
            tendon: taken[k],
            tendon_at: at(k),
            pulley: at(k) + pulley_radius * out,
            shaft: distance * out + (at(k).dot(&across) + workshop.spool_radius()) * across,
        }
    };
    // beyond the pulleys, and as far out as the motors need beside each other
    let outermost = (0..count).map(|k| at(k).dot(&direction(angles[k]))).fold(0.0, f64::max);
    let spool = 0.5 * workshop.spool_diameter + SPOOL_FLANGE;
    let least = ((outermost + pulley_radius + pulley_flange(workshop) + AIR + spool) / MM).ceil() * MM;
    let all = |distance: f64| (0..count).map(|k| place(k, distance)).collect::<Vec<_>>();
    let distances = (0..FARTHEST).map(|i| least + i as f64 * MM);
    distances.map(all).find(|places| motors_fit(workshop, places)).unwrap_or_else(|| all(least))
}

/// The tendon of each place, if it has one: the nearest place that is free, ties to the first.
fn assigned(tendons: &[TendonHole], angles: &[f64]) -> Vec<Option<usize>> {
    let mut taken = vec![None; angles.len()];
    for hole in tendons {
        let apart = |k: usize| {
            let turn = (angles[k] - angle_of(hole.center)).rem_euclid(TAU);
            turn.min(TAU - turn) + k as f64 * 1e-9 // rounding decides nothing
        };
        let free = (0..angles.len()).filter(|&k| taken[k].is_none());
        let nearest = free.min_by(|&a, &b| apart(a).total_cmp(&apart(b)));
        taken[nearest.expect("there is a place for every tendon")] = Some(hole.tendon);
    }
    taken
}

/// Of a place around the backbone, 0 to a whole turn.
fn angle_of(p: Point) -> f64 {
    if p.norm() > 0.0 { p.y.atan2(p.x).rem_euclid(TAU) } else { 0.0 }
}

/// Whether no two motors meet, however they are turned.
fn motors_fit(workshop: &Workshop, places: &[MotorPlace]) -> bool {
    let apart = workshop.motor.frame.side * 2f64.sqrt() + AIR;
    let clear =
        |i: usize| places[i + 1..].iter().all(|other| (places[i].shaft - other.shaft).norm() >= apart);
    (0..places.len()).all(clear)
}

/// Letters of axes as motion controllers call them.
fn axis(k: usize) -> char {
    char::from(*b"XYZABCUVWDEFGHIJKLMNOPQRST".get(k).unwrap_or(&b'?'))
}

/// The front plate and the plates that grip the rod behind it, screwed together outside the tendons.
fn front(robot: &Robot, workshop: &Workshop, base: &mut Base) -> Result<(), Error> {
    let t = workshop.sheet_thickness;
    let tendons = tendon_holes(robot, 0.0);
    let outermost = tendons.iter().map(|hole| hole.center.norm()).fold(0.0, f64::max);
    let screw = workshop.screw_hole(workshop.screw_diameter);
    let screws_at = outermost + 0.5 * workshop.tendon_hole() + 2.0 * MM + 0.5 * screw;
    let mut holes = vec![rod_hole(robot, workshop, 0, 0.0)?];
    holes.extend(tendons.iter().map(|hole| Contour::circle(hole.center, 0.5 * workshop.tendon_hole())));
    holes.extend(
        (0..4).map(|i| Contour::circle(screws_at * direction(FRAC_PI_2 * (f64::from(i) + 0.5)), 0.5 * screw)),
    );

    let radius = screws_at + 0.5 * screw + 3.0 * MM;
    let title = "rod clamp: grips the rod behind the front plate, four screws";
    let mut clamp = Part::new("rod-clamp", title, Group::Base, Contour::circle(Point::zeros(), radius));
    clamp.holes.clone_from(&holes);
    clamp.scores.push(vec![Point::new(radius - 2.0 * MM, 0.0), Point::new(radius, 0.0)]);
    clamp.count = base.clamp_plates;

    let outer = base.side + 2.0 * t + 2.0 * edge(workshop);
    let square = Contour::rectangle(Point::zeros(), Point::repeat(outer));
    let mut front = Part::new("front-plate", "front plate: holds the rod, tendons pass", Group::Base, square);
    front.holes = holes;
    let slots = 0.5 * (base.side + t);
    for place in wall_tabs(base.side) {
        for side in [-slots, slots] {
            front.holes.push(slot(workshop, Point::new(place, side), Point::new(TAB, t)));
            front.holes.push(slot(workshop, Point::new(side, place), Point::new(t, TAB)));
        }
    }
    // its front face is looked at; angle 0 to the right
    front.scores.push(vec![Point::new(radius + 1.0 * MM, 0.0), Point::new(radius + 6.0 * MM, 0.0)]);
    front.engrave("0 DEG", Point::new(radius + 16.0 * MM, 0.0), 3.0 * MM);
    for hole in &tendons {
        let name = robot.tendons[hole.tendon].name.to_uppercase();
        let away = hole.center.try_normalize(0.0).unwrap_or(Point::x());
        let turned = Point::new(away.x - 0.35 * away.y, away.y + 0.35 * away.x).normalize();
        front.engrave(&name, (radius + 4.0 * MM) * turned, 4.0 * MM);
    }
    let (name, place) = (robot.name.to_uppercase(), Point::new(0.0, 0.5 * outer - 5.0 * edge(workshop)));
    front.engrave(&name, place, LETTERS);
    base.place("front-plate", Vector3::z() * base.gap, Vector3::x(), Vector3::y());
    for i in 0..base.clamp_plates {
        base.place("rod-clamp", Vector3::z() * (base.gap - t * (i + 1) as f64), Vector3::x(), Vector3::y());
    }
    base.parts.extend([front, clamp]);
    Ok(())
}

/// Material outside the slots.
fn edge(workshop: &Workshop) -> f64 {
    workshop.sheet_thickness.max(3.0 * MM)
}

/// Middles of the tabs of a wall.
fn wall_tabs(length: f64) -> [f64; 2] {
    [-0.25 * length, 0.25 * length]
}

/// A slot for a tab, so much larger.
fn slot(workshop: &Workshop, center: Point, tab: Point) -> Contour {
    Contour::rectangle(center, tab.add_scalar(workshop.slot_clearance))
}

/// Holes for all motors and slots for their pulleys, spare ones too.
fn motor_plate(workshop: &Workshop, base: &mut Base) {
    let t = workshop.sheet_thickness;
    let tabs = wall_tabs(base.side);
    let (outline, tabs) = tabbed(Point::repeat(base.side), TAB, t, [&tabs; 4]);
    let title = "motor plate: motors below, spools and pulleys above";
    let mut plate = Part::new("motor-plate", title, Group::Base, outline);
    plate.tabs = tabs;
    let frame = workshop.motor.frame;
    for place in &base.places {
        let (out, across) = (direction(place.angle), direction(place.angle + FRAC_PI_2));
        plate.holes.push(Contour::circle(place.shaft, 0.5 * (frame.boss + workshop.hole_clearance)));
        for (i, j) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let at = place.shaft + 0.5 * frame.hole_spacing * (i * out + j * across);
            plate.holes.push(Contour::circle(at, 0.5 * workshop.screw_hole(frame.screw)));
        }
        let size = Point::new(BRACKET_TAB, t).add_scalar(workshop.slot_clearance);
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let middle = place.pulley - (bracket_offset() + 0.5 * t) * across;
        let corner = |(i, j): (f64, f64)| middle + i * size.x * out + j * size.y * across;
        plate.holes.push(Contour::polygon(corners.map(corner)));
        let label = place.shaft + (0.5 * frame.boss + 4.0 * MM) * (-out);
        plate.engrave(&place.axis.to_string(), label, LETTERS.min(4.0 * MM));
    }
    plate
        .scores
        .push(vec![Point::new(0.5 * base.side - 6.0 * MM, 0.0), Point::new(0.5 * base.side - 1.0 * MM, 0.0)]);
    base.place("motor-plate", Vector3::z() * -t, Vector3::x(), Vector3::y());
    base.parts.push(plate);
}

/// From the tendon's plane to the face of the plate that carries its pulley.
fn bracket_offset() -> f64 {
    0.5 * PULLEY_WIDTH + WASHER
}

/// Four walls: two across the whole width with slots, two between them with tabs.
fn walls(workshop: &Workshop, base: &mut Base, below: f64) {
    let t = workshop.sheet_thickness;
    let height = below + base.gap;
    let size = Point::new(base.side + 2.0 * t + 2.0 * edge(workshop), height);
    let top = wall_tabs(base.side);
    let sides = [-0.25 * height, 0.25 * height];
    let shelf = below - 0.5 * t - 0.5 * height; // of the motor plate's middle
    let shelf_slots = |part: &mut Part| {
        part.holes.extend(top.map(|at| slot(workshop, Point::new(at, shelf), Point::new(TAB, t))));
    };
    let (outline, tabs) = tabbed(size, TAB, t, [&[], &top, &[], &[]]);
    let title = "outer wall, with a hole for the motors' cables";
    let mut outer = Part::new("wall-outer", title, Group::Base, outline);
    outer.tabs = tabs;
    shelf_slots(&mut outer);
    for side in [-0.5, 0.5] {
        outer.holes.extend(
            sides.map(|at| slot(workshop, Point::new(side * (base.side + t), at), Point::new(t, TAB))),
        );
    }
    let cables = -0.5 * height + 0.5 * WIRING_HOLE + 2.0 * edge(workshop);
    outer.holes.push(Contour::circle(Point::new(0.0, cables), 0.5 * WIRING_HOLE));
    outer.count = 2;

    let (outline, tabs) = tabbed(Point::new(base.side, height), TAB, t, [&sides, &top, &sides, &[]]);
    let mut inner = Part::new("wall-inner", "inner wall", Group::Base, outline);
    inner.tabs = tabs;
    shelf_slots(&mut inner);
    inner.count = 2;

    let middle = Vector3::z() * (0.5 * height - below);
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let half = 0.5 * base.side;
    base.place("wall-outer", middle + (half + t) * y, x, z);
    base.place("wall-outer", middle - half * y, x, z);
    base.place("wall-inner", middle + half * x, y, z);
    base.place("wall-inner", middle - (half + t) * x, y, z);
    base.parts.extend([outer, inner]);
}

/// A plate on edge for each tendon's pulley.
fn brackets(robot: &Robot, workshop: &Workshop, base: &mut Base) {
    let t = workshop.sheet_thickness;
    let height = base.pulley_height + 2.0 * workshop.screw_diameter;
    let size = Point::new(BRACKET, height);
    let (outline, tabs) = tabbed(size, BRACKET_TAB, t, [&[], &[], &[], &[0.0]]);
    let title = "pulley bracket: its tab goes into the motor plate";
    let mut bracket = Part::new("pulley-bracket", title, Group::Base, outline);
    let axle = Point::new(0.0, base.pulley_height - 0.5 * height);
    bracket.holes.push(Contour::circle(axle, 0.5 * workshop.screw_hole(workshop.screw_diameter)));
    bracket.tabs = tabs;
    bracket.count = robot.tendons.len();
    for place in base.places.clone().iter().filter(|place| place.tendon.is_some()) {
        let (out, across) = (direction(place.angle), direction(place.angle + FRAC_PI_2));
        let foot = place.pulley - bracket_offset() * across;
        let origin = Vector3::new(foot.x, foot.y, 0.5 * height);
        base.place("pulley-bracket", origin, Vector3::new(out.x, out.y, 0.0), Vector3::z());
    }
    base.parts.push(bracket);
}

/// Core and flanges, which sit on the flat of the shaft.
fn spools(workshop: &Workshop, base: &mut Base) {
    let frame = workshop.motor.frame;
    let shrunk = 0.5 * workshop.press_fit;
    let shaft = || Contour::flattened_circle(Point::zeros(), 0.5 * frame.shaft - shrunk, frame.flat - shrunk);
    let radius = 0.5 * workshop.spool_diameter;
    let count = base.places.iter().filter(|place| place.tendon.is_some()).count();
    let title = format!("spool core: {:.3} mm of tendon a turn", workshop.circumference() / MM);
    let mut core = Part::new("spool-core", title, Group::Base, Contour::circle(Point::zeros(), radius));
    core.holes.push(shaft());
    core.count = count;
    let outline = Contour::circle(Point::zeros(), radius + SPOOL_FLANGE);
    let mut flange = Part::new(
        "spool-flange",
        "spool flange: the tendon is tied through its small hole",
        Group::Base,
        outline,
    );
    flange.holes.push(shaft());
    flange
        .holes
        .push(Contour::circle(Point::new(radius + 0.5 * SPOOL_FLANGE, 0.0), 0.5 * workshop.tendon_hole()));
    flange.count = 2 * count;
    let t = workshop.sheet_thickness;
    for place in base.places.clone().iter().filter(|place| place.tendon.is_some()) {
        let at = |height: f64| Vector3::new(place.shaft.x, place.shaft.y, height);
        for (name, height) in
            [("spool-flange", AIR), ("spool-core", AIR + t), ("spool-flange", AIR + 2.0 * t)]
        {
            base.place(name, at(height), Vector3::x(), Vector3::y());
        }
    }
    base.parts.extend([core, flange]);
}

impl Base {
    fn place(&mut self, part: &str, origin: Vector3<f64>, x: Vector3<f64>, y: Vector3<f64>) {
        self.placed.push(Placed { part: part.to_owned(), origin, x, y });
    }

    /// Pulley and bracket of a place, seen along the backbone.
    pub(super) fn pulley_footprint(&self, workshop: &Workshop, place: &MotorPlace) -> [Contour; 2] {
        let (out, across) = (direction(place.angle), direction(place.angle + FRAC_PI_2));
        let rectangle = |half: f64, low: f64, high: f64| {
            let corners = [(-half, low), (half, low), (half, high), (-half, high)];
            Contour::polygon(corners.map(|(i, j)| place.pulley + i * out + j * across))
        };
        let width = 0.5 * PULLEY_WIDTH;
        let back = bracket_offset();
        [
            rectangle(pulley_flange(workshop), -width, width),
            rectangle(0.5 * BRACKET, -back - workshop.sheet_thickness, -back),
        ]
    }
}
