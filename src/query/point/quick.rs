//! Small moving objects, of which there may be very many in sight.
//!
//! They hide nothing, so that nothing is gained by testing them before all occluders are drawn:
//! they are collected brick by brick and decided with the other objects in the end. Inside the
//! frustum, most are found visible by one pixel: that of the middle of their box, which lies in
//! them. None of that looks at the object itself, only at its entry in the array of boxes
//! ([`QuickBoxes`](crate::scene::QuickBoxes)).

use casca_slots::{Id, Slot};
use glam::{DVec3, IVec3};

use crate::geometry::Block;
use crate::id::ObjectId;
use crate::occlusion::examine::Budget;
use crate::query::point::Walk;
use crate::query::point::scratch::Candidate;

/// A small moving object whose brick is in sight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mover {
    id: Id,
    /// How many other candidates were found before.
    after: u32,
    /// The middle of its box. Rounding may take it out of the object by as much as single precision
    /// tells: a point that is seen only leaves an object in the set.
    middle: [f32; 3],
}

impl Mover {
    /// Whether it was found before another candidate of such a place.
    pub(super) fn is_before(&self, place: usize) -> bool {
        self.after as usize <= place
    }
}

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
    fn border(&self, brick: IVec3) -> Option<Border> {
        let around = Block::new(self.grid.range_bounds(brick - 1, brick + 1));
        let is_near =
            self.view.eye().is_some_and(|eye| around.grown(self.view.eye_room()).contains_point(eye));
        let inside = self.view.planes.iter().all(|plane| around.is_inside(plane));
        (!is_near).then_some(if inside { Border::Inside } else { Border::Crosses })
    }

    /// Adds a small moving object to the set, unless it is hidden.
    #[inline]
    pub(super) fn decide_mover(&mut self, mover: &Mover, left: &mut Budget) {
        let id = ObjectId(mover.id);
        let buffers = &self.scratch.buffers;
        if buffers.is_clear(DVec3::from_array(mover.middle.map(f64::from)) - buffers.origin()) {
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
