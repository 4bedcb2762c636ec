//! The ids of objects.

use std::fmt;

/// Names an object of one scene. An id is never used again: after removal it is an error wherever it is passed, as is an id of
/// another scene.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId {
    pub(crate) scene: u32,
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl ObjectId {
    /// A small number that no other living object of the scene has: an index for the application's own arrays. It may be given
    /// again after removal.
    pub fn index(self) -> usize {
        self.slot as usize
    }
}

impl fmt::Debug for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ObjectId({self})")
    }
}

impl fmt::Display for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "object {}.{} of scene {}", self.slot, self.generation, self.scene)
    }
}
