//! Letters of single lines, for a laser to engrave.

use crate::planar::Point;

/// Width and height of a letter on its raster, and the gap to the next.
const WIDTH: f64 = 4.0;
const HEIGHT: f64 = 6.0;
const GAP: f64 = 2.0;

/// Lines of a letter: pairs of digits are points x y of the raster, spaces part the lines.
fn lines(letter: char) -> &'static str {
    match letter.to_ascii_uppercase() {
        '0' | 'O' => "103041453616050110",
        '1' => "152620 1030",
        '2' => "05163645440040",
        '3' => "05163645443313 334241301001",
        '4' => "30360242",
        '5' => "4606033342413000",
        '6' => "4536160501103041423303",
        '7' => "064610",
        '8' => "13040516364544331302011030414233",
        '9' => "0110304145361605041343",
        'A' => "0004264440 0242",
        'B' => "00063645443303 3342413000",
        'C' => "4536160501103041",
        'D' => "00062644422000",
        'E' => "46060040 0333",
        'F' => "460600 0333",
        'G' => "45361605011030414323",
        'H' => "0006 4046 0343",
        'I' => "1636 1030 2026",
        'J' => "4641301001",
        'K' => "0006 460340",
        'L' => "060040",
        'M' => "0006234640",
        'N' => "00064046",
        'P' => "00063645443303",
        'Q' => "103041453616050110 2240",
        'R' => "00063645443303 2340",
        'S' => "453616050413334241301001",
        'T' => "0646 2620",
        'U' => "060110304146",
        'V' => "062046",
        'W' => "0610233046",
        'X' => "0046 0640",
        'Y' => "0623 4623 2320",
        'Z' => "06460040",
        '.' => "2021",
        ',' => "2110",
        '-' => "1333",
        '+' => "0343 2125",
        '=' => "0444 0242",
        '/' => "0046",
        '(' => "36242230",
        ')' => "16242210",
        ':' => "2122 2425",
        '_' => "0040",
        ' ' => "",
        _ => "0006464000", // a box for what has no letter here
    }
}

/// Width of a text in letters of this height.
pub(super) fn width(text: &str, height: f64) -> f64 {
    let count = text.chars().count() as f64;
    (count * (WIDTH + GAP) - GAP).max(0.0) * height / HEIGHT
}

/// The lines of a text about a center.
pub(super) fn letters(text: &str, center: Point, height: f64) -> Vec<Vec<Point>> {
    let scale = height / HEIGHT;
    let corner = center - Point::new(width(text, height), height) / 2.0;
    let mut strokes = Vec::new();
    for (i, letter) in text.chars().enumerate() {
        let left = i as f64 * (WIDTH + GAP);
        let point = |pair: &[u8]| {
            let [x, y] = [pair[0], pair[1]].map(|digit| f64::from(digit - b'0'));
            corner + scale * Point::new(left + x, y)
        };
        let drawn = lines(letter).split(' ').filter(|line| !line.is_empty());
        strokes.extend(drawn.map(|line| line.as_bytes().chunks_exact(2).map(point).collect()));
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line that is engraved twice burns twice as deep.
    #[test]
    fn letters_stay_in_their_box_and_repeat_no_line() {
        for letter in (' '..='~').filter(|letter| !letter.is_ascii_lowercase()) {
            let mut seen = Vec::new();
            assert_eq!(lines(letter).replace(' ', "").len() % 2, 0, "{letter}");
            for stroke in letters(&letter.to_string(), Point::zeros(), 6.0) {
                assert!(stroke.iter().all(|p| p.x.abs() <= 2.0 && p.y.abs() <= 3.0), "{letter}");
                for pair in stroke.windows(2) {
                    assert!(pair[0] != pair[1], "{letter}");
                    assert!(
                        !seen.contains(&(pair[0], pair[1])) && !seen.contains(&(pair[1], pair[0])),
                        "{letter}"
                    );
                    seen.push((pair[0], pair[1]));
                }
            }
        }
        assert_eq!(width("10", 6.0), 10.0);
    }
}
