//! Where the rays of a view start.

use std::borrow::Borrow;

use crate::geometry::Block;
use crate::scene::Scene;
use crate::view::{Origin, View};

/// Whether rays may start inside an occluder: at the eye, or in one of the regions ([`Scene::start_regions`]) given. One
/// then sees through its inside, so the cells that it makes opaque hide nothing.
pub(crate) fn rays_start_in_occluder(
    scene: &Scene,
    view: &View,
    mut regions: impl Iterator<Item = impl Borrow<(View, Block)>>,
) -> bool {
    let touches = |(region, around): &(View, Block)| scene.occluder_touches(region, around);
    match view.origin {
        Origin::Eye { at, .. } => scene.inside_occluder(at) || regions.any(|r| touches(r.borrow())),
        Origin::Direction(_) => true,
    }
}
