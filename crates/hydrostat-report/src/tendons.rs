//! Tendons and guides beside the backbone.

use crate::draw::{Canvas, GRID_HEAVY, P, Pen};
use crate::loads::Shape;
use crate::view::View;
use hydrostat::Robot;
use hydrostat::model::{Routing, Tendon};
use nalgebra::Vector3;

/// Okabe and Ito's palette without the colours of the backbone.
const COLOURS: [&str; 6] = ["#d55e00", "#009e73", "#cc79a7", "#e69f00", "#7a5195", "#4d4d4d"];
/// Points of a tendon in a channel.
const SAMPLES: usize = 120;
/// Guides whose size is not given reach this far beyond their holes.
const BEYOND_HOLES: f64 = 1.25;

/// Of guides.
pub(crate) const RIM: Pen = Pen::new(GRID_HEAVY, 0.9);

pub(crate) fn colour(number: usize) -> &'static str {
    COLOURS[number % COLOURS.len()]
}

/// Guides as thin disks from the side, tendons as lines through their holes; slack ones dashed.
pub(crate) fn draw(canvas: &mut Canvas, robot: &Robot, shape: &Shape, view: &View) {
    guides(canvas, robot, shape, view);
    for (number, tendon) in robot.tendons.iter().enumerate() {
        let points: Vec<P> = places(robot, tendon)
            .into_iter()
            .filter_map(|s| hole(robot, tendon, shape, s))
            .map(|p| shape.on_page(view, &p))
            .collect();
        let slack = shape.equilibrium.tendons.get(number).is_some_and(|state| state.slack);
        let pen = Pen::new(colour(number), 1.3);
        canvas.polyline(&points, if slack { Pen::dashed(colour(number), 1.3, "3 3") } else { pen });
    }
}

/// Arc lengths at which a tendon's line has a point.
fn places(robot: &Robot, tendon: &Tendon) -> Vec<f64> {
    let end = robot.tendon_end(tendon);
    match tendon.routing {
        Routing::Channel => (0..=SAMPLES).map(|i| end * i as f64 / SAMPLES as f64).collect(),
        Routing::Guides => robot.plates().into_iter().filter(|s| *s <= end * (1.0 + 1e-9)).collect(),
    }
}

fn hole(robot: &Robot, tendon: &Tendon, shape: &Shape, s: f64) -> Option<Vector3<f64>> {
    let end = robot.tendon_end(tendon);
    let (position, rotation) = shape.at(s.min(robot.length()))?;
    Some(position + rotation * tendon.path.hole((s / end).min(1.0), end).0)
}

fn guides(canvas: &mut Canvas, robot: &Robot, shape: &Shape, view: &View) {
    let mut start = 0.0;
    for section in &robot.sections {
        if let Some(guides) = &section.guides {
            for position in &guides.positions {
                let s = start + position;
                let Some((centre, rotation)) = shape.at(s) else { continue };
                let Some(radius) = guides.radius.or_else(|| holes(robot, s)) else { continue };
                let edge = |angle: f64| {
                    let (sin, cos) = angle.sin_cos();
                    shape.on_page(view, &(centre + rotation * Vector3::new(radius * cos, radius * sin, 0.0)))
                };
                let rim: Vec<P> =
                    (0..=36).map(|i| edge(f64::from(i) * std::f64::consts::TAU / 36.0)).collect();
                canvas.polyline(&rim, RIM);
            }
        }
        start += section.length;
    }
}

/// Radius of a disk around the holes at `s`.
fn holes(robot: &Robot, s: f64) -> Option<f64> {
    let passing = robot.tendons.iter().filter(|tendon| s <= robot.tendon_end(tendon) * (1.0 + 1e-9));
    let radii = passing.map(|tendon| tendon.path.hole(s / robot.tendon_end(tendon), 1.0).0.norm());
    radii.max_by(f64::total_cmp).map(|radius| BEYOND_HOLES * radius)
}
