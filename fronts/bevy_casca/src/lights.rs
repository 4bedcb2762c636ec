//! What the views of all kinds of lights have in common.

use bevy_camera::visibility::VisibleMeshEntities;
use bevy_ecs::prelude::*;
use bevy_platform::collections::HashMap;
use casca::{Method, Scene, View};

use crate::run::run_all;
use crate::settings::{CascaSettings, Shadows};

/// A view of a light: the light, for suns the camera whose cascade it is, and its number.
pub(crate) type Key = (Entity, Entity, usize);

/// The queries of the views of lights.
pub(crate) type Queries = HashMap<Key, casca::Query>;

/// Runs the queries of some views of lights, and forgets those of others.
pub(crate) fn run(
    scene: Option<&Scene>,
    queries: &mut Queries,
    settings: &CascaSettings,
    views: &[(Key, View)],
) {
    let culls =
        settings.enabled && settings.shadows != Shadows::All && !matches!(settings.method, Method::Frustum);
    let Some(scene) = scene.filter(|_| culls) else {
        queries.clear();
        return;
    };
    run_all(scene, queries, settings, views);
}

/// Puts another list in the place of one.
pub(crate) fn replace(out: &mut VisibleMeshEntities, mut list: Vec<Entity>) {
    out.entities.clear();
    out.entities.append(&mut list);
    out.shrink();
}
