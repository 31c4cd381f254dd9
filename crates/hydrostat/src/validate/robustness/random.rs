//! Random rods from a seed.

use crate::Robot;
use crate::model::{CrossSection, Frame, Load, LoadKind, Material, Pose, Profile, Section};
pub(super) use crate::numeric::random::Random;
use nalgebra::{Rotation3, Unit, Vector3};
use std::f64::consts::PI;

/// Bounds of the sweep, in units of the softest E I: F L^2/EI, M L/EI, w L^3/EI, |u*| L.
const FORCE: f64 = 10.0;
const MOMENT: f64 = 3.0;
const WEIGHT: f64 = 20.0;
const REST_ANGLE: f64 = 3.0;

/// The rod of this index; each has its own stream, so that one can be repeated alone.
pub fn robot(seed: u64, index: usize) -> Robot {
    let mut random = Random::new(seed, index);
    let length = random.log_uniform(0.05, 2.0);
    let thickness = length / random.log_uniform(10.0, 1000.0);
    let youngs_modulus = random.log_uniform(1e6, 2e11);
    let material = Material {
        name: "random".into(),
        youngs_modulus,
        shear_modulus: youngs_modulus / (2.0 * (1.0 + random.uniform(0.0, 0.49))),
        density: 0.0,
        strain_limit: None,
    };
    let weights: Vec<f64> = (0..1 + random.below(3)).map(|_| random.uniform(0.3, 1.0)).collect();
    let total: f64 = weights.iter().sum();
    let sections: Vec<Section> = weights
        .iter()
        .map(|weight| section(&mut random, length * weight / total, length, thickness, &material))
        .collect();
    let gravity = 9.81 * random.direction();
    let base = Pose {
        position: length * random.direction(),
        rotation: Rotation3::from_axis_angle(
            &Unit::new_normalize(random.direction()),
            random.uniform(0.0, PI),
        ),
    };
    let mut robot = Robot {
        tendons: Vec::new(),
        actuation: Vec::new(),
        name: format!("random rod {index} of seed {seed}"),
        gravity,
        base,
        sections,
        loads: Vec::new(),
    };
    add_weight(&mut random, &mut robot);
    robot.loads = loads(&mut random, &robot);
    robot
}

/// Round, tube or strip; a third of them tapered to between a half and the whole; half of them bent at rest.
pub(super) fn section(
    random: &mut Random,
    length: f64,
    total: f64,
    thickness: f64,
    material: &Material,
) -> Section {
    let d = thickness * random.uniform(0.7, 1.0);
    let taper = if random.chance(0.33) { random.uniform(0.5, 1.0) } else { 1.0 };
    let ratio = random.uniform(0.3, 0.9);
    let kind = random.below(4);
    let cross_section = |scale: f64| match kind {
        0 => CrossSection::Tube { diameter: scale * d, inner_diameter: scale * ratio * d },
        1 => CrossSection::Strip { width: scale * d, height: scale * ratio * d },
        _ => CrossSection::Round { diameter: scale * d },
    };
    let rest_curvature = if random.chance(0.5) {
        random.uniform(0.0, REST_ANGLE) / total * random.direction()
    } else {
        Vector3::zeros()
    };
    Section {
        name: "random".into(),
        length,
        material: material.clone(),
        profile: Profile {
            base: cross_section(1.0),
            tip: cross_section(taper),
            shear_coefficient: random.uniform(0.8, 1.0),
        },
        rest_curvature,
        guides: None,
    }
}

/// Softest E I anywhere: the loads are in its units.
pub(super) fn softest(robot: &Robot) -> f64 {
    let ends = robot.sections.iter().flat_map(|section| [0.0, 1.0].map(|end| section.stiffness(end).1));
    ends.map(|stiffness| stiffness.x.min(stiffness.y)).fold(f64::INFINITY, f64::min)
}

/// Two rods in three have weight, up to the bound on average over the length.
fn add_weight(random: &mut Random, robot: &mut Robot) {
    if !random.chance(0.67) {
        return;
    }
    let weight = random.uniform(0.0, WEIGHT) * softest(robot) / robot.length().powi(2);
    let area =
        |section: &Section| (section.profile.base.area() + section.profile.tip.area()) / 2.0 * section.length;
    let volume: f64 = robot.sections.iter().map(area).sum();
    for section in &mut robot.sections {
        section.material.density = weight / (9.81 * volume);
    }
}

/// A tip force, and now and then a moment, a force in between, a hung mass, a distributed force. The forces share the bound.
fn loads(random: &mut Random, robot: &Robot) -> Vec<Load> {
    let length = robot.length();
    let unit = softest(robot) / length.powi(2);
    let force =
        |random: &mut Random, share: f64| random.uniform(0.0, share * FORCE) * unit * random.direction();
    let frame = |random: &mut Random| {
        if random.chance(0.15) { Frame::Body } else { Frame::World }
    };
    let moment = if random.chance(0.3) {
        random.uniform(0.0, MOMENT) * unit * length * random.direction()
    } else {
        Vector3::zeros()
    };
    let others = [random.chance(0.3), random.chance(0.2), random.chance(0.2)];
    let share = 1.0 / (1.0 + others.iter().filter(|other| **other).count() as f64);
    let mut kinds =
        vec![LoadKind::Point { at: length, force: force(random, share), moment, frame: frame(random) }];
    if others[0] {
        kinds.push(LoadKind::Point {
            at: random.uniform(0.2, 0.95) * length,
            force: force(random, share),
            moment: Vector3::zeros(),
            frame: frame(random),
        });
    }
    if others[1] {
        kinds.push(LoadKind::Mass {
            at: random.uniform(0.2, 1.0) * length,
            mass: random.uniform(0.0, share * FORCE) * unit / 9.81,
        });
    }
    if others[2] {
        let (from, to) = (random.uniform(0.0, 0.5) * length, random.uniform(0.6, 1.0) * length);
        kinds.push(LoadKind::Distributed {
            from,
            to,
            force_per_length: force(random, share) / (to - from),
            moment_per_length: Vector3::zeros(),
            frame: frame(random),
        });
    }
    kinds.into_iter().map(|kind| Load { name: None, kind }).collect()
}
