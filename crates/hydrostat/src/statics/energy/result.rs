//! What is read off the solution: stations, tendons, strains.

use super::Energy;
use super::search::LARGEST_TURN;
use crate::model::Routing;
use crate::solution::{Station, TendonState};
use crate::statics::chain::{Chain, POINTS, Span, Step};
use crate::statics::rod::{self, Node};
use crate::{Error, Robot};
use nalgebra::{Matrix3, Vector3};

/// Stations are integrated in steps of at most this angle, of shape and load, rad.
const STATION_ANGLE: f64 = 0.3;

impl Energy {
    /// The tendons at the solution.
    pub(in crate::statics) fn tendon_states(&self, robot: &Robot) -> Vec<TendonState> {
        let drive = &self.memory.drive;
        let state = |(i, tendon): (usize, &crate::model::Tendon)| TendonState {
            name: tendon.name.clone(),
            tension: drive.tensions[i],
            tip_tension: drive.tensions[i] * drive.end_shares.get(i).unwrap_or(&1.0),
            displacement: drive.home[i] - tendon.home - drive.lengths[i]
                + drive.compliance(robot, i) * drive.tensions[i],
            length: drive.lengths[i],
            slack: drive.held.iter().zip(&drive.taut).any(|(held, taut)| *held == i && !taut),
        };
        robot.tendons.iter().enumerate().map(state).collect()
    }

    /// The state at `s`, on the base side of a jump: integrated back from the end of its panel, where the solution is most
    /// accurate.
    pub(in crate::statics) fn station(&self, robot: &Robot, chain: &Chain, s: f64) -> Station {
        let Energy { coarse, memory, .. } = self;
        let k = coarse.panel_at(s);
        let panel = &coarse.panels[k];
        let span = &chain.spans[panel.span];
        let chords = memory.sweep.chord_force(panel);
        let (end, rest) = (panel.from + panel.length, (panel.from + panel.length - s).max(0.0));
        let (_, bend) = robot.sections[span.section].stiffness(span.fraction(robot, s));
        let following = memory.sweep.following.get(k).map_or(Vector3::zeros(), |of| of.beyond);
        let force = (span.dead_force(robot, s) + chords + following).norm();
        let per_length = (force / bend.min()).sqrt().max(span.largest_angle(robot));
        let angle = rest * per_length.max(LARGEST_TURN / panel.length);
        let parts = (angle / STATION_ANGLE).ceil().max(1.0);
        let mut node = Node {
            rotation: coarse.rotations[k + 1],
            moment: coarse.rotations[k + 1] * memory.sweep.end_moment(k),
            force: following,
        };
        let mut position = coarse.positions[k + 1];
        let mut step = self.step_with_chords(robot, span, k, end, -rest / parts);
        for part in 0..parts as usize {
            if part > 0 {
                step = self.step_with_chords(robot, span, k, end - part as f64 * rest / parts, -rest / parts);
            }
            let (next, displacement) = rod::integrate(&step, 1.0, &node);
            (node, position) = (next, position + displacement);
        }
        let section = rod::section_law(&step, rod::END, 1.0, &node);
        let (force, moment) = section.backbone(&step, &node);
        Station { s, position, rotation: node.rotation, v: section.v, u: section.u, force, moment }
    }

    /// A step within panel `k`, under the chords beside it and the tensions that friction leaves.
    fn step_with_chords(&self, robot: &Robot, span: &Span, k: usize, from: f64, length: f64) -> Step {
        let Energy { tables, coarse, memory, .. } = self;
        let mut step = span.step(robot, &memory.drive.tensions, from, length);
        let chords = memory.sweep.chord_force(&coarse.panels[k]);
        step.stages.iter_mut().for_each(|stage| stage.force += chords);
        if !memory.drive.mean_shares.is_empty() {
            let middle = 0.5 * (span.from + span.to);
            let passing = (0..robot.tendons.len()).filter(|&i| {
                let tendon = &robot.tendons[i];
                tendon.routing == Routing::Channel && middle < robot.tendon_end(tendon)
            });
            for (points, i) in step.pulls.iter_mut().zip(passing) {
                for (pull, c) in points.iter_mut().zip(POINTS) {
                    pull.tension *= coarse.share(tables, k, i, from + c * length);
                }
            }
        }
        step
    }

    /// Span, arc length, v and u at the nodes and both ends of every panel.
    pub(in crate::statics) fn for_each_strain(
        &self,
        mut visit: impl FnMut(usize, f64, &Vector3<f64>, &Vector3<f64>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let Energy { tables, coarse, memory, .. } = self;
        for (panel, front) in coarse.panels.iter().zip(&memory.sweep.panels) {
            let table = tables.of(panel.nodes.len());
            let (_, start, v) = coarse.interpolated(panel, &table.start);
            visit(panel.span, panel.from, &v, &start)?; // J(0) = 1
            for (point, shape) in table.points.iter().zip(&memory.sweep.shapes[panel.nodes.clone()]) {
                visit(panel.span, panel.from + point * panel.length, &shape.v, &shape.u)?;
            }
            let (_, rate, v) = coarse.interpolated(panel, &table.finish);
            visit(panel.span, panel.from + panel.length, &v, &(front.end.jacobian * rate))?;
        }
        Ok(())
    }

    /// At the middle of every panel between plates: s, how far a tendon's straight line is from the curve of its hole, and the
    /// radius of the hole.
    pub(in crate::statics) fn for_each_deviation(&self, robot: &Robot, mut visit: impl FnMut(f64, f64, f64)) {
        let Energy { coarse, .. } = self;
        for gap in &coarse.gaps {
            let start = coarse.panels[gap.panels.start].from;
            let across: f64 = coarse.panels[gap.panels.clone()].iter().map(|panel| panel.length).sum();
            for k in gap.panels.clone() {
                let panel = &coarse.panels[k];
                let s = panel.from + 0.5 * panel.length;
                let part = (s - start) / across;
                let (position, rotation) = &coarse.middles[k];
                for chord in &coarse.chords[gap.chords.clone()] {
                    let tendon = &robot.tendons[chord.tendon];
                    let hole = if tendon.path.turns == 0.0 {
                        chord.holes[0].lerp(&chord.holes[1], part)
                    } else {
                        let end = robot.tendon_end(tendon);
                        tendon.path.hole(s / end, end).0
                    };
                    let first = coarse.positions[gap.panels.start]
                        + coarse.rotations[gap.panels.start] * chord.holes[0];
                    let line = coarse.chord(gap, &chord.holes);
                    let away = (position + rotation * hole - first).cross(&line).norm() / line.norm();
                    visit(s, away, hole.norm());
                }
            }
        }
    }

    /// Pose of the tip.
    pub(in crate::statics) fn tip(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let last = self.coarse.panels.len();
        (self.coarse.positions[last], self.coarse.rotations[last])
    }
}
