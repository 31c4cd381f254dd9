//! Loads as arrows.

use crate::draw::{Canvas, P, Pen, SECOND, Type, WHITE};
use crate::labels::Label;
use crate::text::{mass, prefixed};
use crate::view::View;
use hydrostat::model::{Frame, LoadKind};
use hydrostat::{Equilibrium, Robot};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

const PEN: Pen = Pen::new(SECOND, 1.8);
const THIN: Pen = Pen::new(SECOND, 1.1);
const ARROW: f64 = 46.0;
const ROW_ARROW: f64 = 15.0;
const ROW_SPACING: f64 = 17.0;

/// The bent backbone as the drawing needs it: where it is at an arc length, and how it is turned there.
pub(crate) struct Shape<'a> {
    pub(crate) equilibrium: &'a Equilibrium,
    pub(crate) base: Vector3<f64>,
    /// px per m.
    pub(crate) scale: f64,
}

impl Shape<'_> {
    /// On the page, from the base.
    pub(crate) fn on_page(&self, view: &View, p: &Vector3<f64>) -> P {
        let q = view.project(&(p - self.base));
        [self.scale * q[0], -self.scale * q[1]]
    }

    /// Position and rotation at an arc length, between stations on the chord.
    pub(crate) fn at(&self, s: f64) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        let stations = &self.equilibrium.stations;
        let last = stations.last()?;
        let i = stations.partition_point(|station| station.s <= s);
        if i == 0 {
            return stations.first().map(|a| (a.position, a.rotation));
        }
        if i == stations.len() {
            return Some((last.position, last.rotation));
        }
        let (a, b) = (&stations[i - 1], &stations[i]);
        let t = (s - a.s) / (b.s - a.s);
        Some((a.position.lerp(&b.position, t), if t < 0.5 { a.rotation } else { b.rotation }))
    }

    /// Unit tangent on the page; None where the backbone points at the viewer.
    pub(crate) fn tangent(&self, view: &View, s: f64) -> Option<P> {
        let (_, rotation) = self.at(s)?;
        let t = view.project(&rotation.column(2).into_owned());
        let n = t[0].hypot(t[1]);
        (n > 0.05).then(|| [t[0] / n, -t[1] / n])
    }
}

/// Draws every load of the robot and asks for its label.
pub(crate) fn draw(canvas: &mut Canvas, labels: &mut Vec<Label>, robot: &Robot, shape: &Shape, view: &View) {
    let mut drawn: Vec<(f64, Vector3<f64>)> = Vec::new();
    for load in &robot.loads {
        let named = |value: String| match &load.name {
            Some(name) => format!("{name}: {value}"),
            None => value,
        };
        match load.kind {
            LoadKind::Mass { at, mass: kg } => {
                let Some((p, _)) = shape.at(at) else { continue };
                let text = named(mass(kg));
                force(canvas, labels, shape.on_page(view, &p), view, &robot.gravity, at, &mut drawn, text);
            }
            LoadKind::Point { at, force: f, moment, frame } => {
                let Some((p, rotation)) = shape.at(at) else {
                    continue;
                };
                let turn = if frame == Frame::Body { rotation } else { Matrix3::identity() };
                let p = shape.on_page(view, &p);
                if f.norm() > 0.0 {
                    let text = named(prefixed(f.norm(), "N"));
                    force(canvas, labels, p, view, &(turn * f), at, &mut drawn, text);
                }
                if moment.norm() > 0.0 {
                    let end = arc(canvas, p, view, &(turn * moment), 17.0, PEN);
                    let text = named(prefixed(moment.norm(), "N m"));
                    labels.push(label(end, [end[0] - p[0], end[1] - p[1]], text));
                }
            }
            LoadKind::Distributed { from, to, force_per_length: f, moment_per_length: m, frame } => {
                let text = [(f.norm(), "N/m"), (m.norm(), "N")]
                    .iter()
                    .filter(|(value, _)| *value > 0.0)
                    .map(|(value, unit)| prefixed(*value, unit))
                    .collect::<Vec<_>>()
                    .join(", ");
                row(canvas, labels, shape, view, [from, to], [&f, &m], frame, named(text));
            }
        }
    }
}

/// A force's arrow, from the point where it acts; a circle where it points at the viewer or away.
#[allow(clippy::too_many_arguments)]
fn force(
    canvas: &mut Canvas,
    labels: &mut Vec<Label>,
    p: P,
    view: &View,
    f: &Vector3<f64>,
    at: f64,
    drawn: &mut Vec<(f64, Vector3<f64>)>,
    text: String,
) {
    let norm = f.norm();
    if !norm.is_finite() || norm == 0.0 {
        labels.push(label(p, [0.0, 1.0], text));
        return;
    }
    let direction = f / norm;
    // forces along the same line stand one behind the other
    let before = drawn.iter().filter(|(s, d)| (s - at).abs() < 1e-9 && d.dot(&direction) > 0.99).count();
    drawn.push((at, direction));
    let d = view.project(&direction);
    let across = d[0].hypot(d[1]);
    if across < 0.2 {
        canvas.circle(p, 6.5, WHITE, Some(PEN));
        if direction.dot(&view.away()) > 0.0 {
            canvas.cross(p, 4.0, Pen::new(SECOND, 1.4));
        } else {
            canvas.circle(p, 2.0, SECOND, None);
        }
        labels.push(label(p, [1.0, -1.0], text));
        return;
    }
    let length = ARROW * across.max(0.45) / across + 26.0 * before as f64 / across;
    let tip = [p[0] + length * d[0], p[1] - length * d[1]];
    canvas.arrow(p, tip, PEN, 10.0);
    labels.push(label(tip, [d[0], -d[1]], text));
}

/// An arc of three quarters of a turn about the moment's axis, as seen; returns the end of its arrow.
fn arc(canvas: &mut Canvas, c: P, view: &View, moment: &Vector3<f64>, radius: f64, pen: Pen) -> P {
    let axis = moment / moment.norm();
    let m = view.project(&axis);
    let toward = -axis.dot(&view.away());
    let across = m[0].hypot(m[1]);
    // the half axis along which the circle is foreshortened, and the one at right angles to it
    let thin = if across > 1e-9 { [m[0] / across, -m[1] / across] } else { [0.0, -1.0] };
    let wide = [-thin[1], thin[0]];
    let squeeze = toward.abs().max(0.3) * if toward < -1e-9 { -1.0 } else { 1.0 };
    let a = [radius * wide[0], radius * wide[1]];
    let b = [-radius * squeeze * thin[0], -radius * squeeze * thin[1]];
    // counter-clockwise about an axis that points at the viewer; y is down on the page
    let (a, b) = (a, [-b[0], -b[1]]);
    let points = Canvas::ellipse(c, a, b, -0.125 * TAU, 0.6 * TAU);
    let n = points.len();
    canvas.polyline(&points[..n - 2], pen);
    canvas.arrow(points[n - 4], points[n - 1], pen, if radius > 10.0 { 9.0 } else { 5.0 });
    points[n / 2]
}

/// Small arrows along the part of the backbone a distributed load acts on.
#[allow(clippy::too_many_arguments)]
fn row(
    canvas: &mut Canvas,
    labels: &mut Vec<Label>,
    shape: &Shape,
    view: &View,
    [from, to]: [f64; 2],
    [force, moment]: [&Vector3<f64>; 2],
    frame: Frame,
    text: String,
) {
    let count = ((to - from).abs() * shape.scale / ROW_SPACING).ceil();
    if !count.is_finite() {
        return;
    }
    let count = (count as usize).clamp(2, 60);
    let (mut tails, mut ends) = (Vec::new(), Vec::new());
    for i in 0..=count {
        let s = from + (to - from) * i as f64 / count as f64;
        let Some((p, rotation)) = shape.at(s) else { return };
        let turn = if frame == Frame::Body { rotation } else { Matrix3::identity() };
        let p = shape.on_page(view, &p);
        if force.norm() > 0.0 {
            let d = view.project(&(turn * force / force.norm()));
            if d[0].hypot(d[1]) < 0.2 {
                canvas.circle(p, 2.5, WHITE, Some(THIN));
                tails.push(p);
            } else {
                let end = [p[0] + ROW_ARROW * d[0], p[1] - ROW_ARROW * d[1]];
                canvas.arrow(p, end, THIN, 5.0);
                tails.push(end);
            }
        }
        if moment.norm() > 0.0 && (i % 2 == 1 || count < 4) {
            let end = arc(canvas, p, view, &(turn * moment), 7.0, THIN);
            if force.norm() == 0.0 {
                ends.push(end);
            }
        }
    }
    canvas.polyline(&tails, Pen::new(SECOND, 0.6));
    tails.append(&mut ends);
    if let Some(&middle) = tails.get(tails.len() / 2) {
        let (p, _) = shape.at(0.5 * (from + to)).unwrap_or((shape.base, Matrix3::identity()));
        let p = shape.on_page(view, &p);
        labels.push(label(middle, [middle[0] - p[0], middle[1] - p[1] + 1e-3], text));
    }
}

fn label(at: P, prefer: P, text: String) -> Label {
    Label { at, prefer, text, style: Type::bold(12.5, SECOND) }
}
