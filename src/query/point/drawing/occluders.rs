//! Drawing convex occluders.

use casca_slots::Slot;

use crate::geometry::Block;
use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::numeric::shape::REGION;
use crate::object::Occluder;
use crate::query::point::drawing::Drawing;
use crate::query::point::drawing::recall::Role;

/// Occluders are drawn from this radius on, in pixels. Smaller ones cover no pixel, and in finer
/// pixels they hide too little for the time that they take: scenes of thousands lose less than one
/// object of a thousand.
const SMALLEST_OCCLUDER: f64 = 0.35;

/// A mesh is drawn in patches, too, if its radius exceeds that of the solid inside it by more
/// pixels than this. Narrower gaps hide less than the pixels that the outlines of patches touch.
const MOST_GAP: f64 = 3.0;

/// Meshes of which shells are drawn are drawn in patches, too, from this radius on, in pixels:
/// patches hide what lies inside of shells.
const SHELLS_ALONE: f64 = 32.0;

impl Drawing<'_> {
    /// Draws the occluder of an object in sight, unless it waits.
    pub(crate) fn offer(&mut self, slot: Slot) {
        self.note_offered(slot);
        let role = if self.run.coherent { self.scratch.coherence.solid(slot) } else { Role::Fresh };
        match role {
            Role::Fresh | Role::InParts => self.draw(slot),
            Role::Waits if self.has_patches_beside_solid(slot) => self.list_surface(slot),
            Role::Waits | Role::Drawn => {}
        }
    }

    /// Notes for a result that is kept that it may rest on the occluder of an object.
    pub(super) fn note_offered(&mut self, slot: Slot) {
        if self.run.fixed_only {
            self.scratch.offered.0.push(slot);
        }
    }

    /// Notes that a solid was drawn, and whether it hid more than before.
    fn drew_solid(&mut self, slot: Slot, changed: bool) {
        if changed {
            self.stats.occluders_useful += u32::from(self.scratch.useful.decide(slot));
        }
        if self.run.coherent {
            self.scratch.coherence.drew_solid(slot, changed);
        }
    }

    /// Draws the occluder of an object, or lists its surface for drawing.
    pub(crate) fn draw(&mut self, slot: Slot) {
        if !self.run.view.is_ordered() {
            return;
        }
        let Some(occluder) = self.run.scene.object(slot).occluder() else { return };
        if self.scratch.is_small(&self.scratch.buffers.relative(&occluder.block()), SMALLEST_OCCLUDER) {
            self.stats.occluders_skipped += 1;
            return;
        }
        if occluder.surface().is_some() {
            self.stats.occluders_drawn += 1;
            let done = self.draw_convex_mesh(slot, occluder)
                || self.draw_inner_solid(slot, occluder)
                || self.draw_shells(slot, occluder);
            if !done {
                self.list_surface(slot);
            }
            return;
        }
        if self.starts_near(&occluder.block()) && self.starts.may_be_in(self.run.view, occluder) {
            self.stats.eye_in_occluder = true;
            return;
        }
        let buffers = &mut self.scratch.buffers;
        let body = occluder.kind().inner(buffers.origin(), buffers.uncertainty());
        if let Some(changed) = body.and_then(|body| buffers.draw_body(&body, slot)) {
            self.stats.occluders_drawn += 1;
            self.drew_solid(slot, changed);
        }
    }

    /// Whether a box reaches the places where rays start; in doubt, yes.
    fn starts_near(&self, block: &Block) -> bool {
        self.around_starts.as_ref().is_none_or(|around| around.may_meet(block))
    }

    /// Draws a convex mesh as one solid, if the eye is known and rays start outside of it. Returns
    /// whether it did.
    fn draw_convex_mesh(&mut self, slot: Slot, occluder: &Occluder) -> bool {
        let buffers = &mut self.scratch.buffers;
        let origin = buffers.origin();
        if buffers.uncertainty() > 0.0 {
            return false;
        }
        let Some((part, beyond)) = occluder.convex_mesh(origin) else { return false };
        // Outside of the mesh, too: between it and the solid one sees into the mesh.
        let outside = |block: &Block| {
            let (middle, half) = ((block.min + block.max) * 0.5 - origin, (block.max - block.min) * 0.5);
            let room = REGION * (1.0 + block.min.abs().max(block.max.abs()).max_element());
            let clear = |f: HalfSpace| f.beyond(middle) - f.normal.abs().dot(half) > beyond + room;
            part.faces().any(clear)
        };
        let starts_outside = match buffers.direction() {
            Some(d) => !self.run.view.cuts_front(d, &occluder.block()),
            None => {
                let half = buffers.room().half();
                outside(&Block { min: origin - half, max: origin + half })
            }
        };
        if !(starts_outside && self.starts.cut().iter().all(|(_, region)| outside(region))) {
            return false;
        }
        let Some(changed) = buffers.draw_body(&Body::Part(part), slot) else { return false };
        self.drew_solid(slot, changed);
        true
    }

    /// Draws the solid inside a closed mesh, if the eye is known and rays start outside of the box
    /// around the mesh. Returns whether it covers nearly the same pixels, so that the triangles
    /// need not be drawn. Larger solids are drawn beside the triangles: they close pixels that
    /// outlines of patches touch, and hide some of those patches.
    fn draw_inner_solid(&mut self, slot: Slot, occluder: &Occluder) -> bool {
        let Some(inner) = occluder.inner() else { return false };
        let block = occluder.block();
        let buffers = &self.scratch.buffers;
        if buffers.uncertainty() > 0.0 || self.starts_near(&block) {
            return false;
        }
        let is_alike = self.is_like_solids(&block, inner.gap, f64::INFINITY);
        let buffers = &mut self.scratch.buffers;
        let part = occluder.inner_from(buffers.origin());
        let Some(changed) = part.and_then(|part| buffers.draw_body(&Body::Part(part), slot)) else {
            return false;
        };
        self.drew_solid(slot, changed);
        is_alike
    }

    /// Draws the solids inside pieces of a mesh that are open on one side, if the eye is known and
    /// rays start outside of the box around the mesh. Returns whether the mesh is so small that its
    /// patches need not be drawn beside them.
    fn draw_shells(&mut self, slot: Slot, occluder: &Occluder) -> bool {
        let Some(gap) = occluder.beside_shells() else { return false };
        let block = occluder.block();
        if self.scratch.buffers.uncertainty() > 0.0 || self.starts_near(&block) {
            return false;
        }
        let buffers = &mut self.scratch.buffers;
        let mut changed = false;
        occluder.shells(buffers.origin(), &mut |part, beyond| {
            changed |= buffers.draw_shell(part, beyond, slot) == Some(true);
        });
        self.drew_solid(slot, changed);
        self.is_like_solids(&block, gap, SHELLS_ALONE)
    }

    /// Whether a mesh covers nearly the same pixels as the solids inside it, by the box of the mesh
    /// and the width of the gap between them, and is smaller than some pixels.
    fn is_like_solids(&self, block: &Block, gap: f64, pixels: f64) -> bool {
        self.scratch.is_small(&self.scratch.buffers.relative(block), (MOST_GAP / gap).min(pixels))
    }

    /// Whether an object is drawn as a solid and, beside it, as patches.
    fn has_patches_beside_solid(&self, slot: Slot) -> bool {
        let Some(occluder) = self.run.scene.object(slot).occluder() else { return false };
        occluder
            .inner()
            .is_some_and(|inner| !self.is_like_solids(&occluder.block(), inner.gap, f64::INFINITY))
            || occluder
                .beside_shells()
                .is_some_and(|gap| !self.is_like_solids(&occluder.block(), gap, SHELLS_ALONE))
    }
}
