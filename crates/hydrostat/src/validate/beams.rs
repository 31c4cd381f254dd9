//! Published beams in space: the 45-degree bend and the Princeton experiment.

use super::{Case, Group, dead_load, material, prismatic, read, rod, solve};
use crate::Robot;
use crate::model::CrossSection;
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::PI;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = bend();
    cases.extend(princeton());
    cases
}

/// Radius 100, an eighth of a circle, E 1e7, nu 0, a force P out of its plane. Axes of Simo & Vu-Quoc: the beam starts
/// along y and curves to x; P along z.
fn bend_robot(section: CrossSection, force: f64) -> Robot {
    let mut robot = rod(25.0 * PI, material(1e7, 0.0), prismatic(section));
    let axes = Matrix3::from_columns(&[Vector3::x(), -Vector3::z(), Vector3::y()]);
    robot.base.rotation = Rotation3::from_matrix_unchecked(axes);
    robot.sections[0].rest_curvature = Vector3::new(0.0, 0.01, 0.0);
    robot.loads = vec![dead_load(25.0 * PI, force * Vector3::z(), Vector3::zeros())];
    robot
}

fn bend() -> Vec<Case> {
    // A tube with the unit square's area 1, second moment 1/12 and polar moment 1/6 exactly: the papers' GJ = 8.3333e5.
    // D^2 - d^2 = 4/pi and D^2 + d^2 = 4/3.
    let tube = CrossSection::Tube {
        diameter: (2.0 / 3.0 + 2.0 / PI).sqrt(),
        inner_diameter: (2.0 / 3.0 - 2.0 / PI).sqrt(),
    };
    let square = CrossSection::Strip { width: 1.0, height: 1.0 };
    let converged = Group {
        title: "45-degree bend",
        source: "converged: DOP853 at 1e-11 with root finding, computed outside this project",
        reason: "rounding of the printed digits",
    };
    let literature = Group {
        source: "literature: Bathe & Bolourchi 1979, Int. J. Numer. Methods Eng. 14; Simo & Vu-Quoc 1986, \
                 Comput. Methods Appl. Mech. Eng. 58 (8 elements)",
        reason: "8 elements are 0.15 (Simo & Vu-Quoc) and 0.8 (Bathe & Bolourchi) from the converged tip",
        ..converged
    };
    let torsion = [("GJ = 8.3333e5", tube), ("GJ = 7.0288e5 (Saint-Venant)", square)];
    // Per torsion constant and force: tip and tolerance against the converged and the published values.
    let (exact, simo, bathe) = ("converged", "Simo & Vu-Quoc", "Bathe & Bolourchi");
    let references = [
        (0, 300.0, exact, [22.244781, 58.779122, 40.191892], 1e-6, converged),
        (0, 300.0, simo, [22.33, 58.84, 40.08], 0.15, literature),
        (0, 300.0, bathe, [22.5, 59.2, 39.5], 0.8, literature),
        (0, 600.0, exact, [15.684801, 47.150439, 53.474859], 1e-6, converged),
        (0, 600.0, simo, [15.79, 47.23, 53.37], 0.15, literature),
        (0, 600.0, bathe, [15.9, 47.2, 53.4], 0.8, literature),
        (1, 300.0, exact, [22.112615, 58.535933, 40.480262], 1e-6, converged),
        (1, 600.0, exact, [15.557786, 46.891925, 53.607369], 1e-6, converged),
    ];
    let mut cases = Vec::new();
    for (index, force, by, tip, tolerance, group) in references {
        let (name, section) = torsion[index];
        let solved = solve(&bend_robot(section, force));
        for (axis, label) in ["x", "y", "z"].into_iter().enumerate() {
            cases.push(group.case(
                format!("{name}, P = {force}, tip {label}, {by}"),
                tip[axis],
                read(&solved, |e| e.tip.position[axis]),
                tolerance,
            ));
        }
    }
    cases
}

/// Strip 12.377 x 3.2024 mm, 0.508 m, E 71.7 GPa, nu 0.31, 8.896 N at 45 degrees to the sides; along d1 the stiff way.
fn princeton() -> Vec<Case> {
    let converged = Group {
        title: "Princeton beam, 8.896 N at 45 degrees",
        source: "converged: computed outside this project with Saint-Venant's torsion constant and k = 5/6",
        reason: "rounding of the printed digits",
    };
    let published = Group {
        source: "published: a beam code; experiment: Dowell & Traybar 1975, Princeton AMS Report 1194",
        reason: "the experiments scatter by more than 1 %",
        ..converged
    };
    let strip = CrossSection::Strip { width: 12.377e-3, height: 3.2024e-3 };
    let mut profile = prismatic(strip);
    profile.shear_coefficient = 5.0 / 6.0;
    let mut robot = rod(0.508, material(71.7e9, 0.31), profile);
    let force = 8.896 * 0.5_f64.sqrt();
    robot.loads = vec![dead_load(0.508, Vector3::new(0.0, force, force), Vector3::zeros())];
    let solved = solve(&robot);
    [
        (converged, "converged", 1, 0.0088889, 1e-7),
        (converged, "converged", 2, 0.1090416, 1e-7),
        (published, "published", 1, 0.0088372, 0.01 * 0.0088372),
        (published, "published", 2, 0.1089879, 0.01 * 0.1089879),
    ]
    .into_iter()
    .map(|(group, by, axis, reference, tolerance)| {
        let way = ["", "stiff", "soft"][axis];
        let name = format!("tip deflection the {way} way [m], {by}");
        group.case(name, reference, read(&solved, |e| e.tip.position[axis]), tolerance)
    })
    .collect()
}
