//! Whether a fitted value can be what it is called.

use super::part::Part;
use super::{Estimate, Problem};

/// How far from its stated value a quantity may be found before something else is meant: moduli differ by alloy, heat and
/// direction of fibres, dimensions by tolerance, a density hardly.
pub(super) fn tolerated(part: &Part) -> Option<f64> {
    match part {
        Part::YoungsModulus { .. } | Part::ShearModulus { .. } => Some(1.0),
        Part::Density { .. } => Some(0.15),
        Part::Length { .. } => Some(0.05),
        Part::Dimension { .. } => Some(0.1),
        Part::HoleRadius { .. } => Some(0.25),
        _ => None,
    }
}

/// Angles of mounting that are seen with the eye, rad.
const SEEN: f64 = 0.17;
/// Part of the largest mass that no scale is off by.
const MASS_OFF: f64 = 0.1;

/// Factor from the stated value beyond which even a guess is doubted, and part of the length that no place is off by.
const GUESS: f64 = 10.0;
const MISPLACED: f64 = 0.1;
/// Turn of a section at rest, rad.
const CURLED: f64 = 2.0 * std::f64::consts::PI;

/// What to doubt about one parameter.
pub(super) fn doubts(problem: &Problem, estimate: &Estimate) -> Vec<String> {
    let all = [unphysical(problem, estimate), loose(estimate), against_prior(estimate)];
    all.into_iter().flatten().collect()
}

/// A value that stands for something else.
pub(super) fn unphysical(problem: &Problem, estimate: &Estimate) -> Option<String> {
    let Estimate { parameter, before, value, .. } = estimate;
    let name = &parameter.name;
    let shown = parameter.show(*value, estimate.standard_error);
    let part = &parameter.parts[0];
    if let Some(tolerated) = tolerated(part) {
        let ratio = value / before;
        let plausible = ratio <= 1.0 + tolerated && ratio >= 1.0 / (1.0 + tolerated);
        return (*before > 0.0 && !plausible).then(|| {
            format!(
                "{name} = {shown} is {ratio:.2} times the stated {}: as a physical value this is implausible, and more likely it stands \
                 for something that the model or the bench has and the fit has not.",
                parameter.show(*before, None)
            )
        });
    }
    match part {
        Part::MountAngle | Part::BaseRotation { .. } | Part::HoleAngle { .. }
            if (value - before).abs() > SEEN =>
        {
            Some(format!(
                "{name} = {shown} is farther from the stated {} than the eye would miss.",
                parameter.show(*before, None)
            ))
        }
        Part::MassOffset { input } => {
            let masses =
                || problem.experiment.rows.iter().map(|row| row.inputs[*input]).filter(|mass| *mass != 0.0);
            let largest = masses().fold(0.0, f64::max);
            if masses().any(|mass| mass + value < -1e-9 * largest) {
                Some(format!("{name} = {shown} makes a hung mass negative, which is unphysical."))
            } else {
                (value.abs() > MASS_OFF * largest).then(|| {
                    format!("{name} = {shown} is more than a tenth of the largest mass: no scale is off by so much.")
                })
            }
        }
        Part::BasePosition { .. } | Part::MarkerOffset { .. } => {
            let length = problem.experiment.robot.length();
            ((value - before).abs() > MISPLACED * length).then(|| {
                format!(
                    "{name} = {shown} is farther from the stated {} than a tenth of the length: check the origin of the readings.",
                    parameter.show(*before, None)
                )
            })
        }
        Part::RestCurvature { section, .. } => {
            let turn = (value - before).abs() * problem.experiment.robot.sections[*section].length;
            (turn > CURLED)
                .then(|| format!("{name} = {shown} curls the section into more than a full circle at rest."))
        }
        Part::Stiffness { .. } | Part::GuideMass { .. } if *before > 0.0 => {
            let ratio = value / before;
            (!(1.0 / GUESS..=GUESS).contains(&ratio)).then(|| {
                format!(
                    "{name} = {shown} is {ratio:.2} times the stated {}: check the unit of that, and whether the data tell it at all.",
                    parameter.show(*before, None)
                )
            })
        }
        _ => None,
    }
}

/// Part of a value from which its standard error says that it is not known.
const NOT_KNOWN: f64 = 0.5;

fn loose(estimate: &Estimate) -> Option<String> {
    let Estimate { parameter, value, .. } = estimate;
    let error = estimate.standard_error?;
    let signed = parameter.parts[0].lowest_possible() < 0.0;
    (!signed && *value > 0.0 && error > NOT_KNOWN * value).then(|| {
        format!(
            "{} is hardly determined: its standard error is {:.0} % of its value.",
            parameter.name,
            100.0 * error / value
        )
    })
}

/// Standard errors from which a prior and the data contradict each other.
const CONTRADICTS: f64 = 3.0;

fn against_prior(estimate: &Estimate) -> Option<String> {
    let prior = estimate.parameter.prior?;
    let away = (estimate.value - prior.value) / prior.standard_error;
    (away.abs() > CONTRADICTS).then(|| {
        format!(
            "{} is found {:.1} standard errors from its prior: one of the two is wrong, or the model is.",
            estimate.parameter.name,
            away.abs()
        )
    })
}
