//! The memory that a scene takes.

use std::collections::HashSet;

use crate::scene::Scene;

/// Memory taken by a scene, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryUse {
    /// Os, O, and boxes of opaque cells.
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

impl Scene {
    /// The memory that the scene takes. Costs a walk over all bricks and objects.
    pub fn memory(&self) -> MemoryUse {
        MemoryUse {
            opacity: self.opacity.bytes(),
            ids: self.ids.bytes(),
            tbvs: self.volumes.bytes(),
            objects: self.living().map(|(_, object)| object.bytes()).sum::<usize>()
                + self.slots.bytes()
                + self.boxes.bytes()
                + self.members.bytes()
                + self.rooms.bytes()
                + self.movers.bytes()
                + self.reports.bytes()
                + self.resting.bytes()
                + self.seams.bytes()
                + self.expiries.bytes()
                + self.changes.bytes()
                + self.seen.bytes()
                + self.user_data.bytes()
                + self.unseen.capacity() * size_of::<casca_slots::Slot>()
                + self.moved.bytes(),
            shapes: self.shape_bytes(),
        }
    }

    /// Bytes of the shapes that objects share.
    fn shape_bytes(&self) -> usize {
        let (mut counted, mut sum) = (HashSet::new(), 0);
        let mut once = |at: *const u8, bytes: usize| sum += if counted.insert(at) { bytes } else { 0 };
        for (_, object) in self.living() {
            object.bounds().shared(&mut once);
            let local = object.placed();
            local.inspect(|placed| placed.bounds.shared(&mut once));
            let occluders =
                object.given_occluder().into_iter().chain(local.and_then(|p| p.occluder.as_ref()));
            occluders.for_each(|occluder| occluder.shared(&mut once));
        }
        sum
    }
}
