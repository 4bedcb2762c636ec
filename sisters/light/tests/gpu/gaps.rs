//! Gaps of pictures, filled by rays.

use casca_radiosity::gpu::{Answers, Gaps, GpuCache, Surfaces};
use casca_radiosity::{Cache, Grid, Settings};
use casca_stage::gpu::Gpu;
use glam::Vec3;

use crate::common::{lamp, matt, rooms, scene};
use crate::device::{drawn, furnished, picture_of, points, shaded, texture_of};

/// Passes end with the first that changes less than this share of the light, far below the 3% that
/// tests allow, and after so many.
const SETTLED: f64 = 1e-4;
const MOST_PASSES: u32 = 20;

/// Points with normals, of which a picture has been made, after the gaps were filled.
fn filled(gpu: &Gpu, light: &GpuCache, points: &[(Vec3, Vec3)], rays: u32) -> Vec<[f32; 4]> {
    let before = texture_of(gpu, &shaded(gpu, light, Answers::Indirect, points), |p| *p);
    let ([place, normals], gaps) = (&drawn(gpu, points), Gaps::new(&gpu.device));
    picture_of(gpu, points.len(), |encoder, view| {
        let surfaces = Surfaces { place, normals };
        light.fill(&gpu.device, encoder, (&gaps, rays), surfaces, (&before, view)).unwrap();
    })
}

#[test]
fn gaps_have_the_light_that_rays_of_the_processor_find() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let scene = furnished();
    let settings = Settings { answer_rays: 512, ..Settings::new(Grid::around(&scene.objects, 20)) };
    let mut cache = Cache::new(&scene, settings).unwrap();
    // States of the floor alone: nothing stands for walls and the box.
    for (p, n) in points().into_iter().filter(|(p, n)| *n == Vec3::Y && p.y == 0.0) {
        cache.request(p, n).unwrap();
    }
    cache.gather_part((64, 64), usize::MAX).unwrap();
    cache.direct();
    cache.converge(SETTLED, MOST_PASSES);
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    let found = filled(&gpu, &light, &points(), 64);
    let (mut gaps, mut sums) = (0, [Vec3::ZERO; 2]);
    for ((p, n), pixel) in points().iter().zip(&found) {
        let answer = cache.irradiance(*p, *n).unwrap();
        assert_eq!(pixel[3], if answer.states > 0 { 1.0 } else { 0.5 }, "{p}");
        if answer.states == 0 {
            gaps += 1;
            sums[0] += Vec3::from_slice(pixel);
            sums[1] += answer.indirect;
        }
    }
    let off = (sums[0] - sums[1]).abs() / sums[1];
    println!("{gaps} gaps: {} and {}, off by {off}", sums[0], sums[1]);
    assert!(gaps > 200 && sums[1].min_element() > 1.0);
    assert!(off.max_element() < 0.03, "{off}");
}

#[test]
fn rays_of_gaps_cross_no_wall_and_see_no_lamp_twice() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for thickness in [0.0, 0.02] {
        let lights = vec![lamp(Vec3::new(-2.0, 2.0, 0.3), 10.0)];
        let scene = scene(rooms(thickness), vec![matt(0.7)], lights, 0.0);
        let mut cache = Cache::new(&scene, Settings::new(Grid::around(&scene.objects, 32))).unwrap();
        // The lit room only, so that all pixels of the other one are gaps.
        cache.request(Vec3::new(-2.0, 0.0, 0.0), Vec3::Y).unwrap();
        cache.gather(16).unwrap();
        cache.direct();
        cache.converge(SETTLED, MOST_PASSES);
        let light = GpuCache::new(&gpu.device, &cache).unwrap();
        let at = |i: usize| {
            let (u, v) = ((i as f32 + 0.3) / 60.0, (i as f32 * 0.618).fract());
            (Vec3::new(0.5 * thickness, 0.05 + 2.9 * u, 3.8 * v - 1.9), Vec3::X)
        };
        let dark = filled(&gpu, &light, &(0..60).map(at).collect::<Vec<_>>(), 32);
        assert!(dark.iter().all(|p| *p == [0.0, 0.0, 0.0, 0.5]), "{thickness}");
    }
    // Black walls that shine: all light is direct.
    let mut shining = furnished();
    (shining.lights, shining.sky) = (Vec::new(), casca_radiosity::Sky::default());
    shining.materials.iter_mut().for_each(|m| (m.albedo, m.emission) = (Vec3::ZERO, Vec3::ONE));
    let cache = Cache::new(&shining, Settings::new(Grid::around(&shining.objects, 16))).unwrap();
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    assert!(filled(&gpu, &light, &points(), 8).iter().all(|p| *p == [0.0, 0.0, 0.0, 0.5]));
}

#[test]
fn numbers_of_rays_are_checked_and_nothing_is_filled_where_nothing_is_shown() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = Cache::new(&furnished(), Settings::new(Grid::around(&furnished().objects, 8))).unwrap();
    let light = GpuCache::new(&gpu.device, &cache).unwrap();
    let gaps = Gaps::new(&gpu.device);
    let [place, normals, before] =
        [[1.0, 1.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0; 4]].map(|p| texture_of(&gpu, &[p; 3], |p| *p));
    let surfaces = Surfaces { place: &place, normals: &normals };
    let shown = picture_of(&gpu, 3, |encoder, view| {
        for rays in [0, 65, u32::MAX] {
            let wrong = light.fill(&gpu.device, encoder, (&gaps, rays), surfaces, (&before, view));
            assert!(wrong.is_err(), "{rays}");
        }
        light.fill(&gpu.device, encoder, (&gaps, 64), surfaces, (&before, view)).unwrap();
    });
    assert_eq!(shown, [[0.0; 4]; 3]);
}
