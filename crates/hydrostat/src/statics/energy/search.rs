//! From the unloaded shape to the loaded one: load continuation, then finer meshes.

use super::mesh::Layout;
use super::newton::{Converged, Equations, Stuck};
use super::{Energy, Memory, friction, tendons};
use crate::model::Routing;
use crate::numeric::collocation::MOST;
use crate::numeric::larger;
use crate::solution::{Station, TendonState};
use crate::statics::Settings;
use crate::statics::chain::{Chain, POINTS, Span, Step};
use crate::statics::rod::{self, Node};
use crate::{Error, Robot};
use nalgebra::{Matrix3, Vector3};

/// What the search found, beside the shape in `Energy::fine`.
#[derive(Clone, Debug)]
pub(in crate::statics) struct Found {
    pub(in crate::statics) residual: f64,
    pub(in crate::statics) error_estimate: f64,
    pub(in crate::statics) negative: usize,
    pub(in crate::statics) smallest_eigenvalue: Option<f64>,
    pub(in crate::statics) unstable_from: Option<f64>,
    pub(in crate::statics) snapped_from: Option<f64>,
    pub(in crate::statics) iterations: usize,
}

/// Largest turn that a panel is laid out for, and with which it is cut in two, rad.
const FIRST_TURN: f64 = 0.8;
const LARGEST_TURN: f64 = 1.3;
/// Points of the first mesh; more where panels turn much.
const FIRST_POINTS: usize = 3;
/// Factor on the error estimate, for what two or three solutions cannot tell.
const SAFETY: f64 = 3.0;
/// What is assumed of the reduction by one more point before it has been seen, and the largest that is believed.
const UNSEEN_REDUCTION: f64 = 8.0;
const LARGEST_REDUCTION: f64 = 64.0;
const SLOWEST_REDUCTION: f64 = 2.0;
/// Length, in parts of the whole, that an error of the part of a tension that friction leaves counts for.
const SHARES: f64 = 0.01;
const MOST_NODES: usize = 20_000;
/// A load step may turn no cross-section by more (radians).
const LARGEST_LOAD_TURN: f64 = 0.7;
/// Load steps are measured in parts of the load that they lead to. A first unstable shape is accepted only where they are this small.
const UNSTABLE_BELOW: f64 = 1.0 / 4096.0;
const SMALLEST_LOAD_STEP: f64 = 1.0 / 65_536.0;
const SMALLEST_LOAD: f64 = 1e-9;
/// A search gives up after so many nodes linearised.
const MOST_WORK: usize = 1_000_000;
/// By how much the loads grow where the robot snaps, and how often it may.
const SNAP: f64 = 1e-3;
const MOST_SNAPS: usize = 20;
/// How often the way is begun anew on the panels that its end needed.
const MOST_RESTARTS: usize = 3;
const MOST_BISECTIONS: usize = 6;
/// Turns of Newton's method and friction, and a change of the shares that has not become small enough.
const MOST_TURNS: usize = 200;
const SLOW: f64 = 0.7;
/// Stations are integrated in steps of at most this angle, of shape and load, rad.
const STATION_ANGLE: f64 = 0.3;
/// Accuracy on the way to the full load: enough to start the next step.
const ON_THE_WAY: f64 = 1e-7;

/// Where a search begins.
#[derive(Clone, Copy)]
pub(in crate::statics) enum Start<'a> {
    /// The unloaded shape.
    Rest,
    /// The last solution, where it fits.
    Last,
    /// A given shape, base to tip.
    Shape(&'a [Station]),
}

/// Finds an equilibrium: on the primary branch from the unloaded shape, on that of the start otherwise.
pub(in crate::statics) fn find(
    energy: &mut Energy,
    robot: &Robot,
    chain: &Chain,
    settings: &Settings,
    start: Start,
) -> Result<Found, Error> {
    let mut search =
        Search { energy, robot, chain, settings, iterations: 0, snapped_from: None, relaid: false };
    search.run(start)
}

struct Search<'a> {
    energy: &'a mut Energy,
    robot: &'a Robot,
    chain: &'a Chain,
    settings: &'a Settings,
    iterations: usize,
    /// Part of the loads at which the branch ended and the robot snapped.
    snapped_from: Option<f64>,
    /// Whether panels were cut in two on the way.
    relaid: bool,
}

impl Search<'_> {
    fn run(&mut self, start: Start) -> Result<Found, Error> {
        let tolerance = self.settings.tolerance;
        let mut unstable_from = None;
        match start {
            Start::Shape(shape) => self.start_from(shape)?,
            Start::Last if self.continue_last() => {}
            Start::Last | Start::Rest => {
                self.first_layout();
                self.lay();
                unstable_from = self.follow_load()?;
            }
        }
        self.newton(1.0, 0.1 * tolerance).map_err(|stuck| self.not_converged(1.0, &stuck))?;
        let mut last_difference: Option<f64> = None;
        let mut restarts = 0;
        // the angle that a tendon turns by converges less fast than the shape
        let rubs = self.rubs();
        let mut reduction = if rubs { SLOWEST_REDUCTION } else { UNSEEN_REDUCTION };
        loop {
            let added = self.refine();
            let end = match self.newton(1.0, 0.1 * tolerance) {
                Ok(end) => end,
                Err(_) if restarts < MOST_RESTARTS && matches!(start, Start::Rest) => {
                    // the panels were too long to believe where they led
                    restarts += 1;
                    self.energy.layouts.iter_mut().for_each(|layout| {
                        *layout = Layout { parts: 2 * layout.parts, points: FIRST_POINTS };
                    });
                    self.lay();
                    unstable_from = self.follow_load()?;
                    last_difference = None;
                    self.newton(1.0, 0.1 * tolerance).map_err(|stuck| self.not_converged(1.0, &stuck))?;
                    continue;
                }
                Err(stuck) => return Err(self.not_converged(1.0, &stuck)),
            };
            let difference = self.difference();
            if let Some(last) = last_difference.filter(|_| added) {
                let largest = if rubs { SLOWEST_REDUCTION } else { LARGEST_REDUCTION };
                reduction = (last / difference).clamp(SLOWEST_REDUCTION, largest);
            }
            last_difference = added.then_some(difference);
            let nodes = self.energy.coarse.data.len();
            let rounding =
                (end.residual.min(1e-3 * tolerance) + f64::EPSILON * nodes as f64) * self.chain.length;
            let error_estimate = SAFETY * difference / (reduction - 1.0) + rounding;
            if error_estimate <= tolerance * self.chain.length {
                return self.judge(end, error_estimate, unstable_from);
            }
            if nodes > MOST_NODES || !error_estimate.is_finite() {
                let asked = tolerance * self.chain.length;
                return Err(Error::new(format!(
                    "the shape is known to {error_estimate:.1e} m only, on {nodes} nodes, not to {asked:.1e} m"
                ))
                .hint("ask for a larger tolerance"));
            }
        }
    }

    /// Newton's method at the full load from the last solution. Returns whether it converged.
    fn continue_last(&mut self) -> bool {
        if self.energy.layouts.len() != self.chain.spans.len() || self.energy.coarse.panels.is_empty() {
            return false;
        }
        let (before, drive) = (self.energy.coarse.clone(), self.energy.memory.drive.clone());
        self.lay();
        if before.data.len() != self.energy.coarse.data.len() || drive.held != self.energy.memory.drive.held {
            return false;
        }
        self.energy.coarse.copy_shape(&before);
        self.energy.memory.drive.tensions = drive.tensions;
        self.newton(1.0, ON_THE_WAY).is_ok()
    }

    /// The equilibrium near a given shape: by Newton's method, or downhill from it.
    fn start_from(&mut self, shape: &[Station]) -> Result<(), Error> {
        self.first_layout();
        self.lay();
        for _ in 0..MOST_BISECTIONS {
            let Energy { tables, coarse, .. } = &mut *self.energy;
            coarse.take_shape(tables, shape);
            if coarse.largest_turn(tables) <= LARGEST_TURN {
                break;
            }
            for layout in &mut self.energy.layouts {
                layout.parts *= 2;
            }
            self.lay();
        }
        let given = self.energy.coarse.clone();
        if self.newton(1.0, ON_THE_WAY).is_ok() {
            return Ok(());
        }
        self.energy.coarse = given;
        self.energy.memory.drive.tensions.fill(0.0);
        self.snap(1.0, &mut 0).map_err(|stuck| {
            Error::new(format!(
                "no equilibrium found from the given shape: {} iterations, last correction {:.1e}",
                self.iterations, stuck.correction
            ))
            .hint("start from a shape of the same robot, or from the unloaded one")
        })
    }

    /// Panels for the first mesh.
    fn first_layout(&mut self) {
        self.energy.layouts.clear();
        for span in &self.chain.spans {
            let turn = span.largest_angle(self.robot) * (span.to - span.from);
            let parts = (turn / FIRST_TURN - 1e-9).ceil().clamp(1.0, 1e4) as usize;
            let points = if turn < 0.1 * FIRST_TURN { FIRST_POINTS - 1 } else { FIRST_POINTS };
            self.energy.layouts.push(Layout { parts, points });
        }
    }

    /// The coarse mesh at rest, and the tendons with it.
    fn lay(&mut self) {
        let Energy { tables, layouts, coarse, memory, .. } = &mut *self.energy;
        coarse.rebuild(self.robot, self.chain, layouts, tables);
        memory.sweep.place(coarse, tables);
        memory.drive.rest(self.robot);
        tendons::measure(coarse, &memory.sweep, &mut memory.drive.home, self.robot.tendons.len());
    }

    /// Newton's method on the coarse mesh; with friction in turns with the tensions along the tendons.
    fn newton(&mut self, factor: f64, target: f64) -> Result<Converged, Stuck> {
        let rubs = self.rubs();
        let (mut part, mut last) = (1.0, f64::INFINITY);
        for _ in 0..MOST_TURNS {
            let Energy { tables, coarse, memory, .. } = &mut *self.energy;
            let equations = Equations { robot: self.robot, chain: self.chain, tables, factor };
            let converged = equations.newton(memory, coarse, target, &mut self.iterations)?;
            if !rubs {
                return Ok(converged);
            }
            let Memory { sweep, drive, .. } = memory;
            let (means, ends) = (&mut drive.mean_shares, &mut drive.end_shares);
            let change = friction::update(self.robot, coarse, sweep, tables, part, means, ends);
            if change <= target {
                return Ok(converged);
            }
            if change > SLOW * last {
                part *= 0.5;
            }
            last = change;
        }
        Err(Stuck { correction: last })
    }

    fn rubs(&self) -> bool {
        self.robot.tendons.iter().any(|tendon| tendon.friction > 0.0)
    }

    /// Follows the primary branch as the loads grow from 0 to 1. Returns the part at which it first turned unstable.
    fn follow_load(&mut self) -> Result<Option<f64>, Error> {
        let largest_step = self.settings.largest_load_step;
        let (mut reached, mut step) = (0.0_f64, largest_step);
        let mut unstable_from = None;
        self.energy.reached.clone_from(&self.energy.coarse);
        let mut tensions = self.energy.memory.drive.tensions.clone();
        let (mut snaps, mut restarts) = (0, 0);
        let mut begun = self.iterations;
        while reached < 1.0 {
            let factor = (reached + step).min(1.0);
            let part = (factor - reached) / factor;
            let outcome = self.newton(factor, ON_THE_WAY);
            let work = (self.iterations - begun) * self.energy.coarse.data.len();
            let strayed = outcome.is_ok() && self.turned() > LARGEST_LOAD_TURN;
            let unstable = matches!(outcome, Ok(end) if end.negative > 0) && unstable_from.is_none();
            if outcome.is_ok() && !strayed && (!unstable || part < UNSTABLE_BELOW) {
                reached = factor;
                unstable_from = unstable_from.or(unstable.then_some(factor));
                step = (2.0 * step).min(largest_step);
                if self.energy.coarse.largest_turn(&self.energy.tables) > LARGEST_TURN {
                    self.bisect();
                }
                self.energy.reached.clone_from(&self.energy.coarse);
                tensions.clone_from(&self.energy.memory.drive.tensions);
            } else {
                self.energy.coarse.clone_from(&self.energy.reached);
                self.energy.memory.drive.tensions.clone_from(&tensions);
                step *= 0.5;
                if work > MOST_WORK {
                    return Err(self.not_converged(reached, &outcome.err().unwrap_or_default()));
                }
                let ends = step < SMALLEST_LOAD_STEP * factor.max(SMALLEST_LOAD);
                if ends && self.relaid && restarts < MOST_RESTARTS {
                    // the panels were too long to believe where they led
                    (restarts, self.relaid) = (restarts + 1, false);
                    (reached, step, unstable_from, begun) = (0.0, largest_step, None, self.iterations);
                    self.lay();
                    self.energy.reached.clone_from(&self.energy.coarse);
                    tensions.clone_from(&self.energy.memory.drive.tensions);
                } else if ends {
                    // the branch ends here: the robot snaps to a minimum of its energy
                    let beyond = (reached * (1.0 + SNAP)).clamp(SMALLEST_LOAD, 1.0);
                    let way = self.snap(beyond, &mut snaps);
                    way.map_err(|stuck| self.not_converged(reached, &outcome.err().unwrap_or(stuck)))?;
                    self.snapped_from = self.snapped_from.or(Some(reached));
                    (reached, step) = (beyond, largest_step);
                    self.energy.reached.clone_from(&self.energy.coarse);
                    tensions.clone_from(&self.energy.memory.drive.tensions);
                }
            }
        }
        Ok(unstable_from)
    }

    /// Minimises the energy at a part of the loads, from the shape of the coarse mesh.
    fn snap(&mut self, factor: f64, snaps: &mut usize) -> Result<(), Stuck> {
        *snaps += 1;
        if *snaps > MOST_SNAPS || !self.chain.conservative {
            return Err(Stuck::default());
        }
        for _ in 0..MOST_BISECTIONS {
            let Energy { tables, coarse, memory, .. } = &mut *self.energy;
            let equations = Equations { robot: self.robot, chain: self.chain, tables, factor };
            let outcome = equations.minimise(memory, coarse, &mut self.iterations);
            memory.drive.springs.give.clear();
            outcome?;
            if self.energy.coarse.largest_turn(&self.energy.tables) <= LARGEST_TURN {
                break;
            }
            self.bisect();
        }
        self.newton(factor, ON_THE_WAY).map(|_| ())
    }

    /// Largest angle between a cut and what it was at the last load step.
    fn turned(&self) -> f64 {
        let pairs = self.energy.coarse.rotations.iter().zip(&self.energy.reached.rotations);
        pairs.map(|(a, b)| ((a.dot(b) - 1.0) / 2.0).clamp(-1.0, 1.0).acos()).fold(0.0, larger)
    }

    /// Cuts every panel that turns much in two.
    fn bisect(&mut self) {
        let Energy { tables, layouts, coarse, .. } = &mut *self.energy;
        for panel in &coarse.panels {
            let turn = coarse.end_turn(panel, tables.of(panel.nodes.len())).norm();
            if turn > 0.5 * LARGEST_TURN && panel.ends_span {
                layouts[panel.span].parts *= 2;
                self.relaid = true;
            }
        }
        self.relay();
    }

    /// Lays the coarse mesh anew and keeps the shape.
    fn relay(&mut self) {
        let tensions = self.energy.memory.drive.tensions.clone();
        let taut = self.energy.memory.drive.taut.clone();
        std::mem::swap(&mut self.energy.coarse, &mut self.energy.fine);
        self.lay();
        let Energy { tables, coarse, fine, memory, .. } = &mut *self.energy;
        coarse.prolong(fine, tables);
        memory.sweep.place(coarse, tables);
        self.energy.memory.drive.tensions = tensions;
        self.energy.memory.drive.taut = taut;
    }

    /// One more point in every panel, or shorter panels; the mesh of before is in `fine`. Returns whether points were added.
    fn refine(&mut self) -> bool {
        let add = self.energy.layouts.iter().all(|layout| layout.points < MOST);
        for layout in &mut self.energy.layouts {
            if add {
                layout.points += 1;
            } else {
                *layout = Layout { parts: 2 * layout.parts, points: MOST - 3 };
            }
        }
        self.relay();
        add
    }

    /// Largest distance between the shapes of the coarse mesh and the one before it.
    fn difference(&self) -> f64 {
        let Energy { tables, coarse, fine, .. } = &*self.energy;
        let mut largest = 0.0;
        for (k, panel) in coarse.panels.iter().enumerate() {
            for t in [0.25, 0.5, 0.75] {
                let s = panel.from + t * panel.length;
                let apart = coarse.at(tables, s).position - fine.at(tables, s).position;
                largest = larger(largest, apart.norm());
            }
            let end = fine.at(tables, panel.from + panel.length).position;
            largest = larger(largest, (coarse.positions[k + 1] - end).norm());
        }
        if self.rubs() { larger(largest, self.difference_of_shares()) } else { largest }
    }

    /// Largest difference of the parts of the tensions that friction leaves, as a length.
    fn difference_of_shares(&self) -> f64 {
        let Energy { tables, coarse, fine, .. } = &*self.energy;
        let mut largest = 0.0;
        for (i, tendon) in self.robot.tendons.iter().enumerate().filter(|(_, tendon)| tendon.friction > 0.0) {
            let end = self.robot.tendon_end(tendon);
            for (k, panel) in coarse.panels.iter().enumerate().filter(|(_, panel)| panel.from < end) {
                let s = panel.from + 0.1 * panel.length;
                let shares = (coarse.share(tables, k, i, s), fine.share(tables, fine.panel_at(s), i, s));
                largest = larger(largest, (shares.0 - shares.1).abs());
            }
        }
        SHARES * largest * self.chain.length
    }

    fn judge(
        &mut self,
        end: Converged,
        error_estimate: f64,
        unstable_from: Option<f64>,
    ) -> Result<Found, Error> {
        if let Some(folded) = self.folded(1.0) {
            return Err(folded);
        }
        // at the last shape, not at the one before the last step
        let Energy { tables, coarse, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        let taut = memory.drive.taut.clone();
        let last = equations.linearise(memory, coarse, 0.0);
        memory.drive.taut = taut;
        let negative = last.negative.unwrap_or(end.negative);
        let smallest_eigenvalue = self.settings.eigenvalue.then(|| self.smallest_eigenvalue());
        Ok(Found {
            residual: last.residual,
            error_estimate,
            negative,
            smallest_eigenvalue,
            unstable_from: unstable_from.or((negative > 0).then_some(1.0)),
            snapped_from: self.snapped_from,
            iterations: self.iterations,
        })
    }

    /// Of the Hessian scaled by the elastic stiffness, by bisection on the inertia.
    fn smallest_eigenvalue(&mut self) -> f64 {
        const NEARLY_ONE: f64 = 0.999;
        const ACCURACY: f64 = 1e-7;
        const LOWEST: f64 = -1e6;
        let mut below = |mu: f64| self.falls_with(-mu);
        if !below(NEARLY_ONE) {
            return 1.0;
        }
        let (mut low, mut high) = if below(0.0) { (-1.0, 0.0) } else { (0.0, NEARLY_ONE) };
        while below(low) {
            (low, high) = (2.0 * low, low);
            if low < LOWEST {
                return low;
            }
        }
        while high - low > ACCURACY * (1.0 - low) {
            let middle = 0.5 * (low + high);
            if below(middle) { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    }

    /// Whether the energy with a stiffer elastic part falls in some direction.
    fn falls_with(&mut self, shift: f64) -> bool {
        let Energy { tables, coarse, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        let taut = memory.drive.taut.clone();
        let negative = equations.linearise(memory, coarse, shift).negative;
        memory.drive.taut = taut;
        negative != Some(0)
    }

    /// Tendons that the robot has bent around so far that nothing is left of their way.
    fn folded(&self, reached: f64) -> Option<Error> {
        let (tendon, s) = tendons::folded(&self.energy.coarse, &self.energy.memory.sweep)?;
        let name = &self.robot.tendons[tendon].name;
        let message = format!(
            "the robot folds about tendon \"{name}\" near s = {s:.4} m at {:.3} % of the loads: the way from hole to hole \
             shrinks to nothing there",
            100.0 * reached
        );
        Some(Error::new(message).hint("pull less, set the guides closer, or stiffen the backbone"))
    }

    fn not_converged(&self, reached: f64, stuck: &Stuck) -> Error {
        if let Some(folded) = self.folded(reached) {
            return folded;
        }
        Error::new(format!(
            "no equilibrium found beyond {:.3} % of the loads: {} Newton iterations, last correction {:.1e}",
            100.0 * reached,
            self.iterations,
            stuck.correction
        ))
        .hint("the robot probably snaps or buckles there: lower the loads, or stiffen or shorten the robot")
    }
}

impl Energy {
    /// The tendons at the solution.
    pub(in crate::statics) fn tendon_states(&self, robot: &Robot) -> Vec<TendonState> {
        let drive = &self.memory.drive;
        let state = |(i, tendon): (usize, &crate::model::Tendon)| TendonState {
            name: tendon.name.clone(),
            tension: drive.tensions[i],
            tip_tension: drive.tensions[i] * drive.end_shares.get(i).unwrap_or(&1.0),
            displacement: drive.home[i] - drive.lengths[i] + drive.compliance(robot, i) * drive.tensions[i],
            length: drive.lengths[i],
            slack: drive.held.iter().zip(&drive.taut).any(|(held, taut)| *held == i && !taut),
        };
        robot.tendons.iter().enumerate().map(state).collect()
    }

    /// The state at `s`, on the base side of a jump: integrated back from the end of its panel, where the solution is most
    /// accurate.
    pub(in crate::statics) fn station(&self, robot: &Robot, chain: &Chain, s: f64) -> Station {
        let Energy { coarse, memory, .. } = self;
        let k = coarse.panel_at(s);
        let panel = &coarse.panels[k];
        let span = &chain.spans[panel.span];
        let chords = memory.sweep.chord_force(panel);
        let (end, rest) = (panel.from + panel.length, (panel.from + panel.length - s).max(0.0));
        let (_, bend) = robot.sections[span.section].stiffness(span.fraction(robot, s));
        let force = (span.dead_force(robot, s) + chords).norm();
        let per_length = (force / bend.min()).sqrt().max(span.largest_angle(robot));
        let angle = rest * per_length.max(LARGEST_TURN / panel.length);
        let parts = (angle / STATION_ANGLE).ceil().max(1.0);
        let mut node = Node {
            rotation: coarse.rotations[k + 1],
            moment: coarse.rotations[k + 1] * memory.sweep.end_moment(k),
            force: Vector3::zeros(),
        };
        let mut position = coarse.positions[k + 1];
        let mut step = self.step_with_chords(robot, span, k, end, -rest / parts);
        for part in 0..parts as usize {
            if part > 0 {
                step = self.step_with_chords(robot, span, k, end - part as f64 * rest / parts, -rest / parts);
            }
            let (next, displacement) = rod::integrate(&step, 1.0, &node);
            (node, position) = (next, position + displacement);
        }
        let section = rod::section_law(&step, rod::END, 1.0, &node);
        Station {
            s,
            position,
            rotation: node.rotation,
            v: section.v,
            u: section.u,
            force: node.rotation * section.backbone_force(&step),
            moment: node.rotation * section.backbone_moment(&step),
        }
    }

    /// A step within panel `k`, under the chords beside it and the tensions that friction leaves.
    fn step_with_chords(&self, robot: &Robot, span: &Span, k: usize, from: f64, length: f64) -> Step {
        let Energy { tables, coarse, memory, .. } = self;
        let mut step = span.step(robot, &memory.drive.tensions, from, length);
        let chords = memory.sweep.chord_force(&coarse.panels[k]);
        step.stages.iter_mut().for_each(|stage| stage.force += chords);
        if !memory.drive.mean_shares.is_empty() {
            let middle = 0.5 * (span.from + span.to);
            let passing = (0..robot.tendons.len()).filter(|&i| {
                let tendon = &robot.tendons[i];
                tendon.routing == Routing::Channel && middle < robot.tendon_end(tendon)
            });
            for (points, i) in step.pulls.iter_mut().zip(passing) {
                for (pull, c) in points.iter_mut().zip(POINTS) {
                    pull.tension *= coarse.share(tables, k, i, from + c * length);
                }
            }
        }
        step
    }

    /// Span, arc length, v and u at several places of every panel, both ends included.
    pub(in crate::statics) fn for_each_strain(
        &self,
        mut visit: impl FnMut(usize, f64, &Vector3<f64>, &Vector3<f64>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        for panel in &self.coarse.panels {
            let table = self.tables.of(panel.nodes.len());
            for (i, row) in table.quarters.iter().enumerate() {
                let (v, u) = self.coarse.strains(panel, row);
                visit(panel.span, panel.from + 0.25 * i as f64 * panel.length, &v, &u)?;
            }
        }
        Ok(())
    }

    /// Pose of the tip.
    pub(in crate::statics) fn tip(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let last = self.coarse.panels.len();
        (self.coarse.positions[last], self.coarse.rotations[last])
    }
}
