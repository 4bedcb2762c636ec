//! The queries of cameras: new in each frame, or kept ones whose next result a task finds.

use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_tasks::futures::check_ready;
use bevy_tasks::{AsyncComputeTaskPool, Task};
use casca::{KeptOptions, KeptQuery, KeptResult, Method, PointOptions, Pvs, Query, Scene, View};

use crate::run;
use crate::settings::CascaSettings;

/// A query that keeps its result, and the task that finds its next one.
#[derive(Debug)]
pub(crate) struct Kept {
    query: KeptQuery,
    options: PointOptions,
    task: Option<Task<KeptResult>>,
}

/// The queries of all cameras: each has one, of one of two kinds.
#[derive(Debug, Default)]
pub(crate) struct Eyes {
    fresh: EntityHashMap<Query>,
    kept: EntityHashMap<Kept>,
}

impl Eyes {
    /// Runs the queries of some cameras, and forgets those of others.
    pub(crate) fn run(&mut self, scene: &Scene, settings: &CascaSettings, views: &[(Entity, View)]) {
        match (settings.kept, settings.method) {
            (Some(how), Method::Point(options)) => {
                self.fresh.clear();
                self.run_kept(scene, how, options, views);
            }
            _ => {
                self.kept.clear();
                run::run_all(scene, &mut self.fresh, settings, views);
            }
        }
    }

    fn run_kept(&mut self, scene: &Scene, how: KeptOptions, options: PointOptions, views: &[(Entity, View)]) {
        let mut old = std::mem::take(&mut self.kept);
        let mut jobs = Vec::with_capacity(views.len());
        for (camera, view) in views {
            let kept = old.remove(camera).filter(|kept| kept.is_for(how, options));
            jobs.extend(kept.or_else(|| Kept::new(how, options)).map(|kept| (*camera, kept, view)));
        }
        run::each(&mut jobs, |(_, kept, view)| kept.run(scene, view));
        self.kept.extend(jobs.into_iter().map(|(camera, kept, _)| (camera, kept)));
    }

    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.fresh.clear();
        self.kept.clear();
    }

    pub(crate) fn fresh(&self, camera: Entity) -> Option<&Query> {
        self.fresh.get(&camera)
    }

    pub(crate) fn kept(&self, camera: Entity) -> Option<&KeptQuery> {
        self.kept.get(&camera).map(|kept| &kept.query)
    }

    /// What a camera found.
    pub(crate) fn pvs(&self, camera: Entity) -> Option<&Pvs> {
        self.fresh(camera).map(Query::pvs).or_else(|| self.kept(camera).map(KeptQuery::pvs))
    }

    /// What all cameras found.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Pvs> {
        self.fresh.values().map(Query::pvs).chain(self.kept.values().map(|kept| kept.query.pvs()))
    }
}

impl Kept {
    /// `None` if the options are refused.
    fn new(how: KeptOptions, options: PointOptions) -> Option<Self> {
        let mut query = KeptQuery::with_options(how).ok()?;
        query.set_point_options(options.coherent(true)).ok()?;
        Some(Self { query, options, task: None })
    }

    fn is_for(&self, how: KeptOptions, options: PointOptions) -> bool {
        self.query.options() == how && self.options == options
    }

    fn run(&mut self, scene: &Scene, view: &View) {
        if let Some(result) = self.task.as_mut().and_then(check_ready) {
            self.task = None;
            // One that came too late changes nothing.
            self.query.install(result, scene);
        }
        self.query.run(scene, view);
        if self.task.is_none() {
            let job = self.query.prepare(scene, view);
            let pool = AsyncComputeTaskPool::get_or_init(Default::default);
            self.task = Some(pool.spawn(async move { job.run() }));
        }
    }
}

#[cfg(test)]
mod tests {
    use casca::glam::{UVec3, Vec3};
    use casca::{Aabb, GridSpec, ObjectDesc, Sphere};

    use super::*;

    #[test]
    fn tasks_find_the_next_result_in_time() {
        let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(32) }).unwrap();
        let wall = Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 17.0));
        scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
        scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(16.0, 16.0, 24.0), 0.5))).unwrap();
        let mut kept = Kept::new(KeptOptions::new().reach(0.5), PointOptions::fast()).unwrap();
        for step in 0..40 {
            let eye = Vec3::new(12.0 + 0.2 * step as f32, 16.0, 8.0);
            kept.run(&scene, &View::omnidirectional(eye).unwrap());
            assert_eq!(kept.query.pvs().len(), 1);
            while !kept.task.as_ref().unwrap().is_finished() {
                std::thread::yield_now();
            }
        }
        assert_eq!(kept.query.refreshes(), 1, "only the first run waited");
    }
}
