//! Draw lists: the visible objects in order, with projected size and level of detail.

use std::f64::consts::TAU;

use casca_slots::Slot;
use glam::DVec3;

use crate::error::{Error, not_negative};
use crate::id::ObjectId;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::view::{Origin, View};

/// An object to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DrawItem {
    /// The object.
    pub id: ObjectId,
    /// From the eye to the nearest point of the bounds in world units, 0 inside of them. For
    /// parallel rays, how far along them that point lies from the plane through the origin of the
    /// world: it may be negative.
    ///
    /// For a mesh it is the distance of its bounding box. For an object that goes unreported
    /// ([`crate::Reports::OnExpiry`]) it is that of the volume around it; without a volume it is 0
    /// (for parallel rays, minus infinity).
    pub distance: f32,
    /// The angle in radians under which the eye sees a ball around the bounds, up to pi; 2 pi
    /// inside that ball. For parallel rays, the diameter of the ball in world units.
    ///
    /// The ball is the bounds themselves if they are a sphere, else the ball around their box. For
    /// an object that goes unreported it is the ball around its volume; without a volume the size
    /// is 2 pi (for parallel rays, infinity).
    pub size: f32,
    /// The share of the object that can be seen, 0 to 1: 1, unless the application sets an estimate
    /// of its own, such as the share of some boxes of which [`crate::Query::sight`] sees a point.
    pub fraction: f32,
}

impl DrawItem {
    /// The size of what can be seen of the object: [`DrawItem::size`] times the root of
    /// [`DrawItem::fraction`], since areas grow with the square of the size. By default the size
    /// itself. The greatest first is an order for streaming.
    pub fn seen_size(&self) -> f32 {
        self.size * self.fraction.sqrt()
    }

    /// The level of detail by [`DrawItem::seen_size`]: how many of the `thresholds` it is below.
    /// With thresholds in descending order, 0 is the finest level and `thresholds.len()` the
    /// coarsest. NaN counts for nothing.
    ///
    /// A threshold of `n` pixels is `n * field_of_view / height` in radians, where `height` is the
    /// height of the picture in pixels and `field_of_view` its vertical angle: exact for narrow
    /// views. In wide ones, pixels in the middle of the picture see a larger angle: `n * 2.0 *
    /// (field_of_view / 2.0).tan() / height`. For parallel rays it is `n` times the width of a
    /// pixel in world units.
    ///
    /// ```
    /// use casca::{DrawOptions, ObjectDesc, Query, Scene, Sphere, View};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let ball = |x| ObjectDesc::fixed(Sphere::new(Vec3::new(x, 32.0, 32.0), 1.0));
    /// let (far, near) = (scene.insert(ball(60.0))?, scene.insert(ball(8.0))?);
    /// let mut query = Query::new();
    /// let pvs = query.run(&scene, &View::omnidirectional(Vec3::new(4.0, 32.0, 31.0))?);
    /// let mut items = Vec::new();
    /// pvs.draw_list(&scene, &DrawOptions::default(), &mut items)?;
    /// // Full detail from 200 pixels on, half of it from 50, in a picture 1080 pixels and 1 radian high.
    /// let thresholds = [200.0 / 1080.0, 50.0 / 1080.0];
    /// let levels: Vec<_> = items.iter().map(|item| (item.id, item.level(&thresholds))).collect();
    /// assert_eq!(levels, [(near, 0), (far, 2)]);
    /// # Ok(())
    /// # }
    /// ```
    pub fn level(&self, thresholds: &[f32]) -> usize {
        thresholds.iter().filter(|&&t| self.seen_size() < t).count()
    }
}

/// How [`Pvs::draw_list`] lists the visible objects.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct DrawOptions {
    /// Contribution culling: objects with a [`DrawItem::size`] below this are left out, in radians
    /// (for parallel rays, in world units); finite and not negative. 0, the default, leaves out
    /// none.
    ///
    /// **Not conservative**: objects that are left out can be seen, if small. Objects that go
    /// unreported while hidden are never left out, since nobody knows how near they are.
    pub min_size: f32,
}

impl DrawOptions {
    /// Sets [`DrawOptions::min_size`], in radians.
    #[must_use]
    pub const fn min_size(mut self, radians: f32) -> Self {
        self.min_size = radians;
        self
    }
}

impl Pvs {
    /// Lists the visible objects, nearest first, with distance and projected size; at equal
    /// distances by id. Far to near, as blending needs it, is the list from its end.
    ///
    /// All is measured from the eye of the view that this set was found for, to where objects are
    /// now. Those removed since are left out. `out` is emptied first; its memory is used again.
    ///
    /// Costs the visible objects, and sorting them.
    ///
    /// ```
    /// use casca::{Aabb, DrawOptions, ObjectDesc, Query, Scene, View};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// # let mut scene = Scene::new(1.0)?;
    /// # let cube = Aabb::new(Vec3::splat(8.0), Vec3::splat(9.0));
    /// # let id = scene.insert(ObjectDesc::fixed(cube))?;
    /// # let mut query = Query::new();
    /// # let view = View::omnidirectional(Vec3::new(2.0, 8.5, 8.5))?;
    /// let mut items = Vec::new();
    /// // Two pixels: smaller objects are not drawn, though they can be seen.
    /// let options = DrawOptions::default().min_size(2.0 / 1080.0);
    /// query.run(&scene, &view).draw_list(&scene, &options, &mut items)?;
    /// assert_eq!((items[0].id, items[0].distance), (id, 6.0));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses a scene other than the one that was queried, and a least size that is negative or
    /// not finite. `out` is then left as it was.
    pub fn draw_list(
        &self,
        scene: &Scene,
        options: &DrawOptions,
        out: &mut Vec<DrawItem>,
    ) -> Result<(), Error> {
        not_negative("the least size", f64::from(options.min_size))?;
        if self.scene != scene.tag() {
            return Err(Error::ForeignPvs);
        }
        out.clear();
        let Some(view) = &self.view else { return Ok(()) };
        for &id in &self.visible {
            let Ok(object) = scene.find(id) else { continue };
            let (distance, size) = measure(scene, id.slot(), view);
            let item = DrawItem { id, distance: distance as f32, size: size as f32, fraction: 1.0 };
            let known = !scene.is_unlocated(id.slot()) && object.unreported_volume().is_none();
            if !(known && item.size < options.min_size) {
                out.push(item);
            }
        }
        out.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.id.cmp(&b.id)));
        Ok(())
    }
}

/// Distance and size of an object as it is seen.
fn measure(scene: &Scene, slot: Slot, view: &View) -> (f64, f64) {
    let object = scene.object(slot);
    if scene.is_unlocated(slot) {
        return match view.origin {
            Origin::Eye { .. } => (0.0, TAU),
            Origin::Direction(_) => (f64::NEG_INFINITY, f64::INFINITY),
        };
    }
    if let Some(volume) = object.unreported_volume() {
        return finish(|at| volume.distance_from(at), |d| volume.distance_along(d), volume.ball(), view);
    }
    let bounds = object.bounds().kind();
    finish(|at| bounds.distance_from(at), |d| bounds.distance_along(d), bounds.ball(), view)
}

/// The distance of a shape, from an eye or along a direction, and the size of the ball around it.
fn finish(
    from: impl Fn(DVec3) -> f64,
    along: impl Fn(DVec3) -> f64,
    (center, radius): (DVec3, f64),
    view: &View,
) -> (f64, f64) {
    match view.origin {
        Origin::Eye { at, error } => {
            // The eye may be anywhere within a cube, and go from there: as near as that allows.
            let unsure = error * 3f64.sqrt() + view.reach();
            let way = (center - at).length() - unsure;
            // NaN is inside.
            let size = if way > radius { 2.0 * (radius / way).asin() } else { TAU };
            ((from(at) - unsure).max(0.0), size)
        }
        // Adding 0 makes -0 the same distance as 0.
        Origin::Direction(d) => (along(d) + 0.0, 2.0 * radius),
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, TAU};

    use glam::camera::rh::{proj::directx, view::look_to_mat4};
    use glam::{Quat, Vec3};

    use super::*;
    use crate::geometry::Plane;
    use crate::geometry::{Aabb, Obb, Sphere};
    use crate::object::ObjectDesc;
    use crate::query::Query;

    fn scene() -> Scene {
        Scene::new(1.0).unwrap()
    }

    fn list(scene: &Scene, view: &View, least: f32) -> Vec<DrawItem> {
        let mut out = Vec::new();
        Query::new().run(scene, view).draw_list(scene, &DrawOptions { min_size: least }, &mut out).unwrap();
        out
    }

    #[test]
    fn distances_and_sizes_are_those_of_the_bounds() {
        let mut scene = scene();
        let ball = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(0.0, 0.0, -10.0), 5.0))).unwrap();
        let cube = Aabb::new(Vec3::new(3.0, 4.0, -1.0), Vec3::new(5.0, 6.0, 1.0));
        let cube = scene.insert(ObjectDesc::fixed(cube)).unwrap();
        let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
        let obb = Obb::new(Vec3::new(-10.0, 0.0, 0.0), Vec3::splat(2f32.sqrt()), turn);
        let obb = scene.insert(ObjectDesc::fixed(obb)).unwrap();
        let room = Aabb::new(Vec3::splat(-30.0), Vec3::splat(30.0));
        let room = scene.insert(ObjectDesc::fixed(room)).unwrap();
        let items = list(&scene, &View::omnidirectional(Vec3::ZERO).unwrap(), 0.0);
        let ids: Vec<_> = items.iter().map(|i| i.id).collect();
        // The ball and the cube are 5 away.
        assert_eq!(ids, [room, ball, cube, obb]);
        let expected = [
            (0.0, TAU),
            (5.0, 2.0 * 0.5f32.asin()),
            (5.0, 2.0 * (3f32.sqrt() / 41f32.sqrt()).asin()),
            // Its edge points at the eye.
            (8.0, 2.0 * (6f32.sqrt() / 10.0).asin()),
        ];
        for (item, (distance, size)) in items.iter().zip(expected) {
            assert!((item.distance - distance).abs() < 1e-4, "{item:?} {distance}");
            assert!((item.size - size).abs() < 1e-5, "{item:?} {size}");
        }
    }

    #[test]
    fn parallel_rays_measure_along_themselves() {
        let mut scene = scene();
        let at = |z: f32| Aabb::from_center(Vec3::new(0.0, 0.0, z), Vec3::ONE);
        let (far, near) = (
            scene.insert(ObjectDesc::fixed(at(-8.0))).unwrap(),
            scene.insert(ObjectDesc::fixed(at(6.0))).unwrap(),
        );
        let look = look_to_mat4(Vec3::new(0.0, 0.0, 20.0), Vec3::NEG_Z, Vec3::Y);
        let matrix = directx::orthographic(-8.0, 8.0, -8.0, 8.0, 0.1, 100.0) * look;
        let items = list(&scene, &View::orthographic(Vec3::NEG_Z, matrix).unwrap(), 0.0);
        assert_eq!(items.iter().map(|i| (i.id, i.distance)).collect::<Vec<_>>(), [(near, -7.0), (far, 7.0)]);
        assert!(items.iter().all(|i| (i.size - 12f32.sqrt()).abs() < 1e-6));
    }

    #[test]
    fn small_objects_are_left_out_only_when_asked() {
        let mut scene = scene();
        let ids: Vec<_> = (1..20)
            .map(|i| scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::X * i as f32 * 1.5, 0.1))).unwrap())
            .collect();
        let view = View::omnidirectional(Vec3::ZERO).unwrap();
        assert_eq!(list(&scene, &view, 0.0).iter().map(|i| i.id).collect::<Vec<_>>(), ids);
        // The ball at 15 looks about 0.2 / 15 = 0.01333 wide.
        assert_eq!(list(&scene, &view, 0.0133).iter().map(|i| i.id).collect::<Vec<_>>(), ids[..10]);
        assert_eq!(list(&scene, &view, 0.0134).iter().map(|i| i.id).collect::<Vec<_>>(), ids[..9]);
        assert!(list(&scene, &view, f32::MAX).is_empty());
    }

    #[test]
    fn unreported_objects_are_as_near_as_they_may_be() {
        let mut scene = scene();
        let ball = Sphere::new(Vec3::new(20.0, 0.0, 0.0), 0.01);
        let desc = ObjectDesc::dynamic(ball).max_speed(4.0).reported_on_expiry();
        let id = scene.insert(desc).unwrap();
        let away = Plane { normal: Vec3::NEG_X, offset: -1.0 };
        let away = View::from_planes(Vec3::NEG_X * 2.0, &[away]).unwrap();
        let mut query = Query::new();
        scene.begin_frame(0.0).unwrap();
        query.run(&scene, &away);
        scene.end_frame([query.pvs()]).unwrap();
        let (lo, hi) = scene.tbv(id).unwrap().expect("nobody saw it");
        let view = View::omnidirectional(Vec3::ZERO).unwrap();
        // Whatever its size, it is not left out.
        let item = list(&scene, &view, f32::MAX)[0];
        assert_eq!((item.id, item.distance), (id, lo.x as f32));
        let (radius, middle) = ((hi - lo).length() * 0.5, ((hi + lo) * 0.5).length());
        assert!((f64::from(item.size) - 2.0 * (radius / middle).asin()).abs() < 1e-6);
        assert_eq!(scene.begin_frame(1e6).unwrap(), [id]);
        let item = list(&scene, &view, f32::MAX)[0];
        assert_eq!((item.distance, item.size), (0.0, TAU));
    }

    #[test]
    fn levels_count_the_thresholds_above() {
        let mut scene = scene();
        scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::X * 2f32.sqrt(), 1.0))).unwrap();
        let item = list(&scene, &View::omnidirectional(Vec3::ZERO).unwrap(), 0.0)[0];
        assert!((item.size - FRAC_PI_2).abs() < 1e-6);
        for (thresholds, level) in [
            (&[][..], 0),
            (&[1.5, 1.0], 0),
            (&[1.6, 1.0], 1),
            (&[3.0, 2.0, f32::NAN, 1.0], 2),
            (&[f32::INFINITY, 4.0, 1.6], 3),
        ] {
            assert_eq!(item.level(thresholds), level, "{thresholds:?}");
        }
    }

    #[test]
    fn refuses_other_scenes_and_sizes_out_of_range() {
        let mut scene = scene();
        let id = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::X * 4.0, 1.0))).unwrap();
        let huge = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::ZERO, 3e38))).unwrap();
        let far = Aabb::new(Vec3::splat(3e38), Vec3::splat(f32::MAX));
        let far = scene.insert(ObjectDesc::fixed(far)).unwrap();
        let mut query = Query::new();
        let mut out = list(&scene, &View::omnidirectional(Vec3::ZERO).unwrap(), 0.0);
        assert_eq!(out.iter().map(|i| i.id).collect::<Vec<_>>(), [huge, id, far]);
        assert_eq!((out[0].distance, out[2].distance), (0.0, f32::INFINITY));
        assert!(out.iter().all(|i| i.size > 0.0 && i.size <= TAU));
        let before = out.clone();
        assert_eq!(query.pvs().draw_list(&scene, &DrawOptions::default(), &mut out), Err(Error::ForeignPvs));
        query.run(&scene, &View::omnidirectional(Vec3::ZERO).unwrap());
        for min_size in [-1.0, f32::NAN, f32::INFINITY] {
            assert!(query.pvs().draw_list(&scene, &DrawOptions { min_size }, &mut out).is_err());
        }
        let other = super::tests::scene();
        assert_eq!(query.pvs().draw_list(&other, &DrawOptions::default(), &mut out), Err(Error::ForeignPvs));
        assert_eq!(out, before);
        scene.remove(id).unwrap();
        query.pvs().draw_list(&scene, &DrawOptions::default(), &mut out).unwrap();
        assert_eq!(out.iter().map(|i| i.id).collect::<Vec<_>>(), [huge, far]);
    }
}
