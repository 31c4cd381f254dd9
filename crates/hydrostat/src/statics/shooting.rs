//! Multiple shooting: Newton's method on the wrench and rotation at the nodes of a mesh.
//!
//! One interval is the thesis's method: guess the base wrench, integrate, correct until the tip is free.
//! With more intervals each starts from a guess of its own and the corrections also close the gaps. Either
//! way the linear equations are solved by a Riccati sweep from the tip, stable where the transition
//! matrices grow exponentially: beyond node k the free tip means `dw_k = P_k dy_k + q_k`, theory (16).

use super::chain::Chain;
use super::crossing::{Chord, Crossing, cross, own_states};
use super::rod::{self, Node, Transition};
use super::span::{Jump, Step};
use crate::geometry::{cayley, cayley_coordinates};
use crate::model::{Robot, Routing};
use crate::numeric::{MAX_UNKNOWNS, eliminate, larger};
use nalgebra::{Matrix3, Vector3};

/// Steps, nodes between them, and the scratch memory of the sweeps; kept from solve to solve.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) steps: Vec<Step>,
    /// Loads passed at the end of each step.
    pub(super) jumps: Vec<Jump>,
    /// State at the start of each step, and after everything at the tip (steps + 1).
    pub(super) nodes: Vec<Node>,
    pub(super) positions: Vec<Vector3<f64>>,
    /// The rod's own states, see [`Mesh::own_states`].
    pub(super) own: Vec<Node>,
    /// Whether a shooting interval starts at the node, so that its state is an unknown of its own.
    starts_interval: Vec<bool>,
    /// Gaps between plates that straight tendons cross, and the chords in them.
    crossings: Vec<Crossing>,
    chords: Vec<Chord>,
    gaps: Vec<Gap>,
    corrections: Vec<Correction>,
    /// What the last correction started from, and the correction itself, so that it can be damped.
    previous: Vec<Node>,
    tried: Vec<Correction>,
}

/// End of a step minus the node there.
#[derive(Clone, Copy, Debug, Default)]
struct Gap {
    rotation: Vector3<f64>,
    moment: Vector3<f64>,
    force: Vector3<f64>,
}

/// What Newton's method adds to a node.
type Correction = Gap;

/// The feedback from a rotation error at a node to the wrench that keeps the tip free.
#[derive(Clone, Copy, Debug)]
struct Feedback {
    moment: Matrix3<f64>,
    force: Matrix3<f64>,
    moment_offset: Vector3<f64>,
    force_offset: Vector3<f64>,
}

/// Scratch of the Riccati sweep, per block size.
#[derive(Clone, Debug)]
pub(super) struct Sweep<const N: usize> {
    transitions: Vec<Transition<N>>,
    feedback: Vec<Feedback>,
}

impl<const N: usize> Default for Sweep<N> {
    fn default() -> Self {
        Sweep { transitions: Vec::new(), feedback: Vec::new() }
    }
}

/// What one linearisation found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linearised {
    /// Largest correction: radians, and wrench in units of stiffness / length (force: / length^2).
    pub(super) correction: f64,
    /// Number of conjugate points, 0 for a stable equilibrium of dead forces; with followers, of negative determinants.
    pub(super) conjugate_points: usize,
    /// Smallest determinant of the sweep: 1 without load, 0 where a conjugate point reaches a node.
    pub(super) smallest_pivot: f64,
}

impl Mesh {
    /// Divides every span of the chain into `per_span` steps; the nodes are kept where their number allows.
    pub(super) fn rebuild(
        &mut self,
        robot: &Robot,
        chain: &Chain,
        tensions: &[f64],
        per_span: &[usize],
        intervals: usize,
    ) {
        self.steps.clear();
        self.jumps.clear();
        for (span, &count) in chain.spans.iter().zip(per_span) {
            let length = (span.to - span.from) / count as f64;
            for i in 0..count {
                self.steps.push(span.step(robot, tensions, span.from + i as f64 * length, length));
                self.jumps.push(if i + 1 == count { span.jump } else { Jump::default() });
            }
        }
        let count = self.steps.len();
        let intervals = intervals.clamp(1, count);
        self.starts_interval.clear();
        self.starts_interval.extend((0..=count).map(|k| {
            // node k starts interval i where k = ceil(i count / intervals)
            k == 0 || (k < count && (k * intervals) / count != ((k - 1) * intervals) / count)
        }));
        self.find_crossings(robot, tensions);
        let base = Node {
            rotation: *robot.base.rotation.matrix(),
            moment: Vector3::zeros(),
            force: Vector3::zeros(),
        };
        self.nodes.resize(count + 1, base);
        self.nodes[0].rotation = base.rotation;
        self.positions.resize(count + 1, robot.base.position);
        self.positions[0] = robot.base.position;
        self.gaps.resize(count, Gap::default());
        self.corrections.resize(count + 1, Gap::default());
        self.tried.resize(count + 1, Gap::default());
    }

    /// Groups the steps between plates; a gap is one step of shooting, which starts an interval.
    fn find_crossings(&mut self, robot: &Robot, tensions: &[f64]) {
        self.crossings.clear();
        self.chords.clear();
        let same = 1e-9 * robot.length();
        for pair in robot.plates().windows(2) {
            let first_chord = self.chords.len();
            for (tendon, tension) in robot.tendons.iter().zip(tensions) {
                let end = robot.tendon_end(tendon);
                if tendon.routing == Routing::Guides && pair[1] <= end + same {
                    let holes = pair.iter().map(|s| tendon.path.hole(s / end, end).0);
                    let holes: Vec<Vector3<f64>> = holes.collect();
                    self.chords.push(Chord { holes: [holes[0], holes[1]], tension: *tension });
                }
            }
            let first = self.steps.partition_point(|step| step.from < pair[0] - same);
            let beyond = self.steps.partition_point(|step| step.from < pair[1] - same);
            for k in first + 1..beyond {
                self.starts_interval[k] = false;
            }
            self.starts_interval[first] = true;
            if beyond < self.steps.len() {
                self.starts_interval[beyond] = true;
            }
            let chords = first_chord..self.chords.len();
            self.crossings.push(Crossing {
                first,
                count: beyond - first,
                chords,
                displacement: Vector3::zeros(),
            });
        }
    }

    /// Puts every node at rest: no load, no wrench.
    pub(super) fn rest(&mut self) {
        self.nodes[0].moment = Vector3::zeros();
        self.nodes[0].force = Vector3::zeros();
        for k in 0..self.steps.len() {
            let (end, displacement) = rod::integrate(&self.steps[k], 0.0, &self.nodes[k]);
            self.nodes[k + 1] = end;
            self.positions[k + 1] = self.positions[k] + displacement;
        }
        for crossing in &mut self.crossings {
            let (first, beyond) = (crossing.first, crossing.first + crossing.count);
            crossing.displacement = self.positions[beyond] - self.positions[first];
        }
    }

    /// Starts from the solution on a mesh whose steps are `parts` times as long.
    pub(super) fn prolong(&mut self, coarse: &Mesh, factor: f64, parts: usize) {
        for k in 0..=self.steps.len() {
            if k % parts == 0 {
                self.nodes[k] = coarse.nodes[k / parts];
            } else {
                self.nodes[k] = rod::integrate(&self.steps[k - 1], factor, &self.nodes[k - 1]).0;
            }
        }
        for (own, other) in self.crossings.iter_mut().zip(&coarse.crossings) {
            own.displacement = other.displacement;
        }
    }

    /// Advances step `k` to the next node, its jump passed. A gap is crossed at its first step, and its other steps do nothing.
    fn advance<const N: usize>(&mut self, k: usize, factor: f64, softening: f64) -> Advanced<N> {
        let start = self.nodes[k];
        let after = self.crossings.partition_point(|crossing| crossing.first <= k);
        let number = after
            .checked_sub(1)
            .filter(|&number| k < self.crossings[number].first + self.crossings[number].count);
        let Some(number) = number else {
            return Advanced::Step;
        };
        let crossing = &self.crossings[number];
        if k > crossing.first {
            return Advanced::Within(start);
        }
        let steps = k..k + crossing.count;
        let crossed = cross::<N>(
            crossing,
            &self.chords[crossing.chords.clone()],
            &self.steps[steps.clone()],
            &self.jumps[steps.clone()],
            factor,
            softening,
            &start,
            &self.nodes[steps.end].rotation,
        );
        let Some(mut crossed) = crossed else {
            return Advanced::Crossed {
                end: not_a_node(),
                transition: [[Matrix3::from_element(f64::NAN); N]; N],
            };
        };
        let jump = &self.jumps[steps.end - 1];
        rod::pass_transition(jump, factor, &crossed.end.rotation, &mut crossed.transition);
        rod::pass(jump, factor, &mut crossed.end);
        self.crossings[number].displacement = crossed.displacement;
        // only plates have a place before the rod's own states are known
        let start = self.positions[k];
        self.positions[k + 1..steps.end].fill(start);
        self.positions[steps.end] = start + crossed.displacement;
        Advanced::Crossed { end: crossed.end, transition: crossed.transition }
    }

    /// Whether tendons run beside the rod in chords.
    pub(super) fn own_differs(&self) -> bool {
        !self.crossings.is_empty()
    }

    /// The rod's own state at the start of every step: where tendons run beside it in chords, the nodes hold the wrench of all.
    pub(super) fn own_states(&mut self, factor: f64) {
        self.own.clone_from(&self.nodes);
        for crossing in &self.crossings {
            let steps = crossing.first..crossing.first + crossing.count;
            let (own, positions) = (&mut self.own, &mut self.positions);
            let start = positions[steps.start];
            own_states(
                crossing,
                &self.chords[crossing.chords.clone()],
                &self.steps[steps.clone()],
                &self.jumps[steps.clone()],
                factor,
                &self.nodes[steps.start],
                &self.nodes[steps.end].rotation,
                |k, node, displacement| {
                    own[steps.start + k] = node;
                    positions[steps.start + k] = start + displacement;
                },
            );
        }
    }

    /// Largest angle between the ends of a step.
    pub(super) fn largest_turn(&self) -> f64 {
        self.nodes.windows(2).map(|pair| angle(&pair[0], &pair[1])).fold(0.0, larger)
    }

    /// Largest angle between a node and what it was before.
    pub(super) fn turned_since(&self, before: &[Node]) -> f64 {
        self.nodes.iter().zip(before).map(|(now, before)| angle(now, before)).fold(0.0, larger)
    }

    /// Integrates without derivatives: positions, and the largest gap left in scaled units.
    pub(super) fn residual(&mut self, chain: &Chain, factor: f64) -> f64 {
        let mut largest = 0.0_f64;
        for k in 0..self.steps.len() {
            let end = match self.advance::<2>(k, factor, 1.0) {
                Advanced::Step => {
                    let (mut end, displacement) = rod::integrate(&self.steps[k], factor, &self.nodes[k]);
                    rod::pass(&self.jumps[k], factor, &mut end);
                    self.positions[k + 1] = self.positions[k] + displacement;
                    end
                }
                Advanced::Within(end) | Advanced::Crossed { end, .. } => end,
            };
            let gap = self.gap(k, &end);
            if self.starts_interval[k + 1] || k + 1 == self.steps.len() {
                largest = larger(largest, gap.size(chain));
            }
            if !self.starts_interval[k + 1] {
                self.nodes[k + 1] = end;
            }
        }
        largest
    }

    /// End of step `k` against the node there; against a free tip at the last.
    fn gap(&self, k: usize, end: &Node) -> Gap {
        if k + 1 == self.steps.len() {
            return Gap { rotation: Vector3::zeros(), moment: end.moment, force: end.force };
        }
        let node = &self.nodes[k + 1];
        Gap {
            rotation: cayley_coordinates(&(end.rotation * node.rotation.transpose())),
            moment: end.moment - node.moment,
            force: end.force - node.force,
        }
    }

    /// Integrates every step with its transition, then finds Newton's correction of every node.
    pub(super) fn linearise<const N: usize>(
        &mut self,
        chain: &Chain,
        factor: f64,
        softening: f64,
        sweep: &mut Sweep<N>,
    ) -> Linearised {
        let count = self.steps.len();
        sweep.transitions.clear();
        for k in 0..count {
            let (end, transition) = match self.advance::<N>(k, factor, softening) {
                Advanced::Step => {
                    let (step, start) = (&self.steps[k], &self.nodes[k]);
                    let (mut end, _) = rod::integrate(step, factor, start);
                    let mut transition = rod::transition::<N>(step, factor, softening, start, &end);
                    rod::pass_transition(&self.jumps[k], factor, &end.rotation, &mut transition);
                    rod::pass(&self.jumps[k], factor, &mut end);
                    (end, transition)
                }
                Advanced::Within(end) => (end, identity()),
                Advanced::Crossed { end, transition } => (end, transition),
            };
            sweep.transitions.push(transition);
            if self.starts_interval[k + 1] {
                self.gaps[k] = self.gap(k, &end);
            } else {
                self.nodes[k + 1] = end;
                self.gaps[k] = if k + 1 == count { self.gap(k, &end) } else { Gap::default() };
            }
        }
        let (conjugate_points, smallest_pivot) = sweep.backward(&self.gaps);
        sweep.forward(&self.gaps, &mut self.corrections);
        let correction = self.corrections.iter().map(|correction| correction.size(chain)).fold(0.0, larger);
        Linearised { correction, conjugate_points, smallest_pivot }
    }

    /// Adds the corrections to the nodes that start an interval.
    pub(super) fn correct(&mut self) {
        self.previous.clone_from(&self.nodes);
        self.tried.clone_from(&self.corrections);
        self.add_tried(1.0);
    }

    /// Takes the last correction back, and adds `scale` of it instead.
    pub(super) fn damp(&mut self, scale: f64) {
        self.nodes.clone_from(&self.previous);
        self.add_tried(scale);
    }

    fn add_tried(&mut self, scale: f64) {
        for k in 0..self.steps.len() {
            if self.starts_interval[k] {
                let (node, correction) = (&mut self.nodes[k], &self.tried[k]);
                node.rotation = cayley(&(scale * correction.rotation)) * node.rotation;
                node.moment += scale * correction.moment;
                node.force += scale * correction.force;
            }
        }
    }
}

/// How a step of the mesh was advanced.
enum Advanced<const N: usize> {
    /// A step of its own, still to be integrated.
    Step,
    /// A step within a gap: the node after it is that before it.
    Within(Node),
    Crossed {
        end: Node,
        transition: Transition<N>,
    },
}

fn identity<const N: usize>() -> Transition<N> {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| if i == j { Matrix3::identity() } else { Matrix3::zeros() })
    })
}

/// Where no crossing was found: the iteration counts as diverged.
fn not_a_node() -> Node {
    let vector = Vector3::from_element(f64::NAN);
    Node { rotation: Matrix3::from_element(f64::NAN), moment: vector, force: vector }
}

impl Gap {
    /// Size: radians, moments in units of stiffness / length, forces of stiffness / length^2.
    fn size(&self, chain: &Chain) -> f64 {
        let moment = chain.length / chain.stiffness;
        [self.rotation.amax(), self.moment.amax() * moment, self.force.amax() * moment * chain.length]
            .into_iter()
            .fold(0.0, larger)
    }
}

/// Angle between the rotations of two nodes.
fn angle(a: &Node, b: &Node) -> f64 {
    ((a.rotation.dot(&b.rotation) - 1.0) / 2.0).clamp(-1.0, 1.0).acos()
}

/// Of the symmetric part, by the signs of its leading minors (Jacobi).
fn negative_eigenvalues(m: &Matrix3<f64>) -> usize {
    let m = 0.5 * (m + m.transpose());
    let minors = [1.0, m.m11, m.m11 * m.m22 - m.m12 * m.m21, m.determinant()];
    minors.windows(2).filter(|pair| pair[0] * pair[1] <= 0.0).count()
}

impl<const N: usize> Sweep<N> {
    /// Tip to base, theory (15, 16): at the tip the wrench beyond the last load is zero, `dw + gap = 0`.
    ///
    /// ```text
    /// dy+ = T11 dy + T12 dw + g1,   dw+ = T21 dy + T22 dw + g2,   dw+ = P+ dy+ + q+
    /// (T22 - P+ T12) dw = (P+ T11 - T21) dy + P+ g1 + q+ - g2
    /// ```
    ///
    /// Returns the number of conjugate points. With dead loads, eliminating node k + 1 from the second variation of
    /// the energy leaves the pivot `S = (T22 - P+ T12) T12^-1`, theory (18), so its negative eigenvalues, or those of
    /// the congruent `T12^T (T22 - P+ T12)`, count the directions in which the energy falls (the inertia of a block
    /// elimination). With follower loads only the steps with a negative determinant are counted.
    fn backward(&mut self, gaps: &[Gap]) -> (usize, f64) {
        let count = self.transitions.len();
        let unknowns = 3 * (N - 1);
        let free = Feedback {
            moment: Matrix3::zeros(),
            force: Matrix3::zeros(),
            moment_offset: Vector3::zeros(),
            force_offset: Vector3::zeros(),
        };
        self.feedback.clear();
        self.feedback.resize(count + 1, free);
        let (mut negative, mut smallest) = (0, f64::INFINITY);
        for k in (0..count).rev() {
            let (t, gap, beyond) = (&self.transitions[k], &gaps[k], &self.feedback[k + 1]);
            let mut rows = [[0.0; MAX_UNKNOWNS + 4]; MAX_UNKNOWNS];
            for block_row in 1..N {
                let (p, offset, block_gap) = if block_row == 1 {
                    (&beyond.moment, &beyond.moment_offset, &gap.moment)
                } else {
                    (&beyond.force, &beyond.force_offset, &gap.force)
                };
                for block_column in 1..N {
                    let left = t[block_row][block_column] - p * t[0][block_column];
                    for i in 0..3 {
                        for j in 0..3 {
                            rows[3 * block_row - 3 + i][3 * block_column - 3 + j] = left[(i, j)];
                        }
                    }
                }
                let right = p * t[0][0] - t[block_row][0];
                let offset = p * gap.rotation + offset - block_gap;
                for i in 0..3 {
                    let row = &mut rows[3 * block_row - 3 + i];
                    for j in 0..3 {
                        row[unknowns + j] = right[(i, j)];
                    }
                    row[unknowns + 3] = offset[i];
                }
            }
            let determinant = eliminate(&mut rows, unknowns);
            smallest = determinant.min(smallest);
            if determinant == 0.0 {
                // no feedback closes the gap here: the iteration counts as diverged
                rows = [[f64::NAN; MAX_UNKNOWNS + 4]; MAX_UNKNOWNS];
            }
            let within_gap = t[0][1] == Matrix3::zeros();
            negative += if within_gap {
                0
            } else if N == 2 {
                let left = t[1][1] - beyond.moment * t[0][1];
                negative_eigenvalues(&t[0][1].tr_mul(&left))
            } else {
                usize::from(determinant < 0.0)
            };
            let matrix = |first: usize| Matrix3::from_fn(|i, j| rows[first + i][unknowns + j]);
            let vector = |first: usize| Vector3::from_fn(|i, _| rows[first + i][unknowns + 3]);
            let here = &mut self.feedback[k];
            here.moment = matrix(0);
            here.moment_offset = vector(0);
            if N > 2 {
                here.force = matrix(3);
                here.force_offset = vector(3);
            }
        }
        (negative, smallest)
    }

    /// Base to tip: the base does not turn.
    fn forward(&self, gaps: &[Gap], corrections: &mut [Correction]) {
        let mut rotation = Vector3::zeros();
        for (k, feedback) in self.feedback.iter().enumerate() {
            let moment = feedback.moment * rotation + feedback.moment_offset;
            let force = feedback.force * rotation + feedback.force_offset;
            corrections[k] = Correction { rotation, moment, force };
            if let Some(t) = self.transitions.get(k) {
                rotation = t[0][0] * rotation + t[0][1] * moment + gaps[k].rotation;
                if N > 2 {
                    rotation += t[0][2] * force;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::rod::tests::tapered_rod;
    use super::*;

    /// Steps of the mesh: the transitions' own error is then 1e-8.
    const STEPS: usize = 256;
    /// Step of the central differences, and what they and the transitions leave, relative to the derivative.
    const DIFFERENCE: f64 = 1e-5;
    const LEFT: f64 = 1e-6;
    /// Newton's iterations from rest; they converge quadratically.
    const ITERATIONS: usize = 12;

    /// Converges on the full loads with the base turned by a small world rotation.
    fn solved<const N: usize>(follower: bool, turn: &Vector3<f64>) -> (Chain, Mesh, Sweep<N>) {
        let robot = tapered_rod(follower);
        let (mut chain, mut mesh, mut sweep) = (Chain::default(), Mesh::default(), Sweep::<N>::default());
        chain.rebuild(&robot);
        mesh.rebuild(&robot, &chain, &[], &[STEPS], usize::MAX);
        mesh.nodes[0].rotation = cayley(turn) * mesh.nodes[0].rotation;
        mesh.rest();
        for _ in 0..ITERATIONS {
            mesh.linearise(&chain, 1.0, 1.0, &mut sweep);
            mesh.correct();
        }
        assert!(mesh.residual(&chain, 1.0) < 1e-11, "Newton's method converged");
        (chain, mesh, sweep)
    }

    fn assert_close(name: &str, ours: &Matrix3<f64>, expected: &Matrix3<f64>) {
        let off = (ours - expected).amax() / expected.amax();
        assert!(off < LEFT, "{name}: {off:.1e}");
    }

    /// P at the base: how the wrench that keeps the tip free changes where the base is turned.
    fn assert_feedback<const N: usize>(follower: bool) {
        let sweep = solved::<N>(follower, &Vector3::zeros()).2;
        let (mut moment, mut force) = (Matrix3::zeros(), Matrix3::zeros());
        for axis in 0..3 {
            let by = |h: f64| solved::<N>(follower, &(h * Vector3::ith(axis, 1.0))).1.nodes[0];
            let (ahead, behind) = (by(DIFFERENCE), by(-DIFFERENCE));
            moment.set_column(axis, &((ahead.moment - behind.moment) / (2.0 * DIFFERENCE)));
            force.set_column(axis, &((ahead.force - behind.force) / (2.0 * DIFFERENCE)));
        }
        assert_close("moment", &sweep.feedback[0].moment, &moment);
        if N > 2 {
            assert_close("force", &sweep.feedback[0].force, &force);
        }
    }

    #[test]
    fn the_feedback_is_the_derivative_of_the_base_wrench() {
        assert_feedback::<2>(false);
        assert_feedback::<3>(true);
    }

    /// From a base wrench that is off, single shooting's correction is -J^-1 r with J by differences.
    #[test]
    fn the_correction_is_that_of_newtons_method() {
        let robot = tapered_rod(false);
        let (chain, mesh, _) = solved::<2>(false, &Vector3::zeros());
        let off = mesh.nodes[0].moment + Vector3::new(0.02, -0.03, 0.01);
        let tip_moment = |moment: Vector3<f64>| {
            let mut single = Mesh::default();
            single.rebuild(&robot, &chain, &[], &[STEPS], 1);
            single.nodes[0].moment = moment;
            single.linearise(&chain, 1.0, 1.0, &mut Sweep::<2>::default());
            (single.gaps[STEPS - 1].moment, single.corrections[0].moment)
        };
        let mut jacobian = Matrix3::zeros();
        for axis in 0..3 {
            let by = DIFFERENCE * Vector3::ith(axis, 1.0);
            let change = tip_moment(off + by).0 - tip_moment(off - by).0;
            jacobian.set_column(axis, &(change / (2.0 * DIFFERENCE)));
        }
        let (gap, ours) = tip_moment(off);
        let expected = jacobian.lu().solve(&-gap).expect("regular");
        assert!((ours - expected).norm() < LEFT * expected.norm(), "{ours} {expected}");
    }
}
