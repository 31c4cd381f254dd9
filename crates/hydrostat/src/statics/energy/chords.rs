//! Chords: the straight pieces of tendons between the plates of a gap.

use super::factor::{Carried, D, FIRST_PLATE, FOLLOWING, NU, ROTATION};
use super::mesh::Mesh;
use super::sweep::{Column, Problem, Sweep};
use crate::geometry::hat;
use crate::numeric::blocks::symmetric;
use nalgebra::{Matrix3, Vector3};

impl Sweep {
    /// Forces of the chords on the plates of their gaps, theory (33).
    pub(super) fn pull_chords(&mut self, problem: &Problem, mesh: &Mesh, gradient: &mut Column) {
        self.gaps.resize_with(mesh.gaps.len(), Default::default);
        for (number, (gap, front)) in mesh.gaps.iter().zip(&mut self.gaps).enumerate() {
            (front.force, front.first_plate, front.second_plate) = Default::default();
            let [first, second] = [&mesh.rotations[gap.panels.start], &mesh.rotations[gap.panels.end]];
            let chords = gap.chords.clone();
            for (chord, (direction, _)) in mesh.chords[chords.clone()].iter().zip(&self.spans[chords]) {
                let pull = problem.tensions[chord.tendon] * chord.share * direction;
                front.force -= pull;
                front.first_plate -= chord.holes[0].cross(&first.tr_mul(&pull));
                front.second_plate += chord.holes[1].cross(&second.tr_mul(&pull));
            }
            // the energy's slope in d is what the chords carry, and closes by itself
            gradient.gaps[number][1] = front.first_plate;
        }
    }

    /// Hessian of the chords at the end of their gap, theory (33): energy tau |c| with c from hole to hole, which changes with the
    /// rotation of the second plate by `-R_2 hat(h_2)`, with d by the identity and with the rotation of the first plate by `R_1 hat(h_1)`.
    pub(super) fn bend_chords(&self, problem: &Problem, mesh: &Mesh, number: usize, carried: &mut Carried) {
        let gap = &mesh.gaps[number];
        let [first, second] = [&mesh.rotations[gap.panels.start], &mesh.rotations[gap.panels.end]];
        let between = second.tr_mul(first);
        let [mut second_second, mut second_first, mut first_first] = [Matrix3::zeros(); 3];
        let [mut across, mut d_second, mut d_first] = [Matrix3::zeros(); 3];
        let [mut arm_first, mut arm_second] = [Vector3::zeros(); 2];
        let chords = gap.chords.clone();
        for (chord, (t, length)) in mesh.chords[chords.clone()].iter().zip(&self.spans[chords]) {
            let tension = problem.tensions[chord.tendon] * chord.share;
            if tension == 0.0 {
                continue;
            }
            // dc . (I - t t^T) dc tau/|c|, with t . dc by each rotation, and tau t . d^2c
            let per_length = tension / length;
            let [hole_first, hole_second] = chord.holes;
            let (t_first, t_second) = (first.tr_mul(t), second.tr_mul(t));
            let (along_first, along_second) = (t_first.cross(&hole_first), hole_second.cross(&t_second));
            let own = |hole: &Vector3<f64>, along: &Vector3<f64>| {
                square_less_outer(hole) - along * along.transpose()
            };
            second_second += per_length * own(&hole_second, &along_second)
                + tension * symmetric(&less_dot(&hole_second, &t_second));
            first_first += per_length * own(&hole_first, &along_first)
                - tension * symmetric(&less_dot(&hole_first, &t_first));
            second_first += per_length
                * (hat(&hole_second) * (between * hat(&hole_first)) - along_second * along_first.transpose());
            let weighted = per_length * t;
            across += Matrix3::from_diagonal_element(per_length) - weighted * t.transpose();
            d_second -= weighted * along_second.transpose();
            d_first -= weighted * along_first.transpose();
            arm_first += per_length * hole_first;
            arm_second += per_length * hole_second;
        }
        d_second -= second * hat(&arm_second);
        d_first += first * hat(&arm_first);

        for other in [NU, ROTATION, FIRST_PLATE] {
            carried[(NU, other)] = Matrix3::zeros();
            carried[(other, NU)] = Matrix3::zeros();
        }
        for other in [NU, D, FIRST_PLATE] {
            carried[(FOLLOWING, other)] = Matrix3::zeros();
        }
        carried[(NU, D)] = Matrix3::identity();
        carried[(D, NU)] = Matrix3::identity();
        carried[(ROTATION, ROTATION)] += second_second;
        carried[(D, D)] = across;
        carried[(FIRST_PLATE, FIRST_PLATE)] = first_first;
        for (row, column, block) in
            [(D, ROTATION, d_second), (D, FIRST_PLATE, d_first), (ROTATION, FIRST_PLATE, second_first)]
        {
            carried[(row, column)] = block;
            carried[(column, row)] = block.transpose();
        }
    }
}

/// hat(a)^T hat(a).
fn square_less_outer(a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(a.norm_squared()) - a * a.transpose()
}

/// hat(b) hat(a).
fn less_dot(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    a * b.transpose() - Matrix3::from_diagonal_element(a.dot(b))
}
