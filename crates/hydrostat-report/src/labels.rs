//! Finds room for labels: never on another label, on lines as little as possible.

use crate::draw::{Anchor, Canvas, INK, MUTED, P, Pen, Rect, Type, WHITE};
use std::f64::consts::TAU;

/// A text that belongs to a point.
pub(crate) struct Label {
    pub(crate) at: P,
    /// Where it would best stand, seen from the point (px right, px down).
    pub(crate) prefer: P,
    pub(crate) text: String,
    pub(crate) style: Type,
}

/// What labels must not cover (`boxes`) and should not cover (`lines`).
#[derive(Default)]
pub(crate) struct Obstacles {
    pub(crate) boxes: Vec<Rect>,
    pub(crate) lines: Vec<(P, P)>,
    /// What labels should not leave.
    pub(crate) within: Option<Rect>,
}

const DISTANCES: [f64; 14] =
    [7.0, 11.0, 16.0, 23.0, 32.0, 43.0, 56.0, 72.0, 92.0, 120.0, 155.0, 200.0, 270.0, 380.0];
const DIRECTIONS: usize = 24;

/// Sets each label where there is room, with a thin leader where it stands far from its point.
pub(crate) fn place(canvas: &mut Canvas, obstacles: &mut Obstacles, labels: &[Label]) {
    for label in labels {
        let (width, height) = (label.style.width(&label.text) + 6.0, label.style.height() + 1.0);
        if !(label.at[0].is_finite() && label.at[1].is_finite()) {
            continue;
        }
        let spot = best_spot(obstacles, label, width, height);
        let edge = [label.at[0].clamp(spot.x0, spot.x1), label.at[1].clamp(spot.y0, spot.y1)];
        let gap = (edge[0] - label.at[0]).hypot(edge[1] - label.at[1]);
        if gap > 17.0 {
            // from beside the point's own mark
            let t = 7.0 / gap;
            let start =
                [label.at[0] + t * (edge[0] - label.at[0]), label.at[1] + t * (edge[1] - label.at[1])];
            let colour = if label.style.colour == INK { MUTED } else { label.style.colour };
            canvas.line(start, edge, Pen::new(colour, 0.6));
            obstacles.lines.push((label.at, edge));
        }
        canvas.rect(spot, WHITE, None);
        let baseline = spot.y0 + 0.5 * height + 0.36 * label.style.size;
        canvas.text([(spot.x0 + spot.x1) / 2.0, baseline], Anchor::Middle, label.style, &label.text);
        obstacles.boxes.push(spot);
    }
}

fn best_spot(obstacles: &Obstacles, label: &Label, width: f64, height: f64) -> Rect {
    let preferred = label.prefer[1].atan2(label.prefer[0]);
    let mut best: Option<(f64, Rect)> = None;
    for distance in DISTANCES {
        for i in 0..DIRECTIONS {
            // 0, +1, -1, +2, -2, ...
            let turn = i.div_ceil(2) as f64 * if i % 2 == 1 { 1.0 } else { -1.0 };
            let (sin, cos) = (preferred + turn * TAU / DIRECTIONS as f64).sin_cos();
            // the distance is from the point to the box's edge along that direction
            let reach = distance + (width / 2.0 * cos.abs()).hypot(height / 2.0 * sin.abs());
            let spot = Rect::centred([label.at[0] + reach * cos, label.at[1] + reach * sin], width, height);
            if obstacles.boxes.iter().any(|b| b.grown(1.5).overlaps(&spot)) {
                continue;
            }
            let outside = obstacles
                .within
                .is_some_and(|w| spot.x0 < w.x0 || spot.y0 < w.y0 || spot.x1 > w.x1 || spot.y1 > w.y1);
            let base_cost = distance + 2.5 * turn.abs() + if outside { 1000.0 } else { 0.0 };
            if best.as_ref().is_some_and(|(cost, _)| base_cost >= *cost) {
                continue;
            }
            let crossed = obstacles.lines.iter().filter(|(a, b)| crosses(*a, *b, &spot)).count();
            let edge = [label.at[0].clamp(spot.x0, spot.x1), label.at[1].clamp(spot.y0, spot.y1)];
            let hidden = obstacles.boxes.iter().any(|b| crosses(label.at, edge, b));
            let cost = base_cost + 45.0 * (crossed as f64).sqrt() + if hidden { 120.0 } else { 0.0 };
            if best.as_ref().is_none_or(|(c, _)| cost < *c) {
                best = Some((cost, spot));
            }
        }
    }
    best.map(|(_, spot)| spot).unwrap_or_else(|| {
        // no room anywhere near: below everything
        let bottom = obstacles.boxes.iter().map(|b| b.y1).fold(label.at[1], f64::max);
        Rect::centred([label.at[0], bottom + height], width, height)
    })
}

/// Whether a segment and a rectangle meet (Liang-Barsky).
fn crosses(a: P, b: P, r: &Rect) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (start, delta, low, high) in [(a[0], b[0] - a[0], r.x0, r.x1), (a[1], b[1] - a[1], r.y0, r.y1)] {
        if delta.abs() < 1e-12 {
            if start < low || start > high {
                return false;
            }
            continue;
        }
        let (t0, t1) = ((low - start) / delta, (high - start) / delta);
        from = from.max(t0.min(t1));
        to = to.min(t0.max(t1));
    }
    from <= to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_one_point_never_overlap() {
        let labels: Vec<Label> = (0..30)
            .map(|i| Label {
                at: [0.0, 0.0],
                prefer: [1.0, 0.0],
                text: format!("label {i}"),
                style: Type::new(12.0, INK),
            })
            .collect();
        let mut obstacles = Obstacles::default();
        place(&mut Canvas::new(), &mut obstacles, &labels);
        for (i, a) in obstacles.boxes.iter().enumerate() {
            assert!(obstacles.boxes[..i].iter().all(|b| !a.overlaps(b)));
        }
    }
}
