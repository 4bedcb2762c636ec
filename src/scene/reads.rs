//! A new scene, and what it tells: of one object, of all, and of the matrices that queries walk.

use std::fmt;

use casca_slots::{Slot, Slots};
use glam::{Affine3A, DVec3, IVec3};

use crate::error::Error;
use crate::geometry::Block;
use crate::grid::Grid;
use crate::grid::cell_box::CellBox;
use crate::id::ObjectId;
use crate::matrix::ids::IdMatrix;
use crate::matrix::tbv::TbvMatrix;
use crate::mesh::surface::seams::Seams;
use crate::numeric::shape::{OCCLUDER_ROUNDING, OCCLUDER_SHARE};
use crate::object::{Bounds, Motion, Occluder, transform_of_instances};
use crate::scene::changes::{Changes, Journal};
use crate::scene::clock::Clock;
use crate::scene::last_frame::LastFrame;
use crate::scene::memory::{MemoryUse, shape_bytes};
use crate::scene::opacity::Opacity;
use crate::scene::spatial_index::SpatialIndex;
use crate::scene::user_data::UserData;
use crate::scene::{Boxes, LayerOpacity, Movers, Object, ObjectBox, Scene, StaticChange};

/// An object of a scene, to read. [`Scene::iter`] gives them.
#[derive(Debug, Clone, Copy)]
pub struct ObjectRef<'a> {
    object: &'a Object,
    user_data: u64,
}

impl<'a> ObjectRef<'a> {
    /// The shape that is tested for visibility, as last reported.
    pub fn bounds(&self) -> &'a Bounds {
        self.object.bounds()
    }

    /// The shape that hides others, if it has one.
    pub fn occluder(&self) -> Option<&'a Occluder> {
        self.object.given_occluder()
    }

    /// Whether it moves, and how.
    pub fn motion(&self) -> Motion {
        self.object.motion()
    }

    /// The layers that it is on: see [`crate::ObjectDesc::layers`].
    pub fn layers(&self) -> u64 {
        self.object.layers
    }

    /// The number that the application gave it: see [`Scene::user_data`].
    pub fn user_data(&self) -> u64 {
        self.user_data
    }
}

impl fmt::Debug for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Scene({} objects in {:?})", self.len(), self.grid())
    }
}

impl Scene {
    /// An empty scene, with cells of edge `cell`, in world units. They go on in all directions, 2^20
    /// of them along each axis, and only those in which there is anything take memory and time; an
    /// object farther away is tested in every query. [`crate::cell_for`] tells what suits a level.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(cell: f32) -> Result<Self, Error> {
        let grid = Grid::new(cell)?;
        Ok(Self {
            origin: DVec3::ZERO,
            grid,
            slots: Slots::new(),
            user_data: UserData::default(),
            index: SpatialIndex::default(),
            opacity: Opacity::new(),
            seams: Seams::default(),
            clock: Clock::default(),
            last_frame: LastFrame::default(),
            changes: Changes::default(),
        })
    }

    /// The grid.
    #[inline]
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

    /// Whether an id names an object of this scene. Costs one look-up.
    pub fn contains(&self, id: ObjectId) -> bool {
        self.find(id).is_ok()
    }

    /// The ids of all objects, in the order of [`ObjectId::index`]. Costs a look at each index ever
    /// given.
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> {
        self.living().map(|(slot, _)| self.id(slot))
    }

    /// All objects with their ids, in the order of [`ObjectId::index`]. Costs a look at each index
    /// ever given.
    ///
    /// ```
    /// use casca::{ObjectDesc, Scene, Sphere};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let ball = Sphere::new(Vec3::splat(4.0), 1.0);
    /// let id = scene.insert(ObjectDesc::fixed(ball).occluder(ball).user_data(7))?;
    /// scene.insert(ObjectDesc::dynamic(ball))?;
    /// let hiding: Vec<_> = scene.iter().filter(|(_, object)| object.occluder().is_some()).collect();
    /// assert_eq!(hiding.len(), 1);
    /// assert_eq!((hiding[0].0, hiding[0].1.user_data()), (id, 7));
    /// # Ok(())
    /// # }
    /// ```
    pub fn iter(&self) -> impl Iterator<Item = (ObjectId, ObjectRef<'_>)> {
        self.living()
            .map(|(slot, object)| (self.id(slot), ObjectRef { object, user_data: self.user_data.get(slot) }))
    }

    /// The shape by which an object's visibility is tested, as last reported.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn bounds(&self, id: ObjectId) -> Result<&Bounds, Error> {
        self.find(id).map(Object::bounds)
    }

    /// The shape by which an object hides others, if it has one.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn occluder(&self, id: ObjectId) -> Result<Option<&Occluder>, Error> {
        self.find(id).map(Object::given_occluder)
    }

    /// The transform of an object that [`Scene::set_transform`] moves, as last reported; `None` for
    /// other objects.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn transform(&self, id: ObjectId) -> Result<Option<Affine3A>, Error> {
        let object = self.find(id)?;
        let own = object.placed().map(|placed| placed.transform);
        Ok(own.or_else(|| transform_of_instances(object.bounds(), object.given_occluder())))
    }

    /// The corners of the temporal bounding volume that an object is in, in world units; `None` if
    /// it is in none.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn tbv(&self, id: ObjectId) -> Result<Option<(DVec3, DVec3)>, Error> {
        let object = self.find(id)?;
        let certain = object.volume().filter(|_| object.is_hidden());
        Ok(certain.map(|hidden| (hidden.tbv.block.min, hidden.tbv.block.max)))
    }

    /// The layers that an object is on, a bit for each: see [`crate::ObjectDesc::layers`].
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn layers(&self, id: ObjectId) -> Result<u64, Error> {
        self.find(id).map(|object| object.layers)
    }

    /// The number that the application gave an object, 0 if it gave none: an index into its own
    /// tables, or the handle of an entity. The scene does nothing with it.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn user_data(&self, id: ObjectId) -> Result<u64, Error> {
        self.find(id).map(|_| self.user_data.get(id.slot()))
    }

    /// An id in 64 bits, for tables and interfaces that have no room for an [`ObjectId`]: its
    /// [index](ObjectId::index) in the low 32 bits, and the generation of that index in the high
    /// ones.
    ///
    /// A key leaves out the scene. It names one object of one scene for ever: no key is given twice
    /// in the life of a scene. In another scene the same key may name another object, and nothing
    /// tells it apart there; in a clone it names the same object if that was there when the clone
    /// was made. Where ids of several scenes may be mixed up, keep the [`ObjectId`]: 64 bits cannot
    /// tell scenes, indices and generations apart for certain.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn key(&self, id: ObjectId) -> Result<u64, Error> {
        self.find(id)?;
        Ok(u64::from(id.generation()) << 32 | u64::from(id.slot().get()))
    }

    /// The id that a [key](Scene::key) of this scene stands for. Costs one look-up.
    ///
    /// ```
    /// # use casca::{Error, ObjectDesc, Scene, Sphere};
    /// # use glam::{UVec3, Vec3};
    /// # fn main() -> Result<(), Error> {
    /// # let mut scene = Scene::new(1.0)?;
    /// # let id = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::splat(4.0), 1.0)))?;
    /// let key: u64 = scene.key(id)?;
    /// assert_eq!(scene.id_from_key(key)?, id);
    /// scene.remove(id)?;
    /// assert_eq!(scene.id_from_key(key), Err(Error::UnknownKey(key)));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses a key that names no object of this scene, such as that of one that was removed.
    pub fn id_from_key(&self, key: u64) -> Result<ObjectId, Error> {
        let (slot, generation) = (Slot::new(key as u32), (key >> 32) as u32);
        let living = self.slots.of_generation(slot, generation);
        living.map(|_| self.id(slot)).ok_or(Error::UnknownKey(key))
    }

    /// The memory that the scene takes. Costs a walk over all bricks and objects.
    pub fn memory(&self) -> MemoryUse {
        MemoryUse {
            opacity: self.opacity.bytes(),
            ids: self.index.ids.bytes(),
            tbvs: self.index.volumes.bytes(),
            objects: self.living().map(|(_, object)| object.bytes()).sum::<usize>()
                + self.slots.bytes()
                + self.index.bytes_of_lists()
                + self.seams.bytes()
                + self.clock.bytes()
                + self.changes.bytes()
                + self.last_frame.bytes()
                + self.user_data.bytes(),
            shapes: shape_bytes(self.living().map(|(_, object)| object)),
        }
    }

    /// Whether a cell is opaque (O) in views of some layers.
    pub(crate) fn is_opaque(&self, cell: IVec3, layers: u64) -> bool {
        self.opacity(layers).any(|part| part.is_opaque(cell))
    }

    /// The opaque cells that count in views of some layers.
    pub(crate) fn opacity(&self, layers: u64) -> impl Iterator<Item = &LayerOpacity> {
        self.opacity.parts().iter().filter(move |part| part.layers() & layers != 0)
    }

    /// I: the objects that touch each cell.
    #[inline]
    pub(crate) fn id_matrix(&self) -> &IdMatrix {
        &self.index.ids
    }

    /// Txy, Txz, Tyz: the temporal bounding volumes.
    #[inline]
    pub(crate) fn tbv_matrix(&self) -> &TbvMatrix {
        &self.index.volumes
    }

    /// The cells of an object's volume, if it is in one.
    #[inline]
    pub(crate) fn volume_cells(&self, slot: Slot) -> Option<&CellBox> {
        self.object(slot).volume().map(|hidden| &hidden.tbv.cells)
    }

    /// The objects whose volumes contain a cell, on their surface or inside, in the order of slots.
    pub(crate) fn volumes_around(&self, cell: IVec3) -> Vec<Slot> {
        let contains = |&slot: &Slot| self.volume_cells(slot).is_some_and(|cells| cells.contains(cell));
        let mut around: Vec<Slot> = self.tbv_matrix().ids(cell >> 3i32).filter(contains).collect();
        around.sort_unstable();
        around
    }

    /// The box of an object's volume, for a hidden object.
    pub(crate) fn volume_block(&self, slot: Slot) -> Block {
        let object = self.object(slot);
        object.volume().map_or_else(|| object.bounds.block(), |hidden| hidden.tbv.block)
    }

    #[inline]
    pub(crate) fn seams(&self) -> &Seams {
        &self.seams
    }

    /// The objects that every query tests.
    #[inline]
    pub(crate) fn always(&self) -> &[Slot] {
        self.index.always.as_slice()
    }

    /// The listed objects that every query counts as visible, since they are overdue.
    pub(crate) fn overdue(&self) -> impl Iterator<Item = Slot> {
        self.clock.reports.overdue()
    }

    /// Whether there are any.
    #[inline]
    pub(crate) fn any_overdue(&self) -> bool {
        self.clock.reports.count_overdue() > 0
    }

    /// Whether the place of an object is unknown: it counts as visible and hides nothing.
    #[inline]
    pub(crate) fn is_unlocated(&self, slot: Slot) -> bool {
        let object = self.object(slot);
        object.is_expired()
            || object.on_expiry() && !object.is_hidden() && !self.clock.reports.is_current(slot)
    }

    /// Listed dynamic objects, those in zones included.
    #[inline]
    pub(crate) fn listed_movers(&self) -> &[Slot] {
        self.index.movers.as_slice()
    }

    /// Small moving objects that hide nothing.
    #[inline]
    pub(crate) fn movers(&self) -> &Movers {
        &self.index.zones
    }

    /// Number of slots: all slots of objects are below.
    #[inline]
    pub(crate) fn slot_count(&self) -> usize {
        self.slots.count()
    }

    /// All objects with their slots, in the order of these.
    #[inline]
    pub(crate) fn living(&self) -> impl Iterator<Item = (Slot, &Object)> {
        self.slots.iter()
    }

    /// Whether a slot contains an object that is in a volume.
    #[inline]
    pub(crate) fn is_hidden(&self, slot: Slot) -> bool {
        self.slots.get(slot).is_some_and(Object::is_hidden)
    }

    /// What the boxes of objects tell.
    #[inline]
    pub(crate) fn boxes(&self) -> &Boxes {
        &self.index.boxes
    }

    /// Whether the box of an object tells what the object is.
    pub(crate) fn is_up_to_date(&self, slot: Slot) -> bool {
        *self.index.boxes.of(slot) == ObjectBox::of(self.object(slot))
    }

    /// The object of a slot, if it contains one.
    #[inline]
    pub(crate) fn living_at(&self, slot: Slot) -> Option<&Object> {
        self.slots.get(slot)
    }

    /// The object of a slot that is known to contain one.
    #[inline]
    pub(crate) fn object(&self, slot: Slot) -> &Object {
        &self.slots[slot]
    }

    /// The id of the object in a slot.
    #[inline]
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

    /// Changes whenever anything changed that a result could depend on. Motion inside a temporal
    /// bounding volume that was there when the query ran does not count: its surface was tested.
    pub(crate) fn revision(&self) -> u64 {
        self.changes.revision
    }

    /// The static objects that came, went or changed.
    pub(crate) fn static_changes(&self) -> &Journal<StaticChange> {
        &self.changes.fixed
    }

    /// The volumes that are new.
    pub(crate) fn journal(&self) -> &Journal<Slot> {
        &self.changes.volumes
    }

    /// The dynamic objects that no volume stands for: those in the matrices, and those of unknown
    /// place.
    pub(crate) fn movers_outside_volumes(&self) -> impl Iterator<Item = (Slot, &Object)> {
        let elsewhere = |slot: &Slot| !self.index.movers.contains(*slot) && !self.object(*slot).is_static();
        let elsewhere = self.always().iter().copied().filter(elsewhere);
        self.index.movers.as_slice().iter().copied().chain(elsewhere).map(|slot| (slot, self.object(slot)))
    }

    /// Changes also when a hidden object moved.
    pub(crate) fn moves(&self) -> u64 {
        self.changes.moves + self.changes.revision
    }

    /// The number of the last move that [`Scene::update`] was told of, hidden objects included.
    pub(crate) fn last_move(&self) -> u64 {
        self.changes.moves
    }

    /// Whether an object was moved or changed since a number of [`Scene::last_move`], or is gone.
    pub(crate) fn moved_since(&self, id: ObjectId, last: u64) -> bool {
        !self.find(id).is_ok_and(|object| object.moved <= last)
    }

    /// A block of bricks around all that the cells tell of; a brick if there is nothing.
    pub(crate) fn extent_in_bricks(&self) -> CellBox {
        self.index.extent().unwrap_or_default()
    }

    /// Corners of a box that contains all objects whose place is known, all volumes, and the occluders
    /// that stick out of bounds as far as they may.
    pub(crate) fn extent(&self) -> (DVec3, DVec3) {
        let always = self.always().iter().map(|&slot| self.object(slot).bounds.block());
        let CellBox { lo, hi } = self.extent_in_bricks();
        let cells = self.grid.bricks().range_bounds(lo, hi);
        let (min, max) = always.fold(cells, |(min, max), block| (min.min(block.min), max.max(block.max)));
        let largest = min.abs().max(max.abs()).max_element();
        let room = OCCLUDER_SHARE * (max - min).length() + OCCLUDER_ROUNDING * largest;
        (min - room, max + room)
    }
}
