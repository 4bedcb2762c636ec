//! Queries: the memory of one view, and the methods that find its PVS.

pub(crate) mod cell;
pub(crate) mod marks;
pub(crate) mod point;
pub(crate) mod receivers;
pub(crate) mod sight;
pub(crate) mod start;
pub(crate) mod validity;

use crate::error::Error;
use crate::geometry::Block;
use crate::matrix::bits::{BitMatrix, OcclusionMatrix};
use crate::method::{CellOptions, Method, PointOptions};
use crate::pvs::Pvs;
use crate::query::cell::lists::CellLists;
use crate::query::cell::{CellScratch, CellWalk};
use crate::query::marks::Marks;
use crate::query::point::drawing::{DrawingScratch, Offered};
use crate::query::point::run::Run;
use crate::query::point::{PointScratch, StaticChanges};
use crate::query::receivers::ReceiverScratch;
use crate::scene::Scene;
use crate::view::View;

pub(crate) use sight::sealed;
pub use sight::{CameraQuery, Sight};

/// What a query is told besides its view.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Extras<'a> {
    /// Boxes before which objects lie that [`Method::Point`] finds; it leaves out others.
    pub(crate) receivers: Option<&'a [Block]>,
    /// Whether [`Method::Point`] looks at static objects only, as if there were no others.
    pub(crate) fixed_only: bool,
}

/// Finds the objects that a view can see.
///
/// A query is a [`Method`] with the memory that it works in and its last result. Keep one for each
/// camera and light, and run it in every frame: runs of [`Method::Point`] take no memory where they
/// were before, and what a new place needs is kept.
///
/// # Use
///
/// [`Query::run`] fills the [`Pvs`] and lends it, and [`Query::pvs`] lends it again until the next
/// run. A run reads the scene and writes only the query, so that any number of queries can run on
/// one scene at the same time, each in its own thread (with the feature `rayon`,
/// `Query::run_all` does so). After the run,
/// [`Query::sight`] answers about boxes and points that are no objects of the scene.
///
/// ```
/// use casca::{Aabb, Method, ObjectDesc, PointOptions, Query, Scene, Sphere, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut scene = Scene::new(1.0)?;
/// let wall = Aabb::new(Vec3::new(8.0, 0.0, 0.0), Vec3::new(10.0, 32.0, 32.0));
/// scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let far = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(20.0, 16.0, 16.0), 1.0)))?;
///
/// let view = View::omnidirectional(Vec3::new(2.5, 16.5, 16.5))?;
/// let mut query = Query::with_method(Method::Point(PointOptions::fast()))?;
/// assert!(!query.run(&scene, &view).contains(far));
/// // The result stays until the next run.
/// assert_eq!(query.pvs().len(), 1);
/// query.set_method(Method::Frustum)?;
/// assert!(query.run(&scene, &view).contains(far), "the frustum alone hides nothing");
/// # Ok(())
/// # }
/// ```
///
/// # Cost
///
/// A run costs the cells and objects that can be seen rather than those that there are: see
/// [`Method`], and [`Stats`](crate::Stats) for the work of one. The memory grows to what the
/// largest run needs, with a few bytes for each slot of the scene. A clone has the same method and
/// result, and memory of its own.
///
/// # Guarantees
///
/// The set contains every object of which a point can be seen. It is the same on every machine and
/// does not depend on threads, nor on what the query ran before unless [`PointOptions::coherent`](crate::PointOptions::coherent) is
/// set. Nothing panics: views are checked when they are made.
///
/// # Pitfalls
///
/// - One query that serves several cameras in turn is right, but loses what coherent runs and
///   [`Scene::end_frame`] gain: that takes the result of each camera.
/// - A run overwrites the result. Clone the [`Pvs`] to compare it with the next one.
#[derive(Debug, Clone)]
pub struct Query {
    method: Method,
    pvs: Pvs,
    marks: Marks,
    cell: CellScratch,
    lists: CellLists,
    point: PointScratch,
    /// Whether runs of [`Method::Cell`] keep the cells that they visited and found hidden.
    record: bool,
    /// Whether runs of [`Method::Point`] use more than one thread.
    #[cfg(feature = "rayon")]
    parallel: bool,
    visited: Option<BitMatrix>,
    hidden: Option<OcclusionMatrix>,
    pub(crate) shadows: ReceiverScratch,
}

impl Default for Query {
    fn default() -> Self {
        Self::new()
    }
}

impl Query {
    /// A query by the default method: [`Method::Point`] with its default options.
    pub fn new() -> Self {
        Self {
            method: Method::default(),
            pvs: Pvs::empty(),
            marks: Marks::default(),
            cell: CellScratch::new(CellOptions::default().mask_resolution),
            lists: CellLists::default(),
            point: PointScratch::default(),
            record: false,
            #[cfg(feature = "rayon")]
            parallel: false,
            visited: None,
            hidden: None,
            shadows: ReceiverScratch::default(),
        }
    }

    /// A query by the method given.
    ///
    /// # Errors
    /// [`Error::Setting`] if one of its options is out of its range.
    pub fn with_method(method: Method) -> Result<Self, Error> {
        let mut query = Self::new();
        query.set_method(method)?;
        Ok(query)
    }

    /// The method, with its options.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Changes the method and its options from the next run on.
    ///
    /// # Errors
    /// [`Error::Setting`] if one of the options is out of its range. The query then keeps the old
    /// ones.
    pub fn set_method(&mut self, method: Method) -> Result<(), Error> {
        method.check()?;
        if let Method::Cell(options) = &method {
            self.cell.set_resolution(options.mask_resolution);
        }
        self.method = method;
        Ok(())
    }

    /// Finds the objects that a view can see: a superset of them, by its method.
    ///
    /// The result stays in the query ([`Query::pvs`]). [`Method`] says what each method finds and
    /// costs.
    pub fn run(&mut self, scene: &Scene, view: &View) -> &Pvs {
        self.run_with(scene, view, Extras::default())
    }

    /// As [`Query::run`], with what some methods are told besides.
    pub(crate) fn run_with(&mut self, scene: &Scene, view: &View, extras: Extras) -> &Pvs {
        let Extras { receivers, fixed_only } = extras;
        let pvs = &mut self.pvs;
        pvs.reset(scene.slot_count());
        pvs.scene = scene.tag();
        pvs.moves = scene.last_move();
        pvs.method = self.method;
        pvs.partial = receivers.is_some() || fixed_only;
        pvs.cell = None;
        pvs.viewer = view.eye().map(|e| scene.grid().cell_of(e));
        match &self.method {
            Method::Frustum => run_frustum(scene, view, pvs),
            Method::Cell(_) => {
                pvs.revision = scene.revision();
                let record = self.record.then(|| (BitMatrix::default(), BitMatrix::default()));
                (self.visited, self.hidden) = record.unzip();
                let record = self.visited.as_mut().zip(self.hidden.as_mut());
                self.lists.follow(scene);
                let (marks, lists, scratch) = (&mut self.marks, &self.lists, &mut self.cell);
                CellWalk::run((scene, view), pvs, marks, lists, scratch, record);
            }
            Method::Point(options) => {
                pvs.revision = scene.revision();
                let run = Run { fixed_only, ..Run::new(scene, view, options, receivers) };
                #[cfg(feature = "rayon")]
                let run = Run { parallel: self.parallel, ..run };
                self.point.run(run, pvs, &mut self.marks);
            }
        }
        match &mut pvs.view {
            Some(own) => own.clone_from(view),
            None => pvs.view = Some(view.clone()),
        }
        pvs
    }

    /// Brings the buffers of the last run of [`Method::Point`], on static objects only and of the
    /// same view, up to date with changes of those, and fills the set with the objects that came
    /// into sight. Returns the share of the pixels that were opened for it.
    pub(crate) fn follow(
        &mut self,
        scene: &Scene,
        view: &View,
        changes: &StaticChanges,
        offered: &Offered,
    ) -> f64 {
        self.pvs.reset(scene.slot_count());
        let options = match self.method {
            Method::Point(options) => options.unrefined(),
            _ => PointOptions::new().unrefined(),
        };
        let run = Run { fixed_only: true, ..Run::new(scene, view, &options, None) };
        self.point.follow(run, &mut self.pvs, &mut self.marks, changes, offered)
    }

    /// Finds nothing, as from a view without rays. The result is valid for no view.
    pub(crate) fn run_nothing(&mut self, scene: &Scene) {
        self.pvs.reset(scene.slot_count());
        self.pvs.scene = scene.tag();
        self.pvs.method = self.method;
        self.pvs.partial = false;
        (self.pvs.view, self.pvs.cell, self.pvs.viewer) = (None, None, None);
    }

    /// Runs each query on the view at the same index, in parallel. The results are the same as of
    /// single runs.
    ///
    /// If the slices differ in length, the rest of the longer one is ignored. Queries that
    /// [share](Query::set_parallel) their own work do so here, too: it helps at the end of a call,
    /// when some threads have nothing left to do.
    ///
    /// Needs the feature `rayon`.
    #[cfg(feature = "rayon")]
    pub fn run_all(queries: &mut [Self], scene: &Scene, views: &[View]) {
        use rayon::prelude::*;
        queries.par_iter_mut().zip(views).for_each(|(query, view)| {
            query.run(scene, view);
        });
    }

    /// Says whether runs of [`Method::Point`] by this query share their work among the threads of
    /// rayon's current pool. Default: false.
    ///
    /// Sets, their order and [`Stats`](crate::Stats) are the same for any number of threads. Any
    /// call that makes a run may share it, [`Query::run_all`] and runs inside of other tasks
    /// included; no pool is made but the one that rayon makes by itself. Runs of other methods, and
    /// what is asked after a run, use one thread.
    ///
    /// # Cost
    ///
    /// Shared are the second test of objects, and patches of triangles by the sides of the view
    /// cube, of which one may see most: seven to nine tenths of the work of a run that takes a
    /// millisecond or more. The walk from the eye outwards is not shared. Fewer than 32 objects, or
    /// 64 patches, are left to one thread. All threads together execute up to 3% more
    /// instructions. With as many views as cores, [`Query::run_all`] alone leaves less to one
    /// thread. Each thread that takes part keeps some memory in the query.
    ///
    /// Needs the feature `rayon`.
    #[cfg(feature = "rayon")]
    pub fn set_parallel(&mut self, parallel: bool) {
        self.parallel = parallel;
    }

    /// Whether runs share their work among threads: [`Query::set_parallel`].
    ///
    /// Needs the feature `rayon`.
    #[cfg(feature = "rayon")]
    pub fn is_parallel(&self) -> bool {
        self.parallel
    }

    /// Forgets the runs that a [coherent](crate::PointOptions::coherent) one builds on, as after a
    /// cut of the camera. The last result stays.
    pub fn reset(&mut self) {
        self.point.drawing.coherence.reset();
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }

    /// The occlusion buffers of the last run of [`Method::Point`], with what that run drew.
    pub(crate) fn drawn(&self) -> &DrawingScratch {
        &self.point.drawing
    }

    /// Says whether runs of [`Method::Cell`] keep the cells that they visited and found hidden.
    pub(crate) fn record_cells(&mut self, record: bool) {
        self.record = record;
    }

    /// The cells visited and those found hidden by the last run, if they were recorded.
    pub(crate) fn recorded(&self) -> (Option<&BitMatrix>, Option<&OcclusionMatrix>) {
        (self.visited.as_ref(), self.hidden.as_ref())
    }
}

/// Fills the set with the objects whose bounds may intersect the frustum.
fn run_frustum(scene: &Scene, view: &View, pvs: &mut Pvs) {
    pvs.revision = scene.moves();
    for (slot, object) in scene.living().filter(|(_, object)| object.is_shown(view)) {
        pvs.stats.objects_tested += 1;
        let seen = match object.unreported_volume() {
            Some(volume) => view.may_see_volume(volume),
            None => scene.is_unlocated(slot) || view.may_see(object.bounds()),
        };
        if seen {
            pvs.push(scene.id(slot));
        }
    }
}
