//! Slots: where values are stored, and which ids name them.

use std::ops::{Index, IndexMut};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::slot::{Id, Slot};

/// The most slots of a store: tables may hold twice the number of a slot, or a bit beside it.
pub const MOST_SLOTS: usize = (1 << 31) - 1;

static STORES: AtomicU32 = AtomicU32::new(1);

/// Tells the stores of a process apart. A copy of a store changes on its own, so that cloning makes
/// a new tag.
#[derive(Debug)]
struct Tag(u32);

impl Tag {
    fn new() -> Self {
        Self(STORES.fetch_add(1, Ordering::Relaxed))
    }
}

impl Clone for Tag {
    fn clone(&self) -> Self {
        Self::new()
    }
}

/// A place for one value at a time.
#[derive(Debug, Clone)]
struct Place<T> {
    /// How many values were removed from here.
    generation: u32,
    /// The store that the value was inserted into: this one, or one that this is a copy of.
    store: u32,
    value: Option<T>,
}

impl<T> Place<T> {
    const EMPTY: Self = Self { generation: 0, store: 0, value: None };
}

/// Values by slot.
///
/// A clone is another store. It knows the ids of all values that it was made with, but not the ids
/// that the original gives out later, nor the other way round. Stores are told apart until a
/// process has made 2^32 - 1 of them, clones included.
///
/// A slot is given up after 2^32 values. `slots[slot]` is the value of a slot that is known to
/// have one.
#[derive(Debug, Clone)]
pub struct Slots<T> {
    tag: Tag,
    places: Vec<Place<T>>,
    free: Vec<Slot>,
    len: usize,
}

impl<T> Slots<T> {
    /// An empty store, with a tag of its own.
    pub fn new() -> Self {
        Self { tag: Tag::new(), places: Vec::new(), free: Vec::new(), len: 0 }
    }

    /// The number that tells the store from all others.
    #[inline]
    pub fn tag(&self) -> u32 {
        self.tag.0
    }

    /// Number of values.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no values.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number of slots, free ones included: the numbers of all slots are below.
    #[inline]
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// The id of the value in a slot.
    ///
    /// # Panics
    /// On a slot that was never given out.
    #[inline]
    pub fn id(&self, slot: Slot) -> Id {
        let Place { store, generation, .. } = self.places[slot.index()];
        Id::new(store, slot, generation)
    }

    /// The value that an id names, if it is still there.
    #[inline]
    pub fn find(&self, id: Id) -> Option<&T> {
        let place = self.places.get(id.slot().index()).filter(|place| place.store == id.store())?;
        place.value.as_ref().filter(|_| place.generation == id.generation())
    }

    /// The value of a slot in one generation, if it is still there.
    #[inline]
    pub fn of_generation(&self, slot: Slot, generation: u32) -> Option<&T> {
        let place = self.places.get(slot.index())?;
        place.value.as_ref().filter(|_| place.generation == generation)
    }

    /// The value of a slot, if there is one.
    #[inline]
    pub fn get(&self, slot: Slot) -> Option<&T> {
        self.places.get(slot.index())?.value.as_ref()
    }

    /// As [`Slots::get`], to change it.
    #[inline]
    pub fn get_mut(&mut self, slot: Slot) -> Option<&mut T> {
        self.places.get_mut(slot.index())?.value.as_mut()
    }

    /// All values, in the order of their slots. Costs a look at each slot, free ones included.
    #[inline]
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (Slot, &T)> {
        let places = self.places.iter().enumerate();
        places.filter_map(|(i, place)| Some((Slot::new(i as u32), place.value.as_ref()?)))
    }

    /// Stores a value in the slot that came free last, or in a new one; `None`, without a change,
    /// if there are [`MOST_SLOTS`].
    pub fn insert(&mut self, value: T) -> Option<Slot> {
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None if self.places.len() < MOST_SLOTS => {
                self.places.push(Place::EMPTY);
                Slot::new(self.places.len() as u32 - 1)
            }
            None => return None,
        };
        let place = &mut self.places[slot.index()];
        (place.store, place.value) = (self.tag.0, Some(value));
        self.len += 1;
        Some(slot)
    }

    /// Stores a value of another store under the id that it has there; false, without a change, if
    /// its slot has a value. Values that are inserted later may get any slot: only copies that no
    /// others are inserted into take over values.
    pub fn take_over(&mut self, id: Id, value: T) -> bool {
        let slot = id.slot();
        if self.get(slot).is_some() {
            return false;
        }
        if self.places.len() <= slot.index() {
            self.places.resize_with(slot.index() + 1, || Place::EMPTY);
        }
        let value = Some(value);
        self.places[slot.index()] = Place { generation: id.generation(), store: id.store(), value };
        self.free.clear();
        self.len += 1;
        true
    }

    /// Empties a slot, and gives the value that was there, if there was one. Its id names nothing
    /// from now on.
    pub fn remove(&mut self, slot: Slot) -> Option<T> {
        let place = self.places.get_mut(slot.index())?;
        let value = place.value.take()?;
        self.len -= 1;
        // A slot whose generations are used up is never given again.
        if let Some(next) = place.generation.checked_add(1) {
            place.generation = next;
            self.free.push(slot);
        }
        Some(value)
    }

    /// Takes memory for more values, where it can be had.
    pub fn reserve(&mut self, additional: usize) {
        let new = additional.saturating_sub(self.free.len()).min(MOST_SLOTS - self.places.len());
        // Without it, inserting takes memory as it goes.
        let _ = self.places.try_reserve(new);
    }

    /// Bytes on the heap, without those that values own.
    pub fn bytes(&self) -> usize {
        self.places.capacity() * size_of::<Place<T>>() + self.free.capacity() * size_of::<Slot>()
    }
}

impl<T> Default for Slots<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Index<Slot> for Slots<T> {
    type Output = T;

    /// The value of a slot.
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    fn index(&self, slot: Slot) -> &T {
        self.places[slot.index()].value.as_ref().expect("a slot that is known to have a value")
    }
}

impl<T> IndexMut<Slot> for Slots<T> {
    #[inline]
    fn index_mut(&mut self, slot: Slot) -> &mut T {
        self.places[slot.index()].value.as_mut().expect("a slot that is known to have a value")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_is_used_again_and_its_old_id_is_not() {
        let mut slots = Slots::new();
        let first = slots.insert('a').unwrap();
        let old = slots.id(first);
        assert_eq!((slots.remove(first), slots.remove(first)), (Some('a'), None));
        assert_eq!((slots.find(old), slots.len()), (None, 0));
        let second = slots.insert('b').unwrap();
        let new = slots.id(second);
        assert!(first == second && old != new);
        assert_eq!((slots.find(new), slots.find(old)), (Some(&'b'), None));
        assert_eq!(slots.of_generation(first, old.generation()), None);
        assert_eq!(slots.of_generation(first, new.generation()), Some(&'b'));
        assert_eq!((slots.len(), slots.count(), slots.iter().count()), (1, 1, 1));
        let beyond = Slot::new(9);
        assert!(slots.get(beyond).is_none() && slots.remove(beyond).is_none());
    }

    #[test]
    fn a_slot_without_generations_is_given_up() {
        let mut slots = Slots::new();
        let slot = slots.insert(()).unwrap();
        slots.places[slot.index()].generation = u32::MAX;
        let last = slots.id(slot);
        slots.remove(slot);
        assert_eq!(slots.find(last), None);
        assert_ne!(slots.insert(()), Some(slot));
        assert_eq!(slots.len(), 1);
    }

    #[test]
    fn copies_know_old_ids_and_tell_new_ones_apart() {
        let mut slots = Slots::new();
        let common = slots.insert(()).unwrap();
        let common = slots.id(common);
        let mut copy = slots.clone();
        assert!(copy.find(common).is_some() && copy.tag() != slots.tag());
        let (a, b) = (slots.insert(()).unwrap(), copy.insert(()).unwrap());
        assert_eq!(a, b);
        assert!(slots.find(copy.id(b)).is_none() && copy.find(slots.id(a)).is_none());
    }

    #[test]
    fn values_are_taken_over_with_their_ids() {
        let mut slots = Slots::new();
        let mut copy = slots.clone();
        let [_, b] = ["a", "b"].map(|value| slots.insert(value).unwrap());
        assert!(copy.take_over(slots.id(b), "b") && !copy.take_over(slots.id(b), "c"));
        assert_eq!((copy.find(slots.id(b)), copy.len(), copy.count()), (Some(&"b"), 1, 2));
    }

    #[test]
    fn reserving_takes_no_more_than_there_can_be() {
        let mut slots = Slots::new();
        slots.reserve(1000);
        let bytes = slots.bytes();
        for i in 0..1000 {
            slots.insert(i).unwrap();
        }
        assert_eq!(slots.bytes(), bytes);
    }
}
