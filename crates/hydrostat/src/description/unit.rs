//! Units: their dimension, their size in SI, and the names they go by.
//!
//! Own code, because uom parses fixed unit names only and its errors cannot say which kind was found.

use crate::Error;
use std::f64::consts::{PI, TAU};

/// Exponents of metre, kilogram, second and radian.
pub type Dimension = [i32; 4];

const NONE: Dimension = [0, 0, 0, 0];
const LENGTH: Dimension = [1, 0, 0, 0];
const MASS: Dimension = [0, 1, 0, 0];
const TIME: Dimension = [0, 0, 1, 0];
const ANGLE: Dimension = [0, 0, 0, 1];
const FORCE: Dimension = [1, 1, -2, 0];
const PRESSURE: Dimension = [-1, 1, -2, 0];

/// A unit of size factor x 10^ten in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    factor: f64,
    ten: i32,
    /// What it measures.
    pub dimension: Dimension,
}

/// Name, factor, power of ten, dimension, whether it takes SI prefixes.
type Row = (&'static str, f64, i32, Dimension, bool);

const UNITS: &[Row] = &[
    ("m", 1.0, 0, LENGTH, true),
    ("in", 254.0, -4, LENGTH, false),
    ("ft", 3048.0, -4, LENGTH, false),
    ("g", 1.0, -3, MASS, true),
    ("t", 1.0, 3, MASS, false),
    ("lb", 0.45359237, 0, MASS, false),
    ("oz", 0.028349523125, 0, MASS, false),
    ("s", 1.0, 0, TIME, true),
    ("min", 60.0, 0, TIME, false),
    ("h", 3600.0, 0, TIME, false),
    ("Hz", 1.0, 0, [0, 0, -1, 0], true),
    ("N", 1.0, 0, FORCE, true),
    ("kgf", 9.80665, 0, FORCE, false),
    ("gf", 9.80665, -3, FORCE, false),
    ("lbf", 4.4482216152605, 0, FORCE, false),
    ("Pa", 1.0, 0, PRESSURE, true),
    ("bar", 1.0, 5, PRESSURE, true),
    ("psi", 6894.757293168361, 0, PRESSURE, false),
    ("J", 1.0, 0, [2, 1, -2, 0], true),
    ("W", 1.0, 0, [2, 1, -3, 0], true),
    ("rad", 1.0, 0, ANGLE, true),
    ("deg", PI / 180.0, 0, ANGLE, false),
    ("°", PI / 180.0, 0, ANGLE, false),
    ("rev", TAU, 0, ANGLE, false),
    ("rpm", TAU / 60.0, 0, [0, 0, -1, 1], false),
    ("%", 1.0, -2, NONE, false),
    ("1", 1.0, 0, NONE, false),
];

const PREFIXES: &[(char, i32)] = &[
    ('G', 9),
    ('M', 6),
    ('k', 3),
    ('d', -1),
    ('c', -2),
    ('m', -3),
    ('u', -6),
    ('µ', -6), // micro sign
    ('μ', -6), // Greek mu
    ('n', -9),
];

/// What a misspelt unit is compared with first.
const COMMON: &[&str] = &[
    "mm", "cm", "m", "um", "kg", "g", "mg", "N", "mN", "kN", "GPa", "MPa", "kPa", "Pa", "deg", "rad", "ms",
    "s",
];

const OPERATORS: &[char] = &['*', '·', '⋅', '/'];

const LONGEST: usize = 64;

impl Unit {
    /// Reads a product of units, such as `g/cm^3`, `N m`, `N*m` or `1/m`.
    pub fn parse(text: &str) -> Result<Unit, Error> {
        let text = text.trim();
        let malformed = || {
            Error::new(format!("{} is not a unit", quoted(text)))
                .hint("write units as in \"mm\", \"N m\", \"g/cm^3\" or \"1/m\"")
        };
        if text.len() > LONGEST {
            return Err(malformed());
        }
        let mut product = Unit { factor: 1.0, ten: 0, dimension: NONE };
        let (mut rest, mut sign, mut divided) = (text, 1, false);
        loop {
            let (factor, tail) = rest.split_at(
                rest.find(|c: char| c.is_whitespace() || OPERATORS.contains(&c)).unwrap_or(rest.len()),
            );
            let (name, exponent) = split_exponent(factor).ok_or_else(malformed)?;
            let unit = find(name).ok_or_else(|| unknown(name))?;
            product = product.times(&unit, sign * exponent);
            let tail = tail.trim_start();
            if tail.is_empty() {
                break;
            }
            let operator = tail.chars().next().filter(|c| OPERATORS.contains(c));
            sign = if operator == Some('/') { -1 } else { 1 };
            if divided && sign == 1 {
                return Err(Error::new(format!("{} can be read in two ways", quoted(text)))
                    .hint("repeat the slash, as in \"kg/m/s\", or write the divided units last"));
            }
            divided |= sign == -1;
            rest = tail[operator.map_or(0, char::len_utf8)..].trim_start();
        }
        Ok(product)
    }

    /// The size of this unit in SI.
    pub fn size(self) -> f64 {
        self.factor * 10f64.powi(self.ten)
    }

    /// A decimal number in this unit, in SI; the power of ten is taken in decimal, so that "34.87 cm" is 0.3487.
    pub(super) fn to_si(self, number: &str) -> f64 {
        if self.ten == 0 {
            return number.parse::<f64>().unwrap_or(f64::NAN) * self.factor;
        }
        let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
        let exponent = exponent.parse::<i64>().map(|exponent| exponent.saturating_add(self.ten.into()));
        let shifted = match exponent {
            Ok(exponent) => format!("{mantissa}e{exponent}").parse::<f64>(),
            Err(_) => number.parse(), // beyond any power of ten: zero or infinite either way
        };
        shifted.unwrap_or(f64::NAN) * self.factor
    }

    fn times(&self, other: &Unit, exponent: i32) -> Unit {
        let mut dimension = self.dimension;
        for (own, more) in dimension.iter_mut().zip(other.dimension) {
            *own += exponent * more;
        }
        Unit {
            factor: self.factor * other.factor.powi(exponent),
            ten: self.ten + exponent * other.ten,
            dimension,
        }
    }
}

/// `cm^3` -> (`cm`, 3); None where either part is missing.
fn split_exponent(factor: &str) -> Option<(&str, i32)> {
    let (name, exponent) = match factor.split_once('^') {
        Some((name, exponent)) => (name, exponent.parse().ok()?),
        None if factor.ends_with('²') => (factor.trim_end_matches('²'), 2),
        None if factor.ends_with('³') => (factor.trim_end_matches('³'), 3),
        None => (factor, 1),
    };
    (!name.is_empty() && (-9..=9).contains(&exponent) && exponent != 0).then_some((name, exponent))
}

fn find(name: &str) -> Option<Unit> {
    let row = |name: &str| UNITS.iter().find(|row| row.0 == name);
    let unit = |row: &Row, prefix: i32| Unit { factor: row.1, ten: row.2 + prefix, dimension: row.3 };
    if let Some(exact) = row(name) {
        return Some(unit(exact, 0));
    }
    let mut rest = name.chars();
    let first = rest.next()?;
    let (_, power) = PREFIXES.iter().find(|(prefix, _)| *prefix == first)?;
    row(rest.as_str()).filter(|row| row.4).map(|row| unit(row, *power))
}

fn unknown(name: &str) -> Error {
    let error = Error::new(format!("unknown unit {}", quoted(name)));
    match nearest(name) {
        Some(other) => error.hint(format!("did you mean {}?", quoted(&other))),
        None => error.hint("known units: m in ft, g t lb oz, s min h, N kgf gf lbf, Pa bar psi, J W Hz, rad deg rev, %, 1; with prefixes as in mm, kN, GPa"),
    }
}

/// Two units run together, a wrong case, a missing caret or one wrong letter.
fn nearest(name: &str) -> Option<String> {
    let halves = name.char_indices().skip(1).map(|(i, _)| name.split_at(i));
    for (a, b) in halves {
        if let (Some(first), Some(second)) = (find(a), find(b))
            && first.dimension != second.dimension
            && first.dimension != NONE
        {
            return Some(format!("{a} {b}"));
        }
        if find(a).is_some() && matches!(b, "2" | "3") {
            return Some(format!("{a}^{b}"));
        }
    }
    let known = || COMMON.iter().copied().chain(UNITS.iter().map(|row| row.0));
    known()
        .find(|other| other.eq_ignore_ascii_case(name))
        .or_else(|| known().find(|other| other.len() > 1 && strsim::damerau_levenshtein(other, name) == 1))
        .map(str::to_string)
}

/// Quotes a piece of the user's text: one line, cut where it is long.
pub(super) fn quoted(text: &str) -> String {
    let line = |c: char| if c.is_control() { ' ' } else { c };
    let dots = if text.chars().count() > LONGEST { "..." } else { "" };
    format!("\"{}{dots}\"", text.chars().take(LONGEST).map(line).collect::<String>())
}
