//! Changing the objects of a scene.

use casca_slots::Slot;
use glam::{Affine3A, Vec3, Vec3A};

use crate::error::{Error, finite3};
use crate::geometry::Block;
use crate::id::ObjectId;
use crate::object::{Bounds, ObjectDesc, Occluder, check_pair, instances_at};
use crate::scene::Scene;
use crate::scene::movers::Movers;
use crate::scene::object::Object;
use crate::scene::rooms::quick_box;

impl Scene {
    /// Inserts an object. A dynamic one counts as visible until a frame ends without it.
    ///
    /// Costs the cells around the surfaces of its bounds and its occluder, and a little for each
    /// 512 cells inside. Bounds that span more than 2^22 cells cost no cells: such an object is
    /// tested against the view in every query instead, and so is one that reaches farther than 2^20
    /// cells from the corner of the grid. A mesh costs the cells of its surface.
    ///
    /// # Errors
    /// Refuses shapes that are not finite, inverted or negative, occluders that stick out of the
    /// box of their bounds by more than a thousandth of its diagonal, speeds that are not finite or
    /// negative, speeds of fixed objects, and more than 2^31 objects; also transforms that
    /// [`Scene::set_transform`] would refuse.
    pub fn insert(&mut self, mut desc: ObjectDesc) -> Result<ObjectId, Error> {
        desc.check()?;
        let placed = desc.place()?;
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

    /// Reserves memory for the records of more objects, before many are inserted. The matrices
    /// still grow with the cells that objects touch. Does nothing if there is not enough memory.
    pub fn reserve(&mut self, additional: usize) {
        self.slots.reserve(additional);
        self.index.boxes.reserve(self.slots.len().saturating_add(additional));
    }

    /// Moves an object or changes its shape: all of it, in world units.
    ///
    /// An object that hides nothing and stays in its zone of 32x32x32 cells, its bricks of 8x8x8 or its
    /// volume costs a comparison; others cost the cells that they enter or leave. For an object that is reported on
    /// expiry this is the report, also where nothing changed. An object that was
    /// [placed](ObjectDesc::placed) is not any more.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, shapes as [`Scene::insert`], and an update
    /// without occluder of an object that has one (see [`Scene::set_occluder`]).
    pub fn update(
        &mut self,
        id: ObjectId,
        bounds: impl Into<Bounds>,
        occluder: Option<Occluder>,
    ) -> Result<(), Error> {
        let bounds = bounds.into();
        if occluder.is_none() && (self.move_in_room(id, &bounds) || self.move_to_room(id, &bounds)) {
            return Ok(());
        }
        check_pair(&bounds, occluder.as_ref())?;
        let object = self.find(id)?;
        if occluder.is_none() && object.given_occluder().is_some() {
            return Err(Error::OccluderMissing(id));
        }
        self.slots[id.slot()].set_placed(None);
        self.report(id.slot(), bounds, occluder);
        Ok(())
    }

    /// Gives an object other bounds. Its occluder stays, and so does its place:
    /// [`Scene::set_transform`] goes on working for a [placed](ObjectDesc::placed) object. For
    /// skinned meshes, whose bounds change with each pose.
    ///
    /// The bounds are in the space that the object was described in: in its own one if it is
    /// placed, in world units if not. So an engine gives the box of the pose, and apart from that
    /// the transform of the object. Bounds of an object that consists of
    /// [`Instance`](crate::Instance)s must be an instance under the same transform again, or
    /// [`Scene::set_transform`] refuses it from then on.
    ///
    /// Costs as [`Scene::update`]; like that it is the report of an object that is reported on
    /// expiry.
    ///
    /// ```
    /// use casca::{Aabb, ObjectDesc, Scene};
    /// use glam::{Affine3A, UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let standing = Aabb::new(Vec3::new(-0.4, 0.0, -0.4), Vec3::new(0.4, 1.8, 0.4));
    /// let at = |x| Affine3A::from_translation(Vec3::new(x, 2.0, 9.0));
    /// let person = scene.insert(ObjectDesc::dynamic(standing).placed(at(5.0)))?;
    /// // The next pose, and the next step.
    /// scene.set_bounds(person, Aabb { max: Vec3::new(0.4, 1.1, 0.9), ..standing })?;
    /// scene.set_transform(person, at(5.1))?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, and shapes as [`Scene::insert`]: also
    /// bounds that the occluder of the object sticks out of. The object then stays as it is.
    pub fn set_bounds(&mut self, id: ObjectId, bounds: impl Into<Bounds>) -> Result<(), Error> {
        let bounds = bounds.into();
        let object = self.find(id)?;
        let occluder = object.given_occluder().cloned();
        let Some(placed) = object.placed() else {
            check_pair(&bounds, occluder.as_ref())?;
            self.report(id.slot(), bounds, occluder);
            return Ok(());
        };
        check_pair(&bounds, placed.occluder.as_ref())?;
        let world = bounds.placed(placed.transform)?;
        check_pair(&world, None)?;
        if let Some(placed) = self.slots[id.slot()].placed_mut() {
            placed.bounds = bounds;
        }
        self.report(id.slot(), world, occluder);
        Ok(())
    }

    /// Gives an object another occluder, or takes away the one that it has. Its bounds stay.
    ///
    /// Costs as [`Scene::update`]; like that it is the report of an object that is reported on
    /// expiry, and an object that was [placed](ObjectDesc::placed) is not any more.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, and shapes as [`Scene::insert`].
    pub fn set_occluder(&mut self, id: ObjectId, occluder: Option<Occluder>) -> Result<(), Error> {
        let bounds = self.bounds(id)?.clone();
        check_pair(&bounds, occluder.as_ref())?;
        self.slots[id.slot()].set_placed(None);
        self.report(id.slot(), bounds, occluder);
        Ok(())
    }

    /// Moves a placed object: its bounds and its occluder together. `transform` leads from the
    /// space of its shapes to world space, wherever the object was before.
    ///
    /// For objects that were described with [`ObjectDesc::placed`], and for objects whose bounds
    /// are an [`Instance`](crate::Instance) of a mesh and whose occluder, if they have one, is an
    /// instance under the same transform. Costs as [`Scene::update`], and the corners of the
    /// shapes; like that it is the report of an object that is reported on expiry.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use casca::{Instance, ObjectDesc, Scene, TriMesh};
    /// use glam::{Affine3A, UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// # let mut scene = Scene::new(1.0)?;
    /// let leaf = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
    /// let leaf = Instance::new(Arc::new(leaf), Affine3A::from_translation(Vec3::splat(8.0)))?;
    /// let leaf = scene.insert(ObjectDesc::dynamic(leaf.clone()).occluder(leaf))?;
    /// let turned = Affine3A::from_rotation_y(0.5) * Affine3A::from_scale(Vec3::new(1.0, 3.0, 1.0));
    /// scene.set_transform(leaf, turned)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, objects that are not placed
    /// ([`Error::NotPlaced`]), transforms that are not finite or lead to coordinates that are not
    /// in single precision, and transforms of spheres that do not scale all axes alike. The object
    /// then stays where it is.
    pub fn set_transform(&mut self, id: ObjectId, transform: Affine3A) -> Result<(), Error> {
        let object = self.find(id)?;
        let (bounds, occluder) = match object.placed() {
            Some(placed) => placed.at(transform)?,
            None => instances_at(object.bounds(), object.given_occluder(), transform)?
                .ok_or(Error::NotPlaced(id))?,
        };
        if let Some(placed) = self.slots[id.slot()].placed_mut() {
            placed.transform = transform;
        }
        self.report(id.slot(), bounds, occluder);
        Ok(())
    }

    /// Moves an object by an offset in world units. Each coordinate is rounded to single
    /// precision; where many small steps would drift, use [`Scene::update`]. Costs as that.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene, an offset that is not
    /// finite or leads to coordinates that are not, and objects with meshes in world space.
    pub fn translate(&mut self, id: ObjectId, offset: Vec3) -> Result<(), Error> {
        finite3("the offset", offset)?;
        let object = self.find(id)?;
        if let Some(mut transform) = object.placed().map(|placed| placed.transform) {
            transform.translation += Vec3A::from(offset);
            return self.set_transform(id, transform);
        }
        let refused = || Error::FixedMesh(id);
        let bounds = object.bounds().moved(offset)?.ok_or_else(refused)?;
        let occluder = match object.given_occluder() {
            Some(occluder) => Some(occluder.moved(offset)?.ok_or_else(refused)?),
            None => None,
        };
        self.update(id, bounds, occluder)
    }

    /// Moves many objects that hide nothing, as [`Scene::update`] without an occluder does one by
    /// one. All moves are made but those that are refused.
    ///
    /// Costs a comparison for each object that stays in its zone of 32x32x32 cells, in its bricks if it
    /// is too large for that, or in its volume, if its bounds are a sphere or a box; it is cheapest in
    /// the order of [`ObjectId::index`].
    ///
    /// ```
    /// use casca::{ObjectDesc, Scene, Sphere};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let ball = |x: f32| Sphere::new(Vec3::new(x, 9.0, 9.0), 0.5);
    /// let birds = (0..20).map(|i| scene.insert(ObjectDesc::dynamic(ball(i as f32 + 1.0))));
    /// let birds = birds.collect::<Result<Vec<_>, _>>()?;
    /// let moves = birds.iter().zip(0..).map(|(&id, i)| (id, ball(i as f32 + 1.1)));
    /// scene.update_many(moves).map_err(|(_, why)| why)?;
    /// assert!(scene.bounds(birds[19])?.aabb().contains(Vec3::new(20.1, 9.0, 9.0)));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// The first move that was refused, with the reasons of [`Scene::update`].
    pub fn update_many<B: Into<Bounds>>(
        &mut self,
        moves: impl IntoIterator<Item = (ObjectId, B)>,
    ) -> Result<(), (ObjectId, Error)> {
        first_refused(moves, |id, bounds| self.update(id, bounds, None))
    }

    /// Moves many placed objects, as [`Scene::set_transform`] does one by one. All moves are made
    /// but those that are refused.
    ///
    /// Costs the shapes under their new transforms, and little more for each object that hides
    /// nothing and stays in its zone of 32x32x32 cells, in its bricks or in its volume.
    ///
    /// # Errors
    /// The first move that was refused, with the reasons of [`Scene::set_transform`].
    pub fn set_transforms(
        &mut self,
        moves: impl IntoIterator<Item = (ObjectId, Affine3A)>,
    ) -> Result<(), (ObjectId, Error)> {
        first_refused(moves, |id, at| self.set_transform(id, at))
    }

    /// Gives an object another number: see [`Scene::user_data`]. Costs one look-up; results keep
    /// holding.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn set_user_data(&mut self, id: ObjectId, user_data: u64) -> Result<(), Error> {
        self.find(id)?;
        self.user_data.set(id.slot(), user_data);
        Ok(())
    }

    /// Puts an object on other layers: see [`ObjectDesc::layers`]. Results that were found before
    /// do not hold any more.
    ///
    /// It is no report for an object that is reported on expiry. Costs one look-up; if the object
    /// has an occluder, the cells that it touches.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn set_layers(&mut self, id: ObjectId, mask: u64) -> Result<(), Error> {
        let object = self.find(id)?;
        if object.layers == mask {
            return Ok(());
        }
        let is_static = object.is_static();
        self.changes.changed();
        if is_static {
            self.note_static(id.slot());
        } else {
            // A view that passed over its volume may show it from now on.
            self.changes.volume_is_new(id.slot(), self.slots.len());
        }
        self.change_layers(id.slot(), mask);
        Ok(())
    }

    /// Takes over the static objects in some slots of another scene, of which this one is a copy.
    /// What was there before is taken out.
    pub(crate) fn follow_static(&mut self, from: &Self, slots: &[Slot]) {
        for &slot in slots {
            if self.slots.get(slot).is_some() {
                self.take_out(slot);
            }
            let Some(object) = from.living_at(slot).filter(|object| object.is_static()) else { continue };
            let occluder = object.given_occluder().cloned();
            self.slots.take_over(from.id(slot).0, object.unlisted());
            self.note_static(slot);
            self.exchange_occluder(slot, occluder);
            self.list(slot);
        }
    }

    /// Takes an object out. Costs the cells that it touches; of a hidden object, those of its
    /// volume's surface.
    ///
    /// # Errors
    /// Refuses an id that names no object of this scene.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), Error> {
        self.find(id)?;
        self.take_out(id.slot());
        Ok(())
    }

    /// Takes all objects out. Their ids and the results with them are refused from now on, as after
    /// [`Scene::remove`]; the grid, the clock and the memory stay. Costs as removing each object.
    ///
    /// ```
    /// # use casca::{Error, ObjectDesc, Scene, Sphere};
    /// # use glam::{UVec3, Vec3};
    /// # fn main() -> Result<(), Error> {
    /// # let mut scene = Scene::new(1.0)?;
    /// # let ball = Sphere::new(Vec3::splat(4.0), 1.0);
    /// let id = scene.insert(ObjectDesc::fixed(ball))?;
    /// scene.clear();
    /// assert!(scene.is_empty() && !scene.contains(id));
    /// assert_ne!(scene.insert(ObjectDesc::fixed(ball))?, id);
    /// # Ok(())
    /// # }
    /// ```
    pub fn clear(&mut self) {
        for slot in Slot::below(self.slots.count()).rev() {
            if self.slots.get(slot).is_some() {
                self.take_out(slot);
            }
        }
    }

    /// Moves an object that hides nothing inside its room; false, without a change, if it is in
    /// none, would leave it, or has bounds that are to be checked.
    #[inline]
    fn move_in_room(&mut self, id: ObjectId, bounds: &Bounds) -> bool {
        let Some((min, max)) = quick_box(bounds) else { return false };
        if !self.index.rooms.hold(id.0, min, max) {
            return false;
        }
        let object = &mut self.slots[id.slot()];
        if object.is_placed() {
            return false;
        }
        // In a volume, objects reported on expiry have no rooms.
        let overdue = object.on_expiry() && self.clock.reports.report(id.slot());
        if object.replace_bounds(bounds) || overdue {
            object.moved = self.changes.moved();
            // Where it is in its volume tells a result nothing.
            if !object.is_hidden() {
                self.changes.changed();
                self.index.boxes.put_mover(id.slot(), min, max);
            }
        }
        true
    }

    /// Moves an object that is listed in a zone to another; false, without a change, for other
    /// objects, and for bounds that are to be checked or may not be listed by zones.
    #[inline(never)]
    fn move_to_room(&mut self, id: ObjectId, bounds: &Bounds) -> bool {
        let Some((lower, upper)) = quick_box(bounds) else { return false };
        let (slot, Some(object)) = (id.slot(), self.slots.find(id.0)) else { return false };
        if !object.in_zone || object.is_placed() {
            return false;
        }
        // Numbers that are not finite are in no grid.
        let (min, max) = (lower.as_dvec3(), upper.as_dvec3());
        let zone = Movers::zone_of(&self.grid, &Block { min, max }).filter(|_| min.cmple(max).all());
        let Some(zone) = zone else { return false };
        // The same bounds again are no change, also where a corner lies on the side of a room.
        if object.bounds.same(bounds) {
            return false;
        }
        self.note_report(slot);
        let object = &mut self.slots[slot];
        object.moved = self.changes.moved();
        object.bounds = bounds.clone();
        self.index.enter_zone(&self.grid, (id.0, zone), object.is_plain(), (lower, upper));
        self.changes.changed();
        true
    }
}

/// Makes all moves, and gives the first that was refused.
fn first_refused<M>(
    moves: impl IntoIterator<Item = (ObjectId, M)>,
    mut make: impl FnMut(ObjectId, M) -> Result<(), Error>,
) -> Result<(), (ObjectId, Error)> {
    let mut first = None;
    // Quicker than `for`, which has each pair copied twice.
    moves.into_iter().for_each(|(id, to)| {
        if let Err(why) = make(id, to) {
            first.get_or_insert((id, why));
        }
    });
    first.map_or(Ok(()), Err)
}
