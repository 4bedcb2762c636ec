//! The memory of coherent queries: the use of each occluder, and the objects found visible, in the
//! last run.

use casca_slots::Slot;

use crate::geometry::Block;
use crate::mesh::surface::{PatchIndex, PatchNumber};
use crate::occlusion::surface::batch::Sighting;
use crate::occlusion::surface::by_patch::ByPatch;
use crate::view::View;

/// Objects that stay visible are examined, and occluders that wait are drawn, in one run of this
/// many: each in its turn.
const TURN: u32 = 16;

/// The use of an occluder in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Usage {
    /// It was not looked at.
    #[default]
    Unknown,
    /// It hid nothing that others did not hide nearer.
    Idle,
    Useful,
    /// A group of patches of which the parts were looked at, one by one.
    Parts,
}

/// The use of an occluder in the run of a number.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Recall {
    pub(super) run: u32,
    pub(super) usage: Usage,
}

/// How an occluder takes part in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// As if there had been no run before.
    Fresh,
    /// A group of patches: as parts.
    InParts,
    /// It was drawn before.
    Drawn,
    /// It is drawn only if something comes into sight behind it.
    Waits,
}

/// The memory of coherent queries.
#[derive(Debug, Clone, Default)]
pub(crate) struct Coherence {
    /// The tag of the scene.
    pub(super) scene: u32,
    /// The number of this run; 0 before the first.
    pub(super) run: u32,
    /// The view of the last run.
    pub(super) view: Option<View>,
    /// By slot: convex occluders, and solids in place of meshes.
    pub(super) solids: Vec<Recall>,
    /// By number in the scene.
    pub(super) patches: ByPatch<Recall>,
    /// By slot: the last run that found the object visible.
    pub(super) seen: Vec<u32>,
    /// Of the last run, slots.
    pub(super) useful_solids: Vec<Slot>,
    /// Of the last run, slots and patches.
    pub(super) useful_patches: Vec<(Slot, PatchIndex)>,
    /// Solids drawn in this run, and whether they hid more than before.
    pub(super) drawn_solids: Vec<(Slot, bool)>,
    /// For the patches drawn in this run, in order of first drawing, whether they hid more than
    /// before.
    pub(super) changed: Vec<bool>,
    /// Where faces see those patches. The index is that in order of first drawing.
    pub(super) sights: Vec<Sighting>,
    pub(super) waiting_solids: Vec<Slot>,
    pub(super) waiting_patches: Vec<(Slot, PatchIndex)>,
}

impl Coherence {
    /// Forgets all runs.
    pub(crate) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Begins a run for a scene with these numbers of slots and patches.
    pub(super) fn begin(&mut self, scene: u32, slots: usize, patches: usize) {
        if self.scene != scene || self.run == u32::MAX {
            self.reset();
            self.scene = scene;
        }
        self.run += 1;
        self.solids.resize(slots.max(self.solids.len()), Recall::default());
        self.seen.resize(slots.max(self.seen.len()), 0);
        self.patches.grow(patches);
        self.drawn_solids.clear();
        self.changed.clear();
        self.sights.clear();
        self.waiting_solids.clear();
        self.waiting_patches.clear();
    }

    /// Whether the turn of the number of a slot or patch comes in this run.
    fn is_turn(&self, number: u32) -> bool {
        number.wrapping_add(self.run).is_multiple_of(TURN)
    }

    /// How a solid takes part in this run. One that waits is listed.
    pub(super) fn solid(&mut self, slot: Slot) -> Role {
        let Recall { run, usage } = self.solids[slot.index()];
        if run == self.run {
            return Role::Drawn;
        }
        if run + 1 == self.run && usage == Usage::Idle && !self.is_turn(slot.get()) {
            self.waiting_solids.push(slot);
            return Role::Waits;
        }
        Role::Fresh
    }

    /// How a patch that was not drawn in this run takes part in it, by its object and its number in
    /// the scene. One that waits is listed.
    pub(super) fn patch(&mut self, slot: Slot, patch: PatchIndex, number: PatchNumber) -> Role {
        let Recall { run, usage } = self.patches.get(number);
        if run == self.run && usage == Usage::Parts {
            return Role::InParts;
        }
        if run == 0 || run + 1 != self.run {
            return Role::Fresh;
        }
        match usage {
            Usage::Parts if !self.is_turn(number.get()) => Role::InParts,
            Usage::Idle if !self.is_turn(number.get()) => {
                self.waiting_patches.push((slot, patch));
                Role::Waits
            }
            _ => Role::Fresh,
        }
    }

    /// Whether any solid or patch waits.
    pub(crate) fn has_waiting(&self) -> bool {
        !self.waiting_solids.is_empty() || !self.waiting_patches.is_empty()
    }

    /// Notes that a solid was drawn, and whether it hid more than before.
    pub(super) fn drew_solid(&mut self, slot: Slot, changed: bool) {
        self.solids[slot.index()] = Recall { run: self.run, usage: Usage::Unknown };
        self.drawn_solids.push((slot, changed));
    }

    /// Whether the last run took an object that was in its view for hidden.
    pub(crate) fn hid(&self, slot: Slot, block: Option<&Block>) -> bool {
        let in_view = |block: &Block| self.view.as_ref().is_some_and(|view| view.may_see_block(block));
        !self.saw(slot) && block.is_some_and(in_view)
    }

    /// Whether the last run found an object visible.
    fn saw(&self, slot: Slot) -> bool {
        let run = self.seen[slot.index()];
        run > 0 && run + 1 == self.run
    }

    /// Whether an object that was visible in the last run stays so unless the buffers hide it at
    /// once.
    pub(crate) fn stays(&self, slot: Slot) -> bool {
        self.saw(slot) && !self.is_turn(slot.get())
    }
}
