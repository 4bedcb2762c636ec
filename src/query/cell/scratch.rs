//! The memory of the cell method.

use casca_slots::Slot;
use glam::IVec3;

use crate::query::cell::masks::DirectionMasks;
use crate::query::cell::side::Hit;
use crate::query::cell::sides::ShellSides;

/// The memory of the cell method, reused from query to query.
#[derive(Debug, Clone)]
pub(crate) struct CellScratch {
    pub(super) sides: ShellSides,
    pub(super) hits: Vec<Hit>,
    pub(super) pending: Vec<Vec<(IVec3, Slot)>>,
}

impl CellScratch {
    /// Memory for masks of `resolution` pixels along each side, a power of two.
    pub(crate) fn new(resolution: u32) -> Self {
        let masks = DirectionMasks::new(resolution.trailing_zeros());
        Self { sides: ShellSides { masks, cells: Default::default() }, hits: Vec::new(), pending: Vec::new() }
    }

    /// Changes the resolution of the masks.
    pub(crate) fn set_resolution(&mut self, resolution: u32) {
        let log = resolution.trailing_zeros();
        if log != self.sides.masks.log() {
            self.sides.masks = DirectionMasks::new(log);
        }
    }
}
