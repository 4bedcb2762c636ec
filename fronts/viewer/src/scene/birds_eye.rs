//! A culled frame seen from above: all objects, and in the colour of each whether it is drawn,
//! culled or outside the frustum.

use std::f64::consts::FRAC_PI_2;

use casca_scenes::world::Camera;
use casca_stage::report::Entry;
use glam::{DVec3, Vec3};

use crate::scene::camera_fit::{Solid, fitted};
use crate::scene::draw::coloured;
use crate::scene::geometry::DrawList;
use crate::scene::legend::{COUNTED, Role, join, of_marks, of_roles};
use crate::scene::overlays::Overlays;
use crate::scene::playback::Frame;
use crate::scene::renderer::Marks;

/// How far down the camera looks, in radians: steep enough to see into streets and rooms.
const PITCH: f64 = 0.62 * FRAC_PI_2;
/// Vertical angle of view, in degrees: that of the camera which is flown.
pub const FOV_Y: f32 = 60.0;
/// It is narrower for the whole scene, so that walls lean less.
const FOV_Y_WHOLE: f32 = 32.0;

/// What is drawn of a frame: objects, marks over them, and the meanings of their colours. `lost` are
/// the objects that a check found missing. From above all objects have the colours of their roles, and
/// the legend counts those in the picture of `watcher`; else those that are visible have their own.
pub fn drawn(
    frame: &Frame<'_>,
    overlays: &mut Overlays,
    (watcher, is_above): (&Camera, bool),
    lost: &[usize],
) -> Result<(DrawList, Marks, Vec<Entry>), casca::Error> {
    let marks = overlays.marks(frame, lost)?;
    if !is_above {
        let list = coloured(frame.geometry, frame.objects, &frame.visible);
        let legend = of_marks(&marks);
        return Ok((list, marks, legend));
    }
    let mut roles = vec![Role::Outside; frame.objects.len()];
    overlays.culled(frame)?.into_iter().for_each(|i| roles[i] = Role::Culled);
    lost.iter().for_each(|&i| roles[i] = Role::Lost);
    frame.visible.iter().for_each(|&i| roles[i] = Role::Drawn);
    // Counted before grounds and ceilings are set apart, so that the numbers are those of culling.
    let in_picture = overlays.in_frustum(frame.scene, watcher)?;
    let counts = COUNTED.map(|(role, ..)| in_picture.iter().filter(|&&i| roles[i] == role).count());
    let extent = (frame.level.1 - frame.level.0).as_vec3();
    for (role, object) in roles.iter_mut().zip(frame.objects) {
        *role = Role::of(object, *role, frame.camera.eye, extent);
    }
    let shown = (0..roles.len()).filter(|&i| roles[i] != Role::Ceiling);
    let list = frame.geometry.list(frame.objects, shown, &|i| roles[i].colour());
    let mut legend = of_roles(counts);
    join(&mut legend, of_marks(&marks));
    Ok((list, marks, legend))
}

/// A direction, steeply down.
fn down(level: DVec3) -> DVec3 {
    level * PITCH.cos() - DVec3::Y * PITCH.sin()
}

/// A camera above and behind another one, as near as it can be with that one and its frustum, as
/// far as it lies in the box of the scene, in its picture.
pub fn above_frustum(camera: &Camera, (min, max): (DVec3, DVec3), aspect: f32) -> Camera {
    let mut points: Vec<DVec3> = Solid::seen(camera, min, max).corners().collect();
    if points.is_empty() {
        points = Solid::cuboid(min, max).corners().collect();
    }
    points.push(camera.eye.as_dvec3());
    let forward = -camera.view.row(2).truncate().as_dvec3();
    let level = DVec3::new(forward.x, 0.0, forward.z).normalize_or(DVec3::NEG_Z);
    // The lines of help cover the bottom.
    fitted(&points, down(level), (FOV_Y, aspect), [0.06, 0.16], (max - min).length())
}

/// A camera that has the whole scene in its picture, with room for a title and a legend.
pub fn above_scene((min, max): (DVec3, DVec3), aspect: f32) -> Camera {
    let points: Vec<DVec3> = Solid::cuboid(min, max).corners().collect();
    fitted(&points, down(DVec3::NEG_Z), (FOV_Y_WHOLE, aspect), [0.02, 0.08], (max - min).length())
}

/// Where a point is in the picture of a camera, in shares of it from its left upper corner. Points
/// behind the camera are outside.
pub fn place_in(watcher: &Camera, point: Vec3) -> [f32; 2] {
    let clip = watcher.view_projection() * point.extend(1.0);
    if clip.w <= 0.0 {
        return [-1.0; 2];
    }
    [0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w]
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: (DVec3, DVec3) = (DVec3::ZERO, DVec3::new(100.0, 20.0, 60.0));

    fn assert_inside(camera: &Camera, points: impl IntoIterator<Item = DVec3>) {
        for p in points {
            let c = camera.view_projection().as_dmat4().project_point3(p);
            assert!(c.x.abs() < 1.0 && c.y.abs() < 1.0 && c.z > 0.0 && c.z < 1.0, "{p} is at {c}");
        }
    }

    #[test]
    fn the_frozen_camera_its_frustum_and_the_whole_scene_are_in_their_pictures() {
        for (eye, target) in [
            (Vec3::new(50.0, 2.0, 30.0), Vec3::new(60.0, 2.0, 20.0)),
            (Vec3::new(50.0, 2.0, 30.0), Vec3::new(50.0, -9.0, 30.0)),
            // Outside the scene: looking at it, and away from it.
            (Vec3::new(-300.0, 90.0, 30.0), Vec3::new(60.0, 2.0, 20.0)),
            (Vec3::new(-300.0, 90.0, 30.0), Vec3::new(-400.0, 90.0, 20.0)),
        ] {
            let camera = Camera::look_at(eye, target, 70.0, 1.5, 0.1, 900.0);
            let above = above_frustum(&camera, BOUNDS, 1.8);
            assert_inside(&above, Solid::seen(&camera, BOUNDS.0, BOUNDS.1).corners());
            assert_inside(&above, [eye.as_dvec3()]);
            assert!(above.eye.y > eye.y, "it is above");
        }
        for aspect in [0.4, 1.6, 3.0] {
            assert_inside(&above_scene(BOUNDS, aspect), Solid::cuboid(BOUNDS.0, BOUNDS.1).corners());
        }
    }
}
