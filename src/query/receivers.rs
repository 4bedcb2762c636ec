//! Room for the receivers of shadows, kept from one query of a light to the next.

use std::collections::VecDeque;

use crate::geometry::Block;

/// What the light's query keeps to spare allocations.
#[derive(Debug, Default)]
pub(crate) struct ReceiverScratch {
    pub(crate) pieces: Vec<Block>,
    pub(crate) cutting: VecDeque<Block>,
    pub(crate) depths: Vec<f64>,
}
