//! Worlds larger than single precision: places in double precision, pages that are loaded and
//! dropped, and an origin that follows the eye.
//!
//! # Pages, anchors and the origin
//!
//! A [`Scene`] has shapes in single precision. A world keeps each object as it was described,
//! relative to an *anchor* in double precision: the corner of its *page* (a cube of 512 cells, named
//! by whole numbers), or a place of its own for what moves through the world. The scene that queries
//! read is made from these: its coordinates are relative to the corner of a page near the eye.
//!
//! Each shape is rounded once, from its description, and not again with every shift
//! ([`source`], `geometry::offset`): bounds outwards, occluders inwards, and not at all where the
//! sums are single numbers. Corners of pages are exact.
//!
//! # An origin that moves
//!
//! All coordinates change with the origin. So a second scene is made, in the new coordinates, a
//! number of objects in each frame ([`succession`]), while the first one answers queries. All
//! changes go to both. Once everything was taken over, the second takes the place of the first,
//! under the same ids; that costs hardly more than any frame. There is no moment in which an object
//! is in neither: the first is whole until it goes, the second when it comes. Until then the eye may
//! be anywhere.
//!
//! The second scene is another one: results from before are refused as those of a foreign scene are
//! ([`crate::Pvs::is_valid_for`] says no, [`crate::Query::sight`] has no occlusion, a
//! [`crate::KeptQuery`] finds a new result). Ids and keys stay.
//!
//! # Cost
//!
//! Memory follows what is loaded: an object takes its description beside its record in the scene,
//! and both scenes while the origin moves. A frame costs the objects that are loaded and dropped in
//! it, as many of the shift, and the changes of movers (twice during a shift); all but the
//! last are bounded by [`WorldOptions::budget`]. A scene that was replaced is dropped at once, in
//! milliseconds, unless another thread does it ([`World::take_retired`]); and movers come back into
//! volumes in the frames after a shift ([`crate::MOST_NEW_VOLUMES`]).

mod edit;
mod frame;
mod options;
mod page;
mod source;
mod succession;
mod task;

use std::collections::{BTreeMap, VecDeque};
use std::fmt;

use glam::DVec3;

use crate::error::Error;
use crate::geometry::offset::Offset;
use crate::geometry::{Aabb, Block};
use crate::id::ObjectId;
use crate::scene::Scene;
use crate::scene::origin::check_place;
use crate::world::source::ObjectSource;
use crate::world::succession::NextScene;
use crate::world::task::Task;

pub use frame::WorldFrame;
pub use options::WorldOptions;
pub use page::{PAGE_CELLS, PageId, PageObjects};

/// A world of any size: objects at places in double precision, in pages that are loaded and dropped
/// while queries run, and a [`Scene`] around the eye.
///
/// # Use
///
/// Prepare the objects of a page on any thread ([`PageObjects::new`]), with their meshes, and hand
/// them over ([`World::load`]). Insert what moves through the world at its place
/// ([`World::insert`]). A frame is [`World::begin_frame`] with the time and the eye, the moves
/// ([`World::set_place`]), queries of [`World::scene`], and [`World::end_frame`] with their
/// results. Views are those of a renderer that draws relative to the eye ([`Scene::view`]). All
/// queries, kept ones and other answers work on the scene as usual.
///
/// ```
/// use casca::{Aabb, ObjectDesc, PageId, PageObjects, Query, Sphere, View, World, WorldOptions};
/// use glam::{DVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut world = World::new(WorldOptions::new(1.0))?;
/// // A thousand kilometres from the origin.
/// let eye = DVec3::new(1.0e6 + 0.25, 20.0, 16.0);
/// let page = world.page_at(eye)?;
/// // Shapes in a page are relative to its least corner.
/// let wall = Aabb::new(Vec3::new(90.0, 0.0, 0.0), Vec3::new(92.0, 60.0, 60.0));
/// let ball = Sphere::new(Vec3::new(110.0, 20.0, 16.0), 1.0);
/// let objects = PageObjects::new([
///     ObjectDesc::fixed(wall).occluder(wall).user_data(1),
///     ObjectDesc::fixed(ball).user_data(2),
/// ])?;
/// world.load(page, objects)?;
/// let bird = ObjectDesc::dynamic(Sphere::new(Vec3::ZERO, 0.2)).user_data(3);
/// let bird = world.insert(bird, eye + DVec3::X * 5.0)?;
/// let mut query = Query::new();
/// for frame in 0..3 {
///     world.begin_frame(f64::from(frame) / 60.0, eye)?;
///     world.set_place(bird, eye + DVec3::new(5.0, 0.1 * f64::from(frame), 0.0))?;
///     // The view as it is at the origin; `View::perspective` takes the matrix without the eye.
///     let view = world.scene().view(eye, &View::omnidirectional(Vec3::ZERO)?)?;
///     let seen: Vec<u64> = query
///         .run(world.scene(), &view)
///         .iter()
///         .map(|id| world.scene().user_data(id))
///         .collect::<Result<_, _>>()?;
///     assert!(seen.contains(&1) && seen.contains(&3));
///     assert!(!seen.contains(&2), "the ball is behind the wall");
///     world.end_frame([query.pvs()])?;
/// }
/// # Ok(())
/// # }
/// ```
///
/// # Guarantees
///
/// An object that is loaded and can be seen is in every set: in the frames in which pages come and
/// go and the origin moves, and across the borders of pages. What is not loaded
/// is not known. Visibility is that of the places and shapes as given, without rounding; transforms
/// of shapes have the room for renderers of single precision that
/// [`ObjectDesc::placed`](crate::ObjectDesc::placed) tells of. What is found depends only on the
/// sequence of calls.
///
/// # Pitfalls
///
/// - An object counts from the frame that reports its page as loaded, or a few before it, until its
///   page is reported as dropped ([`WorldFrame`]). Keep drawing what is in the sets until then: it
///   hides other things.
/// - A shift takes over all objects that are loaded. Give a budget by which it is done before the
///   eye has gone a few pages more.
/// - Coordinates that are multiples of a 2048th of a cell are not rounded up to 16 pages from the
///   origin with cells of a power of two. Others are, by up to a 4096th of a cell: walls that abut
///   exactly then leave gaps that wide.
/// - Meshes become instances in the scene: they fill no cells for [`crate::Method::Cell`].
pub struct World {
    options: WorldOptions,
    /// The page whose least corner is the origin of the scene.
    origin_page: PageId,
    scene: Scene,
    /// The scene around the next origin.
    next: Option<NextScene>,
    /// The objects as described, by slot.
    sources: Vec<Option<ObjectSource>>,
    /// The objects of the pages that are loaded, wholly or in part.
    pages: BTreeMap<PageId, Vec<ObjectId>>,
    tasks: VecDeque<Task>,
    /// The last scene that was replaced, for the caller to drop.
    retired: Option<Scene>,
    /// The scenes before this one.
    former: Vec<u32>,
}

impl World {
    /// An empty world.
    ///
    /// # Errors
    /// As [`WorldOptions::check`].
    pub fn new(options: WorldOptions) -> Result<Self, Error> {
        options.check()?;
        Ok(Self {
            scene: Scene::new(options.cell)?,
            options,
            origin_page: PageId::default(),
            next: None,
            sources: Vec::new(),
            pages: BTreeMap::new(),
            tasks: VecDeque::new(),
            retired: None,
            former: Vec::new(),
        })
    }

    /// The options.
    pub fn options(&self) -> &WorldOptions {
        &self.options
    }

    /// The scene around the eye, for queries. Its coordinates are those of the world less
    /// [`World::origin`].
    #[inline]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The place of the origin of the scene's coordinates: the corner of a page. It changes in
    /// [`World::begin_frame`] and [`World::settle`] only, with the scene.
    pub fn origin(&self) -> DVec3 {
        self.scene.origin()
    }

    /// The edge length of a page in world units.
    pub fn page_size(&self) -> f64 {
        self.options.page_size()
    }

    /// The page that contains a place; a place on a face belongs to the upper page.
    ///
    /// # Errors
    /// Refuses places that are not finite, or beyond the last page ([`Error::TooFar`]).
    pub fn page_at(&self, at: DVec3) -> Result<PageId, Error> {
        check_place("the place", at)?;
        PageId::containing(at, self.options.page_size()).ok_or(Error::TooFar { what: "the place", value: at })
    }

    /// The least corner of a page, which its objects are relative to.
    pub fn corner(&self, page: PageId) -> DVec3 {
        page.corner(self.options.page_size())
    }

    /// A box in the scene's coordinates, rounded outwards, for [`crate::Sight::may_see_box`].
    ///
    /// # Errors
    /// Refuses corners that are not finite or farther than 2^60 world units from the origin.
    pub fn scene_box(&self, min: DVec3, max: DVec3) -> Result<Aabb, Error> {
        check_place("the corner", min)?;
        check_place("the corner", max)?;
        let at = |corner| Offset::between(corner, self.origin());
        let (low, high) = (at(min), at(max));
        Ok(Block { min: low.by - low.error, max: high.by + high.error }.to_aabb())
    }

    /// Whether a page has objects in the scene.
    pub fn is_loaded(&self, page: PageId) -> bool {
        self.pages.contains_key(&page)
    }

    /// The objects of a page that are in the scene, in the order in which they were given; some may
    /// have been removed since. Empty for a page that is not loaded.
    pub fn page_objects(&self, page: PageId) -> &[ObjectId] {
        self.pages.get(&page).map_or(&[], Vec::as_slice)
    }

    /// The place that an object is relative to: the corner of its page, or the last one given.
    ///
    /// # Errors
    /// Refuses an id that names no object of this world.
    pub fn place(&self, id: ObjectId) -> Result<DVec3, Error> {
        self.scene.find(id)?;
        Ok(self.source(id).map_or(DVec3::NAN, |source| source.place))
    }

    /// The page that an object goes with; `None` for one that belongs to the world.
    ///
    /// # Errors
    /// Refuses an id that names no object of this world.
    pub fn page(&self, id: ObjectId) -> Result<Option<PageId>, Error> {
        self.scene.find(id)?;
        Ok(self.source(id).and_then(|source| source.page))
    }

    /// Whether the origin is moving: two scenes are kept until it has.
    pub fn is_shifting(&self) -> bool {
        self.next.is_some()
    }

    /// Bytes that the world takes on the heap: its scenes, and the descriptions of objects. Costs a
    /// walk over all bricks and objects. Shapes that several objects share count once for each
    /// scene.
    pub fn memory_bytes(&self) -> usize {
        let scenes = [Some(&self.scene), self.next.as_ref().map(NextScene::scene), self.retired.as_ref()];
        scenes.into_iter().flatten().map(|scene| scene.memory().total()).sum::<usize>()
            + self.sources.capacity() * size_of::<Option<ObjectSource>>()
            + self.pages.values().map(|ids| ids.capacity() * size_of::<ObjectId>()).sum::<usize>()
            + self.tasks.iter().map(Task::bytes).sum::<usize>()
    }

    /// An object as described.
    fn source(&self, id: ObjectId) -> Option<&ObjectSource> {
        self.sources.get(id.index())?.as_ref()
    }
}

impl fmt::Debug for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World")
            .field("options", &self.options)
            .field("origin", &self.origin())
            .field("objects", &self.scene.len())
            .field("pages", &self.pages.len())
            .field("shifting", &self.is_shifting())
            .finish_non_exhaustive()
    }
}
