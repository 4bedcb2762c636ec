//! The place of the eye, as drawing surfaces needs it.

use glam::DVec3;

use crate::geometry::Room;

/// How surfaces are seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Viewpoint {
    /// The origin of the rays.
    pub(crate) origin: DVec3,
    /// Surfaces are cut at this depth: nothing nearer is drawn.
    pub(crate) limit: f64,
    /// Where the eye may go, around the origin.
    pub(crate) room: Room,
}
