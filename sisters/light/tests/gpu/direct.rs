//! Direct light by rays on the device.

use casca_radiosity::gpu::{Answers, GpuCache};
use casca_radiosity::{Cache, Grid, Light, Material, Settings};
use casca_stage::gpu::Gpu;
use glam::Vec3;

use crate::common::{gathered, lamp, lit, matt, scene, sheet};
use crate::device::{furnished, points, shaded};

/// Relative differences to the processor's direct light of points: of the sums, and the share of
/// points that differ by more than a hundredth of the mean.
fn apart(gpu: &Gpu, cache: &Cache) -> (f64, f64) {
    let device = GpuCache::new(&gpu.device, cache).unwrap();
    let points = points();
    let all = shaded(gpu, &device, Answers::All, &points);
    let bounced = shaded(gpu, &device, Answers::Indirect, &points);
    let found = all.iter().zip(&bounced).map(|(a, b)| f64::from(a[0] - b[0]));
    let known = points.iter().map(|(p, n)| f64::from(cache.irradiance(*p, *n).unwrap().direct.x));
    let both: Vec<(f64, f64)> = found.zip(known).collect();
    let sums = both.iter().fold((0.0, 0.0), |s, b| (s.0 + b.0, s.1 + b.1));
    let mean = sums.1 / both.len() as f64;
    assert!(mean > 1e-3, "{mean}");
    let far = both.iter().filter(|(a, b)| (a - b).abs() > 0.01 * mean.max(*b)).count();
    (sums.0 / sums.1 - 1.0, far as f64 / both.len() as f64)
}

#[test]
fn lights_with_sharp_shadows_are_those_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let one = Vec3::new(6.0, 4.0, 2.0);
    for light in [
        lamp(Vec3::new(3.0, 2.0, 0.6), 9.0),
        Light::Spot {
            position: Vec3::new(2.0, 2.8, 3.2),
            direction: Vec3::new(-0.2, -1.0, -0.6),
            intensity: one,
            inner: 0.3,
            outer: 0.7,
            radius: 0.0,
        },
        Light::Sun { direction: Vec3::new(0.3, -1.0, 0.4), irradiance: one, half_angle: 0.0 },
    ] {
        let mut cache = lit(&furnished(), 24, 8, 1);
        cache.set_lights(&[light]).unwrap();
        let (sum, far) = apart(&gpu, &cache);
        println!("{light:?}: {sum:e}, {far}");
        // A point may lie on the edge of a shadow.
        assert!(sum.abs() < 1e-3 && far < 0.005, "{light:?}: {sum} {far}");
    }
}

#[test]
fn soft_lights_and_lamps_give_what_they_give_on_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let one = Vec3::new(6.0, 4.0, 2.0);
    let ball = Light::Point { position: Vec3::new(3.0, 2.0, 0.6), intensity: one, radius: 0.3 };
    let sun = Light::Sun { direction: Vec3::new(0.3, -1.0, 0.4), irradiance: one, half_angle: 0.1 };
    for lights in [vec![ball], vec![sun, ball], vec![]] {
        let mut scene = furnished();
        // Two lamps of different sizes and colours instead of lights.
        if lights.is_empty() {
            scene.materials.push(Material::new(Vec3::ZERO, Vec3::new(5.0, 1.0, 1.0)));
            scene.materials.push(Material::new(Vec3::splat(0.2), Vec3::new(2.0, 9.0, 1.0)));
            scene.objects.push(sheet(Vec3::new(0.6, 2.9, 0.4), Vec3::X * 1.2, Vec3::Z, 2).into());
            scene.objects.push(sheet(Vec3::new(3.9, 0.6, 3.0), Vec3::Y, Vec3::Z * 0.5, 3).into());
        }
        scene.lights = lights.clone();
        let rays = Settings {
            light_rays: 256,
            lamp_points: 1024,
            lamp_rays: 256,
            ..Settings::new(Grid::around(&scene.objects, 20))
        };
        let (sum, far) = apart(&gpu, &gathered(&scene, rays, 8));
        println!("{lights:?}: {sum:e}, {far}");
        // They send other rays: with so many, penumbras differ by a hundredth here and there.
        assert!(sum.abs() < 1e-3 && far < 0.1, "{lights:?}: {sum} {far}");
    }
}

#[test]
fn what_hangs_outside_of_the_grid_hides_nothing() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // A sheet that rises out of the grid over the floor, in the cells of which rays end.
    let slope = sheet(Vec3::new(-1.0, 0.5, -4.0), Vec3::new(4.0, 4.0, 0.0), Vec3::Z * 8.0, 0);
    let mut all = sheet(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    all.extend(slope);
    let sun = Light::Sun { direction: Vec3::new(-0.4, -1.0, 0.1), irradiance: Vec3::ONE, half_angle: 0.0 };
    let scene = scene(all, vec![matt(0.5)], vec![sun], 0.0);
    let grid = Grid { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 0.8, 1.0), cells: 6 };
    let cache = gathered(&scene, Settings::new(grid), 4);
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    let points: Vec<(Vec3, Vec3)> = (0..200)
        .map(|i| (Vec3::new(i as f32 / 100.0 - 0.997, 0.0, (0.618 * i as f32).fract() - 0.5), Vec3::Y))
        .collect();
    let found = shaded(&gpu, &device, Answers::All, &points);
    let bounced = shaded(&gpu, &device, Answers::Indirect, &points);
    let mut lit = 0;
    for (((p, n), all), bounced) in points.iter().zip(found).zip(bounced) {
        let known = cache.irradiance(*p, *n).unwrap().direct.x;
        assert!((all[0] - bounced[0] - known).abs() < 1e-3, "{p}: {all:?} {known}");
        lit += usize::from(known > 0.0);
    }
    assert!(lit > 20 && lit < 180, "{lit}");
}
