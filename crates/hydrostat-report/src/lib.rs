//! Pictures and printable pages of what Hydrostat computes.
//!
//! [`shape_svg`] draws an equilibrium to scale in two views; [`verification_page`] turns a verification into one
//! self-contained HTML page; [`budget_svg`] shows a budget of tolerances as bars; [`svg_to_png`] makes pixels of the drawings. Strings out, no files and no clock.

// what is drawn
mod budget;
mod chart;

mod describe;
mod kit;
mod loads;
mod overlay;
mod page;

mod shape;
mod view;

// drawing, with no robot
mod draw;
mod labels;
#[cfg(feature = "png")]
mod png;
mod tendons;
mod text;
mod ticks;

pub use budget::budget_svg;
pub use kit::{KitFile, kit_files};
pub use page::{Provenance, verification_page, verification_svg};
#[cfg(feature = "png")]
pub use png::{PngError, svg_to_png};
pub use shape::shape_svg;
