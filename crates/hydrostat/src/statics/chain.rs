//! The backbone cut at its breakpoints, with everything along it that does not depend on the shape.

use super::span::{Jump, Span, Uniform};
use crate::model::{Frame, Guides, LoadKind, Robot, Tendon};
use nalgebra::Vector3;

/// The spans between breakpoints: section ends, point loads, guides, ends of distributed loads.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub(super) spans: Vec<Span>,
    pub(super) length: f64,
    /// Length over the integral of 1 / (smaller bending stiffness), N m^2: the scale of moments.
    pub(super) stiffness: f64,
    /// Whether a load follows the shape, so that the force along the backbone is unknown too.
    pub(super) follower: bool,
    /// Whether all loads are dead forces, so that the equilibrium is the stationary point of an energy.
    pub(super) conservative: bool,
    /// Whether no dead moment and no follower acts, so that the tangent is symmetric.
    pub(super) symmetric: bool,
    /// As [`Robot::plates`]; empty where gaps are averaged.
    pub(super) plates: Vec<f64>,
    /// Whether guides and the tendons straight between them are spread evenly, theory (67).
    averaged: bool,
    cuts: Vec<f64>,
}

impl Chain {
    /// Cuts the robot, whatever its commands; keeps the memory of an earlier chain.
    pub(super) fn rebuild(&mut self, robot: &Robot) {
        self.averaged = false;
        self.lay(robot);
    }

    /// The same robot with its guides spread evenly along each section, and the tendons straight between them likewise.
    pub(super) fn rebuild_averaged(&mut self, robot: &Robot) {
        self.averaged = true;
        self.lay(robot);
        self.plates.clear();
    }

    /// Whether every span is a gap between guides, and those of a section are equally long.
    pub(super) fn has_even_gaps(&self) -> bool {
        let even = |pair: &[Span]| {
            let [a, b] = [&pair[0], &pair[1]].map(|span| span.to - span.from);
            pair[0].section != pair[1].section || (a - b).abs() <= SAME_GAP * a
        };
        self.spans.len() + 1 == self.plates.len() && self.spans.windows(2).all(even)
    }

    pub(super) fn is_averaged(&self) -> bool {
        self.averaged
    }

    fn lay(&mut self, robot: &Robot) {
        self.length = robot.length();
        self.plates = robot.plates();
        self.cut(robot);
        self.spans.clear();
        let (mut section, mut section_start) = (0, 0.0);
        for pair in self.cuts.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            while section + 1 < robot.sections.len()
                && middle > section_start + robot.sections[section].length
            {
                section_start += robot.sections[section].length;
                section += 1;
            }
            let of = &robot.sections[section];
            let uniform = (of.profile.base == of.profile.tip).then(|| {
                let (shear, bend) = of.stiffness(0.0);
                Uniform {
                    stiffness: (shear, bend),
                    shear: shear.map(f64::recip),
                    bend: bend.map(f64::recip),
                    weight: of.material.density * of.cross_section(0.0).area() * robot.gravity,
                }
            });
            self.spans.push(Span {
                from: pair[0],
                to: pair[1],
                section,
                section_start,
                gap: self.averaged.then(|| mean_gap(&self.plates, pair)),
                uniform,
                force_beyond: Vector3::zeros(),
                force_per_length: Vector3::zeros(),
                moment_per_length: Vector3::zeros(),
                following_force: Vector3::zeros(),
                following_moment: Vector3::zeros(),
                following_beyond: 0.0,
                heavy_tendons: robot
                    .tendons
                    .iter()
                    .any(|tendon| tendon.mass_per_length > 0.0 && middle < robot.tendon_end(tendon)),
                tendon_mass: None,
                jump: Jump::default(),
            });
        }
        for span in self.spans.iter_mut().filter(|span| span.heavy_tendons) {
            let middle = 0.5 * (span.from + span.to);
            let parallel = |tendon: &Tendon| {
                middle > robot.tendon_end(tendon)
                    || tendon.path.turns == 0.0 && tendon.path.radius == tendon.path.tip_radius
            };
            if robot.tendons.iter().all(parallel) {
                span.tendon_mass = Some(span.tendon_mass(robot, middle));
            }
        }
        self.apply_loads(robot);
        let flexibility: f64 = self
            .spans
            .iter()
            .map(|span| {
                let bend = span.compliance(robot, 0.5 * (span.from + span.to)).1;
                (span.to - span.from) * bend.x.max(bend.y)
            })
            .sum();
        self.stiffness = self.length / flexibility;
    }

    /// Sorts the breakpoints and drops those closer together than rounding.
    fn cut(&mut self, robot: &Robot) {
        let cuts = &mut self.cuts;
        cuts.clear();
        cuts.push(0.0);
        let mut end = 0.0;
        for section in &robot.sections {
            if let Some(guides) =
                section.guides.as_ref().filter(|guides| guides.mass != 0.0 && !self.averaged)
            {
                cuts.extend(guides.positions.iter().map(|position| end + position));
            }
            end += section.length;
            cuts.push(end);
        }
        if !self.averaged {
            cuts.extend(&self.plates);
        }
        cuts.extend(robot.tendons.iter().map(|tendon| robot.tendon_end(tendon)));
        for load in &robot.loads {
            match load.kind {
                LoadKind::Point { at, .. } | LoadKind::Mass { at, .. } => cuts.push(at),
                LoadKind::Distributed { from, to, .. } => cuts.extend([from, to]),
            }
        }
        let same = SAME_PLACE * self.length;
        for cut in cuts.iter_mut() {
            *cut = cut.clamp(0.0, end);
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|later, kept| *later - *kept <= same);
        // the exact ends, whatever was merged into them
        if let Some(last) = cuts.last_mut() {
            *last = end;
        }
    }

    /// Collects point and distributed loads on the spans, tip to base.
    fn apply_loads(&mut self, robot: &Robot) {
        (self.follower, self.symmetric) = (false, true);
        // friction takes energy away
        self.conservative = robot.tendons.iter().all(|tendon| tendon.friction == 0.0);
        let spans = &mut self.spans;
        let same = SAME_PLACE * self.length;
        let span_ending_at =
            |spans: &[Span], at: f64| spans.iter().position(|span| (span.to - at).abs() <= same);
        for load in &robot.loads {
            match load.kind {
                LoadKind::Point { at, force, moment, frame } => {
                    // a load on the clamp itself bends nothing
                    let Some(end) = span_ending_at(spans, at) else {
                        continue;
                    };
                    let loads = force != Vector3::zeros() || moment != Vector3::zeros();
                    let follows = frame == Frame::Body && loads;
                    if moment != Vector3::zeros() || follows {
                        self.conservative = false;
                    }
                    match frame {
                        Frame::World => {
                            self.symmetric &= moment == Vector3::zeros();
                            spans[end].force_beyond += force;
                            spans[end].jump.moment += moment;
                        }
                        Frame::Body => {
                            self.follower |= follows;
                            spans[end].jump.following_force += force;
                            spans[end].jump.following_moment += moment;
                        }
                    }
                }
                LoadKind::Mass { at, mass } => {
                    let Some(end) = span_ending_at(spans, at) else {
                        continue;
                    };
                    spans[end].force_beyond += mass * robot.gravity;
                }
                LoadKind::Distributed { from, to, force_per_length, moment_per_length, frame } => {
                    let loads = force_per_length != Vector3::zeros() || moment_per_length != Vector3::zeros();
                    let follows = frame == Frame::Body && loads;
                    if moment_per_length != Vector3::zeros() || follows {
                        self.conservative = false;
                    }
                    self.follower |= follows;
                    for span in spans.iter_mut() {
                        let middle = 0.5 * (span.from + span.to);
                        if from < middle && middle < to {
                            match frame {
                                Frame::World => {
                                    self.symmetric &= moment_per_length == Vector3::zeros();
                                    span.force_per_length += force_per_length;
                                    span.moment_per_length += moment_per_length;
                                }
                                Frame::Body => {
                                    span.following_force += force_per_length;
                                    span.following_moment += moment_per_length;
                                }
                            }
                        }
                    }
                }
            }
        }
        let mut section_start = 0.0;
        for (number, section) in robot.sections.iter().enumerate() {
            if let Some(guides) = section.guides.as_ref().filter(|guides| guides.mass != 0.0) {
                if self.averaged && !guides.positions.is_empty() {
                    spread_guides(spans, robot, number, guides);
                    continue;
                }
                for position in &guides.positions {
                    if let Some(end) = span_ending_at(spans, section_start + position) {
                        let [x, y] = guides.mass_center;
                        spans[end].force_beyond += guides.mass * robot.gravity;
                        spans[end].jump.hung += guides.mass * Vector3::new(x, y, 0.0);
                        spans[end].jump.gravity = robot.gravity;
                    }
                }
            }
            section_start += section.length;
        }
        self.symmetric &= !self.follower;
        let (mut beyond, mut following) = (Vector3::zeros(), 0.0);
        for span in spans.iter_mut().rev() {
            span.force_beyond += beyond;
            beyond = span.dead_force(robot, span.from);
            following += span.jump.following_force.norm();
            span.following_beyond = following;
            following += (span.to - span.from) * span.following_force.norm();
        }
    }

    /// Number of the span that holds `s`, the earlier one at a breakpoint.
    pub(super) fn span_at(&self, s: f64) -> usize {
        self.spans.partition_point(|span| span.to < s).min(self.spans.len() - 1)
    }
}

/// Mean of h^2/24 over the gaps that lie between two places.
fn mean_gap(plates: &[f64], between: &[f64]) -> f64 {
    let part = |pair: &[f64]| {
        let shared = (pair[1].min(between[1]) - pair[0].max(between[0])).max(0.0);
        shared * (pair[1] - pair[0]).powi(2) / 24.0
    };
    plates.windows(2).map(part).sum::<f64>() / (between[1] - between[0])
}

/// Hangs the guides of a section evenly along it, with so much more at its end, and less at its start, that the mean force along it
/// stays: Euler and Maclaurin's sum, theory (67).
fn spread_guides(spans: &mut [Span], robot: &Robot, section: usize, guides: &Guides) {
    let (length, count) = (robot.sections[section].length, guides.positions.len() as f64);
    let weight = guides.mass * robot.gravity;
    let at_end = (guides.positions.iter().sum::<f64>() / length - 0.5 * count) * weight;
    for of in [section.checked_sub(1), Some(section)].into_iter().flatten() {
        if let Some(span) = spans.iter_mut().rfind(|span| span.section == of) {
            let sign = if of == section { 1.0 } else { -1.0 };
            span.force_beyond += sign * at_end;
            span.jump.hung.z += sign * guides.mass * length / count / 12.0;
            span.jump.gravity = robot.gravity;
        }
    }
    for span in spans.iter_mut().filter(|span| span.section == section) {
        span.force_per_length += count / length * weight;
    }
}

/// Part of a gap by which the next may be longer or shorter.
const SAME_GAP: f64 = 1e-3;
/// Breakpoints closer than this fraction of the length are one.
const SAME_PLACE: f64 = 1e-12;
