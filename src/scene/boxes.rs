//! The boxes of objects, by slot: what a query asks of most objects. Objects themselves are larger
//! and lie apart, and the boxes of meshes lie behind them.

use casca_slots::Slot;
use glam::Vec3A;

use crate::geometry::{Aabb, Block};
use crate::object::{ALL_LAYERS, Bounds};
use crate::scene::object::Object;
use crate::view::View;

/// A box that contains the bounds of an object, and, for most static objects, all else that a query
/// asks before it draws or examines them. Half a line of the cache.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct ObjectBox {
    /// The last number holds the properties, as bits.
    min: [f32; 4],
    max: [f32; 4],
}

impl ObjectBox {
    /// Nothing is known: the object is asked.
    const UNKNOWN: Self = Self { min: [0.0; 4], max: [0.0; 4] };

    const STATIC: u32 = 1;
    const ON_ALL_LAYERS: u32 = 2;
    const CENTERED: u32 = 4;
    const OCCLUDES: u32 = 8;
    const BOX: u32 = 16;

    fn new(min: Vec3A, max: Vec3A, properties: u32) -> Self {
        let corner = |v: Vec3A, last: f32| v.extend(last).to_array();
        Self { min: corner(min, f32::from_bits(properties)), max: corner(max, 0.0) }
    }

    /// That of an object. Of dynamic ones, and of those beyond the range of single precision,
    /// nothing is told.
    pub(super) fn of(object: &Object) -> Self {
        if !object.is_static() {
            return Self::UNKNOWN;
        }
        let bounds = object.bounds();
        let Aabb { min, max } = bounds.aabb();
        if !(min.is_finite() && max.is_finite()) {
            return Self::UNKNOWN;
        }
        let is_box = matches!(bounds, Bounds::Box(_) | Bounds::Mesh(_) | Bounds::Instance(_));
        let properties = [
            (Self::ON_ALL_LAYERS, object.layers == ALL_LAYERS),
            (Self::CENTERED, bounds.kind().is_centered()),
            (Self::OCCLUDES, object.occluder().is_some()),
            (Self::BOX, is_box),
        ];
        let set = properties.iter().filter(|(_, is_set)| *is_set).map(|(bit, _)| bit);
        Self::new(min.into(), max.into(), Self::STATIC | set.sum::<u32>())
    }

    #[inline]
    fn has(&self, property: u32) -> bool {
        self.min[3].to_bits() & property != 0
    }

    /// Whether it tells all that it can: else the object is asked.
    #[inline]
    pub(crate) fn is_static(&self) -> bool {
        self.has(Self::STATIC)
    }

    /// Whether the object is on all layers, and the view shows any; else its layers are asked.
    #[inline]
    pub(crate) fn is_shown(&self, view: &View) -> bool {
        self.has(Self::ON_ALL_LAYERS) && view.layers() != 0
    }

    /// Whether the bounds contain the middle of the box.
    #[inline]
    pub(crate) fn is_centered(&self) -> bool {
        self.has(Self::CENTERED)
    }

    /// Whether the object has an occluder that hides others.
    #[inline]
    pub(crate) fn occludes(&self) -> bool {
        self.has(Self::OCCLUDES)
    }

    /// Whether the bounds are compared with the frustum by their box.
    #[inline]
    pub(crate) fn is_box(&self) -> bool {
        self.has(Self::BOX)
    }

    /// The two corners.
    #[inline]
    pub(crate) fn corners(&self) -> (Vec3A, Vec3A) {
        (Vec3A::from_slice(&self.min), Vec3A::from_slice(&self.max))
    }

    /// As a box in double precision.
    #[inline]
    pub(crate) fn block(&self) -> Block {
        let (min, max) = self.corners();
        Block { min: min.as_dvec3(), max: max.as_dvec3() }
    }
}

/// The boxes of the objects of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Boxes(Vec<ObjectBox>);

impl Boxes {
    /// The box of an object that was put in.
    #[inline]
    pub(crate) fn of(&self, slot: Slot) -> &ObjectBox {
        &self.0[slot.index()]
    }

    /// Takes memory for the boxes of so many slots, where it can be had.
    pub(super) fn reserve(&mut self, slots: usize) {
        let _ = self.0.try_reserve(slots.saturating_sub(self.0.len()));
    }

    /// An object is at a slot, or was changed there.
    pub(super) fn put(&mut self, slot: Slot, object: &Object) {
        if self.0.len() <= slot.index() {
            self.0.resize(slot.index() + 1, ObjectBox::UNKNOWN);
        }
        self.0[slot.index()] = ObjectBox::of(object);
    }

    /// The object at a slot, which was put in, is in a zone, and has this box there.
    #[inline]
    pub(super) fn put_mover(&mut self, slot: Slot, min: Vec3A, max: Vec3A) {
        if let Some(own) = self.0.get_mut(slot.index()) {
            *own = ObjectBox::new(min, max, 0);
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<ObjectBox>()
    }
}
