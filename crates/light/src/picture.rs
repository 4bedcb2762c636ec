//! The light of each pixel: a visibility buffer as G-buffer, cones from it, and the colours of a
//! screen (thesis 2.4; digest S8 and S9).

use bytemuck::{Pod, Zeroable};
use casca_stage::camera::Camera;
use casca_stage::canvas::Target;
use casca_stage::gpu::{DEPTH, Gpu, ITEMS};
use casca_stage::kernel::{Kernel, among, bind};
use casca_stage::wgpu::{
    self, BindingResource, Buffer, BufferUsages, CommandEncoder, TextureFormat, TextureUsages, TextureView,
};
use glam::{Mat4, Vec3};

use crate::device::{filled, held, shader, zeros};
use crate::error::{LightError, Part};
use crate::layers::Others;
use crate::volume::Volume;

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layer {
    /// All light.
    #[default]
    Picture,
    /// What surfaces reflect of light.
    Albedo,
    /// Normals, from -1 to 1 as 0 to 1.
    Normals,
    /// Emission, and light straight from lights.
    Direct,
    /// Light that cones gather.
    Indirect,
    /// Ambient occlusion: bright where nothing is near.
    Occlusion,
    /// Voxels with their light.
    Voxels,
}

impl Layer {
    /// All of them.
    pub const EVERY: [Self; 7] = [
        Self::Picture,
        Self::Albedo,
        Self::Normals,
        Self::Direct,
        Self::Indirect,
        Self::Occlusion,
        Self::Voxels,
    ];

    /// Its name on command lines and in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Albedo => "albedo",
            Self::Normals => "normals",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Occlusion => "occlusion",
            Self::Voxels => "voxels",
        }
    }
}

/// The camera as the shaders take it, in cells.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Eye {
    to_clip: [[f32; 4]; 4],
    position: [f32; 3],
    layer: u32,
    corner: [f32; 3],
    width: u32,
    right: [f32; 3],
    height: u32,
    down: [f32; 3],
    exposure: f32,
}

impl Eye {
    fn new(
        camera: &Camera,
        volume: &Volume,
        (width, height): (u32, u32),
        layer: Layer,
        exposure: f32,
    ) -> Self {
        let to_metres = Mat4::from_scale_rotation_translation(
            Vec3::splat(volume.cell),
            glam::Quat::IDENTITY,
            volume.origin,
        );
        let row = |i| camera.view.row(i).truncate();
        let half = (camera.projection.x_axis.x.recip(), camera.projection.y_axis.y.recip());
        let (right, down) = (row(0) * half.0, -row(1) * half.1);
        Self {
            to_clip: (camera.view_projection() * to_metres).to_cols_array_2d(),
            position: volume.cells_from(camera.eye).to_array(),
            layer: layer as u32,
            corner: (-row(2) - right - down).to_array(),
            width,
            right: (right * 2.0 / width as f32).to_array(),
            height,
            down: (down * 2.0 / height as f32).to_array(),
            exposure,
        }
    }
}

/// Textures and buffers for pictures of one size.
struct Frame {
    size: (u32, u32),
    items: TextureView,
    depth: TextureView,
    light: Buffer,
}

impl Frame {
    fn new(gpu: &Gpu, size: (u32, u32)) -> Result<Self, LightError> {
        let size = gpu.clamp(size);
        let part = Part { name: "the picture", by: "pixels" };
        let items = wgpu::TextureDescriptor {
            label: Some("items"),
            size: wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: ITEMS,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        let items = held(gpu, part, || gpu.device.create_texture(&items))?;
        let depth = held(gpu, part, || gpu.texture(size, DEPTH))?;
        Ok(Self {
            size,
            items: items.create_view(&Default::default()),
            depth: depth.create_view(&Default::default()),
            light: zeros(
                gpu,
                Part { name: "the light of pixels", ..part },
                u64::from(size.0) * u64::from(size.1) * 16,
            )?,
        })
    }
}

/// Draws pictures.
pub struct Picture {
    items: wgpu::RenderPipeline,
    gather: Kernel,
    shader: wgpu::ShaderModule,
    /// For the format of the last target.
    screen: Option<(TextureFormat, wgpu::RenderPipeline)>,
    eye: Buffer,
    frame: Frame,
}

impl Picture {
    /// Pipelines, and textures for small pictures.
    ///
    /// # Errors
    /// The adapter has no buffer as large.
    pub fn new(gpu: &Gpu) -> Result<Self, LightError> {
        let layers =
            Layer::EVERY.map(|l| format!("const {}: u32 = {}u;\n", l.name().to_uppercase(), l as u32));
        let shader = shader(gpu, "picture", &[&layers.concat(), include_str!("picture.wgsl")].concat());
        let depth = wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        };
        let bindings = [0, 1, 2, 5, 7, 8, 9, 10, 11, 12, 13, 14, 20, 21, 50, 51, 52];
        Ok(Self {
            items: pipeline(gpu, &shader, ["item_corner", "item"], ITEMS, Some(depth)),
            gather: Kernel::new(gpu, &shader, "gather", &bindings),
            shader,
            screen: None,
            eye: filled(
                gpu,
                Part { name: "the camera", by: "pixels" },
                &[Eye::zeroed()],
                BufferUsages::UNIFORM,
            )?,
            frame: Frame::new(gpu, (1, 1))?,
        })
    }

    /// Sets camera, size and layer of the next picture.
    ///
    /// # Errors
    /// The adapter has no buffer as large.
    pub fn set(
        &mut self,
        gpu: &Gpu,
        (camera, volume): (&Camera, &Volume),
        size: (u32, u32),
        (layer, exposure): (Layer, f32),
    ) -> Result<(), LightError> {
        if gpu.clamp(size) != self.frame.size {
            self.frame = Frame::new(gpu, size)?;
        }
        let eye = Eye::new(camera, volume, self.frame.size, layer, exposure);
        gpu.queue.write_buffer(&self.eye, 0, bytemuck::bytes_of(&eye));
        Ok(())
    }

    fn resource<'a>(&'a self, binding: u32, others: Others<'a, '_>) -> Option<BindingResource<'a>> {
        match binding {
            50 => Some(self.eye.as_entire_binding()),
            51 => Some(BindingResource::TextureView(&self.frame.items)),
            52 | 53 => Some(self.frame.light.as_entire_binding()),
            other => others(other),
        }
    }

    /// Draws the number of the triangle in each pixel, from 1; 0 where there is none.
    pub fn draw_items<'a>(
        &'a self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        triangles: usize,
        others: Others<'a, '_>,
    ) {
        let group = bind(gpu, &self.items.get_bind_group_layout(0), &[20, 50], &|b| self.resource(b, others));
        let load = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.frame.items,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.frame.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.items);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3 * triangles as u32, 0..1);
    }

    /// Gathers the light of each pixel.
    pub fn gather<'a>(&'a self, gpu: &Gpu, encoder: &mut CommandEncoder, others: Others<'a, '_>) {
        let (x, y) = self.frame.size;
        self.gather.run_pixels(gpu, encoder, [x, y], &|b| self.resource(b, others));
    }

    /// Shows the light of the last picture as colours.
    pub fn show(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder, target: &Target) {
        let format = target.colour.texture().format();
        if self.screen.as_ref().is_none_or(|(of, _)| *of != format) {
            self.screen =
                Some((format, pipeline(gpu, &self.shader, ["screen_corner", "screen_colour"], format, None)));
        }
        let Some((_, screen)) = &self.screen else { return };
        let own = [(50, &self.eye), (53, &self.frame.light)];
        let group = bind(gpu, &screen.get_bind_group_layout(0), &[50, 53], &among(&own));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            ..Default::default()
        });
        pass.set_pipeline(screen);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// The light of the last picture, row by row: red, green, blue, and 1 where there is a
    /// triangle.
    ///
    /// # Errors
    /// The device is lost.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<[f32; 4]>, LightError> {
        Ok(bytemuck::pod_collect_to_vec(&gpu.read_buffer(&self.frame.light)?))
    }
}

fn pipeline(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    format: TextureFormat,
    depth_stencil: Option<wgpu::DepthStencilState>,
) -> wgpu::RenderPipeline {
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
