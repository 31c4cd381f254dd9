//! A framed field with a grid, its values along both edges.

use crate::draw::{Anchor, Canvas, GRID, GRID_HEAVY, INK, MUTED, P, Pen, Rect, Type};
use crate::text::fixed;
use crate::ticks::{decimals, ticks};

pub(crate) const SMALL: Type = Type::new(11.0, MUTED);
pub(crate) const NAME: Type = Type::new(12.0, INK);
/// Of the reading error.
pub(crate) const BAND: &str = "#dfe4ea";
/// Room between the frame and the first and last value, px.
const MARGIN: f64 = 14.0;

/// Where values lie on the page: `x` and `y` are the lowest and highest shown.
pub(crate) struct Panel {
    pub(crate) frame: Rect,
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
}

impl Panel {
    pub(crate) fn at(&self, p: P) -> P {
        let Panel { frame, x, y } = self;
        [
            frame.x0 + MARGIN + (frame.width() - 2.0 * MARGIN) * (p[0] - x[0]) / (x[1] - x[0]),
            frame.y0 + frame.height() * (1.0 - (p[1] - y[0]) / (y[1] - y[0])),
        ]
    }

    /// The values from one to another, over the whole width.
    pub(crate) fn band(&self, page: &mut Canvas, [low, high]: [f64; 2], colour: &str) {
        let [bottom, top] =
            [low, high].map(|y| self.at([self.x[0], y])[1].clamp(self.frame.y0, self.frame.y1));
        page.rect(Rect::new(self.frame.x0, top, self.frame.x1, bottom), colour, None);
    }

    /// Lines, numbers where there is room for them, and the frame.
    pub(crate) fn grid(&self, page: &mut Canvas, [step_x, step_y]: [f64; 2]) {
        let Panel { frame, x, y } = self;
        let mut lines = Vec::new();
        for value in ticks(y[0], y[1], step_y) {
            let py = self.at([x[0], value])[1];
            lines.push(([frame.x0, py], [frame.x1, py]));
            page.text([frame.x0 - 7.0, py + 4.0], Anchor::End, SMALL, &fixed(value, decimals(step_y)));
        }
        let mut free_from = 0.0;
        for value in ticks(x[0], x[1], step_x) {
            let px = self.at([value, y[0]])[0];
            lines.push(([px, frame.y0], [px, frame.y1]));
            let text = fixed(value, decimals(step_x));
            let half = SMALL.width(&text) / 2.0;
            if px - half < free_from {
                continue;
            }
            free_from = px + half + 5.0;
            page.text([px, frame.y1 + 16.0], Anchor::Middle, SMALL, &text);
        }
        page.hairlines(&lines, Pen::new(GRID, 1.0));
        page.rect(*frame, "none", Some(Pen::new(GRID_HEAVY, 1.0)));
    }
}

/// Lowest and highest, apart from each other.
pub(crate) fn range(xs: &[f64]) -> [f64; 2] {
    let finite = || xs.iter().copied().filter(|x| x.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    if low > high {
        [0.0, 1.0]
    } else if high - low <= 1e-9 * high.abs() {
        let half = if high == 0.0 { 1.0 } else { 0.5 * high.abs() };
        [low - half, high + half]
    } else {
        [low, high]
    }
}
