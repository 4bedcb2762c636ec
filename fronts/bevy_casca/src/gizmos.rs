//! Draws boxes around hidden entities, and the volumes of those that move.

use bevy_app::{App, Plugin, PostUpdate};
use bevy_camera::Camera;
use bevy_camera::primitives::{Aabb, Frustum};
use bevy_color::Color;
use bevy_ecs::prelude::*;
use bevy_gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy_gizmos::{AppGizmoBuilder, gizmos::Gizmos};
use bevy_math::Vec3;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use bevy_transform::components::GlobalTransform;

use crate::scene::{CascaScene, InScene};
use crate::settings::CascaSystems;

/// Draws the boxes of [`CascaGizmos`]. Add it beside [`CascaPlugin`](crate::CascaPlugin) and Bevy's
/// `GizmoPlugin`, which is one of the `DefaultPlugins`.
#[derive(Debug, Default, Clone, Copy)]
pub struct CascaGizmosPlugin;

impl Plugin for CascaGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.init_gizmo_group::<CascaGizmos>()
            .add_systems(PostUpdate, draw.after(CascaSystems::End).run_if(is_wanted));
    }
}

/// Which boxes are drawn: a group of gizmos in Bevy's [`GizmoConfigStore`]. Give it the render
/// layer of a second camera to see them from there.
///
/// Each box is looked up and drawn anew in each frame: this costs far more than to cull.
#[derive(Debug, Clone, Reflect, GizmoConfigGroup)]
#[reflect(Clone, Default)]
pub struct CascaGizmos {
    /// Around entities that are in the view of a camera, but hidden from all that have occlusion.
    /// Default: blue.
    pub hidden: Option<Color>,
    /// Around all places where a moving entity can be that nobody has asked for since it was seen
    /// last: its temporal bounding volume. Default: yellow.
    pub volumes: Option<Color>,
    /// The most boxes that are drawn in a frame. Default: 4,096.
    pub most: usize,
}

impl Default for CascaGizmos {
    fn default() -> Self {
        Self {
            hidden: Some(Color::srgb(0.2, 0.4, 1.0)),
            volumes: Some(Color::srgb(1.0, 0.85, 0.2)),
            most: 4096,
        }
    }
}

fn is_wanted(store: Option<Res<GizmoConfigStore>>, casca: Res<CascaScene>) -> bool {
    let config = store.as_ref().and_then(|store| store.get_config::<CascaGizmos>());
    casca.scene.is_some() && config.is_some_and(|(config, _)| config.enabled)
}

fn draw(
    mut gizmos: Gizmos<CascaGizmos>,
    casca: Res<CascaScene>,
    cameras: Query<(Entity, &Camera, &Frustum)>,
    entities: Query<(&InScene, &Aabb, &GlobalTransform)>,
) {
    let Some(scene) = &casca.scene else { return };
    let CascaGizmos { hidden, volumes, most } = gizmos.config_ext.clone();
    let cameras: Vec<_> = cameras
        .iter()
        .filter(|(_, camera, _)| camera.is_active)
        .filter_map(|(entity, _, frustum)| Some((casca.seen_by(entity)?, frustum)))
        .collect();
    let mut left = most;
    for (known, aabb, transform) in &entities {
        if left == 0 {
            return;
        }
        let is_seen = cameras.iter().any(|(pvs, _)| pvs.contains(known.id));
        let world = transform.affine();
        if let Some(color) = hidden.filter(|_| !is_seen)
            && cameras.iter().any(|(_, frustum)| frustum.intersects_obb(aabb, &world, true, true))
        {
            gizmos.aabb_3d(*aabb, *transform, color);
            left -= 1;
        }
        if let Some(color) = volumes
            && let Ok(Some((low, high))) = scene.tbv(known.id)
        {
            let corner = |at: casca::glam::DVec3| Vec3::from_array(at.as_vec3().to_array());
            let volume = Aabb::from_min_max(corner(low), corner(high));
            gizmos.aabb_3d(volume, GlobalTransform::IDENTITY, color);
            left = left.saturating_sub(1);
        }
    }
}
