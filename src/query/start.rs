//! Where the rays of a view start.

use crate::scene::Scene;
use crate::view::{Origin, View};

/// Whether rays may start inside an occluder: at the eye, or where the near plane cuts into it. One then sees
/// through its inside, so the cells that it makes opaque hide nothing.
pub(crate) fn rays_start_in_occluder(scene: &Scene, view: &View) -> bool {
    match view.origin {
        Origin::Eye { at, .. } => scene.inside_occluder(at) || scene.near_plane_cuts(view),
        Origin::Direction(_) => true,
    }
}
