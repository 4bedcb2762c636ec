//! Walks over the cells of a grid in chessboard shells, inside the frustum of a view.

mod frustum;
mod shells;

pub(crate) use frustum::{CellFrustum, SideFrustum, Start};
pub(crate) use shells::Shells;
