//! Context in the memory of a device.

use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::Gpu;
use casca_stage::kernel::filled;
use casca_stage::wgpu::{Buffer, BufferUsages};

use crate::gpu::context::Context;
use crate::gpu::error::LinesGpuError;

/// A vertex, as context.wgsl takes it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(super) struct GpuVertex {
    position: [f32; 3],
    normal: [f32; 3],
    colour: [u8; 4],
}

/// A mesh in the memory of a device.
pub struct GpuContext {
    pub(super) vertices: Buffer,
    pub(super) corners: Buffer,
    pub(super) count: u32,
}

impl GpuContext {
    /// Copies a mesh to the device. Memory: 28 bytes a vertex and 12 a triangle.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(gpu: &Gpu, context: &Context) -> Result<Self, LinesGpuError> {
        let mesh = context.mesh();
        let [r, g, b] = context.colour;
        let vertex = |(position, normal): (&glam::Vec3, glam::Vec3)| GpuVertex {
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
