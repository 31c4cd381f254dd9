//! What to buy.

use super::Kit;
use super::part::Group;
use super::workshop::{Workshop, short};
use crate::Robot;
use crate::model::CrossSection;

const MM: f64 = 1e-3;
/// Of rod beyond what is needed, to be cut flush.
const ROD_SPARE: f64 = 5.0 * MM;
/// Lengths of screws in the shops.
const SCREWS: [f64; 12] = [6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0];
/// Sets of bench clamps that are used at one time.
const CLAMPS: usize = 3;

/// A line of the bill of materials.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    pub item: String,
    pub specification: String,
    pub quantity: usize,
    pub note: String,
}

pub(super) fn bill(robot: &Robot, workshop: &Workshop, kit: &Kit) -> Vec<Item> {
    let mut items = rods(robot, kit);
    items.push(cable(workshop, kit));
    items.extend(sheets(workshop, kit));
    items.extend(motors(workshop, kit));
    items.extend(screws(workshop, kit));
    items
}

fn item(item: &str, specification: String, quantity: usize, note: String) -> Item {
    Item { item: item.to_owned(), specification, quantity, note }
}

/// One length of rod per run of sections with one profile and material.
fn rods(robot: &Robot, kit: &Kit) -> Vec<Item> {
    let mut items = Vec::new();
    let mut first = 0;
    let same = |i: usize, j: usize| {
        let (a, b) = (&robot.sections[i], &robot.sections[j]);
        a.profile == b.profile && a.material == b.material && a.profile.base == a.profile.tip
    };
    for i in 1..=robot.sections.len() {
        if i < robot.sections.len() && same(first, i) {
            continue;
        }
        let length: f64 = robot.sections[first..i].iter().map(|section| section.length).sum();
        let in_base = if first == 0 { kit.base.rod_in_base } else { 0.0 };
        let section = &robot.sections[first];
        let tapers = if section.profile.base == section.profile.tip { "" } else { " at its base, tapering" };
        let profile = match section.profile.base {
            CrossSection::Round { diameter } => format!("diameter {} mm", short(diameter / MM)),
            CrossSection::Tube { diameter, inner_diameter } => {
                format!("tube {} x {} mm", short(diameter / MM), short(inner_diameter / MM))
            }
            CrossSection::Strip { width, height } => {
                format!("strip {} x {} mm", short(width / MM), short(height / MM))
            }
        };
        let names: Vec<&str> = robot.sections[first..i].iter().map(|section| section.name.as_str()).collect();
        let note = format!(
            "sections {}; {} mm on the robot, {} mm in the base, {} mm to trim",
            names.join(", "),
            short(length / MM),
            short(in_base / MM),
            short(ROD_SPARE / MM)
        );
        let cut = (length + in_base + ROD_SPARE) / MM;
        let specification = format!("{} {profile}{tapers}, cut to {cut:.1} mm", section.material.name);
        items.push(item("rod", specification, 1, note));
        first = i;
    }
    items
}

fn cable(workshop: &Workshop, kit: &Kit) -> Item {
    let total: f64 = kit.lines.iter().map(|line| line.cut_length).sum();
    let each: Vec<String> =
        kit.lines.iter().map(|line| format!("{} {:.0} mm", line.name, line.cut_length / MM)).collect();
    let specification =
        format!("diameter {} mm, {:.2} m in all", short(workshop.tendon_diameter / MM), total);
    item("cable", specification, kit.lines.len(), format!("cut: {}", each.join(", ")))
}

fn sheets(workshop: &Workshop, kit: &Kit) -> Vec<Item> {
    let [w, h] = workshop.sheet_size.map(|side| short(side / MM));
    let specification = format!("acrylic {} mm, {w} x {h} mm", short(workshop.sheet_thickness / MM));
    let of = |bench: bool| {
        let group = |part: usize| kit.parts[part].group == Group::Bench;
        let sheets = kit
            .sheets
            .iter()
            .filter(|sheet| sheet.placed.first().is_some_and(|first| group(first.part) == bench));
        sheets.count()
    };
    vec![
        item(
            "sheet",
            specification.clone(),
            of(false),
            "coupon, guides, base and assembly device; cut small groups from offcuts".to_owned(),
        ),
        item(
            "sheet",
            specification,
            of(true),
            "verification bench; leave out if you do not measure".to_owned(),
        ),
    ]
}

fn motors(workshop: &Workshop, kit: &Kit) -> Vec<Item> {
    let (motor, count) = (&workshop.motor, kit.lines.len());
    let spare = kit.base.places.len() - count;
    let specification = format!(
        "{} stepper, {} mm long, {} N m, {} degrees a step, D-shaft {} mm",
        motor.frame.name,
        short(motor.length / MM),
        short(motor.torque),
        short(motor.step.to_degrees()),
        short(motor.frame.shaft / MM)
    );
    let boards = count.div_ceil(4);
    vec![
        item("motor", specification, count, format!("{spare} more fit into the base")),
        item(
            "driver board",
            format!("4 axes, {} microsteps", short(motor.microsteps)),
            boards,
            format!("{count} axes are used; GRBL or similar"),
        ),
        item(
            "idle pulley",
            format!(
                "ball bearing with groove, {} x {} x 4 mm, groove {} mm",
                short(workshop.screw_diameter / MM),
                short(workshop.pulley_diameter / MM + 2.0),
                short(workshop.pulley_diameter / MM)
            ),
            count,
            "one per tendon".to_owned(),
        ),
    ]
}

/// Screws with nuts, by diameter and length.
fn screws(workshop: &Workshop, kit: &Kit) -> Vec<Item> {
    let t = workshop.sheet_thickness / MM;
    let size = |length: f64| SCREWS.into_iter().find(|screw| *screw >= length).unwrap_or(length.ceil());
    let (own, motor) = (workshop.screw_diameter / MM, workshop.motor.frame.screw / MM);
    let nut = 0.8 * own + 1.0; // its height and a turn of thread
    let count = kit.lines.len();
    let with_nut = |length: f64| format!("M{} x {} mm with nut", short(own), short(size(length)));
    let clamp_plates = kit.base.clamp_plates as f64;
    vec![
        item(
            "screw",
            with_nut((clamp_plates + 1.0) * t + nut),
            4,
            "rod clamp behind the front plate".to_owned(),
        ),
        item(
            "screw",
            with_nut(t + 4.0 + 1.0 + nut),
            count,
            "axles of the pulleys, with a washer of 0.5 mm".to_owned(),
        ),
        item(
            "screw",
            format!("M{} x {} mm", short(motor), short(size(t + 4.0))),
            4 * count,
            "motors".to_owned(),
        ),
        item(
            "screw",
            with_nut(3.0 * t + nut),
            4 * CLAMPS,
            "bench clamps: grid, clamp, counterpart".to_owned(),
        ),
        item("washer", format!("M{}, 0.5 mm", short(own)), count, "between pulley and bracket".to_owned()),
    ]
}
