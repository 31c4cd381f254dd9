//! Predicted shapes over millimetre paper, with what was observed.

use crate::draw::{ACCENT, Anchor, Canvas, GRID_HEAVY, INK, MUTED, P, Pen, Rect, SECOND, Type};
use crate::labels::{self, Label, Obstacles};
use crate::text::{fixed, millimetres};
use crate::ticks::{decimals, nice_step, ticks};
use hydrostat::verify::{Experiment, PointError, Verification, VerifiedRow};
use nalgebra::Vector3;

pub(crate) const MODEL: Pen = Pen::new(ACCENT, 1.6);
pub(crate) const CONSTANT_CURVATURE: Pen = Pen::dashed(SECOND, 1.1, "5 3.5");
const FINE: &str = "#eceff3";
const MEDIUM: &str = "#d3dae1";
const ROOM: [f64; 2] = [690.0, 560.0];
const SMALL: Type = Type::new(11.0, MUTED);
/// More rows than this are not all labelled.
const LABELS: usize = 14;

/// Two of the bench's axes as they lie on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    pub(crate) right: usize,
    pub(crate) up: usize,
    /// -1 where gravity points along the positive axis, so that down is down.
    pub(crate) up_sign: f64,
}

pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

impl Plane {
    fn on_page(&self, p: &Vector3<f64>, scale: f64) -> P {
        [scale * p[self.right], -scale * self.up_sign * p[self.up]]
    }
}

impl Plane {
    /// Whether a measured point has its place in this plane: both axes were read, or the only one that was.
    pub(crate) fn shows(self, experiment: &Experiment, point: usize) -> bool {
        let Some(point) = experiment.points.get(point) else { return true };
        let read = [self.right, self.up].map(|axis| point.axes.contains(&axis));
        if point.axes.len() > 1 { read == [true, true] } else { read != [false, false] }
    }
}

/// The plane that was measured; two planes where three axes were, or where the shape leaves the plane.
pub(crate) fn planes(experiment: &Experiment, verification: &Verification) -> Vec<Plane> {
    let gravity = experiment.axes.rotation.inverse() * experiment.robot.gravity;
    let mut extent = [0.0_f64; 3];
    for p in verification.rows.iter().flat_map(|row| &row.shape) {
        for (e, x) in extent.iter_mut().zip(p.iter()) {
            *e = e.max(x.abs());
        }
    }
    let read = |axis: usize| experiment.points.iter().any(|p| p.axes.contains(&axis));
    let length = experiment.robot.length();
    let shown: Vec<usize> = (0..3).filter(|&i| read(i) || extent[i] > 0.02 * length).collect();
    // the measured axis nearest to gravity stands upright
    let up =
        (0..3).max_by(|&i, &j| rank(&shown, &gravity, i).total_cmp(&rank(&shown, &gravity, j))).unwrap_or(1);
    let up_sign = if gravity[up] > 0.7 * gravity.norm() && gravity.norm() > 0.0 { -1.0 } else { 1.0 };
    let mut across: Vec<usize> = shown.into_iter().filter(|&i| i != up).collect();
    if across.is_empty() {
        across.push((up + 1) % 3);
    }
    across.into_iter().map(|right| Plane { right, up, up_sign }).collect()
}

/// How suitable an axis is to stand upright: along gravity, else the last of those shown.
fn rank(shown: &[usize], gravity: &Vector3<f64>, axis: usize) -> f64 {
    let known = if shown.contains(&axis) || shown.is_empty() { 10.0 } else { 0.0 };
    let along = if gravity.norm() > 0.0 { (gravity[axis] / gravity.norm()).abs() } else { 0.0 };
    known + if along > 0.3 { along } else { 0.01 * axis as f64 }
}

/// The point of a shape at an arc length; shapes are evenly spaced.
pub(crate) fn along(shape: &[Vector3<f64>], fraction: f64) -> Option<Vector3<f64>> {
    let last = shape.len().checked_sub(1)?;
    let x = if fraction.is_finite() { fraction.clamp(0.0, 1.0) * last as f64 } else { last as f64 };
    let i = (x.floor() as usize).min(last);
    let next = shape.get(i + 1).unwrap_or(&shape[i]);
    Some(shape[i].lerp(next, x - i as f64))
}

/// The observed point, on axes that were not read where the model has it.
pub(crate) fn observed(
    experiment: &Experiment,
    row: &VerifiedRow,
    j: usize,
    point: &PointError,
) -> Vector3<f64> {
    let mut p = along(&row.shape, point.at / experiment.robot.length()).unwrap_or(point.predicted);
    for &axis in experiment.points.get(j).map_or(&[0, 1, 2][..], |p| &p.axes).iter().filter(|&&a| a < 3) {
        p[axis] = point.observed[axis];
    }
    p
}

/// Draws all rows in each plane of the bench, to one scale; `names` label the rows.
pub(crate) fn shapes_svgs(
    experiment: &Experiment,
    verification: &Verification,
    planes: &[Plane],
    names: &[String],
) -> Vec<String> {
    let mut extents: Vec<Rect> = planes.iter().map(|&p| extent(experiment, verification, p)).collect();
    let low = extents.iter().map(|e| e.y1).fold(f64::NEG_INFINITY, f64::max);
    let high = extents.iter().map(|e| e.y0).fold(f64::INFINITY, f64::min);
    extents.iter_mut().for_each(|e| (e.y0, e.y1) = (high, low));
    let widths: f64 = extents.iter().map(Rect::width).sum();
    let scale = ((ROOM[0] - 130.0 * (planes.len() as f64 - 1.0)) / widths).min(ROOM[1] / (low - high));
    let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1000.0 };
    let planes = planes.iter().zip(extents);
    planes.map(|(&plane, extent)| shapes_svg(experiment, verification, plane, extent, scale, names)).collect()
}

/// The region that one plane shows, m, with down as on the page.
fn extent(experiment: &Experiment, verification: &Verification, plane: Plane) -> Rect {
    let mut extent = Rect::EMPTY;
    extent.include([0.0, 0.0]);
    for row in &verification.rows {
        let points = row.points.iter().enumerate().map(|(j, p)| observed(experiment, row, j, p));
        for p in row.shape.iter().chain(&row.constant_curvature_shape).copied().chain(points) {
            extent.include(plane.on_page(&p, 1.0));
        }
    }
    let length = experiment.robot.length();
    extent.at_least(0.25 * length, 0.2 * length)
}

/// One plane: predicted shapes solid, constant curvature dashed, observations as crosses.
fn shapes_svg(
    experiment: &Experiment,
    verification: &Verification,
    plane: Plane,
    extent: Rect,
    scale: f64,
    names: &[String],
) -> String {
    let length = experiment.robot.length();

    // the drawing, in px from the bench's origin
    let mut scene = Canvas::new();
    for row in &verification.rows {
        let line = |shape: &[Vector3<f64>]| shape.iter().map(|p| plane.on_page(p, scale)).collect::<Vec<_>>();
        scene.polyline(&line(&row.constant_curvature_shape), CONSTANT_CURVATURE);
        scene.polyline(&line(&row.shape), MODEL);
    }
    let mut obstacles = Obstacles::default();
    let mut wanted = Vec::new();
    let every = verification.rows.len().div_ceil(LABELS).max(1);
    for (i, row) in verification.rows.iter().enumerate() {
        for (j, point) in row.points.iter().enumerate() {
            if !plane.shows(experiment, j) {
                continue;
            }
            let c = plane.on_page(&observed(experiment, row, j, point), scale);
            scene.cross(c, 4.2, Pen::new(INK, 1.3));
            obstacles.boxes.push(Rect::centred(c, 8.0, 8.0));
            let outermost = j + 1 == row.points.len();
            if outermost && (i % every == 0 || i + 1 == verification.rows.len()) {
                let before = along(&row.shape, point.at / length - 0.02)
                    .map(|p| plane.on_page(&p, scale))
                    .unwrap_or(c);
                let text = names.get(i).cloned().unwrap_or_default();
                let prefer = [c[0] - before[0], c[1] - before[1] + 1e-6];
                wanted.push(Label { at: c, prefer, text, style: Type::new(11.0, INK) });
            }
        }
    }
    // enough of the lines to keep labels off them
    let every = scene.segments.len().div_ceil(4000).max(1);
    obstacles.lines.extend(scene.segments.iter().step_by(every));
    labels::place(&mut scene, &mut obstacles, &wanted);

    // the paper: whole heavy squares around the drawing
    let fine = if scale * 1e-3 >= 1.2 { 1e-3 } else { nice_step(1.2 / scale) };
    let fine = if scale * 1e-3 > 40.0 { 1e-4 } else { fine };
    let heavy = 10.0 * fine;
    let square = heavy * scale;
    let mut b = scene.bounds.grown(8.0);
    b.unite(Rect::new(extent.x0 * scale, extent.y0 * scale, extent.x1 * scale, extent.y1 * scale));
    let frame = Rect::new(
        (b.x0 / square).floor() * square,
        (b.y0 / square).floor() * square,
        (b.x1 / square).ceil() * square,
        (b.y1 / square).ceil() * square,
    );
    let (left, top) = (46.0, 26.0);
    let origin = [left - frame.x0, top - frame.y0];
    let mut page = Canvas::new();
    paper(&mut page, frame, origin, fine * scale, Pen::new(FINE, 0.5));
    paper(&mut page, frame, origin, square, Pen::new(MEDIUM, 0.8));
    numbers(&mut page, plane, frame, origin, scale, heavy);
    page.place(&scene, origin);
    let title = format!("Predicted shapes and observed points, {} and {}", AXES[plane.right], AXES[plane.up]);
    page.finish(left + frame.width() + 16.0, top + frame.height() + 40.0, &title)
}

fn paper(page: &mut Canvas, frame: Rect, origin: P, step: f64, pen: Pen) {
    let (x0, x1) = (frame.x0 + origin[0], frame.x1 + origin[0]);
    let (y0, y1) = (frame.y0 + origin[1], frame.y1 + origin[1]);
    let upright =
        ticks(frame.x0, frame.x1, step).into_iter().map(|x| ([x + origin[0], y0], [x + origin[0], y1]));
    let level =
        ticks(frame.y0, frame.y1, step).into_iter().map(|y| ([x0, y + origin[1]], [x1, y + origin[1]]));
    page.hairlines(&upright.chain(level).collect::<Vec<_>>(), pen);
}

/// Coordinates in mm along the left and lower edges.
fn numbers(page: &mut Canvas, plane: Plane, frame: Rect, origin: P, scale: f64, heavy: f64) {
    let (x0, x1) = (frame.x0 + origin[0], frame.x1 + origin[0]);
    let (y0, y1) = (frame.y0 + origin[1], frame.y1 + origin[1]);
    page.rect(Rect::new(x0, y0, x1, y1), "none", Some(Pen::new(GRID_HEAVY, 1.0)));
    let step = nice_step((40.0 / scale).max(heavy));
    for x in ticks(frame.x0 / scale, frame.x1 / scale, step) {
        let px = x * scale + origin[0];
        page.line([px, y1], [px, y1 + 4.0], Pen::new(MUTED, 1.0));
        page.text([px, y1 + 16.0], Anchor::Middle, SMALL, &fixed(1e3 * x, decimals(1e3 * step)));
    }
    let step = nice_step((24.0 / scale).max(heavy));
    for up in ticks(-frame.y1 / scale, -frame.y0 / scale, step) {
        let py = origin[1] - up * scale;
        page.line([x0 - 4.0, py], [x0, py], Pen::new(MUTED, 1.0));
        page.text(
            [x0 - 7.0, py + 4.0],
            Anchor::End,
            SMALL,
            &fixed(1e3 * up * plane.up_sign, decimals(1e3 * step)),
        );
    }
    let lines = format!("lines every {}, heavy every {}", millimetres(0.1 * heavy), millimetres(heavy));
    if frame.width() > 260.0 {
        page.text([x1, y0 - 9.0], Anchor::End, SMALL, &lines);
    }
    let name = Type::new(12.0, INK);
    page.text([(x0 + x1) / 2.0, y1 + 33.0], Anchor::Middle, name, &format!("{} in mm", AXES[plane.right]));
    page.text([x0, y0 - 9.0], Anchor::Start, name, &format!("{} in mm", AXES[plane.up]));
}
