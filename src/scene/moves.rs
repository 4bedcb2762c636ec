//! Reports of moves that change no matrix: see [`crate::scene::rooms`].

use glam::Vec3A;

use crate::geometry::{Block, Sphere};
use crate::id::ObjectId;
use crate::numeric::scene::BOX_OF_SPHERE;
use crate::object::Bounds;
use crate::scene::Scene;
use crate::scene::rooms::BrickBox;

/// A box around bounds, where their kind tells it in a few operations. For bounds that are refused
/// there is none, or its corners are not finite or in the wrong order.
#[inline]
fn quick_box(bounds: &Bounds) -> Option<(Vec3A, Vec3A)> {
    match *bounds {
        Bounds::Box(b) => Some((b.min.into(), b.max.into())),
        Bounds::Sphere(Sphere { center, radius }) if radius >= 0.0 => {
            let center = Vec3A::from(center);
            let grow = (center.abs().max_element() + radius) * BOX_OF_SPHERE + f32::MIN_POSITIVE;
            let half = Vec3A::splat(radius + grow);
            Some((center - half, center + half))
        }
        _ => None,
    }
}

/// Takes over bounds of the kinds that have a quick box; whether they are others than before.
#[inline]
fn replace(bounds: &mut Bounds, new: &Bounds) -> bool {
    match (&mut *bounds, new) {
        (Bounds::Sphere(old), Bounds::Sphere(new)) => std::mem::replace(old, *new) != *new,
        (Bounds::Box(old), Bounds::Box(new)) => std::mem::replace(old, *new) != *new,
        _ => {
            *bounds = new.clone();
            true
        }
    }
}

impl Scene {
    /// Moves an object that hides nothing inside its room; false, without a change, if it is in
    /// none, would leave it, or has bounds that are to be checked.
    #[inline]
    pub(super) fn move_in_room(&mut self, id: ObjectId, bounds: &Bounds) -> bool {
        let Some((min, max)) = quick_box(bounds) else { return false };
        if !self.rooms.hold(id.0, min, max) || self.ids.is_by_cell() {
            return false;
        }
        let object = &mut self.slots[id.slot()];
        if object.placed.is_some() {
            return false;
        }
        object.reported(self.now);
        if replace(&mut object.bounds, bounds) {
            object.moved = self.changes.moved();
            // Where it is in its volume tells a result nothing.
            if !object.is_hidden() {
                self.changes.changed();
                self.quick.replace(id.slot(), min, max);
            }
        }
        true
    }

    /// Moves an object that is listed by bricks to others; false, without a change, for other
    /// objects, and for bounds that are to be checked or may not be listed by bricks.
    #[inline(never)]
    pub(super) fn move_to_room(&mut self, id: ObjectId, bounds: &Bounds) -> bool {
        let Some((lower, upper)) = quick_box(bounds) else { return false };
        let Some(object) = self.slots.find(id.0) else { return false };
        let Some(old) = object.listed_in else { return false };
        // Numbers that are not finite are in no grid.
        let (min, max) = (lower.as_dvec3(), upper.as_dvec3());
        let new = BrickBox::around(&self.grid, &Block { min, max }).filter(|_| min.cmple(max).all());
        let Some(new) = new.filter(|_| !self.ids.is_by_cell()) else { return false };
        // The same bounds again are no change, also where a corner lies on the side of a room.
        if object.placed.is_some() || object.is_unlocated() || object.bounds.same(bounds) {
            return false;
        }
        self.exchange_bricks(id.slot(), old, new);
        self.quick.replace(id.slot(), lower, upper);
        let object = &mut self.slots[id.slot()];
        object.reported(self.now);
        object.moved = self.changes.moved();
        self.changes.changed();
        object.bounds = bounds.clone();
        true
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::random::Random;

    #[test]
    fn the_quick_box_contains_the_sphere() {
        let mut random = Random(5);
        let check = |center: Vec3, radius: f32| {
            let bounds = Bounds::from(Sphere::new(center, radius));
            let (block, (min, max)) = (bounds.block(), quick_box(&bounds).unwrap());
            assert!(min.as_dvec3().cmple(block.min).all(), "{center} {radius}");
            assert!(max.as_dvec3().cmpge(block.max).all(), "{center} {radius}");
            let off = (block.min - min.as_dvec3()).max(max.as_dvec3() - block.max).max_element();
            let size = f64::from(center.abs().max_element() + radius);
            assert!(off <= 5e-7 * size + 2.0 * f64::from(f32::MIN_POSITIVE), "{center} {radius} {off}");
        };
        for i in 0..2000 {
            let size = 10f64.powi(i % 20 - 10);
            check((random.point(size)).as_vec3(), (random.next().abs() * size * 2.0) as f32);
            check((random.point(size)).as_vec3(), (random.next().abs() * size * 1e-7) as f32);
        }
        check(Vec3::splat(1e-45), 1e-45);
        check(Vec3::splat(f32::MIN_POSITIVE), f32::MIN_POSITIVE);
    }
}
