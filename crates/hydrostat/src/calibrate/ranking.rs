//! What of a large calibration to look at first.

use super::{CalibratedRow, Calibration};

impl Calibration {
    /// Numbers of the rows, from 0, by their largest error after the fit, largest first.
    pub fn rows_by_error(&self) -> Vec<usize> {
        let largest = |row: &CalibratedRow| row.after.iter().map(|point| point.error).fold(0.0, f64::max);
        let mut numbers: Vec<usize> = (0..self.rows.len()).collect();
        numbers.sort_by(|&a, &b| largest(&self.rows[b]).total_cmp(&largest(&self.rows[a])));
        numbers
    }

    /// Pairs of different parameters that have a correlation, strongest first.
    pub fn pairs_by_correlation(&self) -> Vec<(usize, usize)> {
        let size = |pair: &(usize, usize)| self.correlation[*pair].abs();
        let pairs = (0..self.parameters.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
        let mut pairs: Vec<(usize, usize)> = pairs.filter(|pair| size(pair).is_finite()).collect();
        pairs.sort_by(|a, b| size(b).total_cmp(&size(a)));
        pairs
    }
}
