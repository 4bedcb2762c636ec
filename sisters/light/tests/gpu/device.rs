//! A device, and what tests draw with it.

use casca_radiosity::gpu::{Answers, Gloss, GpuCache, Mirrors, Shading, Surfaces};
use casca_radiosity::{Light, Material, Scene};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu::{self, TextureUsages};
use glam::Vec3;

use crate::common::{cuboid, holed, lamp, matt, painted, room, scene, sheet};

/// Points lie in rows of so many pixels, so that groups of pixels lie along both axes. Rows of
/// copies take multiples of 256 bytes.
const WIDE: usize = 48;

fn descriptor(count: usize, usage: TextureUsages) -> wgpu::TextureDescriptor<'static> {
    let (width, height) = (WIDE as u32, count.div_ceil(WIDE) as u32);
    wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage,
        view_formats: &[],
    }
}

/// A texture of four numbers for each point.
pub fn texture_of<T>(gpu: &Gpu, points: &[T], of: impl Fn(&T) -> [f32; 4]) -> wgpu::TextureView {
    use wgpu::util::DeviceExt;
    let mut values: Vec<[f32; 4]> = points.iter().map(of).collect();
    values.resize(values.len().next_multiple_of(WIDE), [0.0; 4]);
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &descriptor(points.len(), TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST),
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(&values),
    );
    texture.create_view(&Default::default())
}

/// The first pixels of a picture that `draw` fills.
pub fn picture_of(
    gpu: &Gpu,
    count: usize,
    draw: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::TextureView),
) -> Vec<[f32; 4]> {
    let usage = TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC;
    let picture = gpu.device.create_texture(&descriptor(count, usage));
    let row = 16 * WIDE as u32;
    let buffer = gpu.buffer(u64::from(row * picture.height()), wgpu::BufferUsages::COPY_DST).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    draw(&mut encoder, &picture.create_view(&Default::default()));
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), target, picture.size());
    gpu.queue.submit([encoder.finish()]);
    let mut all: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&buffer).unwrap());
    all.truncate(count);
    all
}

/// The pictures of points and of their normals.
pub fn drawn(gpu: &Gpu, points: &[(Vec3, Vec3)]) -> [wgpu::TextureView; 2] {
    let place = texture_of(gpu, points, |p| p.0.extend(1.0).to_array());
    [place, texture_of(gpu, points, |p| p.1.extend(0.0).to_array())]
}

/// The light of points with normals.
pub fn shaded(gpu: &Gpu, light: &GpuCache, answers: Answers, points: &[(Vec3, Vec3)]) -> Vec<[f32; 4]> {
    let [place, normals] = &drawn(gpu, points);
    let shading = Shading::new(&gpu.device, answers);
    picture_of(gpu, points.len(), |encoder, view| {
        light.shade(&gpu.device, encoder, &shading, Surfaces { place, normals }, view);
    })
}

/// A point of a mirroring surface, its normal and the width of its lobe.
pub type Mirroring = (Vec3, Vec3, f32);

/// What points mirror towards an eye by so many rays.
pub fn mirrored(gpu: &Gpu, light: &GpuCache, points: &[Mirroring], eye: Vec3, rays: u32) -> Vec<[f32; 4]> {
    let [place, normals] = &drawn(gpu, &points.iter().map(|p| (p.0, p.1)).collect::<Vec<_>>());
    // Other components are read by nobody.
    let roughness = &texture_of(gpu, points, |p| [p.2, f32::NAN, -1.0, 7.0]);
    let mirrors = Mirrors::new(&gpu.device);
    picture_of(gpu, points.len(), |encoder, view| {
        let gloss = Gloss { roughness, eye, rays };
        light.mirror(&gpu.device, encoder, &mirrors, Surfaces { place, normals }, gloss, view).unwrap();
    })
}

/// A long hall with a screen in its middle that has a hole: walls, the screen and the wall at the
/// far end have a material each.
pub fn hall(materials: Vec<Material>, lights: Vec<Light>) -> Scene {
    let mut all = room(Vec3::ZERO, Vec3::new(40.0, 4.0, 4.0), 0);
    all.extend(sheet(Vec3::new(20.0, 0.0, 0.0), Vec3::Y * 4.0, Vec3::Z * 2.0, 1));
    all.iter_mut().filter(|t| t.corners.iter().all(|p| p.x == 40.0)).for_each(|t| t.material = 2);
    scene(all, materials, lights, 0.0)
}

/// Points of the wall at its near end.
pub fn in_hall() -> Vec<(Vec3, Vec3)> {
    let at = |i: usize| Vec3::new(0.0, 0.05 * i as f32 + 0.02, (0.618 * i as f32).fract() * 4.0);
    (0..80).map(|i| (at(i), Vec3::X)).collect()
}

/// A coloured room with a box and a screen full of holes in it, under a sky that a hole in the ceiling lets in.
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
    let paint = Material { texture: Some(0), ..matt(0.8) };
    let mut scene = Scene { textures: vec![holed()], ..scene(all, vec![matt(0.7), red, paint], lights, 1.0) };
    scene.objects.push(painted(sheet(Vec3::new(2.6, 0.0, 0.5), Vec3::Y * 1.5, Vec3::Z * 2.0, 2), 3.0));
    scene
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
