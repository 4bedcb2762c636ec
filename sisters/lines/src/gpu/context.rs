//! Context: opaque triangle meshes among the lines, which hide them.
//!
//! Meshes are rasterised into a depth of each pixel, so that their number costs no pixel anything.
//! The same triangles are occluders of the scene of bundles: casca's meshes hide no more than their
//! triangles do.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use casca::{Aabb, Occluder, TriMesh};
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{among, bind, filled};
use casca_stage::wgpu::{self, Buffer, BufferUsages, TextureFormat, TextureUsages, TextureView};
use glam::Vec3;

use crate::gpu::error::LinesGpuError;
use crate::gpu::lens::shader;
use crate::mesh::Mesh;

/// The colour of walls, bytes of sRGB.
pub const GREY: [u8; 3] = [158, 163, 173];

/// A mesh in a colour, prepared to hide lines.
pub struct Context {
    mesh: Mesh,
    colour: [u8; 3],
    occluders: Vec<(Aabb, Occluder)>,
}

impl Context {
    /// A mesh, open or closed, in a colour: bytes of sRGB. Time: that of [`TriMesh::new`], one to
    /// two seconds for a million triangles.
    ///
    /// # Errors
    /// The mesh has no triangles, or positions that are not finite, or it names vertices that are
    /// not there.
    pub fn new(mesh: Mesh, colour: [u8; 3]) -> Result<Self, LinesGpuError> {
        let occluder = TriMesh::new(mesh.positions.clone(), mesh.triangles.clone())?;
        let corners = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]);
        let occluders = Aabb::from_points(corners).map(|bounds| (bounds, Arc::new(occluder).into()));
        Ok(Self { mesh, colour, occluders: occluders.into_iter().collect() })
    }

    /// Grey boxes, by their least and greatest corners; each hides alone.
    pub fn of_boxes(boxes: &[[Vec3; 2]]) -> Self {
        let solid = |[min, max]: &[Vec3; 2]| (Aabb::new(*min, *max), Aabb::new(*min, *max).into());
        let occluders = boxes.iter().map(solid).collect();
        Self { mesh: Mesh::of_boxes(boxes), colour: GREY, occluders }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The occluders, and their bounds.
    pub(super) fn occluders(&self) -> &[(Aabb, Occluder)] {
        &self.occluders
    }
}

/// A vertex, as context.wgsl takes it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct GpuVertex {
    position: [f32; 3],
    normal: [f32; 3],
    colour: [u8; 4],
}

/// A mesh in the memory of a device.
pub struct GpuContext {
    vertices: Buffer,
    corners: Buffer,
    count: u32,
}

impl GpuContext {
    /// Copies a mesh to the device. Memory: 28 bytes a vertex and 12 a triangle.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(gpu: &Gpu, context: &Context) -> Result<Self, LinesGpuError> {
        let mesh = context.mesh();
        let [r, g, b] = context.colour;
        let vertex = |(position, normal): (&Vec3, Vec3)| GpuVertex {
            position: position.to_array(),
            normal: normal.to_array(),
            colour: [r, g, b, 255],
        };
        let vertices: Vec<GpuVertex> = mesh.positions.iter().zip(mesh.normals()).map(vertex).collect();
        let corners = mesh.triangles.as_flattened();
        Ok(Self {
            vertices: filled(gpu, &vertices, BufferUsages::VERTEX)?,
            corners: filled(gpu, corners, BufferUsages::INDEX)?,
            count: corners.len() as u32,
        })
    }
}

/// The depths of eye space, in full.
const DEPTH: TextureFormat = TextureFormat::R32Float;
const SHADE: TextureFormat = TextureFormat::Rgba8Unorm;
/// By which triangles hide each other.
const ORDER: TextureFormat = TextureFormat::Depth32Float;
/// The depth of a pixel without context, as `FAR_AWAY` of the shaders.
const FAR_AWAY: f64 = 3e38;

/// The depth and shade of context in each pixel.
pub(super) struct Surfaces {
    depth: TextureView,
    shade: TextureView,
    order: TextureView,
}

impl Surfaces {
    /// Of a size in pixels. Memory on the device: 12 bytes a pixel.
    pub(super) fn new(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<Self, GpuError> {
        let most = u64::from(gpu.device.limits().max_texture_dimension_2d);
        let bytes = u64::from(width) * u64::from(height) * 4;
        let no_room = GpuError::NoRoom { bytes, most: most * most * 4 };
        if u64::from(width.max(height)) > most {
            return Err(no_room);
        }
        let texture = |format, usage| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some("context"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            };
            gpu.try_room(|| gpu.device.create_texture(&descriptor).create_view(&Default::default()))
        };
        let of = TextureUsages::TEXTURE_BINDING;
        match (texture(DEPTH, of), texture(SHADE, of), texture(ORDER, TextureUsages::empty())) {
            (Some(depth), Some(shade), Some(order)) => Ok(Self { depth, shade, order }),
            _ => Err(no_room),
        }
    }

    /// The bindings of shaders that read them, and `others`.
    pub(super) fn with<'a>(
        &'a self,
        others: impl Fn(u32) -> Option<wgpu::BindingResource<'a>>,
    ) -> impl Fn(u32) -> Option<wgpu::BindingResource<'a>> {
        move |number| match number {
            10 => Some(wgpu::BindingResource::TextureView(&self.depth)),
            13 => Some(wgpu::BindingResource::TextureView(&self.shade)),
            _ => others(number),
        }
    }
}

/// Draws context.
pub(super) struct ContextPass {
    pipeline: wgpu::RenderPipeline,
}

impl ContextPass {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let module = shader(gpu, "context", include_str!("shaders/context.wgsl"));
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4];
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        })];
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("context"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &buffers,
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: ORDER,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("shade"),
                compilation_options: Default::default(),
                targets: &[Some(DEPTH.into()), Some(SHADE.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    /// Draws meshes through a lens.
    pub(super) fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (lens, context): (&Buffer, &[GpuContext]),
        onto: &Surfaces,
    ) {
        let target = |view, clear: wgpu::Color| {
            let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store };
            Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
        };
        let far_away = wgpu::Color { r: FAR_AWAY, ..wgpu::Color::BLACK };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("context"),
            color_attachments: &[target(&onto.depth, far_away), target(&onto.shade, wgpu::Color::BLACK)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &onto.order,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let group = bind(gpu, &self.pipeline.get_bind_group_layout(0), &[0], &among(&[(0, lens)]));
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        for mesh in context.iter().filter(|mesh| mesh.count > 0) {
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.corners.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.count, 0, 0..1);
        }
    }
}
