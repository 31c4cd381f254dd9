//! A quantity that a fit may change, by the path of its place.

use super::part::{AXES, Part};
use super::setup::Setup;
use crate::Error;
use crate::verify::Experiment;

/// A quantity that the fit may change; several parts that the user ties have one value.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// As the user wrote it.
    pub name: String,
    /// All of one kind; at least one.
    pub parts: Vec<Part>,
    /// SI.
    pub bounds: [f64; 2],
    /// Whether the user gave them.
    pub bounded: bool,
    pub prior: Option<Prior>,
}

/// What is known beforehand: a value and its standard error, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    pub value: f64,
    pub standard_error: f64,
}

impl Parameter {
    /// The parameter of this name: a path or the end of one, `*` for every name, `+` between paths that are tied.
    ///
    /// # Errors
    /// Nothing or several things of that name, or ties between different kinds.
    pub fn named(experiment: &Experiment, name: &str) -> Result<Parameter, Error> {
        let all: Vec<(String, Part)> =
            Part::all(experiment).into_iter().map(|part| (part.path(experiment), part)).collect();
        let mut parts: Vec<Part> = Vec::new();
        for pattern in name.split('+').map(str::trim) {
            let canonical = pattern.replace("hole_", "");
            let found: Vec<&(String, Part)> =
                all.iter().filter(|(path, part)| matches(&canonical, path, part, experiment)).collect();
            match found[..] {
                [] => return Err(unknown(pattern, &all)),
                [_, _, ..] if !pattern.contains('*') => {
                    let paths: Vec<&str> = found.iter().map(|(path, _)| path.as_str()).collect();
                    return Err(Error::new(format!(
                        "\"{pattern}\" is the name of {} parameters",
                        found.len()
                    ))
                    .hint(format!(
                        "name one of {}, or give them one value: {}",
                        paths.join(", "),
                        paths.join("+")
                    )));
                }
                _ => parts.extend(
                    found
                        .into_iter()
                        .map(|(_, part)| part.clone())
                        .filter(|part| !parts.contains(part))
                        .collect::<Vec<_>>(),
                ),
            }
        }
        if let Some(other) =
            parts.iter().find(|part| std::mem::discriminant(*part) != std::mem::discriminant(&parts[0]))
        {
            return Err(Error::new(format!(
                "\"{name}\" ties {} to {}, which is another kind of quantity",
                parts[0].path(experiment),
                other.path(experiment)
            )));
        }
        let bounds = parts[0].possible();
        Ok(Parameter { name: name.to_owned(), parts, bounds, bounded: false, prior: None })
    }

    /// Unit of SI.
    pub fn unit(&self) -> &'static str {
        self.parts[0].kind().unit
    }

    /// Paths of its parts.
    pub fn paths(&self, experiment: &Experiment) -> Vec<String> {
        self.parts.iter().map(|part| part.path(experiment)).collect()
    }

    /// A value for people: `54.3 GPa`, with so many digits that a part of `error` is seen.
    pub fn show(&self, value: f64, error: Option<f64>) -> String {
        let (unit, size) = self.parts[0].display_unit();
        let digits = digits(value / size, error.map(|error| error / size));
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        let text = format!("{:.digits$}", value / size);
        let zero = text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.'));
        format!("{}{unit}", if zero { text.trim_start_matches('-') } else { &text })
    }

    /// Value where the fit starts: that of the file.
    pub(super) fn start(&self, setup: &Setup) -> Result<f64, Error> {
        let first = self.parts[0].get(setup)?;
        let keeps_ratio = self.parts[0].lowest().is_some();
        for part in &self.parts[1..] {
            if keeps_ratio && first == 0.0 && part.get(setup)? != 0.0 {
                return Err(Error::new(format!(
                    "the parts of {} keep their ratio, and the first of them is 0 while another is not",
                    self.name
                ))
                .hint("give the first a value above 0 in the file, or free them one by one"));
            }
        }
        Ok(first)
    }
}

/// Decimals that leave two digits of an error, or five digits of a value.
fn digits(value: f64, error: Option<f64>) -> usize {
    let size = match error {
        Some(error) if error > 0.0 && error.is_finite() => error / 10.0,
        _ if value != 0.0 => value.abs() / 1e4,
        _ => 1e-3,
    };
    (-size.log10().floor()).clamp(0.0, 9.0) as usize
}

/// Whether the end of a path is the pattern; sections and tendons go by number from 1 as well.
fn matches(pattern: &str, path: &str, part: &Part, experiment: &Experiment) -> bool {
    let wanted: Vec<&str> = pattern.split('.').collect();
    let have: Vec<&str> = path.split('.').collect();
    // a name alone is a quantity, never the axis of one
    if wanted.len() > have.len() || wanted.iter().all(|word| AXES.contains(word)) {
        return false;
    }
    let number = match part {
        Part::Length { section }
        | Part::Dimension { section, .. }
        | Part::RestCurvature { section, .. }
        | Part::GuideMass { section } => Some(section + 1),
        Part::HoleRadius { tendon }
        | Part::HoleAngle { tendon }
        | Part::Stiffness { tendon }
        | Part::Friction { tendon }
        | Part::Home { tendon } => Some(tendon + 1),
        _ => None,
    };
    let named = |name: &str| {
        experiment.robot.sections.iter().any(|section| section.name == name)
            || experiment.robot.tendons.iter().any(|tendon| tendon.name == name)
    };
    let offset = have.len() - wanted.len();
    wanted.iter().zip(&have[offset..]).enumerate().all(|(i, (wanted, have))| {
        let by_number = i + offset == 1 && !named(wanted) && wanted.parse::<usize>().ok() == number;
        wanted == have || *wanted == "*" || (number.is_some() && by_number)
    })
}

fn unknown(pattern: &str, all: &[(String, Part)]) -> Error {
    let error = Error::new(format!("there is no parameter \"{pattern}\""));
    if pattern.rsplit('.').next() == Some("poisson_ratio") {
        return error.hint("Poisson's ratio shows through the shear modulus alone: name shear_modulus, which is E / (2 (1 + ratio))");
    }
    let ends = all.iter().flat_map(|(path, _)| path.match_indices('.').map(|(at, _)| &path[at + 1..]));
    let nearest = ends.min_by_key(|end| strsim::damerau_levenshtein(pattern, end));
    match nearest.filter(|end| strsim::damerau_levenshtein(pattern, end) <= (end.len() / 3).max(1)) {
        Some(end) => error.hint(format!("did you mean \"{end}\"?")),
        None => {
            let paths: Vec<&str> = all.iter().map(|(path, _)| path.as_str()).collect();
            error.hint(format!("parameters of this experiment: {}", paths.join(", ")))
        }
    }
}
