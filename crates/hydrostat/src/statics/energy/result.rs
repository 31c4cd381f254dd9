//! What is read off the solution: stations, tendons, strains.

use super::mesh::Passing;
use super::node::Shape;
use super::search::LARGEST_TURN;
use super::{Averaged, Energy};
use crate::model::Routing;
use crate::solution::{Station, TendonState};
use crate::statics::chain::Chain;
use crate::statics::rod::{self, Node};
use crate::statics::span::{POINTS, Span, Step};
use crate::{Error, Robot};
use nalgebra::{Matrix3, Vector3};

/// Stations are integrated in steps of at most this angle, of shape and load, rad.
const STATION_ANGLE: f64 = 0.3;

impl Energy {
    /// The tendons at the solution.
    pub(in crate::statics) fn tendon_states(&self, robot: &Robot) -> Vec<TendonState> {
        let read = self.read_averaged();
        let drive = read.map_or(&self.memory.drive, |(averaged, _)| &averaged.energy.memory.drive);
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

    /// The state at `s`, on the base side of a jump.
    pub(in crate::statics) fn station(&self, robot: &Robot, chain: &Chain, s: f64) -> Station {
        let station = self.station_of_panel(robot, chain, s);
        let Some((averaged, _)) = self.read_averaged() else { return station };
        // as far as the averaged robot has moved since the gaps were placed
        let tables = &self.tables;
        let [now, then] = [&averaged.energy.coarse, &averaged.gaps.beside].map(|mesh| mesh.at(tables, s));
        let span = &chain.spans[self.coarse.panels[self.coarse.panel_at(s)].span];
        let (shear, bend) = robot.sections[span.section].stiffness(span.fraction(robot, s));
        let (dv, du) = (now.v - then.v, now.u - then.u);
        let turned = now.rotation * then.rotation.transpose();
        let rotation = turned * station.rotation;
        Station {
            s,
            position: station.position + now.position - then.position,
            rotation,
            v: station.v + dv,
            u: station.u + du,
            force: turned * station.force + rotation * shear.component_mul(&dv),
            moment: turned * station.moment + rotation * bend.component_mul(&du),
        }
    }

    /// Integrated back from the end of its panel, where the solution is most accurate.
    fn station_of_panel(&self, robot: &Robot, chain: &Chain, s: f64) -> Station {
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
        chain: &Chain,
        mut visit: impl FnMut(&Span, f64, &Vector3<f64>, &Vector3<f64>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let mut outcome = Ok(());
        let mut visit = |span: &Span, s: f64, v: &Vector3<f64>, u: &Vector3<f64>| {
            if outcome.is_ok() {
                outcome = visit(span, s, v, u);
            }
        };
        if let Some((averaged, measured)) = self.read_averaged() {
            let Averaged { energy: Energy { coarse, .. }, chain, .. } = averaged;
            averaged.energy.visit_strains(chain, |span, s, v, u| {
                let panel = coarse.panel_at(s);
                let at_rest = coarse.data[coarse.panels[panel].nodes.start].rest_curvature;
                let more = (measured.more[panel].bending - 1.0) * (u - at_rest).xy();
                visit(span, s, v, &(u + Vector3::new(more.x, more.y, 0.0)));
            });
        } else {
            self.visit_strains(chain, visit);
        }
        outcome
    }

    pub(super) fn visit_strains(
        &self,
        chain: &Chain,
        mut visit: impl FnMut(&Span, f64, &Vector3<f64>, &Vector3<f64>),
    ) {
        let Energy { tables, coarse, memory, .. } = self;
        for (panel, front) in coarse.panels.iter().zip(&memory.sweep.panels) {
            let (table, span) = (tables.of(panel.nodes.len()), &chain.spans[panel.span]);
            let (_, start, v) = coarse.interpolated(panel, &table.start);
            visit(span, panel.from, &v, &start); // J(0) = 1
            for (point, shape) in table.points.iter().zip(&memory.sweep.shapes[panel.nodes.clone()]) {
                visit(span, panel.from + point * panel.length, &shape.v, &shape.u);
            }
            let (_, rate, v) = coarse.interpolated(panel, &table.finish);
            visit(span, panel.from + panel.length, &v, &(front.end.jacobian * rate));
        }
    }

    /// At the middle of every panel between plates: s, how far a tendon's straight line is from the curve of its hole, and the
    /// radius of the hole. Of an averaged robot, of a gap around every node.
    pub(in crate::statics) fn for_each_deviation(&self, robot: &Robot, mut visit: impl FnMut(f64, f64, f64)) {
        if let Some((averaged, measured)) = self.read_averaged() {
            averaged.energy.visit_deviations(robot, |s, away, radius| {
                let panel = averaged.energy.coarse.panel_at(s);
                visit(s, measured.more[panel].deviation * away, radius);
            });
        } else {
            self.visit_deviations(robot, visit);
        }
    }

    pub(super) fn visit_deviations(&self, robot: &Robot, mut visit: impl FnMut(f64, f64, f64)) {
        let Energy { tables, coarse, memory, .. } = self;
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
        if coarse.passing.iter().all(|passing| passing.slack.gap == 0.0) {
            return;
        }
        for panel in &coarse.panels {
            let points = &tables.of(panel.nodes.len()).points;
            for (node, point) in panel.nodes.clone().zip(points) {
                let Shape { v, u, .. } = &memory.sweep.shapes[node];
                for Passing { slack, .. } in &coarse.passing[coarse.data[node].passing.clone()] {
                    let path = v + u.cross(&slack.hole);
                    // h^2/8 of the curvature across the path
                    let away = 3.0 * slack.gap * path.cross(&u.cross(&path)).norm() / path.norm();
                    visit(panel.from + point * panel.length, away, slack.hole.norm());
                }
            }
        }
    }

    /// Pose of the tip.
    pub(in crate::statics) fn tip(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let last = self.coarse.panels.len();
        let (position, rotation) = (self.coarse.positions[last], self.coarse.rotations[last]);
        let Some((averaged, _)) = self.read_averaged() else { return (position, rotation) };
        let (now, then) = (&averaged.energy.coarse, &averaged.gaps.beside);
        let tip = now.panels.len();
        (
            position + now.positions[tip] - then.positions[tip],
            now.rotations[tip] * then.rotations[tip].tr_mul(&rotation),
        )
    }
}
