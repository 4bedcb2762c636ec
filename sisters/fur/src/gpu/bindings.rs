//! Groups of bindings, which are numbered from 0, and the shadow map.

use casca_stage::gpu::DEPTH;
use casca_stage::wgpu::{
    self, BindingResource, BindingType, BufferBindingType, ShaderStages, TextureSampleType,
    TextureViewDimension,
};

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
    [frame, [UNIFORM, STORAGE, STORAGE]].map(|types| {
        let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let entries: Vec<_> = (0..).zip(types).map(entry).collect();
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    })
}

pub(super) fn depth_map(device: &wgpu::Device, side: u32) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadow map"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}
