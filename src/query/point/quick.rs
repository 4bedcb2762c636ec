//! Small moving objects, of which there may be very many in sight.
//!
//! They hide nothing, so that nothing is gained by testing them before all occluders are drawn:
//! they are collected brick by brick and decided with the other objects in the end. Inside the
//! frustum, most are found visible by one pixel: that of the middle of their box, which lies in
//! them. None of that looks at the object itself, only at its entry in the array of boxes
//! ([`QuickBoxes`](crate::scene::QuickBoxes)).

use casca_slots::Slot;
use glam::{IVec3, Vec3A};

use crate::id::ObjectId;
use crate::occlusion::examine::Budget;
use crate::query::point::Walk;
use crate::query::point::mover::{Frustum, Mover};
use crate::query::point::scratch::Candidate;

/// What a brick tells of the frustum about the objects that are listed in it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Border {
    /// All of them are inside.
    Inside,
    /// They are compared with the frustum one by one.
    Crosses,
}

impl Walk<'_> {
    /// Takes the small moving objects out of those that were found in a brick, and lists those in
    /// the frustum to be decided.
    pub(super) fn find_movers(&mut self, brick: IVec3, open: &mut Vec<Slot>) {
        // A coherent run asks more of its objects.
        if self.coherent || self.fixed_only {
            return;
        }
        let scene = self.scene;
        let mut border = None;
        open.retain(|&slot| {
            let Some(quick) = scene.quick().get(slot) else { return true };
            let Some(border) = *border.get_or_insert_with(|| self.border(brick)) else { return true };
            self.marks.decide(slot);
            self.stats.objects_tested += 1;
            if border == Border::Inside || self.view.may_see(scene.object(slot).bounds()) {
                let after = self.scratch.candidates.len() as u32;
                let middle = quick.middle().as_vec3().to_array();
                self.scratch.movers.push(Mover { id: quick.id(slot), after, middle });
            }
            false
        });
    }

    /// Where the objects listed in a brick are: in it or in those beside it, since they may have
    /// moved by a brick since they were listed. `None` near the eye.
    #[inline]
    fn border(&self, brick: IVec3) -> Option<Border> {
        let Frustum { half, planes, near } = &self.scratch.frustum;
        let (min, max) = self.grid.cell_bounds(brick);
        let middle = (min + max) * 0.5;
        let is_near = self.view.eye().is_some_and(|eye| (middle - eye).abs().max_element() <= half + near);
        let inside = planes.iter().all(|(normal, least)| normal.dot(middle) >= *least);
        (!is_near).then_some(if inside { Border::Inside } else { Border::Crosses })
    }

    /// Adds a small moving object to the set, unless it is hidden.
    #[inline]
    pub(super) fn decide_mover(&mut self, mover: &Mover, left: &mut Budget) {
        let id = ObjectId(mover.id);
        let buffers = &self.scratch.buffers;
        if buffers.is_clear(Vec3A::from_array(mover.middle) - buffers.origin().as_vec3a()) {
            self.stats.occlusion_tests += 1;
            self.pvs.push(id);
            return;
        }
        let block = self.scene.object(id.slot()).bounds().block();
        let candidate = Candidate { id, block: Some(block), is_centered: true, occludes: false };
        if !self.examine(&candidate, left) {
            self.pvs.push(id);
        }
    }
}
