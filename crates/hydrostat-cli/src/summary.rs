//! What `solve` prints: a summary in millimetres and degrees, or the stations as CSV.

use crate::json::method;
use crate::text::{self, MM, components, fixed};
use hydrostat::model::Command;
use hydrostat::solution::{Check, Method, TendonState};
use hydrostat::{Equilibrium, Robot};
use std::fmt::Write;
use std::time::Duration;

/// The check that is a yes or no; its number is in the report.
const STABILITY: &str = "stability";
/// The check that counts tendons; they are named instead.
const SLACK: &str = "slack";

/// The default output of `solve`.
pub(crate) fn text(robot: &Robot, shape: &Equilibrium, took: Duration) -> String {
    let report = &shape.report;
    let mut text = format!("{:<25} {:.1} mm long\n", robot.name, robot.length() * MM);
    let mut line = |name: &str, value: String| text += &text::line(name, &value);
    let direction: Vec<f64> = shape.tip.rotation.matrix().column(2).iter().copied().collect();
    let angles: Vec<f64> =
        direction.iter().map(|cosine| cosine.clamp(-1.0, 1.0).acos().to_degrees()).collect();
    line("tip position", format!("{} mm", components(shape.tip.position.as_slice(), MM, 3)));
    line("tip direction", format!("{} deg to the axes x y z", components(&angles, 1.0, 2)));
    if let Some(base) = shape.stations.first() {
        line("backbone force at base", format!("{} N", components(base.force.as_slice(), 1.0, 6)));
        line("backbone moment at base", format!("{} N mm", components(base.moment.as_slice(), MM, 4)));
    }
    for (tendon, command) in shape.tendons.iter().zip(&robot.actuation) {
        let way = way(tendon, command);
        let (tension, length) = (fixed(tendon.tension, 4), fixed(tendon.length * MM, 3));
        line(&format!("tendon {}", tendon.name), format!("{tension} N, {way}, {length} mm long"));
    }
    for check in shape.checks.iter().filter(|check| check.name != STABILITY) {
        let in_words =
            if check.name == SLACK { slack_in_words(check, robot, shape) } else { check_in_words(check) };
        line(check.name, in_words);
    }
    line("stability", stability(robot, shape));
    line(
        "error estimate",
        format!("{:.1e} mm (residual {:.1e})", report.error_estimate * MM, report.residual),
    );
    let (name, time) = (method(report.method), took.as_secs_f64() * 1e6);
    line("found by", format!("{name}, {} iterations, {time:.0} us", report.iterations));
    text
}

/// How far a tendon is pulled in, and how much longer it is than its way where it is slack.
fn way(tendon: &TendonState, command: &Command) -> String {
    let mm = |length: f64| fixed(length * MM, 3);
    let pulled = mm(tendon.displacement);
    match command {
        Command::Displacement { displacement, .. } if tendon.slack && mm(*displacement) != pulled => {
            let by = mm(tendon.displacement - displacement);
            format!("held at {} mm, slack by {by} mm", mm(*displacement))
        }
        _ => format!("pulled in {pulled} mm"),
    }
}

/// Every check that fails, in words.
pub(crate) fn failures(shape: &Equilibrium) -> Vec<String> {
    let in_words = |check: &Check| match check.name {
        STABILITY => {
            "the equilibrium is unstable; a small side load or tilt of the base leads to the bent one"
                .to_owned()
        }
        SLACK => format!("check {SLACK} fails: {}", slack_fails(check)),
        name => format!("check {name} fails: {}", check_in_words(check)),
    };
    shape.checks.iter().filter(|check| !check.ok).map(in_words).collect()
}

/// The stations as CSV, SI units in the header.
pub(crate) fn stations(shape: &Equilibrium) -> String {
    let mut csv = String::from(
        "s [m],x [m],y [m],z [m],R11,R12,R13,R21,R22,R23,R31,R32,R33,v1,v2,v3,u1 [1/m],u2 [1/m],u3 [1/m],\
         force x [N],force y [N],force z [N],moment x [N m],moment y [N m],moment z [N m]\n",
    );
    for station in &shape.stations {
        let rotation = station.rotation.transpose(); // nalgebra stores columns
        let vectors = [&station.v, &station.u, &station.force, &station.moment];
        let numbers = station.position.iter().chain(rotation.iter()).chain(vectors.into_iter().flatten());
        // the sum has no -0, and `?` writes what is tiny with an exponent
        let numbers: Vec<String> = numbers.map(|number| format!(",{:?}", number + 0.0)).collect();
        let _ = writeln!(csv, "{:?}{}", station.s, numbers.concat());
    }
    csv
}

fn check_in_words(check: &Check) -> String {
    // a strain is a fraction
    let show = |value: f64| match check.name {
        "strain" | "guide_spacing" => format!("{:.3} %", value * 100.0),
        "tension" => format!("{value:.3} N"),
        _ => format!("{value:.6}"),
    };
    let mut place = check.at.map_or(String::new(), |at| format!(" at s = {:.1} mm", at * MM));
    if !check.tendons.is_empty() {
        let _ = write!(place, " in tendon {}", check.tendons.join(", "));
    }
    let word = if check.ok { "" } else { ": FAILS" };
    let limit = if check.limit.is_finite() {
        format!("limit {}", show(check.limit))
    } else {
        "no limit given".to_owned()
    };
    format!("{}{place}, {limit}{word}", show(check.value))
}

/// The slack tendons by name; where the check fails, those that fail it. Pulled in and no longer than their way, they are taut at 0 N.
fn slack_in_words(check: &Check, robot: &Robot, shape: &Equilibrium) -> String {
    if !check.ok {
        return slack_fails(check);
    }
    let pulled_in = |command: &Command| matches!(command, Command::Displacement { displacement, .. } if *displacement > 0.0);
    let slack = shape.tendons.iter().zip(&robot.actuation);
    let slack = slack.filter(|(tendon, command)| tendon.slack && !pulled_in(command));
    let slack: Vec<&str> = slack.map(|(tendon, _)| tendon.name.as_str()).collect();
    if slack.is_empty() {
        "no tendon held by displacement is slack".to_owned()
    } else {
        format!("{} slack, none of them pulled in", slack.join(", "))
    }
}

fn slack_fails(check: &Check) -> String {
    format!("{} slack although pulled in: FAILS", check.tendons.join(", "))
}

fn stability(robot: &Robot, shape: &Equilibrium) -> String {
    let report = &shape.report;
    let held = |(tendon, command): (&TendonState, &Command)| {
        matches!(command, Command::Displacement { .. }) && !tendon.slack
    };
    let word = match report.stable {
        Some(true) => "stable".to_owned(),
        Some(false) => report.unstable_from.map_or("UNSTABLE".to_owned(), |factor| {
            format!("UNSTABLE from {:.1} % of the loads", factor * 100.0)
        }),
        None if report.method == Method::Shooting && shape.tendons.iter().zip(&robot.actuation).any(held) => {
            "not known: shooting does not judge tendons held by displacement, the energy method does"
                .to_owned()
        }
        None => {
            "not known (the loads are not conservative): no direction falls, but it may flutter".to_owned()
        }
    };
    report
        .smallest_eigenvalue
        .map_or(word.clone(), |value| format!("{word}, smallest eigenvalue {}", significant(value)))
}

/// Four decimals, or what a smaller number needs.
fn significant(value: f64) -> String {
    if value.abs() < 1e-3 { format!("{value:.1e}") } else { format!("{value:.4}") }
}
