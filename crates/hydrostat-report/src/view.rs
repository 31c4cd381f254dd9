//! From which sides a robot is seen.

use crate::draw::P;
use crate::text::{fixed, short};
use hydrostat::{Equilibrium, Robot};
use nalgebra::Vector3;

/// A direction of the page in the world; coordinates are counted along the world axis it belongs to.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) direction: Vector3<f64>,
    /// `x`, or the direction in words where it is no axis of the world.
    pub(crate) name: String,
    /// -1 where the page's direction is the negative world axis.
    pub(crate) sign: f64,
}

/// A parallel projection: world directions that point right and up on the page.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) title: &'static str,
    pub(crate) right: Axis,
    pub(crate) up: Axis,
}

/// A world axis is preferred to the exact plane of bending when it shows this share of the extent.
const SHARE_OF_A_WORLD_AXIS: f64 = 0.9;

/// Components below it are zero in words.
const IN_PLANE: f64 = 1e-3;

impl Axis {
    pub(crate) fn new(direction: Vector3<f64>) -> Axis {
        for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
            if direction[i].abs() > 1.0 - 1e-9 {
                return Axis { direction, name: name.to_owned(), sign: direction[i].signum() };
            }
        }
        Axis { name: direction_in_words(&direction), direction, sign: 1.0 }
    }
}

impl View {
    /// Metres right and up of the world's origin.
    pub(crate) fn project(&self, p: &Vector3<f64>) -> P {
        [p.dot(&self.right.direction), p.dot(&self.up.direction)]
    }

    /// Into the page.
    pub(crate) fn away(&self) -> Vector3<f64> {
        -self.right.direction.cross(&self.up.direction)
    }
}

/// The side view shows the most of the bending, the front view is seen at a right angle to it; up is against gravity,
/// or along the base where there is none.
pub(crate) fn side_and_front(robot: &Robot, equilibrium: &Equilibrium) -> [View; 2] {
    let tangent = robot.base.rotation.matrix().column(2).into_owned();
    let up = unit(&-robot.gravity).or_else(|| unit(&tangent)).unwrap_or_else(Vector3::z);
    let [e1, e2] = across(&up);

    // spread of the backbone over the horizontal directions
    let (mut s11, mut s22, mut s12) = (0.0, 0.0, 0.0);
    let mut mean = Vector3::zeros();
    for station in equilibrium.stations.iter().filter(|s| s.position.iter().all(|x| x.is_finite())) {
        let p = station.position - robot.base.position;
        let (a, b) = (p.dot(&e1), p.dot(&e2));
        s11 += a * a;
        s22 += b * b;
        s12 += a * b;
        mean += p;
    }
    let length = robot.length();
    let flat = s11 + s22 <= 1e-9 * length * length || !(s11 + s22).is_finite();
    let right = if flat {
        unit(&(tangent - up * up.dot(&tangent))).filter(|_| up.dot(&tangent).abs() < 0.999).unwrap_or(e1)
    } else {
        let angle = 0.5 * (2.0 * s12).atan2(s11 - s22);
        let (sin, cos) = angle.sin_cos();
        let most = s11 * cos * cos + 2.0 * s12 * sin * cos + s22 * sin * sin;
        if s11 >= SHARE_OF_A_WORLD_AXIS * most {
            e1
        } else if s22 >= SHARE_OF_A_WORLD_AXIS * most {
            e2
        } else {
            let exact = e1 * cos + e2 * sin;
            if exact.dot(&mean) < 0.0 { -exact } else { exact }
        }
    };
    let front = forward(up.cross(&right));
    [
        View { title: "Side view", right: Axis::new(right), up: Axis::new(up) },
        View { title: "Front view", right: Axis::new(front), up: Axis::new(up) },
    ]
}

/// Two directions at right angles to `up` and each other; world axes where `up` is one.
fn across(up: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let least = (0..3).min_by(|&i, &j| up[i].abs().total_cmp(&up[j].abs())).unwrap_or(0);
    let mut axis = Vector3::zeros();
    axis[least] = 1.0;
    let e1 = unit(&(axis - up * up.dot(&axis))).unwrap_or_else(Vector3::x);
    [forward(e1), forward(up.cross(&e1))]
}

/// The direction or its opposite, whichever has its largest component positive.
fn forward(v: Vector3<f64>) -> Vector3<f64> {
    if v[v.iamax()] < 0.0 { -v } else { v }
}

fn unit(v: &Vector3<f64>) -> Option<Vector3<f64>> {
    let norm = v.norm();
    (norm.is_finite() && norm > 1e-12).then(|| v / norm)
}

/// A direction in words: `+x`, `+x turned 20° to −y`, or its components.
pub(crate) fn direction_in_words(v: &Vector3<f64>) -> String {
    let mut axes = [0, 1, 2];
    axes.sort_by(|&i, &j| v[j].abs().total_cmp(&v[i].abs()));
    let [most, less, least] = axes;
    let angle = short(v[less].abs().atan2(v[most].abs()).to_degrees(), 1);
    if v[least].abs() > IN_PLANE || !v.iter().all(|x| x.is_finite()) {
        return direction_name(v);
    }
    let axis = |i: usize| {
        let mut axis = Vector3::zeros();
        axis[i] = v[i].signum();
        direction_name(&axis)
    };
    if angle == "0" { axis(most) } else { format!("{} turned {angle}° to {}", axis(most), axis(less)) }
}

/// A direction in words: `+x`, `−z`, or its components.
pub(crate) fn direction_name(v: &Vector3<f64>) -> String {
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        if v[i].abs() > 1.0 - 1e-6 {
            return format!("{}{name}", if v[i] < 0.0 { "\u{2212}" } else { "+" });
        }
    }
    format!("({}, {}, {})", fixed(v[0], 2), fixed(v[1], 2), fixed(v[2], 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_in_words() {
        let (sin, cos) = 20_f64.to_radians().sin_cos();
        for (v, words) in [
            ([1.0, 0.0, 0.0], "+x"),
            ([0.0, 0.0, -1.0], "\u{2212}z"),
            ([cos, sin, 0.0], "+x turned 20° to +y"),
            ([-sin, 0.0, -cos], "\u{2212}z turned 20° to \u{2212}x"),
            ([1.0, 1e-4, 0.0], "+x"),
            ([0.48, 0.6, 0.64], "(0.48, 0.60, 0.64)"),
            ([f64::NAN, 0.0, 0.0], "(–, 0.00, 0.00)"),
        ] {
            assert_eq!(direction_in_words(&Vector3::from(v)), words);
        }
    }
}
