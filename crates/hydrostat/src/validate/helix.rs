//! A straight rod held as an exact helix by a wrench at its tip.

use super::{Case, Group, dead_load, material, prismatic, read, rod, solve};
use crate::model::CrossSection;
use nalgebra::{Rotation3, Unit, Vector3};
use std::f64::consts::PI;

/// A helix turns by Omega per arc length about the axis a, its cross-section at a pitch angle alpha:
///
/// ```text
/// d1 = e_r,  d3 = cos(alpha) e_phi + sin(alpha) a,  u = Omega R^T a,  n = F a,  m = M a + rho F e_phi
/// ```
///
/// The section law along d2 and d3 gives M = Omega (EI cos^2 + GJ sin^2) and rho F = Omega (GJ - EI) sin cos; with
/// p' = rho Omega e_phi + h a the law for v gives the radius rho and the advance h. Exact with stretch and shear.
pub(super) fn cases() -> Vec<Case> {
    let group = Group {
        title: "Helix under a tip wrench",
        source: "exact: constant strains, Love 1927, art. 270-271, extended to stretch and shear",
        reason: "the solver is asked for 1e-10 L",
    };
    [(0.5, 30.0), (0.75, 30.0), (0.75, 60.0)]
        .into_iter()
        .flat_map(|(turns, pitch_angle)| helix(group, turns, pitch_angle))
        .collect()
}

fn helix(group: Group, turns: f64, pitch_angle: f64) -> [Case; 4] {
    // Unit length and unit EI, L/d = 20.
    let diameter: f64 = 0.05;
    let poisson_ratio = 0.3;
    let (ei, gj, ea) = (1.0, 1.0 / (1.0 + poisson_ratio), 16.0 / diameter.powi(2));
    let ga = ea / (2.0 * (1.0 + poisson_ratio));

    let omega = 2.0 * PI * turns;
    let (sine, cosine) = f64::to_radians(pitch_angle).sin_cos();
    // rho^2 Omega - rho cos = Omega (GJ - EI) sin^2 cos^2 (1/EA - 1/GA)
    let right = omega * (gj - ei) * (sine * cosine).powi(2) * (1.0 / ea - 1.0 / ga);
    let radius = (cosine + (cosine * cosine + 4.0 * omega * right).sqrt()) / (2.0 * omega);
    let force = omega * (gj - ei) * sine * cosine / radius;
    let moment = omega * (ei * cosine * cosine + gj * sine * sine);
    let advance = force * cosine * cosine / ga + (1.0 + force * sine / ea) * sine;

    // In an oblique world, so that no axis is special.
    let youngs_modulus = 64.0 / (PI * diameter.powi(4));
    let section = CrossSection::Round { diameter };
    let mut robot = rod(1.0, material(youngs_modulus, poisson_ratio), prismatic(section));
    robot.base.rotation = Rotation3::from_euler_angles(0.3, -0.8, 1.1);
    let axis = robot.base.rotation * Vector3::new(0.0, -cosine, sine);
    let radial = robot.base.rotation * Vector3::x();
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(axis), omega);
    let tip = radius * (turn * radial - radial) + advance * axis;
    let rotation = turn * robot.base.rotation;
    let tip_moment = moment * axis + radius * force * axis.cross(&(turn * radial));
    robot.loads = vec![dead_load(1.0, force * axis, tip_moment)];

    let solved = solve(&robot);
    let name = format!("{turns} turns, pitch angle {pitch_angle} deg");
    let position = |axis: usize| {
        let label = ["x", "y", "z"][axis];
        let ours = read(&solved, |e| e.tip.position[axis]);
        group.case(format!("{name}, tip {label} / L"), tip[axis], ours, 1e-9)
    };
    let angle = group.case(
        format!("{name}, angle from the exact tip [rad]"),
        0.0,
        // |R - S| = 2 sqrt(2) sin(angle / 2)
        read(&solved, |e| 2.0 * ((e.tip.rotation.matrix() - rotation.matrix()).norm() / 8_f64.sqrt()).asin()),
        1e-9,
    );
    [position(0), position(1), position(2), angle]
}
