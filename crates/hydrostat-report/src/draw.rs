//! A canvas that writes SVG and remembers what it covers.

use crate::text::{self, escape};
use std::f64::consts::TAU;
use std::fmt::Write;

/// A point on the page: px to the right, px down.
pub(crate) type P = [f64; 2];

pub(crate) const INK: &str = "#1b2530";
pub(crate) const MUTED: &str = "#5a6675";
pub(crate) const GRID: &str = "#e6eaef";
pub(crate) const GRID_HEAVY: &str = "#c2cad3";
pub(crate) const WHITE: &str = "#ffffff";
pub(crate) const ACCENT: &str = "#0b5fad";
pub(crate) const ACCENT_LIGHT: &str = "#5fa3dd";
/// Vermilion of the Okabe-Ito palette.
pub(crate) const SECOND: &str = "#d55e00";

/// An upright rectangle on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x0: f64,
    pub(crate) y0: f64,
    pub(crate) x1: f64,
    pub(crate) y1: f64,
}

impl Rect {
    pub(crate) const EMPTY: Rect =
        Rect { x0: f64::INFINITY, y0: f64::INFINITY, x1: f64::NEG_INFINITY, y1: f64::NEG_INFINITY };

    pub(crate) fn new(x0: f64, y0: f64, x1: f64, y1: f64) -> Rect {
        Rect { x0, y0, x1, y1 }
    }

    pub(crate) fn centred(c: P, width: f64, height: f64) -> Rect {
        Rect::new(c[0] - width / 2.0, c[1] - height / 2.0, c[0] + width / 2.0, c[1] + height / 2.0)
    }

    pub(crate) fn width(&self) -> f64 {
        (self.x1 - self.x0).max(0.0)
    }

    pub(crate) fn height(&self) -> f64 {
        (self.y1 - self.y0).max(0.0)
    }

    pub(crate) fn include(&mut self, p: P) {
        if p[0].is_finite() && p[1].is_finite() {
            self.x0 = self.x0.min(p[0]);
            self.y0 = self.y0.min(p[1]);
            self.x1 = self.x1.max(p[0]);
            self.y1 = self.y1.max(p[1]);
        }
    }

    pub(crate) fn unite(&mut self, other: Rect) {
        self.include([other.x0, other.y0]);
        self.include([other.x1, other.y1]);
    }

    pub(crate) fn grown(&self, by: f64) -> Rect {
        Rect::new(self.x0 - by, self.y0 - by, self.x1 + by, self.y1 + by)
    }

    /// Widened about its centre to at least this size; an empty one is placed at the origin.
    pub(crate) fn at_least(&self, width: f64, height: f64) -> Rect {
        let centre = if self.x0 <= self.x1 {
            [(self.x0 + self.x1) / 2.0, (self.y0 + self.y1) / 2.0]
        } else {
            [0.0; 2]
        };
        Rect::centred(centre, self.width().max(width), self.height().max(height))
    }

    pub(crate) fn overlaps(&self, other: &Rect) -> bool {
        self.x0 < other.x1 && other.x0 < self.x1 && self.y0 < other.y1 && other.y0 < self.y1
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pen {
    pub(crate) colour: &'static str,
    pub(crate) width: f64,
    pub(crate) dash: Option<&'static str>,
}

impl Pen {
    pub(crate) const fn new(colour: &'static str, width: f64) -> Pen {
        Pen { colour, width, dash: None }
    }

    pub(crate) const fn dashed(colour: &'static str, width: f64, dash: &'static str) -> Pen {
        Pen { colour, width, dash: Some(dash) }
    }
}

/// How a text is set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Type {
    pub(crate) size: f64,
    pub(crate) bold: bool,
    pub(crate) colour: &'static str,
}

impl Type {
    pub(crate) const fn new(size: f64, colour: &'static str) -> Type {
        Type { size, bold: false, colour }
    }

    pub(crate) const fn bold(size: f64, colour: &'static str) -> Type {
        Type { size, bold: true, colour }
    }

    /// Room the text needs, with a reserve for fonts wider than the one measured.
    pub(crate) fn width(&self, s: &str) -> f64 {
        text::width(s, self.size) * if self.bold { 1.12 } else { 1.08 }
    }

    pub(crate) fn height(&self) -> f64 {
        self.size * 1.25
    }
}

/// Which point of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// SVG elements, the rectangle they cover and the lines that labels should keep clear of.
pub(crate) struct Canvas {
    body: String,
    pub(crate) bounds: Rect,
    pub(crate) segments: Vec<(P, P)>,
}

impl Canvas {
    pub(crate) fn new() -> Canvas {
        Canvas { body: String::new(), bounds: Rect::EMPTY, segments: Vec::new() }
    }

    pub(crate) fn line(&mut self, a: P, b: P, pen: Pen) {
        self.polyline(&[a, b], pen);
    }

    /// Points that are not finite are left out.
    pub(crate) fn polyline(&mut self, points: &[P], pen: Pen) {
        let points: Vec<P> = points.iter().copied().filter(finite).collect();
        if points.len() < 2 {
            return;
        }
        let mut d = String::new();
        for (i, p) in points.iter().enumerate() {
            let _ = write!(d, "{}{} {}", if i == 0 { "M" } else { " L" }, px(p[0]), px(p[1]));
            self.cover(*p, pen.width / 2.0);
        }
        self.segments.extend(points.windows(2).map(|w| (w[0], w[1])));
        self.path(&d, "none", Some(pen));
    }

    /// Many separate lines in one element; no obstacle for labels.
    pub(crate) fn hairlines(&mut self, lines: &[(P, P)], pen: Pen) {
        let mut d = String::new();
        for (a, b) in lines.iter().filter(|(a, b)| finite(a) && finite(b)) {
            let _ = write!(d, "M{} {} L{} {} ", px(a[0]), px(a[1]), px(b[0]), px(b[1]));
        }
        if !d.is_empty() {
            self.path(d.trim_end(), "none", Some(pen));
        }
    }

    pub(crate) fn polygon(&mut self, points: &[P], fill: &str) {
        if points.len() < 3 || !points.iter().all(finite) {
            return;
        }
        let mut d = String::new();
        for (i, p) in points.iter().enumerate() {
            let _ = write!(d, "{}{} {}", if i == 0 { "M" } else { " L" }, px(p[0]), px(p[1]));
            self.cover(*p, 0.0);
        }
        d.push('Z');
        self.path(&d, fill, None);
    }

    fn path(&mut self, d: &str, fill: &str, pen: Option<Pen>) {
        let _ = writeln!(self.body, r#"<path d="{d}" fill="{fill}"{}/>"#, stroke(pen));
    }

    pub(crate) fn circle(&mut self, c: P, r: f64, fill: &str, pen: Option<Pen>) {
        if finite(&c) && r.is_finite() {
            self.cover(c, r + 1.0);
            let (x, y, r, pen) = (px(c[0]), px(c[1]), px(r), stroke(pen));
            let _ = writeln!(self.body, r#"<circle cx="{x}" cy="{y}" r="{r}" fill="{fill}"{pen}/>"#);
        }
    }

    /// Round marks in one element, a few bytes each.
    pub(crate) fn dots(&mut self, points: &[P], pen: Pen) {
        let mut d = String::new();
        for p in points.iter().filter(|p| finite(p)) {
            // a line without length is empty to some readers of PDF
            let _ = write!(d, "M{:.1} {:.1}h.01", p[0], p[1]);
            self.cover(*p, pen.width / 2.0);
        }
        if !d.is_empty() {
            self.path(&d, "none", Some(pen));
        }
    }

    pub(crate) fn rect(&mut self, r: Rect, fill: &str, pen: Option<Pen>) {
        if finite(&[r.x0, r.y0]) && finite(&[r.x1, r.y1]) {
            self.bounds.unite(r);
            let (x, y, w, h) = (px(r.x0), px(r.y0), px(r.width()), px(r.height()));
            let _ = writeln!(
                self.body,
                r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}"{}/>"#,
                stroke(pen)
            );
        }
    }

    /// A text with its baseline at `p`.
    pub(crate) fn text(&mut self, p: P, anchor: Anchor, style: Type, s: &str) {
        if !finite(&p) || s.is_empty() {
            return;
        }
        let width = style.width(s);
        let (x0, name) = match anchor {
            Anchor::Start => (p[0], "start"),
            Anchor::Middle => (p[0] - width / 2.0, "middle"),
            Anchor::End => (p[0] - width, "end"),
        };
        self.bounds.unite(Rect::new(x0, p[1] - style.size, x0 + width, p[1] + 0.25 * style.size));
        let weight = if style.bold { r#" font-weight="500""# } else { "" };
        let _ = writeln!(
            self.body,
            r#"<text x="{}" y="{}" font-size="{}" text-anchor="{name}" fill="{}"{weight}>{}</text>"#,
            px(p[0]),
            px(p[1]),
            px(style.size),
            style.colour,
            escape(s)
        );
    }

    /// An arrow whose head ends at `to`.
    pub(crate) fn arrow(&mut self, from: P, to: P, pen: Pen, head: f64) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy);
        if length.is_nan() || length < 1e-9 {
            return;
        }
        let (ux, uy) = (dx / length, dy / length);
        let head = head.min(length);
        let neck = [to[0] - 0.8 * head * ux, to[1] - 0.8 * head * uy];
        self.line(from, neck, pen);
        let (bx, by) = (to[0] - head * ux, to[1] - head * uy);
        let half = 0.38 * head;
        self.polygon(&[to, [bx - half * uy, by + half * ux], [bx + half * uy, by - half * ux]], pen.colour);
        self.segments.push((neck, to));
    }

    /// A diagonal cross, as a reading is marked.
    pub(crate) fn cross(&mut self, c: P, r: f64, pen: Pen) {
        self.line([c[0] - r, c[1] - r], [c[0] + r, c[1] + r], pen);
        self.line([c[0] - r, c[1] + r], [c[0] + r, c[1] - r], pen);
    }

    /// Points of an ellipse with half axes `a` and `b`, given as vectors, between two angles.
    pub(crate) fn ellipse(c: P, a: P, b: P, from: f64, to: f64) -> Vec<P> {
        let n = ((to - from).abs() / TAU * 48.0).ceil().max(2.0) as usize;
        (0..=n)
            .map(|i| {
                let (sin, cos) = (from + (to - from) * i as f64 / n as f64).sin_cos();
                [c[0] + a[0] * cos + b[0] * sin, c[1] + a[1] * cos + b[1] * sin]
            })
            .collect()
    }

    /// Adds another canvas, moved.
    pub(crate) fn place(&mut self, other: &Canvas, by: P) {
        let _ = writeln!(self.body, r#"<g transform="translate({} {})">"#, px(by[0]), px(by[1]));
        self.body.push_str(&other.body);
        self.body.push_str("</g>\n");
        let b = other.bounds;
        self.bounds.unite(Rect::new(b.x0 + by[0], b.y0 + by[1], b.x1 + by[0], b.y1 + by[1]));
    }

    /// The whole document; `title` is for those who cannot see it.
    pub(crate) fn finish(&self, width: f64, height: f64, title: &str) -> String {
        let (w, h) = (px(width.ceil()), px(height.ceil()));
        format!(
            concat!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" "#,
                r#"font-family="Roboto, Arial, Helvetica, sans-serif" stroke-linecap="round" "#,
                "stroke-linejoin=\"round\" role=\"img\">\n<title>{t}</title>\n",
                "<rect x=\"0\" y=\"0\" width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{b}</svg>\n"
            ),
            w = w,
            h = h,
            t = escape(title),
            b = self.body
        )
    }

    fn cover(&mut self, p: P, by: f64) {
        self.bounds.unite(Rect::new(p[0], p[1], p[0], p[1]).grown(by));
    }
}

fn finite(p: &P) -> bool {
    p[0].is_finite() && p[1].is_finite()
}

fn stroke(pen: Option<Pen>) -> String {
    let Some(pen) = pen else { return String::new() };
    let dash = pen.dash.map(|d| format!(r#" stroke-dasharray="{d}""#)).unwrap_or_default();
    format!(r#" stroke="{}" stroke-width="{}"{dash}"#, pen.colour, px(pen.width))
}

/// A coordinate with two decimals at most.
fn px(x: f64) -> String {
    let mut s = format!("{x:.2}");
    while s.ends_with('0') {
        s.pop();
    }
    if s.ends_with('.') {
        s.pop();
    }
    if s == "-0" { "0".to_owned() } else { s }
}
