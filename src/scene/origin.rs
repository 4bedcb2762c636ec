//! Other coordinates: an origin that follows the camera through a large world. All of a scene is
//! shifted at once, or another scene in other coordinates follows it under the same ids, and takes
//! its objects over one by one while it still answers queries.

use casca_slots::{AT_ONCE, Slot};
use glam::{Vec3, Vec3A};

use crate::error::{Error, finite3};
use crate::geometry::Block;
use crate::grid::{Grid, clip};
use crate::id::ObjectId;
use crate::numeric::mesh::SINGLE;
use crate::object::{Bounds, ObjectDesc, Occluder, Placed};
use crate::scene::Scene;
use crate::scene::object::Object;
use crate::scene::opacity::Opacity;
use crate::scene::state::{Event, Hidden, State};
use crate::scene::volume::Tbv;

/// The shapes of an object in other coordinates.
struct Shifted {
    bounds: Bounds,
    occluder: Option<Occluder>,
    placed: Option<Placed>,
}

impl Shifted {
    /// The shapes of an object; `None` if one is a mesh in world space.
    fn of(object: &Object, offset: Vec3) -> Result<Option<Self>, Error> {
        if let Some(placed) = object.placed() {
            let mut placed = placed.clone();
            placed.transform.translation -= Vec3A::from(offset);
            let (bounds, occluder) = placed.at(placed.transform)?;
            return Ok(Some(Self { bounds, occluder, placed: Some(placed) }));
        }
        let Some(bounds) = object.bounds().shifted(offset)? else { return Ok(None) };
        let occluder = match object.given_occluder().map(|occluder| occluder.shifted(offset)).transpose()? {
            Some(None) => return Ok(None),
            Some(Some(occluder)) => occluder,
            None => None,
        };
        bounds.check()?;
        occluder.iter().try_for_each(Occluder::check)?;
        Ok(Some(Self { bounds, occluder, placed: None }))
    }
}

impl Tbv {
    /// The volume in a grid that was shifted: its cells stay.
    fn shifted(&self, grid: &Grid, offset: Vec3) -> Self {
        let by = offset.as_dvec3();
        let block = Block { min: self.block.min - by, max: self.block.max - by };
        let cells = Block::new(grid.range_bounds(self.cells.lo, self.cells.hi));
        Self { block: block.intersection(&cells), ..*self }
    }
}

impl Scene {
    /// Puts the origin of the coordinates at the point `offset`: every coordinate becomes less by
    /// it, those of the grid, the objects and the volumes alike. For large worlds, whose renderer
    /// keeps the camera near the origin. Shift everything else in the same frame: cameras, lights
    /// and your own copies of positions.
    ///
    /// The grid goes with the objects, so that its planes lie between them as before. Its corner is
    /// snapped down to a 2^22nd part of a cell. All sums round as those of an application that
    /// subtracts in single precision: bounds round outwards, occluders inwards, and transforms of
    /// [placed](crate::ObjectDesc::placed) objects and of [`Instance`](crate::Instance)s to
    /// nearest, as [`Scene::translate`] does. Where the offset is a multiple of a power of two that
    /// the coordinates are multiples of, nothing is rounded; multiples of the cell are a good
    /// choice. An occluder that is thinner than the rounding hides nothing from then on.
    ///
    /// No result from before is taken for one of the new coordinates:
    /// [`Pvs::is_valid_for`](crate::Pvs::is_valid_for) says no,
    /// [`Query::sight`](crate::Query::sight) has no occlusion until the query runs again, and a
    /// [`KeptQuery`](crate::KeptQuery) finds a new result. [`Scene::end_frame`] still takes earlier
    /// results. Ids stay. Hidden objects stay in their volumes, unless rounding takes them out.
    ///
    /// Costs as inserting all objects that are in no volume again. Call it rarely: every few
    /// hundred cells of the camera's way.
    ///
    /// ```
    /// use casca::{Aabb, Error, ObjectDesc, Scene};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let wall = scene.insert(ObjectDesc::fixed(Aabb::new(Vec3::splat(8.0), Vec3::splat(10.0))))?;
    /// scene.shift_origin(Vec3::new(16.0, 0.0, 0.0))?;
    /// assert_eq!(scene.bounds(wall)?.aabb().min, Vec3::new(-8.0, 8.0, 8.0));
    /// assert_eq!(scene.grid().min().x, -16.0);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses an offset that is not finite or leads to coordinates that are not, a grid that would
    /// lie too far from the origin, scenes with meshes in world space ([`Error::FixedMesh`]: give
    /// instances of them), and convex occluders as
    /// [`Convex::translated`](crate::Convex::translated) does. Nothing is changed then.
    pub fn shift_origin(&mut self, offset: Vec3) -> Result<(), Error> {
        finite3("the offset", offset)?;
        let grid = self.grid.shifted(offset.as_dvec3())?;
        let mut shapes = Vec::with_capacity(self.len());
        for (slot, object) in self.living() {
            let refused = || Error::FixedMesh(self.id(slot));
            shapes.push((slot, Shifted::of(object, offset)?.ok_or_else(refused)?));
        }
        self.grid = grid;
        self.opacity = Opacity::new();
        self.index.clear_lists();
        self.clock.reports.leave_all_zones();
        self.changes.changed();
        self.changes.all_static_changed();
        let moved = self.changes.moved();
        for (slot, shape) in shapes {
            self.slots[slot].moved = moved;
            self.place_shifted(slot, shape, offset);
        }
        self.opacity.refresh();
        Ok(())
    }

    /// Gives an object that is in no matrix its shapes in the coordinates of the grid, and puts it
    /// where it was.
    fn place_shifted(&mut self, slot: Slot, shape: Shifted, offset: Vec3) {
        let Shifted { bounds, occluder, placed } = shape;
        let object = &mut self.slots[slot];
        object.set_placed(placed);
        (object.bounds, object.in_zone, object.opacity) = (bounds, false, None);
        self.exchange_occluder(slot, occluder);
        match self.object(slot).state() {
            State::Listed => self.list(slot),
            State::Overdue => {
                self.slots[slot].apply(Event::Reported);
                // It misses the report again.
                self.list(slot);
            }
            State::Hidden(hidden) => self.shift_volume(slot, hidden, offset),
            // Its report finds a new volume.
            State::Unlocated { volume } => {
                self.lose(slot, volume.is_some());
            }
        }
    }

    /// Shifts the volume of a hidden object, and leaves the object in it if it surely is still
    /// inside.
    fn shift_volume(&mut self, slot: Slot, hidden: Hidden, offset: Vec3) {
        let tbv = hidden.tbv.shifted(&self.grid, offset);
        let object = self.object(slot);
        let inside = tbv.contains(&self.grid, &object.bounds.block());
        // The place of an object that is not reported was rounded as its bounds were.
        let largest = |b: &Block| b.min.abs().max(b.max.abs()).max_element();
        let off = SINGLE * (largest(&tbv.block) + largest(&hidden.tbv.block)) + 2.0 * self.grid.unit();
        let speed = object.promised_speed().unwrap_or(0.0);
        let mut expires = hidden.expires;
        if object.on_expiry() {
            expires = (expires - (off / speed).next_up()).next_down();
            // Also if it is NaN, for an object that does not move.
            if !(inside && expires > self.clock.now) {
                return self.lose(slot, true);
            }
        } else if !inside {
            self.index.remove_volume(slot);
            return self.list(slot);
        }
        self.changes.volume_is_new(slot, self.slots.len());
        self.hide(slot, Hidden { tbv, expires, ..hidden });
    }

    /// Takes an object out of its volume, if it is in one. It may be anywhere until it is reported,
    /// and its report is due.
    fn lose(&mut self, slot: Slot, enclosed: bool) {
        if enclosed {
            self.index.remove_volume(slot);
        }
        self.slots[slot].apply(Event::Revealed);
        self.index.always.insert(slot);
        self.clock.queue(self.slots.id(slot), AT_ONCE);
    }

    /// Inserts an object whose description was checked, here or in other coordinates.
    ///
    /// # Errors
    /// Refuses more than 2^31 objects.
    pub(crate) fn insert_checked(
        &mut self,
        mut desc: ObjectDesc,
        placed: Option<Placed>,
    ) -> Result<ObjectId, Error> {
        let (occluder, user_data) = (desc.occluder.take(), desc.user_data);
        let object = Object::new(desc, placed, self.changes.moves);
        let slot = self.slots.insert(object).ok_or(Error::SceneFull(self.slots.len()))?;
        self.user_data.set(slot, user_data);
        self.changes.changed();
        self.note_report(slot);
        self.note_static(slot);
        self.exchange_occluder(slot, occluder);
        self.list(slot);
        Ok(self.id(slot))
    }

    /// Takes over an object of another scene under its id, with its shapes in the coordinates of
    /// this one. The place of one that is reported on expiry is not known until it is reported.
    pub(crate) fn take_over(
        &mut self,
        from: &Self,
        id: ObjectId,
        bounds: Bounds,
        occluder: Option<Occluder>,
    ) {
        let Ok(object) = from.find(id) else { return };
        let user_data = from.user_data.get(id.slot());
        let desc = ObjectDesc {
            bounds,
            occluder: None,
            motion: object.motion(),
            contradicts: false,
            user_data,
            layers: object.layers,
            transform: None,
        };
        let object = Object::new(desc, None, self.changes.moves);
        let slot = id.slot();
        if !self.slots.take_over(id.0, object) {
            return;
        }
        self.changes.changed();
        self.user_data.set(slot, user_data);
        self.clock.reports.forget(slot);
        self.note_static(slot);
        self.exchange_occluder(slot, occluder);
        self.list(slot);
    }

    /// A slot of another scene, whose objects this one takes over, holds no object.
    pub(crate) fn skip(&mut self, from: &Self, slot: Slot) {
        self.slots.skip(slot, &from.slots);
    }

    /// Sets the clock to that of another scene.
    pub(crate) fn set_clock(&mut self, from: &Self) {
        self.clock.now = from.clock.now;
    }

    /// Gives out ids where another scene ends, all of whose objects were taken over.
    pub(crate) fn succeed(&mut self, from: &mut Self) {
        self.slots.succeed(&mut from.slots);
    }

    /// As [`Scene::update`], with shapes that were checked elsewhere, in other coordinates.
    pub(crate) fn report_checked(&mut self, id: ObjectId, bounds: Bounds, occluder: Option<Occluder>) {
        if self.contains(id) {
            self.report(id.slot(), bounds, occluder);
        }
    }

    /// Roughly what it costs to insert or to remove an object, in bricks of 8x8x8 cells: those on
    /// the surface of its box, as far as that lies in the grid; 1 at least.
    pub(crate) fn bricks_around(&self, id: ObjectId) -> usize {
        let Ok(object) = self.find(id) else { return 1 };
        let block = object.bounds().block();
        let (lo, hi) = self.grid.cover(block.min, block.max);
        let Some((lo, hi)) = clip(lo, hi) else { return 1 };
        let sides = ((hi >> 3i32) - (lo >> 3i32) + 1).to_array().map(|side| side as usize);
        let inside: usize = sides.iter().map(|side| side.saturating_sub(2)).product();
        sides.iter().product::<usize>() - inside
    }

    /// Brings the boxes that close seams up to date with the static solids inserted and removed.
    pub(crate) fn refresh(&mut self) {
        self.opacity.refresh();
    }
}
