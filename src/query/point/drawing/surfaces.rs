//! Drawing surfaces of triangles, patch by patch.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::mesh::surface::{PatchIndex, PatchNumber};
use crate::occlusion::surface::batch::Batch;
use crate::occlusion::surface::drawable::Drawable;
use crate::query::point::drawing::drawables::Source;
use crate::query::point::drawing::recall::{Recall, Role, Usage};
use crate::query::point::drawing::{Drawing, DrawingScratch};

/// A group is drawn as one if its slab is at most this share as thick as the eye is away from it,
/// or all of it that share as large as its distance.
const THIN: f64 = 0.35;

/// How the walk goes on with a patch.
pub(super) enum AfterPatch {
    /// Drawn, or of no use: its parts are not looked at.
    Done,
    /// Its parts are looked at, one by one.
    Parts,
}

impl<'a> Drawing<'a> {
    /// Notes that the parts of a group were looked at.
    pub(super) fn went_into(&mut self, number: PatchNumber) {
        if self.run.coherent {
            let coherence = &mut self.scratch.coherence;
            let recall = Recall { run: coherence.run, usage: Usage::Parts };
            coherence.patches.fill(number..number.after(), recall);
        }
    }

    /// Lists an object's surface for drawing.
    pub(super) fn list_surface(&mut self, slot: Slot) {
        self.scratch.waiting.push(slot);
    }

    /// Draws the surfaces that were listed, together.
    pub(crate) fn draw_patches(&mut self) {
        if self.scratch.waiting.is_empty() {
            return;
        }
        let mut batch = std::mem::take(&mut self.scratch.batch).emptied();
        let mut waiting = std::mem::take(&mut self.scratch.waiting);
        waiting.drain(..).for_each(|slot| self.collect(slot, &mut batch));
        self.scratch.waiting = waiting;
        self.draw_batch(batch);
    }

    /// Draws patches together.
    pub(super) fn draw_batch(&mut self, batch: Batch<'a>) {
        if batch.drawables.is_empty() {
            self.scratch.batch = batch.emptied();
            return;
        }
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
            let slot = patches[batch.drawables[index as usize].id as usize].0;
            self.stats.occluders_useful += u32::from(useful.decide(slot));
        }
    }

    /// Appends the surface of an object to a batch, in patches and groups of them, without those
    /// that are small or hidden.
    fn collect(&mut self, slot: Slot, batch: &mut Batch<'a>) {
        let Some(source) = Source::of(self.run.scene, slot) else { return };
        let surface = source.surface;
        let mut number = PatchIndex::FIRST;
        // Groups come before their parts.
        while number.index() < surface.patch_count() {
            let scratch = &mut *self.scratch;
            let in_scene = source.place.base.of(number);
            let role = if !self.run.coherent {
                Role::Fresh
            } else if scratch.buffers.surfaces().has_drawn(in_scene) {
                Role::Drawn
            } else {
                scratch.coherence.patch(slot, number, in_scene)
            };
            if matches!(role, Role::Drawn | Role::Waits) {
                number = surface.next(number);
                continue;
            }
            number = match self.collect_patch(&source, number, &source.block(number), role, batch) {
                AfterPatch::Done => surface.next(number),
                AfterPatch::Parts => {
                    self.went_into(in_scene);
                    number.after()
                }
            };
        }
    }

    /// Appends a patch in a box to a batch, if it is to be drawn as one.
    pub(super) fn collect_patch(
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
}
