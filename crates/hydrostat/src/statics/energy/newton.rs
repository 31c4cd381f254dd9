//! Newton's method for the stationary energy, with the held tendons' lengths as constraints.

use super::mesh::Mesh;
use super::sweep::{Column, Folded, Problem, Step, Sweep};
use super::tendons::{self, Drive};
use super::{Memory, Tables};
use crate::Robot;
use crate::numeric::{larger, nonnegative};
use crate::statics::chain::Chain;
use nalgebra::{DMatrix, DVector, Vector3};

/// One linearisation with its right-hand sides: the gradient, and the length of each held tendon.
#[derive(Clone, Debug, Default)]
pub(super) struct Linear {
    /// Minus the energy's gradient.
    pub(super) downhill: Column,
    /// Bows of the panels that it asks for.
    pub(super) bows: Vec<Vector3<f64>>,
    length: Column,
    lengths: Vec<Folded>,
    pull: Column,
    pub(super) step: Step,
    responses: Vec<Step>,
    /// Length that the held tendons give per tension of each, theory (36); as old as the factors.
    border: DMatrix<f64>,
    /// New tensions of the held tendons.
    pub(super) tensions: Vec<f64>,
    /// Length that each held tendon gives per tension, by the robot and by itself.
    pub(super) compliances: Vec<f64>,
}

/// What one linearisation found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linearised {
    /// Largest rotation of the step, rad, or relative change of a tension's bending.
    pub(super) correction: f64,
    /// Turn that the change of the bows adds to a node, which the shape has not answered yet, rad.
    bowing: f64,
    pub(super) residual: f64,
    /// Directions in which the energy falls while the held tendons stay as they are.
    pub(super) negative: Option<usize>,
}

/// Newton's corrections must shrink at least by this factor, or the start is too far for the same branch.
const CONTRACTION: f64 = 0.5;
/// .. or the residual, where they are below this, rad.
const SMALL: f64 = 1e-2;
const MAX_ITERATIONS: usize = 50;
/// Of two iterations, how much faster than linear: correction_(k+1) < QUADRATIC correction_k^2.
const QUADRATIC: f64 = 10.0;
const QUADRATIC_AT_FIRST: f64 = 100.0;
/// Size of the corrections that rounding may cause, and of the residual that it leaves.
const ROUNDING_CORRECTION: f64 = 1e-9;
const ROUNDING_RESIDUAL: f64 = 1e-8;

/// Curvatures below this part of the largest are rounding.
const SMALLEST_CURVATURE: f64 = 1e-12;
/// How far steps with the same factors may lead in all, rad, and by how much each must be smaller than the one before.
pub(super) const NEAR: f64 = 0.05;
const SHRINKING: f64 = 0.1;
/// How much slower than the last step with the same factors the next may be.
const SLOWER: f64 = 4.0;
/// Residual over correction from which on a step is taken to have cancelled.
const CANCELLED: f64 = 5.0;

/// What Newton's method begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Begin {
    Anew,
    /// The factors at hand, where they are of this mesh.
    WithFactors,
    /// The same, and the shape that was placed last.
    Placed,
}

/// A converged iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Converged {
    pub(super) residual: f64,
    /// Directions in which the energy fell where the factors were made, and how far the shape has moved since then, rad; infinity
    /// where they were those of another robot or load.
    pub(super) negative: usize,
    pub(super) moved: f64,
    /// Of the first two corrections; 0 where one was enough.
    pub(super) contraction: f64,
    /// Most directions in which the energy fell at a shape on the way.
    pub(super) most_negative: usize,
}

/// Why an iteration ended without converging.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stuck {
    pub(super) correction: f64,
}

/// The equations at one part of the loads.
pub(super) struct Equations<'a> {
    pub(super) robot: &'a Robot,
    pub(super) chain: &'a Chain,
    pub(super) tables: &'a Tables,
    pub(super) factor: f64,
}

impl Equations<'_> {
    pub(super) fn problem<'b>(&'b self, tensions: &'b [f64]) -> Problem<'b> {
        Problem {
            chain: self.chain,
            tables: self.tables,
            factor: self.factor,
            gravity: self.robot.gravity,
            tensions,
        }
    }

    /// Linearises at the mesh's shape and solves for the step; `shift` makes the elastic part of the Hessian larger.
    pub(super) fn linearise(&self, memory: &mut Memory, mesh: &mut Mesh, shift: f64) -> Linearised {
        let residual = self.evaluate(memory, mesh);
        self.factor_and_step(memory, mesh, residual, shift)
    }

    /// As [`Equations::linearise`] at the shape that was evaluated last.
    fn factor_and_step(&self, memory: &mut Memory, mesh: &Mesh, residual: f64, shift: f64) -> Linearised {
        let negative = memory.sweep.factor(&self.problem(&memory.drive.tensions), mesh, shift);
        self.step(memory, mesh, residual, negative, false)
    }

    /// Places the shape and finds the gradient there, kept with its sign changed. Returns its size.
    fn evaluate(&self, memory: &mut Memory, mesh: &mut Mesh) -> f64 {
        self.place(&mut memory.sweep, &mut memory.drive, mesh);
        self.evaluate_placed(memory, mesh)
    }

    /// The same at the shape that was placed last.
    pub(super) fn evaluate_placed(&self, memory: &mut Memory, mesh: &Mesh) -> f64 {
        let Memory { sweep, linear, drive } = memory;
        drive.apply(self.robot, self.factor);
        let problem = self.problem(&drive.tensions);
        sweep.gradient(&problem, mesh, &mut linear.downhill);
        let residual = sweep.largest_of(&problem, mesh, &linear.downhill);
        linear.downhill.negate();
        residual
    }

    /// Places the shape and measures the tendons on it.
    pub(super) fn place(&self, sweep: &mut Sweep, drive: &mut Drive, mesh: &mut Mesh) {
        sweep.place(mesh, self.tables);
        tendons::measure(mesh, sweep, &mut drive.lengths, self.robot.tendons.len());
        drive.lengths.iter_mut().zip(&drive.left_out).for_each(|(length, more)| *length += more);
    }

    /// What is left of the equations at the placed shape.
    pub(super) fn residual(&self, memory: &mut Memory, mesh: &Mesh) -> f64 {
        let Memory { sweep, linear, drive } = memory;
        let problem = self.problem(&drive.tensions);
        sweep.gradient(&problem, mesh, &mut linear.downhill);
        let mut residual = sweep.largest_of(&problem, mesh, &linear.downhill);
        for (&tendon, &taut) in drive.held.iter().zip(&drive.taut) {
            let excess = drive.excess(self.robot, tendon, self.factor);
            residual =
                larger(residual, if taut { excess.abs() } else { excess.max(0.0) } / self.chain.length);
        }
        residual
    }

    /// Newton's step by the factors at hand.
    fn step(
        &self,
        memory: &mut Memory,
        mesh: &Mesh,
        residual: f64,
        negative: Option<usize>,
        reused: bool,
    ) -> Linearised {
        let Memory { sweep, linear, drive } = memory;
        sweep.solve(mesh, self.tables, &linear.downhill, &mut linear.step);
        if !(reused && linear.border.nrows() == drive.held.len()) {
            self.border(sweep, linear, drive, mesh);
        }
        let held = self.hold(sweep, linear, drive, mesh);
        let bowing =
            if mesh.bows { mesh.find_bows(self.tables, &linear.downhill, &mut linear.bows) } else { 0.0 };
        Linearised {
            correction: larger(linear.step.size, held.change),
            bowing,
            residual: larger(residual, held.residual),
            negative: negative.map(|negative| negative.saturating_sub(held.negative)),
        }
    }

    /// How fast the energy falls along the last step.
    pub(super) fn slope(&self, memory: &Memory, mesh: &Mesh) -> f64 {
        let mut gradient = Folded::default();
        memory.linear.downhill.fold(&memory.sweep, mesh, self.tables, &mut gradient);
        gradient.dot(&memory.linear.step)
    }

    /// How the lengths of the held tendons answer their tensions, theory (36).
    fn border(&self, sweep: &mut Sweep, linear: &mut Linear, drive: &Drive, mesh: &Mesh) {
        let count = drive.held.len();
        linear.lengths.resize_with(count, Folded::default);
        linear.responses.resize_with(count, Step::default);
        for (i, &tendon) in drive.held.iter().enumerate() {
            tendons::length_form(mesh, sweep, tendon, false, &mut linear.length);
            linear.length.fold(sweep, mesh, self.tables, &mut linear.lengths[i]);
            tendons::length_form(mesh, sweep, tendon, true, &mut linear.pull);
            sweep.solve(mesh, self.tables, &linear.pull, &mut linear.responses[i]);
        }
        let (lengths, responses) = (&linear.lengths, &linear.responses);
        linear.border = DMatrix::from_fn(count, count, |i, j| lengths[i].dot(&responses[j]));
    }

    /// Corrects the step so that taut tendons keep their lengths, and finds their tensions (Schur complement, theory (36)).
    fn hold(&self, sweep: &mut Sweep, linear: &mut Linear, drive: &mut Drive, mesh: &Mesh) -> Held {
        let count = drive.held.len();
        linear.tensions.clear();
        if count == 0 {
            return Held::default();
        }
        let mut s = linear.border.clone();
        linear.compliances.clear();
        for (i, &tendon) in drive.held.iter().enumerate() {
            s[(i, i)] += drive.compliance(self.robot, tendon) + drive.springs.give.get(i).unwrap_or(&0.0);
            linear.compliances.push(s[(i, i)]);
        }
        let now = DVector::from_fn(count, |i, _| drive.tensions[drive.held[i]]);
        let excess = DVector::from_fn(count, |i, _| {
            drive.excess(self.robot, drive.held[i], self.factor) + drive.springs.lag(i, drive.held[i], now[i])
        });
        let right = DVector::from_fn(count, |i, _| linear.lengths[i].dot(&linear.step)) + &excess + &s * &now;
        let negative = falling(&s);
        // taut tendons pull; where the chain alone is unstable there is no minimum to find them by
        let solved = if negative == 0 {
            nonnegative::minimise(&s, &right)
        } else {
            nonnegative::complementary(&s, &right, &drive.taut)
        };
        let Some(tensions) = solved else {
            return Held { change: f64::NAN, residual: f64::NAN, negative };
        };
        // a slack tendon holds nothing
        let pulling: Vec<usize> = (0..count).filter(|&i| tensions[i] > 0.0).collect();
        let negative =
            if negative == 0 { 0 } else { falling(&s.select_rows(&pulling).select_columns(&pulling)) };
        let mut held = Held { change: 0.0, residual: 0.0, negative };
        for i in 0..count {
            let change = tensions[i] - now[i];
            linear.step.add(-change, &linear.responses[i]);
            drive.taut[i] = tensions[i] > 0.0;
            linear.tensions.push(tensions[i]);
            held.change = larger(held.change, (change * linear.responses[i].size).abs());
            // too long, or slack and yet too short to be so
            let off = if tensions[i] > 0.0 { excess[i].abs() } else { excess[i].max(0.0) };
            held.residual = larger(held.residual, off / self.chain.length);
        }
        linear.step.size = linear.step.largest(sweep, mesh);
        held
    }

    /// Adds the last step to the mesh and the tensions.
    pub(super) fn correct(&self, memory: &mut Memory, mesh: &mut Mesh) {
        let Memory { linear, drive, .. } = memory;
        for (turn, change) in mesh.turn.iter_mut().zip(&linear.step.turn) {
            *turn += change;
        }
        for (v, change) in mesh.v.iter_mut().zip(&linear.step.v) {
            *v += change;
        }
        if mesh.bows {
            mesh.take_bows(&linear.bows);
        }
        for (&tendon, &tension) in drive.held.iter().zip(&linear.tensions) {
            drive.tensions[tendon] = tension;
        }
    }

    /// Newton's method until the error it leaves is below `target` (radians and like units). Factors are kept while steps are short and
    /// shrink fast.
    pub(super) fn newton(
        &self,
        memory: &mut Memory,
        mesh: &mut Mesh,
        target: f64,
        begin: Begin,
        iterations: &mut usize,
    ) -> Result<Converged, Stuck> {
        let (mut last, mut last_residual) = (f64::INFINITY, f64::INFINITY);
        let (mut first_contraction, mut most_negative): (Option<f64>, usize) = (None, 0);
        let (mut made, mut reuse) = (false, begin != Begin::Anew);
        let mut evaluated = (begin == Begin::Placed).then(|| self.evaluate_placed(memory, mesh));
        for _ in 0..MAX_ITERATIONS {
            let reused = reuse && memory.sweep.holds_factors(mesh);
            let gradient = evaluated.take().unwrap_or_else(|| self.evaluate(memory, mesh));
            let now = if reused {
                let negative = memory.sweep.factored;
                self.step(memory, mesh, gradient, negative, true)
            } else {
                self.factor_and_step(memory, mesh, gradient, 0.0)
            };
            made |= !reused;
            *iterations += 1;
            let Linearised { correction, bowing, residual, .. } = now;
            let contraction = if correction > 0.0 { correction / last } else { 0.0 };
            let near = memory.sweep.moved + correction <= NEAR;
            if reused && !(near && contraction <= SHRINKING) {
                (reuse, evaluated) = (false, Some(gradient));
                continue;
            }
            let rounding = correction <= ROUNDING_CORRECTION && contraction > CONTRACTION;
            let first = last == f64::INFINITY && correction.is_finite();
            // a small step that brings the equations closer leads to no other branch
            let closer = correction < SMALL && residual <= CONTRACTION * last_residual;
            let Some(negative) =
                now.negative.filter(|_| first || rounding || closer || contraction <= CONTRACTION)
            else {
                return Err(Stuck { correction });
            };
            most_negative = most_negative.max(negative);
            self.correct(memory, mesh);
            memory.sweep.moved += correction;
            if !first {
                first_contraction = first_contraction.or(Some(contraction));
            }
            // the step is taken; the next one would be too small to matter
            // steps may cancel with factors of elsewhere, which the residual shows
            let cancels = residual > CANCELLED * correction;
            let shrinks = if cancels { larger(contraction, residual / last_residual) } else { contraction };
            let next = (SLOWER * shrinks).min(SHRINKING);
            let ahead = match (reused, first) {
                (true, true) => f64::INFINITY,
                (true, false) => correction * next,
                (false, true) => QUADRATIC_AT_FIRST * correction * correction,
                (false, false) => correction * contraction.min(QUADRATIC * correction).max(1e-3 * correction),
            };
            let ahead = larger(ahead, bowing);
            let allowed = target.max(ROUNDING_RESIDUAL);
            let closed = larger(correction, bowing) <= target && residual <= allowed || rounding;
            if closed || ahead <= target && (!reused || next * residual <= allowed) {
                if closed && residual > allowed {
                    return Err(Stuck { correction });
                }
                self.place(&mut memory.sweep, &mut memory.drive, mesh);
                if memory.drive.longest_slack(self.robot, self.factor) > ROUNDING_RESIDUAL * self.chain.length
                {
                    return Err(Stuck { correction });
                }
                mesh.find_middles(&memory.sweep, self.tables);
                return Ok(Converged {
                    residual: if closed { residual } else { ahead },
                    negative,
                    moved: if made { memory.sweep.moved } else { f64::INFINITY },
                    contraction: first_contraction.unwrap_or(0.0),
                    most_negative,
                });
            }
            reuse = correction <= NEAR;
            (last, last_residual) = (correction, residual);
        }
        Err(Stuck { correction: last })
    }
}

/// Number of negative eigenvalues of the symmetric part.
fn falling(s: &DMatrix<f64>) -> usize {
    if s.is_empty() {
        return 0;
    }
    let curvatures = (0.5 * (s + s.transpose())).symmetric_eigenvalues();
    curvatures.iter().filter(|value| **value < -SMALLEST_CURVATURE * curvatures.amax()).count()
}

/// What holding the tendons' lengths found.
#[derive(Clone, Copy, Debug, Default)]
struct Held {
    change: f64,
    residual: f64,
    /// Negative eigenvalues of the Schur complement: directions that holding the lengths takes away.
    negative: usize,
}
