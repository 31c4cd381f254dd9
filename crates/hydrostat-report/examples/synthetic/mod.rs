//! Robots with shapes integrated by hand, for pictures and tests; no solver is involved.
#![allow(dead_code, clippy::unwrap_used)]

use hydrostat::model::{CrossSection, Frame, Guides, Load, LoadKind, Material, Pose, Profile, Section};
use hydrostat::solution::{Check, Method, Report, Station};
use hydrostat::verify::{
    Experiment, Input, Point, PointError, Published, Row, Summary, Varied, Verification, VerifiedRow,
};
use hydrostat::{Equilibrium, Robot};
use nalgebra::{Matrix3, Rotation3, Vector3};

pub(crate) fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

pub(crate) fn nitinol() -> Material {
    Material {
        name: "niti54".into(),
        youngs_modulus: 54e9,
        shear_modulus: 20.3e9,
        density: 6450.0,
        strain_limit: Some(0.01),
    }
}

pub(crate) fn section(name: &str, length: f64, diameter: f64) -> Section {
    let round = CrossSection::Round { diameter };
    Section {
        name: name.into(),
        length,
        material: nitinol(),
        profile: Profile { base: round, tip: round, shear_coefficient: 1.0 },
        rest_curvature: Vector3::zeros(),
        guides: None,
    }
}

pub(crate) fn guides(spacing: f64, length: f64) -> Option<Guides> {
    let count = (length / spacing + 1e-9) as usize;
    Some(Guides {
        positions: (1..=count).map(|i| i as f64 * spacing).collect(),
        mass: 0.9e-3,
        mass_center: [0.0; 2],
        radius: None,
    })
}

pub(crate) fn robot(name: &str, base: Pose, sections: Vec<Section>, loads: Vec<LoadKind>) -> Robot {
    let loads = loads.into_iter().map(|kind| Load { name: None, kind }).collect();
    Robot {
        tendons: Vec::new(),
        actuation: Vec::new(),
        name: name.into(),
        gravity: v(0.0, 0.0, -9.81),
        base,
        sections,
        loads,
    }
}

pub(crate) fn upward() -> Pose {
    Pose { position: Vector3::zeros(), rotation: Rotation3::identity() }
}

/// A base with the given world directions of the tangent and, about, of d1.
pub(crate) fn base(tangent: Vector3<f64>, normal: Vector3<f64>) -> Pose {
    let d3 = tangent.normalize();
    let d2 = d3.cross(&normal).normalize();
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[d2.cross(&d3), d2, d3]));
    Pose { position: Vector3::zeros(), rotation }
}

/// The shape with bending and twist u(s), body frame.
pub(crate) fn integrate(robot: &Robot, u: impl Fn(f64) -> Vector3<f64>) -> Equilibrium {
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
        tendons: Vec::new(),
        tip: Pose { position: last.position, rotation: Rotation3::from_matrix_unchecked(last.rotation) },
        stations,
        checks: vec![Check {
            name: "strain",
            value: 0.004,
            limit: 0.01,
            ok: true,
            at: Some(0.0),
            tendons: Vec::new(),
        }],
        report: Report {
            unstable_from: None,
            snapped_from: None,
            method: Method::Shooting,
            iterations: 4,
            residual: 1e-13,
            error_estimate: 1e-10,
            stable: Some(true),
            smallest_eigenvalue: Some(0.4),
        },
    }
}

pub(crate) fn point(at: f64, force: Vector3<f64>, moment: Vector3<f64>) -> LoadKind {
    LoadKind::Point { at, force, moment, frame: Frame::World }
}

pub(crate) fn hung(at: f64, mass: f64) -> LoadKind {
    LoadKind::Mass { at, mass }
}

/// Every picture of the gallery: name, robot, shape.
pub(crate) fn gallery() -> Vec<(&'static str, Robot, Equilibrium)> {
    let horizontal = || base(v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0));
    let mut all = Vec::new();
    let mut add = |name, robot: Robot, u: &dyn Fn(f64) -> Vector3<f64>| {
        let shape = integrate(&robot, u);
        all.push((name, robot, shape));
    };

    let mut planar =
        robot("Gray's rod, 20 g", horizontal(), vec![section("rod", 0.39, 1.56e-3)], vec![hung(0.39, 0.02)]);
    planar.gravity = v(0.0, -9.81, 0.0);
    planar.base = base(v(1.0, 0.0, 0.0), v(0.0, 0.0, 1.0));
    add("planar", planar, &|s| Vector3::x() * (-5.2 * (1.0 - s / 0.39)));

    let mut proximal = section("proximal", 0.2, 1.56e-3);
    proximal.guides = guides(0.01, 0.2);
    let mut distal = section("distal", 0.15, 1.2e-3);
    distal.guides = guides(0.01, 0.15);
    let sections = vec![proximal, distal];
    let loads = vec![point(0.35, v(0.1, -0.2, 0.05), v(0.0, 0.02, 0.0)), hung(0.2, 0.02), hung(0.35, 0.05)];
    add("helix", robot("SCR, helically routed tendon", upward(), sections, loads), &|s| {
        let a = 22.0 * s;
        v(9.0 * a.cos(), 9.0 * a.sin(), 1.5)
    });

    let mut tiny = section("catheter tip", 0.02, 0.3e-3);
    tiny.profile.base = CrossSection::Tube { diameter: 0.6e-3, inner_diameter: 0.4e-3 };
    tiny.profile.tip = tiny.profile.base;
    let loads = vec![point(0.02, v(0.004, 0.0, 0.0), v(0.0, 1e-5, 0.0))];
    add("tiny", robot("Micro catheter", upward(), vec![tiny], loads), &|_| v(0.0, 55.0, 0.0));

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
    add("long", robot("Two-metre boom", horizontal(), vec![long], loads), &|s| {
        Vector3::x() * (0.9 * (1.0 - s / 2.0))
    });

    add(
        "vertical",
        robot("Upright & unloaded <test>", upward(), vec![section("rod", 0.4, 2e-3)], vec![]),
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
        robot("Almost straight rod", horizontal(), vec![section("rod", 0.6, 6e-3)], loads),
        &|_| Vector3::x() * 0.002,
    );

    let mut free = robot(
        "No gravity, oblique base",
        base(v(1.0, 1.0, 1.0), Vector3::x()),
        (1..=4).map(|i| section(&format!("segment {i}"), 0.05, 1e-3)).collect(),
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

/// Table 2 of Gray 2009: mass in g, observed x and y in cm.
const GRAY: [[f64; 3]; 11] = [
    [0.0, 39.0, -2.3],
    [13.8, 35.0, -15.9],
    [16.9, 33.9, -17.8],
    [20.0, 32.5, -19.5],
    [23.1, 31.4, -21.2],
    [26.2, 30.3, -22.4],
    [29.3, 29.5, -23.3],
    [32.4, 28.5, -24.4],
    [35.5, 27.4, -25.4],
    [38.6, 26.5, -26.2],
    [41.7, 25.8, -26.9],
];

const STIFFNESS: f64 = 0.015701;
const WEIGHT: f64 = 0.1176;

/// Gray's rod with a mass at its tip: EI theta'' = (W + w (L - s)) cos theta by bisection on theta'(0).
pub(crate) fn elastica(length: f64, mass: f64) -> Vec<Vector3<f64>> {
    let (n, tip) = (1000, mass * 9.81);
    let h = length / f64::from(n);
    let run = |bend: f64| {
        let (mut theta, mut kappa, mut p) = (0.0_f64, bend, Vector3::zeros());
        let mut shape = vec![p];
        for i in 0..n {
            let load = |s: f64| tip + WEIGHT * (length - s);
            let s = f64::from(i) * h;
            let middle = theta + kappa * h / 2.0;
            kappa += h * load(s + h / 2.0) * middle.cos() / STIFFNESS;
            p += h * v(middle.cos(), middle.sin(), 0.0);
            theta = middle + kappa * h / 2.0;
            if i % 10 == 9 {
                shape.push(p);
            }
        }
        (kappa, shape)
    };
    let (mut low, mut high) = (-40.0, 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if run(middle).0 > 0.0 { high = middle } else { low = middle }
    }
    run(0.5 * (low + high)).1
}

/// An arc whose end has the rod's mean slope: what constant curvature gives, roughly.
fn arc(length: f64, end: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let kappa = 1.75 * end.y.atan2(end.x) / length;
    let at = |s: f64| v((kappa * s).sin() / kappa, (1.0 - (kappa * s).cos()) / kappa, 0.0);
    (0..=100).map(|i| at(length * f64::from(i) / 100.0)).collect()
}

pub(crate) fn summary(errors: &[f64], length: f64, reading: f64) -> Summary {
    let n = errors.len().max(1) as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
    Summary {
        mean,
        rms,
        max: errors.iter().copied().fold(0.0, f64::max),
        mean_fraction: mean / length,
        in_reading_errors: rms / reading / 2f64.sqrt(),
        offset: Vector3::zeros(),
        rms_without_offset: rms,
    }
}

/// Gray's bench, with shapes of [`elastica`].
pub(crate) fn gray() -> (Experiment, Verification) {
    let length = 0.39;
    let mut robot = robot(
        "SCR1, one rod",
        base(v(1.0, 0.0, 0.0), v(0.0, 0.0, 1.0)),
        vec![section("rod", length, 1.56e-3)],
        vec![],
    );
    robot.gravity = v(0.0, -9.81, 0.0);
    let mut rows = Vec::new();
    let mut measured = Vec::new();
    let mut constant = Vec::new();
    for [g, x, y] in GRAY {
        let shape = elastica(length, g * 1e-3);
        let observed = v(x, y, 0.0) * 0.01;
        let predicted = *shape.last().unwrap();
        let bent = arc(length, &predicted);
        constant.push((bent.last().unwrap() - observed).norm());
        let error = (predicted - observed).norm();
        measured.push(Row { inputs: vec![g * 1e-3], observed: vec![observed] });
        rows.push(VerifiedRow {
            failed: Vec::new(),
            inputs: vec![g * 1e-3],
            points: vec![PointError { at: length, predicted, observed, error }],
            shape,
            constant_curvature_shape: bent,
        });
    }
    let errors: Vec<f64> = rows.iter().map(|r| r.points[0].error).collect();
    let model = summary(&errors, length, 5e-4);
    let experiment = Experiment {
        name: "Horizontal rod with hung masses".into(),
        source: Some("Gray 2009, Table 2".into()),
        robot: robot.clone(),
        axes: upward(),
        inputs: vec![Input {
            column: "mass".into(),
            unit: ("g".into(), 1e-3),
            quantity: Varied::HungMass { at: length },
        }],
        points: vec![Point { at: length, axes: vec![0, 1], reading_error: 5e-4 }],
        rows: measured,
        published: Some(Published {
            mean_errors: vec![
                ("mean error in the text".into(), 2.1e-3),
                ("mean error in the table".into(), 2.4e-3),
            ],
            ..Published::default()
        }),
        variants: vec![("density 6.80 g/cm³".into(), robot)],
    };
    let verification = Verification {
        rows,
        model,
        constant_curvature: summary(&constant, length, 5e-4),
        constant_curvature_weightless: summary(&constant.iter().map(|e| 1.4 * e).collect::<Vec<_>>(), length, 5e-4),
        variants: vec![("density 6.80 g/cm³".into(), summary(&errors.iter().map(|e| 1.2 * e).collect::<Vec<_>>(), length, 5e-4))],
        verdict: vec![
            "The model predicts the tip to 2.4 mm on average, 0.62 % of the length; that is more than the reading error of 0.5 mm explains.".into(),
            "The residual is systematic: the rod is observed stiffer than predicted at 17 to 30 g and softer above 35 g.".into(),
        ],
        findings: vec![
            "The mean of the printed errors is 2.4 mm; the text says 2.1 mm.".into(),
            "Row 38.6 g: the printed coordinates are 3.4 mm apart, the table says 3.3 mm.".into(),
            "A density of 6.80 g/mm³ is impossible; 6.80 g/cm³ is meant, and the predicted column fits 6.27 g/cm³.".into(),
        ],
    };
    (experiment, verification)
}

/// Every page of the gallery.
pub(crate) fn benches() -> Vec<(&'static str, (Experiment, Verification))> {
    vec![("gray", gray()), ("spatial", spatial()), ("single", single())]
}

/// Two points measured in three axes, two inputs; the robot bends out of the plane.
pub(crate) fn spatial() -> (Experiment, Verification) {
    let mut sections = vec![section("proximal", 0.2, 1.56e-3), section("distal", 0.15, 1.2e-3)];
    sections[0].guides = guides(0.02, 0.2);
    let robot = robot("SCR <two sections> & tendons", upward(), sections, vec![hung(0.1, 0.01)]);
    let length = robot.length();
    let (mut rows, mut measured) = (Vec::new(), Vec::new());
    let (mut errors, mut constant) = (Vec::new(), Vec::new());
    for (i, (force, angle)) in
        [(0.0, 0.0), (0.1, 0.0), (0.2, 0.0), (0.1, 0.35), (0.2, 0.35), (0.3, 0.35)].into_iter().enumerate()
    {
        let shape: Vec<_> = integrate(&robot, |s| v(1.0 + 8.0 * angle, 14.0 * force + 0.5, 0.0) * (1.3 - s))
            .stations
            .iter()
            .map(|k| k.position)
            .collect();
        let bent: Vec<_> = integrate(&robot, |_| v(1.0 + 8.0 * angle, 14.0 * force + 0.5, 0.0) * 1.05)
            .stations
            .iter()
            .map(|k| k.position)
            .collect();
        let noise = |k: usize| (((i * 7 + k * 3) % 11) as f64 - 5.0) * 4e-4;
        let points: Vec<PointError> = [57, 100]
            .iter()
            .map(|&k| {
                let predicted = shape[k];
                let observed = predicted + v(noise(k), noise(k + 1), noise(k + 2));
                constant.push((bent[k] - observed).norm());
                errors.push((predicted - observed).norm());
                PointError {
                    at: length * k as f64 / 100.0,
                    predicted,
                    observed,
                    error: (predicted - observed).norm(),
                }
            })
            .collect();
        measured
            .push(Row { inputs: vec![force, angle], observed: points.iter().map(|p| p.observed).collect() });
        rows.push(VerifiedRow {
            inputs: vec![force, angle],
            points,
            failed: Vec::new(),
            shape,
            constant_curvature_shape: bent,
        });
    }
    let point = |at| Point { at, axes: vec![0, 1, 2], reading_error: 1e-3 };
    let input = |column: &str, unit: &str, size, quantity| Input {
        column: column.into(),
        unit: (unit.into(), size),
        quantity,
    };
    let experiment = Experiment {
        name: "Side force & turned base, <3-D>".into(),
        source: None,
        axes: upward(),
        inputs: vec![
            input("force", "mN", 1e-3, Varied::Force { at: length, direction: Vector3::x() }),
            input("angle", "deg", 1f64.to_radians(), Varied::MountAngle),
        ],
        points: vec![point(0.57 * length), point(length)],
        rows: measured,
        published: None,
        variants: vec![],
        robot,
    };
    let verification = Verification {
        rows,
        model: summary(&errors, length, 1e-3),
        constant_curvature: summary(&constant, length, 1e-3),
        constant_curvature_weightless: summary(&constant, length, 1e-3),
        variants: vec![],
        verdict: vec!["The model is within the reading error.".into()],
        findings: vec![],
    };
    (experiment, verification)
}

/// One row, nothing varied.
pub(crate) fn single() -> (Experiment, Verification) {
    let (mut experiment, mut verification) = gray();
    experiment.name = "One photograph".into();
    experiment.inputs.clear();
    experiment.published = None;
    experiment.variants.clear();
    experiment.rows.truncate(1);
    experiment.rows[0].inputs.clear();
    verification.rows.truncate(1);
    verification.rows[0].inputs.clear();
    verification.variants.clear();
    verification.findings.clear();
    verification.verdict.truncate(1);
    (experiment, verification)
}
