//! What tells whether a result still holds: the number of changes of a scene, and the last of them.

use casca_slots::Slot;

use crate::geometry::Block;
use crate::scene::journal::{Journal, MOST_STATIC, StaticChange};

/// The changes of a scene, counted, with the last ones of two kinds.
#[derive(Debug, Clone, Default)]
pub(super) struct Changes {
    /// Changes that a result may depend on.
    revision: u64,
    /// Moves of all objects, hidden ones included.
    moves: u64,
    /// The objects that were put into a volume, or whose layers changed there.
    volumes: Journal<Slot>,
    /// The static objects that came, went or changed.
    fixed: Journal<StaticChange>,
}

impl Changes {
    /// Something changed that a result may depend on.
    #[inline]
    pub(super) fn changed(&mut self) {
        self.revision += 1;
    }

    /// An object moved: gives the number of the move.
    #[inline]
    pub(super) fn moved(&mut self) -> u64 {
        self.moves += 1;
        self.moves
    }

    /// One of this many objects has another volume, or other layers in its volume.
    pub(super) fn volume_is_new(&mut self, slot: Slot, objects: usize) {
        self.volumes.push(slot, objects);
    }

    /// A static object comes, goes or changes; the box is around its occluder before.
    pub(super) fn static_changed(&mut self, slot: Slot, occluder: Option<Block>) {
        self.fixed.push(StaticChange::new(slot, occluder), MOST_STATIC);
    }

    /// All static objects changed.
    pub(super) fn all_static_changed(&mut self) {
        self.fixed.cut();
    }

    #[inline]
    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    #[inline]
    pub(super) fn moves(&self) -> u64 {
        self.moves
    }

    /// The volumes that are new.
    pub(super) fn volumes(&self) -> &Journal<Slot> {
        &self.volumes
    }

    /// The static objects that came, went or changed.
    pub(super) fn fixed(&self) -> &Journal<StaticChange> {
        &self.fixed
    }

    pub(super) fn bytes(&self) -> usize {
        self.volumes.bytes() + self.fixed.bytes()
    }
}
