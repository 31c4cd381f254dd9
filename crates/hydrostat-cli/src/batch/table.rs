//! The columns of a batch's output.

use hydrostat::batch::{Chunk, Pull, Shape};
use hydrostat::{Error, Robot};
use std::borrow::Cow;

/// Rows as columns, SI.
pub(super) struct Table {
    /// From 1.
    pub(super) row: Vec<u64>,
    pub(super) status: Vec<Cow<'static, str>>,
    /// Rows without a solution have no values in the other columns.
    pub(super) solved: Vec<bool>,
    pub(super) columns: Vec<(String, Values)>,
}

pub(super) enum Values {
    Numbers(Vec<f64>),
    /// None is not known.
    Flags(Vec<Option<bool>>),
    /// So many per row.
    #[cfg_attr(not(feature = "parquet"), expect(dead_code, reason = "CSV has no lists"))]
    Lists(usize, Vec<f64>),
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Table {
    pub(super) fn new(robot: &Robot, stations: usize, chunks: &[Chunk]) -> Table {
        let rows = || chunks.iter().flat_map(|chunk| &chunk.rows);
        let numbers = |of: &dyn Fn(&Shape) -> f64| {
            Values::Numbers(rows().map(|row| row.as_ref().map_or(f64::NAN, of)).collect())
        };
        let mut columns = Vec::new();
        for (axis, letter) in AXES.iter().enumerate() {
            columns.push((format!("tip_{letter}_m"), numbers(&|shape| shape.tip.position[axis])));
        }
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let entry = numbers(&|shape| shape.tip.rotation[(i, j)]);
            columns.push((format!("tip_r{}{}", i + 1, j + 1), entry));
        }
        for (tendon, first) in robot.tendons.iter().zip(0..) {
            let pulls = || {
                let every = robot.tendons.len();
                chunks.iter().flat_map(move |chunk| chunk.tendons.iter().skip(first).step_by(every))
            };
            let mut number = |name: &str, of: fn(&Pull) -> f64| {
                let column = format!("tendon.{}.{name}", tendon.name);
                columns.push((column, Values::Numbers(pulls().map(of).collect())));
            };
            number("tension_n", |pull| pull.tension);
            number("displacement_m", |pull| pull.displacement);
            number("length_m", |pull| pull.length);
            let slack = pulls().map(|pull| Some(pull.slack)).collect();
            columns.push((format!("tendon.{}.slack", tendon.name), Values::Flags(slack)));
        }
        let stable = rows().map(|row| row.as_ref().ok().and_then(|shape| shape.stable)).collect();
        columns.push(("stable".to_owned(), Values::Flags(stable)));
        columns.push(("error_estimate_m".to_owned(), numbers(&|shape| shape.error_estimate)));
        for (axis, letter) in AXES.iter().enumerate().filter(|_| stations > 0) {
            let positions = chunks.iter().flat_map(|chunk| &chunk.stations);
            let list = positions.map(|position| position[axis]).collect();
            columns.push((format!("stations_{letter}_m"), Values::Lists(stations, list)));
        }
        let number = || chunks.iter().flat_map(|chunk| chunk.first + 1..=chunk.first + chunk.rows.len());
        Table {
            row: number().map(|number| number as u64).collect(),
            status: rows().map(status).collect(),
            solved: rows().map(Result::is_ok).collect(),
            columns,
        }
    }
}

/// What became of a row, in one line.
pub(super) fn status(row: &Result<Shape, Error>) -> Cow<'static, str> {
    match row {
        Ok(shape) if shape.failed.is_empty() => "ok".into(),
        Ok(shape) => format!("check failed: {}", shape.failed.join(", ")).into(),
        Err(error) => format!("error: {}", error.message()).into(),
    }
}
