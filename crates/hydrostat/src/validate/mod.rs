//! Published and exact solutions that the solver must reproduce.
//!
//! Every reference is computed here by another method (closed form, elliptic integrals, series, quadrature) or is a
//! published number; the solver never makes its own reference. [`robustness`] sweeps random rods and checks each answer.

mod beams;
mod bench;
mod buckling;
mod elastica;
mod helix;
mod reference;
pub mod robustness;
mod small_load;
mod sorosim;
mod tendons;

use crate::model::{CrossSection, Frame, Load, LoadKind, Material, Pose, Profile, Section};
use crate::statics::{self, Settings};
use crate::{Equilibrium, Robot};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::fmt::Write;

/// One number of the validation table.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Heading of the table it belongs to, such as "Cantilever with a dead tip force".
    pub group: &'static str,
    /// What is compared, such as "F L^2/EI = 2, tip deflection / L".
    pub name: String,
    pub reference: f64,
    /// The solver's message where it found no answer.
    pub ours: Result<f64, String>,
    /// Largest admissible |ours - reference|.
    pub tolerance: f64,
    /// Where the reference comes from.
    pub source: &'static str,
    /// Why the tolerance is what it is.
    pub reason: &'static str,
}

impl Case {
    /// Whether the two agree; false for a refusal and for anything that is not a number.
    pub fn ok(&self) -> bool {
        (self.difference().abs()) <= self.tolerance
    }

    /// ours - reference; NaN where there is no answer.
    pub fn difference(&self) -> f64 {
        self.ours.as_ref().map_or(f64::NAN, |ours| ours - self.reference)
    }
}

/// Computes every case; those against SoRoSim only where its file's text is given.
pub fn run(sorosim_csv: Option<&str>) -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend(small_load::cases());
    cases.extend(elastica::cases());
    cases.extend(helix::cases());
    cases.extend(beams::cases());
    cases.extend(buckling::cases());
    cases.extend(tendons::cases());
    cases.extend(bench::cases());
    cases.extend(sorosim_csv.map(sorosim::cases).unwrap_or_default());
    cases
}

/// The cases as Markdown: one table a group, its source and the reasons of its tolerances below.
pub fn markdown(cases: &[Case]) -> String {
    let mut text = String::new();
    for group in cases.chunk_by(|a, b| a.group == b.group) {
        let _ = writeln!(text, "## {}\n", group[0].group);
        text += "| case | reference | ours | difference | tolerance | |\n|---|---:|---:|---:|---:|---|\n";
        for case in group {
            let (ours, difference) = match &case.ours {
                Ok(ours) => (significant(*ours, case.tolerance), format!("{:.1e}", case.difference())),
                Err(message) => (message.replace('\n', " ").replace('|', "/"), "-".to_string()),
            };
            let reference = significant(case.reference, case.tolerance);
            let verdict = if case.ok() { "ok" } else { "**FAILED**" };
            let (name, tolerance) = (&case.name, case.tolerance);
            let _ = writeln!(
                text,
                "| {name} | {reference} | {ours} | {difference} | {tolerance:.1e} | {verdict} |"
            );
        }
        text += "\n";
        for note in unique(group.iter().map(|case| case.source)) {
            let _ = writeln!(text, "- Reference: {note}.");
        }
        for note in unique(group.iter().map(|case| case.reason)) {
            let _ = writeln!(text, "- Tolerance: {note}.");
        }
        text += "\n";
    }
    text
}

/// A number with as many decimals as the tolerance makes meaningful: one digit finer than it.
fn significant(value: f64, tolerance: f64) -> String {
    let decimals = (1.0 - tolerance.max(1e-12).log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    // the sign of a zero is a rounding error
    match text.strip_prefix('-') {
        Some(zero) if zero.parse() == Ok(0.0) => zero.to_owned(),
        _ => text,
    }
}

fn unique<'a>(notes: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for note in notes {
        if !found.contains(&note) {
            found.push(note);
        }
    }
    found
}

/// What the cases of one group share.
#[derive(Clone, Copy)]
struct Group {
    title: &'static str,
    source: &'static str,
    reason: &'static str,
}

impl Group {
    fn case(
        &self,
        name: impl Into<String>,
        reference: f64,
        ours: Result<f64, String>,
        tolerance: f64,
    ) -> Case {
        Case {
            group: self.title,
            name: name.into(),
            reference,
            ours,
            tolerance,
            source: self.source,
            reason: self.reason,
        }
    }
}

/// Tight enough that the solver's own error is a tenth of the tightest tolerance here, 1e-9 of the length.
const TOLERANCE: f64 = 1e-10;

fn solve(robot: &Robot) -> Result<Equilibrium, String> {
    let settings = Settings { tolerance: TOLERANCE, stations: 3, ..Settings::default() };
    statics::solve(robot, &settings).map_err(|error| error.to_string())
}

/// A number of a solution, or the message of why there is none.
fn read(solved: &Result<Equilibrium, String>, number: impl Fn(&Equilibrium) -> f64) -> Result<f64, String> {
    solved.as_ref().map(number).map_err(String::clone)
}

/// A weightless straight rod of one section, clamped at the origin: d3 along x, d1 along y, d2 along z.
fn rod(length: f64, material: Material, profile: Profile) -> Robot {
    let rotation = Matrix3::from_columns(&[Vector3::y(), Vector3::z(), Vector3::x()]);
    Robot {
        tendons: Vec::new(),
        actuation: Vec::new(),
        name: "validation".into(),
        gravity: Vector3::zeros(),
        base: Pose { position: Vector3::zeros(), rotation: Rotation3::from_matrix_unchecked(rotation) },
        sections: vec![Section {
            name: "rod".into(),
            length,
            material,
            profile,
            rest_curvature: Vector3::zeros(),
            guides: None,
        }],
        loads: Vec::new(),
    }
}

/// A weightless material.
fn material(youngs_modulus: f64, poisson_ratio: f64) -> Material {
    Material {
        name: "validation".into(),
        youngs_modulus,
        shear_modulus: youngs_modulus / (2.0 * (1.0 + poisson_ratio)),
        density: 0.0,
        strain_limit: None,
    }
}

fn prismatic(section: CrossSection) -> Profile {
    Profile { base: section, tip: section, shear_coefficient: 1.0 }
}

fn dead_load(at: f64, force: Vector3<f64>, moment: Vector3<f64>) -> Load {
    Load { name: None, kind: LoadKind::Point { at, force, moment, frame: Frame::World } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_within_its_tolerance() {
        let failed: Vec<Case> = run(None).into_iter().filter(|case| !case.ok()).collect();
        assert!(failed.is_empty(), "{}", markdown(&failed));
    }

    /// A refusal is a failed row that says why, in one line.
    #[test]
    fn a_refusal_is_a_failed_row() {
        let group = Group { title: "Refusals", source: "none", reason: "none" };
        let text = markdown(&[group.case("rod", 0.5, Err("first | second\nhint: third".into()), 1e-3)]);
        let row = "| rod | 0.5000 | first / second hint: third | - | 1.0e-3 | **FAILED** |";
        assert!(text.contains(row), "{text}");
    }
}
