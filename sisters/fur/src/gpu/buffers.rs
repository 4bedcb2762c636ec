//! Buffers on the device: those that grow, and those of a mesh.

use crate::mesh::Mesh;
use crate::skin::Weights;
use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::filled;
use casca_stage::wgpu::{self, BufferUsages};

use crate::gpu::error::FurGpuError;
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

/// A vertex' joints and their shares, as the shaders take them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Follower {
    joints: [u16; 4],
    shares: [f32; 4],
}

/// A mesh on the device.
pub(super) struct Buffers {
    pub(super) corners: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    /// Three for each triangle.
    pub(super) count: u32,
    vertices: usize,
    /// Only meshes that are posed have some.
    pub(super) followers: Option<wgpu::Buffer>,
}

impl Buffers {
    pub(super) fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Self, GpuError> {
        Ok(Self {
            corners: filled(gpu, &corners_of(mesh), BufferUsages::VERTEX)?,
            indices: filled(gpu, mesh.triangles(), BufferUsages::INDEX)?,
            count: 3 * mesh.triangles().len() as u32,
            vertices: mesh.vertices().len(),
            followers: None,
        })
    }

    pub(super) fn set_weights(&mut self, gpu: &Gpu, weights: &Weights) -> Result<(), FurGpuError> {
        weights.check(self.vertices)?;
        let rows = weights.joints().iter().zip(weights.shares());
        let followers: Vec<Follower> = rows.map(|(&joints, &shares)| Follower { joints, shares }).collect();
        self.followers = Some(filled(gpu, &followers, BufferUsages::VERTEX)?);
        Ok(())
    }
}
