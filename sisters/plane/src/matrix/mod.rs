//! The matrices of the grid, in packed rows: opaque cells O, the volumes T (thesis, section 3.1).

mod cross;
mod opacity;

pub(crate) use cross::CrossBits;
pub(crate) use opacity::Opacity;
