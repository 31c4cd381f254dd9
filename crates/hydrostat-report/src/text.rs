//! Numbers and words as they are printed, and how wide they are.

/// Advance widths of ASCII 32 to 126 in Roboto, thousandths of the size.
const ADVANCE: [u16; 95] = [
    248, 258, 320, 616, 562, 732, 622, 175, 342, 348, 431, 567, 197, 276, 264, 413, 562, 562, 562, 562, 562,
    562, 562, 562, 562, 562, 242, 211, 508, 549, 523, 473, 898, 652, 623, 651, 656, 568, 553, 681, 713, 272,
    552, 627, 539, 873, 713, 688, 631, 688, 616, 594, 597, 648, 637, 887, 627, 601, 599, 265, 411, 265, 418,
    451, 309, 544, 562, 523, 564, 530, 348, 562, 551, 243, 239, 507, 243, 877, 552, 570, 562, 568, 339, 516,
    327, 551, 484, 751, 496, 473, 496, 338, 244, 338, 680,
];

/// Width of a text, px, for a font size in px.
pub(crate) fn width(s: &str, size: f64) -> f64 {
    let thousandths: f64 = s
        .chars()
        .map(|c| match (c as usize).checked_sub(32).and_then(|i| ADVANCE.get(i)) {
            Some(&w) => f64::from(w),
            None if (c as u32) < 0x2e80 => 620.0,
            None => 1000.0, // ideographs and pictures
        })
        .sum();
    thousandths * size / 1000.0
}

/// The text with the five characters of XML replaced, and without control characters, which XML forbids.
pub(crate) fn escape(s: &str) -> String {
    let mut out = String::with_capacity(s.len());
    for c in s.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() => out.push(' '),
            '\u{fffe}' | '\u{ffff}' => {}
            c => out.push(c),
        }
    }
    out
}

/// A number with so many decimals and a true minus sign; a dash for what is not a number.
pub(crate) fn fixed(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return "–".to_owned();
    }
    let s = format!("{x:.decimals$}");
    match s.strip_prefix('-') {
        Some(digits) if digits.bytes().any(|b| (b'1'..=b'9').contains(&b)) => format!("\u{2212}{digits}"),
        Some(digits) => digits.to_owned(), // no minus zero
        None => s,
    }
}

/// As [`fixed`], without zeros at the end of the fraction.
pub(crate) fn short(x: f64, decimals: usize) -> String {
    let s = fixed(x, decimals);
    if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').to_owned() } else { s }
}

/// Four significant digits at most; a power of ten beyond a million and below a thousandth.
pub(crate) fn significant(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return short(x, 0);
    }
    let exponent = x.abs().log10().floor() as i32;
    if (-4..=6).contains(&exponent) {
        return short(x, (3 - exponent).max(0) as usize);
    }
    let power: String = exponent
        .to_string()
        .chars()
        .map(|c| match c.to_digit(10) {
            Some(d) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize],
            None => '⁻',
        })
        .collect();
    format!("{} · 10{power}", short(x / 10f64.powi(exponent), 2))
}

/// A value with the SI prefix that keeps it between 1 and 1000: `0.0157 N m²` is not prefixed, `0.02 N` is 20 mN.
pub(crate) fn prefixed(x: f64, unit: &str) -> String {
    let prefixes = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ")];
    let found = prefixes.iter().find(|(size, _)| x.abs() >= *size * 0.9999);
    match found {
        Some((size, prefix)) => format!("{} {prefix}{unit}", significant(x / size)),
        None => format!("{} {unit}", significant(x)),
    }
}

/// A length in millimetres, unit included.
pub(crate) fn millimetres(x: f64) -> String {
    format!("{} mm", short(1e3 * x, 3))
}

/// A mass in grams, or in kilograms from one upward.
pub(crate) fn mass(kg: f64) -> String {
    if kg.abs() < 1.0 { format!("{} g", short(1e3 * kg, 2)) } else { format!("{} kg", significant(kg)) }
}

/// Decimals that show every value of a column exactly, three at most; where that is not possible, enough for a
/// thousandth of the largest.
pub(crate) fn decimals_of(values: impl Iterator<Item = f64> + Clone) -> usize {
    let values = values.filter(|x| x.is_finite());
    let most = values.clone().fold(0.0, |most: f64, x| most.max(x.abs()));
    let fits = |d: i32, slack: f64| {
        let scale = 10f64.powi(d);
        values.clone().all(|x| (x * scale - (x * scale).round()).abs() <= slack * most * scale)
    };
    let exact = (0..=3).find(|&d| fits(d, 1e-9));
    exact.or_else(|| (0..=6).find(|&d| fits(d, 1e-3))).unwrap_or(6) as usize
}

/// The text, cut with an ellipsis where it is wider than `room`.
pub(crate) fn fit(s: &str, room: f64, width: impl Fn(&str) -> f64) -> String {
    if width(s) <= room {
        return s.to_owned();
    }
    let mut cut = String::new();
    for c in s.chars() {
        cut.push(c);
        if width(&cut) + width("…") > room {
            cut.pop();
            break;
        }
    }
    cut.trim_end().to_owned() + "…"
}

/// Lines no wider than `room`, broken at spaces where possible.
pub(crate) fn wrap(s: &str, room: f64, width: impl Fn(&str) -> f64) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in s.split_whitespace() {
        let joined = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if width(&joined) <= room {
            line = joined;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        for c in word.chars() {
            line.push(c);
            if width(&line) > room && line.chars().count() > 1 {
                line.pop();
                lines.push(std::mem::take(&mut line));
                line.push(c);
            }
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(fixed(-1.25, 1), "\u{2212}1.2");
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(f64::NAN, 2), "–");
        assert_eq!(short(200.0, 2), "200");
        assert_eq!(significant(0.0157), "0.0157");
        assert_eq!(significant(1e-12), "1 · 10⁻¹²");
        assert_eq!(prefixed(54e9, "Pa"), "54 GPa");
        assert_eq!(prefixed(-0.2, "N"), "\u{2212}200 mN");
        assert_eq!(mass(0.0138), "13.8 g");
        assert_eq!(decimals_of([0.0, 13.8, 16.9].into_iter()), 1);
        assert_eq!(decimals_of([0.0, 20.053522829].into_iter()), 2);
    }

    #[test]
    fn long_lines_are_broken() {
        let lines = wrap("one two abcdefghij", 5.0, |s| s.chars().count() as f64);
        assert_eq!(lines, ["one", "two", "abcde", "fghij"]);
    }
}
