//! What the caller sees of a converged mesh: stations, checks, report.

use super::Settings;
use super::chain::{Chain, Span};
use super::energy::{self, Energy};
use super::rod;
use super::search::Found;
use super::shooting::Mesh;
use crate::Error;
use crate::model::{Pose, Robot};
use crate::solution::{Check, Equilibrium, Method, Report, Station};
use nalgebra::{Rotation3, Vector3};

/// What is known of the stability.
pub(super) struct Judged {
    pub(super) stable: Option<bool>,
    pub(super) smallest_eigenvalue: Option<f64>,
    pub(super) unstable_from: Option<f64>,
}

/// Reads the equilibrium off the fine mesh.
pub(super) fn equilibrium(
    robot: &Robot,
    settings: &Settings,
    chain: &Chain,
    mesh: &Mesh,
    found: &Found,
    judged: &Judged,
) -> Result<Equilibrium, Error> {
    let tip = mesh.nodes[mesh.steps.len()];
    let stations: Vec<Station> = (0..settings.stations)
        .map(|i| station(chain_position(chain, i, settings.stations), robot, chain, mesh))
        .collect();
    let checks = checks(robot, settings, chain, mesh, &stations, judged)?;
    Ok(Equilibrium {
        tip: Pose {
            position: mesh.positions[mesh.steps.len()],
            rotation: Rotation3::from_matrix_unchecked(tip.rotation),
        },
        stations,
        tendons: Vec::new(),
        checks,
        report: Report {
            method: Method::Shooting,
            iterations: found.iterations,
            residual: found.residual,
            error_estimate: found.error_estimate,
            stable: judged.stable,
            smallest_eigenvalue: judged.smallest_eigenvalue,
            unstable_from: judged.unstable_from,
            snapped_from: None,
        },
    })
}

/// Reads the equilibrium off the energy method's mesh.
pub(super) fn of_energy(
    robot: &Robot,
    settings: &Settings,
    chain: &Chain,
    energy: &Energy,
    found: &energy::Found,
) -> Result<Equilibrium, Error> {
    let (position, rotation) = energy.tip();
    let stations: Vec<Station> = (0..settings.stations)
        .map(|i| energy.station(robot, chain, chain_position(chain, i, settings.stations)))
        .collect();
    let falls = found.negative > 0;
    let stable = if falls { Some(false) } else { chain.conservative.then_some(true) };
    Ok(Equilibrium {
        tip: Pose { position, rotation: Rotation3::from_matrix_unchecked(rotation) },
        stations,
        tendons: energy.tendon_states(robot),
        checks: Vec::new(),
        report: Report {
            method: Method::Energy,
            iterations: found.iterations,
            residual: found.residual,
            error_estimate: found.error_estimate,
            stable,
            smallest_eigenvalue: found.smallest_eigenvalue,
            unstable_from: found.unstable_from,
            snapped_from: found.snapped_from,
        },
    })
}

/// The state at `s`, on the base side of a jump.
pub(super) fn station(s: f64, robot: &Robot, chain: &Chain, mesh: &Mesh) -> Station {
    let k = mesh.steps.partition_point(|step| step.from < s).saturating_sub(1);
    let step = &mesh.steps[k];
    // a whole step is taken as it stands, so that the last station is the tip to the last bit
    let part = if (s - step.from - step.length).abs() <= f64::EPSILON * chain.length {
        step.clone()
    } else {
        chain.spans[chain.span_at(s)].step(robot, step.from, (s - step.from).max(0.0))
    };
    let (node, displacement) = rod::integrate(&part, 1.0, &mesh.nodes[k]);
    let section = rod::section_law(&part, rod::END, 1.0, &node);
    Station {
        s,
        position: mesh.positions[k] + displacement,
        rotation: node.rotation,
        v: section.v,
        u: section.u,
        force: section.force,
        moment: node.moment,
    }
}

/// The backbone is sampled at least so often for its largest strain, unless only the bare shape is wanted.
const SAMPLES: usize = 65;

/// Strain against the limit of each material, and stability.
fn checks(
    robot: &Robot,
    settings: &Settings,
    chain: &Chain,
    mesh: &Mesh,
    stations: &[Station],
    judged: &Judged,
) -> Result<Vec<Check>, Error> {
    let mut worst: Option<Check> = None;
    let mut sample = |span: &Span, s: f64, v: &Vector3<f64>, u: &Vector3<f64>| -> Result<(), Error> {
        let strain = strain(robot, span, s, v, u)?;
        let limit = robot.sections[span.section].material.strain_limit.unwrap_or(f64::INFINITY);
        // the worst is the one nearest to its limit
        let better = |check: &Check| {
            let (a, b) = (strain / limit, check.value / check.limit);
            a > b || (a >= b && strain > check.value)
        };
        if worst.as_ref().is_none_or(better) {
            worst = Some(Check { name: "strain", value: strain, limit, ok: strain <= limit, at: Some(s) });
        }
        Ok(())
    };
    // both ends of every step: strains jump where sections and loads do
    for (k, step) in mesh.steps.iter().enumerate() {
        let span = &chain.spans[chain.span_at(step.from + 0.5 * step.length)];
        let mut end = mesh.nodes[k + 1];
        rod::pass(&mesh.jumps[k], -1.0, &mut end);
        for (c, node, s) in
            [(rod::START, &mesh.nodes[k], step.from), (rod::END, &end, step.from + step.length)]
        {
            let section = rod::section_law(step, c, 1.0, node);
            sample(span, s, &section.v, &section.u)?;
        }
    }
    for station in stations {
        sample(&chain.spans[chain.span_at(station.s)], station.s, &station.v, &station.u)?;
    }
    if settings.eigenvalue && stations.len() < SAMPLES {
        for i in 0..SAMPLES {
            let station = station(chain_position(chain, i, SAMPLES), robot, chain, mesh);
            sample(&chain.spans[chain.span_at(station.s)], station.s, &station.v, &station.u)?;
        }
    }
    let mut checks = Vec::with_capacity(2);
    checks.extend(worst);
    if let Some(ok) = judged.stable {
        let value = judged.smallest_eigenvalue.unwrap_or(f64::NAN);
        checks.push(Check { name: "stability", value, limit: 0.0, ok, at: None });
    }
    Ok(checks)
}

/// Arc length of the i-th of `count` points, both ends included.
fn chain_position(chain: &Chain, i: usize, count: usize) -> f64 {
    chain.length * i as f64 / (count.max(2) - 1) as f64
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
