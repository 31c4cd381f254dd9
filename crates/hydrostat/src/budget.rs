//! How much each tolerance of a robot and its bench moves what is measured.

mod usual;
mod verdict;

pub(crate) use usual::GRID_TILT;
pub use usual::usual;

use crate::Error;
use crate::calibrate::{Parameter, Points, Problem, predictions, sensitivities, start};
use crate::numeric::random::Random;
use crate::statics::Settings;
use crate::verify::{Experiment, Summary};
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// What is not known exactly, and how well.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// As the user wrote it.
    pub name: String,
    pub of: Source,
    /// Standard deviation, SI.
    pub deviation: f64,
}

/// What a tolerance is of.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    Parameter(Parameter),
    /// Turns the grid on which points are read about an axis of the bench (0 x, 1 y, 2 z), through its origin; robot and gravity stay.
    GridTilt {
        axis: usize,
    },
}

/// The outcome of [`budget`].
#[derive(Clone, Debug)]
pub struct Budget {
    /// The largest first.
    pub contributions: Vec<Contribution>,
    /// Of all together.
    pub total: Displacement,
    /// What `verify` finds: errors (rows x points), m, and their summary.
    pub errors: Vec<Vec<f64>>,
    pub verified: Summary,
    /// Chance that the tolerances leave a mean error at least as large as the one that was found.
    pub chance_of_mean: f64,
    /// Of the residuals, against what tolerances and reading leave together, theory (62).
    pub chi_square: f64,
    pub degrees_of_freedom: usize,
    /// Chance of so large a chi-square.
    pub chance_of_shape: f64,
    pub samples: usize,
    pub seed: u64,
    /// Samples of all together that have no solution.
    pub failed: usize,
    /// In words: what dominates, where first order is not enough, whether the tolerances explain the model's error.
    pub verdict: Vec<String>,
}

/// The part of one tolerance, or of reading.
#[derive(Clone, Debug)]
pub struct Contribution {
    /// None is reading.
    pub tolerance: Option<Tolerance>,
    /// That of the files, SI; None for reading.
    pub value: Option<f64>,
    pub displacement: Displacement,
    /// Of the total, by squares and to first order.
    pub share: f64,
}

/// Standard deviations of the predicted points over the axes that are read, m.
#[derive(Clone, Debug)]
pub struct Displacement {
    /// (rows x points)
    pub first_order: Vec<Vec<f64>>,
    /// (rows x points)
    pub monte_carlo: Vec<Vec<f64>>,
    /// Root mean square over rows and points.
    pub rms_first_order: f64,
    pub rms_monte_carlo: f64,
    /// Standard error of `rms_monte_carlo` from the number of samples, at most.
    pub sampling_error: f64,
}

impl Tolerance {
    /// Unit of SI.
    pub fn unit(&self) -> &'static str {
        match &self.of {
            Source::Parameter(parameter) => parameter.unit(),
            Source::GridTilt { .. } => "rad",
        }
    }

    /// A value or a deviation for people.
    pub fn show(&self, value: f64) -> String {
        match &self.of {
            // two digits of the deviation
            Source::Parameter(parameter) => parameter.show(value, Some(self.deviation)),
            Source::GridTilt { .. } => format!("{:.2} deg", value.to_degrees()),
        }
    }
}

impl Contribution {
    pub fn name(&self) -> &str {
        self.tolerance.as_ref().map_or(READING, |tolerance| &tolerance.name)
    }
}

/// The name of the reading error among the contributions.
pub const READING: &str = "reading_error";

/// Fewer samples say nothing of a root mean square, more are hours.
const SAMPLES: [usize; 2] = [20, 1_000_000];
/// Standard deviations that a quantity must be from what is impossible for it.
const FROM_IMPOSSIBLE: f64 = 4.0;

/// Tip error of every tolerance, row by row, theory (60) and (61): to first order and by Monte Carlo.
///
/// # Errors
/// No tolerance, two of the same quantity, one that reaches impossible values; a row that cannot be solved; most samples without solution.
pub fn budget(
    experiment: &Experiment,
    tolerances: &[Tolerance],
    samples: usize,
    seed: u64,
    settings: &Settings,
) -> Result<Budget, Error> {
    if !(SAMPLES[0]..=SAMPLES[1]).contains(&samples) {
        return Err(Error::new(format!(
            "found {samples} samples, expected {} to {}",
            SAMPLES[0], SAMPLES[1]
        )));
    }
    let bench = Bench::new(experiment, tolerances, settings)?;
    let draws: Vec<Vec<f64>> =
        (0..tolerances.len()).map(|j| Random::new(seed, j).normal_strata(samples)).collect();

    let mut contributions = vec![bench.reading()];
    for (j, tolerance) in tolerances.iter().enumerate() {
        let sample = bench
            .sample(&[(j, &draws[j])], settings)
            .map_err(|error| error.within(&format!("tolerance {}", tolerance.name)))?;
        contributions.push(bench.contribution(j, &sample));
    }
    let all: Vec<(usize, &Vec<f64>)> = draws.iter().enumerate().collect();
    let sample = bench.sample(&all, settings)?;
    let total = bench.total(&contributions, &sample);
    let square = total.rms_first_order.powi(2);
    for contribution in &mut contributions {
        contribution.share = contribution.displacement.rms_first_order.powi(2) / square;
    }
    contributions.sort_by(|a, b| b.displacement.rms_monte_carlo.total_cmp(&a.displacement.rms_monte_carlo));

    let rows = experiment.rows.iter().zip(&bench.nominal);
    let errors = rows.map(|(row, points)| experiment.differences(row, points)).collect::<Vec<_>>();
    let verified = experiment.summary(experiment.robot.length(), errors.iter().flatten().copied());
    let mut random = Random::new(seed, tolerances.len());
    let (chi_square, degrees_of_freedom) = bench.chi_square();
    let mut budget = Budget {
        contributions,
        total,
        errors: errors.iter().map(|row| row.iter().map(|point| point.error).collect()).collect(),
        verified,
        chance_of_mean: bench.chance_of_mean(&sample, verified.mean, &mut random),
        chi_square,
        degrees_of_freedom,
        chance_of_shape: ChiSquared::new(degrees_of_freedom as f64)
            .map_or(f64::NAN, |distribution| distribution.sf(chi_square)),
        samples,
        seed,
        failed: samples - sample.len(),
        verdict: Vec::new(),
    };
    budget.verdict = verdict::verdict(experiment, &budget);
    Ok(budget)
}

/// The bench as the files have it, and how it answers each tolerance.
struct Bench<'a> {
    experiment: &'a Experiment,
    tolerances: &'a [Tolerance],
    /// Its parameters are those of the tolerances that have one.
    problem: Problem,
    /// Per tolerance, the index of its parameter.
    parameter: Vec<Option<usize>>,
    values: Vec<f64>,
    nominal: Points,
    /// Per standard deviation (coordinates x tolerances), in the order of rows, points, axes.
    derivatives: DMatrix<f64>,
}

impl<'a> Bench<'a> {
    fn new(
        experiment: &'a Experiment,
        tolerances: &'a [Tolerance],
        settings: &Settings,
    ) -> Result<Bench<'a>, Error> {
        experiment.refuse_impossible_readings()?;
        refuse_twice(tolerances)?;
        let mut parameters = Vec::new();
        let index = |tolerance: &Tolerance| {
            let Source::Parameter(parameter) = &tolerance.of else { return None };
            parameters.push(parameter.clone());
            Some(parameters.len() - 1)
        };
        let parameter = tolerances.iter().map(index).collect();
        let problem = Problem::new(experiment.clone(), parameters);
        let values = start(&problem)?;
        let bench = Bench {
            experiment,
            tolerances,
            parameter,
            nominal: predictions(&problem, std::slice::from_ref(&values), settings)?.swap_remove(0)?,
            values,
            derivatives: DMatrix::zeros(0, 0),
            problem,
        };
        bench.refuse_impossible()?;
        let derivatives = bench.derivatives(settings)?;
        Ok(Bench { derivatives, ..bench })
    }

    /// Draws must not ask for a rod without stiffness.
    fn refuse_impossible(&self) -> Result<(), Error> {
        for (tolerance, parameter) in self.tolerances.iter().zip(&self.parameter) {
            let Some(j) = *parameter else { continue };
            let value = self.values[j];
            let above_zero = self.problem.parameters[j].bounds[0] > 0.0;
            if above_zero && FROM_IMPOSSIBLE * tolerance.deviation > value {
                return Err(Error::new(format!(
                    "a tolerance of {} on {} = {}, which must stay above 0, expected a quarter of the value at most",
                    tolerance.show(tolerance.deviation),
                    tolerance.name,
                    tolerance.show(value)
                ))
                .hint("a tolerance is a standard deviation: two thirds of what is made lies within it"));
            }
        }
        Ok(())
    }

    /// Row, point, axis of everything that was read.
    fn coordinates(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let points = &self.experiment.points;
        (0..self.experiment.rows.len()).flat_map(move |row| {
            points
                .iter()
                .enumerate()
                .flat_map(move |(i, point)| point.axes.iter().map(move |&axis| (row, i, axis)))
        })
    }

    fn derivatives(&self, settings: &Settings) -> Result<DMatrix<f64>, Error> {
        let of_parameters = match self.problem.parameters.is_empty() {
            true => DMatrix::zeros(self.coordinates().count(), 0),
            false => sensitivities(&self.problem, settings)?.1,
        };
        let columns: Vec<DVector<f64>> = self
            .tolerances
            .iter()
            .zip(&self.parameter)
            .map(|(tolerance, parameter)| {
                let column = match (&tolerance.of, parameter) {
                    (_, Some(j)) => of_parameters.column(*j).into_owned(),
                    (Source::GridTilt { axis }, _) => {
                        let turn = Vector3::ith(*axis, 1.0);
                        let of =
                            |(row, i, axis): (usize, usize, usize)| -turn.cross(&self.nominal[row][i])[axis];
                        DVector::from_vec(self.coordinates().map(of).collect())
                    }
                    (Source::Parameter(_), None) => unreachable!("every parameter has its index"),
                };
                column * tolerance.deviation
            })
            .collect();
        Ok(DMatrix::from_columns(&columns))
    }

    /// Points with these tolerances drawn, each in standard deviations; samples without a solution are left out.
    fn sample(&self, drawn: &[(usize, &Vec<f64>)], settings: &Settings) -> Result<Vec<Points>, Error> {
        let samples = drawn.iter().map(|(_, draws)| draws.len()).min().unwrap_or(0);
        let set = |i: usize| {
            let mut values = self.values.clone();
            for (j, draws) in drawn {
                let Some(k) = self.parameter[*j] else { continue };
                let lowest = self.problem.parameters[k].bounds[0];
                let value = values[k] + self.tolerances[*j].deviation * draws[i];
                // what may not be negative is mirrored, which keeps the size of its changes
                values[k] = if value < lowest { 2.0 * lowest - value } else { value };
            }
            values
        };
        let of_robot = drawn.iter().any(|(j, _)| self.parameter[*j].is_some());
        let found = match of_robot {
            true => predictions(&self.problem, &(0..samples).map(set).collect::<Vec<_>>(), settings)?,
            false => (0..samples).map(|_| Ok(self.nominal.clone())).collect(),
        };
        let first_error = found.iter().find_map(|points| points.as_ref().err()).cloned();
        let mut solved = Vec::with_capacity(samples);
        for (i, points) in found.into_iter().enumerate() {
            solved.extend(points.ok().map(|points| self.on_grid(drawn, i, points)));
        }
        match first_error {
            Some(error) if 2 * solved.len() < samples => Err(error.within(&format!(
                "only {} of {samples} samples have a solution; the first without",
                solved.len()
            ))),
            _ => Ok(solved),
        }
    }

    /// As read on a grid that is tilted.
    fn on_grid(&self, drawn: &[(usize, &Vec<f64>)], i: usize, mut points: Points) -> Points {
        let mut tilt = Vector3::zeros();
        for (j, draws) in drawn {
            if let Source::GridTilt { axis } = self.tolerances[*j].of {
                tilt[axis] += self.tolerances[*j].deviation * draws[i];
            }
        }
        let grid = Rotation3::new(-tilt);
        points.iter_mut().flatten().for_each(|point| *point = grid * *point);
        points
    }

    /// Square of a length over the axes of a point that are read.
    fn square(&self, point: usize, away: &Vector3<f64>) -> f64 {
        self.experiment.points[point].axes.iter().map(|&axis| away[axis].powi(2)).sum()
    }

    /// Mean over rows and points.
    fn mean(&self, of: impl Fn(usize, usize) -> f64) -> f64 {
        let (rows, points) = (self.experiment.rows.len(), self.experiment.points.len());
        let sum: f64 =
            (0..rows).flat_map(|row| (0..points).map(move |i| (row, i))).map(|(r, i)| of(r, i)).sum();
        sum / (rows * points) as f64
    }

    /// (rows x points)
    fn table(&self, of: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
        let points = self.experiment.points.len();
        (0..self.experiment.rows.len()).map(|row| (0..points).map(|i| of(row, i)).collect()).collect()
    }

    /// From the squares of a first-order and a sampled displacement, and how surely the samples tell their mean.
    fn displacement(
        &self,
        first_order: impl Fn(usize, usize) -> f64,
        monte_carlo: impl Fn(usize, usize) -> f64,
        error_of_square: f64,
    ) -> Displacement {
        let rms = [self.mean(&first_order).sqrt(), self.mean(&monte_carlo).sqrt()];
        Displacement {
            first_order: self.table(|row, i| first_order(row, i).sqrt()),
            monte_carlo: self.table(|row, i| monte_carlo(row, i).sqrt()),
            rms_first_order: rms[0],
            rms_monte_carlo: rms[1],
            sampling_error: if rms[1] > 0.0 { error_of_square / (2.0 * rms[1]) } else { 0.0 },
        }
    }

    /// Squares of a sample: per row and point, and the standard error of their mean.
    fn squares(&self, sample: &[Points]) -> (Vec<Vec<f64>>, f64) {
        let count = sample.len() as f64;
        let away =
            |points: &Points, row: usize, i: usize| self.square(i, &(points[row][i] - self.nominal[row][i]));
        let squares =
            self.table(|row, i| sample.iter().map(|points| away(points, row, i)).sum::<f64>() / count);
        let means: Vec<f64> = sample.iter().map(|points| self.mean(|row, i| away(points, row, i))).collect();
        let mean = means.iter().sum::<f64>() / count;
        let spread = means.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        (squares, (spread / count).sqrt())
    }

    fn contribution(&self, j: usize, sample: &[Points]) -> Contribution {
        let first_order = self.first_order(j);
        let (squares, error) = self.squares(sample);
        let tolerance = self.tolerances[j].clone();
        Contribution {
            value: Some(self.parameter[j].map_or(0.0, |k| self.values[k])),
            tolerance: Some(tolerance),
            displacement: self.displacement(|r, i| first_order[r][i], |r, i| squares[r][i], error),
            share: 0.0,
        }
    }

    /// Squares (rows x points).
    fn first_order(&self, j: usize) -> Vec<Vec<f64>> {
        let mut squares = self.table(|_, _| 0.0);
        for (k, (row, i, _)) in self.coordinates().enumerate() {
            squares[row][i] += self.derivatives[(k, j)].powi(2);
        }
        squares
    }

    /// Reading is linear: its parts need no samples.
    fn reading(&self) -> Contribution {
        let square = |_: usize, i: usize| self.reading_square(i);
        Contribution {
            tolerance: None,
            value: None,
            displacement: self.displacement(square, square, 0.0),
            share: 0.0,
        }
    }

    fn reading_square(&self, point: usize) -> f64 {
        let point = &self.experiment.points[point];
        point.axes.len() as f64 * point.reading_error.powi(2)
    }

    /// All together, theory (60): squares add up to first order; the sample has all but reading, which is independent of it.
    fn total(&self, contributions: &[Contribution], sample: &[Points]) -> Displacement {
        let (squares, error) = self.squares(sample);
        let first_order = |row: usize, i: usize| {
            contributions.iter().map(|part| part.displacement.first_order[row][i].powi(2)).sum::<f64>()
        };
        let monte_carlo = |row: usize, i: usize| squares[row][i] + self.reading_square(i);
        self.displacement(first_order, monte_carlo, error)
    }

    /// How often a drawn bench, read with a drawn error, errs as much on average as was found.
    fn chance_of_mean(&self, sample: &[Points], found: f64, random: &mut Random) -> f64 {
        let noise: Vec<Vec<f64>> = self.coordinates().map(|_| random.normal_strata(sample.len())).collect();
        let index = self.table(|_, _| 0.0);
        let as_large = |n: usize| {
            let mut squares = index.clone();
            for ((row, i, axis), noise) in self.coordinates().zip(&noise) {
                let away = sample[n][row][i][axis] - self.nominal[row][i][axis];
                squares[row][i] += (away + self.experiment.points[i].reading_error * noise[n]).powi(2);
            }
            self.mean(|row, i| squares[row][i].sqrt()) >= found
        };
        let count = (0..sample.len()).filter(|&n| as_large(n)).count();
        (count + 1) as f64 / (sample.len() + 1) as f64
    }

    /// Theory (62): of the residuals, with the covariance that tolerances and reading give them, and its degrees of freedom.
    fn chi_square(&self) -> (f64, usize) {
        let reading: Vec<f64> =
            self.coordinates().map(|(_, i, _)| self.experiment.points[i].reading_error).collect();
        let residuals = self.coordinates().zip(&reading).map(|((row, i, axis), error)| {
            (self.experiment.rows[row].observed[i][axis] - self.nominal[row][i][axis]) / error
        });
        let residuals = DVector::from_vec(residuals.collect());
        let scaled = DMatrix::from_fn(reading.len(), self.tolerances.len(), |k, j| {
            self.derivatives[(k, j)] / reading[k]
        });
        let projected = scaled.tr_mul(&residuals);
        let inner = DMatrix::identity(self.tolerances.len(), self.tolerances.len()) + scaled.tr_mul(&scaled);
        let explained = inner.cholesky().map_or(0.0, |inner| projected.dot(&inner.solve(&projected)));
        ((residuals.norm_squared() - explained).max(0.0), reading.len())
    }
}

/// Refuses a quantity with two tolerances, and none at all.
fn refuse_twice(tolerances: &[Tolerance]) -> Result<(), Error> {
    if tolerances.is_empty() {
        return Err(Error::new("no tolerance is given, so that there is no budget"));
    }
    for (j, tolerance) in tolerances.iter().enumerate() {
        let same = |other: &&Tolerance| match (&other.of, &tolerance.of) {
            (Source::Parameter(a), Source::Parameter(b)) => a.parts.iter().any(|part| b.parts.contains(part)),
            (a, b) => a == b,
        };
        if let Some(other) = tolerances[..j].iter().find(same) {
            return Err(Error::new(format!(
                "\"{}\" and \"{}\" are tolerances of the same quantity",
                other.name, tolerance.name
            )));
        }
        if !(tolerance.deviation > 0.0 && tolerance.deviation.is_finite()) {
            return Err(Error::new(format!("a tolerance of {} on {}", tolerance.deviation, tolerance.name))
                .hint("expected a standard deviation above 0"));
        }
    }
    Ok(())
}
