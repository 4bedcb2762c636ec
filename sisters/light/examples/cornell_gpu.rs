//! The Cornell box with bounces by the graphics processor, beside the processor's, without a
//! window: `cornell_gpu [FILE.png] [N]`. Positions and normals are those of an application's own
//! pass; here a ray for each pixel gives them.

use std::error::Error;
use std::f32::consts::PI;
use std::path::Path;
use std::time::Instant;

use casca_radiosity::gpu::{Answers, GpuCache, Input, Shading, Surfaces};
use casca_radiosity::lit::Kind;
use casca_radiosity::lit::path::PathTracer;
use casca_radiosity::{Cache, Grid, Scene, Settings};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu::util::{DeviceExt, TextureDataOrder};
use casca_stage::wgpu::{self, TextureUsages};
use casca_tools::image::write_png;
use glam::Vec3;

/// Rows of a picture of floats are 256 bytes times a whole number: 16 pixels.
const SIZE: (usize, usize) = (320, 240);
const EXPOSURE: f32 = 2.0;
/// The processor passes until light changes by less, which no picture shows; so often at most.
const SETTLED: f64 = 1e-4;
const MOST_PASSES: u32 = 40;

fn byte(light: f32) -> u8 {
    let shown = 1.0 - (-EXPOSURE * light.max(0.0)).exp();
    (255.0 * shown.powf(1.0 / 2.2)) as u8
}

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments.first().map_or("cornell_gpu.png", |p| p);
    let cells = arguments.get(1).map_or(Ok(64), |n| n.parse())?;
    let lit = "cornell-point".parse::<Kind>()?.build();
    let scene = Scene::from(&lit);
    let surfaces = PathTracer::new(&lit).surfaces(&lit.camera, SIZE)?;
    let mut cache = Cache::new(&scene, Settings::new(Grid::around(&scene.objects, cells)))?;
    for s in surfaces.iter().flatten() {
        cache.request(s.point.as_vec3(), s.normal.as_vec3())?;
    }
    cache.gather(64)?;
    cache.direct();

    // The device passes the light, and looks it up for each pixel.
    let gpu = Gpu::headless(false)?;
    let mut on_device = GpuCache::new(&gpu.device, &cache)?;
    let extent = wgpu::Extent3d { width: SIZE.0 as u32, height: SIZE.1 as u32, depth_or_array_layers: 1 };
    let descriptor = |usage| wgpu::TextureDescriptor {
        label: None,
        size: extent,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage,
        view_formats: &[],
    };
    let given = descriptor(TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let view = |pixel: &dyn Fn(usize) -> [f32; 4]| {
        let all: Vec<[f32; 4]> = (0..surfaces.len()).map(pixel).collect();
        let bytes = bytemuck::cast_slice(&all);
        let order = TextureDataOrder::LayerMajor;
        let texture = gpu.device.create_texture_with_data(&gpu.queue, &given, order, bytes);
        texture.create_view(&Default::default())
    };
    let positions = view(&|i| surfaces[i].map_or([0.0; 4], |s| s.point.as_vec3().extend(1.0).to_array()));
    let normals = view(&|i| surfaces[i].map_or([0.0; 4], |s| s.normal.as_vec3().extend(0.0).to_array()));
    let made =
        gpu.device.create_texture(&descriptor(TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC));
    let row = 16 * SIZE.0;
    let buffer = gpu.buffer((row * SIZE.1) as u64, wgpu::BufferUsages::COPY_DST)?;
    let clock = Instant::now();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    on_device.pass(&mut encoder, 24);
    let shading = Shading::new(&gpu.device, Input::Positions, Answers::All);
    let surfaces_drawn =
        Surfaces { place: &positions, normals: &normals, inverse: glam::Mat4::IDENTITY, empty: 1.0 };
    let view = made.create_view(&Default::default());
    on_device.shade(&gpu.device, &mut encoder, &shading, surfaces_drawn, &view);
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(made.as_image_copy(), target, extent);
    gpu.queue.submit([encoder.finish()]);
    let light: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&buffer)?);
    println!("{}: 24 passes and a picture in {:.1} ms", gpu.name, clock.elapsed().as_secs_f64() * 1e3);

    cache.converge(SETTLED, MOST_PASSES);
    let mut pixels = vec![0; 8 * SIZE.0 * SIZE.1];
    let (mut apart, mut sum) = (0.0, 0.0);
    for (i, s) in surfaces.iter().enumerate().filter_map(|(i, s)| s.map(|s| (i, s))) {
        let answer = cache.irradiance(s.point.as_vec3(), s.normal.as_vec3())?;
        let (found, known) = (Vec3::from_slice(&light[i]), answer.direct + answer.indirect);
        apart += (found - known).length();
        sum += known.length();
        let factor = lit.materials[s.material].albedo / PI;
        for (side, light) in [found, known].into_iter().enumerate() {
            let at = 4 * (i / SIZE.0 * 2 * SIZE.0 + side * SIZE.0 + i % SIZE.0);
            let shown = factor * light;
            pixels[at..at + 3].copy_from_slice(&shown.to_array().map(byte));
        }
    }
    println!("left: device, right: processor; mean difference {:.1e} of the light", apart / sum);
    write_png(Path::new(path), (2 * SIZE.0 as u32, SIZE.1 as u32), &pixels)?;
    Ok(())
}
