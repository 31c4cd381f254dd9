//! Robots with shapes integrated by hand, for pictures and tests; no solver is involved.
#![allow(dead_code, clippy::unwrap_used)]

use hydrostat::model::{CrossSection, Frame, Guides, Load, LoadKind, Material, Pose, Profile, Section};
use hydrostat::solution::{Check, Method, Report, Station};
use hydrostat::verify::{
    Experiment, Input, Point, PointError, Published, Row, Summary, Varied, Verification, VerifiedRow,
};
use hydrostat::{Equilibrium, Robot};
use nalgebra::{Matrix3, Rotation3, Vector3};

pub fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

pub fn nitinol() -> Material {
    Material {
        name: "niti54".into(),
        youngs_modulus: 54e9,
        shear_modulus: 20.3e9,
        density: 6450.0,
        strain_limit: Some(0.01),
    }
}

pub fn section(name: &str, length: f64, diameter: f64) -> Section {
    let round = CrossSection::Round { diameter };
    Section {
        name: name.into(),
        length,
        material: nitinol(),
        profile: Profile {
            base: round,
            tip: round,
            shear_coefficient: 1.0,
        },
        rest_curvature: Vector3::zeros(),
        guides: None,
    }
}

pub fn guides(spacing: f64, length: f64) -> Option<Guides> {
    let count = (length / spacing + 1e-9) as usize;
    Some(Guides {
        positions: (1..=count).map(|i| i as f64 * spacing).collect(),
        mass: 0.9e-3,
    })
}

pub fn robot(name: &str, base: Pose, sections: Vec<Section>, loads: Vec<LoadKind>) -> Robot {
    let loads = loads.into_iter().map(|kind| Load { name: None, kind }).collect();
    Robot {
        name: name.into(),
        gravity: v(0.0, 0.0, -9.81),
        base,
        sections,
        loads,
    }
}

pub fn upward() -> Pose {
    Pose {
        position: Vector3::zeros(),
        rotation: Rotation3::identity(),
    }
}

/// A base with the given world directions of the tangent and, about, of d1.
pub fn base(tangent: Vector3<f64>, normal: Vector3<f64>) -> Pose {
    let d3 = tangent.normalize();
    let d2 = d3.cross(&normal).normalize();
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[d2.cross(&d3), d2, d3]));
    Pose {
        position: Vector3::zeros(),
        rotation,
    }
}

/// The shape with bending and twist u(s), body frame.
pub fn integrate(robot: &Robot, u: impl Fn(f64) -> Vector3<f64>) -> Equilibrium {
    let (n, fine) = (100, 20);
    let h = robot.length() / f64::from(n * fine);
    let (mut p, mut r) = (robot.base.position, robot.base.rotation);
    let mut stations = Vec::new();
    for i in 0..=n * fine {
        let s = f64::from(i) * h;
        if i % fine == 0 {
            stations.push(Station {
                s,
                position: p,
                rotation: *r.matrix(),
                v: Vector3::z(),
                u: u(s),
                force: Vector3::zeros(),
                moment: Vector3::zeros(),
            });
        }
        let middle = r * Rotation3::new(u(s + h / 2.0) * (h / 2.0));
        p += middle * Vector3::z() * h;
        r *= Rotation3::new(u(s + h / 2.0) * h);
    }
    let last = stations.last().unwrap();
    Equilibrium {
        tip: Pose {
            position: last.position,
            rotation: Rotation3::from_matrix_unchecked(last.rotation),
        },
        stations,
        checks: vec![Check {
            name: "strain",
            value: 0.004,
            limit: 0.01,
            ok: true,
            at: Some(0.0),
        }],
        report: Report {
            method: Method::Shooting,
            iterations: 4,
            residual: 1e-13,
            error_estimate: 1e-10,
            stable: Some(true),
            smallest_eigenvalue: Some(0.4),
        },
    }
}

pub fn point(at: f64, force: Vector3<f64>, moment: Vector3<f64>) -> LoadKind {
    LoadKind::Point {
        at,
        force,
        moment,
        frame: Frame::World,
    }
}

pub fn hung(at: f64, mass: f64) -> LoadKind {
    LoadKind::Mass { at, mass }
}

/// Every picture of the gallery: name, robot, shape.
pub fn gallery() -> Vec<(&'static str, Robot, Equilibrium)> {
    let horizontal = || base(v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0));
    let mut all = Vec::new();
    let mut add = |name, robot: Robot, u: &dyn Fn(f64) -> Vector3<f64>| {
        let shape = integrate(&robot, u);
        all.push((name, robot, shape));
    };

    let mut planar = robot(
        "Gray's rod, 20 g",
        horizontal(),
        vec![section("rod", 0.39, 1.56e-3)],
        vec![hung(0.39, 0.02)],
    );
    planar.gravity = v(0.0, -9.81, 0.0);
    planar.base = base(v(1.0, 0.0, 0.0), v(0.0, 0.0, 1.0));
    add("planar", planar, &|s| Vector3::x() * (5.2 * (1.0 - s / 0.39)));

    let mut proximal = section("proximal", 0.2, 1.56e-3);
    proximal.guides = guides(0.01, 0.2);
    let mut distal = section("distal", 0.15, 1.2e-3);
    distal.guides = guides(0.01, 0.15);
    let sections = vec![proximal, distal];
    let loads = vec![
        point(0.35, v(0.1, -0.2, 0.05), v(0.0, 0.02, 0.0)),
        hung(0.2, 0.02),
        hung(0.35, 0.05),
    ];
    add(
        "helix",
        robot("SCR, helically routed tendon", upward(), sections, loads),
        &|s| {
            let a = 22.0 * s;
            v(9.0 * a.cos(), 9.0 * a.sin(), 1.5)
        },
    );

    let mut tiny = section("catheter tip", 0.02, 0.3e-3);
    tiny.profile.base = CrossSection::Tube {
        diameter: 0.6e-3,
        inner_diameter: 0.4e-3,
    };
    tiny.profile.tip = tiny.profile.base;
    let loads = vec![point(0.02, v(0.004, 0.0, 0.0), v(0.0, 1e-5, 0.0))];
    add(
        "tiny",
        robot("Micro catheter", upward(), vec![tiny], loads),
        &|_| v(0.0, 55.0, 0.0),
    );

    let mut long = section("boom", 2.0, 8e-3);
    long.profile.tip = CrossSection::Round { diameter: 4e-3 };
    let loads = vec![
        LoadKind::Distributed {
            from: 0.4,
            to: 1.6,
            force_per_length: v(0.0, 0.0, -0.5),
            moment_per_length: Vector3::zeros(),
            frame: Frame::World,
        },
        hung(2.0, 0.15),
    ];
    add(
        "long",
        robot("Two-metre boom", horizontal(), vec![long], loads),
        &|s| Vector3::x() * (-0.9 * (1.0 - s / 2.0)),
    );

    add(
        "vertical",
        robot(
            "Upright & unloaded <test>",
            upward(),
            vec![section("rod", 0.4, 2e-3)],
            vec![],
        ),
        &|_| Vector3::zeros(),
    );

    let loads = vec![LoadKind::Mass { at: 0.3, mass: 0.5 }];
    add(
        "hanging",
        robot(
            "Hanging straight down",
            base(v(0.0, 0.0, -1.0), Vector3::x()),
            vec![section("rod", 0.3, 2e-3)],
            loads,
        ),
        &|_| Vector3::zeros(),
    );

    let loads = vec![hung(0.6, 0.001)];
    add(
        "straight",
        robot(
            "Almost straight rod",
            horizontal(),
            vec![section("rod", 0.6, 6e-3)],
            loads,
        ),
        &|_| Vector3::x() * 0.002,
    );

    let mut free = robot(
        "No gravity, oblique base",
        base(v(1.0, 1.0, 1.0), Vector3::x()),
        (1..=4)
            .map(|i| section(&format!("segment {i}"), 0.05, 1e-3))
            .collect(),
        vec![LoadKind::Distributed {
            from: 0.0,
            to: 0.2,
            force_per_length: v(0.6, 0.0, 0.0),
            moment_per_length: v(0.0, 0.0, 0.01),
            frame: Frame::Body,
        }],
    );
    free.gravity = Vector3::zeros();
    free.base.position = v(0.5, -0.2, 1.0);
    add("oblique", free, &|s| v(6.0, 4.0 * (30.0 * s).sin(), 2.0));
    all
}
