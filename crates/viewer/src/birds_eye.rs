//! A culled frame seen from above: all objects, and in the colour of each whether it is drawn, culled or outside the frustum.

use std::f64::consts::FRAC_PI_2;

use casca_scenes::world::{Camera, Object, Shape};
use casca_stage::panel::Entry;
use casca_stage::pictures::palette::{self, rgba};
use glam::DVec3;

use crate::camera_fit::{Margins, Solid, fitted};
use crate::geometry::DrawList;
use crate::legend::of_roles;
use crate::overlays::{LOST, Overlays};
use crate::playback::Frame;

/// How far down the camera looks, in radians: steep enough to see into streets and rooms.
const PITCH: f64 = 0.62 * FRAC_PI_2;
/// Vertical angle of view, in degrees: that of the camera which is flown.
pub const FOV_Y: f32 = 60.0;
/// It is narrower for the whole scene, so that walls lean less.
const FOV_Y_WHOLE: f32 = 32.0;

/// Whether an object is drawn, or the reason why it is not; grounds and ceilings are set apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Found visible and drawn.
    Drawn,
    /// Visible, but not drawn. Only methods that promise nothing lose objects.
    Lost,
    /// In the frustum, found hidden and left out.
    Culled,
    /// Outside the frustum.
    Outside,
    /// The ground under everything, which has a quiet colour.
    Ground,
    /// A ceiling, taken off so that one sees in.
    Ceiling,
}

impl Role {
    /// The roles that culling gives.
    const COUNTED: [Self; 4] = [Self::Drawn, Self::Lost, Self::Culled, Self::Outside];

    /// The colour of objects in this role.
    pub fn colour(self) -> [u8; 4] {
        match self {
            Self::Drawn => rgba(palette::DRAWN, 255),
            Self::Lost => LOST,
            Self::Culled => rgba(palette::CULLED, 255),
            Self::Outside => rgba(palette::OUTSIDE, 255),
            Self::Ground | Self::Ceiling => rgba(palette::GROUND, 255),
        }
    }

    /// Its name in a legend; grounds need none.
    pub fn meaning(self) -> Option<&'static str> {
        match self {
            Self::Drawn => Some("visible, drawn"),
            Self::Lost => Some("visible, lost"),
            Self::Culled => Some("hidden, culled"),
            Self::Outside => Some("outside the frustum"),
            Self::Ground | Self::Ceiling => None,
        }
    }

    /// Wide flat boxes are grounds or ceilings, the others keep the role that culling gave them.
    fn of(object: &Object, given: Self, eye: glam::Vec3, extent: glam::Vec3) -> Self {
        match object.shape {
            Shape::Box { min, max } if (max - min).cmpgt(0.5 * extent).bitmask() & 0b101 == 0b101 => {
                if max.y <= eye.y {
                    Self::Ground
                } else if min.y >= eye.y {
                    Self::Ceiling
                } else {
                    given
                }
            }
            _ => given,
        }
    }
}

/// A frame from above.
pub struct FromAbove {
    /// The objects, to draw.
    pub list: DrawList,
    /// The meanings of their colours.
    pub legend: Vec<Entry>,
}

/// All objects of a frame in the colours of their roles; `lost` are those that a check found missing. The legend counts those in the picture of `watcher`.
///
/// # Errors
/// As [`Overlays::in_frustum`].
pub fn from_above(
    frame: &Frame<'_>,
    overlays: &mut Overlays,
    (watcher, lost): (&Camera, &[usize]),
) -> Result<FromAbove, casca::Error> {
    let mut roles = vec![Role::Outside; frame.objects.len()];
    overlays.culled(frame)?.into_iter().for_each(|i| roles[i] = Role::Culled);
    lost.iter().for_each(|&i| roles[i] = Role::Lost);
    frame.visible.iter().for_each(|&i| roles[i] = Role::Drawn);
    // Counted before grounds and ceilings are set apart, so that the numbers are those of culling.
    let in_picture = overlays.in_frustum(frame.scene, watcher)?;
    let counts = Role::COUNTED.map(|role| (role, in_picture.iter().filter(|&&i| roles[i] == role).count()));
    let grid = frame.scene.grid();
    let extent = (grid.max() - grid.min()).as_vec3();
    for (role, object) in roles.iter_mut().zip(frame.objects) {
        *role = Role::of(object, *role, frame.camera.eye, extent);
    }
    let drawn = (0..roles.len()).filter(|&i| roles[i] != Role::Ceiling);
    let list = frame.geometry.list(frame.objects, drawn, &|i| roles[i].colour());
    Ok(FromAbove { list, legend: of_roles(&counts) })
}

/// A direction, steeply down.
fn down(level: DVec3) -> DVec3 {
    level * PITCH.cos() - DVec3::Y * PITCH.sin()
}

/// A camera above and behind another one, as near as it can be with that one and its frustum, as far as it lies in the
/// box of the scene, in its picture.
pub fn above_frustum(camera: &Camera, (min, max): (DVec3, DVec3), aspect: f32) -> Camera {
    let mut points: Vec<DVec3> = Solid::seen(camera, min, max).corners().collect();
    if points.is_empty() {
        points = Solid::cuboid(min, max).corners().collect();
    }
    points.push(camera.eye.as_dvec3());
    let forward = -camera.view.row(2).truncate().as_dvec3();
    let level = DVec3::new(forward.x, 0.0, forward.z).normalize_or(DVec3::NEG_Z);
    let margins = Margins { sides: 0.06, top: 0.06, bottom: 0.06 };
    fitted(&points, down(level), (FOV_Y, aspect), margins, (max - min).length())
}

/// A camera that has the whole scene in its picture, with room for a title and a legend.
pub fn above_scene((min, max): (DVec3, DVec3), aspect: f32) -> Camera {
    let points: Vec<DVec3> = Solid::cuboid(min, max).corners().collect();
    let margins = Margins { sides: 0.02, top: 0.08, bottom: 0.075 };
    fitted(&points, down(DVec3::NEG_Z), (FOV_Y_WHOLE, aspect), margins, (max - min).length())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const BOUNDS: (DVec3, DVec3) = (DVec3::ZERO, DVec3::new(100.0, 20.0, 60.0));

    fn assert_inside(camera: &Camera, points: impl IntoIterator<Item = DVec3>) {
        for p in points {
            let c = camera.view_projection().as_dmat4().project_point3(p);
            assert!(c.x.abs() < 1.0 && c.y.abs() < 1.0 && c.z > 0.0 && c.z < 1.0, "{p} is at {c}");
        }
    }

    #[test]
    fn the_frozen_camera_and_its_frustum_are_in_the_picture() {
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
    }

    #[test]
    fn the_whole_scene_is_in_the_picture() {
        for aspect in [0.4, 1.6, 3.0] {
            assert_inside(&above_scene(BOUNDS, aspect), Solid::cuboid(BOUNDS.0, BOUNDS.1).corners());
        }
    }

    #[test]
    fn wide_flat_boxes_are_ground_below_the_eye_and_ceilings_above() {
        let role = |min: Vec3, max: Vec3| {
            let shape = Shape::Box { min, max };
            let (name, motion) = (String::new(), casca_scenes::world::Motion::Static);
            let object = Object { name, shape, motion, occludes: true, tested: true };
            Role::of(&object, Role::Drawn, Vec3::new(5.0, 2.0, 5.0), Vec3::new(10.0, 4.0, 10.0))
        };
        assert_eq!(role(Vec3::ZERO, Vec3::new(10.0, 0.2, 10.0)), Role::Ground);
        assert_eq!(role(Vec3::Y * 3.0, Vec3::new(10.0, 3.2, 10.0)), Role::Ceiling);
        assert_eq!(role(Vec3::ZERO, Vec3::new(10.0, 3.0, 0.2)), Role::Drawn, "a wall");
        assert_eq!(role(Vec3::ZERO, Vec3::splat(10.0)), Role::Drawn, "around the eye");
    }
}
