//! Groups of bindings, which are numbered from 0, and the shadow map.

use casca_stage::gpu::DEPTH;
use casca_stage::wgpu::{
    self, BindingResource, BindingType, BufferBindingType, ShaderStages, TextureFormat, TextureSampleType,
    TextureViewDimension,
};

use crate::strands::{PERIOD, TEXELS};

const UNIFORM: BindingType = buffer(BufferBindingType::Uniform);
const STORAGE: BindingType = buffer(BufferBindingType::Storage { read_only: true });

const fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

pub(super) fn group<'a>(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = BindingResource<'a>>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// The layouts of two groups: those of a frame, and those of a look.
pub(super) fn layouts(device: &wgpu::Device) -> [wgpu::BindGroupLayout; 2] {
    let frame = [
        UNIFORM,
        BindingType::Texture {
            sample_type: TextureSampleType::Depth,
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        },
        BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
    ];
    let visibility = ShaderStages::VERTEX_FRAGMENT;
    let strands = BindingType::Texture {
        sample_type: TextureSampleType::Uint,
        view_dimension: TextureViewDimension::D3,
        multisampled: false,
    };
    [&frame[..], &[UNIFORM, STORAGE, STORAGE, strands]].map(|types| {
        let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let entries: Vec<_> = (0..).zip(types).map(entry).collect();
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    })
}

pub(super) fn depth_map(device: &wgpu::Device, side: u32) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 };
    texture(device, size, DEPTH, wgpu::TextureUsages::RENDER_ATTACHMENT).create_view(&Default::default())
}

/// The table of strands.
pub(super) fn strand_map(device: &wgpu::Device) -> wgpu::Texture {
    let side = PERIOD * TEXELS;
    let size = wgpu::Extent3d { width: side, height: side, depth_or_array_layers: side };
    texture(device, size, TextureFormat::R32Uint, wgpu::TextureUsages::COPY_DST)
}

fn texture(
    device: &wgpu::Device,
    size: wgpu::Extent3d,
    format: TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    let is_flat = size.depth_or_array_layers == 1;
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: if is_flat { wgpu::TextureDimension::D2 } else { wgpu::TextureDimension::D3 },
        format,
        usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}
