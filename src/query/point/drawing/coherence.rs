//! Coherent queries: a run begins with the occluders that were of use in the last one, and leaves
//! out those that were not, as long as nothing that was hidden comes into sight.
//!
//! Bittner, Wimmer, Piringer & Purgathofer 2004 (coherent hierarchical culling) guess from the last
//! frame which objects are visible; Haar & Aaltonen 2015 draw those first. Here the guess is about
//! patches and solids:
//!
//! 1. Those that hid something at the end of the last run are drawn first, patches in one batch.
//! 2. The walk goes as ever. It draws occluders that the last run did not draw. Others wait.
//! 3. An object that the last view could have seen, that it did not see, and that is not hidden
//!    after the walk, is suspicious: those that wait before such objects are drawn then, before the
//!    second test if the object is plainly in sight, else after it, and such objects tested again.
//! 4. Objects that were visible in the last run stay visible unless the buffers hide them at once:
//!    their open pixels are examined in every sixteenth run only. All others are examined as ever.
//!
//! All that is drawn occludes, and all objects are tested: so a wrong guess costs time or leaves an
//! object in the set, and hides nothing.

use casca_slots::Slot;

use crate::geometry::Block;
use crate::id::ObjectId;
use crate::mesh::surface::PatchIndex;
use crate::occlusion::magnify::UsedFinely;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::batch::{Batch, Sighting};
use crate::query::point::drawing::Drawing;
use crate::query::point::drawing::drawables::Source;
use crate::query::point::drawing::recall::{Coherence, Recall, Role, Usage};

impl<'a> Drawing<'a> {
    /// Draws the occluders that were of use in the last run.
    pub(crate) fn draw_useful(&mut self) {
        let solids = std::mem::take(&mut self.scratch.coherence.useful_solids);
        for &slot in &solids {
            if self.may_draw(slot) {
                self.note_offered(slot);
                self.draw(slot);
            }
        }
        self.scratch.coherence.useful_solids = solids;
        let mut patches = std::mem::take(&mut self.scratch.coherence.useful_patches);
        self.draw_patches_of(&mut patches, |_, _| true);
        self.scratch.coherence.useful_patches = patches;
    }

    /// Whether an object of which only the slot is known has an occluder that may be drawn.
    fn may_draw(&self, slot: Slot) -> bool {
        self.run.scene.living_at(slot).is_some_and(|object| {
            object.occluder().is_some()
                && object.is_shown(self.run.view)
                && (object.is_static() || !self.run.fixed_only)
                && !self.run.scene.is_unlocated(slot)
                && !object.is_hidden_unreported()
        })
    }

    /// Draws patches of objects of which only the slots are known, those of which `wanted` says so
    /// by their box.
    fn draw_patches_of(
        &mut self,
        patches: &mut [(Slot, PatchIndex)],
        wanted: impl Fn(&Self, &Block) -> bool,
    ) {
        if patches.is_empty() || !self.run.view.is_ordered() {
            return;
        }
        patches.sort_unstable();
        let mut batch = std::mem::take(&mut self.scratch.batch).emptied();
        for of_object in patches.chunk_by(|a, b| a.0 == b.0) {
            let slot = of_object[0].0;
            if self.may_draw(slot)
                && let Some(source) = Source::of(self.run.scene, slot)
            {
                self.note_offered(slot);
                self.collect_some(&source, of_object, &wanted, &mut batch);
            }
        }
        self.draw_batch(batch);
    }

    /// Appends some patches of an object to a batch, in order of their numbers. The groups around
    /// them are drawn in parts from now on, and the patches in them not again: no two patches drawn
    /// in a run have triangles in common.
    fn collect_some(
        &mut self,
        source: &Source<'a>,
        patches: &[(Slot, PatchIndex)],
        wanted: &impl Fn(&Self, &Block) -> bool,
        batch: &mut Batch<'a>,
    ) {
        let (surface, base) = (source.surface, source.place.base);
        let mut at = PatchIndex::FIRST;
        for &(_, patch) in patches {
            // Groups come before their parts: those that end before the patch are passed by, the
            // others contain it.
            while at < patch && at.index() < surface.patch_count() {
                let next = surface.next(at);
                if next > patch {
                    self.went_into(base.of(at));
                }
                at = if next > patch { at.after() } else { next };
            }
            if patch.index() >= surface.patch_count() || at != patch {
                continue;
            }
            at = surface.next(patch);
            let block = source.block(patch);
            if !self.scratch.buffers.surfaces().has_drawn(base.of(patch)) && wanted(self, &block) {
                self.collect_patch(source, patch, &block, Role::Fresh, batch);
            }
        }
    }

    /// Notes where faces see the patches of a batch that was drawn, and which of them hid more than
    /// before.
    pub(super) fn drew_batch(&mut self, batch: &Batch) {
        if !self.run.coherent {
            return;
        }
        let coherence = &mut self.scratch.coherence;
        let id = |index: u32| batch.drawables[index as usize].id;
        coherence.changed.resize(self.scratch.patches.len(), false);
        for &index in self.scratch.buffers.useful_patches() {
            coherence.changed[id(index) as usize] = true;
        }
        coherence
            .sights
            .extend(batch.sights.iter().map(|sight| Sighting { patch: id(sight.patch), ..*sight }));
    }

    /// Draws the occluders that wait before some boxes. Returns whether there are any.
    pub(crate) fn draw_before(&mut self, blocks: &[Block]) -> bool {
        if !self.scratch.coherence.has_waiting() {
            return false;
        }
        let buffers = &self.scratch.buffers;
        let mut tiles: Vec<Vec<f32>> = vec![Vec::new(); buffers.faces().count()];
        for block in blocks {
            let relative = buffers.relative(block);
            for (buffer, tiles) in buffers.faces().zip(&mut tiles) {
                let Some((near, pixels)) = buffer.sight(&relative) else { continue };
                let window = buffer.window();
                let (nx, ny) = window.tile_count();
                tiles.resize((nx * ny) as usize, f32::INFINITY);
                for_tiles(&pixels, |tx, ty| {
                    let tile = &mut tiles[window.tile_index(tx, ty)];
                    *tile = tile.min(near);
                    false
                });
            }
        }
        let before = (self.scratch.coherence.drawn_solids.len(), self.scratch.patches.len());
        let mut solids = std::mem::take(&mut self.scratch.coherence.waiting_solids);
        solids.retain(|&slot| {
            let block = self.run.scene.object(slot).occluder().map(|occluder| occluder.block());
            let draws = block.is_some_and(|block| self.is_before(&block, &tiles));
            if draws {
                self.draw(slot);
            }
            !draws
        });
        self.scratch.coherence.waiting_solids = solids;
        self.draw_patches();
        let mut patches = std::mem::take(&mut self.scratch.coherence.waiting_patches);
        self.draw_patches_of(&mut patches, |walk, block| walk.is_before(block, &tiles));
        self.scratch.coherence.waiting_patches = patches;
        before != (self.scratch.coherence.drawn_solids.len(), self.scratch.patches.len())
    }

    /// Whether a box in world units touches a tile with an object that is nowhere nearer than a
    /// nearness, and the box is.
    fn is_before(&self, world: &Block, tiles: &[Vec<f32>]) -> bool {
        let buffers = &self.scratch.buffers;
        let block = buffers.relative(world);
        let faces = buffers.faces().zip(tiles);
        faces.filter(|(_, tiles)| !tiles.is_empty()).any(|(buffer, tiles)| {
            let Some((near, pixels)) = buffer.sight(&block) else { return false };
            for_tiles(&pixels, |tx, ty| tiles[buffer.window().tile_index(tx, ty)] < near)
        })
    }

    /// Keeps for the next run which objects were found visible, and which occluders were of use:
    /// `used` in magnified pixels.
    pub(crate) fn remember(&mut self, visible: &[ObjectId], used: &UsedFinely) {
        let mut coherence = std::mem::take(&mut self.scratch.coherence);
        let run = coherence.run;
        coherence.view = Some(self.run.view.clone());
        visible.iter().for_each(|id| coherence.seen[id.index()] = run);
        let usage = |useful: bool| Recall { run, usage: if useful { Usage::Useful } else { Usage::Idle } };
        for &slot in &coherence.waiting_solids {
            coherence.solids[slot.index()] = usage(false);
        }
        for &(slot, changed) in &coherence.drawn_solids {
            let block = self.run.scene.object(slot).occluder().map(|occluder| occluder.block());
            let useful = changed && block.is_some_and(|block| !self.hides(&block));
            coherence.solids[slot.index()] = usage(useful);
        }
        for &slot in &used.solids {
            coherence.solids[slot.index()] = usage(true);
        }
        coherence.useful_solids.clear();
        let solids = &coherence.solids;
        let is_useful = |slot: &Slot| solids[slot.index()].usage == Usage::Useful;
        coherence.useful_solids.extend(coherence.drawn_solids.iter().map(|drawn| drawn.0).filter(is_useful));
        self.remember_patches(&mut coherence, used, usage);
        self.scratch.coherence = coherence;
    }

    fn remember_patches(&self, coherence: &mut Coherence, used: &UsedFinely, usage: impl Fn(bool) -> Recall) {
        let scene = self.run.scene;
        let numbers = |slot: Slot, patch: PatchIndex| {
            let place = scene.seams().place(slot);
            let next = Source::of(self.run.scene, slot).map_or(patch.after(), |s| s.surface.next(patch));
            place.base.of(patch)..place.base.of(next)
        };
        let mut open = vec![false; coherence.changed.len()];
        let faces: Vec<_> = self.scratch.buffers.faces().collect();
        for sight in &coherence.sights {
            let is_open = &mut open[sight.patch as usize];
            if coherence.changed[sight.patch as usize] && !*is_open {
                *is_open = !faces[sight.face as usize].hides_pixels(&sight.pixels, sight.near);
            }
        }
        for &id in &used.patches {
            open[id as usize] = true;
        }
        for &(slot, patch) in &coherence.waiting_patches {
            coherence.patches.fill(numbers(slot, patch), usage(false));
        }
        coherence.useful_patches.clear();
        for (&(slot, patch), useful) in self.scratch.patches.iter().zip(open) {
            coherence.patches.fill(numbers(slot, patch), usage(useful));
            if useful {
                coherence.useful_patches.push((slot, patch));
            }
        }
    }
}

/// Calls `found` with the tiles of some pixels until that returns true. Returns whether it did.
fn for_tiles(pixels: &PixelRect, mut found: impl FnMut(i64, i64) -> bool) -> bool {
    let ((x0, x1), (y0, y1)) = (pixels.tiles_x(), pixels.tiles_y());
    (y0..=y1).any(|ty| (x0..=x1).any(|tx| found(tx, ty)))
}
