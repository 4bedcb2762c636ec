//! The scene: objects, the matrices of their cells, and the frame loop.
//!
//! # Where an object is
//!
//! Every object is stored in a [`Slot`] and is in one of four states ([`state`], with the table of
//! transitions):
//! - *listed*: its cells are in the matrices I (objects) and O (opaque cells). Static objects
//!   always are.
//! - *hidden*: no view saw a dynamic object in the last frames, and it is inside a temporal
//!   bounding volume. Only the surface of the volume is in the matrices ([`volumes`]), so that
//!   motion inside changes no matrix.
//! - *overdue* or *unlocated*: an object that is reported on expiry may be anywhere, since no
//!   report came. It is visible to every query and hides nothing.
//!
//! Most moves change nothing of that: [`rooms`] tells how far an object may go, and [`reports`] who
//! is overdue in the zones of small movers ([`movers`]).
//!
//! Lists beside the matrices ([`membership`]): objects whose cells do not tell all - outside the
//! grid, too large, or of unknown place - are in the set `always`, which every query tests. Those
//! that reach out of the grid are in cells and in `overhang` ([`outer`]).
//!
//! # A frame
//!
//! 1. [`Scene::begin_frame`] sets the clock. Volumes that may no longer contain their objects
//!    expire, and those objects are due for a report.
//! 2. The application edits the scene ([`edit`]): it reports the objects that are due or that
//!    moved, and inserts and removes others.
//! 3. Queries read the scene. Any number may run at the same time.
//! 4. [`Scene::end_frame`] takes their results. Dynamic objects that no view saw get volumes;
//!    objects whose volumes were seen leave them.
//!
//! # Results and revisions
//!
//! [`changes`] counts the changes that a result may depend on (the revision; motion inside a volume
//! is none of them), and the moves of all objects. [`crate::Pvs::is_valid_for`] compares both. It
//! also lists the last changes of static objects and the volumes that are new: results that are
//! kept ask for these.

mod boxes;
mod cells;
mod changes;
mod contacts;
mod containing;
mod edit;
mod frame;
mod membership;
mod memory;
mod movers;
mod moves;
mod near;
mod object;
mod objects;
mod opacity;
mod opaque;
mod outer;
mod reports;
mod resting;
mod rooms;
mod shift;
mod slot_bits;
mod solids;
mod state;
mod succession;
mod transitions;
mod user_data;
mod validity;
mod volume;
mod volumes;

use casca_slots::{ExpiryQueue, Slot, Slots};
use glam::{DVec3, IVec3};

use crate::error::Error;
use crate::geometry::Block;
use crate::grid::{Grid, GridSpec};
use crate::id::ObjectId;
use crate::matrix::ids::IdMatrix;
use crate::matrix::tbv::TbvMatrix;
use crate::mesh::surface::seams::Seams;
use crate::scene::changes::{Changes, Journal};
use crate::scene::membership::Membership;
use crate::scene::opacity::Opacity;
use crate::scene::outer::Outer;
use crate::scene::reports::ReportLog;
use crate::scene::resting::Resting;
use crate::scene::rooms::Rooms;
use crate::scene::slot_bits::SlotBits;
use crate::scene::user_data::UserData;
use crate::scene::volumes::Volumes;
use crate::shape::pieces::Moved;

pub(crate) use boxes::{Boxes, ObjectBox};
pub(crate) use changes::StaticChange;
pub use frame::{FrameReport, MOST_NEW_VOLUMES};
pub use memory::MemoryUse;
pub(crate) use movers::{Movers, Zone};
pub(crate) use object::Object;
pub use objects::ObjectRef;
pub(crate) use opacity::{LayerOpacity, OpacityPart};

/// Objects in a regular grid, shared read-only by any number of queries.
///
/// # Use
///
/// [`Scene::insert`] takes descriptions of objects, and gives the ids by which they are moved
/// ([`Scene::update`], [`Scene::set_transform`]) and removed. A frame is [`Scene::begin_frame`]
/// with the time, the moves, queries, and [`Scene::end_frame`] with their results.
///
/// A clone is another scene. It knows the ids of all objects that it was made with, but not the ids
/// that the original gives out later, nor the other way round. Each refuses a [`crate::Pvs`] that
/// was found on the other.
///
/// ```
/// use casca::{Aabb, GridSpec, ObjectDesc, Query, Scene, Sphere, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(32) })?;
/// let wall = Aabb::new(Vec3::new(8.0, 0.0, 0.0), Vec3::new(10.0, 32.0, 32.0));
/// let wall = scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let near = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(4.0, 16.0, 16.0), 1.0)))?;
/// let far = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(20.0, 16.0, 16.0), 1.0)))?;
/// let mut query = Query::new();
/// let pvs = query.run(&scene, &View::omnidirectional(Vec3::new(2.5, 16.5, 16.5))?);
/// assert!(pvs.contains(wall) && pvs.contains(near) && !pvs.contains(far));
/// # Ok(())
/// # }
/// ```
///
/// # Cost
///
/// An object costs its record and the cells that it touches, a move the cells that it enters and
/// leaves; one of a small object that hides nothing costs a comparison while it stays in the same
/// zone of 32x32x32 cells, and the lists of two zones else. A moving object that no
/// view saw is put into a temporal bounding volume at the end of the frame: until it leaves that,
/// its moves cost a comparison each, and queries do not look at it. [`Scene::memory`] tells the
/// memory of all parts.
///
/// # Guarantees
///
/// Ids are never used again, and those of other scenes are refused, as are shapes that are not
/// finite; a call that is refused changes nothing. What queries find depends neither on the order
/// of hashes, nor on threads, nor on the clock of the machine.
///
/// # Pitfalls
///
/// - Objects that are promised to keep to a speed ([`crate::ObjectDesc::max_speed`]) and are
///   [reported on expiry](crate::Reports::OnExpiry) must keep to it: the promise is what hides
///   them.
/// - Occluders must lie inside the geometry that is drawn. What they hide is not drawn.
/// - A frame that ends without [`Scene::end_frame`] loses nothing, but hidden movers stay in the
///   matrices and cost every query.
/// - A grid that is far smaller than the scene works, but what lies outside is tested in every
///   query.
#[derive(Clone)]
pub struct Scene {
    grid: Grid,
    slots: Slots<Object>,
    /// O and Os, with the boxes of static opaque cells that are drawn like solids.
    opacity: Opacity,
    /// The patches of all surfaces, and where those of static objects touch.
    seams: Seams,
    /// I: the objects that touch each cell.
    ids: IdMatrix,
    volumes: Volumes,
    /// What queries ask of most objects.
    boxes: Boxes,
    /// Lists of objects.
    members: Membership,
    /// Where objects may go without a change of the matrices.
    rooms: Rooms,
    /// Small moving objects, by zones.
    movers: Movers,
    /// When objects reported on expiry were last reported.
    reports: ReportLog,
    /// Objects that get no volume for some frames.
    resting: Resting,
    expiries: ExpiryQueue,
    /// The slot from which on the next frame hides objects, if they are many.
    next_to_hide: Slot,
    /// Cells of the viewers of the last frame.
    viewers: Vec<IVec3>,
    /// The clock, in seconds.
    now: f64,
    /// Number of the frame, counted by [`Scene::begin_frame`].
    frame: u64,
    /// What tells whether results still hold.
    changes: Changes,
    /// The objects that the last frame ended with in sight.
    seen: SlotBits,
    /// The number of that frame.
    seen_in: u64,
    user_data: UserData,
    /// Memory used again: listed objects out of sight, and the cells of an object that moves.
    unseen: Vec<Slot>,
    moved: Moved,
}

impl Scene {
    /// An empty scene on a grid. Costs a word for each 64x64x64 cells of the grid and matrix.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(spec: &GridSpec) -> Result<Self, Error> {
        let grid = Grid::new(spec)?;
        let dims = grid.dims();
        Ok(Self {
            grid,
            slots: Slots::new(),
            opacity: Opacity::new(dims),
            seams: Seams::default(),
            ids: IdMatrix::new(dims),
            volumes: Volumes::new(&grid),
            boxes: Boxes::default(),
            members: Membership::default(),
            rooms: Rooms::default(),
            movers: Movers::default(),
            reports: ReportLog::default(),
            resting: Resting::default(),
            expiries: ExpiryQueue::default(),
            next_to_hide: Slot::new(0),
            viewers: Vec::new(),
            now: 0.0,
            frame: 1,
            changes: Changes::default(),
            seen: SlotBits::default(),
            seen_in: 0,
            user_data: UserData::default(),
            unseen: Vec::new(),
            moved: Moved::default(),
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

    /// Whether a cell is opaque (O) in views of some layers. Cells outside the grid are not.
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
        &self.ids
    }

    /// Txy, Txz, Tyz: the temporal bounding volumes.
    #[inline]
    pub(crate) fn tbv_matrix(&self) -> &TbvMatrix {
        self.volumes.matrix()
    }

    /// All temporal bounding volumes, those beyond the grid included.
    #[inline]
    pub(crate) fn volumes(&self) -> &Volumes {
        &self.volumes
    }

    /// The box of an object's volume, for a hidden object.
    pub(crate) fn volume_block(&self, slot: Slot) -> Block {
        self.volumes.block(&self.grid, slot)
    }

    #[inline]
    pub(crate) fn seams(&self) -> &Seams {
        &self.seams
    }

    /// The objects that every query tests.
    #[inline]
    pub(crate) fn always(&self) -> &[Slot] {
        self.members.always.as_slice()
    }

    /// Objects that every query counts as visible, beside those that it tests: they are overdue and
    /// listed in zones.
    pub(crate) fn overdue(&self) -> impl Iterator<Item = Slot> {
        self.reports.overdue()
    }

    /// Whether there are overdue objects in zones.
    #[inline]
    pub(crate) fn any_overdue(&self) -> bool {
        self.reports.count_overdue() > 0
    }

    /// Whether the place of an object is unknown: it counts as visible and hides nothing.
    #[inline]
    pub(crate) fn is_unlocated(&self, slot: Slot) -> bool {
        let object = self.object(slot);
        object.is_unlocated() || object.in_zone && object.on_expiry() && !self.reports.is_current(slot)
    }

    /// Listed dynamic objects, those in zones included.
    #[inline]
    pub(crate) fn listed_movers(&self) -> &[Slot] {
        self.members.movers.as_slice()
    }

    /// Small moving objects that hide nothing.
    #[inline]
    pub(crate) fn movers(&self) -> &Movers {
        &self.movers
    }

    /// The listed objects in cells that reach beyond the grid: hidden cells tell nothing about
    /// their parts out there.
    #[inline]
    pub(crate) fn overhang(&self) -> &Outer {
        &self.members.overhang
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

    /// Whether the cells of an object are in I.
    #[inline]
    pub(crate) fn is_in_cells(&self, object: &Object) -> bool {
        object.in_cells
    }

    /// What the boxes of objects tell.
    #[inline]
    pub(crate) fn boxes(&self) -> &Boxes {
        &self.boxes
    }

    /// Whether the box of an object tells what the object is.
    pub(crate) fn is_up_to_date(&self, slot: Slot) -> bool {
        *self.boxes.of(slot) == ObjectBox::of(self.object(slot))
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
        let elsewhere = |slot: &Slot| !self.members.movers.contains(*slot) && !self.object(*slot).is_static();
        let elsewhere = self.always().iter().copied().filter(elsewhere);
        self.members.movers.as_slice().iter().copied().chain(elsewhere).map(|slot| (slot, self.object(slot)))
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

    /// Corners of a box that contains all objects whose place is known, and all volumes.
    pub(crate) fn extent(&self) -> (DVec3, DVec3) {
        let always = self.always().iter().map(|&slot| self.object(slot).bounds.block());
        let outer = self.volumes.outer().pages().map(|page| *page.around());
        let overhang = self.overhang().pages().map(|page| *page.around());
        always.chain(outer).chain(overhang).fold((self.grid.min(), self.grid.max()), |(min, max), block| {
            (min.min(block.min), max.max(block.max))
        })
    }
}
