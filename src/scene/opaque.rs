//! The cells that solids make opaque.

use crate::grid::Grid;
use crate::matrix::counts::OpaqueCells;
use crate::object::Occluder;
use crate::shape::pieces::{Piece, opaque};

/// Adds the cells that lie inside a solid.
pub(super) fn add_cells(cells: &mut OpaqueCells, solid: &Occluder, grid: &Grid) {
    opaque(solid.kind(), grid, &mut |piece| match piece {
        Piece::Page(page) if cells.add_page(page) => {}
        piece => piece.bricks(|brick, mask| cells.add(brick, mask)),
    });
}

/// Takes away the cells of a solid that was added, except those inside another that was.
pub(super) fn take_cells(cells: &mut OpaqueCells, solid: &Occluder, grid: &Grid) {
    opaque(solid.kind(), grid, &mut |piece| match piece {
        Piece::Page(page) if cells.take_page(page) => {}
        piece => piece.bricks(|brick, mask| {
            cells.take(brick, mask);
        }),
    });
}
