//! The scene: objects, lists of them by cell, and the frame loop.
//!
//! Every object is stored in a [`Slot`]. Objects inside the grid are in the lists of the cells that
//! they touch ([`lists`]). Those that leave the grid, or touch more cells than a query would skip
//! by them, are in the list `outer`, which every query looks at.
//!
//! The matrices of the thesis (section 3.1): Os has the cells inside static occluders, and O those
//! and the cells inside dynamic ones ([`crate::matrix`]), or inside several together ([`fill`]); I
//! is the lists; T has the outlines of the volumes that stand for hidden dynamic objects
//! ([`crate::volume`], [`state`]). H belongs to a query ([`crate::cell`]).
//!
//! A frame: [`Scene::begin_frame`] sets the clock and tells which objects are due for a report; the
//! application moves objects; queries read the scene; [`Scene::end_frame`] takes their results, and
//! puts dynamic objects that no view saw into volumes.

mod doors;
mod edit;
mod fill;
mod frame;
mod hiding;
pub(crate) mod lists;
mod object;
mod state;
mod tiles;

use casca_slots::{ExpiryQueue, Slot, SlotSet, Slots};
use glam::IVec2;

use crate::error::Error;
use crate::geometry::Shape;
use crate::grid::{Grid, GridSpec};
use crate::id::ObjectId;
use crate::matrix::{CrossBits, Opacity};
use crate::object::Motion;
use crate::scene::lists::CellLists;
use crate::volume::Volumes;

pub use doors::TileDoor;
pub use frame::FrameReport;
pub(crate) use object::Object;

/// Objects in a regular grid, shared read-only by any number of queries.
///
/// A frame: [`Scene::begin_frame`] with the time, [`Scene::update`] for the objects that moved,
/// queries, and [`Scene::end_frame`] with their results.
///
/// A clone is another scene. It knows the ids of all objects that it was made with, but not the ids
/// that the original gives out later, nor the other way round. Each refuses a [`crate::Pvs`] that
/// was found on the other.
///
/// ```
/// use casca_plane::{Disc, GridSpec, ObjectDesc, Query, Scene, Segment, View};
/// use glam::{UVec2, Vec2};
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(32) })?;
/// let wall = Segment::new(Vec2::new(8.0, 1.0), Vec2::new(8.0, 31.0));
/// let wall = scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let near = scene.insert(ObjectDesc::fixed(Disc::new(Vec2::new(4.0, 16.0), 1.0)))?;
/// let far = scene.insert(ObjectDesc::fixed(Disc::new(Vec2::new(12.0, 16.0), 1.0)))?;
/// let mut query = Query::new();
/// let pvs = query.run(&scene, &View::all_round(Vec2::new(2.5, 16.5))?);
/// assert!(pvs.contains(wall) && pvs.contains(near) && !pvs.contains(far));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    grid: Grid,
    slots: Slots<Object>,
    lists: CellLists,
    /// The slots of objects that are in no cells, as they are too large or leave the grid.
    outer: Vec<Slot>,
    /// Os: the cells that static occluders fill.
    fixed: Opacity,
    /// The cells that listed dynamic occluders add to make O.
    moving: Opacity,
    /// The cells that solids of both kinds cover together, and none alone when they were decided.
    joined: CrossBits,
    volumes: Volumes,
    /// Dynamic objects in the lists of cells, or too large for them.
    listed: SlotSet,
    /// How many of them are reported on expiry.
    listed_on_expiry: u32,
    /// Objects that every query counts as visible, since their place is unknown.
    lost: SlotSet,
    expiries: ExpiryQueue,
    /// Cells of the viewers of the last frame.
    viewers: Vec<IVec2>,
    /// Number of the frame, counted by [`Scene::begin_frame`].
    frame: u64,
    /// Volumes drawn since the last frame ended.
    drawn: usize,
    /// Memory used again: the objects in sight, a bit for each slot.
    seen: Vec<u64>,
    /// The clock, in seconds.
    now: f64,
    /// Changes with every change of the objects.
    revision: u64,
}

impl Scene {
    /// An empty scene on a grid. Costs a byte for each cell.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(spec: &GridSpec) -> Result<Self, Error> {
        let grid = Grid::new(spec)?;
        let dims = grid.dims().as_uvec2();
        Ok(Self {
            grid,
            slots: Slots::new(),
            lists: CellLists::new(&grid),
            outer: Vec::new(),
            fixed: Opacity::new(dims),
            moving: Opacity::new(dims),
            joined: CrossBits::new(dims),
            volumes: Volumes::new(&grid),
            listed: SlotSet::default(),
            listed_on_expiry: 0,
            lost: SlotSet::default(),
            expiries: ExpiryQueue::default(),
            viewers: Vec::new(),
            frame: 1,
            drawn: 0,
            seen: Vec::new(),
            now: 0.0,
            revision: 0,
        })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of objects.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there are no objects.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether an id names an object of this scene.
    pub fn contains(&self, id: ObjectId) -> bool {
        self.find(id).is_ok()
    }

    /// The ids of all objects, in the order of their indices. Costs all slots.
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> {
        self.living().map(|(slot, _)| self.id(slot))
    }

    /// The bounds of an object.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn bounds(&self, id: ObjectId) -> Result<&Shape, Error> {
        Ok(&self.find(id)?.bounds)
    }

    /// The occluder of an object, if it has one.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn occluder(&self, id: ObjectId) -> Result<Option<&Shape>, Error> {
        Ok(self.find(id)?.occluder.as_ref())
    }

    /// Whether an object moves, and how fast.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn motion(&self, id: ObjectId) -> Result<Motion, Error> {
        Ok(self.find(id)?.motion)
    }

    /// The number that the application gave to an object.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn user_data(&self, id: ObjectId) -> Result<u64, Error> {
        Ok(self.find(id)?.user_data)
    }

    /// The layers that an object is on, a bit for each: see [`crate::ObjectDesc::layers`].
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn layers(&self, id: ObjectId) -> Result<u64, Error> {
        Ok(self.find(id)?.layers)
    }

    /// The time of the last [`Scene::begin_frame`], in seconds; 0 before the first.
    pub fn now(&self) -> f64 {
        self.now
    }

    /// Changes whenever an object came, went or changed. Results that were found at another
    /// revision may not hold any more.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// I: the objects that touch each cell.
    pub(crate) fn lists(&self) -> &CellLists {
        &self.lists
    }

    /// Os and the rest of O: the cells that occluders fill, alone or together.
    pub(crate) fn opacity(&self) -> [&CrossBits; 3] {
        [self.fixed.bits(), self.moving.bits(), &self.joined]
    }

    /// T: the temporal bounding volumes.
    pub(crate) fn volumes(&self) -> &Volumes {
        &self.volumes
    }

    /// Calls `found` with the hidden objects in whose volume an eye in a cell may be: the outline
    /// does not stand for them. For a cell outside of the grid these are all, as outlines end at
    /// the border.
    pub(crate) fn volumes_around(&self, cell: IVec2, mut found: impl FnMut(Slot)) {
        if self.grid.contains(cell) {
            self.volumes.holding(cell, found);
        } else {
            self.living().filter(|(_, object)| object.is_hidden()).for_each(|(slot, _)| found(slot));
        }
    }

    /// The objects whose place is unknown.
    pub(crate) fn lost(&self) -> &[Slot] {
        self.lost.as_slice()
    }

    /// The objects that are in no cells, as they are too large or leave the grid: every query looks
    /// at them.
    pub(crate) fn outer(&self) -> &[Slot] {
        &self.outer
    }

    /// Number of slots: all slots of objects are below.
    pub(crate) fn slot_count(&self) -> usize {
        self.slots.count()
    }

    /// All objects with their slots, in the order of these.
    pub(crate) fn living(&self) -> impl Iterator<Item = (Slot, &Object)> {
        self.slots.iter()
    }

    /// The object of a slot, if there is one.
    pub(crate) fn object(&self, slot: Slot) -> Option<&Object> {
        self.slots.get(slot)
    }

    /// The id of the object in a slot.
    pub(crate) fn id(&self, slot: Slot) -> ObjectId {
        ObjectId(self.slots.id(slot))
    }

    /// The object that an id names.
    pub(crate) fn find(&self, id: ObjectId) -> Result<&Object, Error> {
        self.slots.find(id.0).ok_or(Error::UnknownObject(id))
    }

    /// Tells scenes apart.
    pub(crate) fn tag(&self) -> u32 {
        self.slots.tag()
    }
}
