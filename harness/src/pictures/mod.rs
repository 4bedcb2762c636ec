//! Pictures: the chart of a walk, the grid from above, what a frame shows and hides,
//! speed against accuracy, lines of any quantities, and bars of shares.

mod bars;
mod chart;
mod frame;
mod lines;
mod top_view;
mod tradeoff;

use std::path::Path;

use plotters::style::{FontStyle, register_font};

pub use bars::{Bar, bars};
pub use chart::{FrameCounts, chart};
pub use frame::{FramePicture, buffers, frame};
pub use lines::{Axis, Line, lines};
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

const FONT: &str = "sans-serif";

/// Makes the text of pictures work without fonts on the machine.
fn with_font() {
    for style in [FontStyle::Normal, FontStyle::Bold] {
        // Fails only for broken font data.
        let _ = register_font(FONT, style, epaint_default_fonts::UBUNTU_LIGHT);
    }
}
