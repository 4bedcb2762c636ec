//! Light that is known in closed form.

use std::f64::consts::PI;

use crate::common::{cuboid, indirect, lamp, lit, matt, placed, room, scene, sheet, total, turned};
use casca_radiosity::{Light, Material, Scene, Sky, Triangle};
use casca_scenes::world::Mesh;
use glam::Vec3 as V;

/// A ball of radius 1.
fn ball(cuts: u32) -> Vec<Triangle> {
    let mesh = Mesh::ball(cuts);
    let at = |v: u32| mesh.positions[v as usize];
    mesh.triangles.iter().map(|t| Triangle { corners: t.map(at), material: 0 }).collect()
}

/// The mean and the most distance from a value, over it.
fn apart(values: &[f64], truth: f64) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let most = values.iter().map(|v| (v / truth - 1.0).abs()).fold(0.0, f64::max);
    (mean / truth - 1.0, most)
}

/// Points on the walls of a room of 4 x 3 x 2 metres.
fn on_walls() -> Vec<(V, V)> {
    let mut all = Vec::new();
    for i in 0..10 {
        let (u, v) = ((i as f32 + 0.5) / 10.0, (i as f32 * 0.618 + 0.3).fract());
        all.push((V::new(4.0 * u, 0.0, 2.0 * v), V::Y));
        all.push((V::new(4.0 * u, 3.0, 2.0 * v), -V::Y));
        all.push((V::new(0.0, 3.0 * u, 2.0 * v), V::X));
        all.push((V::new(4.0 * u, 3.0 * v, 2.0), -V::Z));
    }
    all
}

#[test]
fn a_furnace_is_as_bright_as_the_series_says() {
    // All walls scatter a share a and emit a radiance of 1: radiosity is pi / (1 - a) everywhere.
    for a in [0.0_f32, 0.5, 0.8] {
        let material = Material::new(V::splat(a), V::ONE);
        let walls = room(V::ZERO, V::new(4.0, 3.0, 2.0), 0);
        let cache = lit(&scene(walls, vec![material], vec![], 0.0), 16, 64, 40);
        let truth = PI / (1.0 - f64::from(a));
        let found: Vec<f64> = on_walls().iter().map(|(p, n)| total(&cache, *p, *n)).collect();
        let (mean, most) = apart(&found, truth);
        println!("furnace {a}: {mean} {most}");
        assert!(mean.abs() < 1e-4 && most < 1e-4, "{a}: {mean}, {most}");
    }
}

#[test]
fn a_point_light_falls_by_squares_and_the_cosine() {
    let floor = sheet(V::new(-4.0, 0.0, -4.0), V::Z * 8.0, V::X * 8.0, 0);
    for place in [glam::Affine3A::IDENTITY, turned()] {
        let light = lamp(place.transform_point3(V::new(0.5, 1.5, -0.25)), 7.0);
        let scene = scene(placed(&floor, place), vec![matt(0.0)], vec![light], 0.0);
        let cache = lit(&scene, 32, 1, 1);
        for i in 0..40 {
            let at = V::new(-3.9 + 0.19 * i as f32, 0.0, 3.0 * (i as f32 * 0.618).fract() - 1.5);
            let way = V::new(0.5, 1.5, -0.25) - at;
            let truth = 7.0 * f64::from(1.5 / way.length().powi(3));
            let point = place.transform_point3(at);
            let found = total(&cache, point, place.transform_vector3(V::Y));
            // A start is LIFT above the floor: 2.4e-4 metres of 1.5.
            assert!((found / truth - 1.0).abs() < 2e-3, "{found}, not {truth}");
            assert_eq!(total(&cache, point, place.transform_vector3(-V::Y)), 0.0);
        }
    }
}

#[test]
fn suns_and_spots_shine_as_described() {
    let floor = sheet(V::new(-4.0, 0.0, -4.0), V::Z * 8.0, V::X * 8.0, 0);
    let sun = Light::Sun { direction: V::new(1.0, -1.0, 0.0), irradiance: V::splat(3.0), half_angle: 0.01 };
    let spot = Light::Spot {
        position: V::new(0.0, 2.0, 0.0),
        direction: -V::Y,
        intensity: V::splat(8.0),
        inner: 0.4,
        outer: 0.8,
        radius: 0.02,
    };
    let cache = lit(&scene(floor.clone(), vec![matt(0.5)], vec![sun], 0.0), 16, 4, 1);
    let found = total(&cache, V::new(1.0, 0.0, 1.0), V::Y);
    assert!((found - 3.0 * 0.5_f64.sqrt()).abs() < 1e-3, "{found}");
    let cache = lit(&scene(floor, vec![matt(0.5)], vec![spot], 0.0), 16, 4, 1);
    let at = |x: f32| total(&cache, V::new(x, 0.0, 0.0), V::Y);
    let full = |x: f64| 8.0 * 2.0 / (4.0 + x * x).powf(1.5);
    assert!((at(0.0) / full(0.0) - 1.0).abs() < 2e-3);
    assert!((at(0.8) / full(0.8) - 1.0).abs() < 2e-3, "within the inner cone");
    assert_eq!(at(2.1), 0.0, "beyond the outer cone");
    // Half way between the cosines the cubic is a half.
    let cosine = (0.4_f64.cos() + 0.8_f64.cos()) / 2.0;
    let x = 2.0 * cosine.acos().tan();
    assert!((at(x as f32) / full(x) - 0.5).abs() < 2e-3);
}

/// The form factor of two equal parallel squares of side `a` at a distance `d` (Howell).
pub fn squares(a: f64, d: f64) -> f64 {
    let x = a / d;
    let s = (1.0 + x * x).sqrt();
    2.0 / (PI * x * x)
        * ((s * s / (1.0 + 2.0 * x * x).sqrt()).ln() + 2.0 * x * s * (x / s).atan() - 2.0 * x * x.atan())
}

#[test]
fn parallel_squares_exchange_what_their_form_factor_says() {
    let truth = PI * squares(2.0, 1.5);
    let square = |y: f32, material| sheet(V::new(-1.0, y, -1.0), V::Z * 2.0, V::X * 2.0, material);
    let mean = |cache: &casca_radiosity::Cache| {
        let at = |i: i32| (i as f32 + 0.5) / 8.0 - 1.0;
        let points = (0..256).map(|i| V::new(at(i % 16), 0.0, at(i / 16)));
        points.map(|p| total(cache, p, V::Y)).sum::<f64>() / 256.0
    };
    // As a lamp of the scene.
    let glowing = Material::new(V::ZERO, V::ONE);
    let both = [square(0.0, 0), square(1.5, 1)].concat();
    let cache = lit(&scene(both, vec![matt(0.0), glowing], vec![], 0.0), 16, 1, 1);
    let found = mean(&cache);
    assert!((found / truth - 1.0).abs() < 1e-3, "{found}, not {truth}");
    // Each square hides its form factor of the other's sky.
    let both = [square(0.0, 0), square(1.5, 0)].concat();
    let cache = lit(&scene(both, vec![matt(0.0)], vec![], 1.0), 16, 256, 1);
    let (found, truth) = (mean(&cache), PI - truth);
    assert!((found / truth - 1.0).abs() < 0.01, "{found}, not {truth}");
}

#[test]
fn convex_bodies_see_half_of_the_sky() {
    for place in [glam::Affine3A::IDENTITY, turned()] {
        for body in [ball(3), cuboid(V::splat(-0.7), V::splat(0.7), 0)] {
            let scene = scene(placed(&body, place), vec![matt(0.5)], vec![], 2.0);
            let cache = lit(&scene, 24, 64, 4);
            for t in scene.objects[0].triangles.iter().step_by(7) {
                let [a, b, c] = t.corners;
                let found = indirect(&cache, (a + b + c) / 3.0, (b - a).cross(c - a).normalize());
                assert!((found / (2.0 * PI) - 1.0).abs() < 1e-4, "{found}");
            }
        }
    }
}

#[test]
fn the_inside_of_a_ball_spreads_light_evenly() {
    // In a ball, what leaves a point reaches all others alike: E = Phi a / (A (1 - a)) everywhere.
    let mut walls = ball(4);
    walls.iter_mut().for_each(|t| t.corners.swap(1, 2));
    let (power, a) = (4.0 * PI * 3.0, 0.6);
    let light = lamp(V::new(0.2, -0.1, 0.3), 3.0);
    let cache = lit(&scene(walls.clone(), vec![matt(a)], vec![light], 0.0), 24, 64, 30);
    let truth = power * f64::from(a) / (4.0 * PI * (1.0 - f64::from(a)));
    let ask = |t: &Triangle| {
        let [a, b, c] = t.corners;
        indirect(&cache, (a + b + c) / 3.0, (b - a).cross(c - a).normalize())
    };
    let found: Vec<f64> = walls.iter().step_by(27).map(ask).collect();
    let (mean, most) = apart(&found, truth);
    println!("ball {mean} {most}");
    assert!(mean.abs() < 0.01 && most < 0.02, "{mean}, {most}");
}

#[test]
fn a_sky_with_a_gradient_weighs_directions() {
    // Radiance u at height u above the horizon: irradiance 2 pi / 3 on the floor.
    let floor = sheet(V::new(-4.0, 0.0, -4.0), V::Z * 8.0, V::X * 8.0, 0);
    let sky = Sky::Gradient { up: V::Y, zenith: V::ONE, horizon: V::ZERO, nadir: V::splat(9.0) };
    let plain = scene(floor, vec![matt(0.5)], vec![], 0.0);
    let found = indirect(&lit(&Scene { sky, ..plain }, 16, 256, 1), V::new(0.3, 0.0, 0.1), V::Y);
    assert!((found / (2.0 * PI / 3.0) - 1.0).abs() < 0.01, "{found}");
}
