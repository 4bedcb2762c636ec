//! Draws lists of objects: as a picture, or as an item buffer with the numbers of the objects.

use bytemuck::{Pod, Zeroable};
use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::gpu::{Gpu, ITEMS};
use casca_stage::pass::{Draws, behind, over};
use casca_stage::wgpu::util::DeviceExt;
use casca_stage::wgpu::{self, BufferUsages, TextureFormat, VertexFormat, VertexStepMode, vertex_attr_array};

use crate::scene::geometry::{DrawList, Geometry, Instance};

/// No object, in item buffers.
pub const NO_ITEM: u32 = u32::MAX;
/// The colour into which the shaders fade.
const SKY: wgpu::Color = wgpu::Color { r: 0.83, g: 0.88, b: 0.93, a: 1.0 };

/// The camera as the shaders take it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Eye {
    right: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    position: [f32; 4],
    lens: [f32; 4],
    size: [f32; 4],
}

impl Eye {
    fn new(camera: &Camera, (width, height): (u32, u32), haze: f32) -> Self {
        let (view, projection) = (camera.view, camera.projection);
        let row = |i| view.row(i).with_w(0.0).to_array();
        // Planes of a matrix with depth 0 to 1, found in double precision: they cancel.
        let (a, b) = (f64::from(projection.z_axis.z), f64::from(projection.w_axis.z));
        let (near, far) = (b / a, b / (a + 1.0));
        let (width, height) = (width as f32, height as f32);
        Self {
            right: row(0),
            up: row(1),
            forward: (-view.row(2)).with_w(0.0).to_array(),
            position: camera.eye.extend(0.0).to_array(),
            lens: [projection.x_axis.x, projection.y_axis.y, near as f32, (near / far) as f32],
            size: [width, height, haze, 0.0],
        }
    }
}

/// A line in world space, some pixels wide.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Line {
    /// One end.
    pub start: [f32; 3],
    /// Width in pixels.
    pub width: f32,
    /// The other end.
    pub end: [f32; 3],
    /// Red, green, blue, opacity.
    pub colour: [u8; 4],
}

/// A corner of a translucent triangle in world space.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Corner {
    /// Where it is.
    pub position: [f32; 3],
    /// Red, green, blue, opacity.
    pub colour: [u8; 4],
}

/// Lines and translucent areas over a picture.
#[derive(Debug, Clone, Default)]
pub struct Marks {
    /// Lines.
    pub lines: Vec<Line>,
    /// Triangles, three corners each.
    pub fills: Vec<Corner>,
}

/// What a drawing writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Shaded colours.
    Picture,
    /// Numbers of objects.
    Items,
}

/// A buffer that grows.
struct Growing {
    buffer: wgpu::Buffer,
    usage: BufferUsages,
}

impl Growing {
    fn new(gpu: &Gpu, usage: BufferUsages) -> Self {
        Self { buffer: Self::sized(gpu, usage, 1 << 16), usage }
    }

    fn sized(gpu: &Gpu, usage: BufferUsages, size: u64) -> wgpu::Buffer {
        let usage = usage | BufferUsages::COPY_DST;
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    fn write<T: Pod>(&mut self, gpu: &Gpu, data: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        if bytes.len() as u64 > self.buffer.size() {
            self.buffer = Self::sized(gpu, self.usage, (bytes.len() as u64).next_power_of_two());
        }
        gpu.queue.write_buffer(&self.buffer, 0, bytes);
    }
}

/// Pipelines and buffers for one scene and one format of pictures.
pub struct Renderer {
    solids: [wgpu::RenderPipeline; 2],
    meshes: [wgpu::RenderPipeline; 2],
    /// Lines and areas: in front, and faintly behind other things.
    lines: [wgpu::RenderPipeline; 2],
    fills: [wgpu::RenderPipeline; 2],
    eye: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    mesh_ranges: Vec<(std::ops::Range<u32>, i32)>,
    instances: Growing,
    line_ends: Growing,
    fill_corners: Growing,
    /// How fast things fade into the sky, by distance.
    pub haze: f32,
    /// The colour behind everything.
    pub sky: wgpu::Color,
}

impl Renderer {
    /// A renderer for the meshes of a scene and pictures of this format.
    pub fn new(gpu: &Gpu, format: TextureFormat, geometry: &Geometry) -> Self {
        let device = &gpu.device;
        let shader = device.create_shader_module(wgpu::include_wgsl!("scene.wgsl"));
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let eye = Growing::sized(gpu, BufferUsages::UNIFORM, size_of::<Eye>() as u64);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: eye.as_entire_binding() }],
        });
        let pipelines = Pipelines {
            gpu,
            shader: &shader,
            layout: &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            }),
            format,
        };
        let filled = |contents: &[u8], usage| {
            // Empty buffers cannot be bound.
            let contents = if contents.is_empty() { &[0; 16] } else { contents };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        Self {
            solids: pipelines.objects(true),
            meshes: pipelines.objects(false),
            lines: pipelines.marks("line_corner"),
            fills: pipelines.marks("fill_corner"),
            eye,
            bindings,
            vertices: filled(bytemuck::cast_slice(&geometry.vertices), BufferUsages::VERTEX),
            indices: filled(bytemuck::cast_slice(&geometry.indices), BufferUsages::INDEX),
            mesh_ranges: geometry.meshes.clone(),
            instances: Growing::new(gpu, BufferUsages::VERTEX),
            line_ends: Growing::new(gpu, BufferUsages::VERTEX),
            fill_corners: Growing::new(gpu, BufferUsages::VERTEX),
            haze: 0.0,
            sky: SKY,
        }
    }

    /// Draws a list of objects, and marks over them.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        output: Output,
        target: &Target,
        camera: &Camera,
        list: &DrawList,
        marks: &Marks,
    ) {
        let eye = Eye::new(camera, target.size(), self.haze);
        gpu.queue.write_buffer(&self.eye, 0, bytemuck::bytes_of(&eye));
        self.instances.write(gpu, &list.instances);
        self.line_ends.write(gpu, &marks.lines);
        self.fill_corners.write(gpu, &marks.fills);

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let nothing = wgpu::Color { r: f64::from(NO_ITEM), ..wgpu::Color::default() };
        let clear = if output == Output::Picture { self.sky } else { nothing };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[over(&target.colour, Some(clear))],
            depth_stencil_attachment: behind(&target.depth, 0.0),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.bindings, &[]);
        let variant = usize::from(output == Output::Items);
        for (mesh, run) in &list.runs {
            let Some(mesh) = mesh else {
                pass.set_pipeline(&self.solids[variant]);
                pass.set_vertex_buffer(0, self.instances.buffer.slice(..));
                pass.draw(0..36, run.clone());
                continue;
            };
            let (indices, base) = &self.mesh_ranges[*mesh];
            pass.set_pipeline(&self.meshes[variant]);
            pass.set_vertex_buffer(0, self.instances.buffer.slice(..));
            pass.set_vertex_buffer(1, self.vertices.slice(..));
            pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(indices.clone(), *base, run.clone());
        }
        if output == Output::Picture {
            for behind in [1, 0] {
                if !marks.fills.is_empty() {
                    pass.set_pipeline(&self.fills[behind]);
                    pass.set_vertex_buffer(0, self.fill_corners.buffer.slice(..));
                    pass.draw(0..marks.fills.len() as u32, 0..1);
                }
                if !marks.lines.is_empty() {
                    pass.set_pipeline(&self.lines[behind]);
                    pass.set_vertex_buffer(0, self.line_ends.buffer.slice(..));
                    pass.draw(0..6, 0..marks.lines.len() as u32);
                }
            }
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }
}

/// Makes pipelines.
struct Pipelines<'a> {
    gpu: &'a Gpu,
    shader: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
    format: TextureFormat,
}

impl Pipelines<'_> {
    /// For solids or meshes: pictures and item buffers.
    fn objects(&self, solids: bool) -> [wgpu::RenderPipeline; 2] {
        let instance =
            vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4, 4 => Unorm8x4, 5 => Uint32];
        let instance = layout::<Instance>(VertexStepMode::Instance, &instance);
        let vertex =
            [wgpu::VertexAttribute { format: VertexFormat::Float32x3, offset: 0, shader_location: 0 }];
        let vertex = layout::<[f32; 3]>(VertexStepMode::Vertex, &vertex);
        let (entry, fragments, buffers) = if solids {
            ("solid_corner", ["solid_colour", "solid_item"], vec![Some(instance)])
        } else {
            ("mesh_corner", ["mesh_colour", "mesh_item"], vec![Some(instance), Some(vertex)])
        };
        [(fragments[0], self.format), (fragments[1], ITEMS)].map(|(fragment, format)| {
            let cull = solids.then_some(wgpu::Face::Front);
            self.make(
                [entry, fragment],
                &buffers,
                (format, None),
                cull,
                (true, wgpu::CompareFunction::Greater),
            )
        })
    }

    /// For marks: what is in front, and what shows through.
    fn marks(&self, entry: &str) -> [wgpu::RenderPipeline; 2] {
        let ends = vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Unorm8x4];
        let corners = vertex_attr_array![0 => Float32x3, 1 => Unorm8x4];
        let buffer = if entry == "line_corner" {
            layout::<Line>(VertexStepMode::Instance, &ends)
        } else {
            layout::<Corner>(VertexStepMode::Vertex, &corners)
        };
        let target = (self.format, Some(wgpu::BlendState::ALPHA_BLENDING));
        [("mark_colour", wgpu::CompareFunction::GreaterEqual), ("mark_behind", wgpu::CompareFunction::Less)]
            .map(|(fragment, compare)| {
                self.make([entry, fragment], &[Some(buffer.clone())], target, None, (false, compare))
            })
    }

    fn make(
        &self,
        entries: [&str; 2],
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        (format, blend): (TextureFormat, Option<wgpu::BlendState>),
        cull: Option<wgpu::Face>,
        depth: (bool, wgpu::CompareFunction),
    ) -> wgpu::RenderPipeline {
        Draws {
            module: self.shader,
            layout: Some(self.layout),
            entries,
            buffers,
            cull,
            depth: Some(depth),
            targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })],
        }
        .pipeline(self.gpu)
    }
}

fn layout<T>(
    step_mode: VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}
