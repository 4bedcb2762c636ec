//! Pictures of the experiments: the chart of a walk, the grid from above, the objects that a frame
//! shows and hides, speed against accuracy. Lines, bars, sheets, colours and marks are those of
//! [`casca_tools::pictures`].
//!
//! Titles say the finding, computed from the data.

mod chart;
mod frame;
mod top_view;
mod tradeoff;

pub use casca_tools::pictures::{Axis, Bar, Line, PictureError, Tile, bars, lines, palette, sheet};
use casca_tools::pictures::{raster, svg};

pub use chart::{FrameCounts, chart};
pub use frame::{FramePicture, buffers, frame};
pub use top_view::{TopView, top_view};
pub use tradeoff::{TradeoffPoint, tradeoff};
