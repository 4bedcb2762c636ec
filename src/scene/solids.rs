//! The cells that static solids make opaque, alone and together.
//!
//! A cell is opaque if the union of the static solids on the same layers contains it. A solid that
//! is inserted adds the cells that it fills alone, and those that it fills together with solids
//! that share the cell. Cells that only several solids fill are noted, to be cleared when one goes.

use glam::IVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::grid::mask::{ALL, Mask, NONE, block_mask, both, cells_of, without};
use crate::grid::{Grid, clip};
use crate::numeric::scene::FILLED;
use crate::object::{Occluder, union_contains};
use crate::scene::opacity::LayerOpacity;
use crate::scene::opaque::add_cells;
use crate::scene::static_solids::{Large, MOST_ASKED, NearSolids, StaticSolids};
use crate::shape::pieces::{Asked, Piece, is_too_large, opaque, touched_where};

/// Whether a cell lies inside the union of `own` and other solids. `own` alone does not fill it.
fn solid_with(grid: &Grid, cell: IVec3, near: &NearSolids, own: Option<&(&Occluder, Block)>) -> bool {
    let block = Block::new(grid.cell_bounds(cell));
    let others = || near.iter().filter(|(_, b)| b.overlaps(&block)).take(MOST_ASKED);
    let filled: f64 = others().chain(own).map(|(_, b)| b.intersection(&block).volume()).sum();
    // The boxes of the solids do not fill it, by more than rounding.
    if filled < FILLED * block.volume() || others().next().is_none() {
        return false;
    }
    let solids: SmallVec<[&Occluder; 16]> = others().chain(own).map(|(o, _)| *o).collect();
    union_contains(&block, &solids)
}

/// The mask of cells of one brick.
fn mask_of(cells: impl Iterator<Item = IVec3>) -> Mask {
    let mut mask = NONE;
    cells.for_each(|c| mask[(c.z & 7) as usize] |= 1 << ((c.y & 7) << 3 | c.x & 7));
    mask
}

/// Whether a solid is so large that it makes no cell opaque.
fn is_larger_than_cells(occluder: &Occluder, grid: &Grid) -> bool {
    let around = occluder.block();
    let (lo, hi) = grid.cover(around.min, around.max);
    clip(lo, hi).is_none_or(|(lo, hi)| is_too_large(lo, hi))
}

/// Adds the cells that a static solid makes opaque, alone and together with others.
pub(super) fn add_static_solid(opacity: &mut LayerOpacity, occluder: &Occluder, others: &StaticSolids) {
    let grid = others.grid;
    if is_larger_than_cells(occluder, grid) {
        return;
    }
    add_cells(&mut opacity.fixed, occluder, grid);
    if !occluder.is_solid() {
        return;
    }
    let large = others.large_near(occluder);
    let own = (occluder, occluder.block());
    let mut joint = Vec::new();
    let fixed = opacity.fixed();
    // Only where others are near may cells be filled together with them.
    let page_asked = |page: IVec3| {
        !fixed.page_is_full(page) && (!large.is_empty() || !others.index.ids.pages().is_empty(page))
    };
    let brick_asked = |brick: IVec3| *fixed.brick(brick) != ALL;
    let asked = Asked { page: &page_asked, brick: &brick_asked };
    touched_where(occluder.kind(), grid, asked, &mut |brick, mask| {
        let open = without(mask, fixed.brick(brick));
        let near = others.in_brick(brick, &own.1, &large);
        if !near.is_empty() {
            joint.extend(cells_of(brick, &open).filter(|&c| solid_with(grid, c, &near, Some(&own))));
        }
    });
    joint.into_iter().for_each(|cell| opacity.join_fixed(cell));
}

/// Takes away the cells that a static solid made opaque, except those inside the union of others.
/// The object is in no list of cells any more.
pub(super) fn remove_static_solid(opacity: &mut LayerOpacity, occluder: &Occluder, others: &StaticSolids) {
    let grid = others.grid;
    if is_larger_than_cells(occluder, grid) {
        return;
    }
    let large = others.large_near(occluder);
    let cleared = clear_solid(opacity, occluder, others, &large);
    // Cells that it filled alone may lie inside the union of others.
    let around = occluder.block();
    let mut joint = Vec::new();
    for (brick, mask) in &cleared {
        let near = others.in_brick(*brick, &around, &large);
        joint.extend(cells_of(*brick, mask).filter(|&c| solid_with(grid, c, &near, None)));
    }
    joint.into_iter().for_each(|cell| opacity.join_fixed(cell));
    let (lo, hi) = grid.cover(around.min, around.max);
    if let Some((lo, hi)) = clip(lo, hi) {
        part_solids(opacity, (lo, hi), others, &large);
    }
}

/// Clears the cells that only one solid fills. Gives those in bricks with other solids nearby.
fn clear_solid(
    opacity: &mut LayerOpacity,
    occluder: &Occluder,
    others: &StaticSolids,
    large: &Large,
) -> Vec<(IVec3, Mask)> {
    let mut cleared: Vec<(IVec3, Mask)> = Vec::new();
    opaque(occluder.kind(), others.grid, &mut |piece| {
        if let Piece::Page(page) = piece
            && opacity.fixed.take_page(page)
        {
            let (min, max) = others.grid.range_bounds(page << 6i32, (page << 6i32) + 63);
            if !others.index.ids.pages().is_empty(page) || others.large_touch(min, max, large) {
                piece.bricks(|brick, mask| {
                    if others.touch_brick(brick, large) {
                        cleared.push((brick, *mask));
                    }
                });
            }
            return;
        }
        piece.bricks(|brick, mask| {
            let gone = opacity.fixed.take(brick, mask);
            if gone != NONE && others.touch_brick(brick, large) {
                cleared.push((brick, gone));
            }
        });
    });
    cleared
}

/// Clears the cells in a block that a solid filled together with others, and that those do not fill
/// without it.
fn part_solids(opacity: &mut LayerOpacity, (lo, hi): (IVec3, IVec3), others: &StaticSolids, large: &Large) {
    let mut open: Vec<(IVec3, Mask)> = Vec::new();
    let joint = &opacity.joint;
    let pages =
        CellBox { lo: lo >> 6i32, hi: hi >> 6i32 }.cells().filter(|&page| !joint.pages().is_empty(page));
    let around = Block::new(others.grid.range_bounds(lo, hi));
    let within = |page: IVec3| CellBox {
        lo: (lo >> 3i32).max(page << 3i32),
        hi: (hi >> 3i32).min((page << 3i32) + 7),
    };
    for brick in pages.flat_map(|page| within(page).cells()) {
        let mask = both(joint.brick(brick), &block_mask(brick, lo, hi));
        if mask == NONE {
            continue;
        }
        let near = others.in_brick(brick, &around, large);
        let lost = mask_of(cells_of(brick, &mask).filter(|&c| !solid_with(others.grid, c, &near, None)));
        if lost != NONE {
            open.push((brick, lost));
        }
    }
    open.iter().for_each(|(brick, mask)| opacity.part_fixed(*brick, mask));
}
