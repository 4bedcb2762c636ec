//! Pictures of light, and the functions in shaders of the application.

use casca_radiosity::gpu::{Answers, GpuCache};
use casca_stage::wgpu;
use glam::Vec3;

use crate::common::{lamp, lit, matt, rooms, scene};
use crate::device::{furnished, points, read, run, shaded};
use casca_stage::gpu::Gpu;

#[test]
fn pictures_of_the_device_have_the_light_of_answers() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&furnished(), 25, 32, 20);
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    // Normals that are not those of the surfaces weigh heights and normals.
    let turned = |(i, (p, n)): (usize, (Vec3, Vec3))| {
        let way = n.any_orthonormal_vector() * [0.4, 0.9, -0.9][i % 3];
        (p, (n + way).normalize())
    };
    let points: Vec<_> = points().into_iter().enumerate().map(turned).collect();
    let found = shaded(&gpu, &light, Answers::Indirect, &points);
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
    let Some(gpu) = Gpu::for_tests() else { return };
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
        let total = |side| shaded(&gpu, &device, Answers::All, &at(side)).iter().map(|p| p[0]).sum::<f32>();
        assert!(total(-1.0) > 10.0, "{}", total(-1.0));
        assert_eq!(total(1.0), 0.0, "{thickness}");
    }
}

#[test]
fn the_function_works_in_a_shader_of_the_application() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&furnished(), 16, 16, 8);
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    let mine = "@group(0) @binding(0) var<storage, read_write> found: vec4f;
        @compute @workgroup_size(1) fn ask() { found = casca_irradiance(vec3f(3.0, 0.0, 3.0), vec3f(0.0, 1.0, 0.0)); }";
    let source = wgpu::ShaderSource::Wgsl((GpuCache::wgsl(2, Answers::Indirect) + mine).into());
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
    let lookup = light.bind_group(&gpu.device, &pipeline.get_bind_group_layout(2), Answers::Indirect);
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
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&scene(vec![], vec![matt(0.5)], vec![], 1.0), 8, 4, 1);
    let mut light = GpuCache::new(&gpu.device, &cache).unwrap();
    run(&gpu, |encoder| light.pass(encoder, 2));
    let far = Vec3::splat(1e30);
    let points = [(Vec3::ZERO, Vec3::Y), (far, Vec3::Y)];
    for answers in [Answers::Indirect, Answers::All] {
        assert_eq!(shaded(&gpu, &light, answers, &points), [[0.0; 4]; 2]);
    }
}

#[test]
fn the_device_smooths_as_the_processor_does() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut cache = lit(&furnished(), 25, 16, 12);
    let mut light = GpuCache::new(&gpu.device, &cache).unwrap();
    let points = points();
    let apart = |light: &GpuCache, cache: &casca_radiosity::Cache| {
        let found = shaded(&gpu, light, Answers::Indirect, &points);
        let of = |((p, n), found): (&(Vec3, Vec3), &[f32; 4])| {
            let known = cache.irradiance(*p, *n).unwrap();
            // Without states, the processor sends rays.
            let error = (Vec3::from_slice(found) - known.indirect).length() / known.indirect.length();
            if known.states > 0 { error } else { 0.0 }
        };
        points.iter().zip(&found).map(of).fold(0.0, f32::max)
    };
    // Before links are there, nothing is smoothed.
    run(&gpu, |encoder| light.smooth(encoder, 2));
    assert!(apart(&light, &cache) < 1e-3);
    light.link(&gpu.device, &cache).unwrap();
    for times in [1, 2, 3, 0] {
        let before = cache.clone();
        cache.smooth(times);
        run(&gpu, |encoder| light.smooth(encoder, times));
        let found = apart(&light, &cache);
        println!("smoothed {times} times: {found:e}");
        assert!(found < 1e-3, "{times}: {found}");
        assert!(apart(&light, &before) > 0.01, "{times}");
    }
    // Passes show their own light.
    cache.smooth(2);
    run(&gpu, |encoder| {
        light.smooth(encoder, 2);
        light.pass(encoder, 60);
    });
    cache.converge(1e-7, 200);
    assert!(apart(&light, &cache) < 1e-3);
}
