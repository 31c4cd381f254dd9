//! Whether rows next to each other err alike: a test that sees sizes and directions, where runs see signs alone.

use super::CalibratedRow;
use crate::numeric::random::Random;
use crate::verify::Experiment;
use rayon::prelude::*;

/// With fewer rows every order is much like any other.
const FEWEST_ROWS: usize = 6;
/// Random orders; they leave a fifth of a percent of error in a chance of 5 %.
const ORDERS: usize = 9_999;
/// Parts of them, on all cores.
const BLOCKS: usize = 9;
const _: () = assert!(ORDERS.is_multiple_of(BLOCKS), "every order belongs to a block");

/// How rows next to each other err.
pub(super) struct Alike {
    /// By what they are ordered: the column of the one input that varies, or the order of the table.
    pub(super) along: String,
    /// Chance of neighbours so much alike in a random order, theory (50).
    pub(super) chance: f64,
    /// Of the residuals of neighbours.
    pub(super) correlation: f64,
}

/// None with few rows.
pub(super) fn alike(experiment: &Experiment, rows: &[CalibratedRow]) -> Option<Alike> {
    let varies = |input: &usize| rows.iter().any(|row| row.inputs[*input] != rows[0].inputs[*input]);
    let varied: Vec<usize> = (0..experiment.inputs.len()).filter(varies).collect();
    if rows.len() < FEWEST_ROWS {
        return None;
    }
    let mut order: Vec<&CalibratedRow> = rows.iter().collect();
    let along = match varied[..] {
        [input] => {
            order.sort_by(|a, b| a.inputs[input].total_cmp(&b.inputs[input]));
            experiment.inputs[input].column.clone()
        }
        _ => "the order of the rows".to_owned(),
    };
    let rows: Vec<Vec<f64>> = order.iter().map(|row| in_reading_errors(experiment, row)).collect();
    let column = |k: usize| rows.iter().map(|row| row[k]).collect();
    let residuals = Residuals { columns: (0..rows[0].len()).map(column).collect() };
    Some(Alike { along, chance: residuals.chance(), correlation: residuals.correlation() })
}

fn in_reading_errors(experiment: &Experiment, row: &CalibratedRow) -> Vec<f64> {
    let points = experiment.points.iter().zip(&row.after);
    points
        .flat_map(|(point, error)| {
            let off = error.predicted - error.observed;
            point.axes.iter().map(move |&axis| off[axis] / point.reading_error)
        })
        .collect()
}

/// In reading errors, (coordinates x rows).
struct Residuals {
    columns: Vec<Vec<f64>>,
}

/// Part of the squares by which rounding may tell equal sums apart.
const ROUNDING: f64 = 1e-12;

impl Residuals {
    fn rows(&self) -> Vec<usize> {
        (0..self.columns.first().map_or(0, Vec::len)).collect()
    }

    fn squares(&self) -> f64 {
        self.columns.iter().flatten().map(|r| r * r).sum()
    }

    /// Sum over rows that are next to each other in an order, theory (50).
    fn likeness(&self, order: &[usize]) -> f64 {
        let mut sum = 0.0;
        for column in &self.columns {
            let mut last = 0.0;
            for &row in order {
                sum += last * column[row];
                last = column[row];
            }
        }
        sum
    }

    fn correlation(&self) -> f64 {
        self.likeness(&self.rows()) / self.squares().max(f64::MIN_POSITIVE)
    }

    fn chance(&self) -> f64 {
        let found = self.likeness(&self.rows()) - ROUNDING * self.squares();
        let as_much = |block| {
            // the same orders at every run
            let (mut order, mut random) = (self.rows(), Random::new(0, block));
            let mut as_much = 0;
            for _ in 0..ORDERS / BLOCKS {
                for i in (1..order.len()).rev() {
                    order.swap(i, random.below(i as u64 + 1) as usize);
                }
                as_much += usize::from(self.likeness(&order) >= found);
            }
            as_much
        };
        let as_much: usize = (0..BLOCKS).into_par_iter().map(as_much).sum();
        (as_much + 1) as f64 / (ORDERS + 1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_agrees_with_counting_every_order() {
        let values = [1.0, 4.0, 2.0, 0.0];
        let mut as_much = 0;
        for a in 0..4 {
            for b in (0..4).filter(|b| *b != a) {
                for c in (0..4).filter(|c| ![a, b].contains(c)) {
                    let d = 6 - a - b - c;
                    let sum = values[a] * values[b] + values[b] * values[c] + values[c] * values[d];
                    as_much += usize::from(sum >= 12.0);
                }
            }
        }
        let found = Residuals { columns: vec![values.to_vec()] }.chance();
        assert!((found - as_much as f64 / 24.0).abs() < 0.015, "{found} {as_much}");
    }
}
