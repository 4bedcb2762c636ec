//! Surface splatting on the graphics processor: a [`SurfelRenderer`] draws points as discs that blend
//! into a closed surface. The device comes from `casca_stage::gpu::Gpu`.
//!
//! Tavares 2009, chapter 4, in the form of Zwicker, Pfister, van Baar & Gross 2001, "Surface Splatting", and
//! Botsch & Kobbelt 2003, "High-Quality Point-Based Rendering on Modern GPUs": a visibility pass into depth,
//! a pass that adds colours with Gaussian weights, and a pass that divides by the sum of weights. The thesis
//! leaves the last one out, so that its pictures depend on the order.

use crate::Camera;
use bytemuck::{Pod, Zeroable};
use casca_stage::canvas::Target;
use casca_stage::gpu::{DEPTH, Gpu, GpuError};
use casca_stage::kernel::{among, bind, filled};
use casca_stage::wgpu::util::{BufferInitDescriptor, DeviceExt};
use casca_stage::wgpu::{self, BufferUsages, Color, TextureFormat, vertex_attr_array};
use glam::Vec3;

/// Sums of colours and weights. Adapters need not blend larger floats.
const SUMS: TextureFormat = TextureFormat::Rgba16Float;

/// A disc that stands for the surface around a point.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Surfel {
    /// Its centre.
    pub position: [f32; 3],
    /// Its radius, in the units of the position.
    pub radius: f32,
    /// The normal of the surface, of length 1; a disc without one, of zeros, faces the eye and has no back.
    pub normal: [f32; 3],
    /// Red, green, blue; the fourth is not used.
    pub colour: [u8; 4],
}

/// Discs in the memory of a device, 32 bytes each.
pub struct Surfels {
    buffer: wgpu::Buffer,
    count: u32,
}

impl Surfels {
    /// Copies discs to the device. Those with numbers that are not finite are not drawn.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(gpu: &Gpu, surfels: &[Surfel]) -> Result<Self, GpuError> {
        let is_good = |s: &&Surfel| {
            let numbers = s.position.iter().chain(&s.normal).chain([&s.radius]);
            numbers.copied().all(f32::is_finite)
        };
        let good: Vec<Surfel> = surfels.iter().filter(is_good).copied().collect();
        Ok(Self { buffer: filled(gpu, &good, BufferUsages::VERTEX)?, count: good.len() as u32 })
    }
}

/// How discs are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// What radii are multiplied by. With 0 each disc is a dot of the least size.
    pub scale: f32,
    /// The least radius of a disc in pixels. About 0.7 leaves no gaps in surfaces that are far away.
    pub least_pixels: f32,
    /// How far discs may be behind the nearest one and still blend with it, in units of the world;
    /// about a radius.
    pub offset: f32,
    /// Whether surfaces with a normal are lit from above the eye's left shoulder.
    pub lit: bool,
}

/// A part of a picture, and the discs in it.
pub struct Pane<'a> {
    /// The discs.
    pub surfels: &'a Surfels,
    /// How they are drawn.
    pub style: Style,
    /// The left upper corner in pixels. The part is as large as the camera's picture, and must be
    /// within the target.
    pub corner: (u32, u32),
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Lens {
    view_projection: [[f32; 4]; 4],
    eye: [f32; 3],
    offset: f32,
    forward: [f32; 3],
    near: f32,
    light: [f32; 3],
    ambient: f32,
    least: f32,
    scale: f32,
    padding: [f32; 2],
}

impl Lens {
    fn new(camera: &Camera, style: &Style) -> Self {
        let [right, down, forward] = camera.axes().map(Vec3::normalize_or_zero);
        Self {
            view_projection: camera.view_projection().to_cols_array_2d(),
            eye: camera.eye().to_array(),
            offset: style.offset,
            forward: forward.to_array(),
            near: camera.depths().0,
            light: (-forward - 0.6 * right - 0.8 * down).normalize_or_zero().to_array(),
            ambient: if style.lit { 0.5 } else { 1.0 },
            least: style.least_pixels / camera.pixels_per_tangent(),
            scale: style.scale,
            padding: [0.0; 2],
        }
    }
}

/// Draws surfels.
pub struct SurfelRenderer {
    surface: wgpu::RenderPipeline,
    weighted: wgpu::RenderPipeline,
    mean: wgpu::RenderPipeline,
}

impl SurfelRenderer {
    /// Compiles the shaders, for pictures of a format.
    pub fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let shader = gpu.device.create_shader_module(wgpu::include_wgsl!("surfels.wgsl"));
        let pipeline = |entries, colour, depth| pipeline(gpu, &shader, entries, colour, depth);
        let sum = wgpu::BlendComponent { dst_factor: wgpu::BlendFactor::One, ..Default::default() };
        let sums = (SUMS, Some(wgpu::BlendState { color: sum, alpha: sum }));
        Self {
            surface: pipeline(["corner_behind", "surface"], None, Some(true)),
            weighted: pipeline(["corner", "weighted"], Some(sums), Some(false)),
            mean: pipeline(["everywhere", "mean"], Some((format, None)), None),
        }
    }

    /// Draws panes over a cleared `target`, all as `camera` sees them. Panes that reach beyond the
    /// target are left out.
    ///
    /// The order of the discs of a pane does not matter, but for the rounding of sums: their
    /// precision is 1/2048. Each disc is drawn twice, with four corners.
    pub fn draw(&self, gpu: &Gpu, target: &Target, camera: &Camera, background: Color, panes: &[Pane<'_>]) {
        let ((width, height), (w, h)) = (target.size(), camera.size());
        let within = |pane: &&Pane| {
            let (x, y) = pane.corner;
            x <= width && w <= width - x && y <= height && h <= height - y
        };
        let (label, usage) = (None, BufferUsages::UNIFORM);
        let lens = |pane: &Pane| {
            let lens = Lens::new(camera, &pane.style);
            let contents = bytemuck::bytes_of(&lens);
            gpu.device.create_buffer_init(&BufferInitDescriptor { label, contents, usage })
        };
        let panes: Vec<_> = panes.iter().filter(within).map(|pane| (pane, lens(pane))).collect();
        let sums = gpu.texture((width, height), SUMS).create_view(&Default::default());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let passes = [
            (&self.surface, None, Some(wgpu::LoadOp::Clear(0.0))),
            (&self.weighted, Some((&sums, Color::TRANSPARENT)), Some(wgpu::LoadOp::Load)),
            (&self.mean, Some((&target.colour, background)), None),
        ];
        for (pipeline, colour, depth) in passes {
            let colour = colour.map(|(view, clear)| wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
            });
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: if colour.is_some() { std::slice::from_ref(&colour) } else { &[] },
                depth_stencil_attachment: depth.map(|load| wgpu::RenderPassDepthStencilAttachment {
                    view: &target.depth,
                    depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            for (pane, lens) in &panes {
                let (x, y) = pane.corner;
                pass.set_viewport(x as f32, y as f32, w as f32, h as f32, 0.0, 1.0);
                pass.set_scissor_rect(x, y, w, h);
                let layout = pipeline.get_bind_group_layout(0);
                if depth.is_some() {
                    pass.set_bind_group(0, &bind(gpu, &layout, &[0], &among(&[(0, lens)])), &[]);
                    pass.set_vertex_buffer(0, pane.surfels.buffer.slice(..));
                    pass.draw(0..4, 0..pane.surfels.count);
                } else {
                    let sums = |_: u32| Some(wgpu::BindingResource::TextureView(&sums));
                    pass.set_bind_group(0, &bind(gpu, &layout, &[1], &sums), &[]);
                    pass.draw(0..3, 0..1);
                }
            }
        }
        gpu.queue.submit([encoder.finish()]);
    }
}

/// A pipeline. `depth` says whether depths are written; without it, they are not even tested, and
/// there are no surfels.
fn pipeline(
    gpu: &Gpu,
    shader: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    colour: Option<(TextureFormat, Option<wgpu::BlendState>)>,
    depth: Option<bool>,
) -> wgpu::RenderPipeline {
    let attributes = vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Unorm8x4];
    let surfels = depth.map(|_| wgpu::VertexBufferLayout {
        array_stride: size_of::<Surfel>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &attributes,
    });
    let (write_mask, topology) = (wgpu::ColorWrites::ALL, wgpu::PrimitiveTopology::TriangleStrip);
    let target = colour.map(|(format, blend)| wgpu::ColorTargetState { format, blend, write_mask });
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: None,
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: if surfels.is_some() { std::slice::from_ref(&surfels) } else { &[] },
        },
        primitive: wgpu::PrimitiveState { topology, ..Default::default() },
        depth_stencil: depth.map(|write| wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(write),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: if target.is_some() { std::slice::from_ref(&target) } else { &[] },
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests;
