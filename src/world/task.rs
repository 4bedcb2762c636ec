//! Work on the pages of a world that is put off.

use std::vec::IntoIter;

use crate::id::ObjectId;
use crate::object::ObjectDesc;
use crate::world::page::PageId;

/// Objects of a page that come or go.
pub(super) enum Task {
    Load(PageId, IntoIter<ObjectDesc>),
    Drop(PageId, IntoIter<ObjectId>),
}

impl Task {
    /// Bytes on the heap, but for those of shared shapes.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Load(_, objects) => objects.len() * size_of::<ObjectDesc>(),
            Self::Drop(_, ids) => ids.len() * size_of::<ObjectId>(),
        }
    }
}
