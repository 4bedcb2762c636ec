//! Bad input: errors, never a panic, and nothing that one bad triangle takes from the others.

use crate::common::{cuboid, gathered, indirect, lamp, lit, matt, room, scene, sheet, total};
use casca_radiosity::{Cache, Grid, Light, LightError, Material, Object, Scene, Settings, Sky, Triangle};
use casca_truth::cases;
use glam::{Vec3 as V, Vec3};
use proptest::prelude::*;

fn plain() -> Scene {
    scene(room(V::ZERO, V::new(4.0, 3.0, 2.0), 0), vec![matt(0.5)], vec![lamp(V::ONE, 3.0)], 0.0)
}

fn made(scene: &Scene, change: impl FnOnce(&mut Settings)) -> Result<Cache, LightError> {
    let mut settings = Settings::new(Grid::around(&scene.objects, 16));
    change(&mut settings);
    Cache::new(scene, settings)
}

#[test]
fn errors_name_what_is_wrong() {
    let s = plain();
    for cells in [0, 513] {
        let wrong = made(&s, |s| s.grid.cells = cells).unwrap_err();
        assert_eq!(wrong.to_string(), format!("the cells of grid 0: {cells} is not within 1 and 512"));
    }
    assert!(made(&s, |s| s.grid.cells = 1).is_ok());
    for max in [V::ZERO, V::splat(-1.0), V::NAN, V::INFINITY, V::new(1.0, f32::NAN, 1.0)] {
        assert!(matches!(made(&s, |s| s.grid.max = max), Err(LightError::Box { .. })), "{max}");
    }
    for rays in [0, 5000] {
        let wrong = made(&s, |s| s.lamp_rays = rays).unwrap_err();
        assert_eq!(wrong.to_string(), format!("lamp_rays 0: {rays} is not within 1 and 4096"));
    }
    let mut wrong = s.clone();
    wrong.objects[0].triangles[3].material = 7;
    let said = made(&wrong, |_| ()).unwrap_err().to_string();
    assert_eq!(said, "triangle 3 of object 0 names material 7; there are 1");
    for albedo in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
        let wrong = Scene { materials: vec![matt(albedo)], ..s.clone() };
        let error = made(&wrong, |_| ()).unwrap_err();
        assert!(matches!(error, LightError::Value { .. }), "{error}");
        assert!(error.to_string().starts_with("the albedo of material 0: "), "{error}");
    }
    let sun = |direction| Light::Sun { direction, irradiance: V::ONE, half_angle: 0.0 };
    for light in [
        lamp(V::NAN, 1.0),
        lamp(V::ZERO, -1.0),
        lamp(V::ZERO, f32::INFINITY),
        sun(V::ZERO),
        sun(V::new(f32::INFINITY, 0.0, 0.0)),
        Light::Point { position: V::ZERO, intensity: V::ONE, radius: -1.0 },
    ] {
        let wrong = Scene { lights: vec![light], ..s.clone() };
        assert!(made(&wrong, |_| ()).is_err(), "{light:?}");
        let mut cache = made(&s, |_| ()).unwrap();
        assert!(cache.set_lights(&[light]).is_err());
    }
    let wrong = Scene { sky: Sky::Even(V::NAN), ..s.clone() };
    assert!(made(&wrong, |_| ()).is_err());
    let mut cache = made(&s, |_| ()).unwrap();
    let said = cache.set_objects(vec![(1, Object::default())]).unwrap_err().to_string();
    assert_eq!(said, "a change names object 1; there are 1");
    assert!(cache.gather_part((0, 0), usize::MAX).is_err());
    assert!(cache.irradiance(V::NAN, V::Y).is_err());
    assert!(cache.irradiance(V::ZERO, V::ZERO).is_err());
    assert!(cache.request(V::ZERO, V::NAN).is_err());
    // Far away there is nothing, but no error either.
    for at in [1e9, 1e30, f32::MAX] {
        let light = cache.irradiance(V::splat(at), V::Y).unwrap();
        assert_eq!((light.indirect, light.states), (V::ZERO, 0));
    }
}

#[test]
fn an_empty_scene_has_a_sky() {
    let cache = lit(&scene(vec![], vec![], vec![], 1.0), 16, 8, 2);
    let light = indirect(&cache, V::ZERO, V::Y);
    assert!((light / std::f64::consts::PI - 1.0).abs() < 1e-6);
    assert_eq!(cache.statistics().entries, 0);
}

#[test]
fn triangles_that_cannot_be_lit_are_left_out_and_counted() {
    let mut s = plain();
    let good = total(&lit(&s, 16, 32, 6), V::new(2.0, 0.0, 1.0), V::Y);
    let bad = |a: V, b: V, c: V| Triangle { corners: [a, b, c], material: 0 };
    let all = vec![
        bad(V::NAN, V::X, V::Y),
        bad(V::ZERO, V::INFINITY, V::Y),
        bad(V::ONE, V::ONE, V::Y),
        bad(V::ZERO, V::X, V::X * 2.0),
        bad(V::splat(1e30), V::new(1e30, 0.0, 0.0), V::new(0.0, 1e30, 0.0)),
        bad(V::splat(-3e38), V::splat(3e38), V::new(3e38, -3e38, 0.0)),
        bad(V::splat(90.0), V::new(91.0, 90.0, 90.0), V::new(90.0, 91.0, 90.0)),
    ];
    s.objects.push(all.into());
    let cache = lit(&s, 16, 32, 6);
    let skipped = cache.statistics().skipped;
    assert_eq!((skipped.left_out, skipped.cut), (6, 0));
    // The last one, of an ordinary size, stretches the grid, and is lit.
    assert!(cache.statistics().dims[0] > 4);
    let found = total(&cache, V::new(2.0, 0.0, 1.0), V::Y);
    assert!((found / good - 1.0).abs() < 0.3, "{found}, {good}");
}

#[test]
fn one_object_far_away_does_not_turn_the_others_black() {
    let mut s = plain();
    let ask = |s: &Scene| {
        let cache = lit(s, 24, 32, 6);
        (total(&cache, V::new(2.0, 0.0, 1.0), V::Y), cache.statistics())
    };
    let (good, before) = ask(&s);
    for size in [1e6, 1e12, 1e30] {
        let corner = V::splat(size);
        let mut triangles = cuboid(corner, corner * 2.0, 0);
        triangles.truncate(if size < 1e8 { 4 } else { 12 });
        let count = triangles.len();
        s.objects.truncate(1);
        s.objects.push(triangles.into());
        let (found, after) = ask(&s);
        assert_eq!((found, after.entries), (good, before.entries), "{size}");
        assert_eq!(after.skipped.left_out, count);
    }
}

#[test]
fn a_floor_of_a_thousand_kilometres_is_cut_to_the_grid() {
    let mut s = plain();
    let floor = sheet(V::new(-1e6, -0.5, -1e6), V::Z * 2e6, V::X * 2e6, 0);
    s.objects.push(floor.into());
    (s.lights, s.sky) = (Vec::new(), Sky::Even(V::ONE));
    let cache = lit(&s, 24, 32, 6);
    assert_eq!(cache.statistics().skipped.cut, 0, "{:?}", cache.statistics());
    let settings = Settings::new(Grid { min: V::splat(-1.0), max: V::splat(5.0), cells: 24 });
    let mut cache = gathered(&s, settings, 16);
    assert_eq!(cache.statistics().skipped.cut, 2);
    // The floor hides the sky below it.
    cache.pass();
    assert!((indirect(&cache, V::new(4.8, -0.5, 4.8), V::Y) / std::f64::consts::PI - 0.95).abs() < 0.05);
}

#[test]
#[ignore = "takes a minute and 2 GB"]
fn too_much_is_refused_before_memory_ends() {
    // 512 sheets through all of a grid of 512 cells touch 2^27 cells.
    let mut all = Vec::new();
    for i in 0..512 {
        all.extend(sheet(V::new(0.0, i as f32 + 0.5, 0.0), V::Z * 512.0, V::X * 512.0, 0));
    }
    let s = scene(all, vec![matt(0.5)], vec![], 0.0);
    let found = Cache::new(&s, Settings::new(Grid::around(&s.objects, 512)));
    assert_eq!(found.unwrap_err(), LightError::TooManyReferences);
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -5.0_f32..5.0,
        // Triangles that touch, lie in one plane or in faces of cells, and have no area.
        4 => (-4..=4_i32).prop_map(|i| i as f32),
        1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(1e30_f32), Just(-1e-30_f32), Just(1e9)],
    ]
}

fn vector() -> impl Strategy<Value = Vec3> {
    [number(), number(), number()].prop_map(Vec3::from_array)
}

proptest! {
    #![proptest_config(cases(96))]

    #[test]
    fn any_triangles_give_finite_light(
        corners in prop::collection::vec([vector(), vector(), vector()], 0..24),
        (cells, glow) in (1u32..20, 0.0_f32..2.0),
        (point, normal) in (vector(), vector()),
        (at, way) in (vector(), vector()),
    ) {
        let triangles = corners.iter().enumerate();
        let of = |(i, c): (usize, &[Vec3; 3])| Triangle { corners: *c, material: i as u32 % 2 };
        let materials = vec![matt(0.9), Material::new(V::splat(0.3), V::splat(glow))];
        let s = scene(triangles.map(of).collect(), materials, vec![], 1.0);
        let Ok(mut cache) = Cache::new(&s, Settings::new(Grid::around(&s.objects, cells))) else {
            return Ok(());
        };
        let lights = [lamp(at, 1.0), Light::Sun { direction: way, irradiance: V::ONE, half_angle: 0.1 }];
        _ = cache.set_lights(&lights);
        _ = cache.request(point, normal);
        cache.request_all();
        cache.gather(4).unwrap();
        cache.direct();
        (0..3).for_each(|_| _ = cache.pass());
        let moved: Vec<_> = s.objects[0].triangles.iter().take(4).copied().collect();
        cache.set_objects(vec![(0, moved.into())]).unwrap();
        cache.gather(4).unwrap();
        cache.direct();
        cache.pass();
        if let Ok(light) = cache.irradiance(point, normal) {
            prop_assert!(light.direct.is_finite() && light.indirect.is_finite());
            prop_assert!(light.direct.min_element() >= 0.0 && light.indirect.min_element() >= 0.0);
        }
    }
}
