//! A view as the shaders take it, as a scene takes it, and how far the occlusion of a pixel
//! reaches.

use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3, DVec4};

use crate::gpu::numeric::LENGTH_UNITS;
use crate::numeric::GROUP;
use crate::slabs::Slices;
use crate::view::{Lens, View};

/// A view for shaders: `Lens` of view.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct GpuLens {
    right: [f32; 3],
    scale: f32,
    up: [f32; 3],
    near: f32,
    back: [f32; 3],
    far: f32,
    origin: [f32; 3],
    perspective: u32,
    rest: [f32; 3],
    slices: u32,
    middle: [f32; 2],
    size: [u32; 2],
    group: u32,
    groups: u32,
    units: f32,
    thick: f32,
}

impl GpuLens {
    /// The lens of a view. `thick` is half the thickness of lines in its pixels, or 0, as in
    /// view.wgsl.
    pub(super) fn new(view: &View, slices: Slices, thick: f32) -> Self {
        let turn = view.eye_from_world().matrix3;
        let origin = view.eye_from_world().inverse().translation;
        let [near, far] = view.depths();
        Self {
            right: turn.row(0).as_vec3().to_array(),
            scale: (1.0 / view.pixel_size(1.0)) as f32,
            up: turn.row(1).as_vec3().to_array(),
            near: near as f32,
            back: turn.row(2).as_vec3().to_array(),
            far: far as f32,
            origin: origin.as_vec3().to_array(),
            perspective: u32::from(view.is_perspective()),
            rest: (origin - origin.as_vec3().as_dvec3()).as_vec3().to_array(),
            slices: slices.count(),
            middle: view.size().map(|s| s as f32 / 2.0),
            size: view.size(),
            group: GROUP,
            groups: slices.groups() as u32,
            units: (LENGTH_UNITS / (far - near)) as f32,
            thick,
        }
    }
}

/// How far from a pixel's fragment lines can change the pixel, in units of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Lines that the pixel may show: the side of a pixel at the farthest depth. A pixel shows a
    /// line where the ray through its centre meets no wall; the line itself is up to 0.71 pixels
    /// beside that ray, maybe behind the wall's edge.
    pub drawn: f32,
    /// Lines that may darken it. The occlusion reads the columns in a ball of the radius, and of
    /// each the groups of slices in it: lines there are at most the radius, a column's diagonal and
    /// the thickness of a group away from the fragment.
    pub read: f32,
}

impl Reach {
    /// Of the pixels of `view` with the columns of `grid`, for an occlusion of a radius.
    pub fn new(view: &View, grid: &View, radius: f32, slices: Slices) -> Self {
        let [near, far] = view.depths();
        let drawn = view.pixel_size(far);
        let slope = |side: u32| f64::from(side) / 2.0 * view.pixel_size(1.0);
        let [x, y] = view.size().map(slope);
        // The way along a ray at a corner of the picture, for each unit of depth.
        let steep = if view.is_perspective() { (1.0 + x * x + y * y).sqrt() } else { 1.0 };
        let thick = (far - near) / slices.groups() as f64 * steep;
        let read = f64::from(radius) + thick + grid.pixel_size(far) * std::f64::consts::SQRT_2 + drawn;
        Self { drawn: drawn as f32, read: read as f32 }
    }
}

/// The view for queries of a scene.
///
/// # Errors
/// As [`casca::View::perspective`] and [`casca::View::orthographic`].
pub fn view_of_scene(view: &View) -> Result<casca::View, casca::Error> {
    let [near, far] = view.depths();
    let [width, height] = view.size().map(f64::from);
    let scale = 1.0 / view.pixel_size(1.0);
    let (x, y, range) = (2.0 * scale / width, 2.0 * scale / height, near - far);
    let world = view.eye_from_world();
    let matrix = |lens: DMat4| (lens * DMat4::from(world)).as_mat4();
    match view.lens() {
        Lens::Perspective { .. } => {
            let depth =
                [DVec4::new(0.0, 0.0, far / range, -1.0), DVec4::new(0.0, 0.0, near * far / range, 0.0)];
            let lens = DMat4::from_cols(DVec4::X * x, DVec4::Y * y, depth[0], depth[1]);
            casca::View::perspective(world.inverse().translation.as_vec3(), matrix(lens))
        }
        Lens::Orthographic { .. } => {
            let depth = [DVec4::new(0.0, 0.0, 1.0 / range, 0.0), DVec4::new(0.0, 0.0, near / range, 1.0)];
            let lens = DMat4::from_cols(DVec4::X * x, DVec4::Y * y, depth[0], depth[1]);
            let forward = world.matrix3.transpose() * DVec3::NEG_Z;
            casca::View::orthographic(forward.as_vec3(), matrix(lens))
        }
    }
}
