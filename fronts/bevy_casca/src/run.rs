//! The queries of a frame, each in a task of its own.

use std::hash::{BuildHasher, Hash};

use bevy_ecs::entity::Entity;
use bevy_platform::collections::HashMap;
use bevy_tasks::ComputeTaskPool;
use casca::{Method, Query, Scene, View};

use crate::settings::{CascaSettings, Shadows};

/// Runs a query for each view, the one of the frame before if there is one, and forgets others. A
/// view has none if the method is refused.
pub(crate) fn run_all<K: Eq + Hash + Copy + Send, S: BuildHasher + Default>(
    scene: &Scene,
    queries: &mut HashMap<K, Query, S>,
    settings: &CascaSettings,
    views: &[(K, View)],
) {
    let mut old = std::mem::take(queries);
    let mut jobs: Vec<(K, Query, &View)> = Vec::with_capacity(views.len());
    for (key, view) in views {
        let mut query = old.remove(key).unwrap_or_default();
        if query.method() == settings.method || query.set_method(settings.method).is_ok() {
            jobs.push((*key, query, view));
        }
    }
    each(&mut jobs, |(_, query, view)| _ = query.run(scene, view));
    queries.extend(jobs.into_iter().map(|(key, query, _)| (key, query)));
}

/// Does something to each, by Bevy's compute tasks if there are several.
pub(crate) fn each<T: Send>(all: &mut [T], does: impl Fn(&mut T) + Sync) {
    if all.len() < 2 {
        return all.iter_mut().for_each(does);
    }
    let does = &does;
    ComputeTaskPool::get_or_init(Default::default).scope(|scope| {
        all.iter_mut().for_each(|one| scope.spawn(async move { does(one) }));
    });
}

/// A view of a light: the light, for suns the camera whose cascade it is, and its number.
pub(crate) type Key = (Entity, Entity, usize);

/// The queries of the views of lights.
pub(crate) type Queries = HashMap<Key, Query>;

/// Runs the queries of some views of lights, and forgets those of others.
pub(crate) fn run_lights(
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
