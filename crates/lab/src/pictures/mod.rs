//! Pictures: the chart of a walk, the objects that a frame shows and hides, what frames cost.
//! Colours and marks are those of [`casca_tools::pictures`].
//!
//! Titles say the finding, computed from the data.

mod chart;
mod frame;
mod worth;

use casca_tools::pictures::{Axis, Line, PictureError, lines, palette, raster, svg};

pub use chart::{FrameCounts, chart};
pub use frame::{FramePicture, frame};
pub use worth::{WorthLine, worth};
