//! The memory of the cell method.

use casca_slots::Slot;
use glam::IVec3;

use crate::query::cell::masks::DirectionMasks;
use crate::query::cell::side_cells::SideCells;

/// The objects or the surfaces of volumes in a tile of cells in sight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub(super) brick: IVec3,
    pub(super) tile: u64,
    /// Whether objects, not volumes, are in the tile.
    pub(super) objects: bool,
}

/// The memory of the cell method, reused from query to query.
#[derive(Debug, Clone)]
pub(crate) struct CellScratch {
    pub(super) masks: DirectionMasks,
    pub(super) sides: [SideCells; 6],
    pub(super) hits: Vec<Hit>,
    /// For each shell, the cells there of revealed objects that are not decided.
    pub(super) pending: Vec<Vec<(IVec3, Slot)>>,
}

impl CellScratch {
    /// Memory for masks of `resolution` pixels along each side, a power of two.
    pub(crate) fn new(resolution: u32) -> Self {
        Self {
            masks: DirectionMasks::new(resolution.trailing_zeros()),
            sides: Default::default(),
            hits: Vec::new(),
            pending: Vec::new(),
        }
    }

    /// Changes the resolution of the masks.
    pub(crate) fn set_resolution(&mut self, resolution: u32) {
        let log = resolution.trailing_zeros();
        if log != self.masks.log() {
            self.masks = DirectionMasks::new(log);
        }
    }
}
