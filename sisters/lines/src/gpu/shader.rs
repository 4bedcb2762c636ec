//! Shaders, with the part that all have in common. A binding has the same number in all of them.

use casca_stage::gpu::Gpu;
use casca_stage::wgpu;

use crate::gpu::numeric::constants;

/// The part that all shaders have in common.
const COMMON: &str = include_str!("shaders/view.wgsl");

/// A shader, with the part that all have in common.
pub(super) fn shader(gpu: &Gpu, name: &str, text: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(format!("{}{COMMON}{text}", constants()).into());
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
}
