//! The solids of a scene in its matrices: what they make opaque, alone and together.

use std::collections::BTreeMap;

use glam::IVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::bricks::Pages;
use crate::grid::cell_box::CellBox;
use crate::matrix::bits::{ALL, Mask, NONE, beside, block_mask, both, cells_of, either, without};
use crate::object::{Occluder, union_contains};
use crate::scene::Scene;
use crate::shape::Shape;
use crate::shape::pieces::{Asked, Piece, misses, opaque, touched, touched_where};

/// Of the objects that share a cell or a brick with a solid, so many are looked at to find other solids that
/// fill a cell together with it. More than that leave the cell transparent.
const MOST_ASKED: usize = 256;

/// Coordinates of a brick or a page.
type Place = [i32; 3];

/// Other static solids that may lie anywhere: objects too large for the lists of cells.
type Large = SmallVec<[u32; 8]>;

/// No object.
const NOBODY: u32 = u32::MAX;

/// The mask of cells of one brick.
fn mask_of(cells: impl Iterator<Item = IVec3>) -> Mask {
    let mut mask = NONE;
    cells.for_each(|c| mask[(c.z & 7) as usize] |= 1 << ((c.y & 7) << 3 | c.x & 7));
    mask
}

/// The cells of a solid in bricks that have opaque cells of others, in them or beside them.
type Near = BTreeMap<Place, Mask>;

impl Scene {
    /// Writes what a visible dynamic object makes opaque.
    pub(crate) fn add_dynamic_solid(&mut self, occluder: &Occluder) {
        let (bits, counts) = (&mut self.opacity_dynamic, &mut self.counts_dynamic);
        opaque(occluder, &self.grid, &mut |piece| match piece {
            Piece::Page(page) if counts.add_page(bits, page) => {}
            piece => piece.bricks(|brick, mask| counts.add(bits, brick, mask)),
        });
    }

    /// Takes away what one dynamic object made opaque, but for cells inside another.
    pub(crate) fn remove_dynamic_solid(&mut self, occluder: &Occluder) {
        let (bits, counts) = (&mut self.opacity_dynamic, &mut self.counts_dynamic);
        opaque(occluder, &self.grid, &mut |piece| match piece {
            Piece::Page(page) if counts.take_page(bits, page) => {}
            piece => piece.bricks(|brick, mask| {
                counts.take(bits, brick, mask);
            }),
        });
    }

    /// A dynamic object made the cells `old` of a brick opaque, and now makes `new`.
    pub(crate) fn move_dynamic_cells(&mut self, brick: IVec3, old: &Mask, new: &Mask) {
        self.counts_dynamic.add(&mut self.opacity_dynamic, brick, &without(new, old));
        self.counts_dynamic.take(&mut self.opacity_dynamic, brick, &without(old, new));
    }

    /// The cells that static solids touch and that are not opaque, again and again where several do.
    pub(crate) fn static_solid_cells(&self, out: &mut dyn FnMut(IVec3)) {
        for object in self.slots.iter().filter_map(|s| s.object.as_ref()).filter(|o| o.is_static()) {
            let Some(occluder) = object.occluder.as_ref().filter(|o| o.is_solid()) else { continue };
            touched(occluder, &self.grid, &mut |piece| match piece {
                Piece::Page(page) if self.opacity_static.page_is_full(page) => {}
                piece => piece.bricks(|brick, mask| {
                    cells_of(brick, &without(mask, self.opacity_static.brick(brick))).for_each(&mut *out);
                }),
            });
        }
    }

    /// The other static occluders that touch a cell.
    pub(crate) fn static_solids(&self, cell: IVec3, but: u32) -> impl Iterator<Item = &Occluder> {
        let large = self.always.iter().copied().filter(|&s| !self.object(s).in_cells);
        self.ids
            .get(cell)
            .take(MOST_ASKED)
            .chain(large.take(MOST_ASKED))
            .filter_map(move |s| self.static_solid(s, but))
    }

    /// The occluder of a static object, unless it is the one left out.
    fn static_solid(&self, slot: u32, but: u32) -> Option<&Occluder> {
        let object = self.object(slot);
        object.occluder.as_ref().filter(|_| slot != but && object.is_static())
    }

    /// Static solids that are in no lists of cells and may meet another.
    fn large_solids(&self, occluder: &Occluder, but: u32) -> Large {
        let around = occluder.block();
        let meets = |&s: &u32| {
            let solid = self.static_solid(s, but).filter(|_| !self.object(s).in_cells);
            solid.is_some_and(|o| o.block().meets(&around))
        };
        self.always.iter().copied().take(MOST_ASKED).filter(meets).collect()
    }

    /// Whether other static solids may touch a brick.
    fn solids_near(&self, brick: IVec3, but: u32, large: &Large) -> bool {
        let mut members = self.ids.in_brick(brick);
        if members.len() > MOST_ASKED || members.any(|s| self.static_solid(s, but).is_some()) {
            return true;
        }
        let (min, max) = self.grid.range_bounds(brick << 3i32, (brick << 3i32) + 7);
        large.iter().any(|&s| self.static_solid(s, but).is_some_and(|o| !misses(o, min, max)))
    }

    /// Whether a cell lies inside the union of the static solids but one, together with `own`.
    fn solid_with(&self, cell: IVec3, but: u32, large: &Large, own: Option<&Occluder>) -> bool {
        let near = self.ids.get(cell).take(MOST_ASKED).chain(large.iter().copied());
        let mut solids: SmallVec<[&Occluder; 16]> = near.filter_map(|s| self.static_solid(s, but)).collect();
        if solids.is_empty() {
            // Its own cells are known; alone it adds no other.
            return false;
        }
        solids.extend(own);
        union_contains(&Block::new(self.grid.cell_bounds(cell)), &solids)
    }

    /// Writes what a static solid makes opaque, alone and together with others.
    pub(crate) fn add_static_solid(&mut self, slot: u32, occluder: &Occluder) {
        self.mark_rims(occluder);
        let (bits, counts) = (&mut self.opacity_static, &mut self.counts_static);
        opaque(occluder, &self.grid, &mut |piece| match piece {
            Piece::Page(page) if counts.add_page(bits, page) => {}
            piece => piece.bricks(|brick, mask| counts.add(bits, brick, mask)),
        });
        if !occluder.is_solid() {
            return;
        }
        let large = self.large_solids(occluder, slot);
        let mut joint = Vec::new();
        // Only where others are near may cells be filled together with them.
        let page_asked = |page: IVec3| {
            !self.opacity_static.page_is_full(page)
                && (!large.is_empty() || !self.ids.pages().page_is_empty(page))
        };
        let brick_asked =
            |brick: IVec3| *self.opacity_static.brick(brick) != ALL && self.solids_near(brick, slot, &large);
        let asked = Asked { page: &page_asked, brick: &brick_asked };
        touched_where(occluder, &self.grid, asked, &mut |brick, mask| {
            let open = without(mask, self.opacity_static.brick(brick));
            let solid = |&c: &IVec3| self.solid_with(c, slot, &large, Some(occluder));
            joint.extend(cells_of(brick, &open).filter(solid));
        });
        self.join(joint);
    }

    /// Marks the cells that a solid will make opaque beside opaque cells of others: where solids abut along a plane
    /// of the grid, no cell is filled by both.
    fn mark_rims(&mut self, occluder: &Occluder) {
        let mut rims = Vec::new();
        let near = self.cells_near_others(occluder);
        for (&place, mask) in &near {
            let brick = IVec3::from_array(place);
            let mut rim = NONE;
            for (next, axis, up) in self.bricks_beside(brick) {
                let bits = &self.opacity_static;
                let others = beside(bits.brick(brick), bits.brick(next), axis, up);
                // A cell of both is no seam. Bricks that are not here have no cells of others.
                let own = beside(mask, near.get(&next.to_array()).unwrap_or(&NONE), axis, up);
                rim = either(&rim, &both(mask, &without(&others, &own)));
            }
            if rim != NONE {
                rims.push((brick, rim));
            }
        }
        rims.iter().for_each(|(brick, rim)| self.fused.add_rims(*brick, rim));
    }

    /// The cells of a solid that is not written yet, as far as others are near.
    fn cells_near_others(&self, occluder: &Occluder) -> Near {
        let mut near = Near::new();
        let around = occluder.block();
        let (lo, hi) = self.grid.cover(around.min, around.max);
        let Some((lo, hi)) = self.grid.clip(lo - 1, hi + 1) else { return near };
        let pages = self.opacity_static.pages();
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
                let held = |b: IVec3| *self.opacity_static.brick(b) != NONE;
                if held(brick) || self.bricks_beside(brick).any(|(next, ..)| held(next)) {
                    near.insert(brick.to_array(), *mask);
                }
            });
        });
        near
    }

    /// The bricks of the grid that share a face with a brick: axis, and whether they lie above.
    fn bricks_beside(&self, brick: IVec3) -> impl Iterator<Item = (IVec3, usize, bool)> + use<> {
        let last = (self.grid.dims() - 1) >> 3i32;
        IVec3::AXES.into_iter().enumerate().flat_map(move |(axis, step)| {
            let inside = move |b: &IVec3| b.cmpge(IVec3::ZERO).all() && b.cmple(last).all();
            [(brick - step, axis, false), (brick + step, axis, true)]
                .into_iter()
                .filter(move |n| inside(&n.0))
        })
    }

    /// Takes away what a static solid made opaque, but for cells inside the union of others. It is in no
    /// list any more.
    pub(crate) fn remove_static_solid(&mut self, slot: u32, occluder: &Occluder) {
        let large = self.large_solids(occluder, slot);
        let grid = self.grid;
        let mut alone: Vec<(IVec3, Mask)> = Vec::new();
        opaque(occluder, &grid, &mut |piece| {
            if let Piece::Page(page) = piece
                && self.counts_static.take_page(&mut self.opacity_static, page)
            {
                let (lo, hi) = (page << 6i32, (page << 6i32) + 63);
                self.fused.clear_block(lo, hi);
                let (min, max) = grid.range_bounds(lo, hi);
                let near = |&s: &u32| self.static_solid(s, slot).is_some_and(|o| !misses(o, min, max));
                if !self.ids.pages().page_is_empty(page) || large.iter().any(near) {
                    piece.bricks(|brick, mask| {
                        if self.solids_near(brick, slot, &large) {
                            alone.push((brick, *mask));
                        }
                    });
                }
                return;
            }
            piece.bricks(|brick, mask| {
                let gone = self.counts_static.take(&mut self.opacity_static, brick, mask);
                if gone != NONE {
                    self.fused.clear_cells(brick, &gone);
                    if self.solids_near(brick, slot, &large) {
                        alone.push((brick, gone));
                    }
                }
            });
        });
        // Cells that it alone held may lie inside the union of others.
        let held = alone.iter().flat_map(|(brick, mask)| cells_of(*brick, mask));
        let joint: Vec<IVec3> = held.filter(|&c| self.solid_with(c, slot, &large, None)).collect();
        self.join(joint);
        // Cells that it filled together with others may lie inside those alone.
        let around = occluder.block();
        let (lo, hi) = grid.cover(around.min, around.max);
        let Some((lo, hi)) = grid.clip(lo, hi) else { return };
        let mut open: Vec<(IVec3, Mask)> = Vec::new();
        self.fused.for_cells(lo, hi, &mut |brick, mask| {
            let mask = both(mask, &block_mask(brick, lo, hi));
            let lost = mask_of(cells_of(brick, &mask).filter(|&c| !self.solid_with(c, slot, &large, None)));
            if lost != NONE {
                open.push((brick, lost));
            }
        });
        for (brick, mask) in open {
            let gone = self.counts_static.take(&mut self.opacity_static, brick, &mask);
            self.fused.part(brick, &mask);
            self.fused.clear_cells(brick, &gone);
        }
        self.forget_rims(lo, hi);
    }

    /// Cells beside those of a solid that is gone are rims only where yet other solids meet.
    fn forget_rims(&mut self, lo: IVec3, hi: IVec3) {
        let (lo, hi) = ((lo - 1).max(IVec3::ZERO), (hi + 1).min(self.grid.dims() - 1));
        let mut idle: Vec<(IVec3, Mask)> = Vec::new();
        self.fused.for_rims(lo, hi, &mut |brick, mask| {
            let mask = both(mask, &block_mask(brick, lo, hi));
            let gone = mask_of(cells_of(brick, &mask).filter(|&c| !self.is_rim(c)));
            if gone != NONE {
                idle.push((brick, gone));
            }
        });
        idle.iter().for_each(|(brick, cells)| self.fused.forget_rims(*brick, cells));
    }

    /// Whether no single solid fills an opaque cell and all opaque cells beside it.
    fn is_rim(&self, cell: IVec3) -> bool {
        let mut steps = IVec3::AXES.into_iter().flat_map(|step| [cell + step, cell - step]);
        self.opacity_static.get(cell)
            && steps.any(|next| {
                let (min, max) = self.grid.range_bounds(cell.min(next), cell.max(next));
                self.opacity_static.get(next)
                    && !self.static_solids(cell, NOBODY).any(|solid| solid.contains_box(min, max))
            })
    }

    /// Makes cells opaque that solids fill together.
    fn join(&mut self, cells: Vec<IVec3>) {
        for c in cells {
            self.opacity_static.set(c);
            self.fused.add(c);
        }
    }
}
