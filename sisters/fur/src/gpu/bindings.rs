//! Groups of bindings, and the textures in them.

use casca_stage::gpu::{DEPTH, Gpu};
use casca_stage::wgpu::{self, CompareFunction, ShaderStages, TextureFormat};

/// The layouts of two groups of bindings: those of a frame, and those of a look.
pub(super) fn layouts(device: &wgpu::Device) -> [wgpu::BindGroupLayout; 2] {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
        sample_type,
        view_dimension,
        multisampled: false,
    };
    let sampler = |ty| wgpu::BindingType::Sampler(ty);
    let frame = [
        entry(0, buffer(wgpu::BufferBindingType::Uniform)),
        entry(1, texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2)),
        entry(2, sampler(wgpu::SamplerBindingType::Comparison)),
    ];
    let look = [
        entry(0, buffer(wgpu::BufferBindingType::Uniform)),
        entry(1, buffer(wgpu::BufferBindingType::Storage { read_only: true })),
        entry(
            2,
            texture(wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::Cube),
        ),
        entry(3, sampler(wgpu::SamplerBindingType::Filtering)),
        entry(4, buffer(wgpu::BufferBindingType::Storage { read_only: true })),
    ];
    [&frame[..], &look[..]].map(|entries| {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries })
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

/// Six faces of one size on the device, one byte a texel.
pub(super) fn cube_map(gpu: &Gpu, (side, faces): &(u32, Vec<u8>)) -> wgpu::Texture {
    use wgpu::util::DeviceExt;
    gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("fur map"),
            size: wgpu::Extent3d { width: *side, height: *side, depth_or_array_layers: 6 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::R8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        faces,
    )
}

pub(super) fn frame_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    frame: &wgpu::Buffer,
    shadow: &wgpu::TextureView,
) -> wgpu::BindGroup {
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(CompareFunction::LessEqual),
        ..Default::default()
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(shadow) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}

pub(super) fn look_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    look: &wgpu::Buffer,
    [records, joints]: [&wgpu::Buffer; 2],
    map: &wgpu::Texture,
) -> wgpu::BindGroup {
    let view = map.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    });
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: look.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: records.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::Sampler(&sampler) },
            wgpu::BindGroupEntry { binding: 4, resource: joints.as_entire_binding() },
        ],
    })
}
