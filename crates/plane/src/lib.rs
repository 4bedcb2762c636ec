//! Visibility in the plane: floor plans, tile maps, and what can be seen in them.
//!
//! The planar twin of [casca](https://docs.rs/casca): the same words, and the same guarantee. What can be seen is never left out.

mod bits;
mod cell;
mod matrix;
mod numeric;

pub use bits::BitGrid;
