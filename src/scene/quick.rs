//! Boxes of small moving objects in one array, as the queries of [`crate::Method::Point`] test
//! them.
//!
//! Objects are far apart in memory, and many movers are in sight at once. What a query asks of
//! most of them is here, in 32 bytes an object: whether it is a matter of its box alone, the box,
//! and the rest of its id.

use casca_slots::{Id, Slot};
use glam::{DVec3, Vec3A};

use crate::geometry::Block;

/// The entry of one object.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Quick {
    /// The least corner of a box around the bounds; not a number if there is no entry.
    min: [f32; 3],
    store: u32,
    max: [f32; 3],
    generation: u32,
}

impl Quick {
    const NONE: Self = Self { min: [f32::NAN; 3], store: 0, max: [f32::NAN; 3], generation: 0 };

    fn is_none(&self) -> bool {
        self.min[0].is_nan()
    }

    /// A box around the bounds.
    #[inline]
    pub(crate) fn block(&self) -> Block {
        let corner = |v: [f32; 3]| Vec3A::from_array(v).as_dvec3();
        Block { min: corner(self.min), max: corner(self.max) }
    }

    /// The middle of the box, which lies in the bounds.
    #[inline]
    pub(crate) fn middle(&self) -> DVec3 {
        let Block { min, max } = self.block();
        (min + max) * 0.5
    }

    /// The id of the object in a slot that has this entry.
    #[inline]
    pub(crate) fn id(&self, slot: Slot) -> Id {
        Id::new(self.store, slot, self.generation)
    }
}

/// The entries of a scene, by slot. An object has one if it moves, hides nothing, is listed by
/// bricks, its place is known, all views show it, and its bounds contain the middle of their box.
#[derive(Debug, Clone, Default)]
pub(crate) struct QuickBoxes(Vec<Quick>);

impl QuickBoxes {
    /// The entry of an object, if it has one.
    #[inline]
    pub(crate) fn get(&self, slot: Slot) -> Option<&Quick> {
        self.0.get(slot.index()).filter(|quick| !quick.is_none())
    }

    /// Makes or replaces an entry. The box contains the bounds.
    #[inline]
    pub(super) fn set(&mut self, id: Id, min: Vec3A, max: Vec3A) {
        let at = id.slot().index();
        if self.0.len() <= at {
            self.0.resize(at + 1, Quick::NONE);
        }
        let (min, max) = (min.to_array(), max.to_array());
        self.0[at] = Quick { min, store: id.store(), max, generation: id.generation() };
    }

    /// Gives an entry, if there is one, another box, which contains the bounds.
    #[inline]
    pub(super) fn replace(&mut self, slot: Slot, min: Vec3A, max: Vec3A) {
        if let Some(quick) = self.0.get_mut(slot.index()).filter(|quick| !quick.is_none()) {
            (quick.min, quick.max) = (min.to_array(), max.to_array());
        }
    }

    /// Takes an entry out.
    pub(super) fn remove(&mut self, slot: Slot) {
        if let Some(quick) = self.0.get_mut(slot.index()) {
            *quick = Quick::NONE;
        }
    }

    /// Takes all out.
    pub(super) fn clear(&mut self) {
        self.0.fill(Quick::NONE);
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<Quick>()
    }
}
