//! The cells that solids make opaque.

use glam::IVec3;

use crate::grid::Grid;
use crate::grid::mask::{Mask, without};
use crate::matrix::bits::OpacityMatrix;
use crate::matrix::counts::Counts;
use crate::object::Occluder;
use crate::shape::pieces::{Piece, opaque};

/// Opaque cells, and how many solids make each of them opaque.
#[derive(Clone, Default)]
pub(super) struct OpaqueCells {
    bits: OpacityMatrix,
    counts: Counts,
}

impl OpaqueCells {
    #[inline]
    pub(super) fn bits(&self) -> &OpacityMatrix {
        &self.bits
    }

    /// Adds the cells that lie inside a solid.
    pub(super) fn add(&mut self, solid: &Occluder, grid: &Grid) {
        let Self { bits, counts } = self;
        opaque(solid, grid, &mut |piece| match piece {
            Piece::Page(page) if counts.add_page(bits, page) => {}
            piece => piece.bricks(|brick, mask| counts.add(bits, brick, mask)),
        });
    }

    /// Takes away the cells of a solid that was added, except those inside another that was.
    pub(super) fn remove(&mut self, solid: &Occluder, grid: &Grid) {
        opaque(solid, grid, &mut |piece| match piece {
            Piece::Page(page) if self.take_page(page) => {}
            piece => piece.bricks(|brick, mask| {
                self.take(brick, mask);
            }),
        });
    }

    /// A solid made the cells `old` of a brick opaque, and now makes `new`.
    pub(super) fn exchange(&mut self, brick: IVec3, old: &Mask, new: &Mask) {
        self.counts.add(&mut self.bits, brick, &without(new, old));
        self.take(brick, &without(old, new));
    }

    /// Makes a cell opaque that no single solid fills.
    pub(super) fn set(&mut self, cell: IVec3) {
        self.bits.set(cell);
    }

    /// One solid fewer fills these cells of a brick: clears and gives those that no other fills.
    pub(super) fn take(&mut self, brick: IVec3, mask: &Mask) -> Mask {
        self.counts.take(&mut self.bits, brick, mask)
    }

    /// Clears a page that a single solid fills; false, without a change, if there are others.
    pub(super) fn take_page(&mut self, page: IVec3) -> bool {
        self.counts.take_page(&mut self.bits, page)
    }

    pub(super) fn bytes(&self) -> usize {
        self.bits.bytes() + self.counts.bytes()
    }
}
