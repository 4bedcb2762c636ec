//! Other coordinates: an origin in double precision, which follows the eye through a large world.

use casca_slots::Slot;
use glam::DVec3;

use crate::error::Error;
use crate::geometry::Block;
use crate::geometry::offset::Offset;
use crate::grid::Grid;
use crate::numeric::mesh::SINGLE;
use crate::numeric::place::FARTHEST;
use crate::object::{Bounds, Occluder, Placed};
use crate::scene::Scene;
use crate::scene::home::Hidden;
use crate::scene::object::Object;
use crate::scene::opacity::Opacity;
use crate::scene::volume::Tbv;
use crate::view::View;

/// The shapes of an object in other coordinates.
struct Shifted {
    bounds: Bounds,
    occluder: Option<Occluder>,
    placed: Option<Placed>,
}

impl Shifted {
    /// The shapes of an object.
    fn of(object: &Object, offset: &Offset) -> Result<Self, Error> {
        if let Some(placed) = object.placed() {
            let mut placed = placed.clone();
            let at = placed.transform.translation.as_dvec3() + offset.by;
            placed.transform.translation = at.as_vec3a();
            let (bounds, occluder) = placed.at(placed.transform)?;
            return Ok(Self { bounds, occluder, placed: Some(placed) });
        }
        let bounds = object.bounds().shifted(offset)?;
        let occluder = object.given_occluder().map(|given| given.shifted(offset)).transpose()?.flatten();
        bounds.check()?;
        occluder.iter().try_for_each(Occluder::check)?;
        Ok(Self { bounds, occluder, placed: None })
    }
}

impl Tbv {
    /// The volume in coordinates that differ by an offset; it stays in its cells.
    fn shifted(&self, grid: &Grid, by: DVec3) -> Self {
        let block = Block { min: self.block.min + by, max: self.block.max + by };
        let cells = Block::new(grid.range_bounds(self.cells.lo, self.cells.hi));
        Self { block: block.intersection(&cells), ..*self }
    }
}

/// Refuses a place that is not finite or too far away.
pub(crate) fn check_place(what: &'static str, at: DVec3) -> Result<(), Error> {
    if !at.is_finite() {
        return Err(Error::NotFinite { what, value: at });
    }
    if at.abs().max_element() > FARTHEST { Err(Error::TooFar { what, value: at }) } else { Ok(()) }
}

impl Scene {
    /// The place of the origin of all coordinates: see [`Scene::set_origin`]. Zero at first.
    #[inline]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// A view in coordinates relative to a place, such as the eye, in those of the scene: the view
    /// of a renderer that draws relative to the eye, whose matrix has no translation. The place is
    /// not rounded to single precision.
    ///
    /// It is a view of the scene until the origin is set: make it anew in each frame. Lights are in
    /// the scene's coordinates, too: `at - scene.origin()`.
    ///
    /// # Errors
    /// Refuses a place that is not finite or farther than 2^60 world units from the world's origin.
    pub fn view(&self, from: DVec3, view: &View) -> Result<View, Error> {
        check_place("the place of the view", from)?;
        Ok(view.carried(from - self.origin))
    }

    /// Puts the origin of all coordinates at a place of a world in double precision: for levels that
    /// lie far from the world's origin, and for worlds so large that the origin follows the eye.
    /// Objects, grid and volumes stay where they are, and their coordinates become those relative to
    /// the new origin. Give all else relative to it from then on: cameras ([`Scene::view`]), lights,
    /// new objects, moves.
    ///
    /// Bounds round outwards, occluders inwards, and transforms of
    /// [placed](crate::ObjectDesc::placed) objects to nearest. Where origins are multiples of a power
    /// of two that the coordinates are multiples of, nothing is rounded: take multiples of 512 cells
    /// of a power of two, or of 1024 units. With others, bounds of what stays for many shifts grow by
    /// a digit in each. An occluder that is thinner than the rounding hides nothing from then on.
    /// Meshes in world space become instances, which fill no cells for [`crate::Method::Cell`].
    ///
    /// No result from before is taken for one of the new coordinates:
    /// [`Pvs::is_valid_for`](crate::Pvs::is_valid_for) says no,
    /// [`Query::sight`](crate::Query::sight) has no occlusion until the query runs again, and a
    /// [`KeptQuery`](crate::KeptQuery) finds a new result. [`Scene::end_frame`] still takes earlier
    /// results. Ids stay. Hidden objects stay in their volumes, unless rounding takes them out or cells
    /// are numbered anew, every 2^18 of them.
    ///
    /// Costs as inserting all objects again, a third of a microsecond to two for each, and nothing in
    /// an empty scene. Call it rarely: every few thousand cells of the camera's way, as
    /// `examples/large_world.rs` does. Where that pause is too long, set it on a clone in another
    /// thread, give the clone what changed since, and go on with that: the ids are the same.
    ///
    /// ```
    /// use casca::{Aabb, ObjectDesc, Query, Scene, View};
    /// use glam::{DVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// // A level at four thousand kilometres.
    /// scene.set_origin(DVec3::new(4_194_304.0, 0.0, 0.0))?;
    /// let wall = scene.insert(ObjectDesc::fixed(Aabb::new(Vec3::splat(8.0), Vec3::splat(10.0))))?;
    /// // The eye in the world, and the view of a renderer that draws relative to it.
    /// let eye = DVec3::new(4_194_309.1, 9.0, 9.0);
    /// let view = scene.view(eye, &View::omnidirectional(Vec3::ZERO)?)?;
    /// assert!(Query::new().run(&scene, &view).contains(wall));
    /// scene.set_origin(scene.origin() + 1024.0)?;
    /// assert_eq!(scene.bounds(wall)?.aabb().min, Vec3::splat(8.0 - 1024.0));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses a place that is not finite or farther than 2^60 units from the world's origin, and one
    /// from which there are coordinates beyond single precision or 2^28 cells. Nothing is changed then.
    pub fn set_origin(&mut self, at: DVec3) -> Result<(), Error> {
        check_place("the origin", at)?;
        if self.is_empty() {
            self.origin = at;
            self.changes.changed();
            self.changes.all_static_changed();
            return Ok(());
        }
        let offset = Offset::between(self.origin, at);
        let (grid, keeps_numbers) = self.grid.shifted(offset.by)?;
        let mut shapes = Vec::with_capacity(self.len());
        for (slot, object) in self.living() {
            shapes.push((slot, Shifted::of(object, &offset)?));
        }
        (self.origin, self.grid) = (at, grid);
        self.opacity = Opacity::new();
        self.index.clear_lists();
        self.clock.reports.leave_all();
        self.changes.changed();
        self.changes.all_static_changed();
        let moved = self.changes.moved();
        for (slot, shape) in shapes {
            self.slots[slot].moved = moved;
            self.place_shifted(slot, shape, offset.by, keeps_numbers);
        }
        Ok(())
    }

    /// Gives an object that is in no matrix its shapes in the coordinates of the grid, and puts it
    /// where it was.
    fn place_shifted(&mut self, slot: Slot, shape: Shifted, by: DVec3, keeps_numbers: bool) {
        let Shifted { bounds, occluder, placed } = shape;
        let object = &mut self.slots[slot];
        object.set_placed(placed);
        (object.bounds, object.in_zone, object.opacity) = (bounds, false, None);
        self.exchange_occluder(slot, occluder);
        match self.object(slot).volume() {
            Some(&hidden) => self.shift_volume(slot, hidden, by, keeps_numbers),
            None => self.list(slot),
        }
    }

    /// Shifts the volume of an object, and leaves the object in it if it surely is still inside.
    fn shift_volume(&mut self, slot: Slot, hidden: Hidden, by: DVec3, keeps_numbers: bool) {
        let tbv = hidden.tbv.shifted(&self.grid, by);
        let object = self.object(slot);
        // The matrices know the volume by the numbers of its cells.
        let mut inside = keeps_numbers && tbv.contains(&self.grid, &object.bounds.block());
        let mut expires = hidden.expires;
        if object.on_expiry() {
            // The place of an object that is not reported was rounded as its bounds were.
            let largest = |b: &Block| b.min.abs().max(b.max.abs()).max_element();
            let off = SINGLE * (largest(&tbv.block) + largest(&hidden.tbv.block)) + 2.0 * self.grid.unit();
            let speed = object.promised_speed().unwrap_or(0.0);
            expires = (expires - (off / speed).next_up()).next_down();
            // Not if it is NaN, either, for an object that does not move.
            inside &= object.is_hidden() && expires > self.clock.now;
        }
        if inside {
            self.changes.volume_is_new(slot, self.slots.len());
            self.hide(slot, Hidden { tbv, expires, ..hidden });
        } else {
            self.remove_volume(slot);
            self.list(slot);
        }
    }
}
