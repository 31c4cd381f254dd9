//! What the caller sees of a converged mesh: stations, checks, report.

use super::Settings;
use super::chain::Chain;
use super::rod::{self, Node};
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
    let stations = match settings.stations {
        0 => Vec::new(),
        count => (0..count)
            .map(|i| station(robot, chain, mesh, chain.length * i as f64 / (count.max(2) - 1) as f64))
            .collect(),
    };
    Ok(Equilibrium {
        tip: Pose {
            position: mesh.positions[mesh.steps.len()],
            rotation: Rotation3::from_matrix_unchecked(tip.rotation),
        },
        stations,
        checks: checks(robot, chain, mesh, judged)?,
        report: Report {
            method: Method::Shooting,
            iterations: found.iterations,
            residual: found.residual,
            error_estimate: found.error_estimate,
            stable: judged.stable,
            smallest_eigenvalue: judged.smallest_eigenvalue,
            unstable_from: judged.unstable_from,
        },
    })
}

/// The state at `s`, on the base side of a jump.
pub(super) fn station(robot: &Robot, chain: &Chain, mesh: &Mesh, s: f64) -> Station {
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

/// Strain against the limit of each material, and stability.
fn checks(robot: &Robot, chain: &Chain, mesh: &Mesh, judged: &Judged) -> Result<Vec<Check>, Error> {
    let mut checks = Vec::new();
    let mut worst: Option<Check> = None;
    for (k, step) in mesh.steps.iter().enumerate() {
        let span = &chain.spans[chain.span_at(step.from + 0.5 * step.length)];
        let section = &robot.sections[span.section];
        let mut end = mesh.nodes[k + 1];
        rod::pass(&mesh.jumps[k], -1.0, &mut end);
        for (c, node, s) in
            [(rod::START, &mesh.nodes[k], step.from), (rod::END, &end, step.from + step.length)]
        {
            let strain = fibre_strain(robot, span.section, step, c, node, s - span.section_start)
                .ok_or_else(|| {
                    Error::new(format!(
                        "the backbone is compressed to nothing at s = {:.4} m of section \"{}\"",
                        s, section.name
                    ))
                    .hint(
                        "the linear section law does not hold there: lower the loads or stiffen the section",
                    )
                })?;
            let limit = section.material.strain_limit.unwrap_or(f64::INFINITY);
            // the worst is the one nearest to its limit
            let better = |check: &Check| {
                let (a, b) = (strain / limit, check.value / check.limit);
                a > b || (a == b && strain > check.value)
            };
            if worst.as_ref().is_none_or(better) {
                worst =
                    Some(Check { name: "strain", value: strain, limit, ok: strain <= limit, at: Some(s) });
            }
        }
    }
    checks.extend(worst);
    if let Some(ok) = judged.stable {
        let value = judged.smallest_eigenvalue.unwrap_or(f64::NAN);
        checks.push(Check { name: "stability", value, limit: 0.0, ok, at: None });
    }
    Ok(checks)
}

/// Largest fibre strain at a point of a step, theory (9); None where the backbone is turned inside out.
fn fibre_strain(
    robot: &Robot,
    section: usize,
    step: &super::chain::Step,
    c: usize,
    node: &Node,
    along: f64,
) -> Option<f64> {
    let strains = rod::section_law(step, c, 1.0, node);
    let section = &robot.sections[section];
    let bending: Vector3<f64> = strains.u - section.rest_curvature;
    let cross_section = section.cross_section((along / section.length).clamp(0.0, 1.0));
    (strains.v.z > 0.0)
        .then(|| (strains.v.z - 1.0).abs() + cross_section.bending_strain([bending.x, bending.y]))
}
