//! What the robot is: numbers in SI units, checked by whoever builds them (see `description`).

use nalgebra::{Rotation3, Unit, Vector3};

/// A robot: a clamped backbone of sections in series, base to tip, and what loads it.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    pub name: String,
    /// Gravitational acceleration, world frame.
    pub gravity: Vector3<f64>,
    /// Pose of the backbone at s = 0, world frame; third column of the rotation along the backbone.
    pub base: Pose,
    pub sections: Vec<Section>,
    pub loads: Vec<Load>,
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

/// Guides (disks) on a section: where, from the section's base, and the mass of each.
#[derive(Clone, Debug, PartialEq)]
pub struct Guides {
    pub positions: Vec<f64>,
    pub mass: f64,
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
    Point {
        at: f64,
        force: Vector3<f64>,
        moment: Vector3<f64>,
        frame: Frame,
    },
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
}
