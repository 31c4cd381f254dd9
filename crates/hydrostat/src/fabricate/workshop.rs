//! How the kit is made: sheet, laser, fits, motors. Every value has a default.

use std::f64::consts::PI;

const MM: f64 = 1e-3;

/// What the file's `[fabrication]` says, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Workshop {
    /// As measured.
    pub sheet_thickness: f64,
    /// Width and height.
    pub sheet_size: [f64; 2],
    pub sheet_density: f64,
    /// Width of the laser's cut.
    pub kerf: f64,
    /// By how much the hole that holds the rod is smaller than the rod, in diameter.
    pub press_fit: f64,
    /// Of a slot over what it takes, in length and in width.
    pub slot_clearance: f64,
    /// Of a hole over the tendon or screw that passes it, in diameter.
    pub hole_clearance: f64,
    /// Least width of material between two cuts.
    pub minimum_web: f64,
    /// Between parts on a sheet, and to its edge.
    pub part_spacing: f64,
    pub tendon_diameter: f64,
    pub screw_diameter: f64,
    pub motor: Motor,
    /// Places for motors beyond one per tendon; None as many as the tendons of a robot of one section.
    pub spare_motors: Option<usize>,
    /// Under the tendon.
    pub spool_diameter: f64,
    /// Of the idle pulleys, under the tendon.
    pub pulley_diameter: f64,
    /// Length of the rod in the base.
    pub rod_grip: f64,
    /// Width and height of the verification grid.
    pub bench_size: [f64; 2],
    /// Keys of the file that were given.
    pub given: Vec<&'static str>,
}

/// A stepper motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    pub frame: Frame,
    /// Of the body, from the plate it is screwed to.
    pub length: f64,
    /// Holding torque, N m.
    pub torque: f64,
    /// Of one full step, rad.
    pub step: f64,
    pub microsteps: f64,
}

/// A size of stepper motor: the square, its holes, the ring around the shaft, the shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub name: &'static str,
    pub side: f64,
    pub hole_spacing: f64,
    /// Of the screws that hold it.
    pub screw: f64,
    pub boss: f64,
    pub shaft: f64,
    /// From the shaft's centre to its flat.
    pub flat: f64,
    /// Of the shaft, from the plate.
    pub shaft_length: f64,
}

/// Faces of NEMA ICS 16-2001 as makers of steppers draw them (42BYG, 35BYG and 57BYG series); D-shafts with a flat of 0.5 mm.
pub const FRAMES: [Frame; 3] = [
    Frame {
        name: "NEMA 14",
        side: 35.2 * MM,
        hole_spacing: 26.0 * MM,
        screw: 3.0 * MM,
        boss: 22.0 * MM,
        shaft: 5.0 * MM,
        flat: 2.0 * MM,
        shaft_length: 22.0 * MM,
    },
    Frame {
        name: "NEMA 17",
        side: 42.3 * MM,
        hole_spacing: 31.0 * MM,
        screw: 3.0 * MM,
        boss: 22.0 * MM,
        shaft: 5.0 * MM,
        flat: 2.0 * MM,
        shaft_length: 24.0 * MM,
    },
    Frame {
        name: "NEMA 23",
        side: 56.4 * MM,
        hole_spacing: 47.14 * MM,
        screw: 5.0 * MM,
        boss: 38.1 * MM,
        shaft: 6.35 * MM,
        flat: 2.675 * MM,
        shaft_length: 21.0 * MM,
    },
];

impl Default for Workshop {
    /// Acrylic of 1/8 inch and a rod that is held over 1 cm as in Gray 2009; a sheet and a grid of 24 x 18 inch; a common NEMA 17
    /// (0.4 N m, 1.8 degrees, 40 mm) on a driver with 16 microsteps.
    fn default() -> Self {
        Workshop {
            sheet_thickness: 3.175 * MM,
            sheet_size: [609.6 * MM, 457.2 * MM],
            sheet_density: 1180.0,
            kerf: 0.15 * MM,
            press_fit: 0.05 * MM,
            slot_clearance: 0.1 * MM,
            hole_clearance: 0.5 * MM,
            minimum_web: 1.0 * MM,
            part_spacing: 3.0 * MM,
            tendon_diameter: 0.5 * MM,
            screw_diameter: 3.0 * MM,
            motor: Motor {
                frame: FRAMES[1],
                length: 40.0 * MM,
                torque: 0.4,
                step: 1.8 * PI / 180.0,
                microsteps: 16.0,
            },
            spare_motors: None,
            spool_diameter: 20.0 * MM,
            pulley_diameter: 10.0 * MM,
            rod_grip: 10.0 * MM,
            bench_size: [457.2 * MM, 609.6 * MM],
            given: Vec::new(),
        }
    }
}

/// A setting as it was used.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub key: &'static str,
    pub value: String,
    /// Not in the file.
    pub default: bool,
}

impl Workshop {
    /// Every setting with its value, in the order of the format.
    pub fn settings(&self) -> Vec<Setting> {
        let mm = |length: f64| format!("{} mm", short(length / MM));
        let size = |[w, h]: [f64; 2]| format!("[{}, {}] mm", short(w / MM), short(h / MM));
        let values = [
            ("sheet_thickness", mm(self.sheet_thickness)),
            ("sheet_size", size(self.sheet_size)),
            ("sheet_density", format!("{} g/cm^3", short(self.sheet_density / 1000.0))),
            ("kerf", mm(self.kerf)),
            ("press_fit", mm(self.press_fit)),
            ("slot_clearance", mm(self.slot_clearance)),
            ("hole_clearance", mm(self.hole_clearance)),
            ("minimum_web", mm(self.minimum_web)),
            ("part_spacing", mm(self.part_spacing)),
            ("tendon_diameter", mm(self.tendon_diameter)),
            ("screw_diameter", mm(self.screw_diameter)),
            ("motor_frame", self.motor.frame.name.to_owned()),
            ("motor_length", mm(self.motor.length)),
            ("motor_torque", format!("{} N m", short(self.motor.torque))),
            ("motor_step", format!("{} deg", short(self.motor.step.to_degrees()))),
            ("microsteps", short(self.motor.microsteps)),
            (
                "spare_motors",
                self.spare_motors
                    .map_or("one per tendon of a robot of one section".to_owned(), |n| n.to_string()),
            ),
            ("spool_diameter", mm(self.spool_diameter)),
            ("pulley_diameter", mm(self.pulley_diameter)),
            ("rod_grip", mm(self.rod_grip)),
            ("bench_size", size(self.bench_size)),
        ];
        let setting = |(key, value)| Setting { key, value, default: !self.given.contains(&key) };
        values.into_iter().map(setting).collect()
    }

    /// Of the hole that a tendon passes.
    pub fn tendon_hole(&self) -> f64 {
        self.tendon_diameter + self.hole_clearance
    }

    /// Of the hole that a screw of this diameter passes.
    pub fn screw_hole(&self, screw: f64) -> f64 {
        screw + self.hole_clearance
    }

    /// Radius at which the tendon's middle lies on the spool.
    pub fn spool_radius(&self) -> f64 {
        0.5 * (self.spool_diameter + self.tendon_diameter)
    }

    /// Length of tendon per turn of the spool.
    pub fn circumference(&self) -> f64 {
        2.0 * PI * self.spool_radius()
    }

    /// Microsteps per m of tendon.
    pub fn steps_per_length(&self) -> f64 {
        2.0 * PI / self.motor.step * self.motor.microsteps / self.circumference()
    }
}

/// Without zeros at the end, to four decimals.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
