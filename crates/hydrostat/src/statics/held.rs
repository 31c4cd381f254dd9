//! Tendons in the shooting method: their lengths, and the tensions of those held by displacement.

use super::report::{self, STATION_POINTS};
use super::search::{Found, MOST_WORK};
use super::section::Pull;
use super::{Settings, Workspace, shoot};
use crate::model::{Command, Routing};
use crate::numeric::nonnegative;
use crate::solution::TendonState;
use crate::{Error, Robot};
use nalgebra::{DMatrix, DVector, Vector3};

const MOST_ITERATIONS: usize = 15;
/// Shapes are found to this part of the tolerance. Lengths must agree to the second part of it times the distance of the holes: a length
/// bends the robot by so much more.
const SHAPE_TOLERANCE: f64 = 0.1;
const LENGTH_TOLERANCE: f64 = 0.5;
/// Part of the last difference of lengths that is still slow.
const SLOW: f64 = 0.2;
/// Differences of tensions that bend the robot by about this angle, and the accuracy of the shapes between which they are taken.
const DIFFERENCE: f64 = 3e-3;
const ROUGH: f64 = 1e-7;
/// Steps linearised for a robot with tendons, at most: seconds of work. One counts for so many where tendons run in channels and
/// through guides, and every gap is crossed in turns with the section law.
const MOST_TENDON_WORK: usize = 100_000;
const BOTH_ROUTINGS: usize = 10;

/// Shoots under the commanded tensions, and finds those of the held tendons by Newton's method with differences.
pub(super) fn solve(
    robot: &Robot,
    settings: &Settings,
    workspace: &mut Workspace,
    warm: bool,
) -> Result<(Found, Vec<TendonState>), Error> {
    if robot.tendons.iter().any(|tendon| tendon.friction > 0.0) {
        return Err(Error::new("shooting knows no friction of tendons")
            .hint("use the energy method, which is the default"));
    }
    let known = if warm { workspace.tensions.clone() } else { Vec::new() };
    let given = |command: &Command| match command {
        Command::Tension { tension, .. } => *tension,
        Command::Displacement { .. } => 0.0,
    };
    workspace.tensions = robot.actuation.iter().map(given).collect();
    let held: Vec<usize> = (0..robot.tendons.len())
        .filter(|&i| matches!(robot.actuation[i], Command::Displacement { .. }))
        .collect();
    if warm && known.len() == workspace.tensions.len() {
        held.iter().for_each(|&i| workspace.tensions[i] = known[i]);
    }
    (workspace.work, workspace.most_work) = (0, most_work(robot));
    let mut found = shoot(robot, settings, workspace, warm)?;
    if robot.tendons.is_empty() {
        return Ok((found, Vec::new()));
    }
    let home = home_lengths(robot, workspace);
    let mut lengths = lengths(robot, workspace);
    let tolerance = (SHAPE_TOLERANCE * settings.tolerance).max(1e-12);
    let quick = Settings { eigenvalue: false, tolerance, ..settings.clone() };
    let rough = Settings { tolerance: tolerance.max(ROUGH), ..quick.clone() };
    let mut s = DMatrix::zeros(held.len(), held.len());
    let mut last_off = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let tensions = workspace.tensions.clone();
        let excess: Vec<f64> =
            held.iter().map(|&i| excess(robot, i, lengths[i], home[i], tensions[i])).collect();
        let off = held
            .iter()
            .zip(&excess)
            .map(|(&i, excess)| if tensions[i] > 0.0 { excess.abs() } else { excess.max(0.0) });
        let off = off.fold(0.0, f64::max);
        let arms = held.iter().map(|&i| arm(robot, i, workspace.chain.length));
        let near = LENGTH_TOLERANCE * settings.tolerance * arms.fold(workspace.chain.length, f64::min);
        if off <= near.max(f64::EPSILON * workspace.chain.length) {
            return Ok((found, states(robot, &workspace.tensions, &home, &lengths)));
        }
        // how the lengths follow the tensions, anew where what was known of it leads on too slowly
        let slow = off > SLOW * last_off;
        last_off = off;
        for (column, &j) in held.iter().enumerate().filter(|_| slow) {
            let length = workspace.chain.length;
            let change = DIFFERENCE * workspace.chain.stiffness / (arm(robot, j, length) * length);
            workspace.tensions[j] = tensions[j] + change;
            shoot(robot, &rough, workspace, true)?;
            let ahead = self::lengths(robot, workspace);
            workspace.tensions[j] = tensions[j];
            for (row, &i) in held.iter().enumerate() {
                s[(row, column)] = (lengths[i] - ahead[i]) / change;
            }
            s[(column, column)] += compliance(robot, j, home[j]);
        }
        let now = DVector::from_iterator(held.len(), held.iter().map(|&i| tensions[i]));
        let right = DVector::from_vec(excess) + &s * &now;
        // with followers it is not symmetric
        let Some(target) = nonnegative::minimise(&s, &right) else { break };
        // as far towards them as the robot can be solved
        let mut part = 1.0;
        found = loop {
            for (k, &i) in held.iter().enumerate() {
                workspace.tensions[i] = tensions[i] + part * (target[k] - tensions[i]);
            }
            match shoot(robot, &quick, workspace, true) {
                Ok(found) => break found,
                Err(error) if part < 1e-3 || workspace.work > workspace.most_work => return Err(error),
                Err(_) => part *= 0.5,
            }
        };
        lengths = self::lengths(robot, workspace);
    }
    Err(Error::new("the tensions that hold the tendons at their displacements were not found by shooting")
        .hint("use the energy method, which is the default"))
}

/// Steps that shooting may linearise for a robot.
fn most_work(robot: &Robot) -> usize {
    let runs = |routing: Routing| robot.tendons.iter().any(|tendon| tendon.routing == routing);
    match (runs(Routing::Channel), runs(Routing::Guides)) {
        (false, false) => MOST_WORK,
        (true, true) => MOST_TENDON_WORK / BOTH_ROUTINGS,
        _ => MOST_TENDON_WORK,
    }
}

/// Distance of a tendon's holes from the backbone, at least a thousandth of the length.
fn arm(robot: &Robot, i: usize, length: f64) -> f64 {
    robot.tendons[i].path.radius.max(1e-3 * length)
}

fn compliance(robot: &Robot, i: usize, home: f64) -> f64 {
    robot.tendons[i].stiffness.map_or(0.0, |stiffness| home / stiffness)
}

/// How much longer a held tendon is than its command and stretch allow.
fn excess(robot: &Robot, i: usize, length: f64, home: f64, tension: f64) -> f64 {
    let pulled = match robot.actuation[i] {
        Command::Displacement { displacement, .. } => displacement + robot.tendons[i].home,
        Command::Tension { .. } => 0.0,
    };
    length - home + pulled - compliance(robot, i, home) * tension
}

fn states(robot: &Robot, tensions: &[f64], home: &[f64], lengths: &[f64]) -> Vec<TendonState> {
    let state = |i: usize| TendonState {
        name: robot.tendons[i].name.clone(),
        tension: tensions[i],
        tip_tension: tensions[i],
        displacement: home[i] - robot.tendons[i].home - lengths[i]
            + compliance(robot, i, home[i]) * tensions[i],
        length: lengths[i],
        slack: tensions[i] == 0.0 && matches!(robot.actuation[i], Command::Displacement { .. }),
    };
    (0..robot.tendons.len()).map(state).collect()
}

/// Points at which a step's path is summed; Gauss-Legendre, exact to degree 11.
const GAUSS: [(f64, f64); 6] = [
    (0.033765242898423975, 0.08566224618958517),
    (0.16939530676686776, 0.1803807865240693),
    (0.3806904069584015, 0.23395696728634552),
    (0.6193095930415985, 0.23395696728634552),
    (0.8306046932331322, 0.1803807865240693),
    (0.966234757101576, 0.08566224618958517),
];

/// Lengths of the paths on the solution.
fn lengths(robot: &Robot, workspace: &Workspace) -> Vec<f64> {
    let mut lengths = vec![0.0; robot.tendons.len()];
    let channel = |routing: Routing| routing == Routing::Channel;
    if robot.tendons.iter().any(|tendon| channel(tendon.routing)) {
        for step in &workspace.fine.steps {
            for (point, weight) in GAUSS {
                let s = step.from + point * step.length;
                let station =
                    report::station(s, robot, &workspace.chain, &workspace.tensions, &workspace.fine);
                for (length, tendon) in lengths.iter_mut().zip(&robot.tendons) {
                    let end = robot.tendon_end(tendon);
                    if channel(tendon.routing) && s < end {
                        let (hole, along) = tendon.path.hole(s / end, end);
                        let pull = Pull { hole, along, tension: 0.0, gap: 0.0 };
                        *length += weight * step.length * pull.path(&station.v, &station.u).speed;
                    }
                }
            }
        }
    }
    let poses = |s: f64| report::station(s, robot, &workspace.chain, &workspace.tensions, &workspace.fine);
    add_chords(robot, &mut lengths, |s| {
        let station = poses(s);
        (station.position, station.rotation)
    });
    lengths
}

/// Of the unloaded robot.
fn home_lengths(robot: &Robot, workspace: &Workspace) -> Vec<f64> {
    let mut lengths = vec![0.0; robot.tendons.len()];
    for span in &workspace.chain.spans {
        let u = robot.sections[span.section].rest_curvature;
        for (length, tendon) in lengths.iter_mut().zip(&robot.tendons) {
            let end = robot.tendon_end(tendon);
            if tendon.routing == Routing::Channel && span.from < end * (1.0 - 1e-12) {
                // the speed along a helix on a bent rod varies: sum over short parts
                let part = (span.to - span.from) / STATION_POINTS as f64;
                for k in 0..STATION_POINTS {
                    for (point, weight) in GAUSS {
                        let s = span.from + (k as f64 + point) * part;
                        let (hole, along) = tendon.path.hole(s / end, end);
                        let pull = Pull { hole, along, tension: 0.0, gap: 0.0 };
                        *length += weight * part * pull.path(&Vector3::z(), &u).speed;
                    }
                }
            }
        }
    }
    add_chords(robot, &mut lengths, |s| report::rest_pose(robot, s));
    lengths
}

fn add_chords(
    robot: &Robot,
    lengths: &mut [f64],
    pose: impl Fn(f64) -> (Vector3<f64>, nalgebra::Matrix3<f64>),
) {
    for pair in robot.plates().windows(2) {
        let ends = [pose(pair[0]), pose(pair[1])];
        for (length, tendon) in lengths.iter_mut().zip(&robot.tendons) {
            let end = robot.tendon_end(tendon);
            if tendon.routing == Routing::Guides && pair[1] <= end * (1.0 + 1e-9) {
                let hole =
                    |k: usize| ends[k].0 + ends[k].1 * tendon.path.hole((pair[k] / end).min(1.0), end).0;
                *length += (hole(1) - hole(0)).norm();
            }
        }
    }
}
