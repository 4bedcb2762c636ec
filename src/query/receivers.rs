//! The memory for the receivers of shadows, reused from one query of a light to the next.

use std::collections::BinaryHeap;

use casca_slots::Slot;

use crate::geometry::Block;
use crate::occlusion::buffers::OcclusionBuffers;

/// A part of the box of a receiver.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxPart {
    /// How large it appears to the camera, roughly: its longest edge over its distance.
    pub(crate) size: f64,
    /// The slot of the receiver.
    pub(crate) slot: Slot,
    pub(crate) block: Block,
}

/// Parts are in the order of their sizes.
impl Ord for BoxPart {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.size.total_cmp(&other.size)
    }
}

impl PartialOrd for BoxPart {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for BoxPart {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for BoxPart {}

/// Lists of the parts of receivers, and where they are as the light sees them.
#[derive(Debug, Clone, Default)]
pub(crate) struct ReceiverScratch {
    /// Parts that may still be cut.
    pub(crate) parts: BinaryHeap<BoxPart>,
    /// Boxes that together contain every point on which a shadow may be seen.
    pub(crate) pieces: Vec<Block>,
    /// Buffers that hide what lies before no piece, for methods that have no buffers.
    pub(crate) mask: OcclusionBuffers,
}
