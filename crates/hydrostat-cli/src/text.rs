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
