//! The stationary energy in strain coordinates: the default method.
//!
//! Each panel of the backbone has a polynomial for its rotation vector, and so for its bending and twist, and values of
//! shear and stretch at its Gauss nodes (`mesh`, `node`); one block elimination along the chain gives Newton's step and the
//! inertia of the Hessian (`factor`, `chords`, `following`, `sweep`, `newton`); `search`, `at_once`, `warm`, `refine`, `bow` and `trust` lead to
//! the full load, for robots with guides by way of one whose guides are spread (`averaged`, `gaps`); `judge`, `convex`, `result` and
//! `derivatives` say what was found.

mod at_once;
mod averaged;
mod bow;
mod chords;
mod convex;
mod derivatives;
mod factor;
mod following;
mod friction;
mod gaps;
mod judge;
mod mesh;
mod newton;
mod node;
mod refine;
mod result;
mod search;
mod sweep;
mod tendons;
#[cfg(test)]
mod tests;
mod trust;
mod warm;

pub(super) use derivatives::derivatives;
pub(super) use search::{Found, Start, find};

use crate::statics::chain::Chain;
use mesh::{Layout, Mesh, Tables};
use newton::Linear;
use search::Seen;
use sweep::Sweep;
use tendons::Drive;

/// Memory that solves share, and the last solution.
#[derive(Clone, Debug, Default)]
pub(super) struct Energy {
    tables: Tables,
    layouts: Vec<Layout>,
    coarse: Mesh,
    fine: Mesh,
    /// The coarse mesh's shape at the last load step and its tensions, to go back to.
    reached: Mesh,
    reached_drive: Drive,
    memory: Memory,
    seen: Seen,
    /// Of the same robot with the gaps between its guides averaged.
    averaged: Option<Box<Averaged>>,
}

/// The robot with the gaps between its guides averaged.
#[derive(Clone, Debug, Default)]
struct Averaged {
    chain: Chain,
    energy: Energy,
    gaps: gaps::Gaps,
    /// What it leaves out; None where that is not known.
    measured: Option<averaged::Measured>,
    /// Whether the last solution was found by way of it, and whether that is read off it, the gaps being where they were placed last.
    led: bool,
    holds_solution: bool,
}

/// Scratch of one linearisation, and the tendons' tensions.
#[derive(Clone, Debug, Default)]
struct Memory {
    sweep: Sweep,
    linear: Linear,
    drive: Drive,
}
