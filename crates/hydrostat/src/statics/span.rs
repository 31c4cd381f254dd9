//! What acts on and along one span of the backbone.

use super::section::Pull;
use crate::Robot;
use crate::model::{Command, Routing, Tendon};
use crate::numeric::dop853::{C, STAGES};
use nalgebra::Vector3;

/// A piece of one section on which all distributed loads are constant.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    /// Index into `Robot::sections`, and where that section begins.
    pub(super) section: usize,
    pub(super) section_start: f64,
    /// Mean of h^2/24 of the gaps between guides, where these are averaged, m^2.
    pub(super) gap: Option<f64>,
    /// What is the same all along; None where the section tapers.
    pub(super) uniform: Option<Uniform>,
    /// Dead force beyond the span's end, world frame.
    pub(super) force_beyond: Vector3<f64>,
    /// Dead force and moment per length besides the weight, world frame.
    pub(super) force_per_length: Vector3<f64>,
    pub(super) moment_per_length: Vector3<f64>,
    /// Following force and moment per length, body frame.
    pub(super) following_force: Vector3<f64>,
    pub(super) following_moment: Vector3<f64>,
    /// Sum of the following forces beyond the span's end, whatever their direction.
    pub(super) following_beyond: f64,
    /// Whether tendons that pass have a weight.
    pub(super) heavy_tendons: bool,
    /// Their mass per length and its first moment where these are the same all along: parallel tendons.
    pub(super) tendon_mass: Option<(f64, Vector3<f64>)>,
    /// Point loads at the span's end that jump in the unknown wrench.
    pub(super) jump: Jump,
}

/// A span without taper: diagonals of K_se and K_bt, of their inverses, and weight per length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Uniform {
    pub(super) stiffness: (Vector3<f64>, Vector3<f64>),
    pub(super) shear: Vector3<f64>,
    pub(super) bend: Vector3<f64>,
    pub(super) weight: Vector3<f64>,
}

/// Point loads at one arc length that the unknown part of the wrench sees.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jump {
    /// Dead moment, world frame.
    pub(super) moment: Vector3<f64>,
    /// First moment of the masses off the axis, sum m r_c, and of spread guides along it, body frame, and gravity, world frame.
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
    pub(super) fn compliance(&self, robot: &Robot, s: f64) -> (Vector3<f64>, Vector3<f64>) {
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
    pub(super) fn tendon_mass(&self, robot: &Robot, s: f64) -> (f64, Vector3<f64>) {
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
