//! Pictures of light.

use casca_radiosity::gpu::{Answers, GpuCache};
use glam::Vec3;

use crate::common::{lit, matt, scene};
use crate::device::{furnished, points, shaded};
use casca_stage::gpu::Gpu;

#[test]
fn pictures_of_the_device_have_the_light_of_answers() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut cache = lit(&furnished(), 25, 32, 20);
    // Normals that are not those of the surfaces weigh heights and normals.
    let turned = |(i, (p, n)): (usize, (Vec3, Vec3))| {
        let way = n.any_orthonormal_vector() * [0.4, 0.9, -0.9][i % 3];
        (p, (n + way).normalize())
    };
    let points: Vec<_> = points().into_iter().enumerate().map(turned).collect();
    // As passes leave it, and smoothed.
    for times in [0, 2] {
        cache.smooth(times);
        let light = GpuCache::new(&gpu.device, &cache).unwrap();
        let found = shaded(&gpu, &light, Answers::Indirect, &points);
        let mut errors = Vec::new();
        for ((p, n), device) in points.iter().zip(&found) {
            let answer = cache.irradiance(*p, *n).unwrap();
            assert_eq!(device[3] == 1.0, answer.states > 0, "{p}");
            if answer.states > 0 {
                let way = Vec3::from_slice(device) - answer.indirect;
                errors.push(f64::from(way.length() / answer.indirect.length()));
            }
        }
        let worst = errors.iter().copied().fold(0.0, f64::max);
        let mean = errors.iter().sum::<f64>() / found.len() as f64;
        println!("pictures: worst {worst:e}, mean {mean:e}, {} of {} with states", errors.len(), found.len());
        assert!(worst < 1e-3 && mean < 1e-5, "{worst} {mean}");
    }
}

#[test]
fn an_empty_scene_is_dark_on_the_device() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&scene(vec![], vec![matt(0.5)], vec![], 1.0), 8, 4, 1);
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    let far = Vec3::splat(1e30);
    let points = [(Vec3::ZERO, Vec3::Y), (far, Vec3::Y)];
    for answers in [Answers::Indirect, Answers::All] {
        assert_eq!(shaded(&gpu, &light, answers, &points), [[0.0; 4]; 2]);
    }
}
