//! Slots: where objects are stored, and which ids name them.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::Error;
use crate::id::ObjectId;
use crate::scene::object::Object;

/// Places of objects are `u32`, and some tables store twice a place.
const MOST: usize = (1 << 31) - 1;

static SCENES: AtomicU32 = AtomicU32::new(1);

/// Tells the scenes of a process apart. A copy of a scene changes on its own, so that cloning makes a new tag.
#[derive(Debug, PartialEq, Eq)]
struct Tag(u32);

impl Tag {
    fn new() -> Self {
        Self(SCENES.fetch_add(1, Ordering::Relaxed))
    }
}

impl Clone for Tag {
    fn clone(&self) -> Self {
        Self::new()
    }
}

/// A place for one object at a time.
#[derive(Debug, Clone, Default)]
struct Slot {
    /// How many objects were removed from here.
    generation: u32,
    /// The scene that the object was inserted into: this one, or one that this is a copy of.
    scene: u32,
    object: Option<Object>,
}

/// The objects of a scene by slot.
#[derive(Debug, Clone)]
pub(super) struct Slots {
    tag: Tag,
    slots: Vec<Slot>,
    free: Vec<u32>,
    len: usize,
}

impl Slots {
    pub(super) fn new() -> Self {
        Self { tag: Tag::new(), slots: Vec::new(), free: Vec::new(), len: 0 }
    }

    /// The tag of the scene.
    pub(super) fn tag(&self) -> u32 {
        self.tag.0
    }

    /// Number of objects.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Number of slots, free ones included.
    #[inline]
    pub(super) fn count(&self) -> usize {
        self.slots.len()
    }

    /// The id of the object in a slot.
    #[inline]
    pub(super) fn id(&self, slot: u32) -> ObjectId {
        let Slot { scene, generation, .. } = self.slots[slot as usize];
        ObjectId { scene, slot, generation }
    }

    /// The object that an id names.
    pub(super) fn find(&self, id: ObjectId) -> Result<&Object, Error> {
        let slot = self.slots.get(id.slot as usize).filter(|s| s.scene == id.scene);
        slot.filter(|s| s.generation == id.generation)
            .and_then(|s| s.object.as_ref())
            .ok_or(Error::UnknownObject(id))
    }

    /// The object of a slot in one generation, if it is still there.
    pub(super) fn of_generation(&self, slot: u32, generation: u32) -> Option<&Object> {
        let slot = self.slots.get(slot as usize)?;
        slot.object.as_ref().filter(|_| slot.generation == generation)
    }

    /// The object of a slot that is known to contain one.
    #[inline]
    pub(super) fn object(&self, slot: u32) -> &Object {
        self.slots[slot as usize].object.as_ref().expect("the matrices and lists name living objects only")
    }

    /// As [`Slots::object`], to change it.
    #[inline]
    pub(super) fn object_mut(&mut self, slot: u32) -> &mut Object {
        self.slots[slot as usize].object.as_mut().expect("the matrices and lists name living objects only")
    }

    /// The object of a slot, if there is one.
    #[inline]
    pub(super) fn get(&self, slot: u32) -> Option<&Object> {
        self.slots.get(slot as usize)?.object.as_ref()
    }

    /// All objects, in the order of their slots.
    #[inline]
    pub(super) fn living(&self) -> impl DoubleEndedIterator<Item = (u32, &Object)> {
        let slots = self.slots.iter().enumerate();
        slots.filter_map(|(i, slot)| Some((i as u32, slot.object.as_ref()?)))
    }

    /// Stores an object in a free slot, or in a new one.
    pub(super) fn insert(&mut self, object: Object) -> Result<u32, Error> {
        let at = match self.free.pop() {
            Some(slot) => slot,
            None if self.slots.len() < MOST => {
                self.slots.push(Slot::default());
                self.slots.len() as u32 - 1
            }
            None => return Err(Error::SceneFull(self.len)),
        };
        let slot = &mut self.slots[at as usize];
        (slot.scene, slot.object) = (self.tag.0, Some(object));
        self.len += 1;
        Ok(at)
    }

    /// Stores an object of another scene under the id that it has there. Its slot is empty. Objects that are inserted
    /// later may get any slot: only copies that others are not inserted into take over objects.
    pub(super) fn take_over(&mut self, id: ObjectId, object: Object) {
        let at = id.slot as usize;
        if self.slots.len() <= at {
            self.slots.resize_with(at + 1, Slot::default);
        }
        self.slots[at] = Slot { generation: id.generation, scene: id.scene, object: Some(object) };
        self.free.clear();
        self.len += 1;
    }

    /// Empties a slot that contains an object. The ids of the object name nothing from now on.
    pub(super) fn remove(&mut self, at: u32) {
        let slot = &mut self.slots[at as usize];
        slot.object = None;
        self.len -= 1;
        // A slot whose generations are used up is never given again.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(at);
        }
    }

    /// Takes memory for more objects, where it can be had.
    pub(super) fn reserve(&mut self, additional: usize) {
        let new = additional.saturating_sub(self.free.len()).min(MOST - self.slots.len());
        // Without it, inserting takes memory as it goes.
        let _ = self.slots.try_reserve(new);
    }

    pub(super) fn bytes(&self) -> usize {
        let own: usize = self.living().map(|(_, object)| object.bytes()).sum();
        own + self.slots.capacity() * size_of::<Slot>() + self.free.capacity() * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::Sphere;
    use crate::object::ObjectDesc;

    fn object() -> Object {
        Object::new(ObjectDesc::fixed(Sphere::new(Vec3::ZERO, 1.0)), None, 0.0, 0)
    }

    #[test]
    fn a_slot_is_used_again_and_its_old_id_is_not() {
        let mut slots = Slots::new();
        let first = slots.insert(object()).unwrap();
        let old = slots.id(first);
        slots.remove(first);
        assert_eq!(slots.find(old).unwrap_err(), Error::UnknownObject(old));
        let second = slots.insert(object()).unwrap();
        let new = slots.id(second);
        assert!(first == second && old != new && slots.find(new).is_ok() && slots.find(old).is_err());
        assert!(slots.of_generation(first, old.generation).is_none());
        assert!(slots.of_generation(first, new.generation).is_some());
        assert_eq!((slots.len(), slots.count(), slots.living().count()), (1, 1, 1));
    }

    #[test]
    fn a_slot_without_generations_is_given_up() {
        let mut slots = Slots::new();
        let slot = slots.insert(object()).unwrap();
        slots.slots[slot as usize].generation = u32::MAX;
        let last = slots.id(slot);
        slots.remove(slot);
        assert!(slots.find(last).is_err());
        assert_ne!(slots.insert(object()).unwrap(), slot);
        assert_eq!(slots.len(), 1);
    }

    #[test]
    fn copies_know_old_ids_and_tell_new_ones_apart() {
        let mut slots = Slots::new();
        let common = slots.insert(object()).unwrap();
        let common = slots.id(common);
        let mut copy = slots.clone();
        assert!(copy.find(common).is_ok() && copy.tag() != slots.tag());
        let (a, b) = (slots.insert(object()).unwrap(), copy.insert(object()).unwrap());
        assert_eq!(a, b);
        assert!(slots.find(copy.id(b)).is_err() && copy.find(slots.id(a)).is_err());
    }

    #[test]
    fn reserving_takes_no_more_than_there_can_be() {
        let mut slots = Slots::new();
        slots.reserve(1000);
        let bytes = slots.bytes();
        for _ in 0..1000 {
            slots.insert(object()).unwrap();
        }
        assert_eq!(slots.slots.capacity() * size_of::<Slot>(), bytes);
    }
}
