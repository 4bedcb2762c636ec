//! The scene: objects, lists of them by cell, and the frame loop.
//!
//! Every object is stored in a slot ([`slots`]). Objects inside the grid are in the lists of the cells that they touch
//! ([`lists`]). Those that leave the grid, or touch more cells than a query would skip by them, are in the list `outer`, which every
//! query looks at.

mod edit;
mod frame;
pub(crate) mod lists;
mod slots;

use crate::error::Error;
use crate::geometry::Shape;
use crate::grid::{Grid, GridSpec};
use crate::id::ObjectId;
use crate::object::{Motion, ObjectDesc};
use crate::scene::lists::CellLists;
use crate::scene::slots::Slots;

/// An object in its slot.
#[derive(Debug, Clone)]
pub(crate) struct Object {
    pub(crate) bounds: Shape,
    pub(crate) occluder: Option<Shape>,
    pub(crate) motion: Motion,
    pub(crate) user_data: u64,
    /// 1 + its place in the list of objects that are in no cells, or 0.
    outer: u32,
}

impl Object {
    fn new(desc: ObjectDesc) -> Self {
        let ObjectDesc { bounds, occluder, motion, user_data, .. } = desc;
        Self { bounds, occluder, motion, user_data, outer: 0 }
    }
}

/// Objects in a regular grid, shared read-only by any number of queries.
///
/// A frame: [`Scene::begin_frame`] with the time, [`Scene::update`] for the objects that moved, queries, and [`Scene::end_frame`] with
/// their results.
///
/// A clone is another scene. It knows the ids of all objects that it was made with, but not the ids that the original gives out
/// later, nor the other way round. Each refuses a [`crate::Pvs`] that was found on the other.
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
    slots: Slots,
    lists: CellLists,
    /// The slots of objects that are in no cells.
    outer: Vec<u32>,
    /// The clock, in seconds.
    now: f64,
    /// Changes with every change of the objects.
    revision: u64,
}

impl Scene {
    /// An empty scene on a grid. Costs four bytes for each 8x8 cells.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(spec: &GridSpec) -> Result<Self, Error> {
        let grid = Grid::new(spec)?;
        let lists = CellLists::new(&grid);
        Ok(Self { grid, slots: Slots::new(), lists, outer: Vec::new(), now: 0.0, revision: 0 })
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
        self.slots.find(id).is_ok()
    }

    /// The ids of all objects, in the order of their indices. Costs all slots.
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> {
        self.slots.living().map(|(slot, _)| self.slots.id(slot))
    }

    /// The bounds of an object.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn bounds(&self, id: ObjectId) -> Result<&Shape, Error> {
        Ok(&self.slots.find(id)?.bounds)
    }

    /// The occluder of an object, if it has one.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn occluder(&self, id: ObjectId) -> Result<Option<&Shape>, Error> {
        Ok(self.slots.find(id)?.occluder.as_ref())
    }

    /// Whether an object moves, and how fast.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn motion(&self, id: ObjectId) -> Result<Motion, Error> {
        Ok(self.slots.find(id)?.motion)
    }

    /// The number that the application gave to an object.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn user_data(&self, id: ObjectId) -> Result<u64, Error> {
        Ok(self.slots.find(id)?.user_data)
    }

    /// The time of the last [`Scene::begin_frame`], in seconds; 0 before the first.
    pub fn now(&self) -> f64 {
        self.now
    }

    /// Changes whenever an object came, went or changed. Results that were found at another revision may not hold any more.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// I: the objects that touch each cell.
    pub(crate) fn lists(&self) -> &CellLists {
        &self.lists
    }

    /// The objects that are in no cells: every query looks at them.
    pub(crate) fn outer(&self) -> &[u32] {
        &self.outer
    }

    /// Number of slots: all slots of objects are below.
    pub(crate) fn slot_count(&self) -> usize {
        self.slots.count()
    }

    /// All objects with their slots, in the order of these.
    pub(crate) fn living(&self) -> impl Iterator<Item = (u32, &Object)> {
        self.slots.living()
    }

    /// The object of a slot, if there is one.
    pub(crate) fn object(&self, slot: u32) -> Option<&Object> {
        self.slots.get(slot)
    }

    /// The id of the object in a slot.
    pub(crate) fn id(&self, slot: u32) -> ObjectId {
        self.slots.id(slot)
    }

    /// Tells scenes apart.
    pub(crate) fn tag(&self) -> u32 {
        self.slots.tag()
    }
}
