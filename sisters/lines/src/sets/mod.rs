//! Sets of polylines: streamlines, hair, wires, tractograms.
//!
//! - [`LineSet`]: polylines with tangents and lengths.
//! - [`attributes`]: numbers of vertices and lines, and colours.
//! - [`colour`]: colours by direction or numbers.
//! - [`region`]: boxes and spheres that lines are chosen by.
//! - [`generate`]: seeded sets that move with a time.
//! - [`files`]: text, OBJ, PLY, TCK, TRK, VTK.
//! - [`rooms`]: a house with a set in each of its rooms.
//! - [`random`]: the seeded numbers behind them.

pub mod attributes;
pub mod colour;
pub mod files;
pub mod generate;
pub mod random;
pub mod region;
pub mod rooms;
mod set;

pub(crate) use set::arc_lengths_of;
pub use set::{LineError, LineSet, MOST_VERTICES, Segment};
