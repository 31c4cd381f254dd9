//! Plane bending: tip force, own weight, end moment.

use super::reference::{bisect, elliptic, integrate, weight_elastica};
use super::{Case, Group, dead_load, material, prismatic, read, rod, solve};
use crate::Robot;
use crate::model::CrossSection;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};

/// The classical elastica neither stretches nor shears. A round rod of L/d = 1e6 strains by F/EA = alpha (d/L)^2/16 < 1e-12.
const PURE: f64 = 1e-6;
/// A thick rod, in which stretch and shear move the tip by a few percent.
const THICK: f64 = 0.1;
/// Fraction of the length; the reference is accurate to 1e-13.
const EXACT: f64 = 1e-9;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for alpha in [1.0, 2.0, 5.0, 10.0] {
        cases.extend(bisshopp_drucker(alpha));
    }
    for alpha in [1.0, 2.0, 5.0, 10.0] {
        cases.extend(reissner(alpha));
    }
    for beta in [1.0, 2.0, 5.0, 10.0] {
        cases.extend(own_weight(beta));
    }
    for (name, angle) in [("half circle", PI), ("circle", 2.0 * PI)] {
        cases.extend(circle(name, angle));
    }
    cases
}

/// A round rod of unit length and unit E I.
fn unit_rod(diameter: f64) -> Robot {
    let youngs_modulus = 64.0 / (PI * diameter.powi(4));
    rod(1.0, material(youngs_modulus, 0.3), prismatic(CrossSection::Round { diameter }))
}

/// Tip x, drop and slope against a reference in the same order.
fn tip_cases(group: Group, name: &str, robot: &Robot, reference: [f64; 3]) -> [Case; 3] {
    let solved = solve(robot);
    [
        group.case(format!("{name}, tip x / L"), reference[0], read(&solved, |e| e.tip.position.x), EXACT),
        group.case(
            format!("{name}, tip drop / L"),
            reference[1],
            read(&solved, |e| -e.tip.position.y),
            EXACT,
        ),
        group.case(
            format!("{name}, tip slope [rad]"),
            reference[2],
            read(&solved, |e| {
                let tangent = e.tip.rotation * Vector3::z();
                (-tangent.y).atan2(tangent.x)
            }),
            EXACT,
        ),
    ]
}

/// Dead force across the tip of a rod without stretch and shear, alpha = F L^2/EI.
fn bisshopp_drucker(alpha: f64) -> [Case; 3] {
    let group = Group {
        title: "Cantilever with a dead tip force (elastica)",
        source: "elliptic integrals, Bisshopp & Drucker 1945, Q. Appl. Math. 3",
        reason: "the solver is asked for 1e-10 L",
    };
    // Modulus k = sqrt((1 + sin(slope)) / 2) from sqrt(alpha) = K(k) - F(lower, k).
    let span = |k: f64| {
        let lower = (0.5_f64.sqrt() / k).min(1.0).asin();
        let ((f1, e1), (f0, e0)) = (elliptic(FRAC_PI_2, k), elliptic(lower, k));
        (f1 - f0, e1 - e0)
    };
    let k = bisect(0.5_f64.sqrt(), 1.0 - 1e-12, |k| span(k).0 - alpha.sqrt());
    let sine = 2.0 * k * k - 1.0;
    let x = (2.0 * sine / alpha).sqrt();
    let drop = 1.0 - 2.0 / alpha.sqrt() * span(k).1;

    let mut robot = unit_rod(PURE);
    robot.loads = vec![dead_load(1.0, -alpha * Vector3::y(), Vector3::zeros())];
    tip_cases(group, &format!("F L^2/EI = {alpha}"), &robot, [x, drop, sine.asin()])
}

/// The same with stretch and shear (Reissner's beam), by its energy integral: E I phi'^2/2 + W(phi) is constant along s.
fn reissner(alpha: f64) -> [Case; 3] {
    let group = Group {
        title: "Cantilever with a dead tip force, L/d = 10 (stretch and shear)",
        source: "quadrature of the energy integral of Reissner's beam, Reissner 1972, ZAMP 23",
        reason: "the solver is asked for 1e-10 L",
    };
    let (force, ea) = (alpha, 16.0 / THICK.powi(2));
    let ga = ea / 2.6;
    // s, x and drop of the tip for a slope phi_tip there; phi = phi_tip (1 - t^2) takes out the root's singularity.
    let shape = |phi_tip: f64| {
        integrate(|t| {
            let (phi, below) = (phi_tip * (1.0 - t * t), phi_tip * t * t);
            let difference = 2.0 * force * (phi + 0.5 * below).cos() * (0.5 * below).sin()
                + 0.5 * force.powi(2) * (1.0 / ea - 1.0 / ga) * (phi + phi_tip).sin() * below.sin();
            let ds = 2.0 * phi_tip * t / (2.0 * difference).sqrt();
            let (sine, cosine) = phi.sin_cos();
            let (stretch, shear) = (1.0 + force * sine / ea, force * cosine / ga);
            [ds, ds * (stretch * cosine - shear * sine), ds * (stretch * sine + shear * cosine)]
        })
    };
    let phi_tip = bisect(1e-3, FRAC_PI_2 - 1e-3, |phi_tip| shape(phi_tip)[0] - 1.0);
    let [_, x, drop] = shape(phi_tip);

    let mut robot = unit_rod(THICK);
    robot.loads = vec![dead_load(1.0, -force * Vector3::y(), Vector3::zeros())];
    tip_cases(group, &format!("F L^2/EI = {alpha}"), &robot, [x, drop, phi_tip])
}

/// Own weight across a rod without stretch and shear, beta = w L^3/EI.
fn own_weight(beta: f64) -> [Case; 3] {
    let group = Group {
        title: "Cantilever under its own weight (elastica)",
        source: "Taylor series of order 20; compare Rohde 1953, Q. Appl. Math. 11; Wang 1986, Int. J. Mech. Sci. 28",
        reason: "the solver is asked for 1e-10 L",
    };
    let slope = bisect(0.0, FRAC_PI_2, |phi_tip| weight_elastica(beta, phi_tip)[0]);
    let [_, x, drop] = weight_elastica(beta, slope);

    let mut robot = unit_rod(PURE);
    robot.gravity = -Vector3::y();
    robot.sections[0].material.density = beta / (0.25 * PI * PURE.powi(2));
    tip_cases(group, &format!("w L^3/EI = {beta}"), &robot, [x, drop, slope])
}

/// A moment at the tip bends the rod to an arc of this angle.
fn circle(name: &str, angle: f64) -> [Case; 3] {
    let group = Group {
        title: "Circle under an end moment",
        source: "exact: curvature M/EI",
        reason: "the solver is asked for 1e-10 L",
    };
    let mut robot = unit_rod(THICK);
    robot.loads = vec![dead_load(1.0, Vector3::zeros(), angle * Vector3::z())];
    let solved = solve(&robot);
    let exact = [angle.sin() / angle, (1.0 - angle.cos()) / angle];
    [
        group.case(format!("{name}, tip x / L"), exact[0], read(&solved, |e| e.tip.position.x), EXACT),
        group.case(format!("{name}, tip y / L"), exact[1], read(&solved, |e| e.tip.position.y), EXACT),
        group.case(
            format!("{name}, sine of the tip slope"),
            angle.sin(),
            read(&solved, |e| (e.tip.rotation * Vector3::z()).y),
            EXACT,
        ),
    ]
}
