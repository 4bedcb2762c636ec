//! Reports of moves that change no matrix: see [`crate::scene::rooms`].

use glam::Vec3A;

use crate::geometry::Sphere;
use crate::id::ObjectId;
use crate::numeric::scene::BOX_OF_SPHERE;
use crate::object::Bounds;
use crate::scene::Scene;

/// A box around bounds, where their kind tells it in a few operations; corners that are not finite
/// or in the wrong order for bounds that are refused.
#[inline]
fn quick_box(bounds: &Bounds) -> Option<(Vec3A, Vec3A)> {
    match *bounds {
        Bounds::Box(b) => Some((b.min.into(), b.max.into())),
        Bounds::Sphere(Sphere { center, radius }) => {
            let (center, radius) = (Vec3A::from(center), Vec3A::splat(radius));
            let (min, max) = (center - radius, center + radius);
            Some((min - min.abs() * BOX_OF_SPHERE, max + max.abs() * BOX_OF_SPHERE))
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
        if object.on_expiry() {
            object.mover().into_iter().for_each(|mover| mover.reported = self.now);
        }
        if replace(&mut object.bounds, bounds) {
            object.moved = self.changes.moved();
            // Where it is in its volume tells a result nothing.
            if !object.is_hidden() {
                self.changes.changed();
            }
        }
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
            assert!(off <= 1e-6 * (block.min.abs().max(block.max.abs())).max_element());
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
