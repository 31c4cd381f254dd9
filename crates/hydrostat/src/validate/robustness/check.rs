//! Whether a shape is an equilibrium, without the solver: every station is integrated on to the next one.

use super::chords::Chords;
use super::commands;
use super::law::{Law, Pull};
use super::random::softest;
use super::tendon_robots::MOST_TENDONS;
use crate::model::{Command, Frame, LoadKind, Motion, Routing, Section};
use crate::solution::Station;
use crate::{Equilibrium, Robot};
use nalgebra::{Matrix3, SVector, Vector3};

/// Runge-Kutta steps over the length of the robot.
const STEPS: f64 = 1600.0;

/// Turns of tension and strain with friction, which converge like 0.1^n.
const MOST_KINKS: usize = 8;

/// How far a shape is from an equilibrium; lengths in units of L, forces of EI/L^2, moments of EI/L, angles in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defects {
    /// Position and rotation of the first station against the base.
    pub base: f64,
    /// Position, rotation, force and moment against the integral from the station before; summed along the rod.
    pub balance: f64,
    /// Wrench beyond the last station.
    pub tip: f64,
    /// v, u against those that the section law gives under the wrench; the largest, in radians over the length.
    pub section_law: f64,
    /// Departure of a rotation from R^T R = 1; the largest.
    pub rotation: f64,
    /// Lengths, displacements and tensions of the tendons against the shape and their commands; the largest.
    pub tendons: f64,
}

impl Defects {
    /// The largest of all; NaN if one is.
    pub fn largest(&self) -> f64 {
        [self.base, self.balance, self.tip, self.section_law, self.rotation, self.tendons]
            .into_iter()
            .fold(0.0, larger)
    }
}

/// Checks a solution with at least two stations, among them one at every plate; NaN where one is missing.
pub fn defects(robot: &Robot, found: &Equilibrium) -> Defects {
    let nothing = Defects { base: f64::NAN, ..Defects::default() };
    let (Some(first), Some(last)) = (found.stations.first(), found.stations.last()) else {
        return nothing;
    };
    let tensions: Vec<f64> = found.tendons.iter().map(|tendon| tendon.tension).collect();
    if tensions.len() != robot.tendons.len() || tensions.len() > MOST_TENDONS {
        return nothing;
    }
    let mut check = Check::new(robot, &tensions);
    if !check.string_chords(&found.stations) {
        return nothing;
    }
    let mut before = check.state(first, &State::clamped(robot));
    let mut defects = Defects {
        base: check.distance(
            &State { force: before.force, moment: before.moment, ..State::clamped(robot) },
            &before,
        ),
        ..Defects::default()
    };
    for (k, station) in found.stations.iter().enumerate() {
        let arrived =
            if k == 0 { before } else { check.integrate(found.stations[k - 1].s, station.s, before) };
        let state = check.state(station, &arrived);
        defects.balance += check.distance(&arrived, &state);
        defects.section_law = larger(defects.section_law, check.section_law(station, &state));
        let unit = state.rotation.transpose() * state.rotation - Matrix3::identity();
        defects.rotation = larger(defects.rotation, unit.norm());
        before = state;
    }
    let beyond = check.jump(last.s, &before);
    defects.tip = check.wrench(&beyond.force, &beyond.moment);
    defects.tendons = commands::defect(&check, &before, found);
    defects
}

/// The larger of two numbers; NaN, which `f64::max` drops, is the largest.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

pub(super) type PerTendon = SVector<f64, MOST_TENDONS>;

/// State of a cross-section, world frame; also its derivative by s.
#[derive(Clone, Copy)]
pub(super) struct State {
    pub(super) position: Vector3<f64>,
    pub(super) rotation: Matrix3<f64>,
    /// Of rod and tendons in channels together.
    pub(super) force: Vector3<f64>,
    pub(super) moment: Vector3<f64>,
    /// Length of every channel tendon since the base, and the angle that its tangent has turned by if it rubs.
    pub(super) paths: PerTendon,
    pub(super) turned: PerTendon,
}

impl State {
    pub(super) fn clamped(robot: &Robot) -> State {
        State {
            position: robot.base.position,
            rotation: *robot.base.rotation.matrix(),
            force: Vector3::zeros(),
            moment: Vector3::zeros(),
            paths: PerTendon::zeros(),
            turned: PerTendon::zeros(),
        }
    }

    fn plus(&self, h: f64, rate: &State) -> State {
        State {
            position: self.position + h * rate.position,
            rotation: self.rotation + h * rate.rotation,
            force: self.force + h * rate.force,
            moment: self.moment + h * rate.moment,
            paths: self.paths + h * rate.paths,
            turned: self.turned + h * rate.turned,
        }
    }
}

/// A robot with the arc lengths at which something changes, and the tensions that it is said to have.
pub(super) struct Check<'a> {
    pub(super) robot: &'a Robot,
    pub(super) length: f64,
    /// Softest E I.
    ei: f64,
    /// Where the sections begin, and where the tendons end.
    starts: Vec<f64>,
    pub(super) ends: Vec<f64>,
    breaks: Vec<f64>,
    pub(super) tensions: Vec<f64>,
    /// How the tension changes with the angle turned: exp(capstan Theta).
    pub(super) capstan: Vec<f64>,
    pub(super) chords: Chords,
    /// Tensions that a position right to 1e-9 L, or a friction right to 1e-6, leaves uncertain: a chord of L/30 turns by 3e-8.
    uncertain: f64,
}

impl<'a> Check<'a> {
    pub(super) fn new(robot: &'a Robot, tensions: &[f64]) -> Check<'a> {
        let mut end = 0.0;
        let mut starts = Vec::new();
        let mut breaks = Vec::new();
        for section in &robot.sections {
            starts.push(end);
            breaks.push(end);
            if let Some(guides) = &section.guides {
                breaks.extend(guides.positions.iter().map(|position| end + position));
            }
            end += section.length;
        }
        for load in &robot.loads {
            match load.kind {
                LoadKind::Point { at, .. } | LoadKind::Mass { at, .. } => breaks.push(at),
                LoadKind::Distributed { from, to, .. } => breaks.extend([from, to]),
            }
        }
        let ends: Vec<f64> = robot.tendons.iter().map(|tendon| robot.tendon_end(tendon)).collect();
        breaks.extend(&ends);
        breaks.sort_by(f64::total_cmp);
        let length = robot.length();
        breaks.dedup_by(|later, kept| *later - *kept < 1e-12 * length);
        let capstan = robot.tendons.iter().zip(&robot.actuation).map(|(tendon, command)| {
            let (Command::Tension { motion, .. } | Command::Displacement { motion, .. }) = command;
            if *motion == Motion::Pulled { -tendon.friction } else { tendon.friction }
        });
        Check {
            robot,
            length,
            ei: softest(robot),
            starts,
            ends,
            breaks,
            tensions: tensions.to_vec(),
            capstan: capstan.collect(),
            chords: Chords::default(),
            uncertain: 0.0,
        }
    }

    /// Runs the tendons from plate to plate. Returns whether there is a station at every plate.
    fn string_chords(&mut self, stations: &[Station]) -> bool {
        let at = |s: f64| stations.iter().find(|station| self.same(station.s, s));
        let plates = self.robot.plates();
        let placed: Option<Vec<&Station>> = plates.iter().map(|s| at(*s)).collect();
        let Some(placed) = placed else { return false };
        let poses = placed.iter().map(|station| (station.s, station.position, station.rotation)).collect();
        self.chords = Chords::new(self.robot, poses, &self.tensions, &self.capstan);
        let doubt = |i: usize| match self.robot.tendons[i].routing {
            _ if self.capstan[i] != 0.0 => 1.0,
            Routing::Guides => 0.1,
            Routing::Channel => 0.0,
        };
        self.uncertain = self.tensions.iter().enumerate().map(|(i, pull)| doubt(i) * pull).sum();
        true
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

    /// The channel tendons that pass at s; `inside` tells the side of a break.
    fn pulls(&self, s: f64, inside: f64, turned: &PerTendon) -> Vec<Pull> {
        let mut pulls = Vec::new();
        for (i, tendon) in self.robot.tendons.iter().enumerate() {
            let end = self.ends[i];
            if tendon.routing == Routing::Channel && (inside < end || self.same(inside, end)) {
                let (hole, along) = tendon.path.hole(s / end, end);
                let tension = self.tensions[i] * (self.capstan[i] * turned[i]).exp();
                pulls.push(Pull { tendon: i, hole, along, tension });
            }
        }
        pulls
    }

    /// Strains v, u from the wrench (G 13, G 15; theory 27).
    fn strains(&self, s: f64, inside: f64, state: &State, pulls: &[Pull]) -> (Vector3<f64>, Vector3<f64>) {
        let (section, fraction) = self.section_at(s, inside);
        let (se, bt) = section.stiffness(fraction);
        let to_body = state.rotation.transpose();
        Law { se, bt, rest_curvature: section.rest_curvature, pulls }
            .strains(&(to_body * state.force), &(to_body * state.moment))
    }

    fn section_at(&self, s: f64, inside: f64) -> (&Section, f64) {
        let (section, at_inside) = self.section(inside);
        (section, at_inside + (s - inside) / section.length)
    }

    /// A station as a state: its wrench, to which the tendons in channels are added; the rest as it was `arrived` at.
    fn state(&self, station: &Station, arrived: &State) -> State {
        let mut state = State {
            position: station.position,
            rotation: station.rotation,
            force: station.force,
            moment: station.moment,
            ..*arrived
        };
        let pulls = self.pulls(station.s, station.s, &state.turned);
        for pull in &pulls {
            let (force, moment) = pull.wrench(&station.v, &station.u);
            state.force += station.rotation * force;
            state.moment += station.rotation * moment;
        }
        state
    }

    fn section_law(&self, station: &Station, state: &State) -> f64 {
        let pulls = self.pulls(station.s, station.s, &state.turned);
        let (v, u) = self.strains(station.s, station.s, state, &pulls);
        (v - station.v).norm() + self.length * (u - station.u).norm()
    }

    /// Subtracts the point loads at s, and what the chords pull at a plate: the limit from the tip's side.
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
        for (section, start) in self.robot.sections.iter().zip(&self.starts) {
            let Some(guides) = &section.guides else { continue };
            for _ in guides.positions.iter().filter(|position| self.same(start + **position, s)) {
                let weight = guides.mass * self.robot.gravity;
                let arm = state.rotation * Vector3::new(guides.mass_center[0], guides.mass_center[1], 0.0);
                state.force -= weight;
                state.moment -= arm.cross(&weight);
            }
        }
        for plate in self.chords.plates.iter().filter(|plate| self.same(plate.s, s)) {
            state.force -= plate.force;
            state.moment -= plate.moment;
        }
        state
    }

    /// From the base's side of one station to the base's side of the next, through the breaks in between.
    pub(super) fn integrate(&self, from: f64, to: f64, state: State) -> State {
        let inside = self.breaks.iter().copied().filter(|&s| s > from && s < to);
        let inside = inside.filter(|&s| !self.same(s, from) && !self.same(s, to));
        let mut state = state;
        let mut start = from;
        for end in inside.chain([to]) {
            // strictly inside: decides which section, which tendons and which distributed loads
            let middle = 0.5 * (start + end);
            if start > 0.0 {
                let before = state;
                state = self.jump(start, &state);
                self.kink(start, &before, middle, &mut state);
            }
            let count = ((end - start) / self.length * STEPS).ceil().max(1.0);
            let h = (end - start) / count;
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
        let pulls = self.pulls(s, inside, &state.turned);
        let (section, fraction) = self.section_at(s, inside);
        let (v, u) = self.strains(s, inside, state, &pulls);
        let area = section.cross_section(fraction).area();
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
        for (tendon, end) in self.robot.tendons.iter().zip(&self.ends) {
            // every tendon weighs along its path at rest
            if tendon.mass_per_length > 0.0 && inside < *end {
                let (hole, along) = tendon.path.hole(s / end, *end);
                let path = Vector3::z() + section.rest_curvature.cross(&hole) + along;
                let weight = tendon.mass_per_length * path.norm() * self.robot.gravity;
                force += weight;
                moment += (state.rotation * hole).cross(&weight);
            }
        }
        let tangent = state.rotation * v;
        let mut rate = State {
            position: tangent,
            rotation: state.rotation * u.cross_matrix(),
            force: -force,
            moment: -tangent.cross(&state.force) - moment,
            paths: PerTendon::zeros(),
            turned: PerTendon::zeros(),
        };
        for pull in &pulls {
            rate.paths[pull.tendon] = pull.path(&v, &u).norm();
        }
        self.turn(s, inside, state, &mut rate);
        rate
    }

    /// Adds how fast the tangents of rubbing channel tendons turn: their difference along the rate.
    fn turn(&self, s: f64, inside: f64, state: &State, rate: &mut State) {
        let rubs = |i: usize| self.capstan[i] != 0.0 && self.robot.tendons[i].routing == Routing::Channel;
        if !(0..self.tensions.len()).any(rubs) {
            return;
        }
        let h = 1e-5 * self.length;
        // the tensions themselves fall as the tangents turn
        for _ in 0..MOST_KINKS {
            let ends = [-h, h].map(|h| self.tangents(s + h, inside, &state.plus(h, rate)));
            for i in (0..self.tensions.len()).filter(|&i| rubs(i)) {
                rate.turned[i] = (ends[1][i] - ends[0][i]).norm() / (2.0 * h);
            }
        }
    }

    /// World frame, per channel tendon; zero where none passes.
    fn tangents(&self, s: f64, inside: f64, state: &State) -> [Vector3<f64>; MOST_TENDONS] {
        let pulls = self.pulls(s, inside, &state.turned);
        let (v, u) = self.strains(s, inside, state, &pulls);
        let mut tangents = [Vector3::zeros(); MOST_TENDONS];
        for pull in &pulls {
            tangents[pull.tendon] = state.rotation * pull.path(&v, &u).normalize();
        }
        tangents
    }

    /// Turns the tangents of rubbing channel tendons where the strain jumps; what is lost there makes the jump smaller.
    fn kink(&self, s: f64, before: &State, inside: f64, state: &mut State) {
        let at_break = self.breaks.iter().any(|at| self.same(*at, s));
        if !at_break || self.capstan.iter().all(|capstan| *capstan == 0.0) {
            return;
        }
        let near = self.tangents(s, s, before);
        for _ in 0..MOST_KINKS {
            let far = self.tangents(s, inside, state);
            for i in (0..self.tensions.len()).filter(|&i| far[i] != Vector3::zeros()) {
                let angle = near[i].cross(&far[i]).norm().atan2(near[i].dot(&far[i]));
                state.turned[i] = before.turned[i] + angle;
            }
        }
    }

    fn distance(&self, a: &State, b: &State) -> f64 {
        (a.position - b.position).norm() / self.length
            + (a.rotation - b.rotation).norm()
            + self.wrench(&(a.force - b.force), &(a.moment - b.moment))
    }

    /// In units of EI/L^2, and of what is uncertain.
    pub(super) fn force(&self, force: f64) -> f64 {
        force.abs() / (self.ei / self.length.powi(2) + self.uncertain)
    }

    fn wrench(&self, force: &Vector3<f64>, moment: &Vector3<f64>) -> f64 {
        self.force(force.norm()) + self.force(moment.norm() / self.length)
    }
}

fn axes(frame: Frame, state: &State) -> Matrix3<f64> {
    match frame {
        Frame::World => Matrix3::identity(),
        Frame::Body => state.rotation,
    }
}
