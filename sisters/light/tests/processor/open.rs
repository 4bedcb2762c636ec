//! Light in the open: radiance along rays, and what glossy surfaces mirror.

use std::f64::consts::{PI, TAU};

use crate::common::{floor, lamp, leak_questions, lit, matt, room, rooms, scene, sheet};
use casca_radiosity::{Cache, Grid, LightError, Material, Settings, Sky};
use glam::{DVec3, Vec3 as V};

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
    // From below there is nothing.
    assert_eq!(cache.reflection(point, V::Y, V::new(0.0, -1.0, 0.0), 0.5, 8).unwrap(), V::ZERO);
}

#[test]
fn rays_in_a_furnace_see_what_walls_scatter() {
    let (albedo, emission) = (0.6, 1.0);
    let walls = room(V::ZERO, V::new(4.0, 3.0, 2.0), 0);
    let s = scene(walls, vec![Material::new(V::splat(albedo), V::splat(emission))], vec![], 0.0);
    let all = emission / (1.0 - albedo);
    let (floor, eye) = (V::new(1.3, 0.0, 0.6), V::new(0.3, 1.0, 0.8));
    let found = lit(&s, 16, 32, 30).reflection(floor, V::Y, eye, 0.0, 1).unwrap().x;
    assert!((found / all - 1.0).abs() < 1e-3, "{found} for {all}");
}

#[test]
fn no_light_of_mirrors_crosses_a_wall() {
    let lights = vec![lamp(V::new(-2.0, 2.0, 0.3), 10.0)];
    for thickness in [0.0, 0.02, 0.1] {
        let cache = lit(&scene(rooms(thickness), vec![matt(0.7)], lights.clone(), 0.0), 24, 16, 4);
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
    let mut cache = Cache::new(&s, Settings::new(Grid::around(&s.objects, 16))).unwrap();
    cache.request_reflections(&[(V::new(2.0, 0.0, 1.0), V::Y, 0.0)], V::new(2.0, 1.0, 1.0), 1).unwrap();
    cache.gather_part((4, 4), usize::MAX).unwrap();
    let few = cache.statistics().gathered;
    assert!(few > 0 && few < 60, "{few}");
}

#[test]
fn questions_in_the_open_are_refused_by_name() {
    let mut cache = lit(&floor(), 8, 4, 1);
    for value in [0, 5000] {
        let wrong = cache.reflection(V::ZERO, V::Y, V::Y, 0.5, value);
        assert!(matches!(wrong, Err(LightError::Value { what: "rays", .. })));
    }
    let none = cache.request_radiances(&[(V::ZERO, V::ZERO)]);
    assert!(matches!(none, Err(LightError::Direction { .. })));
    assert!(matches!(cache.reflection(V::ZERO, V::Y, V::Y, 1.5, 4), Err(LightError::Value { .. })));
    assert!(matches!(cache.reflection(V::ZERO, V::Y, V::NAN, 0.5, 4), Err(LightError::Value { .. })));
    assert!(matches!(
        cache.request_reflections(&[(V::ZERO, V::ZERO, 0.5)], V::Y, 4),
        Err(LightError::Direction { .. })
    ));
    // An eye in the point itself, and points far away.
    assert_eq!(cache.reflection(V::ZERO, V::Y, V::ZERO, 0.5, 4), Ok(V::ZERO));
    assert_eq!(cache.request_radiances(&[(V::splat(3e38), V::Y)]), Ok(vec![None]));
}
