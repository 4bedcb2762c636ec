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
                self.run_kept(scene, how, options, settings.parallel, views);
            }
            _ => {
                self.kept.clear();
                run::run_all(scene, &mut self.fresh, settings, views);
            }
        }
    }

    fn run_kept(
        &mut self,
        scene: &Scene,
        how: KeptOptions,
        options: PointOptions,
        parallel: bool,
        views: &[(Entity, View)],
    ) {
        let mut old = std::mem::take(&mut self.kept);
        let mut jobs = Vec::with_capacity(views.len());
        for (camera, view) in views {
            let kept = old.remove(camera).filter(|kept| kept.is_for(how, options));
            jobs.extend(kept.or_else(|| Kept::new(how, options)).map(|kept| (*camera, kept, view)));
        }
        run::each(&mut jobs, parallel, |(_, kept, view)| kept.run(scene, view));
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
