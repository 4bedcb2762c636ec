//! Drawing surfaces of triangles, patch by patch.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::mesh::surface::{PatchIndex, PatchNumber};
use crate::occlusion::surface::batch::Batch;
use crate::occlusion::surface::drawable::Drawable;
use crate::query::point::drawing::drawables::Source;
use crate::query::point::drawing::recall::{Recall, Role, Usage};
use crate::query::point::drawing::{Drawing, DrawingScratch, DrawnPatch, Waiting};

/// A group is drawn as one if its slab is at most this share as thick as the eye is away from it,
/// or all of it that share as large as its distance.
const THIN: f64 = 0.35;

/// If the eye may go some way, a batch has at least as many patches as were drawn before, divided
/// by this, except at the end of the walk: so the number of batches grows like the logarithm of
/// that of patches.
const BATCH_SHARE: u64 = 3;

/// How the walk goes on with a patch.
enum AfterPatch {
    /// Drawn, or of no use: its parts are not looked at.
    Done,
    /// Its parts are looked at, one by one.
    Parts,
}

impl<'a> Drawing<'a> {
    /// A patch of an object's surface ready to be drawn, if it can be.
    pub(super) fn drawable(&self, slot: Slot, patch: PatchIndex) -> Option<Drawable<'a>> {
        let source = Source::of(self.run.scene, slot)?;
        source.drawable(patch, &source.block(patch), (self.run.view, &self.starts), self.buffers())
    }

    /// Notes that the parts of a group were looked at.
    pub(super) fn went_into(&mut self, number: PatchNumber) {
        if self.run.coherent {
            let coherence = &mut self.scratch.coherence;
            let recall = Recall { run: coherence.run, usage: Usage::Parts };
            coherence.patches.fill(number..number.after(), recall);
        }
    }

    /// Lists an object's surface for drawing, by the shell that it begins in.
    pub(super) fn list_surface(&mut self, slot: Slot) {
        let all = PatchIndex::FIRST;
        if let Some(source) = Source::of(self.run.scene, slot)
            && source.surface.patch_count() > 0
        {
            self.wait(self.shell_of(&source.block(all)), slot, all, source.surface.next(all).get());
        }
    }

    /// Lists a patch for drawing, or for drawing in parts, once shell `shell` is reached. `count`
    /// is the number of patches in it, with itself.
    fn wait(&mut self, shell: usize, slot: Slot, patch: PatchIndex, count: u32) {
        let waiting = &mut self.scratch.waiting;
        if waiting.len() <= shell {
            waiting.resize_with(shell + 1, Waiting::default);
        }
        waiting[shell].listed.push((slot, patch));
        waiting[shell].count += u64::from(count);
    }

    /// The shell of bricks around the eye that a box begins in.
    fn shell_of(&self, block: &Block) -> usize {
        self.around.as_ref().map_or(0, |shells| shells.begin_of(block))
    }

    /// Draws the visible parts of surfaces that begin up to shell `m`, together, unless they are
    /// too few for a batch: if the eye may go some way, a batch draws the neighbours of its patches
    /// again, as wholes.
    pub(crate) fn draw_patches(&mut self, m: i32) {
        let shells = &self.scratch.waiting[..self.waiting_up_to(m)];
        let enough = self.scratch.patches.len() as u64 / BATCH_SHARE;
        let few = || shells.iter().map(|shell| shell.count).sum::<u64>() < enough;
        if !(self.scratch.buffers.reach() > 0.0 && few()) {
            self.draw_all_patches(m);
        }
    }

    /// Draws the visible parts of all surfaces that begin up to shell `m`, also of those that a
    /// batch was not worth. Parts that begin beyond it wait; which ones does not depend on the
    /// shells that there is room for.
    pub(crate) fn draw_all_patches(&mut self, m: i32) {
        let last = self.waiting_up_to(m);
        if self.scratch.waiting[..last].iter().all(|shell| shell.listed.is_empty()) {
            return;
        }
        let mut batch = std::mem::take(&mut self.scratch.batch).emptied();
        self.scratch.batches += 1;
        for shell in 0..last {
            // Parts of those listed begin in the same shell or later.
            let mut at = 0;
            while let Some(&(slot, patch)) = self.scratch.waiting[shell].listed.get(at) {
                at += 1;
                self.collect(slot, patch, m.max(0) as usize, &mut batch);
            }
            self.scratch.waiting[shell].clear();
        }
        self.draw_batch(batch);
    }

    /// The number of shells up to `m` with room for patches that wait.
    fn waiting_up_to(&self, m: i32) -> usize {
        self.scratch.waiting.len().min(m.max(0) as usize + 1)
    }

    /// Draws patches together.
    pub(super) fn draw_batch(&mut self, mut batch: Batch<'a>) {
        if batch.drawables.is_empty() {
            self.scratch.batch = batch.emptied();
            return;
        }
        self.collect_neighbours(&mut batch);
        self.stats.patches_drawn += batch.drawables.len() as u32;
        let listed = self.run.options.refine_patches > 0;
        let (patches, shared) = (self.run.scene.seams().patches(), self.run.is_parallel());
        self.stats.patch_blocks += self.scratch.buffers.draw_surfaces(&batch, patches, listed, shared);
        self.count_useful(&batch);
        self.drew_batch(&batch);
        self.scratch.batch = batch.emptied();
    }

    /// Counts the objects with patches in a batch that hid more than before.
    fn count_useful(&mut self, batch: &Batch) {
        let DrawingScratch { buffers, patches, useful, .. } = &mut *self.scratch;
        for &index in buffers.useful_patches() {
            let drawable = &batch.drawables[index as usize];
            let owner = match drawable.again {
                true => self.run.scene.seams().owner(drawable.number),
                false => Some(patches[drawable.id as usize].0),
            };
            let Some(slot) = owner else { continue };
            self.stats.occluders_useful += u32::from(useful.decide(slot));
        }
    }

    /// Appends one patch to a batch, as one, unless it is small or hidden.
    pub(super) fn collect_alone(&mut self, source: &Source<'a>, patch: PatchIndex, batch: &mut Batch<'a>) {
        let first = batch.drawables.len();
        self.collect_patch(source, patch, &source.block(patch), Role::Fresh, batch);
        let drawn =
            DrawnPatch { epoch: self.scratch.useful.epoch(), batch: self.scratch.batches, whole: patch };
        for drawable in &batch.drawables[first..] {
            self.scratch.drawn.fill(drawable.numbers(), drawn);
        }
    }

    /// Appends a patch to a batch, as one or in parts, unless it is small or hidden. Parts that
    /// begin beyond shell `m` wait.
    fn collect(&mut self, slot: Slot, whole: PatchIndex, m: usize, batch: &mut Batch<'a>) {
        let Some(source) = Source::of(self.run.scene, slot) else { return };
        let surface = source.surface;
        let first = batch.drawables.len();
        let (mut number, mut waits) = (whole, false);
        // Groups come before their parts.
        while number < surface.next(whole) {
            let scratch = &mut *self.scratch;
            let in_scene = source.place.base.of(number);
            let role = if !self.run.coherent {
                Role::Fresh
            } else if scratch.drawn.get(in_scene).epoch == scratch.useful.epoch() {
                Role::Drawn
            } else {
                scratch.coherence.patch(slot, number, in_scene)
            };
            if matches!(role, Role::Drawn | Role::Waits) {
                number = surface.next(number);
                continue;
            }
            let world = source.block(number);
            let shell = if number == whole { 0 } else { self.shell_of(&world) };
            let next = if shell > m {
                self.wait(shell, slot, number, number.up_to(surface.next(number)));
                waits = true;
                AfterPatch::Done
            } else {
                self.collect_patch(&source, number, &world, role, batch)
            };
            number = match next {
                AfterPatch::Done => surface.next(number),
                AfterPatch::Parts => {
                    self.went_into(in_scene);
                    number.after()
                }
            };
        }
        // Only patches drawn in other batches look for their neighbours there.
        let alone =
            !self.run.coherent && whole == PatchIndex::FIRST && !waits && source.place.links.is_empty();
        let drawn = DrawnPatch {
            epoch: self.scratch.useful.epoch(),
            batch: self.scratch.batches,
            whole: PatchIndex::FIRST,
        };
        for drawable in &mut batch.drawables[first..] {
            drawable.alone = alone;
            if !alone {
                self.scratch.drawn.fill(drawable.numbers(), DrawnPatch { whole: drawable.patch, ..drawn });
            }
        }
    }

    /// Appends a patch in a box to a batch, if it is to be drawn as one.
    fn collect_patch(
        &mut self,
        source: &Source<'a>,
        number: PatchIndex,
        world: &Block,
        role: Role,
        batch: &mut Batch<'a>,
    ) -> AfterPatch {
        let has_parts = source.surface.next(number) > number.after();
        let block = self.scratch.buffers.relative(world);
        if self.scratch.is_small(&block, self.run.options.patch_radius.into()) {
            return AfterPatch::Done;
        }
        if !batch.see(&self.scratch.buffers, &block) {
            return AfterPatch::Done;
        }
        if has_parts && !self.run.view.may_see_block(world) {
            batch.drop_sights();
            return AfterPatch::Done;
        }
        if (role == Role::Fresh || !has_parts)
            && source.surface.has_outline(number)
            && let Some(mut drawable) =
                source.drawable(number, world, (self.run.view, &self.starts), self.buffers())
            && (!has_parts || self.is_thin(&drawable))
        {
            drawable.id = self.scratch.patches.len() as u32;
            self.scratch.patches.push((source.slot, number));
            batch.drawables.push(drawable);
            return AfterPatch::Done;
        }
        batch.drop_sights();
        if has_parts { AfterPatch::Parts } else { AfterPatch::Done }
    }

    /// Whether a group hides about as much as its parts do: its slab, or the whole of it, is thin
    /// compared to its distance.
    fn is_thin(&self, d: &Drawable) -> bool {
        let (lo, hi) = d.slab;
        let (thickness, height) = (hi - lo, lo.max(-hi));
        let across = (d.block.max - d.block.min).length();
        let distance = match self.scratch.buffers.direction() {
            Some(_) => self.bricks.cell_size(),
            None => d.block.min.max(-d.block.max).max(DVec3::ZERO).length(),
        };
        thickness <= THIN * height || across <= THIN * distance
    }

    /// Appends the neighbours of a batch that were drawn before, so that no seam stays between
    /// batches.
    fn collect_neighbours(&mut self, batch: &mut Batch<'a>) {
        let (epoch, number) = (self.scratch.useful.epoch(), self.scratch.batches);
        for i in 0..batch.drawables.len() {
            if batch.drawables[i].alone || batch.drawables[i].is_apart() {
                continue;
            }
            for twin in batch.drawables[i].twins() {
                let drawn = self.scratch.drawn.get(twin);
                if drawn.epoch != epoch || drawn.batch == number {
                    continue;
                }
                let owner = self.run.scene.seams().owner(twin);
                let whole = DrawnPatch { batch: number, ..drawn };
                let Some(again) = owner.and_then(|slot| self.drawable(slot, drawn.whole)) else {
                    self.scratch.drawn.fill(twin..twin.after(), whole);
                    continue;
                };
                self.scratch.drawn.fill(again.numbers(), whole);
                if let Some(id) = self.scratch.buffers.id_of_patch(again.number)
                    && batch.see(&self.scratch.buffers, &again.block)
                {
                    batch.drawables.push(Drawable { id, again: true, ..again });
                }
            }
        }
    }
}
