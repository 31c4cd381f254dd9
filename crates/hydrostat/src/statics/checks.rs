//! Every quantity of a solution that has a limit, held against it.

use super::chain::Chain;
use super::span::Span;
use crate::Error;
use crate::model::{Command, Robot, Routing};
use crate::solution::{Check, Station, TendonState};
use nalgebra::Vector3;

/// The largest strain so far, relative to the limit where it occurs.
#[derive(Default)]
pub(super) struct Strain {
    worst: Option<Check>,
}

impl Strain {
    /// Takes a point of the backbone into account.
    pub(super) fn sample(
        &mut self,
        robot: &Robot,
        span: &Span,
        s: f64,
        v: &Vector3<f64>,
        u: &Vector3<f64>,
    ) -> Result<(), Error> {
        let strain = strain(robot, span, s, v, u)?;
        let limit = robot.sections[span.section].material.strain_limit.unwrap_or(f64::INFINITY);
        // the worst is the one nearest to its limit
        let better = |check: &Check| {
            let (a, b) = (strain / limit, check.value / check.limit);
            a > b || (a >= b && strain > check.value)
        };
        if self.worst.as_ref().is_none_or(better) {
            let ok = strain <= limit;
            self.worst =
                Some(Check { name: "strain", value: strain, limit, ok, at: Some(s), tendons: Vec::new() });
        }
        Ok(())
    }

    pub(super) fn check(self) -> Option<Check> {
        self.worst
    }
}

/// Largest fibre strain at `s`, theory (9).
fn strain(robot: &Robot, span: &Span, s: f64, v: &Vector3<f64>, u: &Vector3<f64>) -> Result<f64, Error> {
    let section = &robot.sections[span.section];
    if v.z <= 0.0 {
        return Err(Error::new(format!(
            "the backbone is compressed to nothing at s = {s:.4} m of section \"{}\"",
            section.name
        ))
        .hint("the linear section law does not hold there: lower the loads or stiffen the section"));
    }
    let bending = u - section.rest_curvature;
    let along = ((s - span.section_start) / section.length).clamp(0.0, 1.0);
    Ok((v.z - 1.0).abs() + section.cross_section(along).bending_strain([bending.x, bending.y]))
}

/// Tension against the breaking load, and slack tendons.
///
/// # Errors
/// A commanded displacement that would tear its tendon.
pub(super) fn tendons(robot: &Robot, states: &[TendonState]) -> Result<Vec<Check>, Error> {
    let mut checks = Vec::new();
    if !states.is_empty() {
        checks.extend(tension(robot, states)?);
        checks.extend(slack(robot, states));
    }
    Ok(checks)
}

/// The tension nearest to its breaking load.
fn tension(robot: &Robot, states: &[TendonState]) -> Result<Option<Check>, Error> {
    let mut worst: Option<Check> = None;
    for ((tendon, command), state) in robot.tendons.iter().zip(&robot.actuation).zip(states) {
        let Some(limit) = tendon.breaking_load else { continue };
        let value = state.tension.max(state.tip_tension);
        if let Command::Displacement { displacement, .. } = command
            && value > limit
        {
            return Err(Error::new(format!(
                "tendon \"{}\" tears: pulled in by {:.3} mm it carries {value:.3} N, above its breaking load of {limit:.3} N",
                tendon.name,
                displacement * 1e3
            ))
            .hint("pull it in less, or pay out the tendons on the other side"));
        }
        if worst.as_ref().is_none_or(|check| value / limit > check.value / check.limit) {
            let (ok, tendons) = (value <= limit, vec![tendon.name.clone()]);
            worst = Some(Check { name: "tension", value, limit, ok, at: None, tendons });
        }
    }
    Ok(worst)
}

/// Part of the robot's length by which a tendon at 0 N may be too long for its way: commands are rounded to about a micrometre,
/// and those read off a solution decide by rounding whether the tendon pulls.
const SLACK: f64 = 1e-5;

/// Tendons that are slack although they are pulled in, and their number.
fn slack(robot: &Robot, states: &[TendonState]) -> Option<Check> {
    let held = |command: &&Command| matches!(command, Command::Displacement { .. });
    robot.actuation.iter().find(held)?;
    let fails = |(command, state): &(&Command, &TendonState)| match command {
        Command::Displacement { displacement, .. } => {
            let too_long = state.displacement - displacement > SLACK * robot.length();
            *displacement > 0.0 && state.slack && too_long
        }
        Command::Tension { .. } => false,
    };
    let slack = robot.actuation.iter().zip(states).filter(fails);
    let tendons: Vec<String> = slack.map(|(_, state)| state.name.clone()).collect();
    let (value, ok) = (tendons.len() as f64, tendons.is_empty());
    Some(Check { name: "slack", value, limit: 0.0, ok, at: None, tendons })
}

/// Largest distance of a straight tendon from its hole's curve, as a fraction of the hole's radius, that is still a channel's.
const LARGEST_DEVIATION: f64 = 0.1;

/// How far tendons leave their channel between guides.
#[derive(Default)]
pub(super) struct GuideSpacing {
    worst: Option<Check>,
}

impl GuideSpacing {
    /// Takes a place between two plates into account: the distance of a tendon from its hole's curve, and the hole's radius.
    pub(super) fn sample(&mut self, s: f64, away: f64, radius: f64) {
        let value = if radius > 0.0 { away / radius } else { 0.0 };
        if self.worst.as_ref().is_none_or(|check| value > check.value) {
            self.worst = Some(Check {
                name: "guide_spacing",
                value,
                limit: LARGEST_DEVIATION,
                ok: value <= LARGEST_DEVIATION,
                at: Some(s),
                tendons: Vec::new(),
            });
        }
    }

    /// Looks at the middle of every gap between plates.
    pub(super) fn of_stations(robot: &Robot, chain: &Chain, station: impl Fn(f64) -> Station) -> Self {
        let mut spacing = GuideSpacing::default();
        let at = |s: f64| station(s.min(chain.length));
        for pair in chain.plates.windows(2) {
            let places = [pair[0], 0.5 * (pair[0] + pair[1]), pair[1]].map(at);
            for tendon in robot.tendons.iter().filter(|tendon| tendon.routing == Routing::Guides) {
                let end = robot.tendon_end(tendon);
                if pair[1] > end * (1.0 + 1e-9) {
                    continue;
                }
                let hole = |station: &Station| tendon.path.hole((station.s / end).min(1.0), end).0;
                let [first, middle, last] =
                    places.each_ref().map(|station| station.position + station.rotation * hole(station));
                let line = last - first;
                let away = (middle - first).cross(&line).norm() / line.norm();
                spacing.sample(places[1].s, away, hole(&places[1]).norm());
            }
        }
        spacing
    }

    pub(super) fn check(self) -> Option<Check> {
        self.worst
    }
}
