//! The potentially visible set of a view: the answer to a query.

use std::iter::Copied;
use std::slice::Iter;

use crate::id::ObjectId;

/// The work of a query in numbers, the same on every machine. The library has no clock: measure
/// around [`crate::Query::run`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Stats {
    /// Objects whose shapes were compared with the view.
    pub objects_tested: u32,
    /// Pieces of the visibility polygon, each of which ends at one wall or at none.
    pub pieces: u32,
    /// Whether the eye was inside a solid occluder, which then hides nothing.
    pub eye_in_occluder: bool,
}

/// The visible set: every object of which any point can be seen, and no other.
///
/// [`crate::Query::pvs`] lends the one of its last run, and writes the next one over it. A clone
/// keeps it.
#[derive(Debug, Clone, Default)]
pub struct Pvs {
    visible: Vec<ObjectId>,
    /// By slot: 1 + the place in `visible`, or 0.
    places: Vec<u32>,
    pub(crate) stats: Stats,
}

impl Pvs {
    /// The objects that can be seen, in the order in which the walk found them: by chessboard
    /// shells from the eye outwards, unless they are few. Objects in no cells come first.
    pub fn visible(&self) -> &[ObjectId] {
        &self.visible
    }

    /// The objects that can be seen, as [`Pvs::visible`] gives them.
    pub fn iter(&self) -> Copied<Iter<'_, ObjectId>> {
        self.visible.iter().copied()
    }

    /// Number of objects that can be seen.
    pub fn len(&self) -> usize {
        self.visible.len()
    }

    /// Whether nothing can be seen.
    pub fn is_empty(&self) -> bool {
        self.visible.is_empty()
    }

    /// Whether an object can be seen. Costs one look-up.
    pub fn contains(&self, id: ObjectId) -> bool {
        let place = self.places.get(id.index()).copied().unwrap_or(0) as usize;
        place > 0 && self.visible[place - 1] == id
    }

    /// The differences between this set and one that was found earlier: the objects to show and
    /// those to take away. Costs one look-up for each object of both sets, when the iterators run.
    pub fn changes_since<'a>(&'a self, earlier: &'a Self) -> PvsChanges<'a> {
        PvsChanges { earlier, later: self }
    }

    /// The work of the query in numbers.
    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// Empties the set for a scene of `slots` slots.
    pub(crate) fn reset(&mut self, slots: usize) {
        for id in self.visible.drain(..) {
            self.places[id.index()] = 0;
        }
        self.places.resize(slots, 0);
        self.stats = Stats::default();
    }

    pub(crate) fn push(&mut self, id: ObjectId) {
        self.visible.push(id);
        self.places[id.index()] = self.visible.len() as u32;
    }
}

/// The differences between two sets: see [`Pvs::changes_since`].
#[derive(Debug, Clone, Copy)]
pub struct PvsChanges<'a> {
    earlier: &'a Pvs,
    later: &'a Pvs,
}

impl<'a> PvsChanges<'a> {
    /// The objects of the later set that are not in the earlier one, in the order of the later.
    pub fn entered(self) -> impl Iterator<Item = ObjectId> + 'a {
        self.later.iter().filter(move |&id| !self.earlier.contains(id))
    }

    /// The objects of the earlier set that are not in the later one, in the order of the earlier.
    /// Some may have been removed.
    pub fn left(self) -> impl Iterator<Item = ObjectId> + 'a {
        self.earlier.iter().filter(move |&id| !self.later.contains(id))
    }
}
