//! Sets of polylines: streamlines, hair, wires, tractograms.
//!
//! - [`LineSet`]: polylines with tangents and lengths.
//! - [`generate`]: seeded sets that move with a time.
//! - [`files`]: text, OBJ, PLY, TCK and TRK.
//! - [`random`]: the seeded numbers behind them.

pub mod files;
pub mod generate;
pub mod random;
mod set;

pub use set::{LineError, LineSet, MOST_VERTICES, Segment};
