//! Light in the open: radiance along rays, what glossy surfaces mirror, and probes.

mod common;

use std::f64::consts::{PI, TAU};

use casca_radiosity::{LightError, Material, Scene, Sky};
use common::{lamp, leak_questions, lit, matt, room, rooms, scene, sheet};
use glam::{DVec3, Vec3, Vec3 as V};

/// A sky whose radiance is linear in the height of the direction.
fn linear() -> Sky {
    let (horizon, zenith) = (V::new(1.0, 2.0, 0.5), V::new(1.5, 0.5, 0.75));
    Sky::Gradient { up: V::Y, zenith, horizon, nadir: 2.0 * horizon - zenith }
}

/// A floor of 2 metres under that sky.
fn floor() -> Scene {
    let floor = sheet(V::new(-1.0, 0.0, -1.0), V::Z * 2.0, V::X * 2.0, 0);
    Scene { sky: linear(), ..scene(floor, vec![matt(0.5)], vec![], 0.0) }
}

/// The mean over a lobe of GGX by a fine grid of directions: the definition, without choices.
fn by_definition(sky: &Sky, view: DVec3, rough: f64) -> DVec3 {
    let normal = DVec3::Y;
    let shadow = |c: f64| {
        let tangent = (1.0 - c * c).max(0.0) / (c * c);
        2.0 / (1.0 + (1.0 + rough * rough * tangent).sqrt())
    };
    let lambda = |c: f64| 1.0 / shadow(c) - 1.0;
    let (mut light, mut sum) = (DVec3::ZERO, 0.0);
    let steps = 600;
    for i in 0..steps {
        for k in 0..2 * steps {
            let (height, turn) =
                ((f64::from(i) + 0.5) / f64::from(steps), TAU * (f64::from(k) + 0.5) / f64::from(2 * steps));
            let radius = (1.0 - height * height).sqrt();
            let way = DVec3::new(radius * turn.cos(), height, radius * turn.sin());
            let half = (way + view).normalize();
            let c = half.dot(normal);
            let d = rough * rough / (PI * (c * c * (rough * rough - 1.0) + 1.0).powi(2));
            let both = 1.0 / (1.0 + lambda(view.y) + lambda(height));
            let weight = d * both / (4.0 * view.y * height) * height;
            light += sky.radiance(way.as_vec3()).as_dvec3() * weight;
            sum += weight;
        }
    }
    light / sum
}

#[test]
fn lobes_are_those_of_the_definition() {
    let scene = floor();
    let cache = lit(&scene, 8, 16, 2);
    let point = V::new(0.1, 0.0, -0.2);
    for rough in [0.1, 0.4, 1.0_f32] {
        for view in [V::new(0.3, 1.0, 0.2), V::new(1.0, 0.25, -0.6)] {
            let found = cache.reflection(point, V::Y, point + view * 3.0, rough, 1024).unwrap();
            let known = by_definition(&scene.sky, view.as_dvec3().normalize(), rough.into());
            let error = (found.as_dvec3() - known).abs().max_element() / known.max_element();
            assert!(error < 4e-3, "{rough} {view}: {found} for {known}");
        }
    }
}

#[test]
fn mirrors_show_the_sky_and_lamps() {
    let glow = Material::new(V::ZERO, V::new(5.0, 3.0, 1.0));
    let mut s = floor();
    s.materials.push(glow);
    s.objects.push(sheet(V::new(-1.0, 1.0, -1.0), V::X, V::Z * 2.0, 1).into());
    let cache = lit(&s, 8, 16, 2);
    let (point, eye) = (V::new(0.2, 0.0, 0.1), V::new(0.6, 0.5, 0.2));
    // To the left hangs the lamp.
    let lamp = cache.reflection(point, V::Y, eye, 0.0, 1).unwrap();
    assert_eq!(lamp, glow.emission);
    let from_left = V::new(-0.9, 0.5, 0.2);
    let way = (from_left - point).normalize();
    let mirrored = V::new(-way.x, way.y, -way.z);
    let sky = cache.reflection(point, V::Y, from_left, 0.0, 1).unwrap();
    assert!((sky - s.sky.radiance(mirrored)).length() < 1e-5, "{sky}");
    assert_eq!(cache.radiance(point + V::Y * 0.01, mirrored).unwrap(), s.sky.radiance(mirrored));
    // From below there is nothing.
    assert_eq!(cache.reflection(point, V::Y, V::new(0.0, -1.0, 0.0), 0.5, 8).unwrap(), V::ZERO);
}

#[test]
fn probes_know_skies_that_are_linear() {
    let cache = lit(&floor(), 8, 16, 2);
    // Beside the floor and above it, but for its share of the ball, which the far point hardly has.
    let probe = cache.probe(V::new(0.0, 400.0, 0.0), 512).unwrap();
    for normal in [V::X, V::Y, -V::Y, V::new(0.6, 0.0, 0.8), V::new(0.0, 0.6, -0.8)] {
        let Sky::Gradient { zenith, horizon, .. } = linear() else { unreachable!() };
        let known = PI as f32 * horizon + (2.0 / 3.0 * PI) as f32 * (zenith - horizon) * normal.y;
        let found = probe.irradiance(normal);
        assert!((found - known).abs().max_element() < 0.01 * known.max_element(), "{found} for {known}");
    }
}

#[test]
fn probes_and_rays_in_a_furnace_see_what_walls_scatter() {
    let (albedo, emission) = (0.6, 1.0);
    let walls = room(V::ZERO, V::new(4.0, 3.0, 2.0), 0);
    let s = scene(walls, vec![Material::new(V::splat(albedo), V::splat(emission))], vec![], 0.0);
    let cache = lit(&s, 16, 32, 30);
    let all = emission / (1.0 - albedo);
    let probe = cache.probe(V::new(1.3, 1.9, 0.6), 256).unwrap();
    for normal in [V::X, -V::Y, V::new(0.0, 0.6, -0.8)] {
        let (found, known) = (probe.irradiance(normal).x, std::f32::consts::PI * (all - emission));
        assert!((found / known - 1.0).abs() < 0.01, "{found} for {known}");
    }
    let found = cache.radiance(V::new(1.3, 1.9, 0.6), V::new(1.0, 0.3, -0.2)).unwrap().x;
    assert!((found / all - 1.0).abs() < 1e-3, "{found} for {all}");
}

#[test]
fn a_probe_gives_about_the_light_of_a_surface_that_is_not_there() {
    let mut s = scene(room(V::ZERO, V::new(4.0, 3.0, 2.0), 0), vec![matt(0.6), matt(0.1)], vec![], 0.0);
    s.objects.push(room(V::new(-0.001, 0.0, 0.0), V::new(4.0, 0.001, 2.0), 1).into());
    s.lights = vec![lamp(V::new(0.8, 2.2, 0.9), 10.0)];
    let cache = lit(&s, 16, 64, 12);
    for point in [V::new(2.0, 1.5, 1.0), V::new(3.1, 0.9, 1.3), V::new(1.1, 1.2, 0.7)] {
        let probe = cache.probe(point, 256).unwrap();
        let normals = [V::X, -V::X, V::Y, -V::Y, V::Z, -V::Z];
        // No state is near, so that rays of a hemisphere answer: they are another way to the same.
        let known = normals.map(|n| cache.irradiance(point, n).unwrap());
        assert!(known.iter().all(|k| k.states == 0));
        let most = known.iter().map(|k| k.indirect.x).fold(0.0, f32::max);
        for (normal, known) in normals.iter().zip(known) {
            // By rays, stored direct light counts as well.
            let error = (probe.irradiance(*normal).x - known.indirect.x) / most;
            assert!(error.abs() < 0.08, "{point} {normal}: {error}");
        }
    }
}

#[test]
fn no_light_of_probes_and_mirrors_crosses_a_wall() {
    let lights = vec![lamp(V::new(-2.0, 2.0, 0.3), 10.0)];
    for thickness in [0.0, 0.02, 0.1] {
        let cache = lit(&scene(rooms(thickness), vec![matt(0.7)], lights.clone(), 0.0), 24, 16, 4);
        let (bright, dark) = (V::new(-2.2, 1.3, 0.4), V::new(2.2, 1.3, 0.4));
        assert!(cache.probe(bright, 64).unwrap().irradiance(V::Y).x > 0.1);
        assert_eq!(cache.probe(dark, 64).unwrap().harmonics, [Vec3::ZERO; 9], "{thickness}");
        for (point, normal) in leak_questions(1.0, thickness) {
            let eye = point + normal + V::new(0.1, 0.2, 0.3);
            let found = cache.reflection(point, normal, eye, 0.3, 8).unwrap();
            assert_eq!(found, V::ZERO, "{thickness} {point}");
        }
    }
}

#[test]
fn only_what_is_asked_for_is_gathered() {
    let s = scene(room(V::ZERO, V::new(4.0, 3.0, 2.0), 0), vec![matt(0.6)], vec![], 0.0);
    let mut cache = casca_radiosity::Cache::new(
        &s,
        casca_radiosity::Settings::new(casca_radiosity::Grid::around(&s.objects, 16)),
    )
    .unwrap();
    cache.request_reflection(V::new(2.0, 0.0, 1.0), V::Y, V::new(2.0, 1.0, 1.0), 0.0, 1).unwrap();
    cache.gather_ring(4).unwrap();
    let few = cache.statistics().gathered;
    cache.request_probe(V::new(2.0, 1.5, 1.0), 64).unwrap();
    cache.gather_ring(4).unwrap();
    let more = cache.statistics().gathered;
    assert!(few > 0 && few < 60 && more > 3 * few, "{few}, {more}");
}

#[test]
fn questions_in_the_open_are_refused_by_name() {
    let mut cache = lit(&floor(), 8, 4, 1);
    let rays = |value| Err(LightError::Rays { what: "rays", value });
    assert_eq!(cache.probe(V::ZERO, 0), rays(0));
    assert_eq!(cache.probe(V::ZERO, 5000), rays(5000));
    assert!(matches!(cache.probe(V::NAN, 4), Err(LightError::Value { .. })));
    assert!(matches!(cache.request_probe(V::INFINITY, 4), Err(LightError::Value { .. })));
    assert!(matches!(cache.radiance(V::ZERO, V::ZERO), Err(LightError::Direction { .. })));
    assert!(matches!(cache.reflection(V::ZERO, V::Y, V::Y, 1.5, 4), Err(LightError::Value { .. })));
    assert!(matches!(cache.reflection(V::ZERO, V::Y, V::NAN, 0.5, 4), Err(LightError::Value { .. })));
    assert!(matches!(
        cache.request_reflection(V::ZERO, V::ZERO, V::Y, 0.5, 4),
        Err(LightError::Direction { .. })
    ));
    // An eye in the point itself, and points far away.
    assert_eq!(cache.reflection(V::ZERO, V::Y, V::ZERO, 0.5, 4), Ok(V::ZERO));
    assert!(cache.probe(V::splat(3e38), 8).unwrap().irradiance(V::Y).is_finite());
}
