//! Capstan friction: how the tension of a tendon falls or rises along its way, theory (37).
//!
//! On a given shape the tension at s is the tension at the base times exp(-mu Theta(s)) while the tendon is pulled, and
//! exp(mu Theta(s)) after a release; Theta is the angle through which its tangent has turned since the base.

use super::mesh::{Mesh, Tables};
use super::sweep::Sweep;
use crate::Robot;
use crate::model::{Command, Motion, Routing};
use crate::numeric::collocation::Collocation;
use nalgebra::Vector3;

/// Sets the shares of all tendons with friction to those of the placed shape. Returns the largest change. `means` and `ends` get
/// the shares' averages along the tendons and their values at the ends.
pub(super) fn update(
    robot: &Robot,
    mesh: &mut Mesh,
    sweep: &Sweep,
    tables: &Tables,
    means: &mut Vec<f64>,
    ends: &mut Vec<f64>,
) -> f64 {
    means.clear();
    means.resize(robot.tendons.len(), 1.0);
    ends.clone_from(means);
    let mut largest = 0.0_f64;
    for (i, (tendon, command)) in robot.tendons.iter().zip(&robot.actuation).enumerate() {
        if tendon.friction == 0.0 {
            continue;
        }
        let (Command::Tension { motion, .. } | Command::Displacement { motion, .. }) = command;
        let coefficient = if *motion == Motion::Pulled { -tendon.friction } else { tendon.friction };
        let mut along = Along { coefficient, turned: 0.0, largest: 0.0, sum: 0.0, length: 0.0, last: 1.0 };
        match tendon.routing {
            Routing::Guides if !mesh.chords.is_empty() => along.chords(i, mesh),
            _ => along.channel(i, mesh, sweep, tables),
        }
        means[i] = if along.length > 0.0 { along.sum / along.length } else { 1.0 };
        ends[i] = along.last;
        largest = largest.max(along.largest);
    }
    largest
}

impl Mesh {
    /// All shares: of the channel tendons at the nodes, then of the chords.
    pub(super) fn shares(&self) -> Vec<f64> {
        let passing = self.passing.iter().map(|passing| passing.share);
        passing.chain(self.chords.iter().map(|chord| chord.share)).collect()
    }

    pub(super) fn set_shares(&mut self, shares: &[f64]) {
        let passing = self.passing.iter_mut().map(|passing| &mut passing.share);
        let own = passing.chain(self.chords.iter_mut().map(|chord| &mut chord.share));
        own.zip(shares).for_each(|(own, share)| *own = *share);
    }
}

/// A walk along a tendon from the base.
struct Along {
    coefficient: f64,
    /// Angle turned so far.
    turned: f64,
    largest: f64,
    sum: f64,
    length: f64,
    last: f64,
}

impl Along {
    fn share(&mut self, share: &mut f64, turned: f64, length: f64) {
        let target = (self.coefficient * turned).exp();
        self.largest = self.largest.max((target - *share).abs());
        *share = target;
        self.sum += *share * length;
        self.length += length;
    }

    fn channel(&mut self, tendon: usize, mesh: &mut Mesh, sweep: &Sweep, tables: &Tables) {
        let mut before: Option<Vector3<f64>> = None;
        for k in 0..mesh.panels.len() {
            let panel = mesh.panels[k].clone();
            let table = tables.of(panel.nodes.len());
            let passing: Option<Vec<usize>> = panel
                .nodes
                .clone()
                .map(|node| mesh.data[node].passing.clone().find(|&p| mesh.passing[p].tendon == tendon))
                .collect();
            let Some(passing) = passing else { break };
            let paths: Vec<(f64, Vector3<f64>)> = panel
                .nodes
                .clone()
                .zip(&passing)
                .map(|(node, &p)| {
                    let path = &sweep.paths[p];
                    (path.speed, sweep.shapes[node].rotation * path.tangent)
                })
                .collect();
            // a kink where the strain jumps
            let start = interpolated(table, &paths, 0.0);
            if let Some(before) = before.filter(|_| k > 0 && mesh.panels[k - 1].ends_span) {
                self.turned += before.cross(&start).norm().atan2(before.dot(&start));
            }
            before = Some(interpolated(table, &paths, 1.0));
            let rates: Vec<f64> = (0..paths.len())
                .map(|i| {
                    let slopes = table.row(table.points[i]).inner_slope;
                    paths.iter().zip(slopes).map(|(path, slope)| slope * path.1).sum::<Vector3<f64>>().norm()
                })
                .collect();
            let to_points = table.to_point.chunks_exact(paths.len());
            for (i, ((&p, path), to_point)) in passing.iter().zip(&paths).zip(to_points).enumerate() {
                // the polynomial through the rates, integrated to the node
                let within: f64 = rates.iter().zip(to_point).map(|(rate, weight)| weight * rate).sum();
                let turned = self.turned + within;
                let length = table.weights[i] * panel.length * path.0;
                self.share(&mut mesh.passing[p].share, turned, length);
            }
            self.turned += rates.iter().zip(&table.weights).map(|(rate, weight)| rate * weight).sum::<f64>();
        }
        self.last = (self.coefficient * self.turned).exp();
    }

    fn chords(&mut self, tendon: usize, mesh: &mut Mesh) {
        let mut before: Option<Vector3<f64>> = None;
        for gap in mesh.gaps.clone() {
            let Some(chord) = gap.chords.clone().find(|&chord| mesh.chords[chord].tendon == tendon) else {
                break;
            };
            let span = mesh.chord(&gap, &mesh.chords[chord].holes);
            if let Some(before) = before {
                self.turned += before.cross(&span).norm().atan2(before.dot(&span));
            }
            before = Some(span);
            let turned = self.turned;
            let mut share = mesh.chords[chord].share;
            self.share(&mut share, turned, span.norm());
            mesh.chords[chord].share = share;
            self.last = share;
        }
    }
}

/// The tangent at a fraction of a panel.
fn interpolated(table: &Collocation, paths: &[(f64, Vector3<f64>)], t: f64) -> Vector3<f64> {
    paths.iter().zip(table.row(t).inner).map(|(path, inner)| inner * path.1).sum()
}
