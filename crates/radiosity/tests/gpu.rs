//! The graphics processor beside the processor.

mod common;

use casca_radiosity::gpu::{GpuCache, GpuError};
use casca_radiosity::{Cache, Grid, Scene, Settings, Sky};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu;
use common::{cuboid, indirect, lamp, lit, matt, room, rooms, scene};
use glam::Vec3;

/// Passes of the device until nothing changes: 0.7 to the power of 64 is 1e-10.
const PASSES: u32 = 64;

/// The processor passes until nothing changes by more than single precision rounds; it stops before
/// so many.
const SETTLED: f64 = 1e-7;
const MOST_PASSES: u32 = 200;

fn gpu() -> Option<Gpu> {
    Gpu::headless(false).map_err(|why| println!("skipped: no adapter: {why}")).ok()
}

fn run(gpu: &Gpu, work: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    work(&mut encoder);
    gpu.queue.submit([encoder.finish()]);
}

fn read(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<[f32; 4]> {
    bytemuck::pod_collect_to_vec(&gpu.read_buffer(buffer).unwrap())
}

/// The light of points with normals, by a picture of one row.
fn shaded(gpu: &Gpu, light: &GpuCache, points: &[(Vec3, Vec3)]) -> Vec<[f32; 4]> {
    use wgpu::util::DeviceExt;
    let size = wgpu::Extent3d { width: points.len() as u32, height: 1, depth_or_array_layers: 1 };
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
    let upload = |values: Vec<[f32; 4]>| {
        let descriptor = descriptor(wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST);
        let texture = gpu.device.create_texture_with_data(
            &gpu.queue,
            &descriptor,
            wgpu::util::TextureDataOrder::LayerMajor,
            bytemuck::cast_slice(&values),
        );
        texture.create_view(&Default::default())
    };
    let positions = upload(points.iter().map(|p| p.0.extend(1.0).to_array()).collect());
    let normals = upload(points.iter().map(|p| p.1.extend(0.0).to_array()).collect());
    let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC;
    let picture = gpu.device.create_texture(&descriptor(usage));
    let row = (16 * size.width).next_multiple_of(256);
    let buffer = gpu.buffer(u64::from(row), wgpu::BufferUsages::COPY_DST).unwrap();
    run(gpu, |encoder| {
        let view = picture.create_view(&Default::default());
        light.shade(&gpu.device, encoder, [&positions, &normals, &view]);
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(picture.as_image_copy(), target, size);
    });
    read(gpu, &buffer)[..points.len()].to_vec()
}

/// A coloured room with a box in it, under a sky that a hole in the ceiling lets in.
fn furnished() -> Scene {
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
fn points() -> Vec<(Vec3, Vec3)> {
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

/// The greatest difference of the indirect light of all states, over the mean.
fn apart(gpu: &Gpu, light: &GpuCache, cache: &Cache) -> f64 {
    // The cache answers at states only: two caches with the light of each are asked.
    let mut other = cache.clone();
    light.read_back(&mut other, &read(gpu, light.indirect())).unwrap();
    let of = |c: &Cache| points().iter().map(|(p, n)| indirect(c, *p, *n)).collect::<Vec<_>>();
    let (a, b) = (of(cache), of(&other));
    let mean = a.iter().sum::<f64>() / a.len() as f64;
    assert!(mean > 0.1);
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / mean
}

#[test]
fn passes_on_the_device_end_in_the_same_light() {
    let Some(gpu) = gpu() else { return };
    let mut cache = lit(&furnished(), 24, 32, 0);
    let mut light = GpuCache::new(&gpu.device, &cache).unwrap();
    cache.converge(SETTLED, MOST_PASSES);
    // A pass at a time, and many at once, from both halves.
    run(&gpu, |encoder| light.pass(encoder, 1));
    assert!(apart(&gpu, &light, &cache) > 0.1, "one pass is not all light");
    run(&gpu, |encoder| light.pass(encoder, PASSES));
    let found = apart(&gpu, &light, &cache);
    println!("passes: {found:e}");
    assert!(found < 1e-5, "{found}");
    // Other lights and another sky.
    cache.set_lights(&[lamp(Vec3::new(0.6, 0.4, 3.3), 20.0)]).unwrap();
    cache.set_sky(Sky::Even(Vec3::new(0.1, 0.5, 2.0))).unwrap();
    cache.direct();
    run(&gpu, |encoder| light.set_direct(&gpu.queue, encoder, &cache).unwrap());
    cache.converge(SETTLED, MOST_PASSES);
    assert!(apart(&gpu, &light, &cache) > 0.1);
    run(&gpu, |encoder| light.pass(encoder, PASSES));
    let found = apart(&gpu, &light, &cache);
    println!("after other lights: {found:e}");
    assert!(found < 1e-5, "{found}");
}

#[test]
fn other_direct_light_is_sent_with_the_light_that_is_there() {
    let Some(gpu) = gpu() else { return };
    let cache = lit(&furnished(), 16, 16, 60);
    let mut light = GpuCache::new(&gpu.device, &cache).unwrap();
    // Nothing changed, so that one pass changes nothing, whichever half it reads.
    for _ in 0..3 {
        run(&gpu, |encoder| {
            light.set_direct(&gpu.queue, encoder, &cache).unwrap();
            light.pass(encoder, 1);
        });
        assert!(apart(&gpu, &light, &cache) < 1e-5);
    }
    // The next pass reads other direct light with the indirect light of before, as a fresh upload does.
    let mut cache = cache;
    cache.set_lights(&[lamp(Vec3::new(0.6, 0.4, 3.3), 20.0)]).unwrap();
    cache.direct();
    let mut fresh = GpuCache::new(&gpu.device, &cache).unwrap();
    run(&gpu, |encoder| {
        light.set_direct(&gpu.queue, encoder, &cache).unwrap();
        light.pass(encoder, 1);
        fresh.pass(encoder, 1);
    });
    let [a, b] = [&light, &fresh].map(|l| read(&gpu, l.indirect()));
    let largest = a.iter().zip(&b).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f32::max);
    assert!(largest < 1e-4, "{largest}");
    // A cache with fewer gathered states is not the one on the device.
    let grid = Grid::around(&furnished().objects, 16);
    let mut other = Cache::new(&furnished(), Settings::new(grid)).unwrap();
    other.request(Vec3::new(2.0, 0.0, 3.0), Vec3::Y).unwrap();
    other.gather_ring(4).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let refused = light.set_direct(&gpu.queue, &mut encoder, &other);
    assert!(matches!(refused, Err(GpuError::Changed { .. })));
}

#[test]
fn pictures_of_the_device_have_the_light_of_answers() {
    let Some(gpu) = gpu() else { return };
    let cache = lit(&furnished(), 25, 32, 20);
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    // Normals that are not those of the surfaces weigh heights and normals.
    let turned = |(i, (p, n)): (usize, (Vec3, Vec3))| {
        let way = n.any_orthonormal_vector() * [0.4, 0.9, -0.9][i % 3];
        (p, (n + way).normalize())
    };
    let points: Vec<_> = points().into_iter().enumerate().map(turned).collect();
    let found = shaded(&gpu, &light, &points);
    let (mut worst, mut sum, mut unseen) = (0.0_f64, 0.0, 0);
    for ((p, n), device) in points.iter().zip(&found) {
        let answer = cache.irradiance(*p, *n).unwrap();
        assert_eq!(device[3] == 1.0, answer.states > 0, "{p}");
        if answer.states == 0 {
            unseen += 1;
            continue;
        }
        let way = Vec3::from_slice(device) - answer.indirect;
        worst = worst.max(f64::from(way.length() / answer.indirect.length()));
        sum += f64::from(way.length() / answer.indirect.length());
    }
    let mean = sum / found.len() as f64;
    println!("pictures: worst {worst:e}, mean {mean:e}, {unseen} of {} without states", found.len());
    assert!(worst < 1e-3 && mean < 1e-5, "{worst} {mean}");
}

#[test]
fn the_room_behind_a_wall_is_dark_in_pictures() {
    let Some(gpu) = gpu() else { return };
    for thickness in [0.0, 0.02, 0.2] {
        let light = vec![lamp(Vec3::new(-2.0, 2.0, 0.3), 10.0)];
        let cache = lit(&scene(rooms(thickness), vec![matt(0.7)], light, 0.0), 32, 16, 4);
        let device = GpuCache::new(&gpu.device, &cache).unwrap();
        let at = |side: f32| {
            let of = move |i: usize| {
                let (u, v) = ((i as f32 + 0.3) / 60.0, (i as f32 * 0.618).fract());
                let wall = side * 0.5 * thickness;
                let z = -1.9 + 3.8 * v;
                match i % 2 {
                    0 => (Vec3::new(wall + side * (0.001 + u), 0.0, z), Vec3::Y),
                    _ => (Vec3::new(wall, 0.05 + 2.9 * u, z), Vec3::X * side),
                }
            };
            (0..60).map(of).collect::<Vec<_>>()
        };
        let total = |side| shaded(&gpu, &device, &at(side)).iter().map(|p| p[0]).sum::<f32>();
        assert!(total(-1.0) > 10.0, "{}", total(-1.0));
        assert_eq!(total(1.0), 0.0, "{thickness}");
    }
}

#[test]
fn the_function_works_in_a_shader_of_the_application() {
    let Some(gpu) = gpu() else { return };
    let cache = lit(&furnished(), 16, 16, 8);
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    let mine = "@group(0) @binding(0) var<storage, read_write> found: vec4f;
        @compute @workgroup_size(1) fn ask() { found = casca_irradiance(vec3f(3.0, 0.0, 3.0), vec3f(0.0, 1.0, 0.0)); }";
    let source = wgpu::ShaderSource::Wgsl((GpuCache::wgsl(2) + mine).into());
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("ask"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = gpu.buffer(16, wgpu::BufferUsages::STORAGE).unwrap();
    let own = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    });
    let lookup = light.bind_group(&gpu.device, &pipeline.get_bind_group_layout(2));
    run(&gpu, |encoder| {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &own, &[]);
        pass.set_bind_group(2, &lookup, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    });
    let (found, truth) =
        (read(&gpu, &buffer)[0], cache.irradiance(Vec3::new(3.0, 0.0, 3.0), Vec3::Y).unwrap().indirect);
    assert!((Vec3::from_slice(&found) - truth).length() < 1e-4 * truth.length(), "{found:?} {truth}");
}

#[test]
fn an_empty_scene_is_dark_on_the_device() {
    let Some(gpu) = gpu() else { return };
    let cache = lit(&scene(vec![], vec![matt(0.5)], vec![], 1.0), 8, 4, 1);
    let mut light = GpuCache::new(&gpu.device, &cache).unwrap();
    run(&gpu, |encoder| light.pass(encoder, 2));
    let far = Vec3::splat(1e30);
    assert_eq!(shaded(&gpu, &light, &[(Vec3::ZERO, Vec3::Y), (far, Vec3::Y)]), [[0.0; 4]; 2]);
}
