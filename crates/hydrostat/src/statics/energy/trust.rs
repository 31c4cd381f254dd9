//! Minimises the energy from any shape: Newton's method whose steps a trust region keeps short.
//!
//! The step solves (Hessian + shift x elastic part) step = -gradient: a region in the metric of the elastic energy, with the
//! shift as its multiplier (More & Sorensen 1983). Held tendons are springs around their last tension (an augmented Lagrangian)
//! until the shape is near; Newton's method finishes with their lengths exact.

use super::Memory;
use super::mesh::Mesh;
use super::newton::{Equations, Stuck};
use super::tendons;
use crate::model::Command;

/// Longest step, rad.
const LONGEST: f64 = 0.5;
/// Least part of the predicted fall that a step must bring.
const ENOUGH: f64 = 1e-3;
/// Near enough for Newton's method, rad.
const NEAR: f64 = 1e-4;
const MAX_ITERATIONS: usize = 400;
/// Shifts begin here, and above this the energy has no minimum nearby.
const FIRST_SHIFT: f64 = 1e-2;
const LARGEST_SHIFT: f64 = 1e9;

impl Equations<'_> {
    /// Moves the shape downhill to near a minimum of the energy. Dead forces and tendons only.
    pub(super) fn minimise(
        &self,
        memory: &mut Memory,
        mesh: &mut Mesh,
        iterations: &mut usize,
    ) -> Result<(), Stuck> {
        let mut shift = 0.0_f64;
        let mut correction = f64::INFINITY;
        self.begin_springs(memory, mesh);
        for round in 0..MAX_ITERATIONS {
            *iterations += 1;
            let before = self.merit(memory, mesh);
            let now = self.linearise(memory, mesh, shift);
            if now.negative != Some(0) || now.correction > LONGEST || now.correction.is_nan() {
                shift = (4.0 * shift).max(FIRST_SHIFT);
                if shift > LARGEST_SHIFT {
                    break;
                }
                continue;
            }
            correction = now.correction;
            if correction < NEAR && shift <= FIRST_SHIFT {
                return Ok(());
            }
            // half the slope is what a quadratic energy falls by
            let predicted = 0.5 * self.slope(memory, mesh);
            let start = (mesh.turn.clone(), mesh.v.clone());
            self.correct(memory, mesh);
            let fallen = before - self.merit(memory, mesh);
            if fallen >= ENOUGH * predicted.max(0.0) - f64::EPSILON * before.abs() {
                shift = if fallen > 0.5 * predicted { shift / 8.0 } else { shift };
                if shift < 1e-3 * FIRST_SHIFT {
                    shift = 0.0;
                }
                if round % 4 == 3 {
                    memory.drive.springs.centre.clone_from(&memory.drive.tensions);
                }
            } else {
                (mesh.turn, mesh.v) = start;
                shift = (4.0 * shift).max(FIRST_SHIFT);
                if shift > LARGEST_SHIFT {
                    break;
                }
            }
        }
        memory.drive.springs.give.clear();
        Err(Stuck { correction })
    }

    /// Springs about as soft as the robot, around the present tensions.
    fn begin_springs(&self, memory: &mut Memory, mesh: &mut Mesh) {
        memory.drive.springs.give.clear();
        memory.drive.springs.centre.clone_from(&memory.drive.tensions);
        self.linearise(memory, mesh, 1.0);
        let give = memory.linear.compliances.iter().map(|compliance| 0.3 * compliance.abs());
        memory.drive.springs.give.extend(give);
    }

    /// Energy with the springs of the held tendons, whose tensions it sets.
    fn merit(&self, memory: &mut Memory, mesh: &mut Mesh) -> f64 {
        let Memory { sweep, drive, .. } = memory;
        drive.apply(self.robot, self.factor);
        sweep.place(mesh, self.tables);
        tendons::measure(mesh, sweep, &mut drive.lengths, self.robot.tendons.len());
        let mut springs = 0.0;
        for (i, &tendon) in drive.held.iter().enumerate() {
            let give = drive.springs.give[i];
            let soft = drive.compliance(self.robot, tendon) + give;
            drive.tensions[tendon] = 0.0;
            let stretch = drive.excess(self.robot, tendon, self.factor) + give * drive.springs.centre[tendon];
            drive.tensions[tendon] = (stretch / soft).max(0.0);
            springs += 0.5 * soft * drive.tensions[tendon].powi(2);
        }
        let given: Vec<f64> = drive
            .tensions
            .iter()
            .zip(&self.robot.actuation)
            .map(|(tension, command)| if matches!(command, Command::Tension { .. }) { *tension } else { 0.0 })
            .collect();
        sweep.energy(&self.problem(&given), mesh, &drive.lengths) + springs
    }
}
