//! The matrices of the grid (thesis, section 3.2), each a sparse array of
//! bricks of 8x8x8 cells:
//!
//! - [`OpacityMatrix`]: O, cells wholly inside solid geometry;
//! - [`OcclusionMatrix`]: H, cells hidden from the viewer;
//! - [`IdMatrix`]: I, the objects that touch each cell;
//! - [`TbvMatrix`]: Txy, Txz and Tyz, the projections of hollow temporal
//!   bounding volumes.

mod bits;
mod counts;
mod ids;
mod slots;
mod tbv;

pub use bits::{BitMatrix, OcclusionMatrix, OpacityMatrix};
pub use ids::IdMatrix;
pub use tbv::TbvMatrix;

pub(crate) use bits::{
    ALL, Mask, NONE, SideAxes, beside, block_mask, both, cells_of, either, span8, without,
};
pub(crate) use counts::Counts;
pub(crate) use tbv::CellBox;
