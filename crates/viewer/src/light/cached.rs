//! Pictures of a scene's matt light with all of its bounces, by the radiosity cache.

use std::error::Error;
use std::f32::consts::PI;

use casca_radiosity::gpu::{Answers, GpuCache, Input, Shading, Surfaces};
use casca_radiosity::{Cache, Grid, Scene, Settings};
use casca_scenes::lit::{HdrImage, LitScene};
use casca_scenes::world::Camera;
use casca_stage::command_line::{make_folder, say};
use casca_stage::gpu::Gpu;
use casca_stage::image::write_png;
use casca_stage::wgpu::util::{DeviceExt, TextureDataOrder};
use casca_stage::wgpu::{self, TextureUsages};
use casca_truth::oracle::path::{PathTracer, Surface};
use glam::{Mat4, Vec3};

use crate::light::headless::compare;
use crate::light::options::Options;
use crate::light::scene::Start;

/// Rays of the states that pixels read, of those which these read, and of all others.
const RAYS: [u32; 3] = [64, 32, 16];
/// Passes of the device; halls as white as 0.7 keep 1e-4 of the light after so many.
const PASSES: u32 = 26;
/// Means over neighbouring states: two take most blotches of so many rays.
const MEANS: u32 = 2;

/// Draws the picture into a file, and beside the path tracer's.
pub fn picture(gpu: &Gpu, start: &Start, options: &Options) -> Result<(), Box<dyn Error>> {
    let out = options.common.folder("light");
    make_folder(&out)?;
    let (width, height) = options.common.drawing.size;
    let camera = start.camera((width, height));
    let mut scene = start.scene.clone();
    // The cache has no light for what mirrors.
    scene.materials.iter_mut().for_each(|m| m.specular = Vec3::ZERO);
    let found = HdrImage::new(width as usize, height as usize, light(gpu, &scene, &camera, options)?)?;
    let path = out.join(format!("{}-cached.png", scene.name));
    let pixels: Vec<u8> =
        found.srgb(options.exposure).chunks(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
    write_png(&path, (width, height), &pixels)?;
    say(path.display());
    if options.truth > 0 {
        let path = out.join(format!("{}-cached-beside-truth.png", scene.name));
        let caption = format!("Radiosity cache: {} cells", options.resolution);
        compare(&path, &scene, options, (&camera, &found), (caption, u32::MAX))?;
    }
    Ok(())
}

/// The light of each pixel.
fn light(gpu: &Gpu, lit: &LitScene, camera: &Camera, options: &Options) -> Result<Vec<Vec3>, Box<dyn Error>> {
    let (width, height) = options.common.drawing.size;
    let shown = PathTracer::new(lit).surfaces(camera, (width as usize, height as usize))?;
    let scene = Scene::from(lit);
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u32);
    let grid = Grid::around(&scene.objects, options.resolution);
    let mut cache = Cache::new(&scene, Settings { threads, ..Settings::new(grid) })?;
    for s in shown.iter().flatten() {
        cache.request(s.point.as_vec3(), s.normal.as_vec3())?;
    }
    let mut ring = 0;
    while cache.gather_ring(RAYS[ring])? > 0 {
        ring = (ring + 1).min(RAYS.len() - 1);
    }
    cache.direct();
    let s = cache.statistics();
    say(format_args!(
        "{}: {} cells along the longest axis, {} of {} states gathered, {} rays, {:.1} MB",
        lit.name,
        options.resolution,
        s.gathered,
        2 * s.entries,
        s.rays,
        s.bytes as f64 / 1e6
    ));
    let irradiance = by_device(gpu, &cache, &shown, (width, height))?;
    let pixel = |(s, light): (&Option<Surface>, &[f32; 4])| match s {
        None => lit.sky,
        Some(s) => {
            let material = &lit.materials[s.material];
            material.emission + material.albedo / PI * Vec3::from_slice(light)
        }
    };
    Ok(shown.iter().zip(&irradiance).map(pixel).collect())
}

/// Passes and the irradiance of all pixels, on the device.
fn by_device(
    gpu: &Gpu,
    cache: &Cache,
    shown: &[Option<Surface>],
    (width, height): (u32, u32),
) -> Result<Vec<[f32; 4]>, Box<dyn Error>> {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let descriptor = |usage| wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage,
        view_formats: &[],
    };
    let given = descriptor(TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let upload = |of: &dyn Fn(&Surface) -> [f32; 4]| {
        let pixels: Vec<[f32; 4]> = shown.iter().map(|s| s.as_ref().map_or([0.0; 4], of)).collect();
        let bytes = bytemuck::cast_slice(&pixels);
        let texture =
            gpu.device.create_texture_with_data(&gpu.queue, &given, TextureDataOrder::LayerMajor, bytes);
        texture.create_view(&Default::default())
    };
    let place = upload(&|s| s.point.as_vec3().extend(1.0).to_array());
    let normals = upload(&|s| s.normal.as_vec3().extend(0.0).to_array());
    let made =
        gpu.device.create_texture(&descriptor(TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC));
    let row = (16 * width).next_multiple_of(256);
    let buffer = gpu.buffer(u64::from(row) * u64::from(height), wgpu::BufferUsages::COPY_DST)?;
    let mut on_device = GpuCache::new(&gpu.device, cache)?;
    let shading = Shading::new(&gpu.device, Input::Positions, Answers::All);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    on_device.link(&gpu.device, cache)?;
    on_device.pass(&mut encoder, PASSES);
    on_device.smooth(&mut encoder, MEANS);
    let surfaces = Surfaces { place: &place, normals: &normals, inverse: Mat4::IDENTITY, empty: 1.0 };
    let view = made.create_view(&Default::default());
    on_device.shade(&gpu.device, &mut encoder, &shading, surfaces, &view);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(made.as_image_copy(), target, size);
    gpu.queue.submit([encoder.finish()]);
    let all: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&buffer)?);
    Ok(all.chunks(row as usize / 16).flat_map(|row| &row[..width as usize]).copied().collect())
}
