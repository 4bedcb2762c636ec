//! How cameras see a coat.

use bevy_camera::primitives::Aabb;
use bevy_camera::{Camera, Projection};
use bevy_math::{Affine3A, Vec3, Vec3A};
use bevy_transform::components::GlobalTransform;

/// A camera, by what counts for sizes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Eye {
    at: Vec3A,
    /// Pixels of a world unit: at distance 1, or everywhere if rays are parallel.
    pixels: f32,
    parallel: bool,
    /// The pixels of its picture.
    pub screen: f32,
}

impl Eye {
    /// None if the camera is not active, or has nothing to draw to.
    pub fn of(camera: &Camera, projection: &Projection, transform: &GlobalTransform) -> Option<Self> {
        let size = camera.physical_viewport_size().filter(|_| camera.is_active)?.as_vec2();
        let clip = projection.get_clip_from_view();
        Some(Self {
            at: transform.translation_vec3a(),
            pixels: 0.5 * size.y * clip.y_axis.y.abs(),
            parallel: clip.w_axis.w == 1.0,
            screen: size.x * size.y,
        })
    }

    /// Under how many pixels a world unit at a ball appears where the ball is nearest; infinite
    /// inside of it and where numbers are not finite.
    fn scale(&self, center: Vec3A, radius: f32) -> f32 {
        if self.parallel {
            return self.pixels;
        }
        let away = (self.at - center).length() - radius;
        if away > 0.0 { self.pixels / away } else { f32::INFINITY }
    }
}

/// A coat in the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ball {
    center: Vec3A,
    radius: f32,
    /// The greatest scale of its transform.
    pub scale: f32,
}

impl Ball {
    pub fn around(aabb: &Aabb, place: Affine3A) -> Self {
        let axes = [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis];
        let scale = axes.map(|axis| axis.length()).into_iter().fold(0.0, f32::max);
        let half: Vec3 = aabb.half_extents.into();
        Self { center: place.transform_point3a(aabb.center), radius: half.length() * scale, scale }
    }

    /// In the eye that sees it largest: the pixels of a world unit, and those of its diameter.
    pub fn seen_by(&self, eyes: &[Eye]) -> (f32, f32) {
        let scales = eyes.iter().map(|eye| eye.scale(self.center, self.radius));
        // Doubt counts as near.
        let scale =
            scales.fold(0.0, |most: f32, scale| if scale > most || scale.is_nan() { scale } else { most });
        let scale = if scale.is_nan() { f32::INFINITY } else { scale };
        (scale, 2.0 * self.radius * scale)
    }
}
