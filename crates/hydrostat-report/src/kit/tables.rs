//! Bill of materials, cut list, wiring, motion settings and checks as CSV.

use super::decimal;
use hydrostat::fabricate::{Kit, Verdict, Workshop};

/// Name and text of each table.
pub(super) fn tables(workshop: &Workshop, kit: &Kit) -> Vec<(&'static str, String)> {
    vec![
        ("bill-of-materials.csv", bill(kit)),
        ("cut-list.csv", cut_list(workshop, kit)),
        ("wiring.csv", wiring(kit)),
        ("motion.csv", motion(workshop, kit)),
        ("checks.csv", checks(kit)),
        ("settings.csv", settings(workshop)),
    ]
}

/// A line of cells, quoted where they need it.
fn row(cells: &[String]) -> String {
    let quoted = |cell: &String| {
        if cell.contains([',', '"', '\n']) {
            format!("\"{}\"", cell.replace('"', "\"\""))
        } else {
            cell.clone()
        }
    };
    cells.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

fn bill(kit: &Kit) -> String {
    let rows = kit.bill.iter().map(|item| {
        row(&[item.item.clone(), item.specification.clone(), item.quantity.to_string(), item.note.clone()])
    });
    "item,specification,quantity,note\n".to_owned() + &rows.collect::<String>()
}

/// Sizes before the kerf; volume of one part of the sheet's thickness, without what is engraved.
fn cut_list(workshop: &Workshop, kit: &Kit) -> String {
    let sheets = |part: usize| {
        let on = kit.sheets.iter().filter(|sheet| sheet.placed.iter().any(|placed| placed.part == part));
        on.map(|sheet| sheet.name.clone()).collect::<Vec<_>>().join(" ")
    };
    let rows = kit.parts.iter().enumerate().map(|(i, part)| {
        let size = part.bounds().size();
        let pockets: f64 =
            part.pockets.iter().map(|(pocket, depth)| pocket.area().min(part.area()) * depth).sum();
        let volume = part.area() * workshop.sheet_thickness - pockets;
        row(&[
            part.name.clone(),
            part.title.clone(),
            part.count.to_string(),
            decimal(size.x, 3),
            decimal(size.y, 3),
            decimal(workshop.sheet_thickness, 3),
            format!("{:.6}", part.area() * 1e6),
            format!("{:.6}", volume * 1e9),
            decimal(part.cut_length(), 1),
            sheets(i),
        ])
    });
    "part,title,count,width [mm],height [mm],thickness [mm],area [mm^2],volume [mm^3],cut length [mm],sheets\n".to_owned()
        + &rows.collect::<String>()
}

fn wiring(kit: &Kit) -> String {
    let rows = kit.lines.iter().enumerate().map(|(i, line)| {
        let port = format!("board {} {}", i / 4 + 1, ["X", "Y", "Z", "A"][i % 4]);
        row(&[
            line.name.clone(),
            line.ends.clone(),
            format!("{:.1}", line.angle.to_degrees()),
            line.axis.to_string(),
            port,
            "tendon winds in".to_owned(),
        ])
    });
    "tendon,ends at,hole angle [deg],motor,driver port,positive direction\n".to_owned()
        + &rows.collect::<String>()
}

fn motion(workshop: &Workshop, kit: &Kit) -> String {
    let steps = workshop.steps_per_length() / 1e3;
    let rows = kit.lines.iter().map(|line| {
        row(&[
            line.axis.to_string(),
            line.name.clone(),
            format!("{steps:.6}"),
            decimal(workshop.circumference(), 6),
            format!("{:.6}", 1.0 / steps),
            format!("{}", workshop.motor.microsteps),
            line.longest_pull.map_or(String::new(), |pull| decimal(pull, 2)),
        ])
    });
    "motor,tendon,steps per mm,spool circumference [mm],mm per microstep,microsteps,longest pull [mm]\n"
        .to_owned()
        + &rows.collect::<String>()
}

/// A verdict in a word.
pub(super) fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "good",
        Verdict::Doubtful => "look at it",
        Verdict::Impossible => "impossible",
    }
}

fn checks(kit: &Kit) -> String {
    let rows = kit.checks.iter().map(|check| {
        row(&[
            check.name.to_owned(),
            word(check.verdict).to_owned(),
            check.says.clone(),
            check.hint.unwrap_or_default().to_owned(),
        ])
    });
    "check,verdict,finding,what to try\n".to_owned() + &rows.collect::<String>()
}

fn settings(workshop: &Workshop) -> String {
    let rows = workshop.settings().into_iter().map(|setting| {
        let from = if setting.default { "default" } else { "robot file" };
        row(&[setting.key.to_owned(), setting.value, from.to_owned()])
    });
    "key,value,from\n".to_owned() + &rows.collect::<String>()
}
