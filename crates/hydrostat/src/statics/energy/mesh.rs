//! Panels of the backbone with their Gauss nodes: what does not depend on the shape, and the shape itself.

use super::sweep::{Sweep, weighted};
use crate::geometry::{RotationVector, rotation_vector};
use crate::model::{Robot, Routing};
use crate::numeric::collocation::{Collocation, FEWEST, MOST, Row};
use crate::numeric::larger;
use crate::solution::Station;
use crate::statics::chain::Chain;
use crate::statics::section::Pull;
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;
use std::sync::LazyLock;

/// A piece of a span with its own polynomial.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) from: f64,
    pub(super) length: f64,
    /// Index into `Chain::spans`.
    pub(super) span: usize,
    /// Its nodes among those of the mesh.
    pub(super) nodes: Range<usize>,
    /// The gap between two plates in which it lies, if chords run there.
    pub(super) gap: Option<usize>,
    /// Whether it is the last of its span, so that the span's point loads act at its end.
    pub(super) ends_span: bool,
    /// What its curvature has of the Legendre polynomial that is zero at the nodes, 1/m.
    pub(super) bow: Vector3<f64>,
}

/// What a Gauss node has whatever the shape.
#[derive(Clone, Debug)]
pub(super) struct NodeData {
    /// Arc length that the node stands for.
    pub(super) weight: f64,
    /// Diagonals of K_se and K_bt.
    pub(super) shear: Vector3<f64>,
    pub(super) bend: Vector3<f64>,
    pub(super) rest_curvature: Vector3<f64>,
    /// Dead force beyond, world frame.
    pub(super) force: Vector3<f64>,
    /// Dead moment per length, world frame.
    pub(super) moment_per_length: Vector3<f64>,
    /// Following moment per length, body frame.
    pub(super) following_moment: Vector3<f64>,
    /// First moment of the mass per length, body frame.
    pub(super) mass_moment: Vector3<f64>,
    /// Force and moment that the section law leaves out, body frame: where gaps are averaged.
    pub(super) left_out: [Vector3<f64>; 2],
    /// The tendons that pass, in channels or between averaged guides, among `Mesh::passing`.
    pub(super) passing: Range<usize>,
    /// The gap in which it lies, if chords run there.
    pub(super) gap: Option<usize>,
}

/// A tendon at a node: in a channel, or on average between guides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passing {
    pub(super) tendon: usize,
    /// Without tension.
    pub(super) slack: Pull,
    /// Its tension over that at the base.
    pub(super) share: f64,
}

impl Passing {
    /// Under the tensions at the base.
    pub(super) fn pull(&self, tensions: &[f64]) -> Pull {
        Pull { tension: tensions[self.tendon] * self.share, ..self.slack }
    }
}

/// The space between two plates with the chords that cross it.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    pub(super) panels: Range<usize>,
    pub(super) chords: Range<usize>,
}

/// A tendon straight between its holes in the two plates of a gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub(super) tendon: usize,
    /// Holes in the first and the second plate, body frame.
    pub(super) holes: [Vector3<f64>; 2],
    pub(super) share: f64,
}

/// The discretised backbone.
#[derive(Debug, Default)]
pub(super) struct Mesh {
    pub(super) panels: Vec<Panel>,
    pub(super) data: Vec<NodeData>,
    pub(super) passing: Vec<Passing>,
    pub(super) gaps: Vec<Gap>,
    pub(super) chords: Vec<Chord>,
    /// Rotation vector since the panel's start, per node.
    pub(super) turn: Vec<Vector3<f64>>,
    /// Shear and stretch, per node.
    pub(super) v: Vec<Vector3<f64>>,
    /// At the panels' starts and at the tip (panels + 1).
    pub(super) rotations: Vec<Matrix3<f64>>,
    pub(super) positions: Vec<Vector3<f64>>,
    /// Whether loads follow the shape.
    pub(super) follows: bool,
    /// Whether its panels bow; all bows are zero otherwise.
    pub(super) bows: bool,
    /// Position and rotation at the panels' middles, where Newton's method ended.
    pub(super) middles: Vec<(Vector3<f64>, Matrix3<f64>)>,
}

impl Clone for Mesh {
    fn clone(&self) -> Self {
        let mut copy = Mesh::default();
        copy.clone_from(self);
        copy
    }

    /// Keeps the memory, which a derived one would not.
    fn clone_from(&mut self, from: &Self) {
        self.panels.clone_from(&from.panels);
        self.data.clone_from(&from.data);
        self.passing.clone_from(&from.passing);
        self.gaps.clone_from(&from.gaps);
        self.chords.clone_from(&from.chords);
        self.turn.clone_from(&from.turn);
        self.v.clone_from(&from.v);
        self.rotations.clone_from(&from.rotations);
        self.positions.clone_from(&from.positions);
        (self.follows, self.bows) = (from.follows, from.bows);
        self.middles.clone_from(&from.middles);
    }
}

/// Tables by number of points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tables(&'static [Collocation]);

static TABLES: LazyLock<Vec<Collocation>> = LazyLock::new(|| (FEWEST..=MOST).map(Collocation::new).collect());

impl Default for Tables {
    fn default() -> Self {
        Tables(&TABLES)
    }
}

impl Tables {
    pub(super) fn of(&self, points: usize) -> &Collocation {
        &self.0[points - FEWEST]
    }
}

/// How one panel is laid out: number of parts its span is cut into, and points in each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) parts: usize,
    pub(super) points: usize,
}

/// A place closer to a cut than this part of a panel is the cut.
const SAME_PLACE: f64 = 1e-11;

impl Mesh {
    /// Lays panels on the chain, one layout per span, at rest.
    pub(super) fn rebuild(&mut self, robot: &Robot, chain: &Chain, layouts: &[Layout], tables: &Tables) {
        self.panels.clear();
        self.data.clear();
        self.passing.clear();
        self.middles.clear();
        (self.follows, self.bows) = (chain.follower, false);
        for (number, (span, layout)) in chain.spans.iter().zip(layouts).enumerate() {
            let length = (span.to - span.from) / layout.parts as f64;
            for part in 0..layout.parts {
                let from = span.from + part as f64 * length;
                let first = self.data.len();
                let table = tables.of(layout.points);
                for (point, weight) in table.points.iter().zip(&table.weights) {
                    self.add_node(robot, chain, number, from + point * length, weight * length);
                }
                self.panels.push(Panel {
                    from,
                    length,
                    span: number,
                    nodes: first..self.data.len(),
                    gap: None,
                    ends_span: part + 1 == layout.parts,
                    bow: Vector3::zeros(),
                });
            }
        }
        self.find_gaps(robot, chain);
        self.rest(robot, tables);
    }

    fn add_node(&mut self, robot: &Robot, chain: &Chain, span: usize, s: f64, weight: f64) {
        let of = &chain.spans[span];
        let section = &robot.sections[of.section];
        let (shear, bend) = of.stiffness(robot, s);
        let first = self.passing.len();
        for (tendon, routed) in robot.tendons.iter().enumerate() {
            let end = robot.tendon_end(routed);
            if of.passes(routed) && s < end {
                let (hole, along) = routed.path.hole(s / end, end);
                let slack = Pull { hole, along, tension: 0.0, gap: of.gap(routed) };
                self.passing.push(Passing { tendon, slack, share: 1.0 });
            }
        }
        self.data.push(NodeData {
            weight,
            shear,
            bend,
            rest_curvature: section.rest_curvature,
            force: of.dead_force(robot, s),
            moment_per_length: of.moment_per_length,
            following_moment: of.following_moment,
            mass_moment: of.mass_moment(robot, s),
            left_out: [Vector3::zeros(); 2],
            passing: first..self.passing.len(),
            gap: None,
        });
    }

    /// The gaps between plates, and the chords in each.
    fn find_gaps(&mut self, robot: &Robot, chain: &Chain) {
        self.gaps.clear();
        self.chords.clear();
        let same = 1e-9 * chain.length;
        let mut last = (f64::NAN, 0..0);
        for pair in chain.plates.windows(2) {
            let first = self.chords.len();
            for (tendon, routed) in robot.tendons.iter().enumerate() {
                let end = robot.tendon_end(routed);
                if routed.routing == Routing::Guides && pair[1] <= end + same {
                    let hole = |s: f64| routed.path.hole(s / end, end).0;
                    // where the chord before has ended
                    let before = self.chords[last.1.clone()].iter().find(|chord| chord.tendon == tendon);
                    let start = before
                        .filter(|_| last.0 == pair[0])
                        .map_or_else(|| hole(pair[0]), |chord| chord.holes[1]);
                    self.chords.push(Chord { tendon, holes: [start, hole(pair[1])], share: 1.0 });
                }
            }
            last = (pair[1], first..self.chords.len());
            let inside = |panel: &Panel| panel.from > pair[0] - same && panel.from < pair[1] - same;
            let start = self.panels.iter().position(inside).unwrap_or(self.panels.len());
            let count = self.panels[start..].iter().take_while(|panel| inside(panel)).count();
            for panel in &mut self.panels[start..start + count] {
                panel.gap = Some(self.gaps.len());
                self.data[panel.nodes.clone()].iter_mut().for_each(|data| data.gap = panel.gap);
            }
            self.gaps.push(Gap { panels: start..start + count, chords: first..self.chords.len() });
        }
    }

    /// Puts every node at rest: no wrench.
    pub(super) fn rest(&mut self, robot: &Robot, tables: &Tables) {
        self.v.clear();
        self.v.resize(self.data.len(), Vector3::z());
        self.turn.clear();
        self.turn.resize(self.data.len(), Vector3::zeros());
        for panel in &self.panels {
            let table = tables.of(panel.nodes.len());
            for (node, point) in panel.nodes.clone().zip(&table.points) {
                // u* is constant along a section
                self.turn[node] = point * panel.length * self.data[node].rest_curvature;
            }
        }
        self.rotations.clear();
        self.rotations.push(*robot.base.rotation.matrix());
        self.positions.clear();
        self.positions.push(robot.base.position);
        for (k, panel) in self.panels.iter().enumerate() {
            let curvature = self.data[panel.nodes.start].rest_curvature;
            let turn = RotationVector::new(panel.length * curvature);
            self.rotations.push(if curvature == Vector3::zeros() {
                self.rotations[k]
            } else {
                self.rotations[k] * turn.rotation()
            });
        }
        self.positions.resize(self.panels.len() + 1, Vector3::zeros());
    }

    /// Turn from the start of the panel to its end.
    pub(super) fn end_turn(&self, panel: &Panel, table: &Collocation) -> Vector3<f64> {
        weighted(&table.end, &self.turn[panel.nodes.clone()])
    }
}

/// The shape between the nodes.
pub(super) struct Sample {
    pub(super) position: Vector3<f64>,
    pub(super) rotation: Matrix3<f64>,
    pub(super) v: Vector3<f64>,
    pub(super) u: Vector3<f64>,
}

impl Mesh {
    /// Whether a gap begins with panel `k`.
    pub(super) fn begins_gap(&self, k: usize) -> bool {
        self.panels[k].gap.is_some_and(|gap| self.gaps[gap].panels.start == k)
    }

    /// Number of the panel that holds `s`, the earlier one at a cut.
    pub(super) fn panel_at(&self, s: f64) -> usize {
        self.panels.partition_point(|panel| panel.from + SAME_PLACE * panel.length < s).saturating_sub(1)
    }

    /// The placed shape at `s`, on the base side of a cut.
    pub(super) fn at(&self, tables: &Tables, s: f64) -> Sample {
        let k = self.panel_at(s);
        let panel = &self.panels[k];
        let table = tables.of(panel.nodes.len());
        let t = ((s - panel.from) / panel.length).clamp(0.0, 1.0);
        let (rotation, v, u) = self.within(panel, table, &self.rotations[k], t);
        let mut position = self.positions[k];
        for (point, weight) in table.points.iter().zip(&table.weights) {
            let (rotation, v, _) = self.within(panel, table, &self.rotations[k], t * point);
            position += (t * weight * panel.length) * (rotation * v);
        }
        Sample { position, rotation, v, u }
    }

    fn rotation_and_v(&self, tables: &Tables, s: f64) -> (Matrix3<f64>, Vector3<f64>) {
        let k = self.panel_at(s);
        let panel = &self.panels[k];
        let t = ((s - panel.from) / panel.length).clamp(0.0, 1.0);
        if t == 1.0 {
            let (.., v) = self.interpolated(panel, &tables.of(panel.nodes.len()).finish);
            return (self.rotations[k + 1], v);
        }
        let (rotation, v, _) = self.within(panel, tables.of(panel.nodes.len()), &self.rotations[k], t);
        (rotation, v)
    }

    /// Tension of a channel tendon at `s` in panel `k` over that at the base.
    pub(super) fn share(&self, tables: &Tables, k: usize, tendon: usize, s: f64) -> f64 {
        let panel = &self.panels[k];
        let table = tables.of(panel.nodes.len());
        let t = ((s - panel.from) / panel.length).clamp(0.0, 1.0);
        let of = |node: usize| {
            let passing = &self.passing[self.data[node].passing.clone()];
            passing.iter().find(|passing| passing.tendon == tendon).map_or(1.0, |passing| passing.share)
        };
        let row = table.row(t);
        panel.nodes.clone().zip(&row.inner).map(|(node, inner)| inner * of(node)).sum()
    }

    /// Rotation and strains at a fraction of a panel.
    fn within(
        &self,
        panel: &Panel,
        table: &Collocation,
        start: &Matrix3<f64>,
        t: f64,
    ) -> (Matrix3<f64>, Vector3<f64>, Vector3<f64>) {
        let (turn, rate, v) = self.interpolated(panel, &table.row(t));
        let turn = RotationVector::new(turn);
        (start * turn.rotation(), v, turn.jacobian() * rate)
    }

    /// Turn, its rate, and v.
    pub(super) fn interpolated(
        &self,
        panel: &Panel,
        row: &Row,
    ) -> (Vector3<f64>, Vector3<f64>, Vector3<f64>) {
        let (mut turn, mut rate) =
            (row.bow * panel.length * panel.bow, row.bow_slope * panel.length * panel.bow);
        let mut v = Vector3::zeros();
        for (j, node) in panel.nodes.clone().enumerate() {
            turn += row.value[j] * self.turn[node];
            rate += row.slope[j] * self.turn[node];
            v += row.inner[j] * self.v[node];
        }
        (turn, rate / panel.length, v)
    }

    /// Starts from the shape of another mesh on the same chain.
    pub(super) fn prolong(&mut self, from: &Mesh, tables: &Tables) {
        for k in 0..self.panels.len() {
            let panel = &self.panels[k];
            let start = if k == 0 { self.rotations[0] } else { from.rotation_and_v(tables, panel.from).0 };
            let points = &tables.of(panel.nodes.len()).points;
            for (node, point) in panel.nodes.clone().zip(points) {
                let (rotation, v) = from.rotation_and_v(tables, panel.from + point * panel.length);
                self.turn[node] = rotation_vector(&start.tr_mul(&rotation));
                self.v[node] = v;
            }
        }
    }

    /// Starts from stations along the backbone, base to tip: their strains, and their rotations in between.
    pub(super) fn take_shape(&mut self, tables: &Tables, shape: &[Station]) {
        let rotation_at = |s: f64| {
            let k = shape.partition_point(|station| station.s < s).clamp(1, shape.len() - 1);
            let (a, b) = (&shape[k - 1], &shape[k]);
            let t = ((s - a.s) / (b.s - a.s)).clamp(0.0, 1.0);
            let turn = rotation_vector(&a.rotation.tr_mul(&b.rotation));
            (a.rotation * RotationVector::new(t * turn).rotation(), a.v.lerp(&b.v, t))
        };
        for panel in &self.panels {
            let start = rotation_at(panel.from).0;
            let points = &tables.of(panel.nodes.len()).points;
            for (node, point) in panel.nodes.clone().zip(points) {
                let (rotation, v) = rotation_at(panel.from + point * panel.length);
                self.turn[node] = rotation_vector(&start.tr_mul(&rotation));
                self.v[node] = v;
            }
        }
    }

    /// Takes over the shape of a mesh with the same layout.
    pub(super) fn copy_shape(&mut self, from: &Mesh) {
        self.turn.clone_from(&from.turn);
        self.v.clone_from(&from.v);
        self.bows = from.bows;
        for (panel, from) in self.panels.iter_mut().zip(&from.panels) {
            panel.bow = from.bow;
        }
    }

    /// Poses of the panels' middles on the placed shape.
    pub(super) fn find_middles(&mut self, sweep: &Sweep, tables: &Tables) {
        self.middles.clear();
        for (k, panel) in self.panels.iter().enumerate() {
            let table = tables.of(panel.nodes.len());
            let mut turn = table.middle.bow * panel.length * panel.bow;
            let mut position = self.positions[k];
            for (j, node) in panel.nodes.clone().enumerate() {
                let shape = &sweep.shapes[node];
                turn += table.middle.value[j] * self.turn[node];
                position += (panel.length * table.to_middle[j]) * (shape.rotation * shape.v);
            }
            self.middles.push((position, self.rotations[k] * RotationVector::new(turn).rotation()));
        }
    }

    /// Largest of a turn's two coefficients of highest degree, times the panel's part of the length: what a higher degree might add. One
    /// of the two may vanish by symmetry. Where panels bow, of what this adds.
    pub(super) fn tail(&self, tables: &Tables) -> f64 {
        if self.bows {
            return self.largest_bow();
        }
        let of = |panel: &Panel| {
            let table = tables.of(panel.nodes.len());
            let turns = &self.turn[panel.nodes.clone()];
            let [top, next] = [&table.top, &table.below_top].map(|row| weighted(row, turns).norm_squared());
            larger(top, next).sqrt() * panel.length
        };
        self.panels.iter().map(of).fold(0.0, larger)
    }

    /// Largest turn of a panel.
    pub(super) fn largest_turn(&self, tables: &Tables) -> f64 {
        let turn = |panel: &Panel| self.end_turn(panel, tables.of(panel.nodes.len())).norm();
        self.panels.iter().map(turn).fold(0.0, larger)
    }
}
