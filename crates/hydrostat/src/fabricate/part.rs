//! A part that is cut from a sheet, and how it stands in the assembled robot.

use super::lettering;
use crate::planar::{Bounds, Contour, Point};
use nalgebra::Vector3;

/// Parts that are cut, and put together, at one time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    Coupon,
    Guides,
    Base,
    Device,
    Bench,
}

impl Group {
    pub const ALL: [Group; 5] = [Group::Coupon, Group::Guides, Group::Base, Group::Device, Group::Bench];

    /// As files are called.
    pub fn name(self) -> &'static str {
        match self {
            Group::Coupon => "coupon",
            Group::Guides => "guides",
            Group::Base => "base",
            Group::Device => "assembly-device",
            Group::Bench => "bench",
        }
    }
}

/// A flat part, m; its own axes. What is cut is what stays: kerf comes later.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// As its files are called.
    pub name: String,
    /// What it is for.
    pub title: String,
    pub group: Group,
    pub outline: Contour,
    pub holes: Vec<Contour>,
    /// Cuts along a line, without allowance for the kerf.
    pub slits: Vec<[Point; 2]>,
    /// Engraved areas, and how deep.
    pub pockets: Vec<(Contour, f64)>,
    pub scores: Vec<Vec<Point>>,
    pub engravings: Vec<Vec<Point>>,
    /// Tongues of the outline that pass slots of other parts.
    pub tabs: Vec<Tab>,
    /// How many are cut.
    pub count: usize,
}

/// A tongue: centre, and size along the part's x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tab {
    pub center: Point,
    pub size: Point,
}

impl Part {
    pub(super) fn new(
        name: impl Into<String>,
        title: impl Into<String>,
        group: Group,
        outline: Contour,
    ) -> Part {
        Part {
            name: name.into(),
            title: title.into(),
            group,
            outline,
            holes: Vec::new(),
            slits: Vec::new(),
            pockets: Vec::new(),
            scores: Vec::new(),
            engravings: Vec::new(),
            tabs: Vec::new(),
            count: 1,
        }
    }

    pub(super) fn engrave(&mut self, text: &str, center: Point, height: f64) {
        self.engravings.extend(lettering::letters(text, center, height));
    }

    /// A text that reads from below upwards.
    pub(super) fn engrave_upright(&mut self, text: &str, center: Point, height: f64) {
        let turned = |p: Point| center + Point::new(center.y - p.y, p.x - center.x);
        let strokes = lettering::letters(text, center, height);
        self.engravings.extend(strokes.into_iter().map(|stroke| stroke.into_iter().map(turned).collect()));
    }

    /// Of one, without its holes.
    pub fn area(&self) -> f64 {
        self.outline.area() - self.holes.iter().map(Contour::area).sum::<f64>()
    }

    pub fn bounds(&self) -> Bounds {
        self.outline.bounds()
    }

    /// Length that the laser cuts.
    pub fn cut_length(&self) -> f64 {
        let slits: f64 = self.slits.iter().map(|[a, b]| (b - a).norm()).sum();
        self.outline.length() + self.holes.iter().map(Contour::length).sum::<f64>() + slits
    }
}

/// Where a part stands in the assembled base: its plane through `origin` along `x` and `y`; the sheet lies on the side of
/// x cross y. Axes of the base: z along the backbone, x and y its d1 and d2, z = 0 on the motor plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    pub part: String,
    pub origin: Vector3<f64>,
    pub x: Vector3<f64>,
    pub y: Vector3<f64>,
}

impl Placed {
    /// A point of the part, so far into the sheet.
    pub fn at(&self, point: Point, depth: f64) -> Vector3<f64> {
        self.origin + point.x * self.x + point.y * self.y + depth * self.x.cross(&self.y)
    }
}

/// A rectangle about the origin with tongues of depth `depth` and length `length` on its edges: right, top, left, bottom, at
/// these distances from the middle of the edge.
pub(super) fn tabbed(size: Point, length: f64, depth: f64, edges: [&[f64]; 4]) -> (Contour, Vec<Tab>) {
    let (x, y) = (0.5 * size.x, 0.5 * size.y);
    // from the start of each edge, counter-clockwise
    let starts = [Point::new(x, -y), Point::new(x, y), Point::new(-x, y), Point::new(-x, -y)];
    let (mut corners, mut tabs) = (Vec::new(), Vec::new());
    for (i, (start, places)) in starts.into_iter().zip(edges).enumerate() {
        let next = starts[(i + 1) % 4];
        let along = (next - start).normalize();
        let out = Point::new(along.y, -along.x);
        let middle = 0.5 * (start + next);
        corners.push(start);
        // places grow along +x or +y of the part
        let sense = if i < 1 || i == 3 { 1.0 } else { -1.0 };
        let mut places: Vec<f64> = places.iter().map(|place| sense * place).collect();
        places.sort_by(f64::total_cmp);
        for place in places {
            let [from, to] = [place - 0.5 * length, place + 0.5 * length].map(|at| middle + at * along);
            corners.extend([from, from + depth * out, to + depth * out, to]);
            let size = if i % 2 == 0 { Point::new(depth, length) } else { Point::new(length, depth) };
            tabs.push(Tab { center: 0.5 * (from + to) + 0.5 * depth * out, size });
        }
    }
    (Contour::polygon(corners), tabs)
}
