//! Contacts: opaque cells of one static solid beside opaque cells of another.
//!
//! Where solids abut along a plane of the grid, no cell is filled by both together, and no box of
//! cells would bridge their seam. The cells on both sides of such a plane are marked, so that boxes
//! of opaque cells are drawn across it.

use std::collections::BTreeMap;

use glam::IVec3;

use crate::grid::bricks::Pages;
use crate::grid::cell_box::CellBox;
use crate::matrix::bits::{Mask, NONE, beside, block_mask, both, cells_of, either, without};
use crate::object::Occluder;
use crate::scene::solids::mask_of;
use crate::scene::{OpacityPart, Scene};
use crate::shape::Shape;
use crate::shape::pieces::{Piece, opaque};

/// The cells of a solid by brick, for bricks that have opaque cells of others in them or beside
/// them.
type NearCells = BTreeMap<[i32; 3], Mask>;

impl Scene {
    /// Marks the cells that a solid will make opaque beside opaque cells of others.
    pub(super) fn mark_contacts(&mut self, part: OpacityPart, occluder: &Occluder) {
        let mut contacts = Vec::new();
        let near = self.cells_near_others(part, occluder);
        for (&place, mask) in &near {
            let brick = IVec3::from_array(place);
            let mut contact = NONE;
            for (next, axis, up) in self.bricks_beside(brick) {
                let bits = self.opacity.part(part).fixed();
                let others = beside(bits.brick(brick), bits.brick(next), axis, up);
                // A cell of both is no seam. Bricks that are not here have no cells of others.
                let own = beside(mask, near.get(&next.to_array()).unwrap_or(&NONE), axis, up);
                contact = either(&contact, &both(mask, &without(&others, &own)));
            }
            if contact != NONE {
                contacts.push((brick, contact));
            }
        }
        let opacity = self.opacity.part_mut(part);
        contacts.iter().for_each(|(brick, contact)| opacity.fused.add_contacts(*brick, contact));
    }

    /// The cells of a solid that is not in the matrices yet, where others are near.
    fn cells_near_others(&self, part: OpacityPart, occluder: &Occluder) -> NearCells {
        let mut near = NearCells::new();
        let bits = self.opacity.part(part).fixed();
        let around = occluder.block();
        let (lo, hi) = self.grid.cover(around.min, around.max);
        let Some((lo, hi)) = self.grid.clip(lo - 1, hi + 1) else { return near };
        let pages = bits.pages();
        let empty = |lo: IVec3, hi: IVec3| {
            CellBox { lo: lo >> 6i32, hi: hi >> 6i32 }.cells().all(|page| pages.page_is_empty(page))
        };
        if !occluder.is_solid() || empty(lo, hi) {
            return near;
        }
        let last = self.grid.dims() - 1;
        opaque(occluder, &self.grid, &mut |piece| {
            if let Piece::Page(page) = piece
                && empty(((page << 6i32) - 1).max(IVec3::ZERO), ((page << 6i32) + 64).min(last))
            {
                return;
            }
            piece.bricks(|brick, mask| {
                let has_opaque = |b: IVec3| *bits.brick(b) != NONE;
                if has_opaque(brick) || self.bricks_beside(brick).any(|(next, ..)| has_opaque(next)) {
                    near.insert(brick.to_array(), *mask);
                }
            });
        });
        near
    }

    /// The bricks of the grid that share a face with a brick, with the axis across it, and whether
    /// they lie above.
    fn bricks_beside(&self, brick: IVec3) -> impl Iterator<Item = (IVec3, usize, bool)> + use<> {
        let last = (self.grid.dims() - 1) >> 3i32;
        IVec3::AXES.into_iter().enumerate().flat_map(move |(axis, step)| {
            let inside = move |b: &IVec3| b.cmpge(IVec3::ZERO).all() && b.cmple(last).all();
            [(brick - step, axis, false), (brick + step, axis, true)]
                .into_iter()
                .filter(move |n| inside(&n.0))
        })
    }

    /// Forgets the contacts in a block of cells around a solid that is gone, where no other solids
    /// abut.
    pub(super) fn forget_contacts(&mut self, part: OpacityPart, lo: IVec3, hi: IVec3) {
        let (lo, hi) = ((lo - 1).max(IVec3::ZERO), (hi + 1).min(self.grid.dims() - 1));
        let mut idle: Vec<(IVec3, Mask)> = Vec::new();
        self.opacity.part(part).fused().for_contacts(lo, hi, &mut |brick, mask| {
            let mask = both(mask, &block_mask(brick, lo, hi));
            let gone = mask_of(cells_of(brick, &mask).filter(|&c| !self.is_contact(part, c)));
            if gone != NONE {
                idle.push((brick, gone));
            }
        });
        let opacity = self.opacity.part_mut(part);
        idle.iter().for_each(|(brick, cells)| opacity.fused.forget_contacts(*brick, cells));
    }

    /// Whether no single solid fills an opaque cell and all opaque cells beside it.
    fn is_contact(&self, part: OpacityPart, cell: IVec3) -> bool {
        let opaque = self.opacity.part(part).fixed();
        let mut steps = IVec3::AXES.into_iter().flat_map(|step| [cell + step, cell - step]);
        opaque.get(cell)
            && steps.any(|next| {
                let (min, max) = self.grid.range_bounds(cell.min(next), cell.max(next));
                opaque.get(next) && !self.static_solids(cell, part).any(|solid| solid.contains_box(min, max))
            })
    }
}
