//! The scene: objects, and lists of them by cell.
//!
//! Every object is stored in a [`Slot`]. Objects inside the grid are in the lists of the cells that
//! they touch ([`lists`]). Those that leave the grid, or touch more cells than a query would skip
//! by them, are in the list `outer`, which every query looks at.

pub(crate) mod lists;
mod tiles;

use casca_slots::{Slot, Slots};

use crate::error::Error;
use crate::geometry::Shape;
use crate::grid::{Grid, GridSpec};
use crate::id::ObjectId;
use crate::numeric::{OCCLUDER_ROUNDING, OCCLUDER_SHARE};
use crate::raster::touched;
use crate::scene::lists::CellLists;

/// An object to insert into a scene. It may move at any time ([`crate::Scene::update`]).
///
/// ```
/// use casca_plane::{Disc, ObjectDesc, Segment};
/// use glam::Vec2;
///
/// let wall = Segment::new(Vec2::ZERO, Vec2::new(10.0, 0.0));
/// let wall = ObjectDesc::new(wall).occluder(wall);
/// let guard = ObjectDesc::new(Disc::new(Vec2::splat(5.0), 0.4)).user_data(7);
/// # let _ = (wall, guard);
/// ```
#[derive(Debug, Clone)]
pub struct ObjectDesc {
    bounds: Shape,
    occluder: Option<Shape>,
    user_data: u64,
}

impl ObjectDesc {
    /// An object that hides nothing.
    pub fn new(bounds: impl Into<Shape>) -> Self {
        Self { bounds: bounds.into(), occluder: None, user_data: 0 }
    }

    /// Lets the object hide others. The occluder must lie inside the bounds.
    #[must_use]
    pub fn occluder(mut self, occluder: impl Into<Shape>) -> Self {
        self.occluder = Some(occluder.into());
        self
    }

    /// Gives the object a number of the application's, 0 if none is given: see
    /// [`crate::Scene::user_data`].
    #[must_use]
    pub fn user_data(mut self, user_data: u64) -> Self {
        self.user_data = user_data;
        self
    }
}

/// Objects in a regular grid, shared read-only by any number of queries.
///
/// A clone is another scene. It knows the ids of all objects that it was made with, but not the ids
/// that the original gives out later, nor the other way round.
///
/// ```
/// use casca_plane::{Disc, GridSpec, ObjectDesc, Query, Scene, Segment, View};
/// use glam::{UVec2, Vec2};
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(32) })?;
/// let wall = Segment::new(Vec2::new(8.0, 1.0), Vec2::new(8.0, 31.0));
/// let wall = scene.insert(ObjectDesc::new(wall).occluder(wall))?;
/// let near = scene.insert(ObjectDesc::new(Disc::new(Vec2::new(4.0, 16.0), 1.0)))?;
/// let far = scene.insert(ObjectDesc::new(Disc::new(Vec2::new(12.0, 16.0), 1.0)))?;
/// let mut query = Query::new();
/// let pvs = query.run(&scene, &View::all_round(Vec2::new(2.5, 16.5))?);
/// assert!(pvs.contains(wall) && pvs.contains(near) && !pvs.contains(far));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) grid: Grid,
    slots: Slots<Object>,
    /// The objects that touch each cell.
    pub(crate) lists: CellLists,
    /// The slots of objects that are in no cells, as they are too large or leave the grid: every
    /// query looks at them.
    pub(crate) outer: Vec<Slot>,
}

/// An object in its slot.
#[derive(Debug, Clone)]
pub(crate) struct Object {
    pub(crate) bounds: Shape,
    pub(crate) occluder: Option<Shape>,
    user_data: u64,
    /// 1 + its place in the list of objects that are in no cells, or 0.
    outer: u32,
}

impl Scene {
    /// An empty scene on a grid. Costs half a byte for each cell.
    ///
    /// # Errors
    /// Refuses a corner that is not finite, a cell size that is not a positive normal number, 0 or
    /// more than [`MAX_CELLS_PER_AXIS`](crate::MAX_CELLS_PER_AXIS) cells along an axis, and a corner
    /// more than about 2^28 cells from the origin.
    pub fn new(spec: &GridSpec) -> Result<Self, Error> {
        let grid = Grid::new(spec)?;
        let (slots, lists) = (Slots::new(), CellLists::new(&grid));
        Ok(Self { grid, slots, lists, outer: Vec::new() })
    }

    /// Adds an object. Costs the cells that its bounds touch: four bytes each, and 1.5 kB for each
    /// 8x8 cells that were empty. An object that touches the border of the grid or leaves it, or
    /// touches more cells than twice the number around the grid, is looked at in every query
    /// instead.
    ///
    /// # Errors
    /// Refuses shapes that are not finite or inverted, or have a negative radius, occluders that
    /// stick out of the rectangle around their bounds by more than a thousandth of its diagonal,
    /// and more than 2^31 objects.
    pub fn insert(&mut self, desc: ObjectDesc) -> Result<ObjectId, Error> {
        let ObjectDesc { bounds, occluder, user_data } = desc;
        check_pair(&bounds, occluder.as_ref())?;
        let object = Object { bounds, occluder, user_data, outer: 0 };
        let slot = self.slots.insert(object).ok_or(Error::SceneFull(self.slots.len()))?;
        self.list(slot);
        Ok(self.id(slot))
    }

    /// Moves an object or changes its shape: all of it, in world units. Costs the cells that it
    /// touched and touches.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, shapes as [`Scene::insert`], and an update
    /// without occluder of an object that has one (see [`Scene::set_occluder`]).
    pub fn update(
        &mut self,
        id: ObjectId,
        bounds: impl Into<Shape>,
        occluder: Option<Shape>,
    ) -> Result<(), Error> {
        let bounds = bounds.into();
        check_pair(&bounds, occluder.as_ref())?;
        let hides = self.find(id)?.occluder.is_some();
        if hides && occluder.is_none() {
            return Err(Error::OccluderMissing(id));
        }
        self.unlist(id.slot());
        if let Some(object) = self.slots.get_mut(id.slot()) {
            (object.bounds, object.occluder) = (bounds, occluder);
        }
        self.list(id.slot());
        Ok(())
    }

    /// Gives an object another occluder, or takes away the one that it has, as for a door that
    /// opens. Its bounds stay. Costs nothing else.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, and shapes as [`Scene::insert`].
    pub fn set_occluder(&mut self, id: ObjectId, occluder: Option<Shape>) -> Result<(), Error> {
        check_pair(&self.find(id)?.bounds, occluder.as_ref())?;
        if let Some(object) = self.slots.get_mut(id.slot()) {
            object.occluder = occluder;
        }
        Ok(())
    }

    /// Takes an object out. Costs the cells that it touches, and the other objects in them.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), Error> {
        self.find(id)?;
        self.unlist(id.slot());
        self.slots.remove(id.slot());
        Ok(())
    }

    /// Enters an object into the lists of its cells, or into the list of those that are in none.
    fn list(&mut self, slot: Slot) {
        let Some(object) = self.slots.get(slot) else { return };
        if !self.is_outer(&object.bounds) {
            return self.lists.insert(slot, &object.bounds, &self.grid);
        }
        self.outer.push(slot);
        let place = self.outer.len() as u32;
        self.slots.get_mut(slot).into_iter().for_each(|object| object.outer = place);
    }

    /// Undoes [`Scene::list`].
    fn unlist(&mut self, slot: Slot) {
        let Some(object) = self.slots.get_mut(slot) else { return };
        let Some(place) = std::mem::take(&mut object.outer).checked_sub(1) else {
            return self.lists.remove(slot, &object.bounds, &self.grid);
        };
        self.outer.swap_remove(place as usize);
        // Another object may have taken its place.
        if let Some(&other) = self.outer.get(place as usize)
            && let Some(other) = self.slots.get_mut(other)
        {
            other.outer = place + 1;
        }
    }

    /// Whether a shape is in no lists of cells: it leaves the grid, or touches more cells than
    /// twice the number around the grid.
    fn is_outer(&self, bounds: &Shape) -> bool {
        let (grid, block) = (&self.grid, bounds.block());
        if !grid.surrounds(block.min, block.max) {
            return true;
        }
        let most = 4 * (grid.dims.x + grid.dims.y) as u64;
        let mut cells = 0;
        touched(bounds, grid, &mut |_, xs| cells += xs.count() as u64);
        cells > most
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

    /// The number that the application gave to an object.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn user_data(&self, id: ObjectId) -> Result<u64, Error> {
        Ok(self.find(id)?.user_data)
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
    fn find(&self, id: ObjectId) -> Result<&Object, Error> {
        self.slots.find(id.0).ok_or(Error::UnknownObject(id))
    }
}

/// Refuses bounds and occluders that are no shapes, and occluders that plainly stick out of their
/// bounds.
fn check_pair(bounds: &Shape, occluder: Option<&Shape>) -> Result<(), Error> {
    bounds.check("the bounds")?;
    let Some(occluder) = occluder else { return Ok(()) };
    occluder.check("the occluder")?;
    let (outer, inner) = (bounds.block(), occluder.block());
    let by = (outer.min - inner.min).max(inner.max - outer.max).max_element();
    let reach = outer.min.abs().max(outer.max.abs()).max_element();
    if by > OCCLUDER_SHARE * (outer.max - outer.min).length() + OCCLUDER_ROUNDING * reach {
        return Err(Error::OccluderOutside { by });
    }
    Ok(())
}
