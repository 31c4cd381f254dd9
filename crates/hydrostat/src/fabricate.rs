//! The workshop's kit: every part of robot, base and bench as a drawing, from the same file as the model.
//!
//! [`kit`] lays out guides, base, assembly device and bench, holds the design against its limits and nests the parts on sheets;
//! [`check`] does the checks alone. Lengths are m; contours are what stays of the sheet, [`Cut`] is the way of the laser, half a
//! kerf outside.

mod base;
mod bench;
mod bill;
mod coupon;
mod cut;
mod design;
mod device;
mod drive;
mod guides;
mod lettering;
mod nesting;
mod part;
mod workshop;

pub use base::{Base, MotorPlace};
pub use bill::Item;
pub use coupon::{FITS, KERF_CUTS, KERF_WINDOW};
pub use cut::{Cut, cut_part, cut_sheet};
pub use design::{DesignCheck, Verdict};
pub use device::{Comb, Device};
pub use drive::{FirstTest, Line};
pub use guides::{Guide, TendonHole};
pub use nesting::{OnSheet, Sheet, fills_sheet};
pub use part::{Group, Part, Placed, Tab};
pub use workshop::{FRAMES, Frame, Motor, Setting, Workshop};

use crate::{Error, Robot};

/// Everything that is made, bought and expected.
#[derive(Clone, Debug, PartialEq)]
pub struct Kit {
    pub checks: Vec<DesignCheck>,
    pub parts: Vec<Part>,
    pub sheets: Vec<Sheet>,
    pub guides: Vec<Guide>,
    pub base: Base,
    pub device: Device,
    pub lines: Vec<Line>,
    pub bill: Vec<Item>,
    pub first_test: FirstTest,
}

/// Parts and checks, before anything is nested.
struct Design {
    guides: Vec<Guide>,
    base: Base,
    device: Device,
    parts: Vec<Part>,
    checks: Vec<DesignCheck>,
}

/// The checks of the design alone.
///
/// # Errors
/// What cannot even be drawn: no tendons, no guides, no hole for the rod, no shape of the robot as commanded.
pub fn check(robot: &Robot, workshop: &Workshop) -> Result<Vec<DesignCheck>, Error> {
    Ok(design(robot, workshop)?.checks)
}

/// The whole kit.
///
/// # Errors
/// As [`check`], and a design of which a check is impossible: all of them are named.
pub fn kit(robot: &Robot, workshop: &Workshop) -> Result<Kit, Error> {
    let design = design(robot, workshop)?;
    refuse(&design.checks)?;
    let Design { guides, base, device, parts, checks } = design;
    let sheets = nesting::nest(&parts, workshop);
    let lines = drive::lines(robot, workshop, &base)?;
    let first_test = drive::first_test(robot, workshop)?;
    let mut kit = Kit { checks, parts, sheets, guides, base, device, lines, bill: Vec::new(), first_test };
    kit.bill = bill::bill(robot, workshop, &kit);
    Ok(kit)
}

fn design(robot: &Robot, workshop: &Workshop) -> Result<Design, Error> {
    robot.check()?;
    let guides = guides::guides(robot, workshop)?;
    let device = device::device(robot, workshop, &guides)?;
    let base = base::base(robot, workshop)?;
    let mut parts = vec![coupon::coupon(robot, workshop)];
    parts.extend(guides.iter().map(|guide| guide.part.clone()));
    parts.extend(base.parts.iter().chain(&device.parts).cloned());
    parts.extend(bench::bench(robot, workshop));
    let mut checks = design::of_parts(workshop, &guides, &base, &parts);
    checks.extend(design::rod_joints(robot));
    checks.extend(design::alignment(robot, &device));
    checks.extend(design::of_robot(robot, workshop, &guides)?);
    Ok(Design { guides, base, device, parts, checks })
}

/// All impossible checks as one error.
fn refuse(checks: &[DesignCheck]) -> Result<(), Error> {
    let impossible: Vec<&DesignCheck> =
        checks.iter().filter(|check| check.verdict == Verdict::Impossible).collect();
    let Some(first) = impossible.first() else { return Ok(()) };
    let says: Vec<String> =
        impossible.iter().map(|check| format!("{}: {}", check.name, check.says)).collect();
    let error = Error::new(format!("this design cannot be built: {}", says.join("; ")));
    Err(first.hint.iter().fold(error, |error, hint| error.hint(*hint)))
}
