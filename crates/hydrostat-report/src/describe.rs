//! Parts of a robot in words.

use crate::text::{fixed, millimetres, prefixed, short, significant};
use hydrostat::model::{CrossSection, Profile};
use hydrostat::solution::Check;

/// `Ø 1.56 mm`, `tube Ø 3 / 2.4 mm`, `strip 10 × 0.5 mm`; both ends where they differ.
pub(crate) fn profile(profile: &Profile) -> String {
    if profile.base == profile.tip {
        cross_section(&profile.base)
    } else {
        format!(
            "{} tapering to {}",
            cross_section(&profile.base),
            cross_section(&profile.tip)
        )
    }
}

fn cross_section(section: &CrossSection) -> String {
    let mm = |x: f64| short(1e3 * x, 3);
    match *section {
        CrossSection::Round { diameter } => format!("Ø {}", millimetres(diameter)),
        CrossSection::Tube {
            diameter,
            inner_diameter,
        } => format!("tube Ø {} / {} mm", mm(diameter), mm(inner_diameter)),
        CrossSection::Strip { width, height } => format!("strip {} × {} mm", mm(width), mm(height)),
    }
}

/// What a check found, where it failed.
pub(crate) fn failed_check(check: &Check) -> String {
    let (value, limit) = if check.name.contains("strain") {
        (
            format!("{} %", fixed(100.0 * check.value, 2)),
            format!("{} %", short(100.0 * check.limit, 2)),
        )
    } else {
        (significant(check.value), significant(check.limit))
    };
    let place = check
        .at
        .map(|s| format!(" at {} from the base", millimetres(s)))
        .unwrap_or_default();
    format!(
        "Check failed: {} is {value}{place}, its limit {limit}.",
        check.name
    )
}

/// A gravity or other acceleration with its direction.
pub(crate) fn acceleration(v: &nalgebra::Vector3<f64>) -> String {
    let norm = v.norm();
    if norm == 0.0 {
        return "none".to_owned();
    }
    format!(
        "{} along {}",
        prefixed(norm, "m/s²"),
        crate::view::direction_name(&(v / norm))
    )
}
