//! The matrices of the grid (thesis, section 3.2), each a sparse array of
//! bricks of 8x8x8 cells:
//!
//! - [`bits::OpacityMatrix`]: O, cells wholly inside solid geometry;
//! - [`bits::OcclusionMatrix`]: H, cells hidden from the viewer;
//! - [`ids::IdMatrix`]: I, the objects that touch each cell;
//! - [`tbv::TbvMatrix`]: Txy, Txz and Tyz, the projections of hollow temporal
//!   bounding volumes.

pub(crate) mod bits;
pub(crate) mod counts;
pub(crate) mod ids;
pub(crate) mod slots;
pub(crate) mod tbv;
