//! The robots whose solves are timed (`scr.rs`) and counted (`examples/count.rs`). All to 1e-6 of the length.

use hydrostat::Robot;
use hydrostat::description::parse_robot;
use hydrostat::model::{Command, Frame, Load, LoadKind, Routing};
use hydrostat::statics::{Input, Settings, Workspace, derivatives, solve_in};
use nalgebra::Vector3;

/// As in a control loop, which judges stability now and then.
pub(crate) fn settings() -> Settings {
    Settings { stability: false, ..judging() }
}

/// With stability from the Hessian's inertia in every solve.
pub(crate) fn judging() -> Settings {
    Settings { tolerance: 1e-6, stations: 0, eigenvalue: false, ..Settings::default() }
}

/// SCR with a force at its tip and all three tendons pulled.
pub(crate) fn scr(routing: Routing) -> Robot {
    let mut robot =
        parse_robot(include_str!("../../../../robots/scr.toml"), "scr.toml").expect("is valid").value;
    for tendon in &mut robot.tendons {
        tendon.routing = routing;
    }
    if routing == Routing::Channel {
        robot.sections[0].guides = None;
    }
    let force = Vector3::new(0.1, 0.05, -0.1);
    let kind = LoadKind::Point { at: robot.length(), force, moment: Vector3::zeros(), frame: Frame::World };
    robot.loads.push(Load { name: None, kind });
    pull(&mut robot, [5.0, 2.0, 1.0]);
    robot
}

fn pull(robot: &mut Robot, tensions: [f64; 3]) {
    for (command, tension) in robot.actuation.iter_mut().zip(tensions) {
        *command = Command::Tension { tension, motion: Default::default() };
    }
}

/// Every tension or displacement 1 % larger.
pub(crate) fn more(robot: &Robot) -> Robot {
    let mut robot = robot.clone();
    for command in &mut robot.actuation {
        match command {
            Command::Tension { tension, .. } => *tension *= 1.01,
            Command::Displacement { displacement, .. } => *displacement *= 1.01,
        }
    }
    robot
}

/// The same shape, its tendons held by what they are pulled in.
pub(crate) fn by_displacement(mut robot: Robot) -> Robot {
    let shape = solve_in(&robot, &settings(), &mut Workspace::default()).expect("has an answer");
    for (command, tendon) in robot.actuation.iter_mut().zip(&shape.tendons) {
        *command = Command::Displacement { displacement: tendon.displacement, motion: Default::default() };
    }
    robot
}

/// SCR cut into so many sections, three tendons to the tip.
pub(crate) fn sections(count: usize) -> Robot {
    let mut robot = scr(Routing::Channel);
    robot.sections[0].length /= count as f64;
    robot.sections = vec![robot.sections[0].clone(); count];
    robot.tendons.iter_mut().for_each(|tendon| tendon.ends = count - 1);
    robot
}

/// SCR with so many guides.
pub(crate) fn guides(count: usize) -> Robot {
    let mut robot = scr(Routing::Guides);
    let guides = robot.sections[0].guides.as_mut().expect("has guides");
    guides.mass *= 30.0 / count as f64;
    guides.positions = (1..=count).map(|k| 0.3 * k as f64 / count as f64).collect();
    robot
}

/// Two sections with ten guides each and six tendons.
pub(crate) fn rao() -> Robot {
    parse_robot(include_str!("../../../../robots/rao2021.toml"), "rao2021.toml").expect("is valid").value
}

/// The Jacobian by the commands and the compliance at the tip.
pub(crate) fn differentiate(robot: &Robot, workspace: &mut Workspace) {
    let inputs = [Input::commands(robot), Input::tip_wrench().to_vec()].concat();
    derivatives(robot, workspace, &[robot.length()], &inputs).expect("is regular");
}
