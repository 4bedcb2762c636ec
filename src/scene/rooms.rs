//! Rooms: where a moving object may go without a change of any list or matrix.
//!
//! A moving object that hides nothing is listed in a zone or in bricks, or is in a temporal bounding
//! volume ([`crate::scene::home`]). While its box stays inside of that, a report changes nothing but
//! its bounds. Such a report is compared with the table of rooms alone, which has 32 bytes for each
//! object.

use casca_slots::{Id, Slot};
use glam::Vec3A;

use crate::geometry::block::{above, below};
use crate::geometry::{Block, Sphere};
use crate::numeric::scene::BOX_OF_SPHERE;
use crate::object::Bounds;

/// A box around bounds, where their kind tells it in a few operations. For bounds that are refused
/// there is none, or its corners are not finite or in the wrong order.
#[inline]
pub(super) fn quick_box(bounds: &Bounds) -> Option<(Vec3A, Vec3A)> {
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

/// Where one object may go. Closed rooms contain nothing.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct ObjectRoom {
    /// The least corner; not a number if the room is closed.
    min: [f32; 3],
    /// The rest of the id of the object that it is for.
    generation: u32,
    /// The greatest corner, which is not inside.
    max: [f32; 3],
    store: u32,
}

impl ObjectRoom {
    const CLOSED: Self = Self { min: [f32::NAN; 3], generation: 0, max: [f32::NAN; 3], store: 0 };
}

/// The rooms of a scene, by slot.
#[derive(Debug, Clone, Default)]
pub(super) struct Rooms(Vec<ObjectRoom>);

impl Rooms {
    /// An object may go anywhere in a box from now on, but to its upper sides: a cell begins there.
    pub(super) fn open(&mut self, id: Id, block: &Block) {
        let at = id.slot().index();
        if self.0.len() <= at {
            self.0.resize(at + 1, ObjectRoom::CLOSED);
        }
        let (min, max) = (block.min.to_array().map(above), block.max.to_array().map(below));
        self.0[at] = ObjectRoom { min, generation: id.generation(), max, store: id.store() };
    }

    /// The next report of the object in a slot may change the matrices.
    pub(super) fn close(&mut self, slot: Slot) {
        if let Some(room) = self.0.get_mut(slot.index()) {
            *room = ObjectRoom::CLOSED;
        }
    }

    /// Closes all.
    pub(super) fn clear(&mut self) {
        self.0.fill(ObjectRoom::CLOSED);
    }

    /// Whether an id names an object whose room is open and contains a box. No box contains
    /// numbers that are not finite, and none is inverted.
    #[inline]
    pub(super) fn hold(&self, id: Id, min: Vec3A, max: Vec3A) -> bool {
        let Some(room) = self.0.get(id.slot().index()) else { return false };
        let inside = Vec3A::from_array(room.min).cmple(min) & max.cmplt(Vec3A::from_array(room.max));
        room.generation == id.generation() && room.store == id.store() && (inside & min.cmple(max)).all()
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<ObjectRoom>()
    }
}

#[cfg(test)]
mod tests {
    use casca_slots::Slots;
    use glam::{DVec3, Vec3, Vec3A};

    use super::*;
    use crate::random::Random;

    #[test]
    fn rooms_contain_their_boxes_but_for_the_upper_sides() {
        let mut slots = Slots::new();
        let slot = slots.insert(()).unwrap();
        let (mut rooms, id) = (Rooms::default(), slots.id(slot));
        let hold =
            |rooms: &Rooms, id, min: f32, max: f32| rooms.hold(id, Vec3A::splat(min), Vec3A::splat(max));
        assert!(!hold(&rooms, id, 1.0, 2.0), "there is none yet");
        rooms.open(id, &Block { min: DVec3::splat(1.0 - 1e-12), max: DVec3::splat(3.0 + 1e-12) });
        assert!(hold(&rooms, id, 1.0, 2.9) && hold(&rooms, id, 2.0, 2.0));
        for (min, max) in [(0.99, 2.0), (1.5, 3.0), (2.0, 1.5), (f32::NAN, 2.0), (1.5, f32::NAN)] {
            assert!(!hold(&rooms, id, min, max), "{min} {max}");
        }
        slots.remove(slot);
        let other = slots.insert(()).unwrap();
        assert!(other == slot && !hold(&rooms, slots.id(other), 1.0, 2.0), "it is another's");
        let mut theirs = Slots::new();
        theirs.insert(()).unwrap();
        assert!(!hold(&rooms, theirs.id(slot), 1.0, 2.0), "another scene's");
        assert!(hold(&rooms, id, 1.0, 2.0));
        rooms.close(slot);
        assert!(!hold(&rooms, id, 1.0, 2.0));
    }

    #[test]
    fn the_quick_box_contains_the_sphere() {
        let mut random = Random::new(5);
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
