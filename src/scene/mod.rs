//! The scene: objects and the matrices that hold them.

pub(crate) mod outer;
pub(crate) mod solids;
pub(crate) mod tbv;

use std::collections::{BinaryHeap, HashSet};
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, IVec3, Vec3};

use crate::error::{Error, finite3};
use crate::geometry::Block;
use crate::grid::cell_box::{CellBox, volume};
use crate::grid::{Grid, GridSpec};
use crate::id::ObjectId;
use crate::matrix::bits::{BitMatrix, NONE, OpacityMatrix};
use crate::matrix::counts::Counts;
use crate::matrix::fused::Fused;
use crate::matrix::ids::IdMatrix;
use crate::matrix::tbv::TbvMatrix;
use crate::mesh::surface::seams::Seams;
use crate::object::{Bounds, Motion, ObjectDesc, Occluder, Reports, check_pair};
use crate::pvs::Pvs;
use crate::scene::tbv::{
    Border, Expiry, FIRST_VALIDITY, LONGER, SHORTER, Tbv, VALIDITY_RANGE, Volumes, lay, way,
};
use crate::shape::Shape;
use crate::shape::pieces::{Moved, touched};
use crate::view::{View, cut};

/// An object whose bounds span more cells than this is not written into I, which would take a
/// brick for every 512 of them: it is tested against the frustum in every query.
const MAX_SPANNED_CELLS: u64 = 1 << 22;

/// When even the shortest volume beyond the grid was revealed, this many volumes stay inside: for
/// [`crate::Method::Cell`], whose masks end with the grid, all of the former in the frustum are in sight.
const CONFINED: u8 = 8;

/// The queue of expiries is looked through for old entries when it is longer than this and twice the objects.
const MANY_EXPIRIES: usize = 64;

/// Beyond this many cells before the near plane all occluders are asked instead.
const MAX_NEAR_CELLS: u64 = 4096;

/// Of the objects in those cells, so many are asked again and again before all are asked once.
const MOST_ASKED: usize = 4096;

static SCENES: AtomicU32 = AtomicU32::new(1);

/// Tells scenes apart. A copy of a scene goes its own way, so that cloning makes a new tag.
#[derive(Debug, PartialEq, Eq)]
struct Tag(u32);

impl Tag {
    fn new() -> Self {
        Self(SCENES.fetch_add(1, Ordering::Relaxed))
    }
}

impl Clone for Tag {
    fn clone(&self) -> Self {
        Self::new()
    }
}

/// Where an object is kept.
#[derive(Debug, Clone, Copy)]
enum State {
    /// In I and O.
    Listed,
    /// In a temporal bounding volume. `expires` counts for objects that are reported on expiry; `queued` is
    /// the time of their entry in the queue, which is never later.
    Hidden { tbv: Tbv, expires: f64, queued: f64 },
    /// Its volume expired and nobody told where it is: visible to all. The
    /// volume stays where it is, for the case that the object is still inside.
    Unlocated { tbv: Option<Tbv> },
}

#[derive(Debug, Clone)]
pub(crate) struct Object {
    pub(crate) bounds: Bounds,
    pub(crate) occluder: Option<Occluder>,
    motion: Motion,
    state: State,
    validity: f64,
    /// Place in the list of listed dynamic objects, if it is one.
    listed_at: u32,
    /// Place in the list of objects tested in every query, or `NOWHERE`.
    always_at: u32,
    /// Whether its cells are in I; objects with too many cells are not.
    pub(crate) in_cells: bool,
    /// The time of the last report.
    reported: f64,
    /// Listed and reported on expiry, but not since the clock last moved: it may be anywhere.
    stale: bool,
    /// The frame that last ended with the object in sight.
    seen_in: u64,
    /// The number of the move that last changed it.
    moved: u64,
    /// So many of its next volumes stay inside the grid.
    confined: u8,
}

const NOWHERE: u32 = u32::MAX;

impl Object {
    /// Whether nobody told where it is: it counts as visible and hides nothing.
    pub(crate) fn is_unlocated(&self) -> bool {
        self.stale || matches!(self.state, State::Unlocated { .. })
    }

    /// Whether it is in a volume.
    pub(crate) fn is_hidden(&self) -> bool {
        matches!(self.state, State::Hidden { .. })
    }

    /// Whether it is in a volume and its bounds are old.
    pub(crate) fn is_hidden_unreported(&self) -> bool {
        self.on_expiry() && self.is_hidden()
    }

    /// The volume of an object whose bounds are old: it may be anywhere in there.
    pub(crate) fn unreported_volume(&self) -> Option<&Block> {
        match &self.state {
            State::Hidden { tbv, .. } if self.on_expiry() => Some(&tbv.block),
            _ => None,
        }
    }

    pub(crate) fn is_static(&self) -> bool {
        self.motion == Motion::Static
    }

    pub(crate) fn on_expiry(&self) -> bool {
        matches!(self.motion, Motion::Dynamic { reports: Reports::OnExpiry, .. })
    }
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Slot {
    generation: u32,
    /// The scene that the object was inserted into: this one, or one that this is a copy of.
    scene: u32,
    pub(crate) object: Option<Object>,
}

/// Memory held by a scene, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryUse {
    /// Os, O, and boxes of opaque cells.
    pub opacity: usize,
    /// I.
    pub ids: usize,
    /// Txy, Txz, Tyz, the volumes themselves and what finds them.
    pub tbvs: usize,
    /// Objects and lists of them.
    pub objects: usize,
    /// Meshes and convex solids. One that several objects share counts once; other scenes and the
    /// application may share it too.
    pub shapes: usize,
}

impl MemoryUse {
    /// The matrices of the grid.
    pub fn grid(&self) -> usize {
        self.opacity + self.ids + self.tbvs
    }

    /// All of it.
    pub fn total(&self) -> usize {
        self.grid() + self.objects + self.shapes
    }
}

/// What [`Scene::end_frame`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct FrameReport {
    /// Objects found hidden and put into a temporal bounding volume.
    pub hidden: usize,
    /// Volumes that were revealed.
    pub revealed: usize,
}

/// Objects in a regular grid, shared read-only by any number of queries.
///
/// A clone is a scene of its own: it knows the ids of all objects that it was made with, but ids that either
/// makes later are its own, and so are sets: a [`Pvs`] of the one is refused by the other.
///
/// A frame: [`Scene::begin_frame`] with the time, [`Scene::update`] for what
/// moved, queries, and [`Scene::end_frame`] with their results.
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
/// let pvs = query.run(&scene, &View::around(Vec3::new(2.5, 16.5, 16.5))?);
/// assert!(pvs.contains(wall) && pvs.contains(near) && !pvs.contains(far));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Scene {
    tag: Tag,
    pub(crate) grid: Grid,
    /// Os.
    pub(crate) opacity_static: OpacityMatrix,
    /// What visible dynamic objects add to Os to make O.
    pub(crate) opacity_dynamic: OpacityMatrix,
    /// How many objects make each of their cells opaque.
    pub(crate) counts_static: Counts,
    pub(crate) counts_dynamic: Counts,
    /// Boxes of static opaque cells that are drawn like solids.
    pub(crate) fused: Fused,
    /// Where surfaces of static objects meet.
    pub(crate) seams: Seams,
    pub(crate) ids: IdMatrix,
    pub(crate) volumes: Volumes,
    pub(crate) slots: Vec<Slot>,
    free: Vec<u32>,
    len: usize,
    /// Listed dynamic objects.
    listed: Vec<u32>,
    /// Objects tested in every query: outside the grid, too large, or unlocated.
    pub(crate) always: Vec<u32>,
    expiries: BinaryHeap<Expiry>,
    /// Cells of the viewers of the last frame.
    viewers: Vec<IVec3>,
    now: f64,
    /// Number of the frame, counted by [`Scene::begin_frame`].
    frame: u64,
    /// How many listed objects are reported on expiry.
    listed_on_expiry: u32,
    /// How many stale objects have occluders: while any does, O is Os.
    stale_occluders: u32,
    revision: u64,
    moves: u64,
    seen: Vec<u64>,
    moved: Moved,
}

impl Scene {
    /// An empty scene on a grid.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(spec: &GridSpec) -> Result<Self, Error> {
        let grid = Grid::new(spec)?;
        Ok(Self {
            tag: Tag::new(),
            grid,
            opacity_static: BitMatrix::new(grid.dims()),
            opacity_dynamic: BitMatrix::new(grid.dims()),
            counts_static: Counts::new(grid.dims()),
            counts_dynamic: Counts::new(grid.dims()),
            fused: Fused::new(grid.dims()),
            seams: Seams::default(),
            ids: IdMatrix::new(grid.dims()),
            volumes: Volumes::new(&grid),
            slots: Vec::new(),
            free: Vec::new(),
            len: 0,
            listed: Vec::new(),
            always: Vec::new(),
            expiries: BinaryHeap::new(),
            viewers: Vec::new(),
            now: 0.0,
            frame: 1,
            listed_on_expiry: 0,
            stale_occluders: 0,
            revision: 0,
            moves: 0,
            seen: Vec::new(),
            moved: Moved::default(),
        })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of objects.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no objects.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// All objects, in the order of [`ObjectId::index`].
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> {
        self.slots.iter().enumerate().filter(|(_, s)| s.object.is_some()).map(|(i, _)| self.id(i as u32))
    }

    /// What an object's visibility is tested by.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn bounds(&self, id: ObjectId) -> Result<&Bounds, Error> {
        self.find(id).map(|(_, o)| &o.bounds)
    }

    /// What an object hides others with.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn occluder(&self, id: ObjectId) -> Result<Option<&Occluder>, Error> {
        self.find(id).map(|(_, o)| o.occluder.as_ref())
    }

    /// Whether the object is held by a temporal bounding volume, and the
    /// corners of that volume.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn tbv(&self, id: ObjectId) -> Result<Option<(DVec3, DVec3)>, Error> {
        let (_, object) = self.find(id)?;
        Ok(match &object.state {
            State::Hidden { tbv, .. } => Some((tbv.block.min, tbv.block.max)),
            _ => None,
        })
    }

    /// Whether a cell is opaque (O).
    pub fn is_opaque(&self, cell: IVec3) -> bool {
        self.opacity_static.get(cell) || self.known_dynamic_opacity().is_some_and(|o| o.get(cell))
    }

    /// The opaque cells of visible dynamic objects, unless the place of one of those is unknown.
    pub(crate) fn known_dynamic_opacity(&self) -> Option<&OpacityMatrix> {
        (self.stale_occluders == 0).then_some(&self.opacity_dynamic)
    }

    /// Whether objects are known to touch a cell (I).
    pub fn is_occupied(&self, cell: IVec3) -> bool {
        self.grid.contains(cell) && self.ids.get(cell).next().is_some()
    }

    /// Os: the opaque cells of static objects.
    pub fn static_opacity(&self) -> &OpacityMatrix {
        &self.opacity_static
    }

    /// The opaque cells of visible dynamic objects; with Os they make O. Not so while an occluder that is
    /// [reported on expiry](Reports::OnExpiry) is due for a report: then O is Os.
    pub fn dynamic_opacity(&self) -> &OpacityMatrix {
        &self.opacity_dynamic
    }

    /// I: the objects that touch each cell.
    pub fn id_matrix(&self) -> &IdMatrix {
        &self.ids
    }

    /// Txy, Txz, Tyz: the temporal bounding volumes.
    pub fn tbv_matrix(&self) -> &TbvMatrix {
        &self.volumes.matrix
    }

    /// Memory held. Walks over all bricks and objects.
    pub fn memory(&self) -> MemoryUse {
        MemoryUse {
            opacity: self.opacity_static.bytes()
                + self.opacity_dynamic.bytes()
                + self.counts_static.bytes()
                + self.counts_dynamic.bytes()
                + self.fused.bytes(),
            ids: self.ids.bytes(),
            tbvs: self.volumes.bytes(),
            objects: self.slots.capacity() * size_of::<Slot>()
                + (self.free.capacity() + self.listed.capacity() + self.always.capacity()) * 4
                + self.seams.bytes()
                + self.expiries.capacity() * size_of::<Expiry>()
                + self.seen.capacity() * 8
                + self.moved.bytes(),
            shapes: self.shape_bytes(),
        }
    }

    /// Bytes of the shapes that objects share.
    fn shape_bytes(&self) -> usize {
        let mut counted = HashSet::new();
        let mut once = |at: *const u8, bytes: usize| if counted.insert(at) { bytes } else { 0 };
        let objects = self.slots.iter().filter_map(|slot| slot.object.as_ref());
        objects
            .map(|object| {
                let (bounds, occluder) =
                    (object.bounds.shared(), object.occluder.as_ref().and_then(Occluder::shared));
                bounds.into_iter().chain(occluder).map(|(at, bytes)| once(at, bytes)).sum::<usize>()
            })
            .sum()
    }

    /// Inserts an object. A dynamic one counts as visible until a frame ends without it.
    ///
    /// Costs the cells around the surfaces of its bounds and its occluder, and a little for each 512 cells
    /// inside. Bounds that span more than 2^22 cells cost no cells: such an object is tested against the
    /// view in every query instead, and so is one that reaches out of the grid. A mesh costs the cells of
    /// its box.
    ///
    /// # Errors
    /// Refuses shapes that are not finite, inverted or negative, occluders that stick out of the box of their bounds
    /// by more than a thousandth of its diagonal, speeds that are not finite or negative, speeds of fixed
    /// objects, and more than 2^31 objects.
    pub fn insert(&mut self, desc: ObjectDesc) -> Result<ObjectId, Error> {
        desc.check()?;
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None if self.slots.len() < (1 << 31) - 1 => {
                self.slots.push(Slot::default());
                self.slots.len() as u32 - 1
            }
            None => return Err(Error::SceneFull(self.len)),
        };
        self.slots[slot as usize].scene = self.tag.0;
        self.slots[slot as usize].object = Some(Object {
            bounds: desc.bounds,
            occluder: None,
            motion: desc.motion,
            state: State::Listed,
            validity: FIRST_VALIDITY,
            listed_at: NOWHERE,
            always_at: NOWHERE,
            in_cells: false,
            reported: self.now,
            stale: false,
            seen_in: 0,
            moved: self.moves,
            confined: 0,
        });
        self.len += 1;
        self.revision += 1;
        self.exchange_occluder(slot, desc.occluder);
        self.list(slot);
        Ok(self.id(slot))
    }

    /// Moves an object or changes its shape: all of it, in world units.
    ///
    /// A hidden object that stays inside its volume costs a comparison; others
    /// cost the cells that they enter or leave. For an object that is reported on
    /// expiry this is the report, also where nothing changed.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, shapes as [`Scene::insert`], and an update without
    /// occluder of an object that has one (see [`Scene::set_occluder`]).
    pub fn update(
        &mut self,
        id: ObjectId,
        bounds: impl Into<Bounds>,
        occluder: Option<Occluder>,
    ) -> Result<(), Error> {
        let bounds = bounds.into();
        check_pair(&bounds, occluder.as_ref())?;
        let (_, object) = self.find(id)?;
        if occluder.is_none() && object.occluder.is_some() {
            return Err(Error::OccluderMissing(id));
        }
        self.set_shape(id.slot, bounds, occluder);
        Ok(())
    }

    /// Gives an object another occluder, or takes away the one that it has. Its bounds stay.
    ///
    /// Costs as [`Scene::update`]; like that it is the report of an object that is reported on expiry.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, and shapes as [`Scene::insert`].
    pub fn set_occluder(&mut self, id: ObjectId, occluder: Option<Occluder>) -> Result<(), Error> {
        let bounds = self.bounds(id)?.clone();
        check_pair(&bounds, occluder.as_ref())?;
        self.set_shape(id.slot, bounds, occluder);
        Ok(())
    }

    /// Puts an object where it is reported to be.
    fn set_shape(&mut self, slot: u32, bounds: Bounds, occluder: Option<Occluder>) {
        let (now, grid) = (self.now, self.grid);
        self.locate(slot);
        let object = self.object_mut(slot);
        object.reported = now;
        if !object.is_unlocated() && object.bounds.same(&bounds) && same_occluder(&object.occluder, &occluder)
        {
            return;
        }
        self.moves += 1;
        self.object_mut(slot).moved = self.moves;
        match self.object(slot).state {
            State::Hidden { tbv, queued, .. } => {
                let block = bounds.block();
                self.exchange_occluder(slot, occluder);
                let object = self.object_mut(slot);
                object.bounds = bounds;
                if tbv.holds(&grid, &block) {
                    if object.on_expiry() {
                        self.stay_in_volume(slot, tbv, tbv.room(&block), queued);
                    }
                    return;
                }
                object.lengthen();
                self.volumes.remove(slot);
                self.revision += 1;
                self.hide_or_list(slot);
            }
            State::Unlocated { tbv } => {
                let block = bounds.block();
                self.object_mut(slot).bounds = bounds;
                self.exchange_occluder(slot, occluder);
                self.forget_always(slot);
                self.revision += 1;
                self.object_mut(slot).lengthen();
                let next = self.lay_volume(slot);
                if let (Some(tbv), Some((wished, _))) = (tbv, &next) {
                    // Where a new volume would not hold much longer, the old one stays.
                    let room = tbv.room(&block);
                    if room >= 0.5 * wished.slack {
                        self.stay_in_volume(slot, tbv, room, f64::INFINITY);
                        return;
                    }
                }
                if tbv.is_some() {
                    self.volumes.remove(slot);
                }
                match next {
                    Some((tbv, expires)) => self.enter_volume(slot, tbv, expires),
                    None => self.list(slot),
                }
            }
            State::Listed => {
                self.revision += 1;
                self.relist(slot, bounds, occluder);
            }
        }
    }

    /// The place of a listed object is no longer known: until it is reported it counts as visible and hides
    /// nothing. Its cells stay as they are, since the report mostly comes at once.
    fn lose(&mut self, slot: u32) {
        let object = self.object_mut(slot);
        if !object.stale {
            object.stale = true;
            self.stale_occluders += u32::from(self.object(slot).occluder.is_some());
            self.remember_always(slot);
            self.revision += 1;
        }
    }

    /// The place of an object is known again, or does not matter any more.
    fn locate(&mut self, slot: u32) {
        let grid = self.grid;
        let object = self.object_mut(slot);
        if std::mem::take(&mut object.stale) {
            self.stale_occluders -= u32::from(self.object(slot).occluder.is_some());
            let (fits, small) = placement(&grid, &self.object(slot).bounds.block());
            if fits && small {
                self.forget_always(slot);
            }
            self.revision += 1;
        }
    }

    /// Moves an object by an offset. Each coordinate is rounded to single
    /// precision; where many small steps would drift, use [`Scene::update`].
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, an offset that is not
    /// finite or leads to coordinates that are not, and objects with meshes in world space.
    pub fn translate(&mut self, id: ObjectId, offset: Vec3) -> Result<(), Error> {
        finite3("the offset", offset)?;
        let (_, object) = self.find(id)?;
        let bounds = object.bounds.moved(offset)?.ok_or(Error::FixedMesh(id))?;
        let occluder = match &object.occluder {
            Some(occluder) => Some(occluder.moved(offset)?.ok_or(Error::FixedMesh(id))?),
            None => None,
        };
        self.update(id, bounds, occluder)
    }

    /// Takes an object out.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), Error> {
        self.find(id)?;
        self.revision += 1;
        self.locate(id.slot);
        match self.object(id.slot).state {
            State::Listed => self.unlist(id.slot),
            State::Hidden { .. } => self.volumes.remove(id.slot),
            State::Unlocated { tbv } => {
                self.forget_always(id.slot);
                if tbv.is_some() {
                    self.volumes.remove(id.slot);
                }
            }
        }
        self.exchange_occluder(id.slot, None);
        let slot = &mut self.slots[id.slot as usize];
        slot.object = None;
        self.len -= 1;
        // A slot whose generations are used up is never given again.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(id.slot);
        }
        Ok(())
    }

    /// Sets the clock, in seconds, and lists the objects whose report is due. Of those
    /// [reported on expiry](Reports::OnExpiry), these are the ones whose volume no longer holds them for sure, and
    /// the ones in no volume, unless the last frame ended with them in sight: those are reported unasked.
    /// Until each is [updated](Scene::update), every query counts it as visible, and it hides nothing.
    ///
    /// A clock that goes backwards makes all in volumes due. Costs the objects that are due and, if any object that
    /// is reported on expiry is in no volume, a look at each dynamic one that is in none.
    ///
    /// Also brings up to date what closes the seams between static solids inserted or
    /// removed since, for [`crate::Method::Point`].
    ///
    /// # Errors
    /// Refuses a time that is not finite.
    pub fn begin_frame(&mut self, now: f64) -> Result<Vec<ObjectId>, Error> {
        if !now.is_finite() {
            return Err(Error::NotFinite { what: "the time", value: DVec3::splat(now) });
        }
        self.fused.refresh(&self.opacity_static);
        let backwards = now < self.now;
        self.now = now;
        let mut due = Vec::new();
        while let Some(&next) = self.expiries.peek() {
            if !backwards && next.at > now {
                break;
            }
            self.expiries.pop();
            let slot = &mut self.slots[next.slot as usize];
            if slot.generation != next.generation {
                continue;
            }
            let Some(object) = &mut slot.object else { continue };
            match &mut object.state {
                // Queued again since: that entry counts.
                State::Hidden { queued, .. } if *queued != next.at => {}
                State::Hidden { expires, queued, .. } if !backwards && *expires > now => {
                    *queued = *expires;
                    self.expiries.push(Expiry { at: *expires, ..next });
                }
                State::Hidden { tbv, .. } => {
                    object.state = State::Unlocated { tbv: Some(*tbv) };
                    object.unconfine();
                    self.remember_always(next.slot);
                    self.revision += 1;
                    due.push(self.id(next.slot));
                }
                // Revealed in the last frame: its bounds are old.
                State::Unlocated { .. } if next.at == f64::NEG_INFINITY => due.push(self.id(next.slot)),
                _ => {}
            }
        }
        // Objects in the matrices were where they are only when they were last reported.
        let frame = self.frame;
        self.frame += 1;
        let asked = if self.listed_on_expiry > 0 { self.listed.len() } else { 0 };
        for i in 0..asked {
            let slot = self.listed[i];
            let object = self.object(slot);
            if object.on_expiry() && object.reported != now {
                self.object_mut(slot).unconfine();
                // An object that the last frame showed is reported unasked.
                if self.object(slot).seen_in != frame {
                    due.push(self.id(slot));
                }
                self.lose(slot);
            }
        }
        Ok(due)
    }

    /// Applies the results of a frame's queries: dynamic objects that no view
    /// saw go into temporal bounding volumes, revealed ones come out. Without
    /// results nothing changes; those of queries that never ran are passed over. A frame that ends without a call
    /// costs reports and time, but loses nobody.
    ///
    /// Costs the dynamic objects that are visible or were revealed.
    ///
    /// # Errors
    /// Refuses a result of another scene.
    pub fn end_frame<'a>(&mut self, views: impl IntoIterator<Item = &'a Pvs>) -> Result<FrameReport, Error> {
        let views: Vec<&Pvs> = views.into_iter().filter(|p| p.has_run()).collect();
        if views.iter().any(|p| p.scene != self.tag.0) {
            return Err(Error::ForeignPvs);
        }
        let mut report = FrameReport::default();
        if views.is_empty() {
            return Ok(report);
        }
        self.viewers.clear();
        self.viewers.extend(views.iter().filter_map(|p| p.viewer));
        let mut seen = std::mem::take(&mut self.seen);
        seen.clear();
        seen.resize(self.slots.len().div_ceil(64), 0);
        for id in views.iter().flat_map(|p| &p.visible) {
            if self.find(*id).is_ok() {
                seen[id.slot as usize / 64] |= 1 << (id.slot % 64);
            }
        }
        let is_seen = |slot: u32| seen[slot as usize / 64] >> (slot % 64) & 1 != 0;
        let frame = self.frame;
        for &id in views.iter().flat_map(|p| &p.revealed) {
            if self.find(id).is_err() || !matches!(self.object(id.slot).state, State::Hidden { .. }) {
                continue;
            }
            report.revealed += 1;
            let outer = self.volumes.is_outer(id.slot);
            self.volumes.remove(id.slot);
            let object = self.object_mut(id.slot);
            object.validity = (object.validity * SHORTER).max(VALIDITY_RANGE.0);
            if outer && object.validity <= VALIDITY_RANGE.0 {
                object.confined = CONFINED;
            }
            if object.on_expiry() {
                let generation = id.generation;
                object.state = State::Unlocated { tbv: None };
                self.remember_always(id.slot);
                self.revision += 1;
                self.expiries.push(Expiry { at: f64::NEG_INFINITY, slot: id.slot, generation });
            } else if is_seen(id.slot) {
                object.state = State::Listed;
                self.list(id.slot);
            } else {
                self.hide_or_list(id.slot);
            }
        }
        let mut i = 0;
        while i < self.listed.len() {
            let slot = self.listed[i];
            if is_seen(slot) {
                self.object_mut(slot).seen_in = frame;
                i += 1;
            } else if self.try_hide(slot) {
                report.hidden += 1;
            } else {
                i += 1;
            }
        }
        self.seen = seen;
        self.compact_expiries();
        Ok(report)
    }

    /// Changes whenever anything changed that a result could depend on. Motion
    /// inside a temporal bounding volume that was there when the query ran does not
    /// count: its surface was tested.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// Changes also when a hidden object moved.
    pub(crate) fn moves(&self) -> u64 {
        self.moves + self.revision
    }

    /// Corners of a box that holds all objects whose place is known, and all volumes.
    pub(crate) fn extent(&self) -> (DVec3, DVec3) {
        let always = self.always.iter().map(|&slot| self.object(slot).bounds.block());
        let outer = self.volumes.outer().map(|bucket| bucket.around);
        always.chain(outer).fold((self.grid.min(), self.grid.max()), |(min, max), block| {
            (min.min(block.min), max.max(block.max))
        })
    }

    /// The number of the last move that [`Scene::update`] was told of, hidden objects included.
    pub(crate) fn last_move(&self) -> u64 {
        self.moves
    }

    /// Whether an object was moved or changed since a number of [`Scene::last_move`], or is gone.
    pub(crate) fn moved_since(&self, id: ObjectId, last: u64) -> bool {
        !self.find(id).is_ok_and(|(_, object)| object.moved <= last)
    }

    pub(crate) fn tag(&self) -> u32 {
        self.tag.0
    }

    pub(crate) fn id(&self, slot: u32) -> ObjectId {
        let Slot { scene, generation, .. } = self.slots[slot as usize];
        ObjectId { scene, slot, generation }
    }

    /// The object that an id names.
    pub(crate) fn find(&self, id: ObjectId) -> Result<(u32, &Object), Error> {
        self.slots
            .get(id.slot as usize)
            .filter(|s| s.scene == id.scene && s.generation == id.generation)
            .and_then(|s| s.object.as_ref())
            .map(|o| (id.slot, o))
            .ok_or(Error::UnknownObject(id))
    }

    /// The object of a slot that is known to hold one.
    pub(crate) fn object(&self, slot: u32) -> &Object {
        self.slots[slot as usize].object.as_ref().expect("the matrices and lists hold living objects only")
    }

    fn object_mut(&mut self, slot: u32) -> &mut Object {
        self.slots[slot as usize].object.as_mut().expect("the matrices and lists hold living objects only")
    }

    /// Whether a point may lie inside an occluder that the matrices know.
    pub(crate) fn inside_occluder(&self, point: DVec3) -> bool {
        let cell = self.grid.cell_of(point);
        let holds = |slot| self.object(slot).occluder.as_ref().is_some_and(|o| o.contains_point(point));
        self.always.iter().copied().any(holds)
            || self.grid.contains(cell) && (self.is_opaque(cell) || self.ids.get(cell).any(holds))
    }

    /// Whether the near plane of a view may cut into an occluder: then one sees
    /// through it, since its front is cut away. So one does where an eye that is not known exactly may lie
    /// inside.
    pub(crate) fn near_plane_cuts(&self, view: &View) -> bool {
        let (min, max) = self.extent();
        let meets = |(region, block): (View, Block)| self.occluder_meets(&region, &block);
        view.cut_regions(min, max).any(meets) || view.eye_region().is_some_and(meets)
    }

    /// Whether an occluder, or an opaque cell, may meet a convex region with its bounding box.
    fn occluder_meets(&self, region: &View, block: &Block) -> bool {
        let meets =
            |slot: u32| self.object(slot).occluder.as_ref().is_some_and(|o| cut::may_meet(o, region, block));
        let (lo, hi) = self.grid.cover(block.min, block.max);
        let Some((lo, hi)) = self.grid.clip(lo, hi) else { return self.always.iter().any(|&s| meets(s)) };
        let anywhere = || {
            let living = |i: &u32| self.slots[*i as usize].object.is_some();
            (0..self.slots.len() as u32).filter(living).any(meets)
        };
        if volume(lo, hi) > MAX_NEAR_CELLS {
            return anywhere();
        }
        if self.always.iter().any(|&s| meets(s)) {
            return true;
        }
        let mut asked = 0;
        for c in (CellBox { lo, hi }).cells() {
            let opaque = || region.may_see_block(&Block::new(self.grid.cell_bounds(c)));
            if self.is_opaque(c) && opaque() || self.ids.get(c).inspect(|_| asked += 1).any(meets) {
                return true;
            }
            // Objects that share many of these cells would be asked again in each.
            if asked > self.len.max(MOST_ASKED) {
                return anywhere();
            }
        }
        false
    }

    fn remember_always(&mut self, slot: u32) {
        let at = self.always.len() as u32;
        let object = self.object_mut(slot);
        if object.always_at == NOWHERE {
            object.always_at = at;
            self.always.push(slot);
        }
    }

    fn forget_always(&mut self, slot: u32) {
        let at = std::mem::replace(&mut self.object_mut(slot).always_at, NOWHERE);
        if at != NOWHERE {
            self.always.swap_remove(at as usize);
            if let Some(&moved) = self.always.get(at as usize) {
                self.object_mut(moved).always_at = at;
            }
        }
    }

    fn set_listed(&mut self, slot: u32, listed: bool) {
        let asks = u32::from(self.object(slot).on_expiry());
        if listed {
            self.object_mut(slot).listed_at = self.listed.len() as u32;
            self.listed.push(slot);
            self.listed_on_expiry += asks;
            return;
        }
        let at = std::mem::replace(&mut self.object_mut(slot).listed_at, NOWHERE);
        if at != NOWHERE {
            self.listed_on_expiry -= asks;
            self.listed.swap_remove(at as usize);
            if let Some(&moved) = self.listed.get(at as usize) {
                self.object_mut(moved).listed_at = at;
            }
        }
    }

    /// Gives an object another occluder, in no matrix.
    fn exchange_occluder(&mut self, slot: u32, occluder: Option<Occluder>) {
        let object = self.slots[slot as usize].object.as_mut();
        let object = object.expect("the matrices and lists hold living objects only");
        let motion = object.motion;
        // Only what lies where its triangles are shares positions with others.
        let fixed = |o: &Occluder| motion == Motion::Static && o.placement().is_none();
        let drawn = |o: &Option<Occluder>| {
            o.as_ref().and_then(|o| o.surface().map(|s| (std::ptr::from_ref(s), fixed(o))))
        };
        if drawn(&object.occluder) == drawn(&occluder) {
            // What moves keeps its numbers.
            object.occluder = occluder;
            return;
        }
        if let Some(old) = &object.occluder
            && let Some(surface) = old.surface()
        {
            self.seams.remove(slot, surface, fixed(old));
        }
        object.occluder = occluder;
        if let Some(new) = &object.occluder
            && let Some(surface) = new.surface()
        {
            self.seams.insert(slot, surface, fixed(new));
        }
    }

    /// Writes an object into I and O.
    fn list(&mut self, slot: u32) {
        let grid = self.grid;
        let object = self.object_mut(slot);
        object.state = State::Listed;
        let (fits, small) = placement(&grid, &object.bounds.block());
        object.in_cells = small;
        let (bounds, occluder) = (object.bounds.clone(), object.occluder.clone());
        let dynamic = !object.is_static();
        let _cells = occluder.as_ref().and_then(|o| o.cache_cells(&grid));
        if small {
            touched(&bounds, &grid, &mut |p| p.bricks(|b, m| self.ids.change(b, &NONE, m, slot)));
        }
        if !(fits && small) {
            self.remember_always(slot);
        }
        if dynamic {
            self.set_listed(slot, true);
        }
        if let Some(occluder) = occluder {
            if dynamic {
                self.add_dynamic_solid(&occluder);
            } else {
                self.add_static_solid(slot, &occluder);
            }
        }
    }

    /// Takes a listed object out of I and O.
    fn unlist(&mut self, slot: u32) {
        let grid = self.grid;
        let object = self.object_mut(slot);
        let in_cells = std::mem::take(&mut object.in_cells);
        let dynamic = !object.is_static();
        let (bounds, occluder) = (object.bounds.clone(), object.occluder.clone());
        let _cells = occluder.as_ref().and_then(|o| o.cache_cells(&grid));
        if in_cells {
            touched(&bounds, &grid, &mut |p| p.bricks(|b, m| self.ids.change(b, m, &NONE, slot)));
        }
        self.forget_always(slot);
        self.set_listed(slot, false);
        if let Some(occluder) = occluder {
            if dynamic {
                self.remove_dynamic_solid(&occluder);
            } else {
                self.remove_static_solid(slot, &occluder);
            }
        }
    }

    /// Moves a listed object: only the cells that change are touched, unless they are many.
    fn relist(&mut self, slot: u32, bounds: Bounds, occluder: Option<Occluder>) {
        let grid = self.grid;
        let mut moved = std::mem::take(&mut self.moved);
        let object = self.object(slot);
        let (fits, small) = placement(&grid, &bounds.block());
        let listed = object.in_cells && object.always_at == NOWHERE;
        let simple = !object.is_static() && fits && small && listed;
        if !(simple && moved.touched(&object.bounds, &bounds, &grid)) {
            self.moved = moved;
            self.unlist(slot);
            self.exchange_occluder(slot, occluder);
            self.object_mut(slot).bounds = bounds;
            self.list(slot);
            return;
        }
        moved.iter().for_each(|(brick, old, new)| self.ids.change(brick, old, new, slot));
        let before = self.object(slot).occluder.clone();
        if moved.opaque(before.as_ref(), occluder.as_ref(), &grid) {
            moved.iter().for_each(|(brick, old, new)| self.move_dynamic_cells(brick, old, new));
        } else {
            before.iter().for_each(|o| self.remove_dynamic_solid(o));
            occluder.iter().for_each(|o| self.add_dynamic_solid(o));
        }
        self.moved = moved;
        self.object_mut(slot).bounds = bounds;
        self.exchange_occluder(slot, occluder);
    }

    /// Puts a listed dynamic object into a volume, if it can be.
    fn try_hide(&mut self, slot: u32) -> bool {
        // A volume around an old place holds nothing.
        if self.object(slot).stale {
            return false;
        }
        let Some((tbv, expires)) = self.lay_volume(slot) else { return false };
        self.unlist(slot);
        self.enter_volume(slot, tbv, expires);
        true
    }

    /// Puts an object that is in no matrix into a volume, or into I and O.
    fn hide_or_list(&mut self, slot: u32) {
        match self.lay_volume(slot) {
            Some((tbv, expires)) => self.enter_volume(slot, tbv, expires),
            None => self.list(slot),
        }
    }

    fn lay_volume(&self, slot: u32) -> Option<(Tbv, f64)> {
        let object = self.object(slot);
        let speed = object.speed();
        let nominal = if speed > 0.0 || object.has_speed() { speed } else { self.grid.cell_size() };
        let far = way(nominal, object.validity);
        let border = match (object.on_expiry(), object.confined) {
            (false, _) => Border::Cut,
            (true, 0) => Border::Beyond,
            (true, _) => Border::Inside,
        };
        let tbv = lay(&self.grid, &object.bounds.block(), far, &self.viewers, border)?;
        Some((tbv, after(self.now, tbv.room(&object.bounds.block()), speed)))
    }

    fn enter_volume(&mut self, slot: u32, tbv: Tbv, expires: f64) {
        self.volumes.insert(slot, &tbv);
        self.revision += 1;
        self.set_hidden(slot, tbv, expires, f64::INFINITY);
    }

    /// Leaves an object in the volume that it has, `room` away from its walls. `queued` is the time of its
    /// entry in the queue, if it has one.
    fn stay_in_volume(&mut self, slot: u32, tbv: Tbv, room: f64, queued: f64) {
        let expires = after(self.now, room, self.object(slot).speed());
        self.set_hidden(slot, tbv, expires, queued);
    }

    fn set_hidden(&mut self, slot: u32, tbv: Tbv, expires: f64, mut queued: f64) {
        let generation = self.slots[slot as usize].generation;
        let object = self.object_mut(slot);
        let early = object.on_expiry() && expires < queued;
        if early {
            queued = expires;
        }
        object.state = State::Hidden { tbv, expires, queued };
        if early {
            self.expiries.push(Expiry { at: expires, slot, generation });
        }
    }

    /// Drops entries that were queued again since, once there are many of them.
    fn compact_expiries(&mut self) {
        if self.expiries.len() <= 2 * self.len + MANY_EXPIRIES {
            return;
        }
        let slots = &self.slots;
        self.expiries.retain(|e| {
            let slot = &slots[e.slot as usize];
            let object = slot.object.as_ref().filter(|_| slot.generation == e.generation);
            object.is_some_and(|o| match o.state {
                State::Hidden { queued, .. } => queued == e.at,
                State::Unlocated { .. } => e.at == f64::NEG_INFINITY,
                State::Listed => false,
            })
        });
    }
}

impl Object {
    fn speed(&self) -> f64 {
        match self.motion {
            Motion::Dynamic { max_speed: Some(v), .. } => f64::from(v),
            _ => 0.0,
        }
    }

    fn has_speed(&self) -> bool {
        matches!(self.motion, Motion::Dynamic { max_speed: Some(_), .. })
    }

    /// One of its volumes, or a try to lay one, is over.
    fn unconfine(&mut self) {
        self.confined = self.confined.saturating_sub(1);
    }

    fn lengthen(&mut self) {
        // Confined volumes tell nothing about larger ones.
        if self.confined == 0 {
            self.validity = (self.validity * LONGER).min(VALIDITY_RANGE.1);
        }
    }
}

fn same_occluder(a: &Option<Occluder>, b: &Option<Occluder>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.same(b),
        (None, None) => true,
        _ => false,
    }
}

/// The time before which an object that is somewhere `now` has not moved by a distance.
///
/// Three operations round by half a unit in the last place each; their results are taken down by one each, so
/// that rounding cannot promise more than the distance holds.
fn after(now: f64, distance: f64, speed: f64) -> f64 {
    if speed > 0.0 {
        (now + (distance.next_down().max(0.0) / speed).next_down().max(0.0)).next_down()
    } else {
        f64::INFINITY
    }
}

/// Whether a block lies inside the grid, and whether it spans few enough of its cells.
fn placement(grid: &Grid, block: &Block) -> (bool, bool) {
    let (lo, hi) = grid.cover(block.min, block.max);
    let fits = grid.contains(lo) && grid.contains(hi);
    let small = grid.clip(lo, hi).is_none_or(|(lo, hi)| volume(lo, hi) <= MAX_SPANNED_CELLS);
    (fits, small)
}
