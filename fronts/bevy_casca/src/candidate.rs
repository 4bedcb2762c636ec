//! What may be seen by a camera, and the test that Bevy makes of it.

use bevy_camera::primitives::{Aabb, Frustum, Sphere};
use bevy_camera::visibility::{
    InheritedVisibility, NoFrustumCulling, RenderLayers, ViewVisibility, VisibilityClass, VisibilityRange,
    VisibleEntityRanges,
};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_transform::components::GlobalTransform;

/// An entity that may be drawn.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Candidate {
    pub(crate) entity: Entity,
    inherited: &'static InheritedVisibility,
    pub(crate) view_visibility: &'static mut ViewVisibility,
    pub(crate) classes: Option<&'static VisibilityClass>,
    layers: Option<&'static RenderLayers>,
    aabb: Option<&'static Aabb>,
    sphere: Option<&'static Sphere>,
    transform: &'static GlobalTransform,
    no_frustum_culling: Has<NoFrustumCulling>,
    has_range: Has<VisibilityRange>,
}

/// A camera, as far as the test asks.
pub(crate) struct Viewer<'a> {
    pub(crate) entity: Entity,
    pub(crate) layers: &'a RenderLayers,
    pub(crate) ranges: Option<&'a VisibleEntityRanges>,
    /// `None` if nothing is culled by it.
    pub(crate) frustum: Option<&'a Frustum>,
}

impl CandidateItem<'_, '_> {
    /// Whether Bevy takes it to be visible.
    pub(crate) fn is_seen(&self, viewer: &Viewer) -> bool {
        let drawn = self.inherited.get() && viewer.layers.intersects(self.layers.unwrap_or_default());
        let out_of_range =
            |ranges: &VisibleEntityRanges| !ranges.entity_is_in_range_of_view(self.entity, viewer.entity);
        if !drawn || self.has_range && viewer.ranges.is_some_and(out_of_range) {
            return false;
        }
        let Some(frustum) = viewer.frustum.filter(|_| !self.no_frustum_culling) else { return true };
        if let Some(aabb) = self.aabb {
            let world_from_local = self.transform.affine();
            let around = Sphere {
                center: world_from_local.transform_point3a(aabb.center),
                radius: self.transform.radius_vec3a(aabb.half_extents),
            };
            frustum.intersects_sphere(&around, false)
                && frustum.intersects_obb(aabb, &world_from_local, true, false)
        } else {
            self.sphere.is_none_or(|sphere| frustum.intersects_sphere(sphere, false))
        }
    }
}
