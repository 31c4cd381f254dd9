//! Pictures and printable pages of what Hydrostat computes.
//!
//! [`shape_svg`] draws an equilibrium to scale in two views; [`verification_page`] and [`calibration_page`] turn their results into
//! one self-contained HTML page; [`budget_svg`] shows a budget of tolerances as bars; [`kit_files`] writes what a workshop needs;
//! [`svg_to_png`] makes pixels of the drawings. Strings out, no files and no clock.

// what is drawn
mod budget;
mod calibration;
mod chart;
mod correlation;
mod describe;
mod interval;
mod kit;
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

pub use budget::budget_svg;
pub use calibration::calibration_page;
pub use kit::{KitFile, kit_files};
pub use page::Provenance;
#[cfg(feature = "png")]
pub use png::{PngError, svg_to_png};
pub use shape::shape_svg;
pub use verification::{verification_page, verification_svg};
