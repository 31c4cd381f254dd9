//! Numbers and tables for people.

use std::fmt::Write;

/// Millimetres per metre.
pub(crate) const MM: f64 = 1e3;

/// Columns two spaces apart; the first to the left if it holds words, numbers to the right.
pub(crate) fn aligned(table: &[Vec<String>]) -> String {
    let columns = table.iter().map(Vec::len).max().unwrap_or(0);
    let cells = |column: usize| table.iter().filter_map(move |row| row.get(column));
    let widths: Vec<usize> =
        (0..columns).map(|c| cells(c).map(|cell| cell.chars().count()).max().unwrap_or(0)).collect();
    let words: Vec<bool> = (0..columns)
        .map(|c| {
            cells(c).skip(1).any(|cell| cell.chars().any(|letter| letter.is_alphabetic() && letter != 'e'))
        })
        .collect();
    let mut text = String::new();
    for row in table {
        let mut line = String::new();
        for (c, cell) in row.iter().enumerate() {
            let width = widths[c];
            let _ =
                if words[c] { write!(line, "  {cell:<width$}") } else { write!(line, "  {cell:>width$}") };
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// A line of a summary.
pub(crate) fn line(name: &str, value: &str) -> String {
    format!("  {name:<23} {value}\n")
}

/// Smaller than this part of the largest component is rounding.
const ROUNDING: f64 = 1e-12;

/// A vector with four significant digits in each component.
pub(crate) fn significant(vector: &[f64], unit: f64) -> String {
    let largest = vector.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let component = |x: &f64| if x.abs() <= ROUNDING * largest { "0".to_owned() } else { four(x * unit) };
    format!("[{}]", vector.iter().map(component).collect::<Vec<_>>().join(", "))
}

fn four(value: f64) -> String {
    let scientific = format!("{value:.3e}");
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    match exponent {
        -4..=5 => format!("{value:.*}", usize::try_from(3 - exponent).unwrap_or(0)),
        _ => scientific,
    }
}

/// A vector with fixed decimals.
pub(crate) fn components(vector: &[f64], unit: f64, digits: usize) -> String {
    let components: Vec<String> = vector.iter().map(|x| fixed(x * unit, digits)).collect();
    format!("[{}]", components.join(", "))
}

/// Fixed decimals, and no sign on what rounds to zero.
pub(crate) fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_owned(),
        _ => text,
    }
}
