//! Buffers on the device: those that grow, and those of a mesh.

use crate::mesh::Mesh;
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::wgpu::{self, BufferUsages};

use crate::gpu::look::corners_of;

/// A buffer that grows.
pub(super) struct Growing {
    pub(super) buffer: wgpu::Buffer,
    usage: BufferUsages,
}

impl Growing {
    pub(super) fn new(gpu: &Gpu, usage: BufferUsages) -> Result<Self, GpuError> {
        Ok(Self { buffer: gpu.buffer(1 << 12, usage)?, usage })
    }

    /// Writes data; whether the buffer is another one now.
    pub(super) fn write(&mut self, gpu: &Gpu, data: &[u8]) -> Result<bool, GpuError> {
        let grows = data.len() as u64 > self.buffer.size();
        if grows {
            self.buffer = gpu.buffer((data.len() as u64).next_power_of_two(), self.usage)?;
        }
        gpu.queue.write_buffer(&self.buffer, 0, data);
        Ok(grows)
    }
}

/// A mesh on the device.
pub(super) struct Buffers {
    pub(super) corners: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) count: u32,
}

impl Buffers {
    pub(super) fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Self, GpuError> {
        let filled = |data: &[u8], usage| {
            let buffer = gpu.buffer(data.len() as u64, usage)?;
            gpu.queue.write_buffer(&buffer, 0, data);
            Ok(buffer)
        };
        Ok(Self {
            corners: filled(bytemuck::cast_slice(&corners_of(mesh)), BufferUsages::VERTEX)?,
            indices: filled(bytemuck::cast_slice(mesh.triangles()), BufferUsages::INDEX)?,
            count: 3 * mesh.triangles().len() as u32,
        })
    }
}
