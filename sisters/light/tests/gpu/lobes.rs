//! Lobes of rough surfaces on the device, beside the processor's with many rays.

use casca_radiosity::gpu::GpuCache;
use casca_radiosity::{Cache, Grid, Material, Settings};
use glam::{DVec3, Vec3};

use crate::common::{floor, lit, room, scene};
use crate::device::{Mirroring, furnished, mirrored, points};
use crate::mirrors::on_floor;
use casca_stage::gpu::Gpu;

/// The rays of the processor's lobes.
const MANY: u32 = 1024;
/// About twice the noise of 64 rays: of one pixel, of the mean of 300, and of the mean of 3,000
/// pixels with one to three rays. Shares of the light.
const NOISE: f64 = 0.03;
const NOISE_OF_MEANS: f64 = 2e-3;
const NOISE_OF_FEW: f64 = 0.015;
/// Metres between points that send other rays, a thousandth of a cell or less.
const BESIDE: f32 = 1e-5;

fn mean(all: impl Iterator<Item = Vec3>) -> DVec3 {
    let (sum, count) = all.fold((DVec3::ZERO, 0.0), |(s, n), v| (s + v.as_dvec3(), n + 1.0));
    sum / count
}

/// The greatest difference of two colours over the greatest channel.
fn apart(found: DVec3, known: DVec3) -> f64 {
    (found - known).abs().max_element() / known.max_element()
}

#[test]
fn lobes_under_a_sky_are_those_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&floor(), 8, 16, 2);
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    for rough in [0.02, 0.1, 0.4, 1.0] {
        // From above, and flat over the floor.
        for eye in [Vec3::new(0.2, 3.0, -0.3), Vec3::new(2.0, 0.3, 1.0)] {
            let points = on_floor(300, rough);
            let of = |p: &Mirroring| cache.reflection(p.0, p.1, eye, rough, MANY).unwrap();
            let known: Vec<Vec3> = points.iter().map(of).collect();
            let many = mirrored(&gpu, &device, &points, eye, 64);
            let each =
                many.iter().zip(&known).map(|(f, k)| apart(Vec3::from_slice(f).as_dvec3(), k.as_dvec3()));
            let worst = each.fold(0.0, f64::max);
            let all = mean(known.iter().copied());
            let of_mean = |found: &[[f32; 4]]| {
                assert!(found.iter().all(|f| f[3] == 1.0));
                apart(mean(found.iter().map(|f| Vec3::from_slice(f))), all)
            };
            let many = of_mean(&many);
            // Few rays of more pixels have the same mean, even one of each.
            let few = [1, 2, 3].map(|n| of_mean(&mirrored(&gpu, &device, &on_floor(3000, rough), eye, n)));
            println!("{rough} from {eye}: each within {worst:.1e}; means {many:.1e}, of few rays {few:?}");
            assert!(
                worst < NOISE && many < NOISE_OF_MEANS && few.iter().all(|f| *f < NOISE_OF_FEW),
                "{rough} {eye}: {worst} {many} {few:?}"
            );
        }
    }
}

#[test]
fn pixels_depend_on_their_places_alone() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&furnished(), 16, 16, 8);
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    let eye = Vec3::new(3.1, 1.7, 2.9);
    let there: Vec<Mirroring> = points().into_iter().step_by(5).map(|(p, n)| (p, n, 0.4)).collect();
    let back: Vec<Mirroring> = there.iter().rev().copied().collect();
    let first = mirrored(&gpu, &device, &there, eye, 4);
    let mut second = mirrored(&gpu, &device, &back, eye, 4);
    second.reverse();
    assert_eq!(first, second);
    // Near points send other rays.
    let near: Vec<Mirroring> = there.iter().map(|(p, n, r)| (*p + Vec3::splat(BESIDE), *n, *r)).collect();
    let near = mirrored(&gpu, &device, &near, eye, 4);
    let same = first.iter().zip(&near).filter(|(a, b)| a[3] > 0.0 && a == b).count();
    assert!(same < first.len() / 10, "{same}");
}

#[test]
fn the_last_component_tells_the_share_without_states() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // A room whose floor alone is gathered.
    let glow = Material::new(Vec3::splat(0.5), Vec3::splat(0.25));
    let s = scene(room(Vec3::ZERO, Vec3::new(4.0, 3.0, 4.0), 0), vec![glow], vec![], 0.0);
    let mut cache = Cache::new(&s, Settings::new(Grid::around(&s.objects, 16))).unwrap();
    for i in 0..1024 {
        let at = Vec3::new((i % 32) as f32 + 0.5, 0.0, (i / 32) as f32 + 0.5) / 8.0;
        cache.request(at, Vec3::Y).unwrap();
    }
    cache.gather_part((4, 4), usize::MAX).unwrap();
    cache.direct();
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    let eye = Vec3::new(3.0, 1.5, 2.0);
    let wall = |y, rough| (Vec3::new(0.0, y, 2.0), Vec3::X, rough);
    let found = mirrored(&gpu, &device, &[wall(0.4, 0.0), wall(2.6, 0.0), wall(1.5, 1.0)], eye, 64);
    // Down to the floor, whose states are dark but stand; up to the ceiling; and all around.
    let share = found[2][3];
    assert_eq!(found[1], [0.25, 0.25, 0.25, 0.5]);
    assert_eq!(found[0][3], 1.0);
    assert!(share > 0.55 && share < 0.95, "{share}");
}
