//! 500 static shapes of a steel rod computed with SoRoSim (opencr-mujoco, MIT).

use super::{Case, Group, dead_load, material, prismatic, rod};
use crate::Robot;
use crate::model::CrossSection;
use crate::solution::Station;
use crate::statics::{self, Settings};
use nalgebra::Vector3;

const LENGTH: f64 = 0.6;
/// The file's stations are read off by a cubic between these.
const STATIONS: usize = 241;
/// Half a unit of the last printed digit, m.
const ROUNDING: f64 = 5e-5;
/// Columns before the first position.
const FIRST_POSITION: usize = 4;

/// One shape: its loads (file's frame, SI) and its positions.
#[derive(Clone, Debug, Default)]
struct Shape {
    gravity: Vector3<f64>,
    /// Force and moment at L/2 and L.
    forces: [Vector3<f64>; 2],
    moments: [Vector3<f64>; 2],
    positions: Vec<Vector3<f64>>,
}

/// Arc lengths of the stations and the shapes.
struct Data {
    arc_lengths: Vec<f64>,
    shapes: Vec<Shape>,
}

pub(super) fn cases(csv: &str) -> Vec<Case> {
    let group = Group {
        title: "Steel rod computed by SoRoSim",
        source: "opencr-mujoco, statics.csv: L 0.6 m, d 1.6 mm, dead wrenches at L/2 and L",
        reason: "positions are rounded to 0.1 mm and the twelve components of the wrenches to 1e-4, of which half a unit \
                 moves the tip by up to 0.18 mm each; the worst station, shape 200, falls from 0.60 to 0.07 mm when \
                 its loads are fitted within their rounding",
    };
    let data = match parse(csv) {
        Ok(data) => data,
        Err(message) => return vec![group.case("file", 0.0, Err(message), 0.0)],
    };
    let mut offsets = Vec::new();
    let mut failures = Vec::new();
    for shape in &data.shapes {
        match offsets_of(shape, &data.arc_lengths) {
            Ok(found) => offsets.extend(found),
            Err(message) => failures.push(message),
        }
    }
    let quantile = |fraction: f64, distance: fn(&Vector3<f64>) -> f64| -> Result<f64, String> {
        let mut distances: Vec<f64> = offsets.iter().map(|offset| 1e3 * distance(offset)).collect();
        distances.sort_by(f64::total_cmp);
        let index = (fraction * distances.len() as f64).ceil() as usize;
        distances.get(index.saturating_sub(1)).copied().ok_or_else(|| failures.join("; "))
    };
    let count = data.shapes.len();
    let missing = failures.len() as f64;
    let as_printed = quantile(1.0, Vector3::norm).unwrap_or(f64::NAN);
    vec![
        group.case(format!("shapes of {count} without an answer"), 0.0, Ok(missing), 0.0),
        group.case("95 % of the stations within [mm]", 0.0, quantile(0.95, Vector3::norm), 0.25),
        group.case(
            format!(
                "all stations within, beyond the rounding of the positions [mm]; as printed: {as_printed:.3}"
            ),
            0.0,
            quantile(1.0, beyond_rounding),
            0.6,
        ),
    ]
}

/// Distance from the box of positions that round to the printed one.
fn beyond_rounding(offset: &Vector3<f64>) -> f64 {
    offset.map(|x| (x.abs() - ROUNDING).max(0.0)).norm()
}

/// From the file's positions to our backbone at the file's stations.
fn offsets_of(shape: &Shape, arc_lengths: &[f64]) -> Result<Vec<Vector3<f64>>, String> {
    let settings = Settings { tolerance: 1e-7, stations: STATIONS, eigenvalue: false, ..Settings::default() };
    let solved = statics::solve(&robot(shape), &settings).map_err(|error| error.to_string())?;
    Ok(arc_lengths
        .iter()
        .zip(&shape.positions)
        .map(|(&s, position)| position_at(&solved.stations, s) - position)
        .collect())
}

/// Position by cubic Hermite interpolation with the exact tangent R v; at a spacing of L/240 its error is below 1e-7 m.
fn position_at(stations: &[Station], s: f64) -> Vector3<f64> {
    let next = stations.partition_point(|station| station.s < s).clamp(1, stations.len() - 1);
    let (a, b) = (&stations[next - 1], &stations[next]);
    let h = b.s - a.s;
    let t = (s - a.s) / h;
    let (ta, tb) = (a.rotation * a.v * h, b.rotation * b.v * h);
    let (rise, back) = (t * t * (3.0 - 2.0 * t), 1.0 - t);
    a.position * (1.0 - rise) + b.position * rise + ta * (t * back * back) - tb * (t * t * back)
}

/// Steel, clamped at the origin, d3 along +x of the file's frame.
fn robot(shape: &Shape) -> Robot {
    let section = CrossSection::Round { diameter: 1.6e-3 };
    let mut robot = rod(LENGTH, material(200e9, 0.33), prismatic(section));
    robot.sections[0].material.density = 7870.0;
    robot.gravity = shape.gravity;
    robot.loads = vec![
        dead_load(0.5 * LENGTH, shape.forces[0], shape.moments[0]),
        dead_load(LENGTH, shape.forces[1], shape.moments[1]),
    ];
    robot
}

/// Reads the file: see `data/README.md` for its layout.
fn parse(csv: &str) -> Result<Data, String> {
    let mut lines = csv.lines().skip(1).filter(|line| !line.trim().is_empty());
    let halves = numbers(lines.next().ok_or("no row of arc lengths")?)?;
    let halves = halves.get(FIRST_POSITION - 1..).unwrap_or_default();
    let per_half = halves.len() / 2;
    let arc_lengths = halves
        .iter()
        .enumerate()
        .map(|(i, fraction)| 0.5 * LENGTH * (fraction + (i / per_half.max(1)) as f64))
        .collect::<Vec<f64>>();
    let rows: Vec<(&str, Vec<f64>)> = lines
        .map(|line| Ok((line.split(',').next().unwrap_or_default(), numbers(line)?)))
        .collect::<Result<_, String>>()?;
    let shapes = rows.chunks(6).map(|rows| shape(rows, arc_lengths.len())).collect::<Result<_, String>>()?;
    Ok(Data { arc_lengths, shapes })
}

/// Six rows, EulX to Pz: moments beside the angles, gravity and forces beside the positions.
fn shape(rows: &[(&str, Vec<f64>)], stations: usize) -> Result<Shape, String> {
    let labels = ["EulX", "EulY", "EulZ", "Px", "Py", "Pz"];
    let first = rows[0].0;
    let complete = rows.len() == labels.len()
        && rows.iter().zip(labels).all(|((name, row), label)| {
            name.starts_with(label) && row.len() == FIRST_POSITION - 1 + stations
        });
    if !complete {
        return Err(format!("the six rows from {first} on are not EulX to Pz with {stations} stations"));
    }
    let vector = |first: usize, column: usize| Vector3::from_fn(|axis, _| rows[first + axis].1[column]);
    Ok(Shape {
        gravity: vector(3, 0),
        forces: [vector(3, 1), vector(3, 2)],
        moments: [vector(0, 1), vector(0, 2)],
        positions: (FIRST_POSITION - 1..FIRST_POSITION - 1 + stations).map(|i| vector(3, i)).collect(),
    })
}

/// The cells after the label.
fn numbers(line: &str) -> Result<Vec<f64>, String> {
    line.split(',')
        .skip(1)
        .map(|cell| cell.trim().parse().map_err(|_| format!("not a number: '{cell}' in '{:.40}...'", line)))
        .collect()
}
