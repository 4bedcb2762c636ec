//! A device, and what tests draw with it.

use casca_radiosity::Scene;
use casca_radiosity::gpu::{Answers, Gloss, GpuCache, Input, Mirrors, Shading, Surfaces};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu;
use glam::{Mat4, Vec3};

use crate::common::{cuboid, lamp, matt, room, scene};

/// Work of one submission.
pub fn run(gpu: &Gpu, work: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    work(&mut encoder);
    gpu.queue.submit([encoder.finish()]);
}

/// What a buffer holds.
pub fn read(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<[f32; 4]> {
    bytemuck::pod_collect_to_vec(&gpu.read_buffer(buffer).unwrap())
}

/// The light of points with normals, by a picture of one row.
pub fn shaded(gpu: &Gpu, light: &GpuCache, answers: Answers, points: &[(Vec3, Vec3)]) -> Vec<[f32; 4]> {
    let size = (points.len(), 1);
    let positions =
        texture_of(gpu, size, &points.iter().map(|p| p.0.extend(1.0).to_array()).collect::<Vec<_>>());
    let normals =
        texture_of(gpu, size, &points.iter().map(|p| p.1.extend(0.0).to_array()).collect::<Vec<_>>());
    let shading = Shading::new(&gpu.device, Input::Positions, answers);
    let surfaces = Surfaces { place: &positions, normals: &normals, inverse: Mat4::NAN, empty: 0.0 };
    picture_of(gpu, size, |encoder, view| light.shade(&gpu.device, encoder, &shading, surfaces, view))
}

/// A point of a mirroring surface, its normal and the width of its lobe.
pub type Mirroring = (Vec3, Vec3, f32);

/// What points mirror towards an eye by so many rays, by a picture of one row.
pub fn mirrored(gpu: &Gpu, light: &GpuCache, points: &[Mirroring], eye: Vec3, rays: u32) -> Vec<[f32; 4]> {
    let size = (points.len(), 1);
    let row = |of: &dyn Fn(&Mirroring) -> [f32; 4]| {
        texture_of(gpu, size, &points.iter().map(of).collect::<Vec<_>>())
    };
    let place = row(&|p| p.0.extend(1.0).to_array());
    let normals = row(&|p| p.1.extend(0.0).to_array());
    // Other components are read by nobody.
    let roughness = row(&|p| [p.2, f32::NAN, -1.0, 7.0]);
    let mirrors = Mirrors::new(&gpu.device, Input::Positions);
    let surfaces = Surfaces { place: &place, normals: &normals, inverse: Mat4::NAN, empty: 0.0 };
    let gloss = Gloss { roughness: &roughness, eye, rays };
    picture_of(gpu, size, |encoder, view| {
        light.mirror(&gpu.device, encoder, &mirrors, surfaces, gloss, view).unwrap();
    })
}

fn descriptor(
    (width, height): (usize, usize),
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    }
}

/// A texture of four numbers for each pixel.
pub fn texture_of(gpu: &Gpu, size: (usize, usize), values: &[[f32; 4]]) -> wgpu::TextureView {
    use wgpu::util::DeviceExt;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &descriptor(size, wgpu::TextureFormat::Rgba32Float, usage),
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(values),
    );
    texture.create_view(&Default::default())
}

/// A depth buffer with these depths, as a pass of the application leaves it.
pub fn depth_of(gpu: &Gpu, size: (usize, usize), depths: &[f32]) -> wgpu::TextureView {
    use wgpu::util::DeviceExt;
    let source = format!(
        "@group(0) @binding(0) var<storage, read> depths: array<f32>;
        @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {{
            return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
        }}
        @fragment fn depth(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {{
            return depths[u32(at.y) * {}u + u32(at.x)];
        }}",
        size.0
    );
    let source = wgpu::ShaderSource::Wgsl(source.into());
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let format = wgpu::TextureFormat::Depth32Float;
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("depth"),
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let buffer = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(depths),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    });
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    let view = gpu.device.create_texture(&descriptor(size, format, usage)).create_view(&Default::default());
    run(gpu, |encoder| {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    });
    view
}

/// The pixels of a picture that `draw` fills.
pub fn picture_of(
    gpu: &Gpu,
    size: (usize, usize),
    draw: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::TextureView),
) -> Vec<[f32; 4]> {
    let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC;
    let picture = gpu.device.create_texture(&descriptor(size, wgpu::TextureFormat::Rgba32Float, usage));
    let row = (16 * size.0).next_multiple_of(256);
    let buffer = gpu.buffer((row * size.1) as u64, wgpu::BufferUsages::COPY_DST).unwrap();
    run(gpu, |encoder| {
        draw(encoder, &picture.create_view(&Default::default()));
        let bytes_per_row = Some(row as u32);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
        let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(picture.as_image_copy(), target, picture.size());
    });
    let all = read(gpu, &buffer);
    all.chunks(row / 16).flat_map(|row| &row[..size.0]).copied().collect()
}

/// A coloured room with a box in it, under a sky that a hole in the ceiling lets in.
pub fn furnished() -> Scene {
    let mut all = room(Vec3::ZERO, Vec3::new(4.0, 3.0, 4.0), 0);
    // The ceiling is the second half of the room's sheets; one of its triangles goes.
    let ceiling = all.iter().position(|t| t.corners.iter().all(|p| p.y == 3.0)).unwrap();
    all.remove(ceiling);
    all.iter_mut().filter(|t| t.corners.iter().all(|p| p.x == 0.0)).for_each(|t| t.material = 1);
    all.extend(cuboid(Vec3::new(1.2, 0.0, 1.0), Vec3::new(2.3, 1.1, 2.2), 1));
    let mut red = matt(0.6);
    red.albedo = Vec3::new(0.7, 0.2, 0.1);
    let lights = vec![lamp(Vec3::new(3.0, 2.0, 0.6), 9.0)];
    scene(all, vec![matt(0.7), red], lights, 1.0)
}

/// Points on walls, the floor and the box.
pub fn points() -> Vec<(Vec3, Vec3)> {
    let mut all = Vec::new();
    for i in 0..120 {
        let (u, v) = ((i as f32 + 0.5) / 120.0, (i as f32 * 0.618 + 0.3).fract());
        all.push((Vec3::new(4.0 * u, 0.0, 4.0 * v), Vec3::Y));
        all.push((Vec3::new(0.0, 3.0 * u, 4.0 * v), Vec3::X));
        all.push((Vec3::new(4.0 * v, 3.0 * u, 4.0), -Vec3::Z));
        all.push((Vec3::new(1.2 + 1.1 * u, 1.1, 1.0 + 1.2 * v), Vec3::Y));
    }
    all
}
