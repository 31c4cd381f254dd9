//! Whether the design can be built and will work, in plain words, before anything is cut.

use super::base::{Base, SPOOL_FLANGE};
use super::device::{Device, parallel};
use super::guides::Guide;
use super::nesting;
use super::part::Part;
use super::workshop::{Workshop, short};
use crate::model::{CrossSection, Robot};
use crate::planar::Contour;
use crate::statics::{self, Input, Settings, Workspace};
use crate::{Equilibrium, Error};

const MM: f64 = 1e-3;
/// Part of the holding torque that a stepper still gives while it turns slowly.
const USABLE_TORQUE: f64 = 0.5;
/// Of the least wall around the shaft.
const SPOOL_WALL: f64 = 1.5 * MM;
/// A part of the tip's motion that is coarse for a demonstration.
const COARSE: f64 = 0.5 * MM;
/// Part of a guide's mass by which the drawing may differ from the file.
const MASS: f64 = 0.1;

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    Good,
    /// It can be built, but look at it.
    Doubtful,
    /// Nothing is made.
    Impossible,
}

/// One check of the design.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignCheck {
    pub name: &'static str,
    pub verdict: Verdict,
    /// What was found, with numbers and units.
    pub says: String,
    /// What to try.
    pub hint: Option<&'static str>,
}

impl DesignCheck {
    fn good(name: &'static str, says: String) -> DesignCheck {
        DesignCheck { name, verdict: Verdict::Good, says, hint: None }
    }

    /// Good, or this verdict with its hint.
    fn unless(
        good: bool,
        verdict: Verdict,
        name: &'static str,
        says: String,
        hint: &'static str,
    ) -> DesignCheck {
        if good {
            DesignCheck::good(name, says)
        } else {
            DesignCheck { name, verdict, says, hint: Some(hint) }
        }
    }
}

/// Of what is cut.
pub(super) fn of_parts(
    workshop: &Workshop,
    guides: &[Guide],
    base: &Base,
    parts: &[Part],
) -> Vec<DesignCheck> {
    let mut checks = vec![sheet(workshop, parts), spool(workshop)];
    checks.extend(webs(workshop, parts));
    checks.push(small_holes(workshop, parts));
    checks.push(base_room(workshop, base));
    checks.push(guide_hole(workshop, guides));
    checks
}

/// Of the robot as it is commanded.
pub(super) fn of_robot(
    robot: &Robot,
    workshop: &Workshop,
    guides: &[Guide],
) -> Result<Vec<DesignCheck>, Error> {
    let mut workspace = Workspace::default();
    let settings = Settings { stations: 2, ..Settings::default() };
    let shape = statics::solve_in(robot, &settings, &mut workspace)
        .map_err(|error| error.within("the robot as commanded"))?;
    let mut checks = vec![strain(&shape), tension(&shape), torque(workshop, &shape)];
    checks.extend(stability(&shape));
    checks.extend(spacing(&shape));
    checks.extend(resolution(robot, workshop, &mut workspace));
    checks.push(travel(robot, workshop));
    checks.extend(mass(robot, workshop, guides));
    Ok(checks)
}

fn sheet(workshop: &Workshop, parts: &[Part]) -> DesignCheck {
    let too_large: Vec<String> = parts
        .iter()
        .filter(|part| !nesting::fits(part, workshop))
        .map(|part| {
            let size = part.bounds().size();
            format!("{} of {} x {} mm", part.name, short(size.x / MM), short(size.y / MM))
        })
        .collect();
    let [w, h] = nesting::room(workshop).map(|side| short(side.max(0.0) / MM));
    let [sheet_w, sheet_h] = workshop.sheet_size.map(|side| short(side / MM));
    let of = format!("a sheet of {sheet_w} x {sheet_h} mm, which has room for {w} x {h} mm");
    let hint = "take a larger sheet (sheet_size) or make the robot smaller";
    match &too_large[..] {
        [] => DesignCheck::good("sheet size", format!("every part fits on {of}")),
        [first, rest @ ..] => {
            let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
            let says = format!("{first}{more} cannot be cut from {of}");
            DesignCheck { name: "sheet size", verdict: Verdict::Impossible, says, hint: Some(hint) }
        }
    }
}

/// Material between cuts: holes that meet or leave their part are impossible, thin webs doubtful.
fn webs(workshop: &Workshop, parts: &[Part]) -> Vec<DesignCheck> {
    let mut worst: Option<(f64, String, bool)> = None;
    for part in parts {
        for (i, hole) in part.holes.iter().enumerate() {
            let edge = (hole.gap(&part.outline), "its edge", !part.outline.contains(hole.chords(1e-2)[0]));
            let others = part.holes[i + 1..].iter().map(|other| {
                (
                    hole.gap(other),
                    "another hole",
                    hole.contains(other.chords(1e-2)[0]) || other.contains(hole.chords(1e-2)[0]),
                )
            });
            for (gap, what, inside) in others.chain([edge]) {
                let broken = inside || gap <= 0.0;
                let at = hole.bounds();
                let at = 0.5 * (at.low + at.high) / MM;
                let says = || {
                    let place = format!("the hole at ({}, {}) mm of {}", short(at.x), short(at.y), part.name);
                    if broken {
                        format!("{place} overlaps {what}")
                    } else {
                        format!("{place} is {} mm from {what}", short(gap / MM))
                    }
                };
                let gap = if broken { gap.min(0.0) } else { gap };
                if worst.as_ref().is_none_or(|(least, ..)| gap < *least - 1e-12) {
                    worst = Some((gap, says(), broken));
                }
            }
        }
    }
    let Some((gap, says, broken)) = worst else { return Vec::new() };
    let says = format!("{says}; least allowed {} mm (minimum_web)", short(workshop.minimum_web / MM));
    let verdict = if broken { Verdict::Impossible } else { Verdict::Doubtful };
    let hint = "move the holes apart (radius, angle of the tendons), make the guides larger, or set minimum_web if your material holds it";
    vec![DesignCheck::unless(!broken && gap >= workshop.minimum_web, verdict, "holes and edges", says, hint)]
}

fn small_holes(workshop: &Workshop, parts: &[Part]) -> DesignCheck {
    let width = |hole: &Contour| hole.bounds().size().min();
    let holes = parts.iter().flat_map(|part| part.holes.iter().map(move |hole| (width(hole), part)));
    let smallest = holes.min_by(|a, b| a.0.total_cmp(&b.0));
    let (width, part) = smallest.map_or((f64::INFINITY, ""), |(width, part)| (width, part.name.as_str()));
    let says = format!(
        "the smallest hole, in {part}, is {} mm wide; the laser's cut is {} mm",
        short(width / MM),
        short(workshop.kerf / MM)
    );
    let hint = "hole_clearance and tendon_diameter, or the rod, must leave a hole wider than the kerf";
    DesignCheck::unless(width > workshop.kerf, Verdict::Impossible, "smallest hole", says, hint)
}

fn spool(workshop: &Workshop) -> DesignCheck {
    let shaft = workshop.motor.frame.shaft;
    let least = shaft + 2.0 * SPOOL_WALL;
    let says = format!(
        "spool of {} mm on a shaft of {} mm ({}); least {} mm",
        short(workshop.spool_diameter / MM),
        short(shaft / MM),
        workshop.motor.frame.name,
        short(least / MM)
    );
    DesignCheck::unless(
        workshop.spool_diameter >= least,
        Verdict::Impossible,
        "spool",
        says,
        "set spool_diameter larger",
    )
}

/// Pulleys, brackets, spools and motors must not meet each other.
fn base_room(workshop: &Workshop, base: &Base) -> DesignCheck {
    let mut gaps = pulley_gaps(workshop, base);
    for (i, place) in base.places.iter().enumerate() {
        for other in &base.places[i + 1..] {
            // squares turned against each other
            let gap = (place.shaft - other.shaft).norm() - workshop.motor.frame.side * 2f64.sqrt();
            gaps.push((gap, format!("the motors of axes {} and {}", place.axis, other.axis)));
        }
    }
    let Some((gap, what)) = gaps.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return DesignCheck::good("room in the base", "one motor with its pulley".to_owned());
    };
    let says = if gap > 0.0 {
        format!("{what} are {} mm apart, and nothing else is nearer", short(gap / MM))
    } else {
        format!("{what} meet")
    };
    let hint = "spread the tendons' angles or radii, or take smaller pulleys (pulley_diameter)";
    DesignCheck::unless(gap > 0.0, Verdict::Impossible, "room in the base", says, hint)
}

/// Of each pulley with its bracket from the other pulleys and from all spools; 0 where they meet.
fn pulley_gaps(workshop: &Workshop, base: &Base) -> Vec<(f64, String)> {
    let used: Vec<_> = base.places.iter().filter(|place| place.tendon.is_some()).collect();
    let inside = |a: &Contour, b: &Contour| b.contains(a.chords(1e-2)[0]) || a.contains(b.chords(1e-2)[0]);
    let apart = |a: &[Contour], b: &[Contour]| {
        let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| if inside(a, b) { 0.0 } else { a.gap(b) }).fold(f64::INFINITY, f64::min)
    };
    let mut gaps = Vec::new();
    for (i, place) in used.iter().enumerate() {
        let pulley = base.pulley_footprint(workshop, place);
        for other in &used[i + 1..] {
            let gap = apart(&pulley, &base.pulley_footprint(workshop, other));
            gaps.push((gap, format!("the pulleys of axes {} and {}", place.axis, other.axis)));
        }
        for other in &base.places {
            let spool = Contour::circle(other.shaft, 0.5 * workshop.spool_diameter + SPOOL_FLANGE);
            let what = format!("the pulley of axis {} and the spool of {}", place.axis, other.axis);
            gaps.push((apart(&pulley, &[spool]), what));
        }
    }
    gaps
}

fn guide_hole(workshop: &Workshop, guides: &[Guide]) -> DesignCheck {
    let hole = guides[0].part.holes[0].bounds().size();
    let size = if matches!(guides[0].part.holes[0], Contour::Circle { .. }) {
        format!("{:.3} mm", hole.x / MM)
    } else {
        format!("{:.3} x {:.3} mm", hole.x / MM, hole.y / MM)
    };
    let says = format!(
        "the first guide's hole is {size}, {:.3} mm smaller than the rod, and is cut {:.3} mm smaller still for the kerf",
        workshop.press_fit / MM,
        workshop.kerf / MM
    );
    let part = workshop.press_fit / (hole.min() + workshop.press_fit);
    let hint = "more than 6 % of the rod cracks acrylic: lower press_fit, or find it with the coupon";
    DesignCheck::unless(part <= 0.06, Verdict::Doubtful, "rod in its hole", says, hint)
}

fn strain(shape: &Equilibrium) -> DesignCheck {
    let Some(check) = shape.checks.iter().find(|check| check.name == "strain") else {
        return DesignCheck::good("strain", "the rod is not strained".to_owned());
    };
    let at = check.at.map_or(String::new(), |at| format!(" at s = {:.1} mm", at / MM));
    let limit = if check.limit.is_finite() {
        format!("limit {:.2} %", 100.0 * check.limit)
    } else {
        "the material has no strain_limit".to_owned()
    };
    let says = format!("as commanded the rod is strained by {:.3} %{at}, {limit}", 100.0 * check.value);
    let hint = "pull less, or take a thinner rod";
    DesignCheck::unless(check.ok, Verdict::Impossible, "strain", says, hint)
}

fn tension(shape: &Equilibrium) -> DesignCheck {
    let hint = "pull less, or take a stronger tendon";
    match shape.checks.iter().find(|check| check.name == "tension") {
        Some(check) => {
            let says = format!(
                "tendon {} carries {:.2} N, breaking load {:.1} N",
                check.tendons.concat(),
                check.value,
                check.limit
            );
            DesignCheck::unless(check.ok, Verdict::Impossible, "tendon load", says, hint)
        }
        None => {
            let most = shape.tendons.iter().map(|tendon| tendon.tension).fold(0.0, f64::max);
            let says =
                format!("the most that a tendon carries is {most:.2} N; no tendon has a breaking_load");
            DesignCheck::good("tendon load", says)
        }
    }
}

fn torque(workshop: &Workshop, shape: &Equilibrium) -> DesignCheck {
    let most = shape.tendons.iter().map(|tendon| tendon.tension).fold(0.0, f64::max);
    let (needed, holding) = (most * workshop.spool_radius(), workshop.motor.torque);
    let says = format!(
        "{most:.2} N on a spool of {} mm needs {:.4} N m; the motor holds {} N m, about half of it while it turns",
        short(workshop.spool_diameter / MM),
        needed,
        short(holding)
    );
    let verdict = if needed > holding { Verdict::Impossible } else { Verdict::Doubtful };
    let hint = "take a thinner spool, a stronger motor (motor_torque), or pull less";
    DesignCheck::unless(needed <= USABLE_TORQUE * holding, verdict, "motor torque", says, hint)
}

fn stability(shape: &Equilibrium) -> Option<DesignCheck> {
    let unstable = shape.report.stable == Some(false);
    let says = "the robot as commanded is not stable: it would snap to another shape".to_owned();
    let hint = "pull less, or stiffen the rod";
    unstable.then(|| DesignCheck::unless(false, Verdict::Impossible, "stability", says, hint))
}

fn spacing(shape: &Equilibrium) -> Option<DesignCheck> {
    let check = shape.checks.iter().find(|check| check.name == "guide_spacing")?;
    let says = format!(
        "between guides the tendons leave the curve of their holes by {:.2} % of the radius, limit {:.0} %",
        100.0 * check.value,
        100.0 * check.limit
    );
    Some(DesignCheck::unless(
        check.ok,
        Verdict::Doubtful,
        "guide spacing",
        says,
        "set the guides nearer to each other",
    ))
}

/// Where one rod ends and another begins, nothing but the builder holds them together.
pub(super) fn rod_joints(robot: &Robot) -> Vec<DesignCheck> {
    let mut checks = Vec::new();
    let mut at = 0.0;
    for pair in robot.sections.windows(2) {
        at += pair[0].length;
        let same = pair[0].profile.tip == pair[1].profile.base && pair[0].material == pair[1].material;
        let [a, b] = [pair[0].profile.tip, pair[1].profile.base].map(|end| short(end.thickness() / MM));
        let says = format!(
            "at s = {:.1} mm the rod changes from {a} to {b} mm ({} to {}), and the drawings do not join the two",
            at / MM,
            pair[0].material.name,
            pair[1].material.name
        );
        let hint = "glue both into a short sleeve behind the guide there, or give the sections one profile";
        checks.push(DesignCheck::unless(same, Verdict::Doubtful, "rod joint", says, hint));
    }
    checks.retain(|check| check.verdict != Verdict::Good);
    checks
}

/// A wire can align the guides only through holes that lie on a line.
pub(super) fn alignment(robot: &Robot, device: &Device) -> Option<DesignCheck> {
    let name = &robot.tendons[device.aligned].name;
    let says = format!(
        "no tendon that passes every guide is parallel to the rod; the holes of {name} do not lie on a line"
    );
    let hint = "turn each guide by hand in the assembly device, its hole at the angle of the model";
    let parallel = parallel(robot, device.aligned);
    (!parallel).then(|| DesignCheck::unless(false, Verdict::Doubtful, "alignment", says, hint))
}

/// How far the tip moves for one microstep of each motor, from the shape as commanded.
fn resolution(robot: &Robot, workshop: &Workshop, workspace: &mut Workspace) -> Option<DesignCheck> {
    let step = 1.0 / workshop.steps_per_length();
    let derivatives =
        statics::derivatives(robot, workspace, &[robot.length()], &Input::commands(robot)).ok()?;
    let by_tendon = derivatives.iter().enumerate().filter_map(|(i, derivative)| {
        let pulled = derivative.tendons[i].displacement.abs();
        let tip = derivative.poses[0].position.norm();
        (pulled > 0.0 && tip.is_finite()).then(|| (tip / pulled * step, i))
    });
    let (most, tendon) = by_tendon.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let says = format!(
        "one microstep winds {:.2} um of tendon; the tip moves by up to {:.1} um (tendon {})",
        step * 1e6,
        most * 1e6,
        robot.tendons[tendon].name
    );
    Some(DesignCheck::unless(
        most <= COARSE,
        Verdict::Doubtful,
        "tip resolution",
        says,
        "take more microsteps or a thinner spool",
    ))
}

/// Length of tendon that bends the rod to its strain limit; None without a limit.
pub(super) fn longest_pull(robot: &Robot, tendon: usize) -> Option<f64> {
    let tendon = &robot.tendons[tendon];
    let bend = robot.sections[..=tendon.ends].iter().map(|section| {
        let half = match section.profile.base {
            CrossSection::Strip { width, height } => 0.5 * width.min(height),
            round => 0.5 * round.thickness(),
        };
        section.material.strain_limit.map(|limit| limit / half * section.length)
    });
    bend.sum::<Option<f64>>().map(|angle| angle * tendon.path.radius)
}

fn travel(robot: &Robot, workshop: &Workshop) -> DesignCheck {
    let pulls = (0..robot.tendons.len()).filter_map(|i| longest_pull(robot, i));
    let Some(most) = pulls.max_by(f64::total_cmp) else {
        return DesignCheck::good(
            "spool travel",
            "the rod has no strain limit, so no tendon has a longest pull".to_owned(),
        );
    };
    let turns = most / workshop.circumference() + 3.0; // those that stay on it
    let layer = (workshop.sheet_thickness / workshop.tendon_diameter).floor().max(1.0);
    let says = format!(
        "up to the rod's strain limit a tendon is pulled in by {:.1} mm, with the turns that stay {turns:.1} turns; one layer holds {layer:.0}",
        most / MM
    );
    let hint = "turns that lie on others wind more per step: take a larger spool";
    DesignCheck::unless(turns <= layer, Verdict::Doubtful, "spool travel", says, hint)
}

/// The mass in the file against that of the drawing.
fn mass(robot: &Robot, workshop: &Workshop, guides: &[Guide]) -> Option<DesignCheck> {
    let first = &guides[0];
    let drawn = first.part.area() * workshop.sheet_thickness * workshop.sheet_density;
    let file = robot.sections[first.section].guides.as_ref().map(|guides| guides.mass)?;
    let says = format!("a guide as drawn weighs {:.2} g, the file says {:.2} g", drawn * 1e3, file * 1e3);
    let hint = "set the guides' mass, so that the model carries what you cut";
    Some(DesignCheck::unless((file / drawn - 1.0).abs() <= MASS, Verdict::Doubtful, "guide mass", says, hint))
}
