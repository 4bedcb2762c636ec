//! The queries of a frame, each in a task of its own.

use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_tasks::ComputeTaskPool;
use casca::{Method, Query, Scene, View};

/// Runs a query for each view, the one of the frame before if there is one, and forgets others. A
/// view has none if the method is refused.
pub(crate) fn run_all(
    scene: &Scene,
    queries: &mut EntityHashMap<Query>,
    method: Method,
    views: &[(Entity, View)],
) {
    let mut old = std::mem::take(queries);
    let mut jobs: Vec<(Entity, Query, &View)> = Vec::with_capacity(views.len());
    for (key, view) in views {
        let mut query = old.remove(key).unwrap_or_default();
        if query.method() == method && query.pvs().is_valid_for(scene, view) {
            queries.insert(*key, query);
        } else if query.method() == method || query.set_method(method).is_ok() {
            jobs.push((*key, query, view));
        }
    }
    each(&mut jobs, &|(_, query, view)| _ = query.run(scene, view));
    queries.extend(jobs.into_iter().map(|(key, query, _)| (key, query)));
}

/// Does something to each, by Bevy's compute tasks if there are several.
pub(crate) fn each<T: Send>(all: &mut [T], does: &(impl Fn(&mut T) + Sync)) {
    if all.len() < 2 {
        return all.iter_mut().for_each(does);
    }
    ComputeTaskPool::get_or_init(Default::default).scope(|scope| {
        all.iter_mut().for_each(|one| scope.spawn(async move { does(one) }));
    });
}
