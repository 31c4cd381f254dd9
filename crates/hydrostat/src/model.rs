//! What the robot is: numbers in SI units. [`Robot::check`] says what no solver can work with.

use crate::Error;
use nalgebra::{Rotation3, Unit, Vector3};
use std::f64::consts::PI;

/// A robot: a clamped backbone of sections in series, base to tip, and what loads it.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    pub name: String,
    /// Gravitational acceleration, world frame.
    pub gravity: Vector3<f64>,
    /// Pose of the backbone at s = 0, world frame; third column of the rotation along the backbone.
    pub base: Pose,
    pub sections: Vec<Section>,
    pub tendons: Vec<Tendon>,
    pub loads: Vec<Load>,
    /// One command per tendon, in their order.
    pub actuation: Vec<Command>,
}

/// A position and a rotation (columns d1 d2 d3) in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub position: Vector3<f64>,
    pub rotation: Rotation3<f64>,
}

impl Pose {
    /// This pose turned about the z axis of `axes`, from its x to its y.
    #[must_use]
    pub fn turned(&self, axes: &Pose, angle: f64) -> Pose {
        let z = Unit::new_normalize(axes.rotation * Vector3::z());
        let turn = Rotation3::from_axis_angle(&z, angle);
        Pose {
            position: axes.position + turn * (self.position - axes.position),
            rotation: turn * self.rotation,
        }
    }
}

/// A piece of backbone of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub name: String,
    pub length: f64,
    pub material: Material,
    pub profile: Profile,
    /// u* at rest, body frame, 1/m.
    pub rest_curvature: Vector3<f64>,
    pub guides: Option<Guides>,
}

/// An isotropic linear elastic material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    pub youngs_modulus: f64,
    pub shear_modulus: f64,
    pub density: f64,
    /// Largest admissible strain of a fibre, as a fraction.
    pub strain_limit: Option<f64>,
}

/// The cross-section at the two ends of a section; dimensions vary linearly in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    pub base: CrossSection,
    /// Same variant as `base`.
    pub tip: CrossSection,
    /// Shear coefficient k of K_se = diag(k G A, k G A, E A).
    pub shear_coefficient: f64,
}

/// A cross-section centred on the backbone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CrossSection {
    Round {
        diameter: f64,
    },
    Tube {
        diameter: f64,
        inner_diameter: f64,
    },
    /// `width` along d1, `height` along d2.
    Strip {
        width: f64,
        height: f64,
    },
}

/// Guides (disks) on a section: where, from the section's base, and what each is.
#[derive(Clone, Debug, PartialEq)]
pub struct Guides {
    pub positions: Vec<f64>,
    pub mass: f64,
    /// Centre of mass along (d1, d2) from the backbone.
    pub mass_center: [f64; 2],
    /// Outer radius, where it is known.
    pub radius: Option<f64>,
}

/// A tendon, from the base to the tip of a section.
#[derive(Clone, Debug, PartialEq)]
pub struct Tendon {
    pub name: String,
    /// Index of the section at whose tip it is fixed.
    pub ends: usize,
    pub path: Path,
    pub routing: Routing,
    /// EA, N; None for an inextensible tendon.
    pub stiffness: Option<f64>,
    /// Capstan coefficient; 0 without friction.
    pub friction: f64,
    /// Largest admissible tension, N.
    pub breaking_load: Option<f64>,
    /// Mass per length of its path.
    pub mass_per_length: f64,
    /// Pulled in by so much at displacement 0, m: above 0 pretensioned, below 0 slack.
    pub home: f64,
}

/// Where a tendon passes the cross-sections: a hole at (radius cos angle, radius sin angle) along (d1, d2). Radius and angle
/// vary linearly with s from the base to the tendon's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    pub radius: f64,
    pub tip_radius: f64,
    /// At the base, rad.
    pub angle: f64,
    /// Of the helix, over the tendon's length; right-handed about d3.
    pub turns: f64,
}

/// How a tendon runs from hole to hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Routing {
    /// In a channel: through the hole of every cross-section.
    Channel,
    /// Straight between plates: the base, the guides, and the tips of sections where tendons end.
    Guides,
}

/// What a tendon's motor does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Tension at the base, N, and the last direction of motion, which matters with friction.
    Tension { tension: f64, motion: Motion },
    /// Pulled in at the base by so much, m; above 0 shortens.
    Displacement { displacement: f64, motion: Motion },
}

/// The last direction of a tendon's motion at the base.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    /// Friction lets the tension fall towards the tip.
    #[default]
    Pulled,
    /// Friction lets the tension rise towards the tip.
    Released,
}

/// A load on the backbone. Arc lengths are measured from the robot's base.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    pub name: Option<String>,
    pub kind: LoadKind,
}

/// What acts, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadKind {
    /// A force and a moment at one arc length.
    Point { at: f64, force: Vector3<f64>, moment: Vector3<f64>, frame: Frame },
    /// A hung mass: its weight along gravity.
    Mass { at: f64, mass: f64 },
    /// Force and moment per reference length between two arc lengths.
    Distributed {
        from: f64,
        to: f64,
        force_per_length: Vector3<f64>,
        moment_per_length: Vector3<f64>,
        frame: Frame,
    },
}

/// The frame in which the components of a load are constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// A dead load.
    World,
    /// A load that follows the cross-section.
    Body,
}

impl Robot {
    /// Length of the unstretched backbone.
    pub fn length(&self) -> f64 {
        self.sections.iter().map(|section| section.length).sum()
    }

    /// Arc length at which a tendon is fixed.
    pub fn tendon_end(&self, tendon: &Tendon) -> f64 {
        self.sections.iter().take(tendon.ends + 1).map(|section| section.length).sum()
    }

    /// Arc lengths, ascending, at which tendons that are straight between guides pass a hole: the base, every guide, and every
    /// section's tip where such a tendon ends, which needs a plate to hold it. Empty where no tendon is routed through guides.
    pub fn plates(&self) -> Vec<f64> {
        let guided = || self.tendons.iter().filter(|tendon| tendon.routing == Routing::Guides);
        let last = guided().map(|tendon| self.tendon_end(tendon)).fold(0.0, f64::max);
        if guided().next().is_none() {
            return Vec::new();
        }
        let mut plates = vec![0.0];
        plates.extend(guided().map(|tendon| self.tendon_end(tendon)));
        let mut start = 0.0;
        for section in &self.sections {
            let guides = section.guides.iter().flat_map(|guides| &guides.positions);
            plates.extend(guides.map(|position| start + position));
            start += section.length;
        }
        let same = BEYOND_TIP * self.length();
        plates.retain(|&plate| plate <= last + same);
        plates.sort_by(f64::total_cmp);
        plates.dedup_by(|later, kept| *later - *kept <= same);
        plates
    }
}

impl Robot {
    /// Whether another robot is this one, whatever the commands.
    pub(crate) fn is_same_but_commands(&self, other: &Robot) -> bool {
        let Robot { name, gravity, base, sections, tendons, loads, actuation } = self;
        *tendons == other.tendons
            && *loads == other.loads
            && *sections == other.sections
            && *gravity == other.gravity
            && *base == other.base
            && *name == other.name
            && actuation.len() == other.actuation.len()
    }
}

impl Path {
    /// The hole r and its derivative r' along s at a fraction of a tendon's `length`, body frame.
    pub fn hole(&self, fraction: f64, length: f64) -> (Vector3<f64>, Vector3<f64>) {
        let radius = self.radius + fraction * (self.tip_radius - self.radius);
        let (sin, cos) = (self.angle + 2.0 * PI * self.turns * fraction).sin_cos();
        let (growth, turning) = ((self.tip_radius - self.radius) / length, 2.0 * PI * self.turns / length);
        let hole = Vector3::new(radius * cos, radius * sin, 0.0);
        let along = Vector3::new(growth * cos - turning * hole.y, growth * sin + turning * hole.x, 0.0);
        (hole, along)
    }
}

/// How far beyond the tip rounding may put a load, as a fraction of the length.
const BEYOND_TIP: f64 = 1e-9;

impl Robot {
    /// Refuses what has no mechanical meaning, whoever built it; every solver asks first.
    ///
    /// # Errors
    /// The first impossible value, and where.
    pub fn check(&self) -> Result<(), Error> {
        if self.sections.is_empty() {
            return Err(Error::new("the robot has no section"));
        }
        let pose =
            self.base.position.iter().chain(self.base.rotation.matrix().iter()).chain(self.gravity.iter());
        finite("base pose and gravity", pose)?;
        self.sections.iter().try_for_each(Section::check)?;
        if self.actuation.len() != self.tendons.len() {
            let (commands, tendons) = (self.actuation.len(), self.tendons.len());
            return Err(Error::new(format!("{commands} commands for {tendons} tendons")));
        }
        for (tendon, command) in self.tendons.iter().zip(&self.actuation) {
            tendon
                .check(self.sections.len())
                .and_then(|()| command.check())
                .map_err(|error| error.within(&format!("tendon \"{}\"", tendon.name)))?;
        }
        let length = self.length();
        for (number, load) in self.loads.iter().enumerate() {
            load.kind.check(length).map_err(|error| error.within(&format!("load {}", number + 1)))?;
        }
        Ok(())
    }
}

fn finite<'a>(what: &str, mut numbers: impl Iterator<Item = &'a f64>) -> Result<(), Error> {
    match numbers.find(|number| !number.is_finite()) {
        Some(number) => Err(Error::new(format!("{what}: found {number}, expected finite numbers"))),
        None => Ok(()),
    }
}

impl Tendon {
    fn check(&self, sections: usize) -> Result<(), Error> {
        if self.ends >= sections {
            return Err(Error::new(format!("it ends at section {} of {sections}", self.ends + 1)));
        }
        let path = &self.path;
        finite("the path", [path.radius, path.tip_radius, path.angle, path.turns].iter())?;
        finite("home", [self.home].iter())?;
        if path.radius < 0.0 || path.tip_radius < 0.0 {
            let smaller = path.radius.min(path.tip_radius);
            return Err(Error::new(format!("a hole at a radius of {smaller} m")));
        }
        for (what, value) in [("a stiffness", self.stiffness), ("a breaking load", self.breaking_load)] {
            if value.is_some_and(|value| !(value > 0.0 && value.is_finite())) {
                return Err(Error::new(format!("{what} that is not a finite number above 0")));
            }
        }
        for (what, value) in [("friction", self.friction), ("mass per length", self.mass_per_length)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::new(format!("a {what} of {value}, expected 0 or more")));
            }
        }
        Ok(())
    }
}

impl Command {
    /// The last direction of motion.
    pub fn motion(&self) -> Motion {
        match *self {
            Command::Tension { motion, .. } | Command::Displacement { motion, .. } => motion,
        }
    }

    fn check(&self) -> Result<(), Error> {
        match *self {
            Command::Tension { tension, .. } if !(tension >= 0.0 && tension.is_finite()) => {
                Err(Error::new(format!("a tension of {tension} N")).hint("a tendon only pulls: 0 N or more"))
            }
            Command::Displacement { displacement, .. } => finite("displacement", [displacement].iter()),
            Command::Tension { .. } => Ok(()),
        }
    }
}

impl LoadKind {
    fn check(&self, length: f64) -> Result<(), Error> {
        let on_backbone = |at: f64| {
            if (0.0..=length * (1.0 + BEYOND_TIP)).contains(&at) {
                return Ok(());
            }
            Err(Error::new(format!("s = {at} m is not on the backbone of 0 to {length} m")))
        };
        match self {
            LoadKind::Point { at, force, moment, .. } => {
                on_backbone(*at)?;
                finite("force and moment", force.iter().chain(moment.iter()))
            }
            LoadKind::Mass { at, mass } => {
                on_backbone(*at)?;
                finite("mass", [mass].into_iter())
            }
            LoadKind::Distributed { from, to, force_per_length, moment_per_length, .. } => {
                on_backbone(*from)?;
                on_backbone(*to)?;
                if from >= to {
                    return Err(Error::new(format!("it acts from s = {from} m to {to} m")));
                }
                finite("force and moment per length", force_per_length.iter().chain(moment_per_length.iter()))
            }
        }
    }
}

impl Section {
    fn check(&self) -> Result<(), Error> {
        let positive = |what: &str, value: f64| {
            if value > 0.0 && value.is_finite() {
                return Ok(());
            }
            let name = &self.name;
            Err(Error::new(format!(
                "section \"{name}\": {what} is {value}, expected a finite number above 0"
            )))
        };
        positive("the length", self.length)?;
        positive("Young's modulus", self.material.youngs_modulus)?;
        positive("the shear modulus", self.material.shear_modulus)?;
        let density = self.material.density;
        if !(density >= 0.0 && density.is_finite()) {
            return Err(Error::new(format!("section \"{}\": the density is {density} kg/m^3", self.name)));
        }
        if std::mem::discriminant(&self.profile.base) != std::mem::discriminant(&self.profile.tip) {
            return Err(Error::new(format!(
                "section \"{}\" tapers from one kind of profile to another",
                self.name
            )));
        }
        for fraction in [0.0, 1.0] {
            let (shear, bend) = self.stiffness(fraction);
            shear.iter().chain(bend.iter()).try_for_each(|&stiffness| positive("a stiffness", stiffness))?;
        }
        finite("rest curvature", self.rest_curvature.iter())?;
        let guides = self.guides.iter().flat_map(|guides| &guides.positions);
        for position in guides {
            if !(0.0..=self.length * (1.0 + BEYOND_TIP)).contains(position) {
                return Err(Error::new(format!("section \"{}\": a guide at {position} m", self.name)));
            }
        }
        Ok(())
    }

    /// The cross-section at a fraction of the section's length.
    pub fn cross_section(&self, fraction: f64) -> CrossSection {
        self.profile.base.towards(&self.profile.tip, fraction)
    }

    /// Diagonals of K_se = diag(k G A, k G A, E A) and K_bt = diag(E I1, E I2, G J), theory (7).
    pub fn stiffness(&self, fraction: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (e, g) = (self.material.youngs_modulus, self.material.shear_modulus);
        let cross_section = self.cross_section(fraction);
        let area = cross_section.area();
        let shear = self.profile.shear_coefficient * g * area;
        let [i1, i2] = cross_section.second_moments();
        (
            Vector3::new(shear, shear, e * area),
            Vector3::new(e * i1, e * i2, g * cross_section.torsion_constant()),
        )
    }
}

impl CrossSection {
    /// Area, m^2.
    pub fn area(&self) -> f64 {
        match *self {
            CrossSection::Round { diameter } => PI / 4.0 * diameter.powi(2),
            CrossSection::Tube { diameter, inner_diameter } => {
                PI / 4.0 * (diameter.powi(2) - inner_diameter.powi(2))
            }
            CrossSection::Strip { width, height } => width * height,
        }
    }

    /// Second moments of area about d1 and about d2, m^4.
    pub fn second_moments(&self) -> [f64; 2] {
        match *self {
            CrossSection::Round { diameter } => [PI / 64.0 * diameter.powi(4); 2],
            CrossSection::Tube { diameter, inner_diameter } => {
                [PI / 64.0 * (diameter.powi(4) - inner_diameter.powi(4)); 2]
            }
            CrossSection::Strip { width, height } => {
                [width * height.powi(3) / 12.0, height * width.powi(3) / 12.0]
            }
        }
    }

    /// Torsion constant J, m^4, theory (8): polar moment of a round section, Saint-Venant's series for a strip.
    ///
    /// ```text
    /// J = a b^3 (1/3 - 64 b / (pi^5 a) sum_{n = 1, 3, ..} tanh(n pi a / 2b) / n^5),  a >= b
    /// ```
    /// (Timoshenko & Goodier, Theory of Elasticity, section 109.)
    pub fn torsion_constant(&self) -> f64 {
        match *self {
            CrossSection::Round { .. } | CrossSection::Tube { .. } => self.second_moments().iter().sum(),
            CrossSection::Strip { width, height } => {
                let (a, b) = (width.max(height), width.min(height));
                // the tail after n = 2 TERMS - 1 is below 1e-9 of J
                const TERMS: usize = 60;
                let series: f64 = (0..TERMS)
                    .map(|k| (2 * k + 1) as f64)
                    .map(|n| (n * PI * a / (2.0 * b)).tanh() / n.powi(5))
                    .sum();
                a * b.powi(3) * (1.0 / 3.0 - 64.0 * b / (PI.powi(5) * a) * series)
            }
        }
    }

    /// Diameter, or the larger side of a strip.
    pub fn thickness(&self) -> f64 {
        match *self {
            CrossSection::Round { diameter } | CrossSection::Tube { diameter, .. } => diameter,
            CrossSection::Strip { width, height } => width.max(height),
        }
    }

    /// Largest fibre strain under the bending strains (u - u*)_1, (u - u*)_2.
    pub fn bending_strain(&self, bending: [f64; 2]) -> f64 {
        match *self {
            CrossSection::Round { diameter } | CrossSection::Tube { diameter, .. } => {
                diameter / 2.0 * bending[0].hypot(bending[1])
            }
            CrossSection::Strip { width, height } => {
                height / 2.0 * bending[0].abs() + width / 2.0 * bending[1].abs()
            }
        }
    }

    /// Linear interpolation of the dimensions; `self` where the two are of different kinds.
    fn towards(&self, tip: &CrossSection, t: f64) -> CrossSection {
        let mix = |a: f64, b: f64| a + t * (b - a);
        match (*self, *tip) {
            (CrossSection::Round { diameter: a }, CrossSection::Round { diameter: b }) => {
                CrossSection::Round { diameter: mix(a, b) }
            }
            (
                CrossSection::Tube { diameter: a, inner_diameter: c },
                CrossSection::Tube { diameter: b, inner_diameter: d },
            ) => CrossSection::Tube { diameter: mix(a, b), inner_diameter: mix(c, d) },
            (CrossSection::Strip { width: a, height: c }, CrossSection::Strip { width: b, height: d }) => {
                CrossSection::Strip { width: mix(a, b), height: mix(c, d) }
            }
            _ => *self,
        }
    }
}
