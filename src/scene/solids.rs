//! The cells that static solids make opaque, alone and together.
//!
//! A cell is opaque if the union of the static solids on the same layers contains it. A solid that
//! is inserted adds the cells that it fills alone, and those that it fills together with solids
//! that share the cell. Cells that only several solids fill are kept apart
//! ([`crate::matrix::fused`]), to be drawn as boxes: no single solid covers the seam between them.

use casca_slots::Slot;
use glam::IVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::bricks::Pages;
use crate::matrix::bits::{ALL, Mask, NONE, OpacityMatrix, block_mask, both, cells_of, without};
use crate::numeric::scene::FILLED;
use crate::object::{Occluder, union_contains};
use crate::scene::{OpacityPart, Scene};
use crate::shape::pieces::{Asked, Piece, misses, opaque, touched_where};

/// How many of the objects that share a cell or a brick with a solid are looked at, to find others
/// that fill a cell together with it. If there are more, the cell stays transparent.
const MOST_ASKED: usize = 256;

/// How many of the objects in a brick are looked at.
const MOST_MEMBERS: usize = 1024;

/// A static solid whose cells are added or taken away.
#[derive(Clone, Copy)]
struct Own {
    slot: Slot,
    /// Where its cells are: it is joined with others there only.
    part: OpacityPart,
}

/// Solids with the boxes around them.
type NearSolids<'a> = SmallVec<[(&'a Occluder, Block); 16]>;

/// Static solids that are in no lists of cells, because they are too large for these.
type Large = SmallVec<[Slot; 8]>;

/// The mask of cells of one brick.
pub(super) fn mask_of(cells: impl Iterator<Item = IVec3>) -> Mask {
    let mut mask = NONE;
    cells.for_each(|c| mask[(c.z & 7) as usize] |= 1 << ((c.y & 7) << 3 | c.x & 7));
    mask
}

impl Scene {
    /// The opaque cells of the static occluders on the same layers.
    #[inline]
    fn opaque(&self, part: OpacityPart) -> &OpacityMatrix {
        self.opacity.part(part).fixed()
    }

    /// The static occluders on the same layers that touch a cell, up to a limit, and those too
    /// large to be in cells.
    pub(crate) fn static_solids(&self, cell: IVec3, part: OpacityPart) -> impl Iterator<Item = &Occluder> {
        // Many may be there that lie wholly outside of the grid.
        let large = self.always().iter().copied().take(MOST_ASKED);
        let large = large.filter(|&s| !self.object(s).in_cells);
        let block = Block::new(self.grid.cell_bounds(cell));
        let near = self.ids.in_brick(cell >> 3i32).take(MOST_MEMBERS);
        let near = near.filter_map(move |s| self.static_solid(s, part));
        let near = near.filter(move |o| o.block().meets(&block)).take(MOST_ASKED);
        near.chain(large.filter_map(move |s| self.static_solid(s, part)))
    }

    /// The occluder of an object, if that is static and its cells are in a part of the opacity.
    fn static_solid(&self, slot: Slot, part: OpacityPart) -> Option<&Occluder> {
        let object = self.object(slot);
        object.occluder().filter(|_| object.is_static() && object.opacity == Some(part))
    }

    /// As [`Scene::static_solid`], but none for a solid itself.
    fn other_solid(&self, other: Slot, own: Own) -> Option<&Occluder> {
        if other == own.slot { None } else { self.static_solid(other, own.part) }
    }

    /// Other static solids that are in no lists of cells and may touch a solid.
    fn large_solids(&self, occluder: &Occluder, own: Own) -> Large {
        let around = occluder.block();
        let meets = |&s: &Slot| {
            let solid = self.other_solid(s, own).filter(|_| !self.object(s).in_cells);
            solid.is_some_and(|o| o.block().meets(&around))
        };
        self.always().iter().copied().take(MOST_ASKED).filter(meets).collect()
    }

    /// The other static solids that may touch the part of a brick that lies in a box.
    fn solids_in(&self, brick: IVec3, own: Own, around: &Block, large: &Large) -> NearSolids<'_> {
        let part =
            Block::new(self.grid.range_bounds(brick << 3i32, (brick << 3i32) + 7)).intersection(around);
        let members = self.ids.in_brick(brick).take(MOST_MEMBERS).chain(large.iter().copied());
        let solids = members.filter_map(|s| self.other_solid(s, own)).map(|o| (o, o.block()));
        solids.filter(|(_, block)| block.meets(&part)).collect()
    }

    /// Whether other static solids may touch a brick.
    fn solids_near(&self, brick: IVec3, own: Own, large: &Large) -> bool {
        let mut members = self.ids.in_brick(brick);
        if members.len() > MOST_ASKED || members.any(|s| self.other_solid(s, own).is_some()) {
            return true;
        }
        let (min, max) = self.grid.range_bounds(brick << 3i32, (brick << 3i32) + 7);
        large.iter().any(|&s| self.other_solid(s, own).is_some_and(|o| !misses(o, min, max)))
    }

    /// Whether a cell lies inside the union of `own` and other solids. `own` alone does not fill
    /// it.
    fn solid_with(&self, cell: IVec3, near: &NearSolids, own: Option<&(&Occluder, Block)>) -> bool {
        let block = Block::new(self.grid.cell_bounds(cell));
        let others = || near.iter().filter(|(_, b)| b.overlaps(&block)).take(MOST_ASKED);
        let filled: f64 = others().chain(own).map(|(_, b)| b.intersection(&block).volume()).sum();
        // The boxes of the solids do not fill it, by more than rounding.
        if filled < FILLED * block.volume() || others().next().is_none() {
            return false;
        }
        let solids: SmallVec<[&Occluder; 16]> = others().chain(own).map(|(o, _)| *o).collect();
        union_contains(&block, &solids)
    }

    /// Adds the cells that a static solid makes opaque, alone and together with others.
    pub(super) fn add_static_solid(&mut self, slot: Slot, part: OpacityPart, occluder: &Occluder) {
        let me = Own { slot, part };
        self.mark_contacts(part, occluder);
        self.opacity.part_mut(part).fixed.add(occluder, &self.grid);
        if !occluder.is_solid() {
            return;
        }
        let large = self.large_solids(occluder, me);
        let own = (occluder, occluder.block());
        let mut joint = Vec::new();
        // Only where others are near may cells be filled together with them.
        let page_asked = |page: IVec3| {
            !self.opaque(part).page_is_full(page)
                && (!large.is_empty() || !self.ids.pages().page_is_empty(page))
        };
        let brick_asked = |brick: IVec3| *self.opaque(part).brick(brick) != ALL;
        let asked = Asked { page: &page_asked, brick: &brick_asked };
        touched_where(occluder, &self.grid, asked, &mut |brick, mask| {
            let open = without(mask, self.opaque(part).brick(brick));
            let near = self.solids_in(brick, me, &own.1, &large);
            if !near.is_empty() {
                joint.extend(cells_of(brick, &open).filter(|&c| self.solid_with(c, &near, Some(&own))));
            }
        });
        self.join(part, joint);
    }

    /// Takes away the cells that a static solid made opaque, except those inside the union of
    /// others. The object is in no list of cells any more.
    pub(super) fn remove_static_solid(&mut self, slot: Slot, part: OpacityPart, occluder: &Occluder) {
        let own = Own { slot, part };
        let large = self.large_solids(occluder, own);
        let cleared = self.clear_solid(own, occluder, &large);
        // Cells that it filled alone may lie inside the union of others.
        let around = occluder.block();
        let mut joint = Vec::new();
        for (brick, mask) in &cleared {
            let near = self.solids_in(*brick, own, &around, &large);
            joint.extend(cells_of(*brick, mask).filter(|&c| self.solid_with(c, &near, None)));
        }
        self.join(part, joint);
        let (lo, hi) = self.grid.cover(around.min, around.max);
        if let Some((lo, hi)) = self.grid.clip(lo, hi) {
            self.part(own, lo, hi, &large);
            self.forget_contacts(part, lo, hi);
        }
    }

    /// Clears the cells that only one solid fills. Gives those in bricks with other solids nearby.
    fn clear_solid(&mut self, own: Own, occluder: &Occluder, large: &Large) -> Vec<(IVec3, Mask)> {
        let grid = self.grid;
        let mut cleared: Vec<(IVec3, Mask)> = Vec::new();
        opaque(occluder, &grid, &mut |piece| {
            if let Piece::Page(page) = piece
                && self.opacity.part_mut(own.part).clear_page(page)
            {
                let (lo, hi) = (page << 6i32, (page << 6i32) + 63);
                let (min, max) = grid.range_bounds(lo, hi);
                let near = |&s: &Slot| self.other_solid(s, own).is_some_and(|o| !misses(o, min, max));
                if !self.ids.pages().page_is_empty(page) || large.iter().any(near) {
                    piece.bricks(|brick, mask| {
                        if self.solids_near(brick, own, large) {
                            cleared.push((brick, *mask));
                        }
                    });
                }
                return;
            }
            piece.bricks(|brick, mask| {
                let gone = self.opacity.part_mut(own.part).take_fixed(brick, mask);
                if gone != NONE && self.solids_near(brick, own, large) {
                    cleared.push((brick, gone));
                }
            });
        });
        cleared
    }

    /// Clears the cells in a block that a solid filled together with others, and that those do not
    /// fill without it.
    fn part(&mut self, own: Own, lo: IVec3, hi: IVec3, large: &Large) {
        let mut open: Vec<(IVec3, Mask)> = Vec::new();
        self.opacity.part(own.part).fused().for_cells(lo, hi, &mut |brick, mask| {
            let mask = both(mask, &block_mask(brick, lo, hi));
            let around = Block::new(self.grid.range_bounds(lo, hi));
            let near = self.solids_in(brick, own, &around, large);
            let lost = mask_of(cells_of(brick, &mask).filter(|&c| !self.solid_with(c, &near, None)));
            if lost != NONE {
                open.push((brick, lost));
            }
        });
        let opacity = self.opacity.part_mut(own.part);
        open.iter().for_each(|(brick, mask)| opacity.part_fixed(*brick, mask));
    }

    /// Makes cells opaque that solids fill together.
    fn join(&mut self, part: OpacityPart, cells: Vec<IVec3>) {
        let opacity = self.opacity.part_mut(part);
        cells.into_iter().for_each(|cell| opacity.join_fixed(cell));
    }
}
