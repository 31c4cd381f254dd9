//! Random tendon robots from a seed.

use super::random::{Random, section, softest};
use crate::Robot;
use crate::model::{
    Command, Frame, Guides, Load, LoadKind, Material, Motion, Path, Pose, Routing, Section, Tendon,
};
use nalgebra::{Rotation3, Unit, Vector3};
use std::f64::consts::PI;

/// Total bend of all tendons and loads, were they to act in one plane: at most a full circle.
const BEND: f64 = 2.0 * PI;
/// Curvature times the radius of the holes that all tendons may cause, at most, and that forces may, half of it the weight: at 1 a
/// tendon on the inside has no length left, and the robot folds about it.
const CURL: f64 = 0.5;
const CURL_OF_LOADS: f64 = 0.3;
/// Compression of a backbone between two guides, tau h^2 / E I, at most; it buckles from about 10 on.
const GAP_LOAD: f64 = 4.0;
/// Guides are set closer than evenly by at most this part of their spacing.
const UNEVEN: f64 = 0.3;
/// Radius of holes in guides, at least, as a fraction of the length.
const NARROWEST: f64 = 0.01;
pub(super) const MOST_TENDONS: usize = 12;

/// The tendon robot of this index; each has its own stream, so that one can be repeated alone.
pub fn tendon_robot(seed: u64, index: usize) -> Robot {
    let mut random = Random::new(!seed, index);
    let length = random.log_uniform(0.05, 2.0);
    let thickness = length / random.log_uniform(15.0, 500.0);
    let youngs_modulus = random.log_uniform(1e6, 2e11);
    let material = Material {
        name: "random".into(),
        youngs_modulus,
        shear_modulus: youngs_modulus / (2.0 * (1.0 + random.uniform(0.0, 0.49))),
        density: 0.0,
        strain_limit: None,
    };
    let weights: Vec<f64> = (0..1 + random.below(4)).map(|_| random.uniform(0.3, 1.0)).collect();
    let total: f64 = weights.iter().sum();
    let mut sections: Vec<Section> = weights
        .iter()
        .map(|weight| section(&mut random, length * weight / total, length, thickness, &material))
        .collect();
    if random.chance(0.6) {
        // most robots are straight at rest
        sections.iter_mut().for_each(|section| section.rest_curvature = Vector3::zeros());
    }
    let base = Pose {
        position: length * random.direction(),
        rotation: Rotation3::from_axis_angle(
            &Unit::new_normalize(random.direction()),
            random.uniform(0.0, PI),
        ),
    };
    let mut robot = Robot {
        name: format!("random tendon robot {index} of seed {seed}"),
        gravity: 9.81 * random.direction(),
        base,
        sections,
        tendons: Vec::new(),
        loads: Vec::new(),
        actuation: Vec::new(),
    };
    let radius = (thickness * random.log_uniform(0.5, 10.0)).min(0.1 * length);
    add_tendons(&mut random, &mut robot, radius);
    let bend = random.uniform(0.0, BEND);
    // curvature at the base 2 bend / L by a force at the tip, 3 bend / L by the weight
    let most_of_loads = CURL_OF_LOADS / 5.0 * length / widest(&robot);
    let of_loads =
        if random.chance(0.7) { (random.uniform(0.0, 0.6) * bend).min(most_of_loads) } else { 0.0 };
    add_guides(&mut random, &mut robot, bend);
    add_weight(&mut random, &mut robot, of_loads);
    add_loads(&mut random, &mut robot, of_loads);
    add_commands(&mut random, &mut robot, bend - of_loads);
    add_friction(&mut random, &mut robot);
    robot
}

/// 1 to 12: in channels, through guides or both; straight, converging, helical.
fn add_tendons(random: &mut Random, robot: &mut Robot, radius: f64) {
    let count = 1 + random.below(MOST_TENDONS as u64) as usize;
    let routings = random.below(3);
    let guided = radius.max(NARROWEST * robot.length());
    let stretches = random.chance(0.4);
    for number in 0..count {
        let routing = match routings {
            0 => Routing::Channel,
            1 => Routing::Guides,
            _ if random.chance(0.5) => Routing::Channel,
            _ => Routing::Guides,
        };
        let widest = if routing == Routing::Guides { guided } else { radius };
        let radius = widest * random.uniform(0.5, 1.0);
        let (converges, winds) = (random.chance(0.33), random.chance(0.33));
        robot.tendons.push(Tendon {
            name: format!("t{number}"),
            ends: random.below(robot.sections.len() as u64) as usize,
            path: Path {
                radius,
                tip_radius: if converges { radius * random.uniform(0.2, 1.0) } else { radius },
                angle: random.uniform(0.0, 2.0 * PI),
                turns: if winds { random.uniform(-1.0, 1.0) } else { 0.0 },
            },
            routing,
            // of a cord between a thousandth and the whole of the backbone's E A
            stiffness: stretches
                .then(|| random.log_uniform(1e-3, 1.0) * robot.sections[0].stiffness(0.0).0.z),
            friction: 0.0,
            breaking_load: None,
            mass_per_length: 0.0,
            home: 0.0,
        });
    }
}

/// At least 3 on every section, and as close as keeps the backbone from buckling between them; some with a mass beside the axis.
fn add_guides(random: &mut Random, robot: &mut Robot, bend: f64) {
    let needed = robot.tendons.iter().any(|tendon| tendon.routing == Routing::Guides) || random.chance(0.1);
    if !needed {
        return;
    }
    let heavy = random.chance(0.4);
    let length = robot.length();
    let unit = softest(robot) / length.powi(2);
    let radius = robot.tendons.iter().map(|tendon| tendon.path.radius).fold(f64::INFINITY, f64::min);
    // tau h^2 / E I at the softest place, with the tension of the one tendon that bends by the whole angle
    let places = places(robot);
    let bend_per_tension = |tendon: &Tendon| {
        let end = robot.tendon_end(tendon);
        let passed = places.iter().filter(|(s, ..)| *s < end);
        passed
            .map(|(s, stiffness, step)| tendon.path.hole(s / end, end).0.norm() / stiffness * step)
            .sum::<f64>()
    };
    let weakest = robot.tendons.iter().map(bend_per_tension).fold(f64::INFINITY, f64::min);
    let closest = (GAP_LOAD * softest(robot) * weakest / bend).sqrt() / (1.0 + UNEVEN);
    for section in &mut robot.sections {
        let count = (3 + random.below(6) as usize).max((section.length / closest).ceil() as usize);
        let spacing = section.length / count as f64;
        let positions = (1..=count)
            .map(|k| (k as f64 - if k < count { random.uniform(0.0, UNEVEN) } else { 0.0 }) * spacing);
        let positions = positions.collect();
        let mass = if heavy { random.uniform(0.0, 1.0) * unit / (9.81 * count as f64) } else { 0.0 };
        let mass_center = [random.uniform(-1.0, 1.0) * radius, random.uniform(-1.0, 1.0) * radius];
        section.guides = Some(Guides { positions, mass, mass_center, radius: None });
    }
}

/// Of backbone and tendons: half of the robots have some.
fn add_weight(random: &mut Random, robot: &mut Robot, bend: f64) {
    if !random.chance(0.5) {
        return;
    }
    let length = robot.length();
    // w L^3 / 6 E I
    let weight = random.uniform(0.0, 1.0) * 6.0 * bend * softest(robot) / length.powi(2);
    let of_tendons = if random.chance(0.4) { random.uniform(0.0, 0.5) } else { 0.0 };
    let area =
        |section: &Section| (section.profile.base.area() + section.profile.tip.area()) / 2.0 * section.length;
    let volume: f64 = robot.sections.iter().map(area).sum();
    for section in &mut robot.sections {
        section.material.density = (1.0 - of_tendons) * weight / (9.81 * volume);
    }
    let tendons: f64 = robot.tendons.iter().map(|tendon| robot.tendon_end(tendon)).sum();
    for tendon in &mut robot.tendons {
        tendon.mass_per_length = of_tendons * weight / (9.81 * tendons);
    }
}

/// Forces that share the bend F L^2 / 2 E I; now and then moments and followers.
fn add_loads(random: &mut Random, robot: &mut Robot, bend: f64) {
    if bend == 0.0 {
        return;
    }
    let length = robot.length();
    let unit = 2.0 * bend * softest(robot) / length.powi(2);
    let frame = if random.chance(0.1) { Frame::Body } else { Frame::World };
    let which = [0.6, 0.3, 0.3, 0.3].map(|probability| random.chance(probability));
    let share = unit / which.iter().filter(|some| **some).count().max(1) as f64;
    let mut force = |share: f64| random.uniform(0.0, share) * random.direction();
    let forces = [force(share), force(share), force(share)];
    let mut kinds = Vec::new();
    if which[0] {
        let moment = if random.chance(0.1) {
            random.uniform(0.0, 0.5) * share * length * random.direction()
        } else {
            Vector3::zeros()
        };
        kinds.push(LoadKind::Point { at: length, force: forces[0], moment, frame });
    }
    if which[1] {
        let at = random.uniform(0.1, 1.0) * length;
        kinds.push(LoadKind::Point { at, force: forces[1], moment: Vector3::zeros(), frame: Frame::World });
    }
    if which[2] {
        let at = if random.chance(0.7) { length } else { random.uniform(0.1, 1.0) * length };
        kinds.push(LoadKind::Mass { at, mass: random.uniform(0.0, share) / 9.81 });
    }
    if which[3] {
        let (from, to) = (random.uniform(0.0, 0.5) * length, random.uniform(0.6, 1.0) * length);
        let moment_per_length = if random.chance(0.1) {
            random.uniform(0.0, 0.5) * share * random.direction()
        } else {
            Vector3::zeros()
        };
        let force_per_length = forces[2] / (to - from);
        kinds.push(LoadKind::Distributed { from, to, force_per_length, moment_per_length, frame });
    }
    robot.loads = kinds.into_iter().map(|kind| Load { name: None, kind }).collect();
}

/// By tension, by displacement or mixed.
fn add_commands(random: &mut Random, robot: &mut Robot, bend: f64) {
    let by = random.below(3);
    let held: Vec<bool> = robot.tendons.iter().map(|_| by == 1 || by == 2 && random.chance(0.5)).collect();
    // what tensions and displacements bend adds up
    let curl = if by == 2 { 0.5 * CURL } else { CURL };
    let tensions = tensions(random, robot, bend, curl);
    let displacements = displacements(random, robot, bend, curl);
    robot.actuation = (0..robot.tendons.len())
        .map(|i| match held[i] {
            true => Command::Displacement { displacement: displacements[i], motion: Motion::Pulled },
            false => Command::Tension { tension: tensions[i], motion: Motion::Pulled },
        })
        .collect();
}

/// Largest radius of a hole.
fn widest(robot: &Robot) -> f64 {
    robot.tendons.iter().map(|tendon| tendon.path.radius).fold(0.0, f64::max)
}

/// Places per section at which stiffness and holes are looked at.
const PLACES: usize = 8;

/// Arc length, softest E I there and the length that it stands for, base to tip.
fn places(robot: &Robot) -> Vec<(f64, f64, f64)> {
    let mut places = Vec::new();
    let mut start = 0.0;
    for section in &robot.sections {
        let step = section.length / PLACES as f64;
        for k in 0..PLACES {
            let fraction = (k as f64 + 0.5) / PLACES as f64;
            let bend = section.stiffness(fraction).1;
            places.push((start + fraction * section.length, bend.x.min(bend.y), step));
        }
        start += section.length;
    }
    places
}

/// Tensions that would bend by the given angle if all pulled to one side; a quarter of the tendons hang loose.
fn tensions(random: &mut Random, robot: &Robot, bend: f64, curl: f64) -> Vec<f64> {
    let weight = |random: &mut Random| if random.chance(0.25) { 0.0 } else { random.uniform(0.0, 1.0) };
    let shares: Vec<f64> = robot.tendons.iter().map(|_| weight(random)).collect();
    let (mut whole, mut sharpest) = (0.0, 0.0_f64);
    for (s, stiffness, step) in places(robot) {
        let mut curvature = 0.0;
        let mut widest = 0.0_f64;
        for (tendon, share) in robot.tendons.iter().zip(&shares) {
            let end = robot.tendon_end(tendon);
            if s < end {
                let radius = tendon.path.hole(s / end, end).0.norm();
                curvature += share * radius / stiffness;
                widest = widest.max(radius);
            }
        }
        whole += curvature * step;
        sharpest = sharpest.max(curvature * widest);
    }
    let scale = (bend / whole).min(curl / sharpest);
    shares.iter().map(|share| if scale.is_finite() { scale * share } else { 0.0 }).collect()
}

/// What the tendons are shorter by when every section bends into an arc, the angles adding up to the given; each a little off.
fn displacements(random: &mut Random, robot: &Robot, bend: f64, curl: f64) -> Vec<f64> {
    let length = robot.length();
    let shares: Vec<f64> = robot.sections.iter().map(|_| random.uniform(0.0, 1.0)).collect();
    let total: f64 = shares.iter().sum();
    // a length tells the whole angle, and the softest place bends most
    let places = places(robot);
    let softness: f64 = places.iter().map(|(_, stiffness, step)| step / (stiffness * length)).sum();
    let evenness = places.iter().map(|(_, stiffness, _)| *stiffness).fold(f64::INFINITY, f64::min) * softness;
    let mut arcs: Vec<Vector3<f64>> = Vec::new();
    for (section, share) in robot.sections.iter().zip(&shares) {
        let angle = random.uniform(0.0, 2.0 * PI);
        let curvature = (bend * share / (total * section.length)).min(curl * evenness / widest(robot));
        arcs.push(curvature * Vector3::new(angle.cos(), angle.sin(), 0.0));
    }
    let tight = if random.chance(0.3) { random.uniform(0.0, 1e-3) * length } else { 0.0 };
    let mut displacements = Vec::new();
    for tendon in &robot.tendons {
        let end = robot.tendon_end(tendon);
        let mut shortening = 0.0;
        for (k, (s, _, step)) in places.iter().enumerate().filter(|(_, (s, ..))| *s < end) {
            let hole = tendon.path.hole(s / end, end).0;
            shortening -= step * arcs[k / PLACES].cross(&hole).z;
        }
        let off = random.uniform(-0.05, 0.05) * shortening;
        let paid_out = if random.chance(0.15) { random.uniform(0.0, 0.02) * length } else { 0.0 };
        displacements.push(shortening + off + tight - paid_out);
    }
    displacements
}

/// One robot in twenty, where the loads have an energy; released now and then.
fn add_friction(random: &mut Random, robot: &mut Robot) {
    let has_energy = |load: &Load| match load.kind {
        LoadKind::Point { moment, frame, .. } => moment == Vector3::zeros() && frame == Frame::World,
        LoadKind::Distributed { moment_per_length, frame, .. } => {
            moment_per_length == Vector3::zeros() && frame == Frame::World
        }
        LoadKind::Mass { .. } => true,
    };
    if !random.chance(0.05) || !robot.loads.iter().all(has_energy) {
        return;
    }
    for (tendon, command) in robot.tendons.iter_mut().zip(&mut robot.actuation) {
        tendon.friction = random.uniform(0.0, 0.3);
        // a tendon under friction is held without stretch
        tendon.stiffness = None;
        let (Command::Tension { motion, .. } | Command::Displacement { motion, .. }) = command;
        if random.chance(0.3) {
            *motion = Motion::Released;
        }
    }
}
