//! The potentially visible set of a view: the answer to a query.

use std::iter::Copied;
use std::slice::Iter;

use crate::id::ObjectId;
use crate::method::Method;
use crate::view::View;

/// The work of a query in numbers, the same on every machine. The library has no clock: measure
/// around [`crate::Query::run`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Stats {
    /// Chessboard shells walked.
    pub shells: u32,
    /// Cells visited. [`Method::Point`] counts those only that have objects or outlines of volumes.
    pub cells_visited: u64,
    /// [`Method::Cell`]: how many of them were hidden. Cells on the diagonals through the viewer's
    /// count twice.
    pub cells_hidden: u64,
    /// [`Method::Cell`]: runs of cells that block, or extended occluders, that were used to hide
    /// others.
    pub occluders_drawn: u32,
    /// [`Method::Cell`]: extended occluders that were left out since their angle is small.
    pub occluders_skipped: u32,
    /// Temporal bounding volumes that were seen.
    pub tbvs_revealed: u32,
    /// Objects whose shapes were compared with the view.
    pub objects_tested: u32,
    /// [`Method::Point`]: sides of occluders that were gathered.
    pub segments: u32,
    /// [`Method::Point`]: pieces of the visibility polygon, each of which ends at one wall or at
    /// none.
    pub pieces: u32,
    /// Whether the eye was inside a solid occluder, which then hides nothing.
    pub eye_in_occluder: bool,
}

/// The potentially visible set: every object of which any point can be seen. That of
/// [`Method::Point`] has no other, but for objects that go unreported
/// ([`crate::Reports::OnExpiry`]): those that may be in sight.
///
/// [`crate::Query::pvs`] lends the one of its last run, and writes the next one over it. A clone
/// keeps it.
#[derive(Debug, Clone, Default)]
pub struct Pvs {
    /// The tag of the scene; 0 before the first run.
    pub(crate) scene: u32,
    pub(crate) revision: u64,
    pub(crate) method: Method,
    pub(crate) view: Option<View>,
    pub(crate) visible: Vec<ObjectId>,
    /// The hidden objects whose volumes were seen.
    pub(crate) revealed: Vec<ObjectId>,
    /// By slot: 1 + the place in `visible`, or 0.
    places: Vec<u32>,
    pub(crate) stats: Stats,
}

impl Pvs {
    /// The objects that can be seen, in the order in which the walk found them: by chessboard
    /// shells from the eye outwards. [`Method::Sector`] gives them in the order of their indices.
    /// Objects in no cells, and hidden ones that came into sight, may come elsewhere.
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

    /// The method of the query.
    pub fn method(&self) -> Method {
        self.method
    }

    /// The view of the query; `None` before the first run.
    pub fn view(&self) -> Option<&View> {
        self.view.as_ref()
    }

    /// The [revision](crate::Scene::revision) of the scene at which it was found.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether it is the result of a query.
    pub(crate) fn has_run(&self) -> bool {
        self.scene != 0
    }

    /// Empties the set for a scene of `slots` slots.
    pub(crate) fn reset(&mut self, slots: usize) {
        for id in self.visible.drain(..) {
            self.places[id.index()] = 0;
        }
        self.places.resize(slots, 0);
        self.revealed.clear();
        self.stats = Stats::default();
    }

    pub(crate) fn push(&mut self, id: ObjectId) {
        self.visible.push(id);
        self.places[id.index()] = self.visible.len() as u32;
    }
}

/// The same objects as [`Pvs::iter`].
impl<'a> IntoIterator for &'a Pvs {
    type Item = ObjectId;
    type IntoIter = Copied<Iter<'a, ObjectId>>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
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
