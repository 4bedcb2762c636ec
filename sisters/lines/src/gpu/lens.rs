//! A view as the shaders take it, with the part that all of them have in common, and as a scene
//! takes it. A binding has the same number in all shaders.

use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu;
use glam::{DMat4, DVec3, DVec4};

use crate::gpu::numeric::constants;
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
    thick: f32,
    middle: [f32; 2],
    size: [u32; 2],
}

impl GpuLens {
    /// The lens of a view. `thick` is half the thickness of lines in its pixels, or 0, as in
    /// view.wgsl.
    pub(super) fn new(view: &View, thick: f32) -> Self {
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
            thick,
            middle: view.size().map(|s| s as f32 / 2.0),
            size: view.size(),
        }
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

/// The part that all shaders have in common.
const COMMON: &str = include_str!("shaders/view.wgsl");

/// A shader, with the part that all have in common.
pub(super) fn shader(gpu: &Gpu, name: &str, text: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(format!("{}{COMMON}{text}", constants()).into());
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
}
