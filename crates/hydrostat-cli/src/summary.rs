//! What `solve` prints: a summary in millimetres and degrees, or the stations as CSV.

use crate::json::method;
use crate::text::{MM, components, fixed};
use hydrostat::solution::{Check, Report};
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
    let mut lines = vec![(robot.name.clone(), format!("{:.1} mm long", robot.length() * MM))];
    let mut line = |name: &str, value: String| lines.push((format!("  {name}"), value));
    let direction: Vec<f64> = shape.tip.rotation.matrix().column(2).iter().copied().collect();
    let angles: Vec<f64> =
        direction.iter().map(|cosine| cosine.clamp(-1.0, 1.0).acos().to_degrees()).collect();
    line("tip position", format!("{} mm", components(shape.tip.position.as_slice(), MM, 3)));
    line("tip direction", format!("{} deg to the axes x y z", components(&angles, 1.0, 2)));
    if let Some(base) = shape.stations.first() {
        line("base force", format!("{} N", components(base.force.as_slice(), 1.0, 6)));
        line("base moment", format!("{} N mm", components(base.moment.as_slice(), MM, 4)));
    }
    for tendon in &shape.tendons {
        let slack = if tendon.slack { ", slack" } else { "" };
        let [pulled, length] = [tendon.displacement, tendon.length].map(|length| fixed(length * MM, 3));
        line(
            &format!("tendon {}", tendon.name),
            format!("{} N, pulled in {pulled} mm, {length} mm long{slack}", fixed(tendon.tension, 4)),
        );
    }
    for check in shape.checks.iter().filter(|check| check.name != STABILITY) {
        let in_words = if check.name == SLACK { slack_in_words(check, shape) } else { check_in_words(check) };
        line(check.name, in_words);
    }
    line("stability", stability(report));
    line(
        "error estimate",
        format!("{:.1e} mm (residual {:.1e})", report.error_estimate * MM, report.residual),
    );
    let (name, time) = (method(report.method), took.as_secs_f64() * 1e6);
    line("found by", format!("{name}, {} iterations, {time:.0} us", report.iterations));
    lines.iter().map(|(name, value)| format!("{name:<17} {value}\n")).collect()
}

/// Every check that fails, in words.
pub(crate) fn failures(shape: &Equilibrium) -> Vec<String> {
    let in_words = |check: &Check| match check.name {
        STABILITY => {
            "the equilibrium is unstable; a small side load or tilt of the base leads to the bent one"
                .to_owned()
        }
        SLACK => format!("check {SLACK} fails: {}", slack_in_words(check, shape)),
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
        let numbers: Vec<String> = numbers.map(|number| format!(",{number}")).collect();
        let _ = writeln!(csv, "{}{}", station.s, numbers.concat());
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

/// The slack tendons by name; where the check fails, those that fail it.
fn slack_in_words(check: &Check, shape: &Equilibrium) -> String {
    let slack: Vec<&str> =
        shape.tendons.iter().filter(|tendon| tendon.slack).map(|tendon| tendon.name.as_str()).collect();
    if !check.ok {
        format!("{} slack although pulled in: FAILS", check.tendons.join(", "))
    } else if slack.is_empty() {
        "no tendon is slack".to_owned()
    } else {
        format!("{} slack, none of them pulled in", slack.join(", "))
    }
}

fn stability(report: &Report) -> String {
    let word = match report.stable {
        Some(true) => "stable".to_owned(),
        Some(false) => report.unstable_from.map_or("UNSTABLE".to_owned(), |factor| {
            format!("UNSTABLE from {:.1} % of the loads", factor * 100.0)
        }),
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
