//! Reports of moves that change no matrix, or the lists of two zones only: see
//! [`crate::scene::rooms`]. Reports of many moves.

use casca_slots::Slot;
use glam::{Affine3A, Vec3A};

use crate::error::Error;
use crate::geometry::{Aabb, Block, Sphere};
use crate::id::ObjectId;
use crate::numeric::scene::BOX_OF_SPHERE;
use crate::object::Bounds;
use crate::scene::Scene;
use crate::scene::movers::Movers;

/// A box around bounds, where their kind tells it in a few operations. For bounds that are refused
/// there is none, or its corners are not finite or in the wrong order.
#[inline]
fn quick_box(bounds: &Bounds) -> Option<(Vec3A, Vec3A)> {
    match *bounds {
        Bounds::Box(b) => Some((b.min.into(), b.max.into())),
        Bounds::Sphere(Sphere { center, radius }) if radius >= 0.0 => {
            let center = Vec3A::from(center);
            let grow = (center.abs().max_element() + radius) * BOX_OF_SPHERE + f32::MIN_POSITIVE;
            let half = Vec3A::splat(radius + grow);
            Some((center - half, center + half))
        }
        _ => None,
    }
}

/// Takes over bounds of the kinds that have a quick box; whether they are others than before.
#[inline]
fn replace(bounds: &mut Bounds, new: &Bounds) -> bool {
    match (&mut *bounds, new) {
        (Bounds::Sphere(old), Bounds::Sphere(new)) => std::mem::replace(old, *new) != *new,
        (Bounds::Box(old), Bounds::Box(new)) => std::mem::replace(old, *new) != *new,
        _ => {
            *bounds = new.clone();
            true
        }
    }
}

impl Scene {
    /// Moves an object that hides nothing inside its room; false, without a change, if it is in
    /// none, would leave it, or has bounds that are to be checked.
    #[inline]
    pub(super) fn move_in_room(&mut self, id: ObjectId, bounds: &Bounds) -> bool {
        let Some((min, max)) = quick_box(bounds) else { return false };
        if !self.rooms.hold(id.0, min, max) {
            return false;
        }
        let object = &mut self.slots[id.slot()];
        if object.is_placed() {
            return false;
        }
        // Objects reported on expiry have no rooms but in zones.
        let overdue = object.on_expiry() && self.reports.report(id.slot());
        if replace(&mut object.bounds, bounds) || overdue {
            object.moved = self.changes.moved();
            // Where it is in its volume tells a result nothing.
            if !object.is_hidden() {
                self.changes.changed();
                self.boxes.put_mover(id.slot(), min, max);
            }
        }
        true
    }

    /// Moves an object that is listed in a zone to another; false, without a change, for other
    /// objects, and for bounds that are to be checked or may not be listed by zones.
    #[inline(never)]
    pub(super) fn move_to_room(&mut self, id: ObjectId, bounds: &Bounds) -> bool {
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
        let plain = object.is_plain();
        let room = self.movers.insert(&self.grid, (id.0, zone), plain);
        self.boxes.put_mover(slot, lower, upper);
        self.rooms.open(id.0, &room);
        self.changes.changed();
        true
    }
}

impl Scene {
    /// Takes over bounds of an object that hides nothing, if it stays in its room with them; false,
    /// without a change, if not.
    pub(super) fn stay_in_room(&mut self, slot: Slot, bounds: &Bounds) -> bool {
        let Aabb { min, max } = bounds.aabb();
        if !self.rooms.hold(self.slots.id(slot), min.into(), max.into()) {
            return false;
        }
        let object = &mut self.slots[slot];
        object.bounds = bounds.clone();
        object.moved = self.changes.moved();
        if !object.is_hidden() {
            self.changes.changed();
            self.refresh_mover(slot);
        }
        true
    }

    /// Moves many objects that hide nothing, as [`Scene::update`] without an occluder does one by
    /// one. All moves are made but those that are refused.
    ///
    /// Costs a comparison for each small object that stays in its zone of 32x32x32 cells, or in its
    /// volume, if its bounds are a sphere or a box; it is cheapest in the order of
    /// [`ObjectId::index`].
    ///
    /// ```
    /// use casca::{GridSpec, ObjectDesc, Scene, Sphere};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(32) })?;
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
        first_refused(moves.into_iter().map(|(id, bounds)| (id, self.update(id, bounds, None))))
    }

    /// Moves many placed objects, as [`Scene::set_transform`] does one by one. All moves are made
    /// but those that are refused.
    ///
    /// Costs the shapes under their new transforms, and a comparison for each object that hides
    /// nothing and stays in its zone of 32x32x32 cells, or in its volume.
    ///
    /// # Errors
    /// The first move that was refused, with the reasons of [`Scene::set_transform`].
    pub fn set_transforms(
        &mut self,
        moves: impl IntoIterator<Item = (ObjectId, Affine3A)>,
    ) -> Result<(), (ObjectId, Error)> {
        first_refused(moves.into_iter().map(|(id, at)| (id, self.set_transform(id, at))))
    }
}

/// Runs through all results, and gives the first error.
fn first_refused(
    results: impl Iterator<Item = (ObjectId, Result<(), Error>)>,
) -> Result<(), (ObjectId, Error)> {
    let mut first = Ok(());
    for (id, result) in results {
        if let (Err(why), Ok(())) = (result, first) {
            first = Err((id, why));
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::random::Random;

    #[test]
    fn the_quick_box_contains_the_sphere() {
        let mut random = Random::new(5);
        let check = |center: Vec3, radius: f32| {
            let bounds = Bounds::from(Sphere::new(center, radius));
            let (block, (min, max)) = (bounds.block(), quick_box(&bounds).unwrap());
            assert!(min.as_dvec3().cmple(block.min).all(), "{center} {radius}");
            assert!(max.as_dvec3().cmpge(block.max).all(), "{center} {radius}");
            let off = (block.min - min.as_dvec3()).max(max.as_dvec3() - block.max).max_element();
            let size = f64::from(center.abs().max_element() + radius);
            assert!(off <= 5e-7 * size + 2.0 * f64::from(f32::MIN_POSITIVE), "{center} {radius} {off}");
        };
        for i in 0..2000 {
            let size = 10f64.powi(i % 20 - 10);
            check((random.point(size)).as_vec3(), (random.next().abs() * size * 2.0) as f32);
            check((random.point(size)).as_vec3(), (random.next().abs() * size * 1e-7) as f32);
        }
        check(Vec3::splat(1e-45), 1e-45);
        check(Vec3::splat(f32::MIN_POSITIVE), f32::MIN_POSITIVE);
    }
}
