//! The backbone cut at its breakpoints, with everything along it that does not depend on the shape.

use super::section::Pull;
use crate::model::{Command, Frame, Guides, LoadKind, Robot, Routing, Tendon};
use crate::numeric::dop853::{C, STAGES};
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

/// A piece of one section on which all distributed loads are constant.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    /// Index into `Robot::sections`, and where that section begins.
    pub(super) section: usize,
    pub(super) section_start: f64,
    /// Mean of h^2/24 of the gaps between guides, where these are averaged, m^2.
    gap: Option<f64>,
    /// What is the same all along; None where the section tapers.
    uniform: Option<Uniform>,
    /// Dead force beyond the span's end, world frame.
    force_beyond: Vector3<f64>,
    /// Dead force and moment per length besides the weight, world frame.
    force_per_length: Vector3<f64>,
    pub(super) moment_per_length: Vector3<f64>,
    /// Following force and moment per length, body frame.
    pub(super) following_force: Vector3<f64>,
    pub(super) following_moment: Vector3<f64>,
    /// Sum of the following forces beyond the span's end, whatever their direction.
    following_beyond: f64,
    /// Whether tendons that pass have a weight.
    heavy_tendons: bool,
    /// Their mass per length and its first moment where these are the same all along: parallel tendons.
    tendon_mass: Option<(f64, Vector3<f64>)>,
    /// Point loads at the span's end that jump in the unknown wrench.
    pub(super) jump: Jump,
}

/// A span without taper: diagonals of K_se and K_bt, of their inverses, and weight per length.
#[derive(Clone, Copy, Debug)]
struct Uniform {
    stiffness: (Vector3<f64>, Vector3<f64>),
    shear: Vector3<f64>,
    bend: Vector3<f64>,
    weight: Vector3<f64>,
}

/// Point loads at one arc length that the unknown part of the wrench sees.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jump {
    /// Dead moment, world frame.
    pub(super) moment: Vector3<f64>,
    /// First moment of the masses off the axis, sum m r_c, body frame, and gravity, world frame.
    pub(super) hung: Vector3<f64>,
    pub(super) gravity: Vector3<f64>,
    /// Following force and moment, body frame.
    pub(super) following_force: Vector3<f64>,
    pub(super) following_moment: Vector3<f64>,
}

/// Points of a step: the abscissae of the stages, then the middle.
pub(super) const POINTS: [f64; STAGES + 1] = {
    let mut points = [0.5; STAGES + 1];
    let mut i = 0;
    while i < STAGES {
        points[i] = C[i];
        i += 1;
    }
    points
};

/// One integration step with its shape-independent data at its points.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) from: f64,
    pub(super) length: f64,
    pub(super) stages: [StageData; POINTS.len()],
    pub(super) rest_curvature: Vector3<f64>,
    pub(super) moment_per_length: Vector3<f64>,
    pub(super) following_force: Vector3<f64>,
    pub(super) following_moment: Vector3<f64>,
    /// Whether either of the two is not zero.
    pub(super) follows: bool,
    /// World frame; zero where the tendons' weight does not act beside the axis.
    pub(super) gravity: Vector3<f64>,
    /// The channel tendons that pass, at every point.
    pub(super) pulls: Vec<[Pull; POINTS.len()]>,
}

/// Compliance (diagonals of K_se^-1, K_bt^-1) and dead force n (world frame) at one arc length.
#[derive(Clone, Copy, Debug)]
pub(super) struct StageData {
    pub(super) shear: Vector3<f64>,
    pub(super) bend: Vector3<f64>,
    pub(super) force: Vector3<f64>,
    /// First moment of the tendons' mass per length, body frame.
    pub(super) mass_moment: Vector3<f64>,
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

impl Span {
    /// Whether a tendon has holes all along the span, as far as it goes: in a channel, or between guides that are averaged.
    pub(super) fn passes(&self, tendon: &Tendon) -> bool {
        tendon.routing == Routing::Channel || self.gap.is_some()
    }

    /// Mean of h^2/24 of the gaps in which it is straight.
    pub(super) fn gap(&self, tendon: &Tendon) -> f64 {
        if tendon.routing == Routing::Channel { 0.0 } else { self.gap.unwrap_or(0.0) }
    }

    /// Whether its stiffness is the same all along.
    pub(super) fn is_uniform(&self) -> bool {
        self.uniform.is_some()
    }

    /// A step from `s` over `length` within this span.
    ///
    /// `tensions` are those of the tendons at the base.
    pub(super) fn step(&self, robot: &Robot, tensions: &[f64], s: f64, length: f64) -> Step {
        let stages = POINTS.map(|c| {
            let at = s + c * length;
            let (shear, bend) = self.compliance(robot, at);
            let mass_moment = self.mass_moment(robot, at);
            StageData { shear, bend, force: self.dead_force(robot, at), mass_moment }
        });
        Step {
            from: s,
            length,
            stages,
            rest_curvature: robot.sections[self.section].rest_curvature,
            moment_per_length: self.moment_per_length,
            following_force: self.following_force,
            following_moment: self.following_moment,
            follows: self.following_force != Vector3::zeros() || self.following_moment != Vector3::zeros(),
            gravity: if self.heavy_tendons { robot.gravity } else { Vector3::zeros() },
            pulls: self.pulls(robot, tensions, s, length),
        }
    }

    fn pulls(&self, robot: &Robot, tensions: &[f64], s: f64, length: f64) -> Vec<[Pull; POINTS.len()]> {
        let middle = 0.5 * (self.from + self.to);
        let passing = |tendon: &Tendon| self.passes(tendon) && middle < robot.tendon_end(tendon);
        let pull = |(tendon, tension): (&Tendon, &f64)| {
            let end = robot.tendon_end(tendon);
            POINTS.map(|c| {
                let (hole, along) = tendon.path.hole((s + c * length) / end, end);
                Pull { hole, along, tension: *tension, gap: self.gap(tendon) }
            })
        };
        robot.tendons.iter().zip(tensions).filter(|(tendon, _)| passing(tendon)).map(pull).collect()
    }

    /// Bound of [`Span::largest_angle`] where nothing turns about the axis, by the sum of the given tensions times their arms.
    pub(super) fn bound_of_angle(&self, robot: &Robot, pull: f64) -> f64 {
        let following = self.following_beyond + (self.to - self.from) * self.following_force.norm();
        let force = self.dead_force(robot, self.from).norm() + self.force_beyond.norm() + following;
        let flexibility =
            self.compliance(robot, self.from).1.amax() + self.compliance(robot, self.to).1.amax();
        (force * flexibility).sqrt() + pull * flexibility
    }

    /// Bending that the given tensions cause, and the turn of helical holes, per length.
    fn tendon_angle(&self, robot: &Robot) -> f64 {
        let middle = 0.5 * (self.from + self.to);
        let bend = self.compliance(robot, middle).1.amax();
        let mut sum = Vector3::zeros();
        let mut turning = 0.0_f64;
        for (tendon, command) in robot.tendons.iter().zip(&robot.actuation) {
            let end = robot.tendon_end(tendon);
            if middle < end {
                let (hole, along) = tendon.path.hole(middle / end, end);
                if let Command::Tension { tension, .. } = command {
                    sum += *tension * hole;
                }
                if tendon.path.turns != 0.0 {
                    turning = turning.max(along.norm() / hole.norm().max(1e-9));
                }
            }
        }
        (sum.norm() * bend).max(0.5 * turning)
    }

    /// The angle per length that a mesh must resolve: the rest curvature, and sqrt(n / EI), which keeps
    /// conjugate points (pi apart in that angle) on different steps.
    pub(super) fn largest_angle(&self, robot: &Robot) -> f64 {
        let following = self.following_beyond + (self.to - self.from) * self.following_force.norm();
        let force = self.dead_force(robot, self.from).norm().max(self.force_beyond.norm()) + following;
        let flexibility =
            [self.from, self.to].map(|s| self.compliance(robot, s).1.amax()).into_iter().fold(0.0, f64::max);
        let of_load = (force * flexibility).sqrt().max(robot.sections[self.section].rest_curvature.norm());
        if robot.tendons.is_empty() { of_load } else { of_load.max(self.tendon_angle(robot)) }
    }

    /// Diagonals of K_se and K_bt at `s`.
    pub(super) fn stiffness(&self, robot: &Robot, s: f64) -> (Vector3<f64>, Vector3<f64>) {
        if let Some(Uniform { stiffness, .. }) = &self.uniform {
            return *stiffness;
        }
        robot.sections[self.section].stiffness(self.fraction(robot, s))
    }

    /// Diagonals of K_se^-1 and K_bt^-1 at `s`.
    fn compliance(&self, robot: &Robot, s: f64) -> (Vector3<f64>, Vector3<f64>) {
        if let Some(uniform) = &self.uniform {
            return (uniform.shear, uniform.bend);
        }
        let (shear, bend) = robot.sections[self.section].stiffness(self.fraction(robot, s));
        (shear.map(f64::recip), bend.map(f64::recip))
    }

    /// Dead force beyond `s`, world frame, theory (10): what is hung farther out, and the weight.
    pub(super) fn dead_force(&self, robot: &Robot, s: f64) -> Vector3<f64> {
        let length = self.to - s;
        let beyond = self.rod_force(robot, s, length);
        if !self.heavy_tendons {
            return beyond;
        }
        let tendons = if let Some((mass, _)) = self.tendon_mass {
            mass * length
        } else {
            let of = |(point, weight): &(f64, f64)| {
                weight * length * self.tendon_mass(robot, s + point * length).0
            };
            GAUSS.iter().map(of).sum()
        };
        beyond + tendons * robot.gravity
    }

    /// First moment of the tendons' mass per length at `s`, body frame.
    pub(super) fn mass_moment(&self, robot: &Robot, s: f64) -> Vector3<f64> {
        if self.heavy_tendons { self.tendon_mass(robot, s).1 } else { Vector3::zeros() }
    }

    /// Mass of the tendons per length of backbone, and its first moment: along their paths at rest.
    fn tendon_mass(&self, robot: &Robot, s: f64) -> (f64, Vector3<f64>) {
        if let Some(everywhere) = self.tendon_mass {
            return everywhere;
        }
        let (mut mass, mut moment) = (0.0, Vector3::zeros());
        for tendon in &robot.tendons {
            let end = robot.tendon_end(tendon);
            if tendon.mass_per_length > 0.0 && 0.5 * (self.from + self.to) < end {
                let (hole, along) = tendon.path.hole(s / end, end);
                let rest_curvature = &robot.sections[self.section].rest_curvature;
                let path = Vector3::z() + rest_curvature.cross(&hole) + along;
                mass += tendon.mass_per_length * path.norm();
                moment += tendon.mass_per_length * path.norm() * hole;
            }
        }
        (mass, moment)
    }

    /// Dead force beyond `s` without the tendons' weight in this span.
    fn rod_force(&self, robot: &Robot, s: f64, length: f64) -> Vector3<f64> {
        if let Some(uniform) = &self.uniform {
            return self.force_beyond + length * (self.force_per_length + uniform.weight);
        }
        let section = &robot.sections[self.section];
        let [near, middle, far] = [s, 0.5 * (s + self.to), self.to]
            .map(|at| section.cross_section(self.fraction(robot, at)).area());
        // Simpson's rule: exact for the quadratic area of a taper
        let volume = length * (near + 4.0 * middle + far) / 6.0;
        self.force_beyond + length * self.force_per_length + section.material.density * volume * robot.gravity
    }

    pub(super) fn fraction(&self, robot: &Robot, s: f64) -> f64 {
        (s - self.section_start) / robot.sections[self.section].length
    }
}

/// Gauss-Legendre points and weights on [0, 1], exact to degree 15: paths of tendons are smooth.
const GAUSS: [(f64, f64); 8] = [
    (0.019855071751231856, 0.05061426814518815),
    (0.10166676129318664, 0.11119051722668725),
    (0.2372337950418355, 0.15685332293894366),
    (0.4082826787521751, 0.181341891689181),
    (0.591717321247825, 0.181341891689181),
    (0.7627662049581645, 0.15685332293894366),
    (0.8983332387068134, 0.11119051722668725),
    (0.9801449282487682, 0.05061426814518815),
];
/// Part of a gap by which the next may be longer or shorter.
const SAME_GAP: f64 = 1e-3;
/// Breakpoints closer than this fraction of the length are one.
const SAME_PLACE: f64 = 1e-12;
