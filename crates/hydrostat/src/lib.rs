//! Statics of continuum robots: special Cosserat rods under loads. The equations are in `docs/theory.md`.
//!
//! [`description`] turns a robot file into a [`model::Robot`]; [`statics::solve`] turns that into a
//! [`solution::Equilibrium`]; the other modules use it. The core does no I/O: text in, numbers out.
//! SI units throughout; arc length `s` runs from the base (0) to the tip along the unstretched backbone.

// what the robot is
pub mod description;
pub mod error;
pub mod model;

// how its shape is found
pub mod solution;
pub mod statics;

// what the shape is used for
pub mod validate;
pub mod verify;

// mathematics with no robot
pub mod geometry;
pub mod numeric;

pub use error::Error;
pub use model::Robot;
pub use solution::Equilibrium;
