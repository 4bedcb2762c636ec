//! Draws furry meshes as shells, their skins, blocks, and the sun's shadow map: into pictures, or
//! into a render pass of the application's own, on its own device, with multisampling.
//!
//! The application makes its device and wraps it once: [`Gpu::new`]. Each frame calls
//! [`Renderer::prepare`] before its pass, then [`Renderer::draw_in`] within it.

use std::ops::Range;

use crate::Error;
use crate::mesh::Mesh;
use crate::skin::Weights;
use casca_stage::canvas::Target;
use casca_stage::gpu::{DEPTH, Gpu, GpuError};
use casca_stage::wgpu::{self, BufferUsages, TextureFormat};
use casca_tools::camera::Camera;

use crate::gpu::bindings::{depth_map, group, layouts, strand_map};
use crate::gpu::buffers::{Buffers, Growing};
use crate::gpu::error::FurGpuError;
use crate::gpu::look::{Look, SKY};
use crate::gpu::pipelines::{Pipelines, shaders};
use crate::gpu::records::{DrawList, Frame, SHADOW_SIZE, Sun};

/// Pipelines and buffers for some meshes and one format of pictures.
pub struct Renderer {
    format: TextureFormat,
    /// For pictures, and for the shadow map.
    pipelines: [Drawing; 2],
    layouts: [wgpu::BindGroupLayout; 2],
    samples: u32,
    walked: bool,
    frame: wgpu::Buffer,
    look: wgpu::Buffer,
    strands: wgpu::Texture,
    shadow: wgpu::TextureView,
    /// One of these reads the shadow map, the other draws it.
    frame_groups: [wgpu::BindGroup; 2],
    look_group: wgpu::BindGroup,
    meshes: Vec<Buffers>,
    records: Growing,
    joints: Growing,
    instances: Growing,
    block_records: Growing,
    /// What was uploaded last: the shells of each mesh, and the number of blocks.
    runs: Vec<(usize, [Range<u32>; 2])>,
    walls: u32,
    /// The share of the sky's colour that the air adds, for each unit of the way.
    pub haze: f32,
}

impl Renderer {
    /// A renderer for these meshes, with one look for all of them, and pictures of this format.
    ///
    /// # Errors
    /// A mesh does not fit into the memory of the device.
    pub fn new(gpu: &Gpu, format: TextureFormat, meshes: &[Mesh], look: &Look) -> Result<Self, FurGpuError> {
        Self::with_samples(gpu, format, 1, meshes, look)
    }

    /// A renderer for passes that the application begins.
    ///
    /// - **Colour**: one attachment of the given format, which must not convert colours: the
    ///   shaders write values for screens (a gamma of 2.2). No blending; alpha is 1.
    /// - **Depth**: one attachment of [`DEPTH`], *reversed*: 1 is near and 0 far, cleared to 0, the
    ///   greater value wins. The matrices of the [`Camera`] are *not* reversed (depth 0 to 1, as
    ///   those of casca); the shaders turn their depth around.
    /// - **Multisampling** smooths outlines of skins and walls. A fragment shades once for each
    ///   pixel, and a strand takes all its samples or none, so that strands are no smoother than
    ///   without.
    /// - **Temporal antialiasing** smooths strands, too: put its jitter into the camera's
    ///   projection. Hashed alpha hides strands thinner than a pixel by their place on the skin,
    ///   not by the frame, so that still pictures stay still.
    ///
    /// # Errors
    /// Refuses formats that convert colours (sRGB) and numbers of samples that the adapter does not
    /// have for this format; a mesh does not fit into the memory of the device.
    pub fn for_pass(
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
        Self::with_samples(gpu, format, samples, meshes, look)
    }

    fn with_samples(
        gpu: &Gpu,
        format: TextureFormat,
        samples: u32,
        meshes: &[Mesh],
        look: &Look,
    ) -> Result<Self, FurGpuError> {
        let device = &gpu.device;
        let layouts = layouts(device);
        let frame = gpu.buffer(size_of::<Frame>() as u64, BufferUsages::UNIFORM)?;
        let records = Growing::new(gpu, BufferUsages::STORAGE)?;
        let joints = Growing::new(gpu, BufferUsages::STORAGE)?;
        let shadow = depth_map(device, SHADOW_SIZE);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let frame_groups = [&shadow, &depth_map(device, 1)].map(|map| {
            let map = wgpu::BindingResource::TextureView(map);
            let sampler = wgpu::BindingResource::Sampler(&sampler);
            group(device, &layouts[0], [frame.as_entire_binding(), map, sampler])
        });
        let look_buffer = gpu.buffer(size_of_val(&look.words()) as u64, BufferUsages::UNIFORM)?;
        let strands = strand_map(device);
        let look_group =
            look_group(device, &layouts[1], [&look_buffer, &records.buffer, &joints.buffer], &strands);
        let mut renderer = Self {
            pipelines: pipelines(device, &layouts, format, samples, look.walked),
            format,
            samples,
            walked: look.walked,
            strands,
            layouts,
            frame,
            look: look_buffer,
            shadow,
            frame_groups,
            look_group,
            meshes: meshes.iter().map(|mesh| Buffers::new(gpu, mesh)).collect::<Result<_, _>>()?,
            records,
            joints,
            instances: Growing::new(gpu, BufferUsages::VERTEX)?,
            block_records: Growing::new(gpu, BufferUsages::VERTEX)?,
            runs: Vec::new(),
            walls: 0,
            haze: 0.0,
        };
        renderer.set_look(gpu, look);
        Ok(renderer)
    }

    /// The format of its pictures.
    pub fn format(&self) -> TextureFormat {
        self.format
    }

    /// Changes the look of all meshes.
    pub fn set_look(&mut self, gpu: &Gpu, look: &Look) {
        if look.walked != self.walked {
            self.walked = look.walked;
            self.pipelines = pipelines(&gpu.device, &self.layouts, self.format, self.samples, look.walked);
        }
        let size = self.strands.size();
        gpu.queue.write_texture(
            self.strands.as_image_copy(),
            bytemuck::cast_slice(&look.fur.table()),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * size.width),
                rows_per_image: Some(size.height),
            },
            size,
        );
        gpu.queue.write_buffer(&self.look, 0, bytemuck::bytes_of(&look.words()));
    }

    /// Lets a mesh, by its number, be posed ([`DrawList::pose`]).
    ///
    /// # Errors
    /// There is no such mesh, it has another number of vertices, or the weights do not fit into the
    /// memory of the device.
    pub fn set_weights(&mut self, gpu: &Gpu, mesh: usize, weights: &Weights) -> Result<(), FurGpuError> {
        let most = self.meshes.len() as f64 - 1.0;
        let refused = Error::Range { what: "the number of a mesh", value: mesh as f64, least: 0.0, most };
        self.meshes.get_mut(mesh).ok_or(refused)?.set_weights(gpu, weights)
    }

    /// Draws the shadow map of a list. It holds until the next call: while neither the sun nor
    /// anything in its light moves, one is enough for all frames.
    ///
    /// # Errors
    /// The list does not fit into the memory of the device.
    pub fn cast_shadows(&mut self, gpu: &Gpu, list: &DrawList, sun: &Sun) -> Result<(), GpuError> {
        // The eye does not matter here.
        let eye = Camera::look_at(sun.center, sun.center + sun.direction(), 60.0, 1.0, 0.1, 1.0);
        self.draw_pass(gpu, list, &Frame::new(&eye, SHADOW_SIZE, sun, (SKY, 0.0)), None)
    }

    /// Draws a picture, with the shadows of the last [`Renderer::cast_shadows`].
    ///
    /// # Errors
    /// The list does not fit into the memory of the device.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        target: &Target,
        camera: &Camera,
        list: &DrawList,
        sun: &Sun,
    ) -> Result<(), GpuError> {
        let frame = Frame::new(camera, target.size().1, sun, (SKY, self.haze));
        self.draw_pass(gpu, list, &frame, Some(target))
    }

    /// Uploads what the next [`Renderer::draw_in`] draws, into pictures so many pixels high. It
    /// holds until the next call, of [`Renderer::draw`] and [`Renderer::cast_shadows`], too; submit
    /// a pass before the next one is prepared.
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
        self.upload(gpu, list, &Frame::new(camera, height, sun, (SKY, self.haze)))
    }

    /// Draws the list of the last [`Renderer::prepare`]; nothing before the first. Sets pipelines,
    /// its two bind groups, and vertex and index buffers of the pass.
    pub fn draw_in(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.record(pass, false);
    }

    /// Draws a picture, or the shadow map if there is no target.
    fn draw_pass(
        &mut self,
        gpu: &Gpu,
        list: &DrawList,
        frame: &Frame,
        target: Option<&Target>,
    ) -> Result<(), GpuError> {
        self.upload(gpu, list, frame)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let sky = SKY.map(|c| f64::from(c.powf(1.0 / 2.2)));
        let colour = target.map(|target| wgpu::RenderPassColorAttachment {
            view: &target.colour,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color { r: sky[0], g: sky[1], b: sky[2], a: 1.0 }),
                store: wgpu::StoreOp::Store,
            },
        });
        let (depth, clear) = target.map_or((&self.shadow, 1.0), |target| (&target.depth, 0.0));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: if target.is_some() { std::slice::from_ref(&colour) } else { &[] },
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(clear),
                    store: if target.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        self.record(&mut pass, target.is_none());
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// Writes the buffers that the next [`Renderer::record`] reads.
    fn upload(&mut self, gpu: &Gpu, list: &DrawList, frame: &Frame) -> Result<(), GpuError> {
        // Nothing is drawn of a list that was refused.
        (self.runs, self.walls) = (Vec::new(), 0);
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        let moved = self.records.write(gpu, bytemuck::cast_slice(&list.records))?;
        if self.joints.write(gpu, bytemuck::cast_slice(&list.joints))? || moved {
            let buffers = [&self.look, &self.records.buffer, &self.joints.buffer];
            self.look_group = look_group(&gpu.device, &self.layouts[1], buffers, &self.strands);
        }
        self.instances.write(gpu, bytemuck::cast_slice(&list.shells))?;
        self.block_records.write(gpu, bytemuck::cast_slice(&list.blocks))?;
        (self.runs, self.walls) = (list.runs.clone(), list.blocks.len() as u32);
        Ok(())
    }

    /// Draws the uploaded list into a pass for pictures or for the shadow map.
    fn record(&self, pass: &mut wgpu::RenderPass<'_>, shadows: bool) {
        pass.set_bind_group(0, &self.frame_groups[usize::from(shadows)], &[]);
        pass.set_bind_group(1, &self.look_group, &[]);
        let Drawing { blocks, meshes } = &self.pipelines[usize::from(shadows)];
        if self.walls > 0 {
            pass.set_pipeline(blocks);
            pass.set_vertex_buffer(0, self.block_records.buffer.slice(..));
            pass.draw(0..36, 0..self.walls);
        }
        pass.set_vertex_buffer(0, self.instances.buffer.slice(..));
        // Skins are drawn first, since they hide the shells behind them.
        for (part, pipelines) in meshes.iter().enumerate() {
            for (mesh, runs) in &self.runs {
                let Some(mesh) = self.meshes.get(*mesh).filter(|mesh| mesh.count > 0) else { continue };
                pass.set_pipeline(&pipelines[usize::from(mesh.followers.is_some())]);
                if let Some(followers) = &mesh.followers {
                    pass.set_vertex_buffer(2, followers.slice(..));
                }
                pass.set_vertex_buffer(1, mesh.corners.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.count, 0, runs[part].clone());
            }
        }
    }
}

/// The pipelines of a pass: skins and shells, without weights and with.
struct Drawing {
    meshes: [[wgpu::RenderPipeline; 2]; 2],
    blocks: wgpu::RenderPipeline,
}

/// Those for pictures, and those for the shadow map, whose shaders give no colours.
fn pipelines(
    device: &wgpu::Device,
    layouts: &[wgpu::BindGroupLayout; 2],
    format: TextureFormat,
    samples: u32,
    walked: bool,
) -> [Drawing; 2] {
    let made = Pipelines {
        device,
        shaders: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("fur"),
            source: wgpu::ShaderSource::Wgsl(shaders(walked).into()),
        }),
        samples,
        layout: &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts.each_ref().map(Some),
            immediate_size: 0,
        }),
    };
    [Some(format), None].map(|format| Drawing {
        meshes: [true, false].map(|skin| [false, true].map(|posed| made.mesh(posed, skin, format))),
        blocks: made.blocks(format),
    })
}

fn look_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffers: [&wgpu::Buffer; 3],
    strands: &wgpu::Texture,
) -> wgpu::BindGroup {
    let table = strands.create_view(&Default::default());
    let buffers = buffers.map(|buffer| buffer.as_entire_binding());
    group(device, layout, buffers.into_iter().chain([wgpu::BindingResource::TextureView(&table)]))
}
