//! Finding objects: those in sight of the view are listed, each once, and tested front to back.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::id::ObjectId;
use crate::pvs::Pvs;
use crate::query::marks::Marks;
use crate::query::point::decide::Candidate;
use crate::query::point::drawing::Drawing;
use crate::query::point::run::Run;

/// Finds the objects of a run: owns the set, the marks of decided objects, the lists of those
/// found, and what their occluders are drawn with.
pub(super) struct ObjectFinder<'a> {
    pub(super) drawing: Drawing<'a>,
    pub(super) pvs: &'a mut Pvs,
    pub(super) marks: &'a mut Marks,
    pub(super) found: &'a mut FoundObjects,
}

/// The objects found in a run, in memory that is used again.
#[derive(Debug, Clone, Default)]
pub(super) struct FoundObjects {
    /// Objects that are yet to be tested.
    listed: Vec<Candidate>,
    /// Numbers that sort them by distance, with the place of each.
    order: Vec<u128>,
    /// Objects found visible so far.
    pub(super) candidates: Vec<Candidate>,
    /// Small moving objects before all that was drawn, which need no test.
    pub(super) in_the_open: Vec<ObjectId>,
}

/// A number that sorts objects by distance and then by slot, with a place as its lowest part. Whole
/// numbers are compared without branches.
fn sort_key(distance: f64, slot: Slot, place: u32) -> u128 {
    let bits = distance.to_bits();
    // The bits of negative numbers run the other way.
    let order = if bits >> 63 == 0 { bits | 1 << 63 } else { !bits };
    u128::from(order) << 64 | u128::from(slot.get()) << 32 | u128::from(place)
}

impl<'a> ObjectFinder<'a> {
    /// Nothing is found yet.
    pub(super) fn new(
        drawing: Drawing<'a>,
        pvs: &'a mut Pvs,
        marks: &'a mut Marks,
        found: &'a mut FoundObjects,
    ) -> Self {
        marks.begin(drawing.run.scene.slot_count());
        found.candidates.clear();
        found.in_the_open.clear();
        Self { drawing, pvs, marks, found }
    }

    /// Lists an object for testing, once in a query: its brick, zone or volume is in sight.
    pub(super) fn find(&mut self, slot: Slot) {
        if !self.marks.decide(slot) {
            return;
        }
        let Run { scene, view, fixed_only, .. } = self.drawing.run;
        let own = *scene.boxes().of(slot);
        let candidate = if own.is_static() {
            // The box tells all.
            debug_assert!(scene.is_up_to_date(slot), "the box of {slot} is old");
            if !own.is_shown(view) && !scene.object(slot).is_shown(view) {
                return;
            }
            self.drawing.stats.objects_tested += 1;
            let block = own.block();
            if !view.may_see_volume(&block) || !own.is_box() && !view.may_see(scene.object(slot).bounds()) {
                return;
            }
            let (is_centered, occludes) = (own.is_centered(), own.occludes());
            Candidate { slot, block: Some(block), is_centered, occludes }
        } else {
            let object = scene.object(slot);
            if fixed_only && !object.is_static() || !object.is_shown(view) {
                return;
            }
            if scene.is_unlocated(slot) || object.is_hidden_unreported() {
                // It may be anywhere: visible, whatever its old bounds say.
                let anywhere = Candidate { slot, block: None, is_centered: false, occludes: false };
                self.found.candidates.push(anywhere);
                return;
            }
            self.drawing.stats.objects_tested += 1;
            let bounds = object.bounds();
            if !view.may_see(bounds) {
                return;
            }
            let (is_centered, occludes) = (bounds.kind().is_centered(), object.occluder().is_some());
            Candidate { slot, block: Some(bounds.block()), is_centered, occludes }
        };
        let distance = candidate.block.map_or(f64::NEG_INFINITY, |block| self.distance(&block));
        self.found.order.push(sort_key(distance, slot, self.found.listed.len() as u32));
        self.found.listed.push(candidate);
    }

    /// A number by which boxes are sorted from front to back.
    pub(super) fn distance(&self, block: &Block) -> f64 {
        match self.drawing.buffers().direction() {
            Some(direction) => ((block.min + block.max) * 0.5).dot(direction),
            None => {
                let eye = self.drawing.buffers().origin();
                (block.min - eye).max(eye - block.max).max(DVec3::ZERO).length_squared()
            }
        }
    }

    /// Tests the listed objects, front to back, and draws the occluders of those that may be seen.
    /// Returns whether any was listed.
    pub(super) fn settle(&mut self) -> bool {
        let Self { drawing, found: FoundObjects { listed, order, candidates, .. }, .. } = self;
        order.sort_unstable();
        for place in order.drain(..).map(|key| key as u32) {
            drawing.stats.occlusion_tests += 1;
            let candidate = listed[place as usize];
            if candidate.block.is_some_and(|block| drawing.hides(&block)) {
                continue;
            }
            candidates.push(candidate);
            if candidate.occludes {
                drawing.offer(candidate.slot);
            }
        }
        let any = !listed.is_empty();
        listed.clear();
        any
    }

    /// Finds the object in a temporal bounding volume, if that is in sight.
    pub(super) fn test_volume(&mut self, slot: Slot) {
        let Run { scene, fixed_only, .. } = self.drawing.run;
        if !fixed_only && !self.marks.is_revealed(slot) && self.drawing.sees_volume(&scene.volume_block(slot))
        {
            self.reveal(slot);
        }
    }

    /// Marks the volume of an object as revealed, and finds the object.
    pub(super) fn reveal(&mut self, slot: Slot) {
        let Run { scene, view, .. } = self.drawing.run;
        if self.marks.reveal(slot) && scene.object(slot).is_shown(view) {
            self.drawing.stats.tbvs_revealed += 1;
            self.pvs.revealed.push(scene.id(slot));
            self.find(slot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_sort_by_distance_and_then_by_slot() {
        let objects = [(-3.0, 9), (-1.0, 1), (0.0, 4), (0.0, 5), (1e-9, 0), (2.0, 7), (f64::INFINITY, 2)];
        let keys = objects.map(|(distance, slot)| sort_key(distance, Slot::new(slot), 9 - slot));
        assert!(keys.is_sorted());
        assert_eq!(keys.map(|key| key as u32), objects.map(|(_, slot)| 9 - slot));
    }
}
