//! The constant-curvature model, for comparison: each section an arc of constant (u1, u2, u3), as most of the field
//! assumes (the thesis's chapter 2.2), in the best balance with the loads that such a shape allows.
//!
//! Neither shear nor stretch. The principle of virtual work over constant variations of u gives, per section,
//! theory (20),
//!
//! ```text
//! integral over the section of ( K_bt (u - u*) - R^T m ) ds = 0
//! ```
//! with m the moment of the loads on the deformed shape: equation (G 15) on average instead of at every s.

use super::chain::Chain;
use super::rod::{END, MIDDLE, START};
use crate::Error;
use crate::geometry::hat;
use crate::model::{Pose, Robot};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

/// Whether the weight of backbone and guides acts; that of hung masses always does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    Included,
    Ignored,
}

/// A shape of constant curvature in each section.
#[derive(Clone, Debug, PartialEq)]
pub struct Arcs {
    /// u of each section, body frame, 1/m.
    pub curvature: Vec<Vector3<f64>>,
    base: Pose,
    /// Where each section ends.
    ends: Vec<f64>,
}

/// Panels of Simpson's rule on each span.
const PANELS: usize = 32;
/// Relative size of the last Newton correction.
const CONVERGED: f64 = 1e-10;
const MAX_ITERATIONS: usize = 30;
const SMALLEST_LOAD_STEP: f64 = 1.0 / 1024.0;

/// The constant-curvature model's answer for a robot.
///
/// # Errors
/// Where no balanced arcs are found on the way from the unloaded shape.
pub fn constant_curvature(robot: &Robot, weight: Weight) -> Result<Arcs, Error> {
    let mut robot = robot.clone();
    if weight == Weight::Ignored {
        for section in &mut robot.sections {
            section.material.density = 0.0;
            section.guides = None;
        }
    }
    let mut chain = Chain::default();
    chain.rebuild(&robot);
    let arcs = Arcs {
        curvature: robot.sections.iter().map(|section| section.rest_curvature).collect(),
        base: robot.base,
        ends: robot
            .sections
            .iter()
            .scan(0.0, |end, section| {
                *end += section.length;
                Some(*end)
            })
            .collect(),
    };
    follow_load(&robot, &chain, arcs)
}

impl Arcs {
    /// The pose at arc length `s`, world frame.
    pub fn pose(&self, s: f64) -> Pose {
        let mut pose = self.base;
        let mut start = 0.0;
        for (u, &end) in self.curvature.iter().zip(&self.ends) {
            pose = along_arc(&pose, u, s.min(end) - start);
            start = end;
            if s <= end {
                break;
            }
        }
        pose
    }

    /// `count` poses evenly spaced in s, both ends included.
    pub fn poses(&self, count: usize) -> Vec<Pose> {
        let length = self.ends.last().copied().unwrap_or(0.0);
        (0..count).map(|i| self.pose(length * i as f64 / (count.max(2) - 1) as f64)).collect()
    }
}

/// The pose a length `h` farther on an arc of constant u.
fn along_arc(pose: &Pose, u: &Vector3<f64>, h: f64) -> Pose {
    let theta = h * u;
    let angle = theta.norm();
    // (1 - cos a) / a^2 and (a - sin a) / a^3, by series where the formulas lose digits
    let (b, c) = if angle < 1e-3 {
        (0.5 - angle.powi(2) / 24.0, 1.0 / 6.0 - angle.powi(2) / 120.0)
    } else {
        ((1.0 - angle.cos()) / angle.powi(2), (angle - angle.sin()) / angle.powi(3))
    };
    let k = hat(&theta);
    let chord = (Matrix3::identity() + b * k + c * k * k) * (h * Vector3::z());
    Pose { position: pose.position + pose.rotation * chord, rotation: pose.rotation * Rotation3::new(theta) }
}

/// Lets all loads grow from zero together.
fn follow_load(robot: &Robot, chain: &Chain, mut arcs: Arcs) -> Result<Arcs, Error> {
    let (mut reached, mut step) = (0.0, 0.25_f64);
    while reached < 1.0 {
        let factor = (reached + step).min(1.0);
        if let Some(next) = newton(robot, chain, factor, &arcs) {
            (arcs, reached, step) = (next, factor, 2.0 * step);
        } else {
            step *= 0.5;
            if step < SMALLEST_LOAD_STEP {
                return Err(Error::new(format!(
                    "the constant-curvature model finds no balance beyond {:.1} % of the loads",
                    100.0 * reached
                )));
            }
        }
    }
    Ok(arcs)
}

/// Newton's method from the given arcs. The Jacobian is a difference quotient: it only steers.
fn newton(robot: &Robot, chain: &Chain, factor: f64, start: &Arcs) -> Option<Arcs> {
    let mut arcs = start.clone();
    let n = 3 * arcs.curvature.len();
    let mut last = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        let residual = imbalance(robot, chain, factor, &arcs);
        let difference = 1e-7 / chain.length;
        let mut jacobian = DMatrix::zeros(n, n);
        for j in 0..n {
            let mut moved = arcs.clone();
            moved.curvature[j / 3][j % 3] += difference;
            jacobian.set_column(j, &((imbalance(robot, chain, factor, &moved) - &residual) / difference));
        }
        let correction = jacobian.lu().solve(&residual)?;
        for (j, correction) in correction.iter().enumerate() {
            arcs.curvature[j / 3][j % 3] -= correction;
        }
        let size = correction.amax() * chain.length;
        if !size.is_finite() || size > last.max(1.0) {
            return None;
        }
        if size < CONVERGED {
            return Some(arcs);
        }
        last = size;
    }
    None
}

/// The left-hand side of the balance of every section, N m^2.
fn imbalance(robot: &Robot, chain: &Chain, factor: f64, arcs: &Arcs) -> DVector<f64> {
    let mut sums = DVector::zeros(3 * arcs.curvature.len());
    let (mut moment, mut following) = (Vector3::zeros(), Vector3::zeros());
    for span in chain.spans.iter().rev() {
        // the loads at the span's far end
        let tip = arcs.pose(span.to).rotation;
        moment += factor * (span.jump.moment + tip * span.jump.following_moment);
        following += factor * (tip * span.jump.following_force);
        let h = (span.to - span.from) / PANELS as f64;
        for panel in (0..PANELS).rev() {
            let step = span.step(robot, &[], span.from + panel as f64 * h, h);
            let [far, middle, near] = [(END, 1.0), (MIDDLE, 0.5), (START, 0.0)]
                .map(|(c, along)| (c, arcs.pose(step.from + along * h)));
            // -m' = p' x n + l, from the far end to the middle and to the near end
            let follow = |fraction: f64| {
                following + fraction * h * factor * (middle.1.rotation * step.following_force)
            };
            let rate = |(c, pose): &(usize, Pose), following: Vector3<f64>| {
                let force = factor * step.stages[*c].force + following;
                (pose.rotation * Vector3::z()).cross(&force)
                    + factor * (step.moment_per_length + pose.rotation * step.following_moment)
            };
            let rates = [rate(&far, following), rate(&middle, follow(0.5)), rate(&near, follow(1.0))];
            let halfway = moment + h / 24.0 * (5.0 * rates[0] + 8.0 * rates[1] - rates[2]);
            let through = moment + h / 6.0 * (rates[0] + 4.0 * rates[1] + rates[2]);
            let u = arcs.curvature[span.section] - step.rest_curvature;
            let balance = |(c, pose): &(usize, Pose), moment: &Vector3<f64>| {
                u.component_div(&step.stages[*c].bend) - pose.rotation.inverse() * moment
            };
            let mean = h / 6.0
                * (balance(&far, &moment) + 4.0 * balance(&middle, &halfway) + balance(&near, &through));
            let mut sum = sums.fixed_rows_mut::<3>(3 * span.section);
            sum += mean;
            moment = through;
            following = follow(1.0);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::builtin;
    use crate::model::{Frame, Load, LoadKind};
    use crate::statics::Settings;

    #[test]
    fn an_end_moment_bends_to_the_exact_arc() -> Result<(), Error> {
        let mut robot = builtin::robot()?.value;
        robot.gravity = Vector3::zeros();
        let moment = robot.base.rotation * Vector3::new(0.05, 0.02, 0.0);
        let at = robot.length();
        let kind = LoadKind::Point { at, force: Vector3::zeros(), moment, frame: Frame::World };
        robot.loads = vec![Load { name: None, kind }];
        let arcs = constant_curvature(&robot, Weight::Included)?;
        let exact = crate::statics::solve(&robot, &Settings::default())?;
        assert!((arcs.pose(at).position - exact.tip.position).norm() < 1e-8);
        Ok(())
    }
}
