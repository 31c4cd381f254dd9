//! The assembly guide: one page with everything that a class needs to build the robot.

use super::{decimal, steps, tables};
use hydrostat::Robot;
use hydrostat::fabricate::{FITS, Group, KERF_CUTS, KERF_WINDOW, Kit, Part, Verdict, Workshop};
use minijinja::{Environment, Value, context};

const TEMPLATE: &str = include_str!("guide.html");
/// Of a drawing across the page, and of two side by side, px.
const WHOLE: f64 = 720.0;
const HALF: f64 = 330.0;

/// One self-contained page (inline CSS and SVG, no scripts) that also prints on A4.
pub(super) fn page(robot: &Robot, workshop: &Workshop, kit: &Kit, source: &str) -> String {
    let svg = |text: String| Value::from_safe_string(text);
    let part = |name: &str| kit.parts.iter().find(|part| part.name == name);
    let drawn =
        |name: &str, width: f64| svg(part(name).map_or(String::new(), |part| steps::part(part, width)));
    let (first, last) = (&kit.guides[0], &kit.guides[kit.guides.len() - 1]);
    let test = &kit.first_test;
    let page = context! {
        name => robot.name,
        source,
        facts => facts(robot, workshop, kit),
        checks => checks(kit),
        bill => kit.bill.iter().map(|item| context! { item => item.item, specification => item.specification, quantity => item.quantity, note => item.note }).collect::<Vec<_>>(),
        settings => workshop.settings().into_iter().map(|setting| context! { key => setting.key, value => setting.value, from => if setting.default { "default" } else { "robot file" } }).collect::<Vec<_>>(),
        sheets => sheets(kit),
        parts => parts(kit),
        kerf => decimal(workshop.kerf, 3),
        half_kerf => decimal(0.5 * workshop.kerf, 4),
        kerf_cuts => KERF_CUTS,
        kerf_window => decimal(KERF_WINDOW, 1),
        expected_gap => decimal(KERF_CUTS as f64 * workshop.kerf, 2),
        press_fit => decimal(workshop.press_fit, 3),
        thickness => decimal(workshop.sheet_thickness, 3),
        fits => FITS.len(),
        coupon => drawn("coupon", WHOLE),
        first_guide => svg(steps::guide(robot, first, workshop)),
        last_guide => svg(steps::guide(robot, last, workshop)),
        two_kinds => first.holes.len() != last.holes.len() || first.holes.iter().any(|hole| hole.ends) != last.holes.iter().any(|hole| hole.ends),
        first_number => first.number,
        last_number => last.number,
        guides => kit.guides.iter().map(|guide| context! { number => guide.number, section => robot.sections[guide.section].name, s => decimal(guide.s, 2), tendons => guide.holes.iter().map(|hole| format!("{}{}", robot.tendons[hole.tendon].name, if hole.ends { " (tied)" } else { "" })).collect::<Vec<_>>().join(", ") }).collect::<Vec<_>>(),
        device_side => svg(steps::device_side(robot, kit, workshop)),
        device_end => svg(steps::device_end(robot, kit, workshop)),
        guides_apart => decimal(last.s - first.s, 2),
        first_s => decimal(first.s, 2),
        last_s => decimal(last.s, 2),
        spool_height => decimal(kit.base.spool_height, 2),
        test_others => kit.lines.iter().skip(1).map(|line| format!("{}=0N", line.name)).collect::<Vec<_>>().join(","),
        comb_pieces => kit.device.combs.len(),
        aligned => robot.tendons[kit.device.aligned].name,
        base_apart => svg(steps::base_apart(kit, workshop)),
        base_above => svg(steps::base_above(robot, kit, workshop)),
        tendon_way => svg(steps::tendon_way(kit, workshop)),
        front_plate => drawn("front-plate", HALF),
        spool_core => drawn("spool-core", 150.0),
        spool_flange => drawn("spool-flange", 190.0),
        clamp_plates => kit.base.clamp_plates,
        rod_in_base => decimal(kit.base.rod_in_base, 2),
        box_side => decimal(kit.base.side + 2.0 * workshop.sheet_thickness, 2),
        box_height => decimal(kit.base.height, 2),
        gap => decimal(kit.base.gap, 2),
        lines => lines(kit),
        circumference => decimal(workshop.circumference(), 3),
        steps_per_mm => format!("{:.4}", workshop.steps_per_length() / 1e3),
        microstep => format!("{:.2}", 1e6 / workshop.steps_per_length()),
        test_tendon => robot.tendons[test.tendon].name,
        test_axis => kit.lines[test.tendon].axis.to_string(),
        test_pull => decimal(test.pull, 1),
        test_steps => test.steps,
        test_tip => [test.tip.x, test.tip.y, test.tip.z].map(|x| decimal(x, 1)).join(", "),
        test_rest => [test.at_rest.x, test.at_rest.y, test.at_rest.z].map(|x| decimal(x, 1)).join(", "),
        test_way => decimal((test.tip - test.at_rest).norm(), 1),
        test_tension => format!("{:.2}", test.tension),
        test_strain => format!("{:.2}", 100.0 * test.strain),
        first_test => svg(steps::first_test(robot, kit)),
        grid_size => workshop.bench_size.map(|side| decimal(side, 1)).join(" x "),
        clamp => drawn("clamp-30", 220.0),
        plain => drawn("clamp-plain", 220.0),
        grid => svg(steps::grid(kit, workshop)),
        version => env!("CARGO_PKG_VERSION"),
    };
    // names with `<` or `&` are escaped because the template's name ends in .html
    Environment::new()
        .render_named_str("guide.html", TEMPLATE, page)
        .expect("the template is part of the program")
}

fn facts(robot: &Robot, workshop: &Workshop, kit: &Kit) -> Vec<Value> {
    let fact = |name: &str, value: String| context! { name, value };
    vec![
        fact("long", format!("{} mm", decimal(robot.length(), 1))),
        fact("guides", kit.guides.len().to_string()),
        fact("tendons and motors", kit.lines.len().to_string()),
        fact("sheets", format!("{} of {} mm", kit.sheets.len(), decimal(workshop.sheet_thickness, 3))),
    ]
}

fn checks(kit: &Kit) -> Vec<Value> {
    let check = |check: &hydrostat::fabricate::DesignCheck| {
        context! {
            name => check.name,
            verdict => tables::word(check.verdict),
            good => check.verdict == Verdict::Good,
            says => check.says,
            hint => check.hint,
        }
    };
    kit.checks.iter().map(check).collect()
}

fn sheets(kit: &Kit) -> Vec<Value> {
    let sheet = |sheet: &hydrostat::fabricate::Sheet| {
        let length: f64 = sheet.placed.iter().map(|on| kit.parts[on.part].cut_length()).sum();
        context! {
            name => sheet.name,
            size => sheet.size.map(|side| decimal(side, 1)).join(" x "),
            parts => sheet.placed.len(),
            length => format!("{length:.2}"),
        }
    };
    kit.sheets.iter().map(sheet).collect()
}

/// The parts by group, guides as one line.
fn parts(kit: &Kit) -> Vec<Value> {
    let line = |part: &Part, name: String, count: usize| {
        let size = part.bounds().size();
        context! {
            name,
            title => if part.group == Group::Guides { "guides, one of each number" } else { &part.title },
            count,
            size => format!("{} x {}", decimal(size.x, 2), decimal(size.y, 2)),
        }
    };
    let guides = &kit.guides;
    let all = format!("{} to {}", guides[0].part.name, guides[guides.len() - 1].part.name);
    let mut lines = Vec::new();
    for part in &kit.parts {
        if part.group != Group::Guides {
            lines.push(line(part, part.name.clone(), part.count));
        } else if part.name == guides[0].part.name {
            lines.push(line(part, all.clone(), guides.len()));
        }
    }
    lines
}

fn lines(kit: &Kit) -> Vec<Value> {
    let line = |(i, line): (usize, &hydrostat::fabricate::Line)| {
        context! {
            name => line.name,
            ends => line.ends,
            angle => format!("{:.0}", line.angle.to_degrees()),
            axis => line.axis.to_string(),
            port => format!("board {}, {}", i / 4 + 1, ["X", "Y", "Z", "A"][i % 4]),
            on_robot => decimal(line.on_robot, 1),
            cut => format!("{:.0}", line.cut_length * super::MM),
            tension => format!("{:.2}", line.tension),
            pull => line.longest_pull.map_or("no limit given".to_owned(), |pull| format!("{} mm", decimal(pull, 1))),
        }
    };
    kit.lines.iter().enumerate().map(line).collect()
}
