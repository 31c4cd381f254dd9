//! The kit against the model: contours, holes, fits, nesting, and what is refused.

use hydrostat::Robot;
use hydrostat::description::parse_workshop;
use hydrostat::fabricate::{
    Cut, Group, Kit, Part, Placed, Tab, Verdict, Workshop, check, cut_part, cut_sheet, kit,
};
use hydrostat::planar::{Contour, Point};
use nalgebra::Vector3;
use std::f64::consts::PI;

const SCR: &str = include_str!("../../../robots/scr.toml");
const TWO_SECTIONS: &str = include_str!("../../../robots/scr_two_section.toml");
/// 1e-6 mm, as the drawings promise.
const EXACT: f64 = 1e-9;

fn read(text: &str) -> (Robot, Workshop) {
    parse_workshop(text, "robot.toml").expect("is valid").value
}

fn kits() -> Vec<(Robot, Workshop, Kit)> {
    let make = |text| {
        let (robot, workshop) = read(text);
        let kit = kit(&robot, &workshop).expect("can be built");
        (robot, workshop, kit)
    };
    vec![make(SCR), make(TWO_SECTIONS)]
}

fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

fn with(text: &str, fabrication: &str) -> String {
    format!("{text}\n[fabrication]\n{fabrication}\n")
}

#[track_caller]
fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= EXACT, "{a} {b}");
}

fn contours(part: &Part) -> impl Iterator<Item = &Contour> {
    std::iter::once(&part.outline).chain(&part.holes)
}

#[test]
fn contours_are_simple_and_holes_lie_inside() {
    for (_, workshop, kit) in kits() {
        for part in &kit.parts {
            for contour in contours(part) {
                assert!(contour.area() > 0.0 && !contour.crosses_itself(), "{}", part.name);
                // the way of the laser exists and is simple, too
                for side in [-0.5, 0.5] {
                    let moved = contour.offset(side * workshop.kerf).expect("is larger than the kerf");
                    assert!(!moved.crosses_itself(), "{}", part.name);
                }
            }
            for hole in &part.holes {
                assert!(part.outline.contains(hole.chords(1e-3)[0]), "{}", part.name);
                assert!(hole.gap(&part.outline) >= workshop.minimum_web, "{}", part.name);
            }
        }
    }
}

/// A second pass burns: no circle twice, no two straight lines that lie on each other for a part of their way.
#[test]
fn no_line_is_drawn_twice() {
    for (_, workshop, kit) in kits() {
        let sheets = kit.sheets.iter().map(|sheet| (&sheet.name, cut_sheet(&kit, sheet, &workshop)));
        for (name, cut) in sheets.chain(kit.parts.iter().map(|part| (&part.name, cut_part(part, &workshop))))
        {
            let mut circles: Vec<[i64; 3]> = cut.cuts.iter().filter_map(circle).collect();
            let count = circles.len();
            circles.sort_unstable();
            circles.dedup();
            assert_eq!(circles.len(), count, "{name}");
            let mut lines: Vec<_> =
                straight_lines(&cut).into_iter().map(|[a, b]| on_its_line(a, b)).collect();
            lines.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            for pair in lines.windows(2) {
                let apart = pair[0].0 != pair[1].0 || pair[1].1 >= pair[0].2 - EXACT;
                assert!(apart, "{name}: {pair:?}");
            }
        }
    }
}

fn circle(contour: &Contour) -> Option<[i64; 3]> {
    let Contour::Circle { center, radius } = contour else { return None };
    Some([center.x, center.y, *radius].map(|x| (x / EXACT).round() as i64))
}

fn straight_lines(cut: &Cut) -> Vec<[Point; 2]> {
    let mut lines = cut.slits.clone();
    for stroke in cut.scores.iter().chain(&cut.engravings) {
        lines.extend(stroke.windows(2).map(|pair| [pair[0], pair[1]]));
    }
    for contour in cut.cuts.iter().chain(&cut.pockets) {
        if let Contour::Polygon(vertices) = contour {
            let next = vertices.iter().cycle().skip(1);
            let straight = vertices.iter().zip(next).filter(|(a, _)| a.bulge == 0.0);
            lines.extend(straight.map(|(a, b)| [a.at, b.at]));
        }
    }
    lines
}

/// Direction and distance from the origin of the line through two points, and where on it they lie.
fn on_its_line(a: Point, b: Point) -> ([i64; 3], f64, f64) {
    let along = (b - a).normalize();
    let along = if along.x < -1e-7 || (along.x < 1e-7 && along.y < 0.0) { -along } else { along };
    let whole = |x: f64, unit: f64| (x / unit).round() as i64;
    let line = [whole(along.x, 1e-6), whole(along.y, 1e-6), whole(a.perp(&along), 1e-8)];
    let (from, to) = (a.dot(&along), b.dot(&along));
    (line, from.min(to), from.max(to))
}

#[test]
fn guides_are_those_of_the_model() {
    for (robot, workshop, kit) in kits() {
        let plates = robot.plates();
        let places: Vec<f64> = kit.guides.iter().map(|guide| guide.s).collect();
        assert_eq!(places.len(), plates.len() - 1, "without the base");
        for (guide, plate) in kit.guides.iter().zip(&plates[1..]) {
            close(guide.s, *plate);
            let rod = robot.sections[guide.section].cross_section(0.0).thickness() - workshop.press_fit;
            let tendons: Vec<_> =
                robot.tendons.iter().filter(|tendon| robot.tendon_end(tendon) >= plate - EXACT).collect();
            let mut area = PI * 0.0125f64.powi(2) - PI / 4.0 * rod.powi(2);
            area -= tendons.len() as f64 * PI / 4.0 * 0.001f64.powi(2);
            close(guide.part.area(), area);
            assert_eq!(guide.part.holes.len(), 1 + tendons.len());
            for (hole, tendon) in guide.part.holes[1..].iter().zip(&tendons) {
                let Contour::Circle { center, radius } = hole else { panic!("a round hole") };
                let end = robot.tendon_end(tendon);
                let model = tendon.path.hole(guide.s / end, end).0;
                close(center.x, model.x);
                close(center.y, model.y);
                close(*radius, 0.0005);
            }
        }
        // the front plate's holes are in line with them
        let front = kit.parts.iter().find(|part| part.name == "front-plate").expect("a front plate");
        for tendon in &robot.tendons {
            let model = tendon.path.hole(0.0, 1.0).0.xy();
            let same =
                |hole: &&Contour| (hole.bounds().low.lerp(&hole.bounds().high, 0.5) - model).norm() <= EXACT;
            assert_eq!(front.holes.iter().filter(same).count(), 1);
        }
    }
}

#[test]
fn combs_hold_every_guide_at_its_place() {
    let long = edited(SCR, "\"300 mm\"", "\"800 mm\"");
    let long = edited(&long, "name = \"SCR\"", "name = \"SCR\"\ngravity = \"[0, 0, 0] m/s^2\"");
    let (robot, workshop) = read(&long);
    let mut all = kits();
    let kit = kit(&robot, &workshop).expect("can be built");
    assert_eq!(kit.device.combs.len(), 2, "longer than a sheet");
    all.push((robot, workshop, kit));
    for (robot, workshop, kit) in all {
        let combs = &kit.device.combs;
        close(combs.iter().map(|comb| comb.to - comb.from).sum(), robot.length());
        let slots: Vec<f64> = combs.iter().flat_map(|comb| comb.slots.clone()).collect();
        assert_eq!(slots, kit.guides.iter().map(|guide| guide.s).collect::<Vec<_>>());
        // measured on the outline: the upper edge is cut at s -+ half a slot, to the depth at which the disk touches
        let half = 0.5 * (workshop.sheet_thickness + workshop.slot_clearance);
        for (comb, part) in combs.iter().zip(&kit.device.parts) {
            let Contour::Polygon(vertices) = &part.outline else { panic!("a polygon") };
            let inner = kit.device.beside - 0.5 * workshop.sheet_thickness;
            let bottom = kit.device.axis_height - (0.0125f64.powi(2) - inner.powi(2)).sqrt();
            for s in &comb.slots {
                for x in [s - half, s + half].map(|x| x - comb.starts) {
                    let at = |y: f64| vertices.iter().any(|v| (v.at - Point::new(x, y)).norm() <= EXACT);
                    assert!(at(bottom) && at(kit.device.comb_height));
                }
            }
            assert!(part.bounds().high.x <= workshop.sheet_size[0]);
        }
    }
}

/// Each tab of the assembled base lies in the middle of a slot that is larger by the clearance, in length and in width.
#[test]
fn tabs_fit_their_slots() {
    for (_, workshop, kit) in kits() {
        let part = |placed: &Placed| {
            kit.parts.iter().find(|part| part.name == placed.part).expect("a part of the kit")
        };
        let half = 0.5 * workshop.sheet_thickness;
        let mut slots = Vec::new();
        for placed in &kit.base.placed {
            for hole in part(placed).holes.iter().filter(|hole| matches!(hole, Contour::Polygon(_))) {
                let corners = hole.chords(1.0);
                let middle = corners.iter().sum::<Point>() / corners.len() as f64;
                let world = |p: Point| placed.x * p.x + placed.y * p.y;
                slots.push((
                    placed.at(middle, half),
                    world(corners[1] - corners[0]),
                    world(corners[2] - corners[1]),
                ));
            }
        }
        let mut tabs = 0;
        for placed in &kit.base.placed {
            let normal = placed.x.cross(&placed.y);
            for tab in &part(placed).tabs {
                let center = placed.at(tab.center, half);
                let meets: Vec<_> = slots.iter().filter(|slot| (slot.0 - center).norm() <= EXACT).collect();
                let [(_, a, b)] = meets[..] else { panic!("{} has a tab without its slot", placed.part) };
                let (along, length) = longer(placed, tab);
                for (direction, size) in [(along, length), (normal, workshop.sheet_thickness)] {
                    let slot = a.dot(&direction).abs().max(b.dot(&direction).abs());
                    close(slot, size + workshop.slot_clearance);
                }
                tabs += 1;
            }
        }
        let motors = kit.lines.len();
        assert_eq!(tabs, 4 * 2 + 4 * 2 + 2 * 4 + motors, "motor plate, tops, inner walls' sides, brackets");
    }
}

/// Direction and length of a tab along its edge.
fn longer(placed: &Placed, tab: &Tab) -> (Vector3<f64>, f64) {
    if tab.size.x > tab.size.y { (placed.x, tab.size.x) } else { (placed.y, tab.size.y) }
}

/// Tendons run in the planes of their spools and meet them tangentially.
#[test]
fn tendons_meet_their_spools() {
    for (robot, workshop, kit) in kits() {
        let base = &kit.base;
        for place in base.places.iter().filter(|place| place.tendon.is_some()) {
            let out = Point::new(place.angle.cos(), place.angle.sin());
            let hole = robot.tendons[place.tendon.expect("in use")].path.hole(0.0, 1.0).0.xy();
            close((place.tendon_at - hole).norm(), 0.0);
            close((place.pulley - hole).perp(&out), 0.0);
            close((place.pulley - hole).norm(), base.pulley_radius);
            close((place.shaft - hole).perp(&out).abs(), workshop.spool_radius());
        }
        close(base.pulley_height - base.pulley_radius, base.spool_height);
        // one turn of the motor winds one circumference
        close(workshop.motor.microsteps * 200.0 / workshop.steps_per_length(), workshop.circumference());
        close(workshop.circumference(), PI * 0.0205);
    }
}

#[test]
fn every_part_is_on_a_sheet_and_none_meet() {
    for (_, workshop, kit) in kits() {
        let mut counts = vec![0; kit.parts.len()];
        for sheet in &kit.sheets {
            let boxes: Vec<_> = sheet
                .placed
                .iter()
                .map(|on| {
                    counts[on.part] += 1;
                    kit.parts[on.part].outline.moved(on.quarter_turns, on.shift).bounds()
                })
                .collect();
            for (i, a) in boxes.iter().enumerate() {
                let [w, h] = sheet.size;
                assert!(a.low.min() >= -EXACT && a.high.x <= w + EXACT && a.high.y <= h + EXACT);
                for b in &boxes[i + 1..] {
                    let apart = (a.low.x - b.high.x)
                        .max(b.low.x - a.high.x)
                        .max(a.low.y - b.high.y)
                        .max(b.low.y - a.high.y);
                    assert!(apart >= workshop.part_spacing + workshop.kerf - EXACT, "{}", sheet.name);
                }
            }
        }
        let wanted: Vec<usize> = kit.parts.iter().map(|part| part.count).collect();
        assert_eq!(counts, wanted);
        let guides = kit.sheets.iter().filter(|sheet| sheet.name == "guides").map(|sheet| sheet.placed.len());
        assert_eq!(guides.sum::<usize>(), kit.guides.len(), "all guides on one sheet");
    }
}

/// Applied once: outlines grow by half a kerf on each side, holes shrink.
#[test]
fn the_kerf_is_allowed_for_once() {
    let (robot, workshop) = read(&with(SCR, "kerf = \"0.2 mm\""));
    let kit = kit(&robot, &workshop).expect("can be built");
    let guide = &kit.guides[0].part;
    let cut = cut_part(guide, &workshop);
    let radius = |contour: &Contour| match contour {
        Contour::Circle { radius, .. } => *radius,
        Contour::Polygon(_) => panic!("a circle"),
    };
    close(radius(&cut.cuts[0]), 0.0125 + 0.0001);
    close(radius(&cut.cuts[1]), 0.5 * (0.00156 - 0.00005) - 0.0001);
    assert!(cut.note.contains("kerf 0.2 mm"), "{}", cut.note);
    // what the window of the coupon measures is not moved
    let coupon = kit.parts.iter().find(|part| part.group == Group::Coupon).expect("a coupon");
    let slits = cut_part(coupon, &workshop).slits;
    assert_eq!(slits.len(), coupon.slits.len());
    close((slits[0][1] - slits[0][0]).norm(), 0.1);
}

#[test]
fn the_first_test_is_that_of_the_solver() {
    use hydrostat::model::{Command, Motion};
    for (mut robot, _, kit) in kits() {
        let test = &kit.first_test;
        close(test.pull, 0.005);
        robot.actuation.fill(Command::Tension { tension: 0.0, motion: Motion::Pulled });
        robot.actuation[0] = Command::Displacement { displacement: 0.005, motion: Motion::Pulled };
        let settings = hydrostat::statics::Settings {
            method: hydrostat::solution::Method::Shooting,
            eigenvalue: false,
            ..Default::default()
        };
        let tip = hydrostat::statics::solve(&robot, &settings).expect("has a shape").tip.position;
        assert!((tip - test.tip).norm() < 1e-7 * robot.length(), "{tip} {}", test.tip);
    }
}

#[test]
fn lengths_to_cut_are_those_of_the_way() {
    for (robot, workshop, kit) in kits() {
        for line in &kit.lines {
            let tendon = &robot.tendons[line.tendon];
            // straight tendons are as long as their sections; the solver's own error is below a nanometre here
            assert!((line.on_robot - robot.tendon_end(tendon)).abs() < 1e-6, "{}", line.on_robot);
            let place =
                kit.base.places.iter().find(|place| place.tendon == Some(line.tendon)).expect("has a motor");
            let down = workshop.sheet_thickness + kit.base.gap - kit.base.pulley_height;
            let run = ((place.shaft - place.pulley).norm_squared() - workshop.spool_radius().powi(2)).sqrt();
            let way = down + 0.5 * PI * kit.base.pulley_radius + run;
            let kept = 3.0 * workshop.circumference() + 0.3;
            assert!((line.cut_length - line.on_robot - way - kept).abs() < 1e-9);
        }
    }
}

#[test]
fn the_robots_of_the_project_pass_their_checks() {
    for (robot, workshop, kit) in kits() {
        let checks = check(&robot, &workshop).expect("can be judged");
        assert_eq!(checks, kit.checks);
        assert!(checks.iter().all(|check| check.verdict != Verdict::Impossible));
        assert_eq!(kit.base.places.len(), 6, "three motors, and room for a second section's");
    }
}

/// One edit, the first words that the refusal must have.
#[test]
fn what_cannot_be_built_is_refused() {
    let by_setting: &[(&str, &[&str])] = &[
        (
            "sheet_size = \"[300, 10] mm\"",
            &["cannot be built: sheet size: coupon of 120 x 72 mm", "a sheet of 300 x 10 mm", "sheet_size"],
        ),
        (
            "spool_diameter = \"4 mm\"",
            &["spool: spool of 4 mm on a shaft of 5 mm (NEMA 17); least 8 mm", "set spool_diameter larger"],
        ),
        ("press_fit = \"1.5 mm\"", &["rod and hole", "the rod is 1.560 mm thick", "press_fit is 1.500 mm"]),
        (
            "sheet_thickness = \"9.5 mm\"",
            &["guide size: guides of 25 mm are too small for two combs of 9.5 mm beside a rod of 1.56 mm"],
        ),
        ("motor_torque = \"0.01 N m\"", &["motor torque: 5.00 N on a spool of 20 mm needs 0.0513 N m"]),
        (
            "tendon_diameter = \"0.1 mm\"\nhole_clearance = \"0 mm\"",
            &["smallest hole, in guide-01, is 0.1 mm wide; the laser's cut is 0.15 mm"],
        ),
    ];
    let by_robot: &[(&str, &str, &[&str])] = &[
        (
            "angle = \"120 deg\"",
            "angle = \"5 deg\"",
            &["holes and edges: the hole at", "overlaps another hole", "hint: move the holes apart"],
        ),
        ("spacing = \"10 mm\"", "spacing = \"4 mm\"", &["guide spacing: guides 1 and 2 are 4 mm apart"]),
        ("a = \"5 N\"", "a = \"40 N\"", &["strain: as commanded the rod is strained by"]),
        ("\"500 N\"", "\"4 N\"", &["tendon load: tendon a carries 5.00 N, breaking load 4.0 N"]),
        ("radius = \"8 mm\"", "radius = \"12.2 mm\"", &["overlaps its edge"]),
        (
            "angle = \"120 deg\"",
            "angle = \"15 deg\"",
            &["room in the base: the pulleys of axes X and Y meet"],
        ),
    ];
    let by_setting = by_setting.iter().map(|(setting, words)| (with(SCR, setting), *words));
    let by_robot = by_robot.iter().map(|(from, to, words)| (edited(SCR, from, to), *words));
    for (text, words) in by_setting.chain(by_robot) {
        let (robot, workshop) = read(&text);
        let error = kit(&robot, &workshop).err().unwrap_or_else(|| panic!("{}", words[0])).to_string();
        for word in words {
            assert!(error.contains(word), "expected {word:?} in {error}");
        }
    }
    let rod = SCR.split("[[tendon]]").next().expect("has text");
    let (robot, workshop) = read(rod);
    let error = kit(&robot, &workshop).expect_err("no tendons").to_string();
    assert!(error.contains("\"SCR\" has no tendons, so there is no kit to make"), "{error}");
}

#[test]
fn what_is_doubtful_is_said_and_made() {
    let doubted: &[(String, &str, &str)] = &[
        (with(SCR, "minimum_web = \"1.6 mm\""), "holes and edges", "1.5 mm from its edge"),
        (with(SCR, "motor_torque = \"0.06 N m\""), "motor torque", "holds 0.06 N m"),
        (with(SCR, "sheet_density = \"2 g/cm^3\""), "guide mass", "the file says 1.84 g"),
        (with(SCR, "press_fit = \"0.2 mm\""), "rod in its hole", "1.360 mm"),
    ];
    for (text, name, words) in doubted {
        let (robot, workshop) = read(text);
        let kit = kit(&robot, &workshop).expect("can be built");
        let found = kit.checks.iter().find(|check| check.name == *name).expect("the check is there");
        assert_eq!(found.verdict, Verdict::Doubtful, "{found:?}");
        assert!(found.says.contains(words), "{found:?}");
    }
}

/// Weight, torque and microstep by hand, for SCR.
#[test]
fn checks_have_the_numbers_of_closed_forms() {
    let (robot, workshop, kit) = kits().swap_remove(0);
    let says =
        |name: &str| kit.checks.iter().find(|check| check.name == name).expect("is checked").says.clone();
    // disk less four holes, 3.175 mm of 1.18 g/cm^3
    let area = PI / 4.0 * (25.0f64.powi(2) - 1.51f64.powi(2) - 3.0);
    let mass = area * 3.175e-3 * 1.18;
    assert!(says("guide mass").contains(&format!("{mass:.2} g")), "{}", says("guide mass"));
    let torque = 5.0 * 0.01025;
    assert!(says("motor torque").contains(&format!("{torque:.4} N m")), "{}", says("motor torque"));
    let step = PI * 20.5 / 3200.0 * 1e3;
    assert!(says("tip resolution").contains(&format!("{step:.2} um")), "{}", says("tip resolution"));
    let travel = 0.01 / 0.00078 * robot.length() * 8.0;
    assert!(says("spool travel").contains(&format!("{travel:.1} mm")), "{}", says("spool travel"));
    assert!(!workshop.settings().iter().any(|setting| !setting.default));
}
