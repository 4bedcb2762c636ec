//! Small moving objects, of which there may be very many in sight.
//!
//! They hide nothing, so that nothing is gained by testing them before all occluders are drawn:
//! they are collected brick by brick and decided with the other objects in the end. Inside the
//! frustum, most are found visible by one pixel: that of the middle of their box, which lies in
//! them. None of that looks at the object itself, only at its entry in the array of boxes
//! ([`QuickBoxes`](crate::scene::QuickBoxes)).

use casca_slots::Slot;
use glam::{IVec3, Vec3A};

use crate::query::point::Walk;
use crate::query::point::mover::{Frustum, Mover};
use crate::query::point::scratch::{Candidate, PointScratch};

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

    /// Puts those small moving objects among the other candidates, in the order in which all were
    /// found, that may lie behind an occluder. The others stay, and are visible.
    pub(super) fn sort_movers(&mut self, candidates: &mut Vec<Candidate>) {
        let PointScratch { buffers, movers, sorted, .. } = &mut *self.scratch;
        if movers.is_empty() {
            return;
        }
        buffers.read_clear();
        let (scene, origin) = (self.scene, buffers.origin().as_vec3a());
        let (mut others, mut taken) = (candidates.drain(..), 0);
        sorted.clear();
        movers.retain_mut(|mover| {
            while taken < mover.after {
                sorted.extend(others.next());
                taken += 1;
            }
            let clear = buffers.is_clear(Vec3A::from_array(mover.middle) - origin);
            if clear {
                mover.after = sorted.len() as u32;
            } else {
                let block = Some(scene.object(mover.id.slot()).bounds().block());
                sorted.push(Candidate { id: mover.id(), block, is_centered: true, occludes: false });
            }
            clear
        });
        sorted.extend(others);
        std::mem::swap(candidates, sorted);
        self.stats.occlusion_tests += movers.len() as u32;
    }
}
