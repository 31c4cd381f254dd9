//! Small loads: bending, shear, twist and stretch against the formulas of the textbook.

use super::reference::torsion_constant;
use super::{Case, Group, dead_load, material, prismatic, read, rod, solve};
use crate::model::CrossSection;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// A thick rod, so that shear shows: m, Pa, m.
const LENGTH: f64 = 0.1;
const YOUNGS_MODULUS: f64 = 3e9;
const POISSON_RATIO: f64 = 0.3;

pub(super) fn cases() -> Vec<Case> {
    let round = CrossSection::Round { diameter: 0.02 };
    let strip = CrossSection::Strip { width: 0.02, height: 0.01 };
    let mut cases = bending(round, 0.9);
    cases.extend(bending(strip, 5.0 / 6.0));
    cases.extend(stretch(round));
    cases.extend([(0.02, 0.02), (0.02, 0.01), (0.002, 0.02)].map(|(width, height)| twist(width, height)));
    cases
}

/// Deflection along d1 and d2 over that of bending alone: 1 + 3 EI/(k G A L^2).
fn bending(section: CrossSection, shear_coefficient: f64) -> Vec<Case> {
    let group = Group {
        title: "Timoshenko cantilever under a small tip force",
        source: "P L^3/3EI + P L/kGA, Timoshenko 1921, Phil. Mag. 41",
        reason: "the formula leaves out (deflection/L)^2, here 1e-6",
    };
    // Deflections of L/1000.
    let (name, area, [i1, i2]) = match section {
        CrossSection::Strip { width, height } => {
            ("strip", width * height, [width * height.powi(3) / 12.0, height * width.powi(3) / 12.0])
        }
        CrossSection::Round { diameter } | CrossSection::Tube { diameter, .. } => {
            ("round", PI * diameter.powi(2) / 4.0, [PI * diameter.powi(4) / 64.0; 2])
        }
    };
    let shear_modulus = YOUNGS_MODULUS / (2.0 * (1.0 + POISSON_RATIO));
    // A force along d1 (world y) bends about d2, one along d2 (world z) about d1.
    [("d1", 1, i2), ("d2", 2, i1)]
        .into_iter()
        .map(|(axis, index, second_moment)| {
            let ei = YOUNGS_MODULUS * second_moment;
            let force = 3e-3 * ei / LENGTH.powi(2);
            let bending = force * LENGTH.powi(3) / (3.0 * ei);
            let shear = force * LENGTH / (shear_coefficient * shear_modulus * area);
            let mut profile = prismatic(section);
            profile.shear_coefficient = shear_coefficient;
            let mut robot = rod(LENGTH, material(YOUNGS_MODULUS, POISSON_RATIO), profile);
            let mut load = Vector3::zeros();
            load[index] = force;
            robot.loads = vec![dead_load(LENGTH, load, Vector3::zeros())];
            group.case(
                format!("{name}, force along {axis}: deflection / (P L^3/3EI)"),
                (bending + shear) / bending,
                read(&solve(&robot), |e| e.tip.position[index] / bending),
                5e-6,
            )
        })
        .collect()
}

fn stretch(section: CrossSection) -> Vec<Case> {
    let group = Group {
        title: "Stretch and twist",
        source: "exact: F/EA; T L/GJ with Saint-Venant's series, Timoshenko & Goodier, art. 109",
        reason: "the solver is asked for 1e-10 L",
    };
    let CrossSection::Round { diameter } = section else {
        return Vec::new();
    };
    let strain = 0.01;
    let force = strain * YOUNGS_MODULUS * PI * diameter.powi(2) / 4.0;
    let mut robot = rod(LENGTH, material(YOUNGS_MODULUS, POISSON_RATIO), prismatic(section));
    robot.loads = vec![dead_load(LENGTH, force * Vector3::x(), Vector3::zeros())];
    vec![group.case(
        "round, pull F/EA = 0.01: extension / L",
        strain,
        read(&solve(&robot), |e| e.tip.position.x / LENGTH - 1.0),
        1e-9,
    )]
}

/// Half a radian of twist; large enough to be read off to 1e-9, small enough to be below the buckling of a twisted strip.
fn twist(width: f64, height: f64) -> Case {
    let group = Group {
        title: "Stretch and twist",
        source: "exact: F/EA; T L/GJ with Saint-Venant's series, Timoshenko & Goodier, art. 109",
        reason: "twist: the tail of the series for the torsion constant, 1e-9 of it",
    };
    let angle = 0.5;
    let strip = CrossSection::Strip { width, height };
    let mut robot = rod(LENGTH, material(YOUNGS_MODULUS, POISSON_RATIO), prismatic(strip));
    let gj = robot.sections[0].material.shear_modulus * torsion_constant(width, height);
    robot.loads = vec![dead_load(LENGTH, Vector3::zeros(), angle * gj / LENGTH * Vector3::x())];
    group.case(
        format!("strip {} x {} mm, T L/GJ = 0.5: twist [rad]", width * 1e3, height * 1e3),
        angle,
        read(&solve(&robot), |e| {
            let d1 = e.tip.rotation * Vector3::x();
            d1.z.atan2(d1.y)
        }),
        1e-9,
    )
}
