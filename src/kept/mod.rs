//! Queries that answer many frames from one result.

mod job;
mod still;
mod watch;

use glam::DVec3;

use crate::error::{Error, not_negative};
use crate::kept::job::Snapshots;
use crate::kept::still::{Stamp, Still, serves};
use crate::method::{Method, PointOptions};
use crate::pvs::{Pvs, Stats};
use crate::query::{CameraQuery, Query, Sight, sealed};
use crate::scene::Scene;
use crate::view::View;
use crate::view::motion::EyeMotion;

pub use job::{KeptJob, KeptResult};

/// A result is found for the way that the camera goes in this many frames, if it goes on like that.
const FRAMES: f64 = 8.0;

/// The eye may stray from that way by this share of half its length, and turn farther by this.
const ASTRAY: f64 = 0.125;
const TURNED_ASTRAY: f64 = 0.25;

/// It may by this share of the reach and of the turn in any case: cameras that stand tremble.
const TREMBLE: f64 = 1.0 / 128.0;

/// A camera that uses more of its bounds in a frame jumps: a result for its way serves few frames.
const JUMP: f64 = 0.5;

/// A camera that left its way before this many frames goes to and fro: the next result is for all
/// places and turns around it that it may come to.
const STEADY: u32 = 3;

/// How far the camera of a [`KeptQuery`] may go and turn before a new result is needed, at most.
///
/// A result is found for the way that a camera goes on in eight frames and some room around it,
/// within these bounds: slow cameras have smaller sets. First of all, after a jump, and where
/// the camera goes by more than half of a bound in a frame, it is found for one view. Greater
/// bounds make results for fast cameras last longer, and their sets larger.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct KeptOptions {
    /// How far the eye may go from the middle of that way, in world units.
    pub reach: f32,
    /// How far the camera may turn from how it looks there, in radians.
    pub turn: f32,
}

impl Default for KeptOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl KeptOptions {
    /// The default options: a reach of 0.25 world units and a turn of 0.15 radians.
    pub const fn new() -> Self {
        Self { reach: 0.25, turn: 0.15 }
    }

    /// Sets [`KeptOptions::reach`], in world units.
    #[must_use]
    pub const fn reach(mut self, distance: f32) -> Self {
        self.reach = distance;
        self
    }

    /// Sets [`KeptOptions::turn`], in radians.
    #[must_use]
    pub const fn turn(mut self, angle: f32) -> Self {
        self.turn = angle;
        self
    }
}

/// Finds the objects that a camera can see, frame after frame, and answers most frames from an
/// earlier result about static objects.
///
/// A [`Query`] starts anew in each frame. A kept query finds the static objects that can be seen
/// from anywhere on the way that the camera goes next ([`KeptOptions`]), by [`Method::Point`], and
/// answers frames from that while the camera is there. In each frame it cuts that set by the
/// frustum, and tests dynamic objects where they are now, against the occlusion buffers of the
/// static ones. When the result does not hold any more, the run finds a new one; or another thread
/// does so in time ([`KeptQuery::prepare`]).
///
/// Static objects may come, go and change meanwhile, as where a level is streamed: the result
/// follows. One that comes is tested and its occluder drawn. Where an occluder goes that hid
/// something, the pixels that it may have covered are opened, and a walk finds what lies behind.
/// After more than 2,048 changes between two runs, or once as many pixels were opened as there are,
/// a new result is found.
///
/// No visible object is missing in any frame. Sets are larger than those of a [`Query`]: by what
/// can be seen from near the eye only, and by what only dynamic occluders hide. It pays where large
/// static occluders hide much, and where few objects move. Results depend only on the sequence of
/// calls.
///
/// ```
/// use casca::{Aabb, KeptOptions, KeptQuery, ObjectDesc, Scene, Sphere, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut scene = Scene::new(1.0)?;
/// let wall = Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 17.0));
/// scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let ball = |x: f32| Sphere::new(Vec3::new(x, 16.0, 24.0), 0.5);
/// let ball_id = scene.insert(ObjectDesc::dynamic(ball(4.0)).max_speed(2.0))?;
///
/// let mut query = KeptQuery::with_options(KeptOptions::new().reach(0.5))?;
/// for frame in 0..10 {
///     scene.begin_frame(f64::from(frame) / 60.0)?;
///     scene.update(ball_id, ball(4.0 + 0.03 * frame as f32), None)?;
///     let eye = Vec3::new(16.0 + 0.03 * frame as f32, 16.0, 8.0);
///     let pvs = query.run(&scene, &View::omnidirectional(eye)?);
///     assert!(!pvs.contains(ball_id), "the ball is behind the wall");
///     scene.end_frame([query.pvs()])?;
/// }
/// assert_eq!(query.refreshes(), 2, "one for the first view, one for the way from there on");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct KeptQuery {
    options: KeptOptions,
    /// A query that never ran.
    fresh: Query,
    /// A query whose memory is used again.
    spare: Option<Box<Query>>,
    /// The result that frames are answered from.
    now: Option<Box<Still>>,
    /// The result installed last, until a view comes that it holds for.
    next: Option<Box<Still>>,
    /// The scene as jobs read it.
    snapshots: Snapshots,
    /// The view of the last run, and how the camera came there.
    last: Option<(View, Option<EyeMotion>)>,
    /// Whether the last result that a run found is for the camera's way, and the runs since then.
    on_way: bool,
    served: u32,
    pvs: Pvs,
    refreshes: u64,
}

impl Default for KeptQuery {
    fn default() -> Self {
        Self::new()
    }
}

impl KeptQuery {
    /// A kept query with the default options.
    pub fn new() -> Self {
        Self {
            options: KeptOptions::new(),
            fresh: Query::with_method(Method::Point(PointOptions::new().coherent(true))).unwrap_or_default(),
            spare: None,
            now: None,
            next: None,
            snapshots: Snapshots::default(),
            last: None,
            on_way: false,
            served: 0,
            pvs: Pvs::empty(),
            refreshes: 0,
        }
    }

    /// A kept query with other options.
    ///
    /// # Errors
    /// Refuses a reach or an angle that is negative or not finite.
    pub fn with_options(options: KeptOptions) -> Result<Self, Error> {
        not_negative("the reach", f64::from(options.reach))?;
        not_negative("the angle", f64::from(options.turn))?;
        Ok(Self { options, ..Self::new() })
    }

    /// The options.
    pub fn options(&self) -> KeptOptions {
        self.options
    }

    /// Changes the options of the queries that find new results: by default [`PointOptions::new`],
    /// but [coherent](PointOptions::coherent). The present result is forgotten.
    ///
    /// # Errors
    /// [`Error::Setting`] if one of the options is out of its range. The query then stays as it is.
    pub fn set_point_options(&mut self, options: PointOptions) -> Result<(), Error> {
        self.fresh = Query::with_method(Method::Point(options))?;
        self.reset();
        Ok(())
    }

    /// Forgets all results: the next run finds a new one. [`KeptQuery::pvs`] stays.
    pub fn reset(&mut self) {
        (self.spare, self.now, self.next) = (None, None, None);
        (self.snapshots, self.last) = (Snapshots::default(), None);
    }

    /// Finds the objects that a view can see: a superset of them. Static objects come first,
    /// roughly front to back.
    ///
    /// Costs a test of each static object in the result and of each that came or changed, of each
    /// dynamic object that is in no volume and of each volume in sight. Where a static occluder
    /// that hid something went, it also costs a walk over the bricks in sight and a test of all
    /// volumes. If the result does not hold, it costs a query of the widened view.
    pub fn run(&mut self, scene: &Scene, view: &View) -> &Pvs {
        let motion = self.last.as_ref().and_then(|(last, _)| EyeMotion::between(last, view));
        self.last = Some((view.clone(), motion));
        if self.next.as_ref().is_some_and(|next| next.holds(scene, view)) {
            let old = std::mem::replace(&mut self.now, self.next.take());
            self.spare = old.map(|still| still.into_query());
        }
        let holds = self.now.as_ref().is_some_and(|now| now.holds(scene, view));
        if !holds {
            self.spare = self.now.take().map(|still| still.into_query()).or(self.spare.take());
            self.refreshes += 1;
        }
        let mut now = self.now.take().unwrap_or_else(|| {
            let (aim, on_way) = self.aim(scene, view);
            (self.on_way, self.served) = (on_way, 0);
            Box::new(Still::find(self.take_query(), scene, aim, Stamp::of(scene)))
        });
        self.served = self.served.saturating_add(1);
        self.begin(scene, view, if holds { Stats::default() } else { *now.stats() });
        now.follow(scene);
        now.answer(scene, view, &mut self.pvs);
        self.now = Some(now);
        &self.pvs
    }

    /// The result of the last run; empty before the first. It is valid for the view of that run, as
    /// that of a [`Query`] is.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }

    /// The view of the last run with the occlusion buffers of static objects, for questions about
    /// anything in space: see [`Query::sight`]. `None` before the first run. Buffers count as long
    /// as no static object came, went or changed. Dynamic occluders do not.
    pub fn sight(&self, scene: &Scene) -> Option<Sight<'_>> {
        let view = self.pvs.view.as_ref()?;
        let now = self.now.as_ref().filter(|now| now.is_of(scene) && now.holds(scene, view));
        Some(Sight::new(scene, view, now.map(|now| now.drawn())))
    }

    /// How many runs had to find a new result.
    pub fn refreshes(&self) -> u64 {
        self.refreshes
    }

    /// A job that finds a new result ahead of time, for views like this one. Run it on any thread,
    /// and give its result to [`KeptQuery::install`].
    ///
    /// The job reads a copy of the scene. The first call makes it, which costs what
    /// [`Scene::clone`] costs; a call while the job before is not done makes a second one. Other
    /// calls take over the static objects that came, went or changed since, which costs what
    /// inserting and removing them costs. After more than 2,048 such changes between two calls the
    /// scene is copied again. Dynamic objects of the copy grow old, but are not looked at.
    pub fn prepare(&mut self, scene: &Scene, view: &View) -> KeptJob {
        let (view, query) = (self.aim(scene, view).0, self.take_query());
        self.snapshots.job(scene, view, query)
    }

    /// Takes over the result of a job. Runs answer from it as soon as it holds for their view,
    /// brought up to date with the static objects that came, went or changed since the job saw the
    /// scene. Returns false, and changes nothing, if more than 2,048 did, or if the scene is
    /// another one.
    pub fn install(&mut self, result: KeptResult, scene: &Scene) -> bool {
        let fits = result.0.can_follow(scene);
        let old = if fits { self.next.replace(result.0) } else { Some(result.0) };
        self.spare = old.map(|still| still.into_query()).or(self.spare.take());
        fits
    }

    /// Whether the next run answers from a result that it has, if this is its view.
    pub fn is_valid_for(&self, scene: &Scene, view: &View) -> bool {
        self.now.iter().chain(&self.next).any(|still| still.holds(scene, view))
    }

    /// The view that a result is found for, and whether it is that of the way that the camera goes.
    fn aim(&self, scene: &Scene, view: &View) -> (View, bool) {
        let (reach, turn) = (f64::from(self.options.reach), f64::from(self.options.turn));
        let motion = self.last.as_ref().and_then(|(_, motion)| *motion);
        let goes_on = |by: &EyeMotion| by.step.length() <= JUMP * reach && by.angle <= JUMP * turn;
        let Some(motion) = motion.filter(goes_on) else {
            return (view.widened(DVec3::ZERO, 0.0, 0.0), false);
        };
        let half = motion.times(FRAMES * 0.5, reach / (1.0 + ASTRAY), turn / (1.0 + TURNED_ASTRAY));
        let aside = (ASTRAY * half.step.length()).max(TREMBLE * reach);
        let turned = (TURNED_ASTRAY * half.angle).max(TREMBLE * turn);
        let ahead = view.moved(&half).widened(half.step, aside, half.angle + turned);
        if self.on_way && self.served < STEADY || !serves(&ahead, scene, view) {
            return (view.widened(DVec3::ZERO, half.step.length() + aside, half.angle + turned), false);
        }
        // What trembles goes nowhere.
        (ahead, aside > TREMBLE * reach || turned > TREMBLE * turn)
    }

    /// A query with the memory of an earlier one, if there is one.
    fn take_query(&mut self) -> Box<Query> {
        let mut query = self.spare.take().unwrap_or_else(|| Box::new(self.fresh.clone()));
        // An old result may have brought a query with other options. These are in their ranges.
        if query.set_method(self.fresh.method()).is_err() {
            return Box::new(self.fresh.clone());
        }
        query
    }

    /// Empties the set for a view.
    fn begin(&mut self, scene: &Scene, view: &View, stats: Stats) {
        let pvs = &mut self.pvs;
        pvs.reset(scene.slot_count());
        (pvs.scene, pvs.revision, pvs.moves) = (scene.tag(), scene.revision(), scene.last_move());
        (pvs.method, pvs.stats) = (self.fresh.method(), stats);
        pvs.viewer = view.eye().map(|eye| scene.grid().cell_of(eye));
        pvs.view = Some(view.clone());
    }
}

impl sealed::Sealed for KeptQuery {}

impl CameraQuery for KeptQuery {
    fn pvs(&self) -> &Pvs {
        Self::pvs(self)
    }

    fn sight(&self, scene: &Scene) -> Option<Sight<'_>> {
        Self::sight(self, scene)
    }
}
