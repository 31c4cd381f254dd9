//! Critical loads, found by bisection on the sign of the second variation.

use super::reference::{bisect, buckling_mode, torsion_constant};
use super::{Case, Group, dead_load, material, prismatic, rod, solve};
use crate::Robot;
use crate::model::CrossSection;
use nalgebra::Vector3;
use std::f64::consts::PI;

const GROUP: Group = Group {
    title: "Critical loads",
    source: "Euler: pi^2/4 EI/L^2 with stretch and shear, Reissner 1972, ZAMP 23; self-buckling: Greenhill 1881; lateral: \
             Prandtl 1899, Michell 1899, Timoshenko & Gere 1961; constants from the zeros of power series",
    reason: "",
};

pub(super) fn cases() -> Vec<Case> {
    vec![euler(1e-3), euler(0.1), greenhill(), lateral()]
}

/// The load between 0.9 and 1.1 of a reference at which the primary branch loses its stability.
fn critical(reference: f64, robot: impl Fn(f64) -> Robot) -> Result<f64, String> {
    let stable = |load: f64| -> Result<bool, String> {
        let solved = solve(&robot(load))?;
        solved
            .report
            .stable
            .ok_or_else(|| "the solver does not say whether the equilibrium is stable".to_string())
    };
    let (mut low, mut high) = (0.9 * reference, 1.1 * reference);
    if !stable(low)? {
        return Err(format!("unstable at {low}"));
    }
    if stable(high)? {
        return Err(format!("stable at {high}"));
    }
    while high - low > 1e-8 * reference {
        let middle = 0.5 * (low + high);
        // At the critical load itself the equations are singular and the solver may refuse.
        if stable(middle).unwrap_or(false) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}

/// A round rod of unit length and unit E I along x.
fn column(diameter: f64) -> Robot {
    let youngs_modulus = 64.0 / (PI * diameter.powi(4));
    rod(1.0, material(youngs_modulus, 0.3), prismatic(CrossSection::Round { diameter }))
}

/// Clamped column under a dead end thrust: P (1 - P/EA) + P^2/GA = pi^2 EI/4L^2.
fn euler(diameter: f64) -> Case {
    let group = Group {
        reason: "Euler: bisection to 1e-8 on an eigenvalue whose mesh error is at most 1e-6",
        ..GROUP
    };
    let (ea, ga) = (16.0 / diameter.powi(2), 16.0 / diameter.powi(2) / 2.6);
    let reference = bisect(1.0, 3.0, |p| p * (1.0 - p / ea) + p * p / ga - PI * PI / 4.0);
    let ours = critical(reference, |thrust| {
        let mut robot = column(diameter);
        robot.loads = vec![dead_load(1.0, -thrust * Vector3::x(), Vector3::zeros())];
        robot
    });
    group.case(format!("Euler column, L/d = {}, P L^2/EI", 1.0 / diameter), reference, ours, 1e-6 * reference)
}

/// Clamped upright column under its own weight: phi'' + (w L^3/EI) t phi = 0 from the tip.
fn greenhill() -> Case {
    let group = Group {
        reason: "Greenhill: stretch and shear, w/EA and w/GA, are left out: 2e-6 at L/d = 1000",
        ..GROUP
    };
    let reference = bisect(1.0, 12.0, |beta| buckling_mode(beta, 1));
    let diameter: f64 = 1e-3;
    let ours = critical(reference, |weight| {
        let mut robot = column(diameter);
        robot.gravity = -Vector3::x();
        robot.sections[0].material.density = weight / (0.25 * PI * diameter.powi(2));
        robot
    });
    group.case("self-buckling, L/d = 1000, w L^3/EI", reference, ours, 5e-6 * reference)
}

/// Narrow strip under a tip force in its plane: phi'' + (P^2 L^4/(EI GJ)) t^2 phi = 0 from the tip.
fn lateral() -> Case {
    let group = Group {
        reason: "lateral buckling: the bending before buckling is left out, a relative (EI_soft + GJ)/2EI_stiff = 1.4e-4 \
                 for a strip 1 : 100",
        ..GROUP
    };
    let reference = bisect(1.0, 30.0, |lambda| buckling_mode(lambda, 2)).sqrt();
    let (width, height) = (0.02, 2e-4);
    let robot = rod(1.0, material(1.0, 0.3), prismatic(CrossSection::Strip { width, height }));
    let soft = width * height.powi(3) / 12.0;
    let scale = (soft * robot.sections[0].material.shear_modulus * torsion_constant(width, height)).sqrt();
    let ours = critical(reference * scale, |force| {
        let mut loaded = robot.clone();
        loaded.loads = vec![dead_load(1.0, force * Vector3::y(), Vector3::zeros())];
        loaded
    });
    group.case(
        "lateral buckling of a strip, P L^2/sqrt(EI GJ)",
        reference,
        ours.map(|force| force / scale),
        3e-4 * reference,
    )
}
