//! How the shape of a robot is found.
//!
//! [`solve`] cuts the backbone into a chain, follows the equilibrium from the unloaded shape to the full load by Newton's method,
//! and refines until two resolutions agree. `energy` is the default method; shooting is the other, independent of it.

mod chain;
mod checks;
mod constant_curvature;
mod crossing;
mod derivatives;
mod energy;
mod held;
mod report;
mod rod;
mod search;
mod section;
mod shooting;
mod span;
mod stability;

pub use constant_curvature::{Arcs, Weight, constant_curvature};
pub use derivatives::{Input, derivatives};

use crate::model::Command;
use crate::solution::{Method, Station};
use crate::{Equilibrium, Error, Robot};
use chain::Chain;
use energy::Start;
use report::Judged;
use rod::Node;
use search::{Found, Search};
use shooting::{Mesh, Sweep};
use stability::SecondVariation;

/// How accurately to solve and how much to report.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// How the shape is found.
    pub method: Method,
    /// Largest estimated position error, as a fraction of the length; 1e-12 to 1e-2.
    pub tolerance: f64,
    /// Number of output stations, evenly spaced in s, both ends included; 0 for none.
    pub stations: usize,
    /// Shooting intervals; 1 is the thesis's single shooting, None one per step.
    pub shooting_intervals: Option<usize>,
    /// Largest part of the loads that is added at once on the way from the unloaded shape.
    pub largest_load_step: f64,
    /// Whether to find the smallest eigenvalue of the energy's second variation, which takes longer than the shape.
    pub eigenvalue: bool,
    /// Whether to judge stability even where a warm start has needed no new Hessian; without, it is then unknown.
    pub stability: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::Energy,
            tolerance: 1e-9,
            stations: 101,
            shooting_intervals: None,
            largest_load_step: 1.0,
            eigenvalue: true,
            stability: true,
        }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<(), Error> {
        if !(1e-12..=1e-2).contains(&self.tolerance) {
            return Err(Error::new(format!("a tolerance of {:e} of the length", self.tolerance))
                .hint("allowed: 1e-12 to 1e-2; the default is 1e-9"));
        }
        if !(self.largest_load_step > 1e-6 && self.largest_load_step <= 1.0) {
            return Err(Error::new(format!("a largest load step of {}", self.largest_load_step))
                .hint("allowed: above 1e-6, up to 1, which is the default"));
        }
        if self.shooting_intervals == Some(0) || self.stations == 1 {
            return Err(Error::new("no shooting intervals, or one station only")
                .hint("allowed: one interval or more; no stations, or two and more"));
        }
        Ok(())
    }
}

/// Memory that solves of similar robots share, and the solution from which [`solve_near`] starts.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    chain: Chain,
    /// The robot that was cut, under any commands, for the energy method.
    cut: Option<Robot>,
    /// At the base, per tendon, for shooting.
    tensions: Vec<f64>,
    steps_per_span: Vec<usize>,
    order_factor: f64,
    coarse: Mesh,
    fine: Mesh,
    /// The coarse mesh's nodes at the last load step, to go back to.
    reached: Vec<Node>,
    dead: Sweep<2>,
    follower: Sweep<3>,
    /// Steps of shooting linearised for the present robot, and at most.
    work: usize,
    most_work: usize,
    energy: energy::Energy,
    /// Whether the last solution is the energy method's.
    by_energy: bool,
    /// Whether the workspace holds a solution.
    warm: bool,
}

/// Finds the equilibrium on the primary branch, the one that starts at the unloaded shape.
///
/// # Errors
/// Not converged or not accurate enough (the message says what was tried), or impossible settings.
pub fn solve(robot: &Robot, settings: &Settings) -> Result<Equilibrium, Error> {
    solve_in(robot, settings, &mut Workspace::default())
}

/// [`solve`], starting from the last solution in the workspace where it fits (same sections and the same
/// places of loads): it follows the branch of that solution. A robot with guides whose shape was found from rest begins there again
/// where its commands have changed much.
///
/// # Errors
/// As [`solve`].
pub fn solve_near(
    robot: &Robot,
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Equilibrium, Error> {
    let start = if workspace.warm { Start::Last { changed: true } } else { Start::Rest };
    run(robot, settings, workspace, start)
}

/// [`solve`], starting from a given shape instead of the unloaded one: its stations, base to tip. The energy method moves
/// downhill from there, so that the answer is a stable equilibrium nearby.
///
/// # Errors
/// As [`solve`], and where the stations do not span the backbone or the method is not that of the energy.
pub fn solve_from(robot: &Robot, settings: &Settings, shape: &[Station]) -> Result<Equilibrium, Error> {
    solve_from_in(robot, settings, shape, &mut Workspace::default())
}

/// [`solve_from`] in memory that is used again.
///
/// # Errors
/// As [`solve_from`].
pub fn solve_from_in(
    robot: &Robot,
    settings: &Settings,
    shape: &[Station],
    workspace: &mut Workspace,
) -> Result<Equilibrium, Error> {
    let length = robot.length();
    let spans = |s: f64, end: f64| (s - end).abs() <= 1e-6 * length;
    let ordered = shape.windows(2).all(|pair| pair[0].s < pair[1].s);
    match shape {
        [first, .., last] if ordered && spans(first.s, 0.0) && spans(last.s, length) => {}
        _ => {
            return Err(Error::new("the shape to start from does not span the backbone")
                .hint(format!("expected stations from s = 0 to {length} m, in order")));
        }
    }
    if settings.method != Method::Energy {
        return Err(Error::new("only the energy method starts from a given shape"));
    }
    run(robot, settings, workspace, Start::Shape(shape))
}

/// [`solve`] in memory that is used again.
///
/// # Errors
/// As [`solve`].
pub fn solve_in(robot: &Robot, settings: &Settings, workspace: &mut Workspace) -> Result<Equilibrium, Error> {
    run(robot, settings, workspace, Start::Rest)
}

fn run(
    robot: &Robot,
    settings: &Settings,
    workspace: &mut Workspace,
    start: Start,
) -> Result<Equilibrium, Error> {
    workspace.warm = false;
    robot.check()?;
    settings.check()?;
    let changed = workspace.cut(robot, settings.method);
    if settings.method == Method::Energy {
        let Workspace { chain, energy, by_energy, .. } = workspace;
        // a shape found by shooting is no start
        let start = match start {
            Start::Last { .. } if *by_energy => Start::Last { changed },
            Start::Last { .. } => Start::Rest,
            other => other,
        };
        *by_energy = true;
        let found = energy::find(energy, robot, chain, settings, start)?;
        let equilibrium = report::of_energy(robot, settings, chain, energy, &found)?;
        workspace.warm = true;
        return Ok(equilibrium);
    }
    let warm = matches!(start, Start::Last { .. }) && !workspace.by_energy;
    workspace.by_energy = false;
    let (found, states) = held::solve(robot, settings, workspace, warm)?;
    let judged = judge(robot, settings, workspace, &found);
    let equilibrium = report::equilibrium(robot, settings, workspace, &found, &judged, states)?;
    workspace.warm = true;
    Ok(equilibrium)
}

/// Shooting under the workspace's tensions.
fn shoot(robot: &Robot, settings: &Settings, workspace: &mut Workspace, warm: bool) -> Result<Found, Error> {
    let Workspace {
        chain,
        tensions,
        steps_per_span,
        order_factor,
        coarse,
        fine,
        reached,
        dead,
        follower,
        work,
        most_work,
        ..
    } = workspace;
    let warm = warm && steps_per_span.len() == chain.spans.len();
    let mut search = Search {
        robot,
        settings,
        chain,
        tensions,
        steps_per_span,
        coarse,
        fine,
        reached,
        order_factor,
        iterations: 0,
        work,
        most_work: *most_work,
    };
    if chain.follower { search.run(warm, follower) } else { search.run(warm, dead) }
}

/// Below this determinant of the Riccati sweep the mesh of the shape is too coarse to judge stability.
const DOUBTFUL_PIVOT: f64 = 0.3;

/// Whether the energy falls in some direction from the shape just found.
fn judge(robot: &Robot, settings: &Settings, workspace: &mut Workspace, found: &Found) -> Judged {
    let Workspace { chain, tensions, steps_per_span, fine, dead, .. } = workspace;
    let held = |(command, tension): (&Command, &f64)| {
        matches!(command, Command::Displacement { .. }) && *tension > 0.0
    };
    let held = robot.actuation.iter().zip(&*tensions).any(held);
    // the steps of the shape do not look between plates
    let doubtful = found.conjugate_points > 0 || found.smallest_pivot < DOUBTFUL_PIVOT || fine.own_differs();
    let (mut falls, mut smallest_eigenvalue) = (found.conjugate_points > 0, None);
    if !chain.follower && (settings.eigenvalue || doubtful) {
        let steps: Vec<usize> = steps_per_span.iter().map(|count| 2 * count).collect();
        let mut second_variation = SecondVariation::new(robot, tensions, chain, fine, &steps, dead);
        falls = second_variation.falls_below(0.0);
        smallest_eigenvalue = (settings.eigenvalue && !held).then(|| second_variation.smallest_eigenvalue());
    }
    if held {
        // this was the robot whose tendons keep their tensions: to keep their lengths can only help
        let stable = (!falls && chain.conservative).then_some(true);
        return Judged { stable, smallest_eigenvalue: None, unstable_from: None };
    }
    Judged {
        // loads that have no energy may set a rod in motion even where no direction is downhill
        stable: if falls { Some(false) } else { chain.conservative.then_some(true) },
        smallest_eigenvalue,
        unstable_from: found.unstable_from.or(falls.then_some(1.0)),
    }
}

impl Workspace {
    /// Cuts the robot, where more than its commands has changed. Returns whether that was so.
    fn cut(&mut self, robot: &Robot, method: Method) -> bool {
        if self.cut.as_ref().is_some_and(|cut| cut.is_same_but_commands(robot)) {
            return false;
        }
        self.chain.rebuild(robot);
        self.cut = (method == Method::Energy).then(|| robot.clone());
        true
    }

    /// The backbone of the solution last found, at any `s`; `robot` as it was solved. None where nothing was found or
    /// `s` is not on the backbone.
    pub fn station(&self, robot: &Robot, s: f64) -> Option<Station> {
        let on_backbone = (0.0..=self.chain.length * (1.0 + 1e-12)).contains(&s);
        (self.warm && on_backbone).then(|| {
            if self.by_energy {
                return self.energy.station(robot, &self.chain, s.min(self.chain.length));
            }
            report::station(s.min(self.chain.length), robot, &self.chain, &self.tensions, &self.fine)
        })
    }
}
