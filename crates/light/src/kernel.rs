//! Compute passes and their bindings. A binding has the same number in all shaders.

use bytemuck::Pod;
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::wgpu::{self, BindingResource, BufferUsages};

use crate::data::LightKindNumber;
use crate::error::{LightError, Part};
use crate::numeric::{self as n, LEVELS, MOST_CONES, MOST_STEPS};

/// Groups along x of a dispatch; others follow along y.
const GROUPS: u32 = 32_768;
/// The part that all shaders have in common.
const COMMON: &str = include_str!("volume.wgsl");

/// Constants that shaders begin with.
fn constants() -> String {
    let floats = [
        ("TOUCH", n::TOUCH),
        ("NORMAL_ROUNDING", n::NORMAL_ROUNDING),
        ("PUSH_OFF", n::PUSH_OFF),
        ("UNIT", n::UNIT),
        ("BRIGHTEST", n::BRIGHTEST),
        ("UNIT_NORMAL", n::UNIT_NORMAL),
        ("CANCELLED", n::CANCELLED),
        ("LARGEST_HALF", n::LARGEST_HALF),
        ("FAR", n::FAR),
        ("TINY", n::TINY),
        ("NEAR_FADE", n::NEAR_FADE),
        ("PI", std::f32::consts::PI),
    ];
    let numbers = [
        ("MOST_STEPS", MOST_STEPS),
        ("LEVELS", LEVELS),
        ("MOST_CONES", MOST_CONES as u32),
        ("DIRECTIONAL", LightKindNumber::Directional as u32),
        ("SPOT", LightKindNumber::Spot as u32),
    ];
    let floats = floats.map(|(name, value)| format!("const {name}: f32 = {value:?};\n"));
    let numbers = numbers.map(|(name, number)| format!("const {name}: u32 = {number}u;\n"));
    floats.into_iter().chain(numbers).collect()
}

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
/// The adapter has none as large, or no memory for it.
pub fn filled<T: Pod>(
    gpu: &Gpu,
    part: Part,
    data: &[T],
    usage: BufferUsages,
) -> Result<wgpu::Buffer, LightError> {
    let bytes: &[u8] = bytemuck::cast_slice(data);
    let buffer = made(gpu, part, bytes.len() as u64, usage)?;
    held(gpu, part, || gpu.queue.write_buffer(&buffer, 0, bytes))?;
    Ok(buffer)
}

/// A storage buffer of zeros, to be copied from and to.
///
/// # Errors
/// The adapter has none as large, or no memory for it.
pub fn zeros(gpu: &Gpu, part: Part, size: u64) -> Result<wgpu::Buffer, LightError> {
    made(gpu, part, size, BufferUsages::STORAGE)
}

fn made(gpu: &Gpu, part: Part, needed: u64, usage: BufferUsages) -> Result<wgpu::Buffer, LightError> {
    // Structures of shaders take at least 16 bytes.
    gpu.buffer(needed.max(16), usage).map_err(|error| match error {
        GpuError::NoRoom { most: limit, .. } if needed > limit => {
            LightError::TooLarge { what: part.name, needed, limit, unit: "bytes", by: part.by }
        }
        GpuError::NoRoom { .. } => LightError::NoMemory(part),
        other => other.into(),
    })
}

/// Makes something on the device. Without an error scope, a device that is out of memory would end the program.
///
/// # Errors
/// The device has no memory for it.
pub fn held<T>(gpu: &Gpu, part: Part, make: impl FnOnce() -> T) -> Result<T, LightError> {
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let made = make();
    match pollster::block_on(scope.pop()) {
        Some(_) => Err(LightError::NoMemory(part)),
        None => Ok(made),
    }
}
