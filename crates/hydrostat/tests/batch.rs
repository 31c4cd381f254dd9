//! Many commands at once give what single solves give.

use hydrostat::batch::{CHUNK, Chunk, Commands, Input, solve_many};
use hydrostat::model::{Command, Frame, Load, LoadKind, Motion, Path, Routing, Tendon};
use hydrostat::statics::{self, Settings};
use hydrostat::{Error, Robot, description};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The built-in rod with two tendons and a force at its tip.
fn robot() -> Robot {
    let mut robot = description::builtin::robot().expect("the built-in robot is read").value;
    for (name, angle) in [("a", 0.0), ("b", 2.0)] {
        robot.tendons.push(Tendon {
            name: name.to_owned(),
            ends: 0,
            path: Path { radius: 8e-3, tip_radius: 8e-3, angle, turns: 0.0 },
            routing: Routing::Channel,
            stiffness: None,
            friction: 0.0,
            breaking_load: None,
            mass_per_length: 0.0,
            home: 0.0,
        });
        robot.actuation.push(Command::Tension { tension: 0.0, motion: Motion::Pulled });
    }
    let (at, zero) = (robot.length(), Vector3::zeros());
    let kind = LoadKind::Point { at, force: zero, moment: zero, frame: Frame::World };
    robot.loads.push(Load { name: Some("push".to_owned()), kind });
    robot
}

fn settings() -> Settings {
    Settings { stations: 3, eigenvalue: false, ..Settings::default() }
}

/// Two tensions and a force, all over the place.
fn commands(rows: usize) -> Commands {
    let inputs =
        vec![Input::Tension { tendon: 0 }, Input::Tension { tendon: 1 }, Input::Force { load: 0, axis: 2 }];
    let value = |row: usize, input: usize| {
        let phase = ((row * 37 + input * 61) % 100) as f64 / 100.0;
        (0.5 - 0.5 * (TAU * (phase + input as f64 / 3.0)).cos()) * [4.0, 4.0, 0.1][input]
    };
    let values = (0..rows).flat_map(|row| (0..3).map(move |input| value(row, input))).collect();
    Commands { inputs, values, broken: Vec::new() }
}

fn all(robot: &Robot, commands: &Commands) -> Vec<Chunk> {
    let mut chunks = Vec::new();
    solve_many(robot, commands, &settings(), || false, |chunk| chunks.push(chunk)).expect("solvable");
    chunks
}

/// Every row against `statics::solve` of the robot that it describes, to the sum of the two error estimates.
#[test]
fn rows_are_single_solves() {
    let commands = commands(CHUNK + 5);
    let mut robot = robot();
    let chunks = all(&robot, &commands);
    assert_eq!(chunks.iter().map(|chunk| chunk.first).collect::<Vec<_>>(), [0, CHUNK]);
    for (row, values) in commands.values.chunks(3).enumerate() {
        for (command, &tension) in robot.actuation.iter_mut().zip(values) {
            *command = Command::Tension { tension, motion: Motion::Pulled };
        }
        let LoadKind::Point { force, .. } = &mut robot.loads[0].kind else { panic!("a point load") };
        force.z = values[2];
        let single = statics::solve(&robot, &settings()).expect("an answer");
        let (chunk, at) = (&chunks[row / CHUNK], row % CHUNK);
        let shape = chunk.rows[at].as_ref().expect("an answer");
        let allowed = shape.error_estimate + single.report.error_estimate;
        let near = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() <= allowed;
        assert!(near(shape.tip.position, single.tip.position), "row {row}");
        for (position, station) in chunk.stations[3 * at..].iter().zip(&single.stations) {
            assert!(near(*position, station.position), "row {row}");
        }
        for (pull, state) in chunk.tendons[2 * at..].iter().zip(&single.tendons) {
            assert_eq!((pull.tension, pull.slack), (state.tension, state.slack), "row {row}");
            assert!((pull.length - state.length).abs() <= 10.0 * allowed, "row {row}");
        }
        assert_eq!(shape.stable, single.report.stable);
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let (robot, commands) = (robot(), commands(3 * CHUNK));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let chunks = pool.install(|| all(&robot, &commands));
        let rows = chunks.into_iter().flat_map(|chunk| chunk.rows);
        rows.map(|row| row.expect("an answer").tip.position).collect::<Vec<_>>()
    };
    let one = on(1);
    assert!(one == on(2) && one == on(5));
}

#[test]
fn a_failing_row_stops_no_other() {
    let mut commands = commands(10);
    commands.values[3 * 4] = -2.0;
    commands.values[3 * 6] = f64::NAN;
    commands.broken.push((8, Error::new("not readable")));
    let chunks = all(&robot(), &commands);
    let message = |row: usize| chunks[0].rows[row].as_ref().expect_err("broken").message().to_owned();
    assert_eq!(message(4), "tendon \"a\": a tension of -2 N");
    assert_eq!(message(6), "tendon \"a\": a tension of NaN N");
    assert_eq!(message(8), "not readable");
    assert_eq!(chunks[0].rows.iter().filter(|row| row.is_ok()).count(), 7);
    assert_eq!((chunks[0].tendons.len(), chunks[0].stations.len()), (20, 30));
}

/// What has been begun is given, without a gap.
#[test]
fn a_stop_keeps_what_is_done() {
    let asked = AtomicUsize::new(0);
    let mut rows = 0;
    let stop = || asked.fetch_add(1, Ordering::Relaxed) >= 2;
    let take = |chunk: Chunk| {
        assert_eq!(chunk.first, rows);
        rows += chunk.rows.len();
    };
    solve_many(&robot(), &commands(10 * CHUNK), &settings(), stop, take).expect("solvable");
    assert_eq!(rows, 2 * CHUNK);
}

#[test]
fn impossible_batches() {
    let refused = |commands: &Commands| {
        let outcome = solve_many(&robot(), commands, &settings(), || false, |_| panic!("no rows"));
        outcome.expect_err("impossible").message().to_owned()
    };
    let inputs = vec![Input::Tension { tendon: 2 }];
    let commands = Commands { inputs, values: vec![1.0], broken: Vec::new() };
    assert_eq!(refused(&commands), "the robot has nothing that Tension { tendon: 2 } sets");
    let inputs = vec![Input::Tension { tendon: 0 }, Input::Tension { tendon: 1 }];
    assert_eq!(refused(&Commands { inputs, ..commands }), "1 values of 2 inputs");
}
