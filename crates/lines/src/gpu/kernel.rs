//! Compute passes and their bindings. A binding has the same number in all shaders.

use bytemuck::Pod;
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::wgpu::{self, BufferUsages};

use crate::gpu::numeric::constants;

/// Groups along x of a dispatch; others follow along y. Adapters take 65,535.
const GROUPS: u32 = 32_768;
/// The part that all shaders have in common.
const COMMON: &str = include_str!("shaders/view.wgsl");

/// A buffer under its binding.
pub(super) type Bound<'a> = (u32, &'a wgpu::Buffer);

/// A shader, with the part that all have in common.
pub(super) fn shader(gpu: &Gpu, name: &str, text: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(format!("{}{COMMON}{text}", constants()).into());
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
}

/// Those of the buffers that a pipeline uses, bound.
pub(super) fn bind(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    used: &[u32],
    buffers: &[Bound<'_>],
) -> wgpu::BindGroup {
    let bound = buffers.iter().filter(|(binding, _)| used.contains(binding));
    let entries: Vec<_> = bound
        .map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// A compute pass.
pub(super) struct Kernel {
    pipeline: wgpu::ComputePipeline,
    used: &'static [u32],
}

impl Kernel {
    /// The entry `name` of a shader, which uses just these bindings.
    pub(super) fn new(gpu: &Gpu, module: &wgpu::ShaderModule, name: &str, used: &'static [u32]) -> Self {
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module,
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        Self { pipeline, used }
    }

    /// Runs it in so many groups.
    pub(super) fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        [x, y]: [u32; 2],
        buffers: &[Bound<'_>],
    ) {
        if x == 0 || y == 0 {
            return;
        }
        let group = bind(gpu, &self.pipeline.get_bind_group_layout(0), self.used, buffers);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }

    /// Runs it once for each chunk of segments.
    pub(super) fn run_chunks(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        chunks: usize,
        buffers: &[Bound<'_>],
    ) {
        let chunks = chunks as u32;
        self.run(gpu, encoder, [chunks.min(GROUPS), chunks.div_ceil(GROUPS)], buffers);
    }

    /// Runs it once for each 8 x 8 pixels.
    pub(super) fn run_pixels(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        size: [u32; 2],
        buffers: &[Bound<'_>],
    ) {
        self.run(gpu, encoder, size.map(|s| s.div_ceil(8)), buffers);
    }
}

/// A buffer with these contents; an empty one holds a zero of 16 bytes, since none of size 0 can be bound.
pub(super) fn filled<T: Pod>(
    gpu: &Gpu,
    contents: &[T],
    usage: BufferUsages,
) -> Result<wgpu::Buffer, GpuError> {
    let bytes: &[u8] = bytemuck::cast_slice(contents);
    let buffer = gpu.buffer((bytes.len() as u64).max(16), usage)?;
    if !bytes.is_empty() {
        gpu.write(&buffer, bytes)?;
    }
    Ok(buffer)
}
