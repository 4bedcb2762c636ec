//! How far the search for objects that a walk may still find has come.

use casca_slots::Slot;

use crate::grid::cell_box::CellBox;

/// How many slots are looked at after each shell, and how many rows walked in it pay for one more:
/// the search costs a small part of the walk.
const SLOTS: i64 = 64;
const ROWS_FOR_A_SLOT: i64 = 8;

/// How far the search has come.
#[derive(Debug, Clone, Default)]
pub(super) struct Remaining {
    /// For each side, the first slot with an object that may still be found there.
    pub(super) slots: [Slot; 6],
    /// For each side, a pixel through which it may be.
    pub(super) open: [(i64, i64); 6],
    /// Sides on which no object may be found.
    pub(super) done: [bool; 6],
    /// Slots that may be looked at. Below zero after a large object.
    pub(super) budget: i64,
    /// Rows walked since the last search.
    pub(super) rows: i64,
    /// Slots of objects that reach beyond the grid, in order, with a box around the cells on the
    /// border that decide about those parts.
    exits: Vec<(Slot, CellBox)>,
}

impl Remaining {
    /// Adds the cells by which objects are found besides their own.
    pub(super) fn add_exits(&mut self, mut exits: Vec<(Slot, CellBox)>) {
        exits.sort_unstable_by_key(|exit| exit.0);
        self.exits = exits;
    }

    /// A box around some cells of an object and those that it is found by besides.
    pub(super) fn with_exits(&self, slot: Slot, own: Option<CellBox>) -> Option<CellBox> {
        let exits = self.exits.binary_search_by_key(&slot, |exit| exit.0).ok().map(|at| self.exits[at].1);
        match (own, exits) {
            (Some(a), Some(b)) => Some(CellBox { lo: a.lo.min(b.lo), hi: a.hi.max(b.hi) }),
            (own, exits) => own.or(exits),
        }
    }

    /// Sets how many slots the next search may look at.
    pub(super) fn earn(&mut self) {
        let rows = std::mem::take(&mut self.rows);
        self.budget = SLOTS.min(self.budget + SLOTS) + rows / ROWS_FOR_A_SLOT;
    }

    /// Whether the walk has left a side.
    pub(super) fn is_done(&self, side: usize) -> bool {
        self.done[side]
    }
}
