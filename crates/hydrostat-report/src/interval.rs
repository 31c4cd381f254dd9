//! An estimate on a line: interval, value, and what was stated.

use crate::draw::{ACCENT, ACCENT_LIGHT, Canvas, GRID_HEAVY, INK, Pen, Rect};
use crate::panel::range;
use hydrostat::calibrate::Estimate;

const SIZE: [f64; 2] = [130.0, 20.0];
const MARGIN: f64 = 8.0;

/// One row for a table; the scale is the estimate's own.
pub(crate) fn interval_svg(estimate: &Estimate) -> String {
    let Estimate { before, value, interval_95, .. } = estimate;
    let mut shown = vec![*before, *value];
    shown.extend(interval_95.iter().flatten());
    let [low, high] = range(&shown);
    let x = |value: f64| MARGIN + (SIZE[0] - 2.0 * MARGIN) * (value - low) / (high - low);
    let middle = SIZE[1] / 2.0;

    let mut page = Canvas::new();
    page.line([2.0, middle], [SIZE[0] - 2.0, middle], Pen::new(GRID_HEAVY, 1.0));
    if let Some([low, high]) = interval_95 {
        page.rect(Rect::new(x(*low), middle - 3.5, x(*high), middle + 3.5), ACCENT_LIGHT, None);
    }
    page.line([x(*before), 2.0], [x(*before), SIZE[1] - 2.0], Pen::new(INK, 1.6));
    page.circle([x(*value), middle], 3.6, ACCENT, None);
    page.finish(SIZE[0], SIZE[1], "Interval, value and stated value")
}
