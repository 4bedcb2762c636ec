//! Pictures: the chart of a walk, the grid from above, what a frame shows and hides,
//! speed against accuracy, lines of any quantities, and bars of shares.

mod bars;
mod chart;
mod frame;
mod lines;
mod top_view;
mod tradeoff;

use std::path::Path;

use plotters::style::{FontStyle, RGBColor, register_font};

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

/// Colours of lines and bars, in their order.
const COLORS: [RGBColor; 10] = [
    RGBColor(31, 90, 180),
    RGBColor(20, 140, 60),
    RGBColor(200, 90, 20),
    RGBColor(150, 40, 150),
    RGBColor(110, 110, 110),
    RGBColor(190, 30, 60),
    RGBColor(0, 140, 150),
    RGBColor(0, 0, 0),
    RGBColor(170, 140, 0),
    RGBColor(240, 130, 180),
];

/// Makes the text of pictures work without fonts on the machine.
fn with_font() {
    for style in [FontStyle::Normal, FontStyle::Bold] {
        // Fails only for broken font data.
        let _ = register_font(FONT, style, epaint_default_fonts::UBUNTU_LIGHT);
    }
}
