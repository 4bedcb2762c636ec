//! The scene: objects and the matrices that hold them.

use std::collections::BinaryHeap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, IVec3, Vec3};

use crate::cells::{Moved, touched_by, volume};
use crate::error::{Error, finite3};
use crate::fused::Fused;
use crate::geometry::Block;
use crate::grid::{Grid, GridSpec};
use crate::matrix::{BitMatrix, CellBox, Counts, IdMatrix, NONE, OpacityMatrix, TbvMatrix};
use crate::object::{Motion, ObjectDesc, ObjectId, Reports};
use crate::pvs::Pvs;
use crate::shape::{Bounds, Occluder, Shape};
use crate::surface::Seams;
use crate::tbv::{Expiry, FIRST_VALIDITY, LONGER, SHORTER, Tbv, VALIDITY_RANGE, Volumes, lay, way};
use crate::{Aabb, Obb, Sphere, View};

/// An object whose bounds span more cells than this is not written into I, which would take a
/// brick for every 512 of them: it is tested against the frustum in every query.
const MAX_SPANNED_CELLS: u64 = 1 << 22;

/// Beyond this many cells before the near plane all occluders are asked instead.
const MAX_NEAR_CELLS: u64 = 4096;

/// Of the objects in those cells, so many are asked again and again before all are asked once.
const MOST_ASKED: usize = 4096;

static SCENES: AtomicU32 = AtomicU32::new(1);

/// Where an object is kept.
#[derive(Debug, Clone, Copy)]
enum State {
    /// In I and O.
    Listed,
    /// In a temporal bounding volume. `expires` counts for objects that are reported on expiry.
    Hidden { tbv: Tbv, expires: f64 },
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
}

const NOWHERE: u32 = u32::MAX;

impl Object {
    pub(crate) fn is_unlocated(&self) -> bool {
        matches!(self.state, State::Unlocated { .. })
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
}

impl MemoryUse {
    /// The matrices of the grid.
    pub fn grid(&self) -> usize {
        self.opacity + self.ids + self.tbvs
    }

    /// All of it.
    pub fn total(&self) -> usize {
        self.grid() + self.objects
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
    tag: u32,
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
            tag: SCENES.fetch_add(1, Ordering::Relaxed),
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
        self.opacity_static.get(cell) || self.opacity_dynamic.get(cell)
    }

    /// Whether objects are known to touch a cell (I).
    pub fn is_occupied(&self, cell: IVec3) -> bool {
        self.grid.contains(cell) && self.ids.get(cell).next().is_some()
    }

    /// Os: the opaque cells of static objects.
    pub fn static_opacity(&self) -> &OpacityMatrix {
        &self.opacity_static
    }

    /// The opaque cells of visible dynamic objects; with Os they make O.
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

    /// Memory held. Walks over all bricks.
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
        }
    }

    /// Inserts an object. A dynamic one counts as visible until a frame ends without it.
    ///
    /// Costs the cells around the surfaces of its bounds and its occluder, and a little for each 512 cells
    /// inside. Bounds that span more than 2^22 cells cost no cells: such an object is tested against the
    /// view in every query instead, and so is one that reaches out of the grid. A mesh costs the cells of
    /// its box.
    ///
    /// # Errors
    /// Refuses shapes that are not finite, inverted or negative, speeds that are
    /// not finite or negative, and more than 2^31 objects.
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
        self.slots[slot as usize].object = Some(Object {
            bounds: desc.bounds,
            occluder: None,
            motion: desc.motion,
            state: State::Listed,
            validity: FIRST_VALIDITY,
            listed_at: NOWHERE,
            always_at: NOWHERE,
            in_cells: false,
        });
        self.len += 1;
        self.revision += 1;
        self.set_occluder(slot, desc.occluder);
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
    /// Refuses an id that names no object of this scene, and shapes as [`Scene::insert`].
    pub fn update(
        &mut self,
        id: ObjectId,
        bounds: impl Into<Bounds>,
        occluder: Option<Occluder>,
    ) -> Result<(), Error> {
        let (bounds, now) = (bounds.into(), self.now);
        bounds.check()?;
        occluder.as_ref().map_or(Ok(()), Occluder::check)?;
        self.find(id)?;
        let slot = id.slot;
        let object = self.object(slot);
        if !(object.is_unlocated())
            && object.bounds.same(&bounds)
            && same_occluder(&object.occluder, &occluder)
        {
            return Ok(());
        }
        self.moves += 1;
        match self.object(slot).state {
            State::Hidden { tbv, .. } => {
                let block = bounds.block();
                self.set_occluder(slot, occluder);
                let object = self.object_mut(slot);
                object.bounds = bounds;
                if tbv.block.contains(&block) {
                    if object.on_expiry() {
                        let room = (block.min - tbv.block.min).min(tbv.block.max - block.max);
                        let expires = now + seconds(room.min_element(), object.speed());
                        object.state = State::Hidden { tbv, expires };
                    }
                    return Ok(());
                }
                object.lengthen();
                self.volumes.remove(slot);
                self.revision += 1;
                self.hide_or_list(slot);
            }
            State::Unlocated { tbv } => {
                let block = bounds.block();
                self.object_mut(slot).bounds = bounds;
                self.set_occluder(slot, occluder);
                self.forget_always(slot);
                self.revision += 1;
                self.object_mut(slot).lengthen();
                let next = self.lay_volume(slot);
                if let (Some(tbv), Some((wished, _))) = (tbv, &next) {
                    // Where a new volume would not hold much longer, the old one stays.
                    let room = (block.min - tbv.block.min).min(tbv.block.max - block.max).min_element();
                    if room >= 0.5 * wished.slack {
                        self.stay_in_volume(slot, tbv, room);
                        return Ok(());
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
        Ok(())
    }

    /// Moves an object by an offset. Each coordinate is rounded to single
    /// precision; where many small steps would drift, use [`Scene::update`].
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, an offset that is not
    /// finite or leads to coordinates that are not, and objects with meshes.
    pub fn translate(&mut self, id: ObjectId, offset: Vec3) -> Result<(), Error> {
        finite3("the offset", offset)?;
        let (_, object) = self.find(id)?;
        let sphere = |s: &Sphere| Sphere::new(s.center + offset, s.radius);
        let aabb = |b: &Aabb| Aabb::new(b.min + offset, b.max + offset);
        let oriented = |b: &Obb| Obb { center: b.center + offset, ..*b };
        let mesh = || Error::NotFinite { what: "a mesh as moved by an offset", value: DVec3::NAN };
        let bounds = match &object.bounds {
            Bounds::Sphere(s) => Bounds::Sphere(sphere(s)),
            Bounds::Box(b) => Bounds::Box(aabb(b)),
            Bounds::Oriented(b) => Bounds::Oriented(oriented(b)),
            Bounds::Instance(i) => Bounds::Instance(i.translated(offset)?),
            Bounds::Mesh(_) => return Err(mesh()),
        };
        let occluder = match &object.occluder {
            Some(Occluder::Sphere(s)) => Some(Occluder::Sphere(sphere(s))),
            Some(Occluder::Box(b)) => Some(Occluder::Box(aabb(b))),
            Some(Occluder::Oriented(b)) => Some(Occluder::Oriented(oriented(b))),
            Some(Occluder::Convex(c)) => Some(Occluder::Convex(Arc::new(c.translated(offset)?))),
            Some(Occluder::Instance(i)) => Some(Occluder::Instance(i.translated(offset)?)),
            Some(Occluder::Mesh(_)) => return Err(mesh()),
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
        self.set_occluder(id.slot, None);
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

    /// Sets the clock, in seconds, and lists the objects whose report is due:
    /// those [reported on expiry](Reports::OnExpiry) whose volume no longer
    /// holds them for sure. Until each is [updated](Scene::update), every query
    /// counts it as visible.
    ///
    /// A clock that goes backwards makes all of them due.
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
        while let Some(next) = self.expiries.peek() {
            if !backwards && next.at > now {
                break;
            }
            let next = *next;
            self.expiries.pop();
            let slot = &mut self.slots[next.slot as usize];
            if slot.generation != next.generation {
                continue;
            }
            let Some(object) = &mut slot.object else { continue };
            let tbv = match object.state {
                State::Hidden { expires, .. } if !backwards && expires > now => {
                    self.expiries.push(Expiry { at: expires, ..next });
                    continue;
                }
                State::Hidden { tbv, .. } => Some(tbv),
                // Listed, but not seen in the last frame: nobody reports it either.
                State::Listed if next.at == f64::NEG_INFINITY => {
                    self.unlist(next.slot);
                    None
                }
                // Revealed in the last frame: its bounds are old.
                State::Unlocated { .. } if next.at == f64::NEG_INFINITY => {
                    due.push(self.id(next.slot));
                    continue;
                }
                _ => continue,
            };
            self.object_mut(next.slot).state = State::Unlocated { tbv };
            self.remember_always(next.slot);
            self.revision += 1;
            due.push(self.id(next.slot));
        }
        Ok(due)
    }

    /// Applies the results of a frame's queries: dynamic objects that no view
    /// saw go into temporal bounding volumes, revealed ones come out. Without
    /// results nothing changes.
    ///
    /// Costs the dynamic objects that are visible or were revealed.
    ///
    /// # Errors
    /// Refuses a result of another scene.
    pub fn end_frame<'a>(&mut self, views: impl IntoIterator<Item = &'a Pvs>) -> Result<FrameReport, Error> {
        let views: Vec<&Pvs> = views.into_iter().collect();
        if views.iter().any(|p| p.scene != self.tag) {
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
        for &id in views.iter().flat_map(|p| &p.revealed) {
            if self.find(id).is_err() || !matches!(self.object(id.slot).state, State::Hidden { .. }) {
                continue;
            }
            report.revealed += 1;
            self.volumes.remove(id.slot);
            let object = self.object_mut(id.slot);
            object.validity = (object.validity * SHORTER).max(VALIDITY_RANGE.0);
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
            if !is_seen(slot) && self.try_hide(slot) {
                report.hidden += 1;
            } else {
                if !is_seen(slot) && self.object(slot).on_expiry() {
                    let generation = self.slots[slot as usize].generation;
                    self.expiries.push(Expiry { at: f64::NEG_INFINITY, slot, generation });
                }
                i += 1;
            }
        }
        self.seen = seen;
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

    /// Corners of a box that holds all objects whose place is known.
    pub(crate) fn extent(&self) -> (DVec3, DVec3) {
        self.always.iter().fold((self.grid.min(), self.grid.max()), |(min, max), &slot| {
            let block = self.object(slot).bounds.block();
            (min.min(block.min), max.max(block.max))
        })
    }

    pub(crate) fn tag(&self) -> u32 {
        self.tag
    }

    pub(crate) fn id(&self, slot: u32) -> ObjectId {
        ObjectId { scene: self.tag, slot, generation: self.slots[slot as usize].generation }
    }

    /// The object that an id names.
    pub(crate) fn find(&self, id: ObjectId) -> Result<(u32, &Object), Error> {
        self.slots
            .get(id.slot as usize)
            .filter(|s| id.scene == self.tag && s.generation == id.generation)
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
    /// through it, since its front is cut away.
    pub(crate) fn near_plane_cuts(&self, view: &View) -> bool {
        let (min, max) = self.extent();
        view.cut_regions(min, max).any(|(region, block)| {
            let meets = |slot: u32| match &self.object(slot).occluder {
                Some(Occluder::Sphere(s)) => region.may_see_sphere(s),
                Some(Occluder::Box(b)) => region.may_see_block(&Block::from(*b)),
                Some(Occluder::Oriented(b)) => region.may_see_oriented(b),
                Some(other @ Occluder::Convex(_)) => region.may_see_block(&other.block()),
                Some(Occluder::Mesh(m)) => m.surface_meets(&block),
                Some(Occluder::Instance(i)) => region.may_see_block(&Block::new(i.bounds())),
                None => false,
            };
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
        })
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
        if listed {
            self.object_mut(slot).listed_at = self.listed.len() as u32;
            self.listed.push(slot);
            return;
        }
        let at = std::mem::replace(&mut self.object_mut(slot).listed_at, NOWHERE);
        if at != NOWHERE {
            self.listed.swap_remove(at as usize);
            if let Some(&moved) = self.listed.get(at as usize) {
                self.object_mut(moved).listed_at = at;
            }
        }
    }

    /// Gives an object another occluder, in no matrix.
    fn set_occluder(&mut self, slot: u32, occluder: Option<Occluder>) {
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
        if small {
            touched_by(&bounds, &grid, &mut |p| p.bricks(|b, m| self.ids.change(b, &NONE, m, slot)));
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
        if in_cells {
            touched_by(&bounds, &grid, &mut |p| p.bricks(|b, m| self.ids.change(b, m, &NONE, slot)));
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
        if !(simple && moved.bounds(&object.bounds, &bounds, &grid)) {
            self.moved = moved;
            self.unlist(slot);
            self.set_occluder(slot, occluder);
            self.object_mut(slot).bounds = bounds;
            self.list(slot);
            return;
        }
        moved.iter().for_each(|(brick, old, new)| self.ids.change(brick, old, new, slot));
        let before = self.object(slot).occluder.clone();
        if moved.occluders(before.as_ref(), occluder.as_ref(), &grid) {
            moved.iter().for_each(|(brick, old, new)| self.move_dynamic_cells(brick, old, new));
        } else {
            before.iter().for_each(|o| self.remove_dynamic_solid(o));
            occluder.iter().for_each(|o| self.add_dynamic_solid(o));
        }
        self.moved = moved;
        self.object_mut(slot).bounds = bounds;
        self.set_occluder(slot, occluder);
    }

    /// Puts a listed dynamic object into a volume, if it can be.
    fn try_hide(&mut self, slot: u32) -> bool {
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
        let tbv = lay(&self.grid, &object.bounds.block(), far, &self.viewers, object.on_expiry())?;
        Some((tbv, self.now + seconds(tbv.slack, speed)))
    }

    fn enter_volume(&mut self, slot: u32, tbv: Tbv, expires: f64) {
        self.volumes.insert(slot, &tbv.cells);
        self.revision += 1;
        self.set_hidden(slot, tbv, expires);
    }

    /// Leaves an object in the volume that it has, `room` away from its walls.
    fn stay_in_volume(&mut self, slot: u32, tbv: Tbv, room: f64) {
        let expires = self.now + seconds(room, self.object(slot).speed());
        self.set_hidden(slot, tbv, expires);
    }

    fn set_hidden(&mut self, slot: u32, tbv: Tbv, expires: f64) {
        let generation = self.slots[slot as usize].generation;
        let object = self.object_mut(slot);
        object.state = State::Hidden { tbv, expires };
        if object.on_expiry() && expires.is_finite() {
            self.expiries.push(Expiry { at: expires, slot, generation });
        }
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

    fn lengthen(&mut self) {
        self.validity = (self.validity * LONGER).min(VALIDITY_RANGE.1);
    }
}

fn same_occluder(a: &Option<Occluder>, b: &Option<Occluder>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.same(b),
        (None, None) => true,
        _ => false,
    }
}

/// The time an object needs at least for a distance, rounded down by a part in 2^40 so that
/// rounding cannot promise more than the distance holds.
fn seconds(distance: f64, speed: f64) -> f64 {
    if speed > 0.0 { (distance.max(0.0) / speed) * (1.0 - 2f64.powi(-40)) } else { f64::INFINITY }
}

/// Whether a block lies inside the grid, and whether it spans few enough of its cells.
fn placement(grid: &Grid, block: &Block) -> (bool, bool) {
    let (lo, hi) = grid.cover(block.min, block.max);
    let fits = grid.contains(lo) && grid.contains(hi);
    let small = grid.clip(lo, hi).is_none_or(|(lo, hi)| volume(lo, hi) <= MAX_SPANNED_CELLS);
    (fits, small)
}
