//! Closed contours of lines and arcs in the plane: area, offset, distances. No robot, any unit of length.
//!
//! Written here because `cavalier_contours` brings a random generator that does not build for wasm32, and the other crates
//! turn arcs into chords.

use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

pub type Point = Vector2<f64>;

/// Largest distance of a chord from its arc, as a part of the radius, where a contour is made of chords.
const CHORD: f64 = 1e-4;

/// A corner, and how the way to the next one bends: the tangent of a quarter of the arc's angle, above 0 to the left; 0 is a
/// line. The convention of DXF's LWPOLYLINE.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    pub at: Point,
    pub bulge: f64,
}

/// A closed curve that does not cross itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Contour {
    Circle {
        center: Point,
        radius: f64,
    },
    /// Counter-clockwise.
    Polygon(Vec<Vertex>),
}

/// An upright rectangle around something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: Point,
    pub high: Point,
}

impl Bounds {
    pub fn size(&self) -> Point {
        self.high - self.low
    }

    /// Around all of these; None without any.
    pub fn around(points: impl IntoIterator<Item = Point>) -> Option<Bounds> {
        let grow = |b: Option<Bounds>, p: Point| {
            let b = b.unwrap_or(Bounds { low: p, high: p });
            Some(Bounds { low: b.low.inf(&p), high: b.high.sup(&p) })
        };
        points.into_iter().fold(None, grow)
    }
}

/// The unit vector at this angle.
pub fn direction(angle: f64) -> Point {
    Point::new(angle.cos(), angle.sin())
}

/// A quarter turn to the left.
fn left(v: Point) -> Point {
    Point::new(-v.y, v.x)
}

fn cross(a: Point, b: Point) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The way from one vertex to the next.
struct Segment {
    from: Point,
    to: Point,
    bulge: f64,
}

impl Segment {
    /// Centre and signed radius of an arc; above 0 turns left.
    fn arc(&self) -> Option<(Point, f64)> {
        if self.bulge == 0.0 {
            return None;
        }
        let chord = self.to - self.from;
        let radius = chord.norm() * (1.0 + self.bulge.powi(2)) / (4.0 * self.bulge);
        let apothem = (1.0 - self.bulge.powi(2)) / (4.0 * self.bulge);
        Some((self.from + 0.5 * chord + apothem * left(chord), radius))
    }

    /// Direction at a place of it.
    fn tangent(&self, at: Point) -> Point {
        match self.arc() {
            None => (self.to - self.from).normalize(),
            Some((center, radius)) => left(at - center) / radius,
        }
    }

    /// Points from its start, without its end, on chords of that part of the radius.
    fn chords(&self, chord: f64) -> Vec<Point> {
        let Some((center, _)) = self.arc() else { return vec![self.from] };
        let sweep = 4.0 * self.bulge.atan();
        let count = steps(sweep, chord);
        let spoke = self.from - center;
        let turned = |i: usize| {
            let turn = direction(sweep * i as f64 / count as f64);
            center + Point::new(turn.x * spoke.x - turn.y * spoke.y, turn.y * spoke.x + turn.x * spoke.y)
        };
        (0..count).map(turned).collect()
    }
}

/// Chords for an angle.
fn steps(sweep: f64, chord: f64) -> usize {
    (sweep.abs() / (2.0 * (1.0 - chord).acos())).ceil().max(2.0) as usize
}

impl Contour {
    pub fn circle(center: Point, radius: f64) -> Contour {
        Contour::Circle { center, radius }
    }

    /// Corners joined by lines, in either sense.
    pub fn polygon(corners: impl IntoIterator<Item = Point>) -> Contour {
        let mut vertices: Vec<Vertex> = corners.into_iter().map(|at| Vertex { at, bulge: 0.0 }).collect();
        if Contour::Polygon(vertices.clone()).area() < 0.0 {
            vertices.reverse();
        }
        Contour::Polygon(vertices)
    }

    pub fn rectangle(center: Point, size: Point) -> Contour {
        let (x, y) = (0.5 * size.x, 0.5 * size.y);
        Contour::polygon([(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| center + Point::new(x, y)))
    }

    /// A rectangle with round corners.
    pub fn rounded_rectangle(center: Point, size: Point, radius: f64) -> Contour {
        let (x, y, r) = (0.5 * size.x, 0.5 * size.y, radius);
        let quarter = (PI / 8.0).tan();
        let corner = |x: f64, y: f64, bulge: f64| Vertex { at: center + Point::new(x, y), bulge };
        Contour::Polygon(vec![
            corner(r - x, -y, 0.0),
            corner(x - r, -y, quarter),
            corner(x, r - y, 0.0),
            corner(x, y - r, quarter),
            corner(x - r, y, 0.0),
            corner(r - x, y, quarter),
            corner(-x, y - r, 0.0),
            corner(-x, r - y, quarter),
        ])
    }

    /// A circle cut off by a chord at so much above its centre: the shaft of a motor.
    pub fn flattened_circle(center: Point, radius: f64, flat: f64) -> Contour {
        let half = (radius.powi(2) - flat.powi(2)).sqrt();
        let sweep = TAU - 2.0 * (flat / radius).acos();
        Contour::Polygon(vec![
            Vertex { at: center + Point::new(half, flat), bulge: 0.0 },
            Vertex { at: center + Point::new(-half, flat), bulge: (sweep / 4.0).tan() },
        ])
    }

    fn segments(vertices: &[Vertex]) -> impl Iterator<Item = Segment> + '_ {
        let next = vertices.iter().cycle().skip(1);
        vertices.iter().zip(next).map(|(a, b)| Segment { from: a.at, to: b.at, bulge: a.bulge })
    }

    /// Exact; above 0 where a polygon runs counter-clockwise.
    pub fn area(&self) -> f64 {
        let part = |segment: Segment| {
            let bow = segment.arc().map_or(0.0, |(_, radius)| {
                let sweep = 4.0 * segment.bulge.atan();
                0.5 * radius.powi(2) * (sweep - sweep.sin())
            });
            0.5 * cross(segment.from, segment.to) + bow
        };
        match self {
            Contour::Circle { radius, .. } => PI * radius.powi(2),
            Contour::Polygon(vertices) => Contour::segments(vertices).map(part).sum(),
        }
    }

    /// Length of the way around.
    pub fn length(&self) -> f64 {
        let part = |segment: Segment| match segment.arc() {
            None => (segment.to - segment.from).norm(),
            Some((_, radius)) => (radius * 4.0 * segment.bulge.atan()).abs(),
        };
        match self {
            Contour::Circle { radius, .. } => TAU * radius,
            Contour::Polygon(vertices) => Contour::segments(vertices).map(part).sum(),
        }
    }

    /// Corners of chords that lie within this part of each arc's radius.
    pub fn chords(&self, chord: f64) -> Vec<Point> {
        match self {
            Contour::Circle { center, radius } => {
                let count = 4 * steps(TAU, chord).div_ceil(4); // the outermost points are met
                let turn = |i| center + *radius * direction(TAU * i as f64 / count as f64);
                (0..count).map(turn).collect()
            }
            Contour::Polygon(vertices) => {
                Contour::segments(vertices).flat_map(|segment| segment.chords(chord)).collect()
            }
        }
    }

    pub fn bounds(&self) -> Bounds {
        if let Contour::Circle { center, radius } = self {
            let spoke = Point::repeat(*radius);
            return Bounds { low: center - spoke, high: center + spoke };
        }
        Bounds::around(self.chords(CHORD)).expect("a contour has corners")
    }

    /// Each point moved by a rigid motion: turned about the origin by quarter turns to the left, then shifted.
    #[must_use]
    pub fn moved(&self, quarter_turns: usize, shift: Point) -> Contour {
        let put = |p: Point| (0..quarter_turns % 4).fold(p, |p, _| left(p)) + shift;
        match self {
            Contour::Circle { center, radius } => Contour::circle(put(*center), *radius),
            Contour::Polygon(vertices) => {
                let put = |v: &Vertex| Vertex { at: put(v.at), bulge: v.bulge };
                Contour::Polygon(vertices.iter().map(put).collect())
            }
        }
    }

    /// The parallel curve at a distance, outwards above 0; corners stay corners. None where nothing is left of it.
    pub fn offset(&self, distance: f64) -> Option<Contour> {
        match self {
            Contour::Circle { center, radius } => {
                (radius + distance > 0.0).then(|| Contour::circle(*center, radius + distance))
            }
            Contour::Polygon(vertices) => offset(vertices, distance),
        }
    }

    /// Whether a point lies inside; on the line is either.
    pub fn contains(&self, point: Point) -> bool {
        inside(&self.chords(CHORD), point)
    }

    /// Smallest distance between the two lines, exact for circles; below 0 where circles overlap, 0 where others cross.
    pub fn gap(&self, other: &Contour) -> f64 {
        if let (Contour::Circle { center: a, radius: r }, Contour::Circle { center: b, radius: q }) =
            (self, other)
        {
            let apart = (a - b).norm();
            // one inside the other, or side by side
            return if apart < r.max(*q) { r.max(*q) - apart - r.min(*q) } else { apart - r - q };
        }
        let (mine, theirs) = (self.chords(CHORD), other.chords(CHORD));
        let mut least = f64::INFINITY;
        for (i, a) in mine.iter().enumerate() {
            let b = mine[(i + 1) % mine.len()];
            for (j, c) in theirs.iter().enumerate() {
                least = least.min(segment_gap(*a, b, *c, theirs[(j + 1) % theirs.len()]));
            }
        }
        least
    }

    /// Whether two parts of it that are not neighbours meet.
    pub fn crosses_itself(&self) -> bool {
        let Contour::Polygon(_) = self else { return false };
        let corners = self.chords(CHORD);
        let count = corners.len();
        let end = |i: usize| corners[(i + 1) % count];
        (0..count).any(|i| {
            (i + 2..count)
                .filter(|&j| (j + 1) % count != i)
                .any(|j| segment_gap(corners[i], end(i), corners[j], end(j)) == 0.0)
        })
    }
}

/// Whether a point lies inside a closed line through these corners.
pub fn inside(corners: &[Point], point: Point) -> bool {
    let next = corners.iter().cycle().skip(1);
    let crossed = |(a, b): &(&Point, &Point)| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    corners.iter().zip(next).filter(crossed).count() % 2 == 1
}

fn offset(vertices: &[Vertex], distance: f64) -> Option<Contour> {
    let segments: Vec<Segment> = Contour::segments(vertices).collect();
    let count = segments.len();
    let corner = |i: usize| joint(&segments[(i + count - 1) % count], &segments[i], distance);
    let corners: Vec<Point> = (0..count).map(corner).collect::<Option<_>>()?;
    let mut moved = Vec::with_capacity(count);
    for (i, segment) in segments.iter().enumerate() {
        let (from, to) = (corners[i], corners[(i + 1) % count]);
        let bulge = match segment.arc() {
            None if (to - from).dot(&(segment.to - segment.from)) <= 0.0 => return None,
            None => 0.0,
            // an arc that turns left grows outwards, the other shrinks
            Some((_, radius)) if (radius + distance) * radius.signum() <= 0.0 => return None,
            Some((center, radius)) => {
                let (a, b) =
                    ((from - center).y.atan2((from - center).x), (to - center).y.atan2((to - center).x));
                let sweep = if radius > 0.0 { (b - a).rem_euclid(TAU) } else { -(a - b).rem_euclid(TAU) };
                (sweep / 4.0).tan()
            }
        };
        moved.push(Vertex { at: from, bulge });
    }
    let moved = Contour::Polygon(moved);
    (moved.area() > 0.0).then_some(moved)
}

/// Where the parallels of two neighbours meet, to the right of them above 0: outside of a contour.
fn joint(before: &Segment, after: &Segment, distance: f64) -> Option<Point> {
    let at = after.from;
    let (a, b) = (before.tangent(at), after.tangent(at));
    let (right_a, right_b) = (-left(a), -left(b));
    if cross(a, b).abs() < 1e-9 && a.dot(&b) > 0.0 {
        return Some(at + distance * right_a); // tangent
    }
    match (before.arc(), after.arc()) {
        (None, None) => Some(at + distance / (1.0 + right_a.dot(&right_b)) * (right_a + right_b)),
        (Some(arc), None) => meet(at, at + distance * right_b, b, arc, distance),
        (None, Some(arc)) => meet(at, at + distance * right_a, a, arc, distance),
        (Some(_), Some(_)) => None, // no part has such a corner
    }
}

/// The point of a line nearest to `near` that lies on the parallel of an arc.
fn meet(
    near: Point,
    on: Point,
    along: Point,
    (center, radius): (Point, f64),
    distance: f64,
) -> Option<Point> {
    let radius = radius + distance;
    let foot = on + along * along.dot(&(center - on));
    let half = (radius.powi(2) - (foot - center).norm_squared()).sqrt();
    let ends = [foot + half * along, foot - half * along];
    let nearest = ends.into_iter().min_by(|p, q| (p - near).norm().total_cmp(&(q - near).norm()))?;
    half.is_finite().then_some(nearest)
}

/// Distance of two line segments; 0 where they cross or touch.
fn segment_gap(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let side = |p: Point, q: Point, r: Point| cross(q - p, r - p);
    let (c_side, d_side, a_side, b_side) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    if c_side * d_side < 0.0 && a_side * b_side < 0.0 {
        return 0.0;
    }
    let gaps = [to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)];
    gaps.into_iter().fold(f64::INFINITY, f64::min)
}

fn to_segment(p: Point, a: Point, b: Point) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    (p - a - t * along).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXACT: f64 = 1e-12; // rounding, for sizes of about 10

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < EXACT * (1.0 + b.abs()), "{a} {b}");
    }

    /// Steiner: a convex curve's parallel with sharp corners adds length x d + d^2 sum of tan(turn / 2) + the arcs' own.
    #[test]
    fn offsets_have_the_areas_of_closed_forms() {
        let (center, size) = (Point::new(3.0, -2.0), Point::new(8.0, 5.0));
        let d = 0.3;
        for d in [d, -d] {
            let area = |contour: &Contour| contour.offset(d).expect("it is larger than that").area();
            close(area(&Contour::rectangle(center, size)), (8.0 + 2.0 * d) * (5.0 + 2.0 * d));
            close(area(&Contour::circle(center, 4.0)), PI * (4.0 + d).powi(2));
            let round = Contour::rounded_rectangle(center, size, 1.0);
            close(round.area(), 40.0 - (4.0 - PI));
            close(area(&round), (8.0 + 2.0 * d) * (5.0 + 2.0 * d) - (4.0 - PI) * (1.0 + d).powi(2));
            let flat = Contour::flattened_circle(center, 2.5, 2.0);
            let segment = |r: f64, h: f64| r * r * (h / r).acos() - h * (r * r - h * h).sqrt();
            close(flat.area(), PI * 2.5f64.powi(2) - segment(2.5, 2.0));
            close(area(&flat), PI * (2.5 + d).powi(2) - segment(2.5 + d, 2.0 + d));
        }
        assert_eq!(Contour::rectangle(center, size).offset(-2.5), None);
        assert_eq!(Contour::circle(center, 0.2).offset(-0.2), None);
        assert_eq!(Contour::rounded_rectangle(center, size, 1.0).offset(-1.1), None);
    }

    /// A concave outline: every part of the parallel is at the distance.
    #[test]
    fn an_offset_keeps_its_distance() {
        let notched = Contour::polygon(
            [(0.0, 0.0), (9.0, 0.0), (9.0, 4.0), (6.0, 4.0), (6.0, 2.0), (4.0, 2.0), (4.0, 4.0), (0.0, 4.0)]
                .map(|(x, y)| Point::new(x, y)),
        );
        close(notched.area(), 32.0);
        for d in [0.4, -0.4] {
            let moved = notched.offset(d).expect("it is larger than that");
            close(moved.gap(&notched), 0.4);
            close(moved.area(), 32.0 + d * notched.length() + 4.0 * d * d);
            assert!(!moved.crosses_itself());
        }
    }

    #[test]
    fn gaps_and_crossings_are_those_of_closed_forms() {
        let circle = |x: f64, radius: f64| Contour::circle(Point::new(x, 0.0), radius);
        close(circle(0.0, 2.0).gap(&circle(5.0, 1.0)), 2.0);
        close(circle(0.0, 2.0).gap(&circle(2.5, 1.0)), -0.5);
        close(circle(0.0, 5.0).gap(&circle(2.0, 1.0)), 2.0);
        close(circle(0.0, 5.0).gap(&circle(4.5, 1.0)), -0.5);
        let square = Contour::rectangle(Point::new(5.0, 0.0), Point::new(2.0, 2.0));
        assert!((square.gap(&circle(0.0, 2.0)) - 2.0).abs() < 2.0 * CHORD);
        assert!(square.contains(Point::new(5.5, 0.5)) && !square.contains(Point::new(6.5, 0.5)));
        let bow_tie = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| Point::new(x, y));
        assert!(Contour::polygon(bow_tie).crosses_itself() && !square.crosses_itself());
        let turned = square.moved(1, Point::new(1.0, 1.0)).bounds();
        close(turned.low.x, 0.0);
        close(turned.high.y, 7.0);
    }
}
