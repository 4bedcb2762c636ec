//! Compute passes and their bindings. A binding has the same number in all shaders.

use bytemuck::Pod;
use casca_stage::gpu::Gpu;
use casca_stage::wgpu::util::DeviceExt;
use casca_stage::wgpu::{self, BindingResource, BufferUsages};

use crate::error::LightError;
use crate::numeric::constants;

/// Groups along x of a dispatch; others follow along y.
const GROUPS: u32 = 32_768;
/// The part that all shaders have in common.
const COMMON: &str = include_str!("volume.wgsl");

/// A shader, with the part that all have in common.
pub fn shader(gpu: &Gpu, name: &str, text: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(format!("{}{COMMON}{text}", constants()).into());
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
}

/// A compute pass.
pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
    bindings: Vec<u32>,
    name: &'static str,
}

/// Gives the resource of a binding by its number.
pub type Lookup<'a, 'b> = &'b dyn Fn(u32) -> BindingResource<'a>;

/// The bind group of these bindings for a pipeline's layout.
pub fn bind(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    bindings: &[u32],
    lookup: Lookup<'_, '_>,
) -> wgpu::BindGroup {
    let entry = |&binding| wgpu::BindGroupEntry { binding, resource: lookup(binding) };
    let entries: Vec<_> = bindings.iter().map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

impl Kernel {
    /// The entry `name` of a shader, which uses just these bindings.
    pub fn new(gpu: &Gpu, module: &wgpu::ShaderModule, name: &'static str, bindings: &[u32]) -> Self {
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module,
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        Self { pipeline, bindings: bindings.to_vec(), name }
    }

    /// Runs it once, in some groups.
    pub fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (x, y): (u32, u32),
        lookup: Lookup<'_, '_>,
    ) {
        if x == 0 || y == 0 {
            return;
        }
        let group = bind(gpu, &self.pipeline.get_bind_group_layout(0), &self.bindings, lookup);
        let descriptor = wgpu::ComputePassDescriptor { label: Some(self.name), timestamp_writes: None };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }

    /// Runs it in so many groups, which it numbers by `group_number`.
    pub fn run_groups(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        groups: usize,
        lookup: Lookup<'_, '_>,
    ) {
        let groups = groups as u32;
        self.run(gpu, encoder, (groups.min(GROUPS), groups.div_ceil(GROUPS)), lookup);
    }
}

/// A buffer that holds `data`; one that is empty holds a zero, since none of size 0 can be bound.
///
/// # Errors
/// The adapter has none as large.
pub fn filled<T: Pod>(
    gpu: &Gpu,
    what: &'static str,
    data: &[T],
    usage: BufferUsages,
) -> Result<wgpu::Buffer, LightError> {
    let bytes: &[u8] = bytemuck::cast_slice(data);
    fits(gpu, what, bytes.len() as u64)?;
    let contents = if bytes.is_empty() { &[0; 16] } else { bytes };
    let usage = usage | BufferUsages::COPY_DST;
    Ok(gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(what),
        contents,
        usage,
    }))
}

/// A storage buffer of zeros, to be copied from and to.
///
/// # Errors
/// The adapter has none as large.
pub fn zeros(gpu: &Gpu, what: &'static str, size: u64) -> Result<wgpu::Buffer, LightError> {
    fits(gpu, what, size)?;
    Ok(gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: size.max(16),
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    }))
}

fn fits(gpu: &Gpu, what: &'static str, needed: u64) -> Result<(), LightError> {
    let limits = gpu.device.limits();
    let limit = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    if needed > limit { Err(LightError::TooLarge { what, needed, limit, unit: "bytes" }) } else { Ok(()) }
}
