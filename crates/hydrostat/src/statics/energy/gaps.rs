//! The nodes between guides beside the averaged robot: where they lie in it, and what they have and lack beyond it.

use super::bow::lost_by_sums;
use super::mesh::{Mesh, Tables};
use super::sweep::{Column, Sweep, weighted};
use crate::numeric::collocation::MOST;
use nalgebra::Vector3;

/// A force and a moment, body frame.
type Wrench = [Vector3<f64>; 2];

/// The nodes of a mesh with guides beside one of the averaged robot.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    /// Where the nodes lie in the averaged robot.
    places: Vec<Place>,
    /// Turn and v beyond the averaged robot's, per node.
    turn: Vec<Vector3<f64>>,
    v: Vec<Vector3<f64>>,
    /// What the strains of the nodes fall short by, per node, and what of it the averaged robot can take over.
    lacking: Vec<Wrench>,
    shared: Vec<Wrench>,
    /// The latter at the nodes of the averaged robot.
    of_averaged: Vec<Wrench>,
    /// The averaged robot where it stood when the nodes were placed last.
    pub(super) beside: Mesh,
}

/// A panel, and what the nodes of it contribute to the polynomial through them.
#[derive(Clone, Copy, Debug)]
struct Place {
    panel: usize,
    parts: [f64; MOST],
}

impl Gaps {
    /// Finds the places of the nodes of a new mesh, which have nothing beyond the averaged robot yet.
    pub(super) fn lay(&mut self, gaps: &Mesh, averaged: &Mesh, tables: &Tables) {
        self.places.clear();
        for panel in &gaps.panels {
            for point in &tables.of(panel.nodes.len()).points {
                let s = panel.from + point * panel.length;
                let k = averaged.panel_at(s);
                let of = &averaged.panels[k];
                let parts = tables.of(of.nodes.len()).inner((s - of.from) / of.length);
                self.places.push(Place { panel: k, parts });
            }
        }
        for of in [&mut self.turn, &mut self.v] {
            of.clear();
            of.resize(gaps.data.len(), Vector3::zeros());
        }
    }

    /// Sets the turns and v of the nodes to those by the strains of the averaged robot, with what they have beyond.
    pub(super) fn place(&mut self, averaged: &Mesh, sweep: &Sweep, gaps: &mut Mesh, tables: &Tables) {
        self.beside.clone_from(averaged);
        for panel in &gaps.panels {
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let mut rates = [Vector3::zeros(); MOST];
            for ((rate, node), t) in rates.iter_mut().zip(panel.nodes.clone()).zip(&table.points) {
                let Place { panel: k, parts } = &self.places[node];
                let (mut u, mut v) = (Vector3::zeros(), self.v[node]);
                for (shape, part) in sweep.shapes[averaged.panels[*k].nodes.clone()].iter().zip(parts) {
                    u += *part * shape.u;
                    v += *part * shape.v;
                }
                gaps.v[node] = v;
                *rate = inverse_jacobian(&(t * panel.length * u), &u);
            }
            for (row, node) in table.to_point.chunks_exact(points).zip(panel.nodes.clone()) {
                gaps.turn[node] = self.turn[node] + panel.length * weighted(row, &rates[..points]);
            }
        }
    }

    /// What the strains of every node fall short by, theory (68), from minus the gradient.
    pub(super) fn find_lacking(&mut self, sweep: &Sweep, mesh: &Mesh, tables: &Tables, downhill: &Column) {
        self.lacking.clear();
        self.lacking.resize(mesh.data.len(), Wrench::default());
        // moment from beyond, world frame
        let mut beyond = Vector3::zeros();
        for (k, panel) in mesh.panels.iter().enumerate().rev() {
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let forms = &downhill.nodes[panel.nodes.clone()];
            beyond += mesh.rotations[k + 1] * downhill.cuts[k + 1];
            let end = sweep.panels[k].end.jacobian.tr_mul(&mesh.rotations[k + 1].tr_mul(&beyond));
            let mut turns = [Vector3::zeros(); MOST];
            for (local, form) in forms.iter().enumerate() {
                turns[local] += form.turn + table.end[local] * end;
                let rate = form.rate / panel.length;
                for (turn, d) in turns.iter_mut().zip(&table.derivative[local * points..(local + 1) * points])
                {
                    *turn += *d * rate;
                }
            }
            for (turn, node) in turns.iter_mut().zip(panel.nodes.clone()) {
                // J(w)^T = J(-w)
                *turn = sweep.shapes[node].rotation * inverse_jacobian(&-mesh.turn[node], turn);
            }
            for (local, node) in panel.nodes.clone().enumerate() {
                let rows = table.to_point.chunks_exact(points);
                let sum: Vector3<f64> = rows.zip(&turns).map(|(row, turn)| row[local] * turn).sum();
                let moment = sweep.shapes[node].rotation.tr_mul(&sum) / table.weights[local];
                self.lacking[node] = [forms[local].v / mesh.data[node].weight, moment];
            }
            beyond += mesh.rotations[k] * forms.iter().map(|form| form.start).sum::<Vector3<f64>>();
            if let Some(gap) = panel.gap.filter(|_| mesh.begins_gap(k)) {
                beyond += mesh.rotations[k] * downhill.gaps[gap][1];
            }
        }
    }

    /// Makes up for what the sums over the points lose of the force along the backbone, theory (70).
    pub(super) fn make_up(&mut self, sweep: &Sweep, mesh: &Mesh, tables: &Tables) {
        for panel in &mesh.panels {
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let top = mesh.highest_bend(panel, table, sweep);
            let lost = lost_by_sums(points) * panel.length * panel.length;
            for (local, node) in panel.nodes.clone().enumerate() {
                // the highest polynomial's value there
                let value = table.top_of_rate[local] / ((2 * points - 1) as f64 * table.weights[local]);
                let compression = -sweep.locals[node].force().z;
                self.lacking[node][1] += lost * compression * value * Vector3::new(top.x, top.y, 0.0);
            }
        }
    }

    /// Finds what of it the averaged robot can take over: its projection on the polynomials there.
    pub(super) fn share(&mut self, gaps: &Mesh, averaged: &Mesh) {
        self.of_averaged.clear();
        self.of_averaged.resize(averaged.data.len(), Wrench::default());
        for ((place, data), lacking) in self.places.iter().zip(&gaps.data).zip(&self.lacking) {
            for (own, part) in averaged.panels[place.panel].nodes.clone().zip(&place.parts) {
                let scale = data.weight * part / averaged.data[own].weight;
                self.of_averaged[own].iter_mut().zip(lacking).for_each(|(sum, lacks)| *sum += scale * lacks);
            }
        }
        self.shared.clear();
        self.shared.extend(self.places.iter().map(|place| {
            let mut sum = Wrench::default();
            for (own, part) in averaged.panels[place.panel].nodes.clone().zip(&place.parts) {
                sum.iter_mut().zip(&self.of_averaged[own]).for_each(|(sum, of)| *sum += *part * of);
            }
            sum
        }));
    }

    /// Lets every node give way to the rest.
    pub(super) fn give_way(&mut self, mesh: &Mesh, sweep: &Sweep, tables: &Tables) {
        for panel in &mesh.panels {
            let (table, points) = (tables.of(panel.nodes.len()), panel.nodes.len());
            let mut bends = [Vector3::zeros(); MOST];
            for (bend, node) in bends.iter_mut().zip(panel.nodes.clone()) {
                let data = &mesh.data[node];
                let [force, moment] = [0, 1].map(|part| self.lacking[node][part] - self.shared[node][part]);
                self.v[node] += force.component_div(&data.shear);
                *bend = sweep.shapes[node].since_start * moment.component_div(&data.bend);
            }
            for (row, node) in table.to_point.chunks_exact(points).zip(panel.nodes.clone()) {
                let sum: Vector3<f64> = row.iter().zip(&bends).map(|(weight, bend)| *weight * bend).sum();
                let turned = sweep.shapes[node].since_start.tr_mul(&(panel.length * sum));
                self.turn[node] += inverse_jacobian(&mesh.turn[node], &turned);
            }
        }
    }

    /// Adds what the averaged robot can take over to what its section law leaves out.
    pub(super) fn leave_out(&self, averaged: &mut Mesh) {
        for (data, of) in averaged.data.iter_mut().zip(&self.of_averaged) {
            data.left_out.iter_mut().zip(of).for_each(|(left_out, of)| *left_out -= of);
        }
    }
}

/// J(w)^-1 a, theory (24), up to the second order in w; the next is the fourth.
fn inverse_jacobian(w: &Vector3<f64>, a: &Vector3<f64>) -> Vector3<f64> {
    let across = w.cross(a);
    a + 0.5 * across + w.cross(&across) / 12.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Routing;
    use crate::statics::chain::Chain;
    use crate::statics::energy::mesh::Layout;
    use crate::statics::energy::sweep::{Problem, Step};
    use crate::statics::energy::tests::{energy, robot};

    /// Any change of the strains changes the energy by what they fall short by.
    #[test]
    fn what_the_strains_lack_is_the_slope_of_the_energy() {
        let robot = robot(&[Routing::Guides; 2]);
        let (mut chain, tables) = (Chain::default(), Tables::default());
        chain.rebuild(&robot);
        let (mut mesh, mut sweep, mut downhill) = (Mesh::default(), Sweep::default(), Column::default());
        let layouts: Vec<Layout> = chain.spans.iter().map(|_| Layout { parts: 4, points: 3 }).collect();
        mesh.rebuild(&robot, &chain, &layouts, &tables);
        for (i, (turn, v)) in mesh.turn.iter_mut().zip(&mut mesh.v).enumerate() {
            let phase = i as f64;
            *turn += 0.03 * Vector3::new(phase.sin(), (1.7 * phase).cos(), (2.3 * phase).sin());
            *v += 0.05 * Vector3::new((0.7 * phase).cos(), (1.1 * phase).sin(), (1.9 * phase).cos());
        }
        let (factor, gravity) = (0.9, robot.gravity);
        let problem = Problem { chain: &chain, tables: &tables, factor, gravity, tensions: &[1.0, 2.0] };
        sweep.place(&mut mesh, &tables);
        sweep.gradient(&problem, &mesh, &mut downhill);
        downhill.negate();
        let mut gaps = Gaps::default();
        gaps.find_lacking(&sweep, &mesh, &tables, &downhill);

        let du = |node: usize| Vector3::new((0.9 * node as f64).sin(), (2.1 * node as f64).cos(), 0.3);
        let mut step = Step { turn: mesh.turn.clone(), v: mesh.v.clone(), ..Step::default() };
        let mut fallen = 0.0;
        for panel in &mesh.panels {
            let rows = tables.of(panel.nodes.len()).to_point.chunks_exact(panel.nodes.len());
            for (row, node) in rows.zip(panel.nodes.clone()) {
                let bends: Vec<_> =
                    panel.nodes.clone().map(|of| sweep.shapes[of].rotation * du(of)).collect();
                let turned = sweep.shapes[node].rotation.tr_mul(&(panel.length * weighted(row, &bends)));
                step.turn[node] = sweep.shapes[node].jacobian.try_inverse().expect("is regular") * turned;
                step.v[node] = 0.1 * du(node).yzx();
                let [force, moment] = gaps.lacking[node];
                fallen += mesh.data[node].weight * (force.dot(&step.v[node]) + moment.dot(&du(node)));
            }
        }
        let at = |h: f64| energy(&problem, &mesh, &mut Sweep::default(), &step, h);
        let slope = (at(1e-4) - at(-1e-4)) / 2e-4;
        assert!((slope + fallen).abs() < 1e-6 * slope.abs(), "{slope} {fallen}");
    }
}
