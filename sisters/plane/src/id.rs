//! Ids of objects.

use std::fmt;

use casca_slots::{Id, Slot};

/// Names an object of one scene. An id is never used again: after removal it is an error wherever
/// it is passed, as is an id of another scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub(crate) Id);

impl ObjectId {
    /// A small number that no other living object of the scene has: an index for the application's
    /// own arrays. It may be given again after removal.
    pub fn index(self) -> usize {
        self.slot().index()
    }

    /// Where the scene stores the object.
    pub(crate) fn slot(self) -> Slot {
        self.0.slot()
    }
}

impl fmt::Display for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (id, slot) = (self.0, self.0.slot());
        write!(f, "object {}.{} of scene {}", slot, id.generation(), id.store())
    }
}
