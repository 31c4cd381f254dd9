//! Chooses rows by their information: the exchange method.

use nalgebra::{Cholesky, DMatrix, Dyn};

/// What a design makes small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Criterion {
    /// log det of the covariance: D-optimal.
    Determinant,
    /// Sum of the variances, each over the square of its parameter's scale: A-optimal.
    Trace,
}

/// Information in units of the parameters' scales, theory (63).
pub(super) struct Information {
    /// Of the rows at hand and the priors (parameters x parameters).
    base: DMatrix<f64>,
    /// Of each candidate.
    candidates: Vec<DMatrix<f64>>,
    /// Information that stands for none, so that what is undetermined has an end: of each parameter.
    least: Vec<f64>,
}

/// Part of the largest information on a parameter that is as good as none.
const NONE: f64 = 1e-9;
/// Gain of log det or of the log of the trace that ends the exchange.
const SETTLED: f64 = 1e-9;
const MOST_PASSES: usize = 50;

impl Information {
    /// From derivatives in reading errors per scale (coordinates x parameters), and priors in scales.
    pub(super) fn new(
        measured: &DMatrix<f64>,
        priors: &[Option<f64>],
        candidates: &[DMatrix<f64>],
    ) -> Information {
        let mut base = measured.tr_mul(measured);
        for (j, prior) in priors.iter().enumerate() {
            base[(j, j)] += prior.map_or(0.0, |error| error.powi(-2));
        }
        let candidates: Vec<DMatrix<f64>> = candidates.iter().map(|rows| rows.tr_mul(rows)).collect();
        let least = (0..priors.len())
            .map(|j| {
                let largest = candidates.iter().map(|own| own[(j, j)]).fold(base[(j, j)], f64::max);
                if largest > 0.0 { NONE * largest } else { 1.0 }
            })
            .collect();
        Information { base, candidates, least }
    }

    /// Greedy, then one exchange after the other while it helps (Fedorov 1972); the row that tells most alone first.
    pub(super) fn choose(&self, criterion: Criterion, count: usize) -> Vec<usize> {
        let mut chosen: Vec<usize> = Vec::new();
        for _ in 0..count {
            let (next, _) = self.best(criterion, &self.with(&chosen));
            chosen.push(next);
        }
        let mut value = self.value(criterion, &self.with(&chosen));
        for _ in 0..MOST_PASSES {
            let before = value;
            for place in 0..count {
                let mut others = chosen.clone();
                others.remove(place);
                let (next, better) = self.best(criterion, &self.with(&others));
                if better < value - SETTLED {
                    (chosen[place], value) = (next, better);
                }
            }
            if value >= before - SETTLED {
                break;
            }
        }
        self.ordered(criterion, chosen)
    }

    /// Volume of the confidence region over that without these rows.
    pub(super) fn volume(&self, chosen: &[usize]) -> f64 {
        let value = |chosen: &[usize]| self.value(Criterion::Determinant, &self.with(chosen));
        (0.5 * (value(chosen) - value(&[]))).exp()
    }

    fn with(&self, chosen: &[usize]) -> DMatrix<f64> {
        chosen.iter().fold(self.base.clone(), |sum, &k| sum + &self.candidates[k])
    }

    /// The candidate that makes the criterion smallest beside `base`; of equals the first.
    fn best(&self, criterion: Criterion, base: &DMatrix<f64>) -> (usize, f64) {
        let mut best = (0, f64::INFINITY);
        for (k, candidate) in self.candidates.iter().enumerate() {
            let value = self.value(criterion, &(base + candidate));
            if value < best.1 - SETTLED {
                best = (k, value);
            }
        }
        best
    }

    fn value(&self, criterion: Criterion, information: &DMatrix<f64>) -> f64 {
        let mut all = information.clone();
        for (j, least) in self.least.iter().enumerate() {
            all[(j, j)] += least;
        }
        let Some(factor) = Cholesky::new(all) else { return f64::INFINITY };
        match criterion {
            Criterion::Determinant => -log_determinant(&factor),
            Criterion::Trace => factor.inverse().trace().ln(),
        }
    }

    /// The same rows, each the best of those that are left.
    fn ordered(&self, criterion: Criterion, mut left: Vec<usize>) -> Vec<usize> {
        let mut ordered = Vec::with_capacity(left.len());
        left.sort_unstable();
        while !left.is_empty() {
            let base = self.with(&ordered);
            let value = |k: usize| self.value(criterion, &(&base + &self.candidates[k]));
            let place = (0..left.len()).min_by(|&a, &b| value(left[a]).total_cmp(&value(left[b])));
            ordered.push(left.remove(place.unwrap_or(0)));
        }
        ordered
    }
}

fn log_determinant(factor: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|pivot| pivot.ln()).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;

    /// All pairs and triples of 30 candidates with 3 parameters.
    #[test]
    fn exchange_finds_the_best_sets() {
        const COUNT: usize = 30;
        let mut random = Random::new(5, 0);
        let mut matrix = |rows| DMatrix::from_fn(rows, 3, |_, _| random.uniform(-1.0, 1.0));
        let measured = matrix(2);
        let candidates: Vec<DMatrix<f64>> = (0..COUNT).map(|_| matrix(2)).collect();
        let information = Information::new(&measured, &[None, Some(2.0), None], &candidates);
        for criterion in [Criterion::Determinant, Criterion::Trace] {
            let value = |chosen: &[usize]| information.value(criterion, &information.with(chosen));
            let mut best = [f64::INFINITY; 2];
            for a in 0..COUNT {
                for b in 0..=a {
                    best[0] = best[0].min(value(&[a, b]));
                    for c in 0..=b {
                        best[1] = best[1].min(value(&[a, b, c]));
                    }
                }
            }
            for (count, best) in [(2, best[0]), (3, best[1])] {
                let found = value(&information.choose(criterion, count));
                assert!(found <= best + 1e-9, "{criterion:?}, {count}: {found} {best}");
            }
        }
    }
}
