//! Statics of continuum robots: special Cosserat rods under loads. The equations are in `docs/theory.md`.
//!
//! [`description`] turns a robot file into a [`model::Robot`]; [`statics::solve`] turns that into a
//! [`solution::Equilibrium`]; the other modules use it. The core does no I/O: text in, numbers out.
//! SI units throughout; arc length `s` runs from the base (0) to the tip along the unstretched backbone.
//!
//! ```
//! use hydrostat::{description, statics};
//!
//! let rod = description::parse_robot(
//!     r#"
//!     name = "wire"
//!     [base]
//!     tangent = [1, 0, 0]
//!     [[section]]
//!     length = "300 mm"
//!     material = "spring_steel"
//!     profile = { diameter = "1 mm" }
//!     [[load]]
//!     at = "tip"
//!     mass = "10 g"
//!     "#,
//!     "wire.toml",
//! )?;
//! let shape = statics::solve(&rod.value, &statics::Settings::default())?;
//! assert!(shape.tip.position.z < -0.05 && shape.report.stable == Some(true));
//! # Ok::<(), hydrostat::Error>(())
//! ```

// what the robot is
pub mod description;
pub mod error;
pub mod model;

// how its shape is found
pub mod solution;
pub mod statics;

// what the shape is used for
pub mod batch;
pub mod budget;
pub mod calibrate;
pub mod fabricate;
pub mod plan;
pub mod validate;
pub mod verify;

// mathematics with no robot
pub mod geometry;
pub mod numeric;
pub mod planar;

pub use error::Error;
pub use model::Robot;
pub use solution::Equilibrium;
