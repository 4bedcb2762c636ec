//! The cells that static solids make opaque, alone and together.
//!
//! A cell is opaque if the union of the static solids contains it. A solid that is inserted adds the cells that it
//! fills alone, and those that it fills together with solids that share the cell. Cells that only several solids fill
//! are kept apart ([`crate::matrix::fused`]), to be drawn as boxes: no single solid covers the seam between them.

use glam::IVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::bricks::Pages;
use crate::matrix::bits::{ALL, Mask, NONE, block_mask, both, cells_of, without};
use crate::numeric::scene::FILLED;
use crate::object::{Occluder, union_contains};
use crate::scene::Scene;
use crate::shape::pieces::{Asked, Piece, misses, opaque, touched, touched_where};

/// Of the objects that share a cell or a brick with a solid, so many are looked at to find other solids that
/// fill a cell together with it. More than that leave the cell transparent.
const MOST_ASKED: usize = 256;

/// Of the objects in a brick, so many are looked at.
const MOST_MEMBERS: usize = 1024;

/// Solids with the boxes around them.
type Near<'a> = SmallVec<[(&'a Occluder, Block); 16]>;

/// Static solids that are in no lists of cells, because they are too large for these.
type Large = SmallVec<[u32; 8]>;

/// The mask of cells of one brick.
pub(super) fn mask_of(cells: impl Iterator<Item = IVec3>) -> Mask {
    let mut mask = NONE;
    cells.for_each(|c| mask[(c.z & 7) as usize] |= 1 << ((c.y & 7) << 3 | c.x & 7));
    mask
}

impl Scene {
    /// The cells that static solids touch and that are not opaque, again and again where several do.
    pub(crate) fn static_solid_cells(&self, out: &mut dyn FnMut(IVec3)) {
        for (_, object) in self.living().filter(|(_, o)| o.is_static()) {
            let Some(occluder) = object.occluder().filter(|o| o.is_solid()) else { continue };
            touched(occluder, &self.grid, &mut |piece| match piece {
                Piece::Page(page) if self.static_opacity().page_is_full(page) => {}
                piece => piece.bricks(|brick, mask| {
                    cells_of(brick, &without(mask, self.static_opacity().brick(brick))).for_each(&mut *out);
                }),
            });
        }
    }

    /// The static occluders that touch a cell, up to a limit, and those too large to be in cells.
    pub(crate) fn static_solids(&self, cell: IVec3) -> impl Iterator<Item = &Occluder> {
        let large = self.always().iter().copied().filter(|&s| !self.object(s).in_cells);
        let block = Block::new(self.grid.cell_bounds(cell));
        let near = self.ids.in_brick(cell >> 3i32).take(MOST_MEMBERS).filter_map(|s| self.static_solid(s));
        let near = near.filter(move |o| o.block().meets(&block)).take(MOST_ASKED);
        near.chain(large.take(MOST_ASKED).filter_map(|s| self.static_solid(s)))
    }

    /// The occluder of an object, if that is static.
    fn static_solid(&self, slot: u32) -> Option<&Occluder> {
        let object = self.object(slot);
        object.occluder().filter(|_| object.is_static())
    }

    /// As [`Scene::static_solid`], but none for the object of `slot` itself.
    fn other_solid(&self, other: u32, slot: u32) -> Option<&Occluder> {
        if other == slot { None } else { self.static_solid(other) }
    }

    /// Other static solids that are in no lists of cells and may touch the solid of `slot`.
    fn large_solids(&self, occluder: &Occluder, slot: u32) -> Large {
        let around = occluder.block();
        let meets = |&s: &u32| {
            let solid = self.other_solid(s, slot).filter(|_| !self.object(s).in_cells);
            solid.is_some_and(|o| o.block().meets(&around))
        };
        self.always().iter().copied().take(MOST_ASKED).filter(meets).collect()
    }

    /// The other static solids that may touch the part of a brick that lies in a box.
    fn solids_in(&self, brick: IVec3, slot: u32, around: &Block, large: &Large) -> Near<'_> {
        let part =
            Block::new(self.grid.range_bounds(brick << 3i32, (brick << 3i32) + 7)).intersection(around);
        let members = self.ids.in_brick(brick).take(MOST_MEMBERS).chain(large.iter().copied());
        let solids = members.filter_map(|s| self.other_solid(s, slot)).map(|o| (o, o.block()));
        solids.filter(|(_, block)| block.meets(&part)).collect()
    }

    /// Whether other static solids may touch a brick.
    fn solids_near(&self, brick: IVec3, slot: u32, large: &Large) -> bool {
        let mut members = self.ids.in_brick(brick);
        if members.len() > MOST_ASKED || members.any(|s| self.other_solid(s, slot).is_some()) {
            return true;
        }
        let (min, max) = self.grid.range_bounds(brick << 3i32, (brick << 3i32) + 7);
        large.iter().any(|&s| self.other_solid(s, slot).is_some_and(|o| !misses(o, min, max)))
    }

    /// Whether a cell lies inside the union of `own` and other solids. `own` alone does not fill it.
    fn solid_with(&self, cell: IVec3, near: &Near, own: Option<&(&Occluder, Block)>) -> bool {
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
    pub(super) fn add_static_solid(&mut self, slot: u32, occluder: &Occluder) {
        self.mark_rims(occluder);
        self.fixed.add(occluder, &self.grid);
        if !occluder.is_solid() {
            return;
        }
        let large = self.large_solids(occluder, slot);
        let own = (occluder, occluder.block());
        let mut joint = Vec::new();
        // Only where others are near may cells be filled together with them.
        let page_asked = |page: IVec3| {
            !self.static_opacity().page_is_full(page)
                && (!large.is_empty() || !self.ids.pages().page_is_empty(page))
        };
        let brick_asked = |brick: IVec3| *self.static_opacity().brick(brick) != ALL;
        let asked = Asked { page: &page_asked, brick: &brick_asked };
        touched_where(occluder, &self.grid, asked, &mut |brick, mask| {
            let open = without(mask, self.static_opacity().brick(brick));
            let near = self.solids_in(brick, slot, &own.1, &large);
            if !near.is_empty() {
                joint.extend(cells_of(brick, &open).filter(|&c| self.solid_with(c, &near, Some(&own))));
            }
        });
        self.join(joint);
    }

    /// Takes away the cells that a static solid made opaque, except those inside the union of others. The object is
    /// in no list of cells any more.
    pub(super) fn remove_static_solid(&mut self, slot: u32, occluder: &Occluder) {
        let large = self.large_solids(occluder, slot);
        let cleared = self.clear_solid(slot, occluder, &large);
        // Cells that it filled alone may lie inside the union of others.
        let around = occluder.block();
        let mut joint = Vec::new();
        for (brick, mask) in &cleared {
            let near = self.solids_in(*brick, slot, &around, &large);
            joint.extend(cells_of(*brick, mask).filter(|&c| self.solid_with(c, &near, None)));
        }
        self.join(joint);
        let (lo, hi) = self.grid.cover(around.min, around.max);
        if let Some((lo, hi)) = self.grid.clip(lo, hi) {
            self.part(slot, lo, hi, &large);
            self.forget_rims(lo, hi);
        }
    }

    /// Clears the cells that only one solid fills. Gives those in bricks with other solids nearby.
    fn clear_solid(&mut self, slot: u32, occluder: &Occluder, large: &Large) -> Vec<(IVec3, Mask)> {
        let grid = self.grid;
        let mut cleared: Vec<(IVec3, Mask)> = Vec::new();
        opaque(occluder, &grid, &mut |piece| {
            if let Piece::Page(page) = piece
                && self.fixed.take_page(page)
            {
                let (lo, hi) = (page << 6i32, (page << 6i32) + 63);
                self.fused.clear_block(lo, hi);
                let (min, max) = grid.range_bounds(lo, hi);
                let near = |&s: &u32| self.other_solid(s, slot).is_some_and(|o| !misses(o, min, max));
                if !self.ids.pages().page_is_empty(page) || large.iter().any(near) {
                    piece.bricks(|brick, mask| {
                        if self.solids_near(brick, slot, large) {
                            cleared.push((brick, *mask));
                        }
                    });
                }
                return;
            }
            piece.bricks(|brick, mask| {
                let gone = self.fixed.take(brick, mask);
                if gone != NONE {
                    self.fused.clear_cells(brick, &gone);
                    if self.solids_near(brick, slot, large) {
                        cleared.push((brick, gone));
                    }
                }
            });
        });
        cleared
    }

    /// Clears the cells in a block that the solid of `slot` filled together with others, and that those do not
    /// fill without it.
    fn part(&mut self, slot: u32, lo: IVec3, hi: IVec3, large: &Large) {
        let mut open: Vec<(IVec3, Mask)> = Vec::new();
        self.fused.for_cells(lo, hi, &mut |brick, mask| {
            let mask = both(mask, &block_mask(brick, lo, hi));
            let around = Block::new(self.grid.range_bounds(lo, hi));
            let near = self.solids_in(brick, slot, &around, large);
            let lost = mask_of(cells_of(brick, &mask).filter(|&c| !self.solid_with(c, &near, None)));
            if lost != NONE {
                open.push((brick, lost));
            }
        });
        for (brick, mask) in open {
            let gone = self.fixed.take(brick, &mask);
            self.fused.part(brick, &mask);
            self.fused.clear_cells(brick, &gone);
        }
    }

    /// Makes cells opaque that solids fill together.
    fn join(&mut self, cells: Vec<IVec3>) {
        for c in cells {
            self.fixed.set(c);
            self.fused.add(c);
        }
    }
}
