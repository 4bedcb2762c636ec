//! Testing objects for the first time.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::query::point::PointWalk;
use crate::query::point::decide::Candidate;
use crate::scene::ObjectBox;

/// A number that sorts objects by distance and then by slot, with a place as its lowest part. Whole
/// numbers are compared without branches.
fn sort_key(distance: f64, slot: Slot, place: u32) -> u128 {
    let bits = distance.to_bits();
    // The bits of negative numbers run the other way.
    let order = if bits >> 63 == 0 { bits | 1 << 63 } else { !bits };
    u128::from(order) << 64 | u128::from(slot.get()) << 32 | u128::from(place)
}

impl PointWalk<'_> {
    /// Lists an object for testing, once in a query: its brick or volume is in sight.
    pub(super) fn find(&mut self, slot: Slot) {
        if !self.marks.decide(slot) {
            return;
        }
        let own = *self.run.scene.boxes().of(slot);
        if own.is_static() { self.find_static(slot, &own) } else { self.find_asking(slot) }
    }

    /// Lists an object of which its box tells all.
    fn find_static(&mut self, slot: Slot, own: &ObjectBox) {
        let (scene, view) = (self.run.scene, self.run.view);
        debug_assert!(scene.is_up_to_date(slot), "the box of {slot} is old");
        if !own.is_shown(view) && !scene.object(slot).is_shown(view) {
            return;
        }
        self.drawing.stats.objects_tested += 1;
        let block = own.block();
        if view.may_see_volume(&block) && (own.is_box() || view.may_see(scene.object(slot).bounds())) {
            self.list_found(Candidate {
                slot,
                block: Some(block),
                is_centered: own.is_centered(),
                occludes: own.occludes(),
            });
        }
    }

    /// Lists an object that must be asked itself.
    fn find_asking(&mut self, slot: Slot) {
        let object = self.run.scene.object(slot);
        let passed_over = self.run.fixed_only && !object.is_static();
        if passed_over || !object.is_shown(self.run.view) {
            return;
        }
        if self.run.scene.is_unlocated(slot) || object.is_hidden_unreported() {
            // It may be anywhere: visible, whatever its old bounds say.
            let anywhere = Candidate { slot, block: None, is_centered: false, occludes: false };
            self.scratch.candidates.push(anywhere);
            return;
        }
        self.drawing.stats.objects_tested += 1;
        let bounds = object.bounds();
        if self.run.view.may_see(bounds) {
            self.list_found(Candidate {
                slot,
                block: Some(bounds.block()),
                is_centered: bounds.kind().is_centered(),
                occludes: object.occluder().is_some(),
            });
        }
    }

    /// Lists an object in the frustum, to be tested in its turn.
    fn list_found(&mut self, candidate: Candidate) {
        let distance = candidate.block.map_or(f64::NEG_INFINITY, |block| self.distance(&block));
        let place = self.scratch.objects.len() as u32;
        self.scratch.found.push(sort_key(distance, candidate.slot, place));
        self.scratch.objects.push(candidate);
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

    /// Tests the listed objects, front to back, and draws the occluders of those that may be seen:
    /// at once, or, where only some may be drawn, the largest of the shell first.
    pub(super) fn settle(&mut self) {
        let mut found = std::mem::take(&mut self.scratch.found);
        let limited = self.run.options.max_occluders < u32::MAX;
        let mut seen: Vec<(f64, Slot)> = Vec::new();
        found.sort_unstable();
        for place in found.drain(..).map(|key| key as u32) {
            self.drawing.stats.occlusion_tests += 1;
            let candidate = self.scratch.objects[place as usize];
            if !candidate.block.is_some_and(|block| self.drawing.hides(&block)) {
                let slot = candidate.slot;
                self.scratch.candidates.push(candidate);
                if !candidate.occludes {
                    continue;
                }
                if limited {
                    seen.push((self.drawing.solid_angle(slot), slot));
                } else {
                    self.drawing.offer(slot);
                }
            }
        }
        seen.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, slot) in seen {
            self.drawing.offer(slot);
        }
        self.scratch.found = found;
        self.scratch.objects.clear();
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
