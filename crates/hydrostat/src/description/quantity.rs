//! Values with a unit, such as `"390 mm"` or `"[0, -9.81, 0] m/s^2"`.

use super::unit::{Dimension, Unit, quoted};
use crate::Error;
use nalgebra::Vector3;

/// What a value measures, and how to name it in a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    /// As in "expected a length".
    pub name: &'static str,
    /// As in `such as "390 mm"`.
    pub example: &'static str,
    /// The SI unit.
    pub unit: &'static str,
    dimension: Dimension,
}

pub const LENGTH: Kind = Kind::new("a length", "390 mm", "m", [1, 0, 0, 0]);
pub const AREA: Kind = Kind::new("an area", "1.9 mm^2", "m^2", [2, 0, 0, 0]);
pub const VOLUME: Kind = Kind::new("a volume", "2 cm^3", "m^3", [3, 0, 0, 0]);
pub const MASS: Kind = Kind::new("a mass", "20 g", "kg", [0, 1, 0, 0]);
pub const DENSITY: Kind = Kind::new("mass per volume", "6450 kg/m^3", "kg/m^3", [-3, 1, 0, 0]);
pub const MASS_PER_LENGTH: Kind = Kind::new("mass per length", "12 g/m", "kg/m", [-1, 1, 0, 0]);
pub const TIME: Kind = Kind::new("a time", "2 s", "s", [0, 0, 1, 0]);
pub const SPEED: Kind = Kind::new("a speed", "10 mm/s", "m/s", [1, 0, -1, 0]);
pub const ACCELERATION: Kind = Kind::new("an acceleration", "9.81 m/s^2", "m/s^2", [1, 0, -2, 0]);
pub const FORCE: Kind = Kind::new("a force", "0.5 N", "N", [1, 1, -2, 0]);
pub const FORCE_PER_LENGTH: Kind = Kind::new("force per length", "0.5 N/m", "N/m", [0, 1, -2, 0]);
pub const MOMENT: Kind = Kind::new("a moment", "0.5 N m", "N m", [2, 1, -2, 0]);
pub const MOMENT_PER_LENGTH: Kind = Kind::new("moment per length", "0.5 N", "N", [1, 1, -2, 0]);
pub const STRESS: Kind = Kind::new("force per area", "54 GPa", "Pa", [-1, 1, -2, 0]);
pub const CURVATURE: Kind = Kind::new("a curvature", "2 1/m", "1/m", [-1, 0, 0, 0]);
pub const ANGLE: Kind = Kind::new("an angle", "30 deg", "rad", [0, 0, 0, 1]);
pub const FRACTION: Kind = Kind::new("a fraction", "1 %", "1", [0, 0, 0, 0]);
pub const FREQUENCY: Kind = Kind::new("a frequency", "2 Hz", "Hz", [0, 0, -1, 0]);

/// The first of two with the same dimension is the one that a message names as found.
const KINDS: &[Kind] = &[
    LENGTH,
    AREA,
    VOLUME,
    MASS,
    DENSITY,
    MASS_PER_LENGTH,
    TIME,
    SPEED,
    ACCELERATION,
    FORCE,
    FORCE_PER_LENGTH,
    MOMENT,
    MOMENT_PER_LENGTH,
    STRESS,
    CURVATURE,
    ANGLE,
    FRACTION,
    FREQUENCY,
];

impl Kind {
    const fn new(
        name: &'static str,
        example: &'static str,
        unit: &'static str,
        dimension: Dimension,
    ) -> Kind {
        Kind { name, example, unit, dimension }
    }

    /// The end of a message: `mass per volume, such as "6450 kg/m^3"`.
    pub fn expected(&self) -> String {
        format!("{}, such as \"{}\"", self.name, self.example)
    }

    /// The same for three components.
    pub fn expected_vector(&self) -> String {
        format!("three components, such as \"[0, 0, 1] {}\"", self.unit)
    }

    /// The same for a list.
    pub fn expected_list(&self) -> String {
        format!("a list, such as \"[1, 2, 3] {}\"", self.unit)
    }

    /// Refuses a unit of another kind; a curvature may be given in rad/m.
    pub(super) fn check(&self, unit: &Unit, text: &str) -> Result<(), Error> {
        let [m, kg, s, rad] = unit.dimension;
        let fits =
            unit.dimension == self.dimension || (*self == CURVATURE && [m, kg, s, rad] == [-1, 0, 0, 1]);
        if fits {
            return Ok(());
        }
        let found = KINDS.iter().find(|kind| kind.dimension == unit.dimension);
        let found =
            found.map_or_else(|| format!("a quantity in {}", quoted(text)), |kind| kind.name.to_string());
        Err(Error::new(format!("found {found}, expected {}", self.expected())))
    }
}

/// Reads one value, in SI.
pub fn scalar(text: &str, kind: &Kind) -> Result<f64, Error> {
    let text = text.trim();
    if text.starts_with('[') {
        return Err(Error::new(format!("found a list, expected {}", kind.expected())));
    }
    let (number, unit) = take_number(text, &kind.expected())?;
    to_si(number, unit, kind)
}

/// Reads three components, in SI.
pub fn vector(text: &str, kind: &Kind) -> Result<Vector3<f64>, Error> {
    let expected = kind.expected_vector();
    match bracketed(text, kind, &expected)?[..] {
        [x, y, z] => Ok(Vector3::new(x, y, z)),
        ref other => Err(Error::new(format!("found a list of {}, expected {expected}", other.len()))),
    }
}

/// Reads a list of any length, in SI.
pub fn list(text: &str, kind: &Kind) -> Result<Vec<f64>, Error> {
    bracketed(text, kind, &kind.expected_list())
}

fn bracketed(text: &str, kind: &Kind, expected: &str) -> Result<Vec<f64>, Error> {
    let malformed = || Error::new(format!("found {}, expected {expected}", quoted(text.trim())));
    let inner = text.trim().strip_prefix('[').ok_or_else(malformed)?;
    let (inner, unit) = inner.split_once(']').ok_or_else(malformed)?;
    let component = |piece: &str| match take_number(piece.trim(), expected)? {
        (number, "") => to_si(number, unit, kind),
        _ => Err(malformed()),
    };
    inner.split(',').map(component).collect()
}

fn to_si(number: &str, unit: &str, kind: &Kind) -> Result<f64, Error> {
    let unit = unit.trim();
    if unit.is_empty() {
        return Err(Error::new(format!("found a number without a unit, expected {}", kind.expected())));
    }
    if unit.starts_with([',', '.']) {
        return Err(Error::new(format!("found {} after a number, expected a unit", quoted(unit)))
            .hint("write decimals with a point and thousands without a mark: 1.5, 2000"));
    }
    let parsed = Unit::parse(unit)?;
    kind.check(&parsed, unit)?;
    let si = parsed.to_si(number);
    let zero = !number.split(['e', 'E']).next().unwrap_or("").contains(|c| ('1'..='9').contains(&c));
    if !si.is_finite() || (si == 0.0 && !zero) {
        let size = if si == 0.0 { "small" } else { "large" };
        return Err(Error::new(format!(
            "{} is too {size} to compute with",
            quoted(&format!("{number} {unit}"))
        )));
    }
    Ok(si)
}

/// Splits a text that starts with a number; what follows is trimmed.
fn take_number<'t>(text: &'t str, expected: &str) -> Result<(&'t str, &'t str), Error> {
    let (number, rest) = text.split_at(number_length(text.as_bytes()));
    if number.is_empty() {
        let word = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        if word.starts_with("nan") || word.starts_with("inf") {
            return Err(Error::new(format!("{} is not a finite number", quoted(text))));
        }
        let found = if text.is_empty() { "an empty text".to_string() } else { quoted(text) };
        return Err(Error::new(format!("found {found}, expected {expected}")));
    }
    Ok((number, rest.trim_start()))
}

/// A value for a message, to 6 digits.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(f64::NAN)
}

/// Length in bytes of the decimal number at the start: sign, digits, point, exponent; 0 where there is none.
fn number_length(text: &[u8]) -> usize {
    let digits = |from: usize| text[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let is = |at: usize, set: &[u8]| text.get(at).is_some_and(|byte| set.contains(byte));
    let mut end = usize::from(is(0, b"+-"));
    let mut count = digits(end);
    end += count;
    if is(end, b".") {
        let decimals = digits(end + 1);
        count += decimals;
        end += 1 + decimals;
    }
    if count == 0 {
        return 0;
    }
    if is(end, b"eE") {
        let sign = usize::from(is(end + 1, b"+-"));
        let exponent = digits((end + 1 + sign).min(text.len()));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Exact: the power of ten is taken in decimal, so that the nearest number is found.
    #[test]
    fn values_are_exact_in_si() {
        let cases: &[(&str, Kind, f64)] = &[
            ("390 mm", LENGTH, 0.39),
            ("390mm", LENGTH, 0.39),
            (" 34.87  cm ", LENGTH, 0.3487),
            (".0445 in", LENGTH, 0.0445 * 254.0 / 1e4),
            ("5. ft", LENGTH, 5.0 * 0.3048),
            ("-1.5e-3 km", LENGTH, -1.5),
            ("3 um", LENGTH, 3e-6),
            ("3 µm", LENGTH, 3e-6),
            ("54 GPa", STRESS, 54e9),
            ("54e3 N/mm^2", STRESS, 54e9),
            ("1 bar", STRESS, 1e5),
            ("10 psi", STRESS, 68947.57293168361),
            ("6.45 g/cm^3", DENSITY, 6450.0),
            ("6.80 g/cm³", DENSITY, 6800.0),
            ("0.284 lb/in^3", DENSITY, 0.284 * 0.45359237 / 0.0254f64.powi(3)),
            ("1 t/m^3", DENSITY, 1000.0),
            ("20 g", MASS, 0.02),
            ("1 oz", MASS, 0.028349523125),
            ("0.5 N m", MOMENT, 0.5),
            ("0.5 N*m", MOMENT, 0.5),
            ("0.5 N·m", MOMENT, 0.5),
            ("50 N mm", MOMENT, 0.05),
            ("1 J", MOMENT, 1.0),
            ("0.5 kg m/s^2", FORCE, 0.5),
            ("0.5 kg*m/s/s", FORCE, 0.5),
            ("1 kgf", FORCE, 9.80665),
            ("100 gf", FORCE, 0.980665),
            ("1 lbf", FORCE, 4.4482216152605),
            ("20 kN", FORCE, 20e3),
            ("3 N", MOMENT_PER_LENGTH, 3.0),
            ("2 mN/mm", FORCE_PER_LENGTH, 2.0),
            ("30 deg", ANGLE, 30.0 * (PI / 180.0)),
            ("0.5 rev", ANGLE, PI),
            ("2 1/m", CURVATURE, 2.0),
            ("2 m^-1", CURVATURE, 2.0),
            ("2 rad/m", CURVATURE, 2.0),
            ("1 %", FRACTION, 0.01),
            ("0.01 1", FRACTION, 0.01),
            ("2 min", TIME, 120.0),
            ("50 Hz", FREQUENCY, 50.0),
        ];
        for (text, kind, expected) in cases {
            let value = scalar(text, kind).expect(text);
            assert!((value - expected).abs() <= 2e-16 * expected.abs(), "{text}: {value} is not {expected}");
        }
    }

    #[test]
    fn vectors_and_lists() {
        let gravity = vector("[0, -9.81, 0] m/s^2", &ACCELERATION);
        assert_eq!(gravity, Ok(Vector3::new(0.0, -9.81, 0.0)));
        let curvature = vector("[-1.4, 0.8,1.3]1/m", &CURVATURE);
        assert_eq!(curvature, Ok(Vector3::new(-1.4, 0.8, 1.3)));
        assert_eq!(list("[10, 20, 40] mm", &LENGTH), Ok(vec![0.01, 0.02, 0.04]));
    }

    #[test]
    fn refusals() {
        let cases: &[(&str, Kind, &str)] = &[
            ("", LENGTH, "found an empty text, expected a length, such as \"390 mm\""),
            ("mm", LENGTH, "found \"mm\", expected a length, such as \"390 mm\""),
            ("- mm", LENGTH, "found \"- mm\", expected a length, such as \"390 mm\""),
            (". mm", LENGTH, "found \". mm\", expected a length, such as \"390 mm\""),
            ("5", LENGTH, "found a number without a unit, expected a length, such as \"390 mm\""),
            ("5 N", MOMENT, "found a force, expected a moment, such as \"0.5 N m\""),
            ("5 N m", FORCE, "found a moment, expected a force, such as \"0.5 N\""),
            ("5 deg", FRACTION, "found an angle, expected a fraction, such as \"1 %\""),
            ("5 %", ANGLE, "found a fraction, expected an angle, such as \"30 deg\""),
            ("5 kg^2", MASS, "found a quantity in \"kg^2\", expected a mass, such as \"20 g\""),
            ("5 m/", LENGTH, "\"m/\" is not a unit"),
            ("5 /m", CURVATURE, "\"/m\" is not a unit"),
            ("5 m//s", SPEED, "\"m//s\" is not a unit"),
            ("5 m^x", LENGTH, "\"m^x\" is not a unit"),
            ("5 m^99999999999", LENGTH, "\"m^99999999999\" is not a unit"),
            ("5 kkg", MASS, "unknown unit \"kkg\""),
            ("1e400 m", LENGTH, "\"1e400 m\" is too large to compute with"),
            ("1e-400 m", LENGTH, "\"1e-400 m\" is too small to compute with"),
            ("1e99999999999999999999 m", LENGTH, "\"1e99999999999999999999 m\" is too large to compute with"),
            ("[1, 2] m", LENGTH, "found a list, expected a length, such as \"390 mm\""),
        ];
        for (text, kind, expected) in cases {
            let error = scalar(text, kind).expect_err(text);
            assert_eq!(error.message(), *expected);
        }
        for text in
            ["", "[", "[]", "[] m", "[1,] m", "[1 2 3] m", "1, 2, 3 m", "[1; 2; 3] m", "[nan, 0, 0] m"]
        {
            assert!(vector(text, &LENGTH).is_err(), "{text}");
        }
    }
}
