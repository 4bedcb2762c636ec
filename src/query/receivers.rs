//! The memory for the receivers of shadows, reused from one query of a light to the next.

use std::collections::VecDeque;

use crate::geometry::Block;

/// Lists of the parts of receivers.
#[derive(Debug, Clone, Default)]
pub(crate) struct ReceiverScratch {
    pub(crate) pieces: Vec<Block>,
    pub(crate) cutting: VecDeque<Block>,
    pub(crate) depths: Vec<f64>,
}
