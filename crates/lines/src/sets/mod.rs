//! Sets of polylines: streamlines, hair, wires, tractograms.
//!
//! - [`LineSet`]: polylines with tangents and lengths.
//! - [`generate`]: seeded sets that move with a time.
//! - [`files`]: text, OBJ, PLY, TCK and TRK.
//! - [`rooms`]: a house with a set in each of its rooms.
//! - [`random`]: the seeded numbers behind them.

pub mod files;
pub mod generate;
pub mod random;
pub mod rooms;
mod set;

pub use set::{LineError, LineSet, MOST_VERTICES, Segment};
