//! A figure of the guide: lengths in m with y up, drawn at so many pixels per millimetre.

use super::MM;
use crate::draw::{ACCENT, GRID_HEAVY, INK, MUTED, SECOND};
use crate::text::{self, escape};
use hydrostat::planar::{Bounds, Contour, Point};
use std::fmt::Write;

pub(super) const LETTERS: f64 = 12.0; // px
const MARGIN: f64 = 10.0;
/// Letters of other fonts than Roboto may be so much wider.
const WIDER: f64 = 1.2;

/// How a line or area is drawn.
#[derive(Clone, Copy)]
pub(super) enum Pen {
    /// Edge of a part, filled white.
    Part,
    /// The same, filled grey: seen from its edge.
    Edge,
    /// Behind or below something.
    Hidden,
    Tendon,
    Rod,
    Thin,
    Score,
    Other,
}

impl Pen {
    fn style(self) -> String {
        let (fill, stroke, width, dash) = match self {
            Pen::Part => ("#ffffff", INK, 1.2, ""),
            Pen::Edge => ("#e3e9ef", INK, 1.0, ""),
            Pen::Hidden => ("none", MUTED, 1.0, " stroke-dasharray=\"5 3\""),
            Pen::Tendon => ("none", SECOND, 1.8, ""),
            Pen::Rod => ("none", INK, 2.4, ""),
            Pen::Thin => ("none", MUTED, 0.8, ""),
            Pen::Score => ("none", ACCENT, 1.2, ""),
            Pen::Other => ("none", GRID_HEAVY, 1.2, ""),
        };
        format!("fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{width}\"{dash}")
    }
}

/// Where a text stands at its point.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

pub(super) struct Figure {
    /// Pixels per m.
    scale: f64,
    body: String,
    /// Corners of all that is drawn, px, y down.
    corners: Vec<Point>,
}

impl Figure {
    /// At so many pixels per millimetre.
    pub(super) fn new(scale: f64) -> Figure {
        Figure { scale: scale * MM, body: String::new(), corners: Vec::new() }
    }

    fn px(&self, p: Point) -> Point {
        self.scale * Point::new(p.x, -p.y)
    }

    fn path(&mut self, points: &[Point], close: bool) -> String {
        let mut path = String::new();
        for (i, point) in points.iter().enumerate() {
            let p = self.px(*point);
            self.corners.push(p);
            let _ = write!(path, "{}{:.2} {:.2}", if i == 0 { 'M' } else { 'L' }, p.x, p.y);
        }
        if close { path + "Z" } else { path }
    }

    pub(super) fn line(&mut self, points: &[Point], pen: Pen) {
        let path = self.path(points, false);
        let _ = writeln!(self.body, "<path d=\"{path}\" {}/>", pen.style().replace("#ffffff", "none"));
    }

    /// An outline with its holes.
    pub(super) fn shape(&mut self, outline: &Contour, holes: &[Contour], pen: Pen) {
        let rings: Vec<Vec<Point>> =
            std::iter::once(outline).chain(holes).map(|ring| ring.chords(1e-3)).collect();
        self.rings(&rings, pen);
    }

    pub(super) fn rings(&mut self, rings: &[Vec<Point>], pen: Pen) {
        let path: String = rings.iter().map(|ring| self.path(ring, true)).collect();
        let _ = writeln!(self.body, "<path d=\"{path}\" fill-rule=\"evenodd\" {}/>", pen.style());
    }

    pub(super) fn circle(&mut self, center: Point, radius: f64, pen: Pen) {
        self.shape(&Contour::circle(center, radius), &[], pen);
    }

    pub(super) fn text(&mut self, at: Point, text: &str, anchor: Anchor) {
        let p = self.px(at);
        let width = WIDER * text::width(text, LETTERS);
        let (word, left) = match anchor {
            Anchor::Start => ("start", 0.0),
            Anchor::Middle => ("middle", 0.5 * width),
            Anchor::End => ("end", width),
        };
        self.corners.extend([p + Point::new(-left, -LETTERS), p + Point::new(width - left, 0.3 * LETTERS)]);
        let _ = writeln!(
            self.body,
            "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{word}\">{}</text>",
            p.x,
            p.y + 0.35 * LETTERS,
            escape(text)
        );
    }

    /// A measured distance between two points, `away` to the left of the way from one to the other.
    pub(super) fn dimension(&mut self, from: Point, to: Point, away: f64, text: &str) {
        let along = (to - from).normalize();
        let out = Point::new(-along.y, along.x);
        let arrow = 6.0 / self.scale;
        let (a, b) = (from + away * out, to + away * out);
        self.line(&[from, a + 0.5 * arrow * away.signum() * out], Pen::Thin);
        self.line(&[to, b + 0.5 * arrow * away.signum() * out], Pen::Thin);
        self.line(&[a, b], Pen::Thin);
        for (end, inward) in [(a, along), (b, -along)] {
            let barb = |side: f64| end + arrow * (inward + side * 0.35 * out);
            self.line(&[barb(1.0), end, barb(-1.0)], Pen::Thin);
        }
        let place = 0.5 * (a + b) + away.signum() * (LETTERS / self.scale) * out;
        let anchor = if out.x.abs() < 0.5 {
            Anchor::Middle
        } else if out.x * away > 0.0 {
            Anchor::Start
        } else {
            Anchor::End
        };
        self.text(place, text, anchor);
    }

    pub(super) fn finish(self, label: &str) -> String {
        let bounds =
            Bounds::around(self.corners).unwrap_or(Bounds { low: Point::zeros(), high: Point::zeros() });
        let low = bounds.low.add_scalar(-MARGIN);
        let size = bounds.size().add_scalar(2.0 * MARGIN);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{}\" width=\"{w:.0}\" height=\"{h:.0}\" viewBox=\"{:.2} {:.2} {w:.2} {h:.2}\" font-family=\"Roboto, Helvetica, Arial, sans-serif\" font-size=\"{LETTERS}\" fill=\"{INK}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n{}</svg>",
            escape(label),
            low.x,
            low.y,
            self.body,
            w = size.x,
            h = size.y
        )
    }
}
