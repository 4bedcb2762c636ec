//! Contacts: opaque cells of one static solid beside opaque cells of another.
//!
//! Where solids abut along a plane of the grid, no cell is filled by both together, and no box of
//! cells would bridge their seam. The cells on both sides of such a plane are marked, so that boxes
//! of opaque cells are drawn across it.

use std::collections::BTreeMap;

use glam::IVec3;

use crate::grid::cell_box::CellBox;
use crate::grid::mask::{Mask, NONE, beside, block_mask, both, cells_of, either, without};
use crate::grid::{Grid, clip};
use crate::object::Occluder;
use crate::scene::opacity::LayerOpacity;
use crate::scene::static_solids::StaticSolids;
use crate::shape::Shape;
use crate::shape::pieces::{Piece, opaque};

/// The cells of a solid by brick, for bricks that have opaque cells of others in them or beside
/// them.
type NearCells = BTreeMap<[i32; 3], Mask>;

/// The mask of cells of one brick.
pub(super) fn mask_of(cells: impl Iterator<Item = IVec3>) -> Mask {
    let mut mask = NONE;
    cells.for_each(|c| mask[(c.z & 7) as usize] |= 1 << ((c.y & 7) << 3 | c.x & 7));
    mask
}

/// Marks the cells that a solid will make opaque beside opaque cells of others.
pub(super) fn mark_contacts(opacity: &mut LayerOpacity, occluder: &Occluder, grid: &Grid) {
    let mut contacts = Vec::new();
    let bits = opacity.fixed();
    let near = cells_near_others(opacity, occluder, grid);
    for (&place, mask) in &near {
        let brick = IVec3::from_array(place);
        let mut contact = NONE;
        for (next, axis, up) in bricks_beside(brick) {
            let others = beside(bits.brick(brick), bits.brick(next), axis, up);
            // A cell of both is no seam. Bricks that are not here have no cells of others.
            let own = beside(mask, near.get(&next.to_array()).unwrap_or(&NONE), axis, up);
            contact = either(&contact, &both(mask, &without(&others, &own)));
        }
        if contact != NONE {
            contacts.push((brick, contact));
        }
    }
    contacts.iter().for_each(|(brick, contact)| opacity.fused.add_contacts(*brick, contact));
}

/// The cells of a solid that is not in the matrices yet, where others are near.
fn cells_near_others(opacity: &LayerOpacity, occluder: &Occluder, grid: &Grid) -> NearCells {
    let mut near = NearCells::new();
    let bits = opacity.fixed();
    let around = occluder.block();
    let (lo, hi) = grid.cover(around.min, around.max);
    let Some((lo, hi)) = clip(lo - 1, hi + 1) else { return near };
    let pages = bits.pages();
    let empty = |lo: IVec3, hi: IVec3| {
        CellBox { lo: lo >> 6i32, hi: hi >> 6i32 }.cells().all(|page| pages.is_empty(page))
    };
    if !occluder.is_solid() || empty(lo, hi) {
        return near;
    }
    opaque(occluder, grid, &mut |piece| {
        if let Piece::Page(page) = piece
            && empty((page << 6i32) - 1, (page << 6i32) + 64)
        {
            return;
        }
        piece.bricks(|brick, mask| {
            let has_opaque = |b: IVec3| *bits.brick(b) != NONE;
            if has_opaque(brick) || bricks_beside(brick).any(|(next, ..)| has_opaque(next)) {
                near.insert(brick.to_array(), *mask);
            }
        });
    });
    near
}

/// The bricks that share a face with a brick, with the axis across it, and whether they lie above.
fn bricks_beside(brick: IVec3) -> impl Iterator<Item = (IVec3, usize, bool)> {
    let axes = IVec3::AXES.into_iter().enumerate();
    axes.flat_map(move |(axis, step)| [(brick - step, axis, false), (brick + step, axis, true)])
}

/// Forgets the contacts in a block of cells around a solid that is gone, where no other solids
/// abut.
pub(super) fn forget_contacts(opacity: &mut LayerOpacity, (lo, hi): (IVec3, IVec3), others: &StaticSolids) {
    let (lo, hi) = (lo - 1, hi + 1);
    let mut idle: Vec<(IVec3, Mask)> = Vec::new();
    opacity.fused().for_contacts(lo, hi, &mut |brick, mask| {
        let mask = both(mask, &block_mask(brick, lo, hi));
        let gone = mask_of(cells_of(brick, &mask).filter(|&c| !is_contact(opacity, c, others)));
        if gone != NONE {
            idle.push((brick, gone));
        }
    });
    idle.iter().for_each(|(brick, cells)| opacity.fused.forget_contacts(*brick, cells));
}

/// Whether no single solid fills an opaque cell and all opaque cells beside it.
fn is_contact(opacity: &LayerOpacity, cell: IVec3, solids: &StaticSolids) -> bool {
    let opaque = opacity.fixed();
    let mut steps = IVec3::AXES.into_iter().flat_map(|step| [cell + step, cell - step]);
    opaque.get(cell)
        && steps.any(|next| {
            let (min, max) = solids.grid.range_bounds(cell.min(next), cell.max(next));
            opaque.get(next) && !solids.near_cell(cell).any(|solid| solid.contains_box(min, max))
        })
}
