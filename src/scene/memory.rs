//! The memory that a scene takes.

use std::collections::HashSet;

use crate::scene::object::Object;

/// Memory taken by a scene, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryUse {
    /// Os and O.
    pub opacity: usize,
    /// I.
    pub ids: usize,
    /// Txy, Txz, Tyz, the volumes themselves and the structures that find them.
    pub tbvs: usize,
    /// Objects and lists of them.
    pub objects: usize,
    /// Meshes, instances of meshes and convex solids. One that several objects share counts once;
    /// other scenes and the application may share it too.
    pub shapes: usize,
}

impl MemoryUse {
    /// The bytes of the matrices of the grid.
    pub fn grid(&self) -> usize {
        self.opacity + self.ids + self.tbvs
    }

    /// The bytes of all parts together.
    pub fn total(&self) -> usize {
        self.grid() + self.objects + self.shapes
    }
}

/// Bytes of the shapes that objects share.
pub(super) fn shape_bytes<'a>(objects: impl Iterator<Item = &'a Object>) -> usize {
    let (mut counted, mut sum) = (HashSet::new(), 0);
    let mut once = |at: *const u8, bytes: usize| sum += if counted.insert(at) { bytes } else { 0 };
    for object in objects {
        object.bounds().shared(&mut once);
        let local = object.placed();
        local.inspect(|placed| placed.bounds.shared(&mut once));
        let occluders = object.given_occluder().into_iter().chain(local.and_then(|p| p.occluder.as_ref()));
        occluders.for_each(|occluder| occluder.shared(&mut once));
    }
    sum
}
