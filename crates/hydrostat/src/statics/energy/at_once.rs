//! The whole load at once, from the bend of the tendons.

use super::newton::{Converged, Equations};
use super::search::{LARGEST_TURN, ON_THE_WAY, Search};
use super::{Energy, Memory, Smooth};
use crate::Robot;
use crate::model::{Command, Frame, Load, LoadKind, Routing, Tendon};
use crate::numeric::collocation::FEWEST;
use nalgebra::Vector3;

/// Points that the first shape has less, and its accuracy.
const POINTS_LESS: usize = 2;
const ROUGH: f64 = 1e-3;
/// Part of its bending stiffness that the robot to start from may lose at most.
const LARGEST_SOFTENING: f64 = 0.5;

impl Search<'_> {
    /// The full load at once, on few points first, from the bend that the tendons alone would give: for those in channels the only
    /// equilibrium without loads, as its energy is convex in the strains. False where that does not surely lead to a stable shape
    /// nearby.
    pub(super) fn start_at_once(&mut self) -> bool {
        let Some(more) = self.start_on_few_points() else { return false };
        if more {
            self.first_layout();
            self.relay();
        }
        !more
            || self.newton(1.0, ON_THE_WAY.min(self.settings.tolerance)).is_ok_and(|end| self.is_nearby(&end))
    }

    /// Returns whether the first mesh has more points; None where no shape nearby was found.
    fn start_on_few_points(&mut self) -> Option<bool> {
        self.first_layout();
        let few = |points: usize| (points - POINTS_LESS).max(FEWEST);
        let more = self.energy.layouts.iter().any(|layout| few(layout.points) < layout.points);
        self.energy.layouts.iter_mut().for_each(|layout| layout.points = few(layout.points));
        self.lay();
        if !self.bend_as_in_channels() {
            self.bend_by_tendons();
        }
        let end = self.newton(1.0, if more { ROUGH } else { ON_THE_WAY }).ok()?;
        self.is_nearby(&end).then_some(more)
    }

    fn is_nearby(&self, end: &Converged) -> bool {
        let turn = self.energy.coarse.largest_turn(&self.energy.tables);
        end.negative == 0 && turn <= LARGEST_TURN && !self.strayed(end)
    }

    /// Places the coarse mesh as bent by the tendons, with the tensions that a first step finds for those held.
    fn bend_by_tendons(&mut self) {
        let Energy { tables, coarse, reached, memory, .. } = &mut *self.energy;
        let equations = Equations { robot: self.robot, chain: self.chain, tables, factor: 1.0 };
        memory.drive.apply(self.robot, 1.0);
        if !memory.drive.held.is_empty() {
            equations.linearise(memory, coarse, 0.0);
            self.iterations += 1;
            let Memory { linear, drive, .. } = memory;
            for (&tendon, &tension) in drive.held.iter().zip(&linear.tensions) {
                drive.tensions[tendon] = tension;
            }
        }
        coarse.bend_by(self.robot, &memory.drive.tensions, tables);
        memory.sweep.place(coarse, tables);
        reached.rotations.clone_from(&coarse.rotations);
    }

    /// Places a mesh with chords as the same robot with its tendons in channels would be, which takes few panels. False without
    /// chords, or where that shape was not found.
    fn bend_as_in_channels(&mut self) -> bool {
        if self.energy.coarse.chords.is_empty() {
            return false;
        }
        let robot = in_channels(self.robot);
        let mut smooth = self.energy.smooth.take().unwrap_or_default();
        let Smooth { chain, energy } = &mut *smooth;
        chain.rebuild(&robot);
        let mut search = Search::new(energy, &robot, chain, self.settings);
        let found = search.start_on_few_points().is_some();
        self.iterations += search.iterations;
        if found {
            let Energy { tables, coarse, reached, memory, .. } = &mut *self.energy;
            coarse.prolong(&energy.coarse, tables);
            memory.drive.tensions.clone_from(&energy.memory.drive.tensions);
            memory.drive.taut.clone_from(&energy.memory.drive.taut);
            memory.sweep.place(coarse, tables);
            reached.rotations.clone_from(&coarse.rotations);
        }
        self.energy.smooth = Some(smooth);
        found
    }
}

/// Sum of the given tensions of the tendons that are straight between the guides of a section.
fn given_tension(robot: &Robot, section: usize) -> f64 {
    let given = |(tendon, command): (&Tendon, &Command)| match command {
        Command::Tension { tension, .. } if tendon.ends >= section && tendon.routing == Routing::Guides => {
            *tension
        }
        _ => 0.0,
    };
    robot.tendons.iter().zip(&robot.actuation).map(given).sum()
}

/// A robot with all tendons in channels that bends nearly as the robot does: softened by what the bow between guides adds to the arm of
/// the tendons, the weight of the guides spread evenly and at the sections' ends.
fn in_channels(robot: &Robot) -> Robot {
    let mut smooth = robot.clone();
    smooth.tendons.iter_mut().for_each(|tendon| tendon.routing = Routing::Channel);
    let mut from = 0.0;
    for (number, section) in smooth.sections.iter_mut().enumerate() {
        let to = from + section.length;
        if let Some(guides) = section.guides.take().filter(|guides| !guides.positions.is_empty()) {
            let (count, bend) = (guides.positions.len() as f64, section.stiffness(0.0).1);
            let gap = section.length / count;
            // a chord is on average curvature x gap^2 / 12 farther from the backbone than its holes
            let softer = given_tension(robot, number) * gap * gap / 12.0;
            section.material.youngs_modulus *=
                1.0 - (2.0 * softer / (bend.x + bend.y)).min(LARGEST_SOFTENING);
            // of their weight so much at the end that its centre stays
            let centre = guides.positions.iter().sum::<f64>() / count;
            let at_end = (2.0 * centre / section.length - 1.0).clamp(0.0, 1.0);
            let mass = guides.mass * count;
            let kind = LoadKind::Distributed {
                from,
                to,
                force_per_length: (1.0 - at_end) * mass / section.length * robot.gravity,
                moment_per_length: Vector3::zeros(),
                frame: Frame::World,
            };
            smooth.loads.push(Load { name: None, kind });
            smooth.loads.push(Load { name: None, kind: LoadKind::Mass { at: to, mass: at_end * mass } });
        }
        from = to;
    }
    smooth
}
