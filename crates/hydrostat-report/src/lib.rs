//! Pictures and printable pages of what Hydrostat computes.
//!
//! [`shape_svg`] draws an equilibrium to scale in two views; [`verification_page`] and [`calibration_page`] turn their results into
//! one self-contained HTML page; [`svg_to_png`] makes pixels of the drawings. Strings out, no files and no clock.

// what is drawn
mod calibration;
mod chart;
mod correlation;
mod describe;
mod interval;
mod loads;
mod overlay;
mod page;
mod residuals;
mod shape;
mod verification;
mod view;

// drawing, with no robot
mod draw;
mod labels;
mod panel;
#[cfg(feature = "png")]
mod png;
mod tendons;
mod text;
mod ticks;

pub use calibration::calibration_page;
pub use page::Provenance;
#[cfg(feature = "png")]
pub use png::{PngError, svg_to_png};
pub use shape::shape_svg;
pub use verification::{verification_page, verification_svg};
