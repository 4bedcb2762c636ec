//! Pictures: the chart of a walk, the grid from above, the objects that a frame shows and hides,
//! speed against accuracy, lines of any quantities, and bars of shares.
//!
//! Charts are SVG: the reader's program sets their text. Pictures made of pixels are PNG. Titles say the
//! finding, computed from the data; all colours and marks are those of [`palette`].

mod bars;
mod chart;
mod cloud;
mod frame;
mod lines;
pub mod palette;
mod raster;
mod sheet;
mod svg;
mod top_view;
mod tradeoff;

use std::path::Path;

pub use bars::{Bar, bars};
pub use chart::{FrameCounts, chart};
pub use cloud::{CloudPanel, CloudView, Fate, cloud};
pub use frame::{FramePicture, buffers, frame};
pub use lines::{Axis, Line, lines};
pub use sheet::{Tile, sheet};
pub use top_view::{TopView, top_view};
pub use tradeoff::{TradeoffPoint, tradeoff};

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw {path}: {why}")]
pub struct PictureError {
    path: String,
    why: String,
}

fn error(path: &Path) -> impl Fn(String) -> PictureError + '_ {
    move |why| PictureError { path: path.display().to_string(), why }
}
