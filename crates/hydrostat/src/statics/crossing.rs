//! One gap between two plates as a single shooting step: the chords of straight tendons make it implicit.
//!
//! The wrench of rod and chords together passes the plates unchanged. Within the gap the rod carries it less the chords,
//! which depend on the plates at both ends: the displacement between them and the rotation of the second are found first.

use super::rod::{self, Node, Transition};
use super::span::{Jump, Step};
use crate::geometry::{cayley, cayley_coordinates, hat};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// A chord from hole to hole, body frames of the first and the second plate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub(super) holes: [Vector3<f64>; 2],
    pub(super) tension: f64,
}

/// The steps of a gap and its chords, as ranges of the mesh's.
#[derive(Clone, Debug)]
pub(super) struct Crossing {
    pub(super) first: usize,
    pub(super) count: usize,
    pub(super) chords: std::ops::Range<usize>,
    /// From plate to plate, world frame: what was found last.
    pub(super) displacement: Vector3<f64>,
}

/// Sensitivity of the chords' wrench to (rotation of the first plate, displacement, rotation of the second plate).
#[derive(Clone, Copy, Debug, Default)]
struct Chords {
    force: Vector3<f64>,
    /// About the first and about the second plate's centre.
    moments: [Vector3<f64>; 2],
    force_by: [Matrix3<f64>; 3],
    moments_by: [[Matrix3<f64>; 3]; 2],
}

impl Chords {
    fn new(
        chords: &[Chord],
        factor: f64,
        first: &Matrix3<f64>,
        displacement: &Vector3<f64>,
        second: &Matrix3<f64>,
    ) -> Self {
        let mut sum = Chords::default();
        for chord in chords {
            let arms = [first * chord.holes[0], second * chord.holes[1]];
            let span = displacement + arms[1] - arms[0];
            let length = span.norm();
            let t = span / length;
            let tension = factor * chord.tension;
            let across = (Matrix3::identity() - t * t.transpose()) * (tension / length);
            let pull = tension * t;
            let by = [across * hat(&arms[0]), across, -(across * hat(&arms[1]))];
            sum.force += pull;
            for (end, arm) in arms.iter().enumerate() {
                sum.moments[end] += arm.cross(&pull);
                for (k, force_by) in by.iter().enumerate() {
                    sum.moments_by[end][k] += hat(arm) * force_by;
                }
                // the arm turns with its plate
                sum.moments_by[end][2 * end] += hat(&pull) * hat(arm);
            }
            for (own, by) in sum.force_by.iter_mut().zip(&by) {
                *own += by;
            }
        }
        sum
    }
}

/// Newton iterations for the second plate, and the change, in radians or of the displacement, at which they end.
const MOST_ITERATIONS: usize = 30;
const CONVERGED: f64 = 1e-14;

/// What lies between two plates, before the loads at the second.
pub(super) struct Crossed<const N: usize> {
    pub(super) end: Node,
    pub(super) displacement: Vector3<f64>,
    pub(super) transition: Transition<N>,
}

/// Integrates the rod of a gap from its own wrench at the start; every inner jump is passed, the last is not. `visit` sees the
/// start of every step.
fn rod_of<'a>(
    steps: &'a [Step],
    jumps: &'a [Jump],
    factor: f64,
    start: Node,
    mut visit: impl FnMut(&'a Step, &Node, &Node, &Vector3<f64>),
) -> (Node, Vector3<f64>) {
    let (mut node, mut displacement) = (start, Vector3::zeros());
    for (k, (step, jump)) in steps.iter().zip(jumps).enumerate() {
        let (mut end, moved) = rod::integrate(step, factor, &node);
        visit(step, &node, &end, &displacement);
        displacement += moved;
        if k + 1 < steps.len() {
            rod::pass(jump, factor, &mut end);
        }
        node = end;
    }
    (node, displacement)
}

/// The rod's own state at the start of every step of a gap, with the displacement since the first plate.
#[allow(clippy::too_many_arguments, reason = "the parts of a mesh, which the caller has borrowed")]
pub(super) fn own_states(
    crossing: &Crossing,
    chords: &[Chord],
    steps: &[Step],
    jumps: &[Jump],
    factor: f64,
    start: &Node,
    second: &Matrix3<f64>,
    mut store: impl FnMut(usize, Node, Vector3<f64>),
) {
    let carried = Chords::new(chords, factor, &start.rotation, &crossing.displacement, second);
    let own = Node {
        rotation: start.rotation,
        moment: start.moment - carried.moments[0],
        force: start.force - carried.force,
    };
    let mut k = 0;
    rod_of(steps, jumps, factor, own, |_, node, _, displacement| {
        store(k, *node, *displacement);
        k += 1;
    });
}

/// Crosses a gap from the total wrench at its first plate; the mesh's node at the second is the first guess. None where
/// Newton's method does not end.
#[allow(clippy::too_many_arguments, reason = "the parts of a mesh, which the caller has borrowed")]
pub(super) fn cross<const N: usize>(
    crossing: &Crossing,
    chords: &[Chord],
    steps: &[Step],
    jumps: &[Jump],
    factor: f64,
    asked: f64,
    start: &Node,
    guess: &Matrix3<f64>,
) -> Option<Crossed<N>> {
    let mut displacement = crossing.displacement;
    let mut second = *guess;
    let length: f64 = steps.iter().map(|step| step.length).sum();
    let mut last = f64::INFINITY;
    let mut arrived = false;
    for _ in 0..MOST_ITERATIONS {
        // the softened transition is asked for at the shape that has been found, and is no help in finding it
        let softening = if arrived { asked } else { 1.0 };
        let carried = Chords::new(chords, factor, &start.rotation, &displacement, &second);
        let own = Node {
            rotation: start.rotation,
            moment: start.moment - carried.moments[0],
            force: start.force - carried.force,
        };
        // end and displacement over (rotation, moment, force) at the start
        let mut t: Transition<3> = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { Matrix3::identity() } else { Matrix3::zeros() })
        });
        let mut p = [Matrix3::zeros(); 3];
        let mut k = 0;
        let (end, moved) = rod_of(steps, jumps, factor, own, |step, from, to, _| {
            let mut one = rod::transition::<3>(step, factor, softening, from, to);
            let shift = rod::displacement_transition(step, factor, softening, from, to, &one);
            if k + 1 < steps.len() {
                rod::pass_transition(&jumps[k], factor, &to.rotation, &mut one);
            }
            k += 1;
            for j in 0..3 {
                p[j] += (0..3).map(|i| shift[i] * t[i][j]).sum::<Matrix3<f64>>();
            }
            t = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| one[i][k] * t[k][j]).sum()));
        });
        // the rod's own wrench at the start lacks that of the chords
        let by = |rows: &[Matrix3<f64>; 3], k: usize| {
            -(rows[1] * carried.moments_by[0][k] + rows[2] * carried.force_by[k])
        };
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        let mut set = |row: usize, column: usize, block: Matrix3<f64>| {
            matrix.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
        };
        set(0, 0, by(&p, 1) - Matrix3::identity());
        set(0, 3, by(&p, 2));
        set(3, 0, by(&t[0], 1));
        set(3, 3, by(&t[0], 2) - Matrix3::identity());
        let inverse = matrix.try_inverse()?;
        let turned = cayley_coordinates(&(end.rotation * second.transpose()));
        let mut off = SVector::<f64, 6>::zeros();
        off.fixed_rows_mut::<3>(0).copy_from(&(moved - displacement));
        off.fixed_rows_mut::<3>(3).copy_from(&turned);
        let change = -inverse * off;
        let size = (change.fixed_rows::<3>(0).amax() / length).max(change.fixed_rows::<3>(3).amax());
        if !size.is_finite() {
            return None;
        }
        if !arrived && (size <= CONVERGED || size >= last && size < 1e-11) {
            arrived = true;
            if asked != 1.0 {
                continue;
            }
        }
        if arrived {
            return Some(Crossed {
                end: Node {
                    rotation: end.rotation,
                    moment: end.moment + carried.moments[1],
                    force: end.force + carried.force,
                },
                displacement: moved,
                transition: through::<N>(&carried, &inverse, &t, &p),
            });
        }
        last = size;
        // no plate turns by more at once
        let scale = (0.5 / size).min(1.0);
        displacement += scale * change.fixed_rows::<3>(0);
        let turn: Vector3<f64> = scale * change.fixed_rows::<3>(3);
        second = cayley(&turn) * second;
    }
    None
}

/// The transition of the total state across a gap, by the implicit function theorem.
fn through<const N: usize>(
    carried: &Chords,
    inverse: &SMatrix<f64, 6, 6>,
    t: &Transition<3>,
    p: &[Matrix3<f64>; 3],
) -> Transition<N> {
    std::array::from_fn(|row| {
        std::array::from_fn(|input| {
            // own (rotation, moment, force) at the start, with the second plate held
            let mut own = [Matrix3::zeros(); 3];
            own[input] = Matrix3::identity();
            if input == 0 {
                own[1] -= carried.moments_by[0][0];
                own[2] -= carried.force_by[0];
            }
            let along = |rows: &[Matrix3<f64>; 3], own: &[Matrix3<f64>; 3]| {
                rows[0] * own[0] + rows[1] * own[1] + rows[2] * own[2]
            };
            let mut off = SMatrix::<f64, 6, 3>::zeros();
            off.fixed_view_mut::<3, 3>(0, 0).copy_from(&along(p, &own));
            off.fixed_view_mut::<3, 3>(3, 0).copy_from(&along(&t[0], &own));
            let moved = -inverse * off;
            let plate =
                [moved.fixed_view::<3, 3>(0, 0).into_owned(), moved.fixed_view::<3, 3>(3, 0).into_owned()];
            for (k, plate) in plate.iter().enumerate() {
                own[1] -= carried.moments_by[0][k + 1] * plate;
                own[2] -= carried.force_by[k + 1] * plate;
            }
            let mut end = along(&t[row], &own);
            let by = match row {
                0 => return end,
                1 => &carried.moments_by[1],
                _ => &carried.force_by,
            };
            if input == 0 {
                end += by[0];
            }
            end += by[1] * plate[0] + by[2] * plate[1];
            end
        })
    })
}
