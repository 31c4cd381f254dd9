//! The thesis's bench: its printed prediction, reproduced, and its error, recomputed.

use super::{Case, Group, material, prismatic, read, rod, solve};
use crate::Robot;
use crate::model::{CrossSection, Load, LoadKind};
use nalgebra::Vector3;
use std::f64::consts::PI;

const TABLE_2: &str = include_str!("../../../../experiments/gray2009/table2.csv");

/// m, m, Pa; weight per length as fitted to the printed prediction, N/m.
const LENGTH: f64 = 0.39;
const DIAMETER: f64 = 1.56e-3;
const YOUNGS_MODULUS: f64 = 54e9;
const WEIGHT: f64 = 0.1176;
const GRAVITY: f64 = 9.81;

/// Mass hung at the tip [kg] and the printed coordinates [mm].
struct Row {
    mass: f64,
    predicted: [f64; 2],
    observed: [f64; 2],
}

pub(super) fn cases() -> Vec<Case> {
    let prediction = Group {
        title: "Bench of the thesis: rod of Table 2, weight 0.1176 N/m",
        source: "Gray 2009, Table 2, predicted column",
        reason: "prediction: the table is rounded to 0.1 mm and its weight is a fit",
    };
    let error = Group {
        source: "errors: recomputed from Gray 2009, Table 2, predicted against observed",
        reason: "errors: as the coordinates; the mean averages the rounding of 22 coordinates",
        ..prediction
    };
    let mut cases = Vec::new();
    let (mut ours, mut theirs): (Vec<Result<f64, String>>, Vec<f64>) = (Vec::new(), Vec::new());
    for row in table() {
        let solved = solve(&robot(row.mass));
        for (axis, label) in ["x", "y"].into_iter().enumerate() {
            cases.push(prediction.case(
                format!("{:.1} g, tip {label} [mm]", row.mass * 1e3),
                row.predicted[axis],
                read(&solved, |e| e.tip.position[axis] * 1e3),
                0.12,
            ));
        }
        let distance = |[x, y]: [f64; 2]| (x - row.observed[0]).hypot(y - row.observed[1]);
        ours.push(read(&solved, |e| distance([e.tip.position.x * 1e3, e.tip.position.y * 1e3])));
        theirs.push(distance(row.predicted));
    }
    let ours: Result<Vec<f64>, String> = ours.into_iter().collect();
    let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len() as f64;
    let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    let ours = |of: fn(&[f64]) -> f64| ours.as_ref().map(|errors| of(errors)).map_err(String::clone);
    cases.push(error.case("mean error [mm]", mean(&theirs), ours(mean), 0.03));
    cases.push(error.case("largest error [mm]", largest(&theirs), ours(largest), 0.12));
    cases
}

fn table() -> Vec<Row> {
    TABLE_2
        .lines()
        .filter_map(|line| {
            let cells: Option<Vec<f64>> = line.split(',').map(|cell| cell.trim().parse().ok()).collect();
            match cells?[..] {
                [mass, px, py, ox, oy, ..] => Some(Row {
                    mass: mass * 1e-3,
                    predicted: [px * 10.0, py * 10.0],
                    observed: [ox * 10.0, oy * 10.0],
                }),
                _ => None,
            }
        })
        .collect()
}

/// Mounted along x, gravity along -y.
fn robot(mass: f64) -> Robot {
    let section = CrossSection::Round { diameter: DIAMETER };
    let mut robot = rod(LENGTH, material(YOUNGS_MODULUS, 0.3), prismatic(section));
    robot.sections[0].material.density = WEIGHT / (GRAVITY * 0.25 * PI * DIAMETER.powi(2));
    robot.gravity = -GRAVITY * Vector3::y();
    robot.loads = vec![Load { name: None, kind: LoadKind::Mass { at: LENGTH, mass } }];
    robot
}

#[cfg(test)]
mod tests {
    /// The thesis prints eleven rows; its own errors have a mean of 2.43 mm.
    #[test]
    fn table_is_complete() {
        let rows = super::table();
        assert_eq!(rows.len(), 11);
        assert!((rows[10].mass - 0.0417).abs() < 1e-12 && (rows[10].observed[1] + 269.0).abs() < 1e-9);
    }
}
