//! Drawings: the kind of file by its ending, and its bytes.

use hydrostat::Error;
use std::path::Path;

/// Pixels per unit of the drawing.
#[cfg(feature = "png")]
const PNG_SCALE: f32 = 2.0;

/// A kind of drawing, known by the file's ending.
#[derive(Clone, Copy)]
pub(crate) enum Format {
    Svg,
    #[cfg(feature = "png")]
    Png,
}

impl Format {
    pub(crate) fn of(path: &Path) -> Result<Format, Error> {
        match path.extension().map(|extension| extension.to_ascii_lowercase()) {
            Some(extension) if extension == "svg" => Ok(Format::Svg),
            #[cfg(feature = "png")]
            Some(extension) if extension == "png" => Ok(Format::Png),
            #[cfg(not(feature = "png"))]
            Some(extension) if extension == "png" => {
                Err(Error::new("this build of hydrostat draws SVG only")
                    .hint("name a file .svg, or build with `--features png`"))
            }
            _ => {
                Err(Error::new(format!("cannot draw into {}: expected a file .svg or .png", path.display())))
            }
        }
    }

    pub(crate) fn encode(self, svg: String) -> Result<Vec<u8>, Error> {
        match self {
            Format::Svg => Ok(svg.into_bytes()),
            #[cfg(feature = "png")]
            Format::Png => {
                hydrostat_report::svg_to_png(&svg, PNG_SCALE).map_err(|error| Error::new(error.to_string()))
            }
        }
    }
}
