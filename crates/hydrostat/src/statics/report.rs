//! What the caller sees of a converged mesh: stations, checks, report.

use super::chain::Chain;
use super::checks;
use super::energy::{self, Energy};
use super::rod;
use super::search::Found;
use super::shooting::Mesh;
use super::{Settings, Workspace};
use crate::Error;
use crate::geometry::RotationVector;
use crate::model::{Pose, Robot};
use crate::solution::{Check, Equilibrium, Method, Report, Station, TendonState};
use nalgebra::{Matrix3, Rotation3, Vector3};

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
    workspace: &Workspace,
    found: &Found,
    judged: &Judged,
    tendons: Vec<TendonState>,
) -> Result<Equilibrium, Error> {
    let Workspace { chain, tensions, fine: mesh, .. } = workspace;
    let tip = mesh.nodes[mesh.steps.len()];
    let stations: Vec<Station> = (0..settings.stations)
        .map(|i| station(chain_position(chain, i, settings.stations), robot, chain, tensions, mesh))
        .collect();
    let mut checks = rod_checks(robot, settings, chain, tensions, mesh, &stations)?;
    checks.extend(checks::tendons(robot, &tendons)?);
    let station = |s| station(s, robot, chain, tensions, mesh);
    checks.extend(checks::GuideSpacing::of_stations(robot, chain, station).check());
    checks.extend(stability(judged));
    Ok(Equilibrium {
        tip: Pose {
            position: mesh.positions[mesh.steps.len()],
            rotation: Rotation3::from_matrix_unchecked(tip.rotation),
        },
        stations,
        tendons,
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
    if let Some(station) =
        stations.iter().find(|station| !(station.u.norm() + station.position.norm()).is_finite())
    {
        return Err(Error::new(format!("the section law has no answer at s = {:.4} m", station.s))
            .hint("a tendon bends the backbone around its own hole: pull less, or stiffen the backbone"));
    }
    // loads that have no energy may set a robot in motion even where no direction is downhill
    let stable = match found.negative {
        Some(0) => chain.conservative.then_some(true),
        Some(_) => Some(false),
        None => None,
    };
    let judged =
        Judged { stable, smallest_eigenvalue: found.smallest_eigenvalue, unstable_from: found.unstable_from };
    let tendons = energy.tendon_states(robot);
    let mut strain = checks::Strain::default();
    energy.for_each_strain(chain, |span, s, v, u| strain.sample(robot, span, s, v, u))?;
    let mut checks: Vec<Check> = strain.check().into_iter().collect();
    checks.extend(checks::tendons(robot, &tendons)?);
    let mut spacing = checks::GuideSpacing::default();
    energy.for_each_deviation(robot, |s, away, radius| spacing.sample(s, away, radius));
    checks.extend(spacing.check());
    checks.extend(stability(&judged));
    Ok(Equilibrium {
        tip: Pose { position, rotation: Rotation3::from_matrix_unchecked(rotation) },
        stations,
        tendons,
        checks,
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
pub(super) fn station(s: f64, robot: &Robot, chain: &Chain, tensions: &[f64], mesh: &Mesh) -> Station {
    // rounding must not carry a cut to its far side
    let k = mesh.steps.partition_point(|step| step.from + SAME_PLACE * step.length < s).saturating_sub(1);
    let step = &mesh.steps[k];
    // a whole step is taken as it stands, so that the last station is the tip to the last bit
    let part = if (s - step.from - step.length).abs() <= f64::EPSILON * chain.length {
        step.clone()
    } else {
        chain.spans[chain.span_at(step.from + 0.5 * step.length)].step(
            robot,
            tensions,
            step.from,
            (s - step.from).max(0.0),
        )
    };
    let (node, displacement) = rod::integrate(&part, 1.0, &mesh.own[k]);
    let section = rod::section_law(&part, rod::END, 1.0, &node);
    let (force, moment) = section.backbone(&part, &node);
    Station {
        s,
        position: mesh.positions[k] + displacement,
        rotation: node.rotation,
        v: section.v,
        u: section.u,
        force,
        moment,
    }
}

/// A place closer to a cut than this part of a step is the cut.
const SAME_PLACE: f64 = 1e-11;
/// Points per span at which a path at rest is summed.
pub(super) const STATION_POINTS: usize = 8;

/// Pose of the unloaded backbone at `s`.
pub(super) fn rest_pose(robot: &Robot, s: f64) -> (Vector3<f64>, Matrix3<f64>) {
    let (mut position, mut rotation) = (robot.base.position, *robot.base.rotation.matrix());
    let mut from = 0.0;
    for section in &robot.sections {
        let length = (s - from).clamp(0.0, section.length);
        let turn = RotationVector::new(length * section.rest_curvature);
        // the integral of exp(t hat(u)) is J(-w) = J(w)^T for constant u
        position += length * (rotation * (turn.jacobian().transpose() * Vector3::z()));
        rotation *= turn.rotation();
        from += section.length;
    }
    (position, rotation)
}

/// The backbone is sampled at least so often for its largest strain, unless only the bare shape is wanted.
const SAMPLES: usize = 65;

/// Strain against the limit of each material, and stability.
fn rod_checks(
    robot: &Robot,
    settings: &Settings,
    chain: &Chain,
    tensions: &[f64],
    mesh: &Mesh,
    stations: &[Station],
) -> Result<Vec<Check>, Error> {
    let mut strain = checks::Strain::default();
    // both ends of every step: strains jump where sections and loads do
    for (k, step) in mesh.steps.iter().enumerate() {
        let span = &chain.spans[chain.span_at(step.from + 0.5 * step.length)];
        let end = if mesh.own_differs() {
            rod::integrate(step, 1.0, &mesh.own[k]).0
        } else {
            let mut end = mesh.nodes[k + 1];
            rod::pass(&mesh.jumps[k], -1.0, &mut end);
            end
        };
        for (c, node, s) in [(rod::START, &mesh.own[k], step.from), (rod::END, &end, step.from + step.length)]
        {
            let section = rod::section_law(step, c, 1.0, node);
            strain.sample(robot, span, s, &section.v, &section.u)?;
        }
    }
    for station in stations {
        strain.sample(robot, &chain.spans[chain.span_at(station.s)], station.s, &station.v, &station.u)?;
    }
    if settings.eigenvalue && stations.len() < SAMPLES {
        for i in 0..SAMPLES {
            let station = station(chain_position(chain, i, SAMPLES), robot, chain, tensions, mesh);
            strain.sample(
                robot,
                &chain.spans[chain.span_at(station.s)],
                station.s,
                &station.v,
                &station.u,
            )?;
        }
    }
    let mut checks = Vec::with_capacity(2);
    checks.extend(strain.check());
    Ok(checks)
}

fn stability(judged: &Judged) -> Option<Check> {
    let value = judged.smallest_eigenvalue.unwrap_or(f64::NAN);
    judged.stable.map(|ok| Check { name: "stability", value, limit: 0.0, ok, at: None, tendons: Vec::new() })
}

/// Arc length of the i-th of `count` points, both ends included.
fn chain_position(chain: &Chain, i: usize, count: usize) -> f64 {
    chain.length * i as f64 / (count.max(2) - 1) as f64
}
