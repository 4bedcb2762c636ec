//! What surfaces mirror: walls, lamps and the sky, beside the processor's reflections.

use casca_radiosity::gpu::{Gloss, GpuCache, Mirrors, Surfaces};
use casca_radiosity::{Cache, Grid, LightError, Material, Settings};
use casca_stage::gpu::Gpu;
use glam::{Affine3A, Vec3};

use crate::common::{floor, gathered, lamp, leak_questions, lit, matt, placed, rooms, scene, sheet, turned};
use crate::device::{Mirroring, furnished, hall, in_hall, mirrored, points, texture_of};

/// Light that differs by more, as a share of the mean or of its own, is that of another wall or of
/// other states.
pub const ELSEWHERE: f32 = 1e-3;
/// Metres from a wall to the nearest point in its fold, and from point to point.
const FOLD: f32 = 1e-4;

/// Points of the floor under a linear sky.
pub fn on_floor(count: usize, rough: f32) -> Vec<Mirroring> {
    let at = |i: usize| {
        let (u, v) = ((i as f32 + 0.5) / count as f32, (i as f32 * 0.618 + 0.3).fract());
        (Vec3::new(1.9 * u - 0.95, 0.0, 1.9 * v - 0.95), Vec3::Y, rough)
    };
    (0..count).map(at).collect()
}

/// Relative differences to the mirrors of the processor over the mean light, for points whose hits
/// states stand for: sorted. The device must send a ray where the eye is above.
fn apart(gpu: &Gpu, device: &GpuCache, cache: &Cache, points: &[Mirroring], eye: Vec3) -> Vec<f32> {
    let found = mirrored(gpu, device, points, eye, 1);
    let known: Vec<Vec3> =
        points.iter().map(|(p, n, r)| cache.reflection(*p, *n, eye, *r, 1).unwrap()).collect();
    let mean = known.iter().map(|k| k.length()).sum::<f32>() / known.len() as f32;
    assert!(mean > 0.05, "{mean}");
    let mut all = Vec::new();
    for (((p, n, _), found), known) in points.iter().zip(&found).zip(&known) {
        assert_eq!(found[3] > 0.0, (eye - *p).dot(*n) > 0.0, "{p}");
        if found[3] == 1.0 {
            all.push((Vec3::from_slice(found) - *known).length() / mean);
        }
    }
    all.sort_by(f32::total_cmp);
    all
}

#[test]
fn mirrors_show_the_sky_and_lamps() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let glow = Material::new(Vec3::ZERO, Vec3::new(5.0, 3.0, 1.0));
    let mut s = floor();
    s.materials.push(glow);
    s.objects.push(sheet(Vec3::new(-1.0, 1.0, -1.0), Vec3::X, Vec3::Z * 2.0, 1).into());
    let cache = lit(&s, 8, 16, 2);
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    // From above, and from below: the floor's back mirrors the sky below the horizon.
    let eyes = [Vec3::new(0.6, 0.5, 0.2), Vec3::new(-0.3, 0.7, 0.1), Vec3::new(0.2, -0.4, 0.3)];
    for eye in eyes {
        // Up to a hundredth, surfaces are mirrors.
        let side = |(p, n, r): Mirroring| (p, n * eye.y.signum(), r);
        let points: Vec<_> = on_floor(200, 0.009).into_iter().map(side).collect();
        let found = mirrored(&gpu, &device, &points, eye, 1);
        let mut lamps = 0;
        for ((p, n, r), found) in points.iter().zip(&found) {
            let known = cache.reflection(*p, *n, eye, *r, 1).unwrap();
            assert!((Vec3::from_slice(found) - known).length() < 1e-5, "{p}: {found:?} for {known}");
            assert_eq!(found[3], 1.0);
            lamps += usize::from(known == glow.emission);
        }
        assert!(if eye.y < 0.0 { lamps == 0 } else { lamps > 5 && lamps < 180 }, "{eye}: {lamps}");
    }
}

#[test]
fn mirrors_show_walls_as_on_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Some walls turn their backs to the room.
    let mut s = furnished();
    s.objects[0].triangles.iter_mut().step_by(3).for_each(|t| t.corners.swap(0, 1));
    let mut cache = lit(&s, 25, 32, 20);
    cache.smooth(2);
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    let points: Vec<_> = points().into_iter().map(|(p, n)| (p, n, 0.0)).collect();
    for eye in [Vec3::new(3.1, 1.7, 2.9), Vec3::new(0.3, 0.4, 3.6), Vec3::new(2.0, 2.8, 1.4)] {
        let all = apart(&gpu, &device, &cache, &points, eye);
        let (middle, worst) = (all[all.len() / 2], all[all.len() - 1]);
        let far = all.iter().filter(|e| **e > ELSEWHERE).count();
        println!("walls from {eye}: middle {middle:e}, worst {worst:e}, {far} of {} far", all.len());
        assert!(all.len() > 300, "{}", all.len());
        assert!(middle < 1e-4 && far < all.len() / 50 && worst < 1e-2, "{middle} {far}");
    }
}

#[test]
fn mirrored_rays_cross_empty_bricks_and_end_at_the_nearest_wall() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Each wall glows alike.
    let glow = |r, g, b| Material::new(Vec3::splat(0.3), Vec3::new(r, g, b));
    let materials = vec![glow(0.1, 0.0, 0.0), glow(0.0, 0.5, 0.0), glow(0.0, 0.0, 2.0)];
    let scene = hall(materials, vec![]);
    let cache = Cache::new(&scene, Settings::new(Grid::around(&scene.objects, 200))).unwrap();
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    let points: Vec<Mirroring> = in_hall().into_iter().map(|(p, n)| (p, n, 0.0)).collect();
    let mut met = [0; 3];
    for eye in [Vec3::new(30.0, 2.1, 2.4), Vec3::new(3.0, 1.0, 2.9)] {
        for ((p, n, _), found) in points.iter().zip(mirrored(&gpu, &device, &points, eye, 1)) {
            // Nothing is gathered: there is emission only, and the device says so.
            let known = cache.reflection(*p, *n, eye, 0.0, 1).unwrap();
            assert_eq!(found, known.extend(0.5).to_array(), "{p}");
            let which = (0..3).find(|c| known[*c] > 0.0).unwrap();
            met[which] += 1;
        }
    }
    assert!(met.iter().all(|m| *m > 5), "{met:?}");
}

#[test]
fn the_room_behind_a_wall_is_dark_in_mirrors() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let walls = [0.0, 0.02, 0.2].map(|thickness| [(thickness, Affine3A::IDENTITY), (thickness, turned())]);
    for (thickness, place) in walls.into_iter().flatten() {
        let lights = vec![lamp(place.transform_point3(Vec3::new(-2.0, 2.0, 0.3)), 10.0)];
        let all = placed(&rooms(thickness), place);
        let cache = lit(&scene(all, vec![matt(0.7)], lights, 0.0), 32, 8, 4);
        let device = GpuCache::new(&gpu.device, &cache).unwrap();
        let total = |side: f32, rough: f32, rays| {
            let mut points = leak_questions(side, thickness);
            // In the fold of wall and floor, where walls are nearest to each other.
            points.extend((0..200).map(|i| {
                let x = side * (0.5 * thickness + FOLD * (1.0 + i as f32));
                (Vec3::new(x, 0.0, (i as f32 * 0.618).fract() * 3.8 - 1.9), Vec3::Y)
            }));
            let there = |(p, n)| (place.transform_point3(p), place.transform_vector3(n), rough);
            let points: Vec<Mirroring> = points.into_iter().map(there).collect();
            let eyes = [(2.2, 1.3, 0.4), (0.2 + thickness, 0.05, -1.2), (4.0, 2.8, 1.9)];
            let eyes = eyes.map(|(x, y, z)| place.transform_point3(Vec3::new(side * x, y, z)));
            let found = eyes.map(|eye| mirrored(&gpu, &device, &points, eye, rays));
            found.iter().flatten().map(|p| p[0] + p[1] + p[2]).sum::<f32>()
        };
        assert!(total(-1.0, 0.0, 1) > 10.0, "{}", total(-1.0, 0.0, 1));
        assert_eq!(total(1.0, 0.0, 1), 0.0, "{thickness} {place}");
        assert_eq!(total(1.0, 0.3, 4), 0.0, "{thickness} {place}");
    }
}

#[test]
fn an_eye_below_sees_nothing_and_odd_numbers_do_no_harm() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&floor(), 8, 16, 2);
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    let eye = Vec3::new(0.1, 1.0, 0.2);
    let (o, up) = (Vec3::ZERO, Vec3::Y);
    let nan = f32::NAN;
    let odd = [
        // From below, in the surface's plane, and from the point itself.
        (o, -up, 0.3),
        (Vec3::new(0.0, 1.0, 0.0), up, 0.3),
        (eye, up, 0.3),
        (Vec3::new(nan, 0.0, 0.0), up, 0.3),
        (Vec3::new(0.0, f32::INFINITY, 0.0), up, 0.3),
        (Vec3::new(0.0, f32::NEG_INFINITY, 0.0), up, 0.0),
        (Vec3::splat(-3e38), up, 0.3),
        (Vec3::splat(-1e20), up, 0.0),
        (o, o, 0.3),
        (o, Vec3::new(0.0, nan, 1.0), 0.3),
        (o, Vec3::splat(f32::INFINITY), 0.3),
        (o, up, nan),
        (o, up, -1.0),
        (o, up, -1e-30),
        (o, up, f32::INFINITY),
        (o, up, f32::NEG_INFINITY),
    ];
    for (point, found) in odd.iter().zip(mirrored(&gpu, &device, &odd, eye, 4)) {
        assert_eq!(found, [0.0; 4], "{point:?}");
    }
    // A normal may have any length, and a roughness above 1 counts as 1.
    let fine = [up * 1e-37, up * 3e38, up].map(|n| (o, n, 0.3));
    let found = mirrored(&gpu, &device, &fine, eye, 4);
    assert!(found.iter().all(|f| *f == found[2] && f[3] == 1.0 && f[0] > 1.0), "{found:?}");
    let found = mirrored(&gpu, &device, &[(o, up, 1.0), (o, up, 9.0)], eye, 4);
    assert_eq!(found[0], found[1]);
    // The distance of an eye does not matter, only its direction.
    let near = mirrored(&gpu, &device, &fine, Vec3::Y, 4);
    assert_eq!(near, mirrored(&gpu, &device, &fine, Vec3::Y * 3e38, 4));
    // An empty cache has only its sky.
    let empty = lit(&scene(vec![], vec![matt(0.5)], vec![], 1.0), 8, 4, 1);
    let empty = GpuCache::new(&gpu.device, &empty).unwrap();
    assert_eq!(mirrored(&gpu, &empty, &fine[2..], eye, 4), [[1.0; 4]]);
}

#[test]
fn wrong_numbers_of_rays_and_eyes_are_refused() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let device = GpuCache::new(&gpu.device, &lit(&floor(), 8, 4, 1)).unwrap();
    let mirrors = Mirrors::new(&gpu.device);
    let view = texture_of(&gpu, &[()], |()| [0.0; 4]);
    let surfaces = Surfaces { place: &view, normals: &view };
    let refused = |eye, rays| {
        let gloss = Gloss { roughness: &view, eye, rays };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        device.mirror(&gpu.device, &mut encoder, &mirrors, surfaces, gloss, &view)
    };
    for (eye, rays) in [(Vec3::ZERO, 0), (Vec3::ZERO, 65), (Vec3::NAN, 1), (Vec3::INFINITY, 1)] {
        assert!(matches!(refused(eye, rays), Err(LightError::Value { .. })), "{eye} {rays}");
    }
}

#[test]
fn what_is_outside_of_the_grid_is_not_mirrored() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // A lamp that rises out of the grid over the floor.
    let mut s = floor();
    s.materials.push(Material::new(Vec3::ZERO, Vec3::new(9.0, 0.0, 0.0)));
    let slope = sheet(Vec3::new(-1.0, 0.5, -4.0), Vec3::new(4.0, 4.0, 0.0), Vec3::Z * 8.0, 1);
    s.objects.push(slope.into());
    let grid = Grid { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 0.8, 1.0), cells: 6 };
    let cache = gathered(&s, Settings::new(grid), 4);
    let device = GpuCache::new(&gpu.device, &cache).unwrap();
    let mut lamps = 0;
    // Also from points far outside of the grid, below which nothing is.
    for (shift, eye) in [(Vec3::ZERO, Vec3::new(-0.4, 1.0, 0.1)), (Vec3::X * 50.0, Vec3::new(99.0, 1.4, 0.1))]
    {
        let points: Vec<_> = on_floor(200, 0.0).into_iter().map(|(p, n, r)| (p + shift, n, r)).collect();
        for ((p, n, r), found) in points.iter().zip(mirrored(&gpu, &device, &points, eye, 1)) {
            let known = cache.reflection(*p, *n, eye, *r, 1).unwrap();
            assert!((Vec3::from_slice(&found) - known).length() < 1e-4, "{p}: {found:?} for {known}");
            lamps += usize::from(known.x == 9.0);
        }
        assert!(lamps > 20 && lamps < 380, "{lamps}");
    }
}
