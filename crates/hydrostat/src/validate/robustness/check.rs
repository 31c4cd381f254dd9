//! Whether a shape is an equilibrium, without the solver: every station is integrated on to the next one.

use super::random::softest;
use crate::model::{Frame, LoadKind, Section};
use crate::solution::Station;
use crate::{Equilibrium, Robot};
use nalgebra::{Matrix3, Vector3};

/// Runge-Kutta steps over the length of the rod.
const STEPS: f64 = 1600.0;

/// How far a shape is from an equilibrium; lengths in units of L, forces of EI/L^2, moments of EI/L, angles in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defects {
    /// Position and rotation of the first station against the base.
    pub base: f64,
    /// Position, rotation, force and moment against the integral from the station before; summed along the rod.
    pub balance: f64,
    /// Wrench beyond the last station.
    pub tip: f64,
    /// v against 1 + K_se^-1 R^T n and u against u* + K_bt^-1 R^T m; the largest, in radians over the length.
    pub section_law: f64,
    /// Departure of a rotation from R^T R = 1; the largest.
    pub rotation: f64,
}

impl Defects {
    /// The largest of all; NaN if one is.
    pub fn largest(&self) -> f64 {
        [self.base, self.balance, self.tip, self.section_law, self.rotation].into_iter().fold(0.0, larger)
    }
}

/// Checks a solution with at least two stations.
pub fn defects(robot: &Robot, found: &Equilibrium) -> Defects {
    let check = Check::new(robot);
    let (Some(first), Some(last)) = (found.stations.first(), found.stations.last()) else {
        return Defects { base: f64::NAN, ..Defects::default() };
    };
    let states: Vec<State> = found.stations.iter().map(State::of).collect();
    let sum = |a: f64, b: f64| a + b;
    let base =
        State { position: robot.base.position, rotation: *robot.base.rotation.matrix(), ..State::of(first) };
    let beyond = check.jump(last.s, &State::of(last));
    let pairs = found.stations.windows(2).zip(states.windows(2));
    Defects {
        base: check.distance(&base, &states[0]),
        balance: pairs
            .map(|(s, state)| check.distance(&check.integrate(s[0].s, s[1].s, state[0]), &state[1]))
            .fold(0.0, sum),
        tip: check.wrench(&beyond.force, &beyond.moment),
        section_law: found.stations.iter().map(|station| check.section_law(station)).fold(0.0, larger),
        rotation: states
            .iter()
            .map(|state| (state.rotation.transpose() * state.rotation - Matrix3::identity()).norm())
            .fold(0.0, larger),
    }
}

/// The larger of two numbers; NaN, which `f64::max` drops, is the largest.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// State of a cross-section, world frame; also its derivative by s.
#[derive(Clone, Copy)]
struct State {
    position: Vector3<f64>,
    rotation: Matrix3<f64>,
    force: Vector3<f64>,
    moment: Vector3<f64>,
}

impl State {
    fn of(station: &Station) -> State {
        State {
            position: station.position,
            rotation: station.rotation,
            force: station.force,
            moment: station.moment,
        }
    }

    fn plus(&self, h: f64, rate: &State) -> State {
        State {
            position: self.position + h * rate.position,
            rotation: self.rotation + h * rate.rotation,
            force: self.force + h * rate.force,
            moment: self.moment + h * rate.moment,
        }
    }
}

/// A robot with the arc lengths at which something changes.
struct Check<'a> {
    robot: &'a Robot,
    length: f64,
    /// Softest E I.
    ei: f64,
    /// Where the sections begin.
    starts: Vec<f64>,
    breaks: Vec<f64>,
}

impl Check<'_> {
    fn new(robot: &Robot) -> Check<'_> {
        let mut end = 0.0;
        let mut starts = Vec::new();
        for section in &robot.sections {
            starts.push(end);
            end += section.length;
        }
        let mut breaks = starts.clone();
        for load in &robot.loads {
            match load.kind {
                LoadKind::Point { at, .. } | LoadKind::Mass { at, .. } => breaks.push(at),
                LoadKind::Distributed { from, to, .. } => breaks.extend([from, to]),
            }
        }
        breaks.sort_by(f64::total_cmp);
        Check { robot, length: robot.length(), ei: softest(robot), starts, breaks }
    }

    /// Arc lengths closer than this are the same place.
    fn same(&self, a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12 * self.length
    }

    /// The section that holds an arc length strictly inside, or ends there; and the fraction of it.
    fn section(&self, s: f64) -> (&Section, f64) {
        let index = (0..self.starts.len())
            .rev()
            .find(|&i| s > self.starts[i] && !self.same(s, self.starts[i]))
            .unwrap_or(0);
        let section = &self.robot.sections[index];
        (section, ((s - self.starts[index]) / section.length).clamp(0.0, 1.0))
    }

    /// Strains v, u from the wrench, in a section (G 13, G 15).
    fn strains(&self, section: &Section, fraction: f64, state: &State) -> (Vector3<f64>, Vector3<f64>) {
        let (se, bt) = section.stiffness(fraction);
        let to_body = state.rotation.transpose();
        (
            Vector3::z() + (to_body * state.force).component_div(&se),
            section.rest_curvature + (to_body * state.moment).component_div(&bt),
        )
    }

    fn section_law(&self, station: &Station) -> f64 {
        let (section, fraction) = self.section(station.s);
        let (v, u) = self.strains(section, fraction, &State::of(station));
        (v - station.v).norm() + self.length * (u - station.u).norm()
    }

    /// Subtracts the point loads at s: the limit from the tip's side.
    fn jump(&self, s: f64, state: &State) -> State {
        let mut state = *state;
        for load in &self.robot.loads {
            match load.kind {
                LoadKind::Point { at, force, moment, frame } if self.same(at, s) => {
                    let axes = axes(frame, &state);
                    state.force -= axes * force;
                    state.moment -= axes * moment;
                }
                LoadKind::Mass { at, mass } if self.same(at, s) => state.force -= mass * self.robot.gravity,
                _ => {}
            }
        }
        state
    }

    /// From the base's side of one station to the base's side of the next, through the breaks in between.
    fn integrate(&self, from: f64, to: f64, state: State) -> State {
        let inside = self.breaks.iter().copied().filter(|&s| s > from && s < to);
        let inside = inside.filter(|&s| !self.same(s, from) && !self.same(s, to));
        let mut state = state;
        let mut start = from;
        for end in inside.chain([to]) {
            if start > 0.0 {
                state = self.jump(start, &state);
            }
            let count = ((end - start) / self.length * STEPS).ceil().max(1.0);
            let h = (end - start) / count;
            // strictly inside: decides which section and which distributed loads
            let middle = 0.5 * (start + end);
            for i in 0..count as usize {
                let s = start + i as f64 * h;
                let a = self.rate(s, middle, &state);
                let b = self.rate(s + 0.5 * h, middle, &state.plus(0.5 * h, &a));
                let c = self.rate(s + 0.5 * h, middle, &state.plus(0.5 * h, &b));
                let d = self.rate(s + h, middle, &state.plus(h, &c));
                state = state.plus(h / 6.0, &a).plus(h / 3.0, &b).plus(h / 3.0, &c).plus(h / 6.0, &d);
            }
            start = end;
        }
        state
    }

    /// Derivative by s (G 3, 4, 6, 11).
    fn rate(&self, s: f64, inside: f64, state: &State) -> State {
        let (section, at_inside) = self.section(inside);
        let fraction = at_inside + (s - inside) / section.length;
        let (v, u) = self.strains(section, fraction.clamp(0.0, 1.0), state);
        let area = section.cross_section(fraction.clamp(0.0, 1.0)).area();
        let mut force = section.material.density * area * self.robot.gravity;
        let mut moment = Vector3::zeros();
        for load in &self.robot.loads {
            if let LoadKind::Distributed { from, to, force_per_length, moment_per_length, frame } = load.kind
                && (from..to).contains(&inside)
            {
                let axes = axes(frame, state);
                force += axes * force_per_length;
                moment += axes * moment_per_length;
            }
        }
        let tangent = state.rotation * v;
        State {
            position: tangent,
            rotation: state.rotation * u.cross_matrix(),
            force: -force,
            moment: -tangent.cross(&state.force) - moment,
        }
    }

    fn distance(&self, a: &State, b: &State) -> f64 {
        (a.position - b.position).norm() / self.length
            + (a.rotation - b.rotation).norm()
            + self.wrench(&(a.force - b.force), &(a.moment - b.moment))
    }

    fn wrench(&self, force: &Vector3<f64>, moment: &Vector3<f64>) -> f64 {
        force.norm() * self.length.powi(2) / self.ei + moment.norm() * self.length / self.ei
    }
}

fn axes(frame: Frame, state: &State) -> Matrix3<f64> {
    match frame {
        Frame::World => Matrix3::identity(),
        Frame::Body => state.rotation,
    }
}
