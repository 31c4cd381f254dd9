//! The assembly guide: one page with everything that a class needs to build the robot.

use super::{decimal, steps, tables};
use hydrostat::Robot;
use hydrostat::fabricate::{Group, Guide, KERF_CUTS, KERF_WINDOW, Kit, Part, Verdict, Workshop};
use minijinja::value::merge_maps;
use minijinja::{Environment, Value, context};

const TEMPLATE: &str = include_str!("guide.html");
/// Of a drawing across the page, and of two side by side, px.
const WHOLE: f64 = 720.0;
const HALF: f64 = 330.0;

/// One self-contained page (inline CSS and SVG, no scripts) that also prints on A4.
pub(super) fn page(robot: &Robot, workshop: &Workshop, kit: &Kit, source: &str) -> String {
    let head = context! { name => robot.name.clone(), source, version => env!("CARGO_PKG_VERSION") };
    let page = merge_maps([
        head,
        overview(robot, workshop, kit),
        coupon(workshop, kit),
        bench(workshop, kit),
        guides(robot, workshop, kit),
        device(robot, workshop, kit),
        base(robot, workshop, kit),
        motion(workshop, kit),
        first_test(robot, kit),
    ]);
    // names with `<` or `&` are escaped because the template's name ends in .html
    Environment::new()
        .render_named_str("guide.html", TEMPLATE, page)
        .expect("the template is part of the program")
}

fn svg(text: String) -> Value {
    Value::from_safe_string(text)
}

fn drawn(kit: &Kit, name: &str, width: f64) -> Value {
    let part = kit.parts.iter().find(|part| part.name == name);
    svg(part.map_or(String::new(), |part| steps::part(part, width)))
}

fn overview(robot: &Robot, workshop: &Workshop, kit: &Kit) -> Value {
    let item = |item: &hydrostat::fabricate::Item| {
        context! {
            item => item.item.clone(),
            specification => item.specification.clone(),
            quantity => item.quantity,
            note => item.note.clone(),
        }
    };
    let setting = |setting: hydrostat::fabricate::Setting| {
        context! { key => setting.key, value => setting.value, default => setting.default }
    };
    context! {
        facts => facts(robot, workshop, kit),
        checks => checks(kit),
        bill => kit.bill.iter().map(item).collect::<Vec<_>>(),
        settings => workshop.settings().into_iter().map(setting).collect::<Vec<_>>(),
        sheets => sheets(kit),
        parts => parts(kit),
    }
}

fn coupon(workshop: &Workshop, kit: &Kit) -> Value {
    context! {
        kerf => decimal(workshop.kerf, 3),
        kerf_cuts => KERF_CUTS,
        kerf_window => decimal(KERF_WINDOW, 1),
        expected_gap => decimal(KERF_CUTS as f64 * workshop.kerf, 2),
        press_fit => decimal(workshop.press_fit, 3),
        thickness => decimal(workshop.sheet_thickness, 3),
        coupon => drawn(kit, "coupon", WHOLE),
    }
}

fn bench(workshop: &Workshop, kit: &Kit) -> Value {
    context! {
        grid_size => workshop.bench_size.map(|side| decimal(side, 1)).join(" x "),
        clamp => drawn(kit, "clamp-30", 150.0),
        plain => drawn(kit, "clamp-plain", 150.0),
        grid => svg(steps::grid(kit, workshop)),
    }
}

fn guides(robot: &Robot, workshop: &Workshop, kit: &Kit) -> Value {
    let (first, last) = (&kit.guides[0], &kit.guides[kit.guides.len() - 1]);
    let tied = |guide: &Guide| guide.holes.iter().map(|hole| (hole.tendon, hole.ends)).collect::<Vec<_>>();
    let tendon = |hole: &hydrostat::fabricate::TendonHole| {
        format!("{}{}", robot.tendons[hole.tendon].name, if hole.ends { " (tied)" } else { "" })
    };
    let row = |guide: &Guide| {
        context! {
            number => guide.number,
            section => robot.sections[guide.section].name.clone(),
            s => decimal(guide.s, 2),
            tendons => guide.holes.iter().map(tendon).collect::<Vec<_>>().join(", "),
        }
    };
    context! {
        first_guide => svg(steps::guide(robot, first, workshop)),
        last_guide => svg(steps::guide(robot, last, workshop)),
        two_kinds => tied(first) != tied(last),
        first_number => first.number,
        last_number => last.number,
        first_s => decimal(first.s, 2),
        last_s => decimal(last.s, 2),
        guides_apart => decimal(last.s - first.s, 2),
        guides => kit.guides.iter().map(row).collect::<Vec<_>>(),
    }
}

fn device(robot: &Robot, workshop: &Workshop, kit: &Kit) -> Value {
    context! {
        device_side => svg(steps::device_side(robot, kit, workshop)),
        device_end => svg(steps::device_end(robot, kit, workshop)),
        comb_pieces => kit.device.combs.len(),
        aligned => robot.tendons[kit.device.aligned].name.clone(),
    }
}

fn base(robot: &Robot, workshop: &Workshop, kit: &Kit) -> Value {
    let base = &kit.base;
    context! {
        base_apart => svg(steps::base_apart(kit, workshop)),
        base_above => svg(steps::base_above(robot, kit, workshop)),
        tendon_way => svg(steps::tendon_way(kit, workshop)),
        front_plate => drawn(kit, "front-plate", HALF),
        spool_core => drawn(kit, "spool-core", 130.0),
        spool_flange => drawn(kit, "spool-flange", 165.0),
        spare_places => base.places.len() - kit.lines.len(),
        clamp_plates => base.clamp_plates,
        rod_in_base => decimal(base.rod_in_base, 2),
        spool_height => decimal(base.spool_height, 2),
        box_side => decimal(base.side + 2.0 * workshop.sheet_thickness, 2),
        box_height => decimal(base.height, 2),
        gap => decimal(base.gap, 2),
    }
}

fn motion(workshop: &Workshop, kit: &Kit) -> Value {
    context! {
        lines => lines(kit),
        circumference => decimal(workshop.circumference(), 3),
        steps_per_mm => format!("{:.4}", workshop.steps_per_length() / super::MM),
        microstep => format!("{:.2}", 1e6 / workshop.steps_per_length()),
    }
}

fn first_test(robot: &Robot, kit: &Kit) -> Value {
    let test = &kit.first_test;
    let place = |p: nalgebra::Vector3<f64>| [p.x, p.y, p.z].map(|x| decimal(x, 1)).join(", ");
    let others = kit.lines.iter().filter(|line| line.tendon != test.tendon);
    context! {
        test_tendon => robot.tendons[test.tendon].name.clone(),
        test_axis => kit.lines[test.tendon].axis.to_string(),
        test_pull => decimal(test.pull, 1),
        test_steps => format!("{:.0}", test.steps),
        test_tip => place(test.tip),
        test_rest => place(test.at_rest),
        test_way => decimal((test.tip - test.at_rest).norm(), 1),
        test_tension => format!("{:.2}", test.tension),
        test_strain => format!("{:.2}", 100.0 * test.strain),
        test_others => others.map(|line| format!("{}=0N", line.name)).collect::<Vec<_>>().join(","),
        first_test => svg(steps::first_test(robot, kit)),
    }
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
            says => check.says.clone(),
            hint => check.hint,
        }
    };
    kit.checks.iter().map(check).collect()
}

fn sheets(kit: &Kit) -> Vec<Value> {
    let sheet = |sheet: &hydrostat::fabricate::Sheet| {
        let length: f64 = sheet.placed.iter().map(|on| kit.parts[on.part].cut_length()).sum();
        context! {
            name => sheet.name.clone(),
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
            title => if part.group == Group::Guides { "guides, one of each number".to_owned() } else { part.title.clone() },
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
            name => line.name.clone(),
            ends => line.ends.clone(),
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
