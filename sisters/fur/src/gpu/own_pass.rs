//! Fur in a render pass of the application's own, on its own device, with multisampling.
//!
//! The application makes its device and wraps it once: [`Gpu::new`]. Each frame calls
//! [`OwnPass::prepare`] before the pass, then [`OwnPass::draw`] within it.

use std::ops::Range;

use casca_stage::gpu::{DEPTH, Gpu, GpuError};
use casca_stage::wgpu::{self, TextureFormat};
use casca_tools::camera::Camera;

use crate::gpu::error::FurGpuError;
use crate::gpu::look::{Look, SKY};
use crate::gpu::records::{DrawList, Frame, Sun};
use crate::gpu::renderer::Renderer;
use crate::mesh::{Image, Mesh};
use crate::skin::Weights;

/// Draws fur into passes that others begin.
///
/// - **Colour**: one attachment of the given format, which must not convert colours: the shaders
///   write values for screens (a gamma of 2.2). No blending; alpha is 1.
/// - **Depth**: one attachment of [`DEPTH`], *reversed*: 1 is near and 0 far, cleared to 0, the
///   greater value wins. The matrices of the [`Camera`] are *not* reversed (depth 0 to 1, as those
///   of casca); the shaders turn their depth around.
/// - **Multisampling** smooths outlines of skins and walls. A fragment shades once for each pixel,
///   and a strand takes all its samples or none, so that strands are no smoother than without.
/// - **Temporal antialiasing** smooths strands, too: put its jitter into the camera's projection.
///   Hashed alpha hides strands thinner than a pixel by their place on the skin, not by the frame,
///   so that still pictures stay still.
pub struct OwnPass {
    renderer: Renderer,
    /// The parts of the last [`OwnPass::prepare`]: the shells of each mesh, and blocks.
    runs: Vec<(usize, Range<u32>)>,
    blocks: u32,
}

impl OwnPass {
    /// For passes with one colour attachment of a format and so many samples a pixel.
    ///
    /// # Errors
    /// Refuses formats that convert colours (sRGB) and numbers of samples that the adapter does not
    /// have for this format; a mesh does not fit into the memory of the device.
    pub fn new(
        gpu: &Gpu,
        format: TextureFormat,
        samples: u32,
        meshes: &[Mesh],
        look: &Look,
    ) -> Result<Self, FurGpuError> {
        // More than 4 samples need a feature of the device that lifts WebGPU's guarantee.
        let lifted = wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
        let guaranteed = matches!(samples, 1 | 4) || gpu.device.features().contains(lifted);
        let able = [format, DEPTH].into_iter().all(|format| {
            let features = gpu.adapter.get_texture_format_features(format);
            features.allowed_usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
                && features.flags.sample_count_supported(samples)
        });
        let stores_colour = format.has_color_aspect() && !format.is_srgb();
        if !(guaranteed && able && stores_colour) {
            return Err(FurGpuError::Pass { format, samples });
        }
        let renderer = Renderer::with_samples(gpu, format, samples, meshes, look)?;
        Ok(Self { renderer, runs: Vec::new(), blocks: 0 })
    }

    /// As [`Renderer::set_look`].
    pub fn set_look(&self, gpu: &Gpu, look: &Look) {
        self.renderer.set_look(gpu, look);
    }

    /// As [`Renderer::set_images`].
    ///
    /// # Errors
    /// There is no such mesh, or there are more than 64 images.
    pub fn set_images(&mut self, gpu: &Gpu, meshes: &[usize], images: &[Image]) -> Result<(), FurGpuError> {
        self.renderer.set_images(gpu, meshes, images)
    }

    /// As [`Renderer::set_weights`]: lets a mesh be posed, so that animals walk in this pass.
    ///
    /// # Errors
    /// There is no such mesh, it has another number of vertices, or the weights do not fit into
    /// the memory of the device.
    pub fn set_weights(&mut self, gpu: &Gpu, mesh: usize, weights: &Weights) -> Result<(), FurGpuError> {
        self.renderer.set_weights(gpu, mesh, weights)
    }

    /// As [`Renderer::cast_shadows`], in a pass of its own: call it before [`OwnPass::prepare`].
    ///
    /// # Errors
    /// The list does not fit into the memory of the device.
    pub fn cast_shadows(&mut self, gpu: &Gpu, list: &DrawList, sun: &Sun) -> Result<(), GpuError> {
        self.renderer.cast_shadows(gpu, list, sun)
    }

    /// Uploads what the next [`OwnPass::draw`] draws, into pictures so many pixels high. It holds
    /// until the next call; submit a pass before the next one is prepared.
    ///
    /// # Errors
    /// The list does not fit into the memory of the device.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        camera: &Camera,
        height: u32,
        list: &DrawList,
        sun: &Sun,
    ) -> Result<(), GpuError> {
        self.runs.clear();
        self.blocks = 0;
        self.renderer.upload(gpu, list, &Frame::new(camera, height, sun, (SKY, self.renderer.haze)))?;
        self.runs.clone_from(&list.runs);
        self.blocks = list.blocks.len() as u32;
        Ok(())
    }

    /// Draws the list of the last [`OwnPass::prepare`]; nothing before the first. Sets pipelines,
    /// its three bind groups, and vertex and index buffers of the pass.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.renderer.record(pass, (&self.runs, self.blocks), false);
    }
}
