//! Chooses rows by their information: the exchange method.

use crate::calibrate::LEAST_INFLUENCE;
use crate::numeric::random::Random;
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
}

/// Information on a parameter that is as good as none: with it, what is undetermined has an end.
const NONE: f64 = LEAST_INFLUENCE * LEAST_INFLUENCE;
/// Gain of log det or of the log of the trace that ends the exchange.
const SETTLED: f64 = 1e-9;
const MOST_PASSES: usize = 50;
/// An exchange may end in a corner that only two rows at once would leave.
const RANDOM_STARTS: usize = 10;

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
        Information { base, candidates }
    }

    /// The best that exchange finds from a greedy start and from random ones (Fedorov 1972); the row that tells most alone first. Fewer than
    /// `count` where no more may be repeated.
    pub(super) fn choose(&self, criterion: Criterion, count: usize, repeats: usize) -> Vec<usize> {
        // more than `count` of one row are never chosen
        let repeats = repeats.min(count);
        let all = self.candidates.len() * repeats;
        let count = count.min(all);
        let mut greedy: Vec<usize> = Vec::new();
        for _ in 0..count {
            greedy.push(self.best(criterion, &greedy, repeats).0);
        }
        let random = (0..RANDOM_STARTS).map(|i| {
            let mut random = Random::new(0, i);
            let mut left: Vec<usize> = (0..all).map(|k| k / repeats).collect();
            (0..count).map(|_| left.swap_remove(random.below(left.len() as u64) as usize)).collect()
        });
        let starts = std::iter::once(greedy).chain(random);
        let ends = starts.map(|start| self.exchanged(criterion, start, repeats));
        let best = ends.reduce(|best, next| if next.1 < best.1 - SETTLED { next } else { best });
        self.ordered(criterion, best.map(|(chosen, _)| chosen).unwrap_or_default())
    }

    /// One row for another while it helps.
    fn exchanged(&self, criterion: Criterion, mut chosen: Vec<usize>, repeats: usize) -> (Vec<usize>, f64) {
        let mut value = self.value(criterion, &self.with(&chosen));
        for _ in 0..MOST_PASSES {
            let before = value;
            for place in 0..chosen.len() {
                let mut others = chosen.clone();
                others.remove(place);
                let (next, better) = self.best(criterion, &others, repeats);
                if better < value - SETTLED {
                    (chosen[place], value) = (next, better);
                }
            }
            if value >= before - SETTLED {
                break;
            }
        }
        (chosen, value)
    }

    /// Volume of the confidence region over that without these rows.
    pub(super) fn volume(&self, chosen: &[usize]) -> f64 {
        let value = |chosen: &[usize]| self.value(Criterion::Determinant, &self.with(chosen));
        (0.5 * (value(chosen) - value(&[]))).exp()
    }

    fn with(&self, chosen: &[usize]) -> DMatrix<f64> {
        chosen.iter().fold(self.base.clone(), |sum, &k| sum + &self.candidates[k])
    }

    /// The candidate that makes the criterion smallest beside others, among which it may not be too often; of equals the first.
    fn best(&self, criterion: Criterion, others: &[usize], repeats: usize) -> (usize, f64) {
        let base = self.with(others);
        let may = |k: &usize| others.iter().filter(|other| *other == k).count() < repeats;
        let mut best: Option<(usize, f64)> = None;
        for k in (0..self.candidates.len()).filter(may) {
            let value = self.value(criterion, &(&base + &self.candidates[k]));
            if best.is_none_or(|(_, least)| value < least - SETTLED) {
                best = Some((k, value));
            }
        }
        best.expect("no more rows are chosen than may be")
    }

    fn value(&self, criterion: Criterion, information: &DMatrix<f64>) -> f64 {
        let none = DMatrix::from_diagonal_element(information.nrows(), information.ncols(), NONE);
        let Some(factor) = Cholesky::new(information + none) else { return f64::INFINITY };
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
            for repeats in [1, 3] {
                let mut best = [f64::INFINITY; 2];
                let fewer = |a: usize| if repeats == 1 { a } else { a + 1 };
                for a in 0..COUNT {
                    for b in 0..fewer(a) {
                        best[0] = best[0].min(value(&[a, b]));
                        for c in 0..fewer(b) {
                            best[1] = best[1].min(value(&[a, b, c]));
                        }
                    }
                }
                for (count, best) in [(2, best[0]), (3, best[1])] {
                    let found = value(&information.choose(criterion, count, repeats));
                    assert!(
                        (found - best).abs() <= 1e-9,
                        "{criterion:?}, {count}, {repeats}: {found} {best}"
                    );
                }
            }
        }
        assert_eq!(information.choose(Criterion::Trace, 70, 2).len(), 60);
        let all = |repeats| information.choose(Criterion::Determinant, 3, repeats);
        assert_eq!(all(usize::MAX), all(3));
    }
}
