//! The visible region as a polygon.

use glam::{DVec2, Vec2};

use crate::geometry::block::Block;
use crate::point::region::Region;

/// The corners of the visible region, counterclockwise.
pub(crate) fn polygon(_region: &Region, _range: Option<f64>, _extent: &Block) -> Vec<Vec2> {
    let _ = DVec2::ZERO;
    Vec::new()
}
