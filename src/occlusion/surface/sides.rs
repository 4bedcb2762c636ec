//! Sides of patches as one face sees them.

use glam::DVec3;

use crate::mesh::surface::PatchNumber;
use crate::occlusion::surface::raster::{Edges, LANES};

/// The place of a side that no other patch shares.
pub(super) const NO_TWIN: PatchNumber = PatchNumber::NONE;

/// Eight sides of a patch as one face sees them.
#[derive(Debug, Clone)]
pub(super) struct Sides {
    pub(super) edges: Edges,
    /// The numbers of the patches beyond, or [`NO_TWIN`].
    pub(super) twins: [PatchNumber; LANES],
    /// Those that run along the side in the opposite direction, one bit each.
    pub(super) opposite: u8,
}

/// A side that is drawn in pieces.
#[derive(Debug, Clone)]
pub(super) struct WholeSide {
    /// Its place among the sides.
    pub(super) group: u32,
    pub(super) lane: u32,
    /// Its ends in coordinates of the face, and in pixels where they are deep enough.
    pub(super) ends: [DVec3; 2],
    pub(super) pixels: [(f64, f64); 2],
    pub(super) slack: f64,
}

/// The sides of the patches seen.
#[derive(Debug, Clone, Default)]
pub(super) struct SeenSides {
    pub(super) groups: Vec<Sides>,
    /// Those that reach over a large range of depths, or behind the near limit.
    pub(super) deep: Vec<WholeSide>,
    /// All of them, if the eye may go some way: each may be a part of a rim.
    pub(super) rims: Vec<WholeSide>,
}

impl SeenSides {
    /// How many there are.
    pub(super) fn reached(&self) -> Reached {
        Reached {
            groups: self.groups.len() as u32,
            deep: self.deep.len() as u32,
            rims: self.rims.len() as u32,
        }
    }

    /// Drops those from a place on.
    pub(super) fn truncate(&mut self, reached: Reached) {
        self.groups.truncate(reached.groups as usize);
        self.deep.truncate(reached.deep as usize);
        self.rims.truncate(reached.rims as usize);
    }
}

/// A place in the list of sides.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Reached {
    pub(super) groups: u32,
    pub(super) deep: u32,
    pub(super) rims: u32,
}
