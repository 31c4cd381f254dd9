//! What can be freed: one place in the robot or the bench.

use super::setup::Setup;
use crate::Error;
use crate::description::quantity::{self, Kind};
use crate::model::{CrossSection, LoadKind, Robot};
use crate::verify::{Experiment, Varied};

/// One place in the robot or the bench; indices are the model's, axes 0 to 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// G keeps its ratio to E, unless it is free itself.
    YoungsModulus {
        material: String,
    },
    ShearModulus {
        material: String,
    },
    Density {
        material: String,
    },
    /// Takes the section's guides and what is at the tip along.
    Length {
        section: usize,
    },
    /// A taper keeps its proportions.
    Dimension {
        section: usize,
        which: Dimension,
    },
    RestCurvature {
        section: usize,
        axis: usize,
    },
    /// A hole that comes nearer to the backbone keeps its proportions.
    HoleRadius {
        tendon: usize,
    },
    HoleAngle {
        tendon: usize,
    },
    Stiffness {
        tendon: usize,
    },
    Friction {
        tendon: usize,
    },
    /// Pretension above 0, slack below.
    Home {
        tendon: usize,
    },
    /// Of each guide of a section.
    GuideMass {
        section: usize,
    },
    BasePosition {
        axis: usize,
    },
    /// Rotation vector, world axes, about the base; on top of the file's.
    BaseRotation {
        axis: usize,
    },
    /// About the bench's z axis; on top of the file's.
    MountAngle,
    /// Added to every mass of a varied input that is not 0.
    MassOffset {
        input: usize,
    },
    /// Of the drive of a varied displacement.
    Backlash {
        input: usize,
    },
    /// Of a measured point from the backbone, body frame.
    MarkerOffset {
        point: usize,
        axis: usize,
    },
}

/// Of a cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    Diameter,
    InnerDiameter,
    Width,
    Height,
}

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

impl Part {
    /// What it measures.
    pub fn kind(&self) -> Kind {
        match self {
            Part::YoungsModulus { .. } | Part::ShearModulus { .. } => quantity::STRESS,
            Part::Density { .. } => quantity::DENSITY,
            Part::Length { .. }
            | Part::Dimension { .. }
            | Part::HoleRadius { .. }
            | Part::Home { .. }
            | Part::BasePosition { .. }
            | Part::Backlash { .. }
            | Part::MarkerOffset { .. } => quantity::LENGTH,
            Part::RestCurvature { .. } => quantity::CURVATURE,
            Part::HoleAngle { .. } | Part::BaseRotation { .. } | Part::MountAngle => quantity::ANGLE,
            Part::Stiffness { .. } => quantity::FORCE,
            Part::Friction { .. } => quantity::FRACTION,
            Part::MassOffset { .. } | Part::GuideMass { .. } => quantity::MASS,
        }
    }

    /// The unit in which people read it, and its size in SI.
    pub fn display_unit(&self) -> (&'static str, f64) {
        match self.kind() {
            quantity::STRESS => ("GPa", 1e9),
            quantity::DENSITY => ("g/cm^3", 1e3),
            quantity::LENGTH => ("mm", 1e-3),
            quantity::ANGLE => ("deg", 1_f64.to_radians()),
            quantity::MASS => ("g", 1e-3),
            kind => (kind.unit, 1.0),
        }
    }

    /// The smallest value that is possible; None where any sign is.
    pub(super) fn lowest(&self) -> Option<f64> {
        match self {
            Part::YoungsModulus { .. }
            | Part::ShearModulus { .. }
            | Part::Length { .. }
            | Part::Dimension { .. }
            | Part::Stiffness { .. } => Some(f64::MIN_POSITIVE),
            Part::Density { .. }
            | Part::HoleRadius { .. }
            | Part::Friction { .. }
            | Part::GuideMass { .. }
            | Part::Backlash { .. } => Some(0.0),
            _ => None,
        }
    }

    /// Between these a fit keeps it where the user gives neither bounds nor a prior, SI: what is possible, and for materials what any solid has.
    ///
    /// Pa: soft gels and tissue have about 1 kPa, diamond has 1050 to 1210 GPa. kg/m^3: osmium has 22.6e3, and ten times that leaves
    /// room for parts on the backbone that the file does not have.
    pub(super) fn possible(&self) -> [f64; 2] {
        match self {
            Part::YoungsModulus { .. } | Part::ShearModulus { .. } => [1e3, 1500e9],
            Part::Density { .. } => [0.0, 250e3],
            _ => [self.lowest_possible(), f64::INFINITY],
        }
    }

    /// Below it a difference would ask for an impossible robot.
    pub(crate) fn lowest_possible(&self) -> f64 {
        self.lowest().unwrap_or(f64::NEG_INFINITY)
    }

    /// A change that matters: the value itself, or what the bench is large in.
    pub(crate) fn scale(&self, experiment: &Experiment, value: f64) -> f64 {
        let length = experiment.robot.length();
        match self {
            Part::BasePosition { .. } | Part::MarkerOffset { .. } => length,
            Part::HoleAngle { .. } | Part::BaseRotation { .. } | Part::MountAngle | Part::Friction { .. } => {
                1.0
            }
            Part::RestCurvature { .. } => 1.0 / length,
            Part::MassOffset { input } => {
                let masses = experiment.rows.iter().map(|row| row.inputs[*input].abs());
                let largest = masses.fold(0.0, f64::max);
                if largest > 0.0 { largest } else { 1e-3 }
            }
            Part::Home { tendon } => experiment.robot.tendons[*tendon].path.radius.max(1e-3 * length),
            Part::Backlash { input } => {
                let values = experiment.rows.iter().map(|row| row.inputs[*input].abs());
                values.fold(1e-3 * length, f64::max)
            }
            Part::GuideMass { .. } if value == 0.0 => 1e-3,
            Part::HoleRadius { .. } if value == 0.0 => length,
            Part::Density { .. } if value == 0.0 => 1e3,
            _ => value.abs(),
        }
    }

    /// Dotted, as in `set`, with what the robot file has no key for under `bench`, `vary` and `measure`.
    pub fn path(&self, experiment: &Experiment) -> String {
        let robot = &experiment.robot;
        let section = |i: usize| &robot.sections[i].name;
        let tendon = |i: usize| &robot.tendons[i].name;
        match self {
            Part::YoungsModulus { material } => format!("material.{material}.youngs_modulus"),
            Part::ShearModulus { material } => format!("material.{material}.shear_modulus"),
            Part::Density { material } => format!("material.{material}.density"),
            Part::Length { section: i } => format!("section.{}.length", section(*i)),
            Part::Dimension { section: i, which } => {
                format!("section.{}.profile.{}", section(*i), which.key())
            }
            Part::RestCurvature { section: i, axis } => {
                format!("section.{}.rest_curvature.{}", section(*i), AXES[*axis])
            }
            Part::HoleRadius { tendon: i } => format!("tendon.{}.radius", tendon(*i)),
            Part::HoleAngle { tendon: i } => format!("tendon.{}.angle", tendon(*i)),
            Part::Stiffness { tendon: i } => format!("tendon.{}.stiffness", tendon(*i)),
            Part::Friction { tendon: i } => format!("tendon.{}.friction", tendon(*i)),
            Part::Home { tendon: i } => format!("tendon.{}.home", tendon(*i)),
            Part::GuideMass { section: i } => format!("section.{}.guides.mass", section(*i)),
            Part::Backlash { input } => format!("vary.{}.backlash", input + 1),
            Part::BasePosition { axis } => format!("base.position.{}", AXES[*axis]),
            Part::BaseRotation { axis } => format!("base.rotation.{}", AXES[*axis]),
            Part::MountAngle => "bench.mount_angle".to_owned(),
            Part::MassOffset { input } => format!("vary.{}.mass_offset", input + 1),
            Part::MarkerOffset { point, axis } => {
                format!("measure.{}.marker_offset.{}", point + 1, AXES[*axis])
            }
        }
    }

    /// Everything that can be freed of this experiment.
    pub(super) fn all(experiment: &Experiment) -> Vec<Part> {
        let robot = &experiment.robot;
        let mut parts = Vec::new();
        let mut materials: Vec<&str> = Vec::new();
        for section in &robot.sections {
            if !materials.contains(&section.material.name.as_str()) {
                materials.push(&section.material.name);
            }
        }
        for material in materials {
            let material = || material.to_owned();
            parts.push(Part::YoungsModulus { material: material() });
            parts.push(Part::ShearModulus { material: material() });
            parts.push(Part::Density { material: material() });
        }
        for (i, section) in robot.sections.iter().enumerate() {
            parts.push(Part::Length { section: i });
            let has = |which: &Dimension| which.of(&section.profile.base).is_some();
            let dimensions = Dimension::ALL.into_iter().filter(has);
            parts.extend(dimensions.map(|which| Part::Dimension { section: i, which }));
            parts.extend((0..3).map(|axis| Part::RestCurvature { section: i, axis }));
            parts.extend(section.guides.is_some().then_some(Part::GuideMass { section: i }));
        }
        for tendon in 0..robot.tendons.len() {
            parts.extend([Part::HoleRadius { tendon }, Part::HoleAngle { tendon }]);
            parts.extend([Part::Stiffness { tendon }, Part::Friction { tendon }, Part::Home { tendon }]);
        }
        parts.extend((0..3).map(|axis| Part::BasePosition { axis }));
        parts.extend((0..3).map(|axis| Part::BaseRotation { axis }));
        parts.push(Part::MountAngle);
        for (input, varied) in experiment.inputs.iter().enumerate() {
            match varied.quantity {
                Varied::HungMass { .. } => parts.push(Part::MassOffset { input }),
                Varied::Displacement { .. } => parts.push(Part::Backlash { input }),
                _ => {}
            }
        }
        for point in 0..experiment.points.len() {
            parts.extend((0..3).map(|axis| Part::MarkerOffset { point, axis }));
        }
        parts
    }

    pub(super) fn get(&self, setup: &Setup) -> Result<f64, Error> {
        let robot = &setup.robot;
        let of_material = |name: &str| robot.sections.iter().map(|s| &s.material).find(|m| m.name == name);
        let missing = || Error::new("the robot has no such part");
        Ok(match self {
            Part::YoungsModulus { material } => of_material(material).ok_or_else(missing)?.youngs_modulus,
            Part::ShearModulus { material } => of_material(material).ok_or_else(missing)?.shear_modulus,
            Part::Density { material } => of_material(material).ok_or_else(missing)?.density,
            Part::Length { section } => robot.sections[*section].length,
            Part::Dimension { section, which } => {
                which.of(&robot.sections[*section].profile.base).ok_or_else(missing)?
            }
            Part::RestCurvature { section, axis } => robot.sections[*section].rest_curvature[*axis],
            Part::HoleRadius { tendon } => robot.tendons[*tendon].path.radius,
            Part::HoleAngle { tendon } => robot.tendons[*tendon].path.angle,
            Part::Stiffness { tendon } => {
                let tendon = &robot.tendons[*tendon];
                tendon.stiffness.ok_or_else(|| {
                    Error::new(format!(
                        "tendon \"{}\" is inextensible: it has no stiffness to calibrate",
                        tendon.name
                    ))
                    .hint("give it a stiffness to start from in the robot file")
                })?
            }
            Part::Friction { tendon } => robot.tendons[*tendon].friction,
            Part::Home { tendon } => robot.tendons[*tendon].home,
            Part::GuideMass { section } => robot.sections[*section].guides.as_ref().ok_or_else(missing)?.mass,
            Part::Backlash { input } => setup.backlash[*input],
            Part::BasePosition { axis } => robot.base.position[*axis],
            Part::BaseRotation { axis } => setup.turn[*axis],
            Part::MountAngle => setup.mount_angle,
            Part::MassOffset { input } => setup.mass_offsets[*input],
            Part::MarkerOffset { point, axis } => setup.marker_offsets[*point][*axis],
        })
    }

    pub(super) fn set(&self, setup: &mut Setup, value: f64) {
        let robot = &mut setup.robot;
        let of_material = |robot: &mut Robot, name: &str, change: &dyn Fn(&mut crate::model::Material)| {
            robot.sections.iter_mut().map(|s| &mut s.material).filter(|m| m.name == name).for_each(change);
        };
        match self {
            Part::YoungsModulus { material } => of_material(robot, material, &|m| {
                m.shear_modulus *= value / m.youngs_modulus;
                m.youngs_modulus = value;
            }),
            Part::ShearModulus { material } => of_material(robot, material, &|m| m.shear_modulus = value),
            Part::Density { material } => of_material(robot, material, &|m| m.density = value),
            Part::Length { section } => set_length(robot, *section, value),
            Part::Dimension { section, which } => {
                let profile = &mut robot.sections[*section].profile;
                let growth = which.of(&profile.base).map_or(1.0, |old| value / old);
                which.scale(&mut profile.base, growth);
                which.scale(&mut profile.tip, growth);
            }
            Part::RestCurvature { section, axis } => robot.sections[*section].rest_curvature[*axis] = value,
            Part::HoleRadius { tendon } => {
                let path = &mut robot.tendons[*tendon].path;
                path.tip_radius =
                    if path.radius > 0.0 { path.tip_radius * value / path.radius } else { value };
                path.radius = value;
            }
            Part::HoleAngle { tendon } => robot.tendons[*tendon].path.angle = value,
            Part::Stiffness { tendon } => robot.tendons[*tendon].stiffness = Some(value),
            Part::Friction { tendon } => robot.tendons[*tendon].friction = value,
            Part::Home { tendon } => robot.tendons[*tendon].home = value,
            Part::GuideMass { section } => {
                robot.sections[*section].guides.iter_mut().for_each(|guides| guides.mass = value);
            }
            Part::Backlash { input } => setup.backlash[*input] = value,
            Part::BasePosition { axis } => robot.base.position[*axis] = value,
            Part::BaseRotation { axis } => setup.turn[*axis] = value,
            Part::MountAngle => setup.mount_angle = value,
            Part::MassOffset { input } => setup.mass_offsets[*input] = value,
            Part::MarkerOffset { point, axis } => setup.marker_offsets[*point][*axis] = value,
        }
    }
}

/// A section of another length: its guides keep their places in proportion, loads at the robot's tip stay there.
fn set_length(robot: &mut Robot, section: usize, value: f64) {
    let old_tip = robot.length();
    let growth = value / robot.sections[section].length;
    robot.sections[section].length = value;
    if let Some(guides) = &mut robot.sections[section].guides {
        guides.positions.iter_mut().for_each(|position| *position *= growth);
    }
    let tip = robot.length();
    let move_along = |at: &mut f64| {
        if (*at - old_tip).abs() <= 1e-9 * old_tip {
            *at = tip;
        }
    };
    for load in &mut robot.loads {
        match &mut load.kind {
            LoadKind::Point { at, .. } | LoadKind::Mass { at, .. } => move_along(at),
            LoadKind::Distributed { to, .. } => move_along(to),
        }
    }
}

impl Dimension {
    const ALL: [Dimension; 4] =
        [Dimension::Diameter, Dimension::InnerDiameter, Dimension::Width, Dimension::Height];

    /// Its key in a profile.
    pub fn key(self) -> &'static str {
        match self {
            Dimension::Diameter => "diameter",
            Dimension::InnerDiameter => "inner_diameter",
            Dimension::Width => "width",
            Dimension::Height => "height",
        }
    }

    fn of(self, shape: &CrossSection) -> Option<f64> {
        let mut copy = *shape;
        self.within(&mut copy).copied()
    }

    fn scale(self, shape: &mut CrossSection, growth: f64) {
        if let Some(dimension) = self.within(shape) {
            *dimension *= growth;
        }
    }

    fn within(self, shape: &mut CrossSection) -> Option<&mut f64> {
        use CrossSection::{Round, Strip, Tube};
        match (self, shape) {
            (Dimension::Diameter, Round { diameter } | Tube { diameter, .. }) => Some(diameter),
            (Dimension::InnerDiameter, Tube { inner_diameter, .. }) => Some(inner_diameter),
            (Dimension::Width, Strip { width, .. }) => Some(width),
            (Dimension::Height, Strip { height, .. }) => Some(height),
            _ => None,
        }
    }
}
