//! Correlations of parameters as a shaded grid.

use crate::draw::{Anchor, Canvas, GRID, INK, MUTED, Rect, Type, WHITE};
use crate::text::{fit, fixed};
use nalgebra::DMatrix;

const CELL: [f64; 2] = [44.0, 24.0];
/// Widest name, px.
const NAME_ROOM: f64 = 190.0;
const NAME: Type = Type::new(12.0, INK);
const HEAD: Type = Type::new(11.0, MUTED);
/// Beyond this, numbers are white on their shade.
const DARK: f64 = 0.65;

/// Blue: rise together; vermilion: one rises as the other falls. Columns have the rows' numbers.
pub(crate) fn correlation_svg(names: &[&str], correlation: &DMatrix<f64>) -> String {
    let labels: Vec<String> = names
        .iter()
        .enumerate()
        .map(|(i, name)| fit(&format!("{}  {name}", i + 1), NAME_ROOM, |s| NAME.width(s)))
        .collect();
    let left = 8.0 + labels.iter().map(|label| NAME.width(label)).fold(0.0, f64::max);
    let corner = |i: usize, j: usize| [left + CELL[0] * j as f64, 20.0 + CELL[1] * i as f64];
    let mut page = Canvas::new();
    for (i, label) in labels.iter().enumerate() {
        let [x, y] = corner(0, i);
        page.text([x + CELL[0] / 2.0, y - 6.0], Anchor::Middle, HEAD, &(i + 1).to_string());
        page.text([left - 8.0, corner(i, 0)[1] + 16.0], Anchor::End, NAME, label);
        for j in 0..names.len() {
            let value = correlation[(i, j)];
            let [x, y] = corner(i, j);
            let fill = if i == j { GRID.to_owned() } else { shade(value) };
            page.rect(Rect::new(x, y, x + CELL[0] - 1.5, y + CELL[1] - 1.5), &fill, None);
            let colour = if i != j && value.abs() > DARK { WHITE } else { INK };
            let text = if i == j && value.is_finite() { "1".to_owned() } else { fixed(value, 2) };
            let middle = [x + (CELL[0] - 1.5) / 2.0, y + 15.5];
            page.text(middle, Anchor::Middle, Type::new(11.5, colour), &text);
        }
    }
    let [right, bottom] = corner(names.len(), names.len());
    page.finish(right + 2.0, bottom + 2.0, "Correlations")
}

/// From white at 0 to full colour at 1 and -1.
fn shade(value: f64) -> String {
    let full: [f64; 3] = if value < 0.0 { [213.0, 94.0, 0.0] } else { [11.0, 95.0, 173.0] };
    let part = if value.is_finite() { value.abs().min(1.0) } else { 0.0 };
    let [r, g, b] = full.map(|full| (255.0 + part * (full - 255.0)).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}
