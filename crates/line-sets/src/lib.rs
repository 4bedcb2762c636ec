//! Sets of polylines: streamlines, hair, wires, tractograms. `casca-lines` computes how lines occlude each other.
//!
//! - [`LineSet`]: polylines with tangents and lengths.
//! - [`generate`]: seeded sets that move with a time.
//! - [`files`]: text, OBJ, PLY, TCK and TRK.
//! - [`random`]: the seeded numbers behind them.

pub mod files;
pub mod generate;
pub mod random;
mod set;
#[cfg(test)]
mod testing;

/// The version of glam whose types these functions take and give.
pub use glam;

pub use set::{LineError, LineSet, MOST_VERTICES, Segment};
