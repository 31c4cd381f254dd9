//! Solves one case a number of times, for `cargo xtask count` to count the instructions of.

#![allow(clippy::print_stderr, reason = "it talks to a developer")]

#[path = "../benches/cases/mod.rs"]
#[allow(dead_code, reason = "some are only timed")]
mod cases;

use hydrostat::Robot;
use hydrostat::model::Routing;
use hydrostat::statics::{Workspace, solve_in, solve_near};
use std::process::ExitCode;

/// How the solves of a case follow each other.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    Cold,
    /// Every command 1 % away from the last.
    Warm,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, times] = &arguments[..] else {
        eprintln!("usage: count CASE TIMES");
        return ExitCode::from(2);
    };
    let channel = || cases::scr(Routing::Channel);
    let (robot, start, differentiates) = match case.as_str() {
        "channel-cold" => (channel(), Start::Cold, false),
        "channel-warm" => (channel(), Start::Warm, false),
        "displacement-warm" => (cases::by_displacement(channel()), Start::Warm, false),
        "jacobian-cold" => (channel(), Start::Cold, true),
        "guides-cold" => (cases::scr(Routing::Guides), Start::Cold, false),
        "guides-warm" => (cases::scr(Routing::Guides), Start::Warm, false),
        "two-sections-warm" => (cases::rao(), Start::Warm, false),
        other => {
            eprintln!("no case \"{other}\"");
            return ExitCode::from(2);
        }
    };
    let Ok(times) = times.parse() else {
        eprintln!("\"{times}\" is no number of solves");
        return ExitCode::from(2);
    };
    solve(&robot, start, differentiates, times);
    ExitCode::SUCCESS
}

fn solve(robot: &Robot, start: Start, differentiates: bool, times: usize) {
    let settings = if start == Start::Warm { cases::settings() } else { cases::judging() };
    let mut workspace = Workspace::default();
    let robots = [robot, &cases::more(robot)];
    for time in 0..times {
        let robot = robots[if start == Start::Warm { time % 2 } else { 0 }];
        let solved = match start {
            Start::Cold => solve_in(robot, &settings, &mut workspace),
            Start::Warm => solve_near(robot, &settings, &mut workspace),
        };
        solved.expect("has an answer");
        if differentiates {
            cases::differentiate(robot, &mut workspace);
        }
    }
}
