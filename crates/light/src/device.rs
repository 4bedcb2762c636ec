//! Shaders, buffers, and errors that name their part. A binding has the same number in all shaders.

use bytemuck::Pod;
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::wgpu::{self, BufferUsages};

use crate::data::LightKindNumber;
use crate::error::{LightError, Part};
use crate::numeric::{self as n, LEVELS, MOST_CONES, MOST_STEPS};

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

/// Makes something on the device.
///
/// # Errors
/// The device has no memory for it.
pub fn held<T>(gpu: &Gpu, part: Part, make: impl FnOnce() -> T) -> Result<T, LightError> {
    gpu.try_room(make).ok_or(LightError::NoMemory(part))
}
