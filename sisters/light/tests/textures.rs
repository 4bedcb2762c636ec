//! Textures beside materials that are cut out by hand.

mod common;

use casca_radiosity::{Cache, Grid, LightError, Material, Object, Scene, Settings, Texture};
use common::{indirect, lamp, lit, matt, room, scene, sheet};
use glam::{Vec2, Vec3 as V};

/// The corners of a sheet's triangles in a texture that covers it once.
fn once() -> Vec<[Vec2; 3]> {
    let [a, b, c, d] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    vec![[a, b, c], [a, c, d]]
}

/// A closed room with a floor in front of which the wall tells the colours.
fn with_floor(floor: Vec<Object>, materials: Vec<Material>, textures: Vec<Texture>) -> Scene {
    let mut s = scene(room(V::new(-2.0, -0.1, -1.0), V::new(2.0, 1.5, 1.0), 0), materials, vec![], 0.0);
    s.objects.extend(floor);
    s.lights = vec![lamp(V::new(0.1, 1.2, 0.2), 10.0)];
    s.textures = textures;
    s
}

#[test]
fn a_texture_scatters_as_the_same_colours_by_hand_do() {
    let (red, green) = (V::new(0.8, 0.1, 0.05), V::new(0.1, 0.7, 0.2));
    // Narrow texels, so that halves are not blurred into each other, nor the ends.
    let texels = (0..256).map(|i| if i % 64 < 32 { red } else { green }).collect();
    let texture = Texture::new(64, 4, texels).unwrap();
    let textured = Material { albedo_texture: Some(0), ..Material::new(V::splat(0.9), V::ZERO) };
    let x = |at: f32| V::new(at, 0.0, 1.0);
    let whole = Object { triangles: sheet(x(-1.9), V::X * 3.8, V::Z * -2.0, 1), uv: once() };
    let s = with_floor(vec![whole], vec![matt(0.5), textured], vec![texture]);
    let halves = [(-1.9, 1), (0.0, 2)].map(|(at, m)| sheet(x(at), V::X * 1.9, V::Z * -2.0, m).into());
    let plain = [red, green].map(|c| Material::new(c * 0.9, V::ZERO));
    let by_hand = with_floor(halves.into(), vec![matt(0.5), plain[0], plain[1]], vec![]);
    let (found, known) = (lit(&s, 20, 64, 8), lit(&by_hand, 20, 64, 8));
    for i in 0..12 {
        let at = V::new(-1.8 + 0.3 * i as f32, 0.3 + 0.05 * i as f32, 1.0);
        let [a, b] = [&found, &known].map(|c| c.irradiance(at, -V::Z).unwrap().indirect);
        assert!((a - b).abs().max_element() < 0.03 * b.max_element(), "{at}: {a} for {b}");
    }
    // The sides differ, so that a mean over all of it would fail.
    let side = |x| found.irradiance(V::new(x, 0.3, 1.0), -V::Z).unwrap().indirect;
    let (left, right) = (side(-1.7), side(1.7));
    assert!(left.x > 1.3 * right.x && right.y > 1.3 * left.y, "{left} {right}");
    // Rays of one's own see texels.
    let down = |x| found.radiance(V::new(x, 0.5, 0.0), -V::Y).unwrap();
    assert!(down(-0.3).x > 4.0 * down(0.3).x, "{} {}", down(-0.3), down(0.3));
}

#[test]
fn without_coordinates_and_under_many_repeats_a_texture_is_its_mean() {
    let texels = (0..256).map(|i| if (i % 16 + i / 16) % 2 == 0 { V::splat(0.9) } else { V::splat(0.1) });
    let texture = Texture::new(16, 16, texels.collect()).unwrap();
    let textured = Material { albedo_texture: Some(0), ..Material::new(V::ONE, V::ZERO) };
    let floor = |uv: Vec<[Vec2; 3]>| {
        let triangles = sheet(V::new(-1.9, 0.0, 1.0), V::X * 3.8, V::Z * -2.0, 1);
        let s = with_floor(vec![Object { triangles, uv }], vec![matt(0.5), textured], vec![texture.clone()]);
        indirect(&lit(&s, 16, 32, 6), V::new(0.4, 0.4, 1.0), -V::Z)
    };
    let known = {
        let floor = sheet(V::new(-1.9, 0.0, 1.0), V::X * 3.8, V::Z * -2.0, 1);
        let s = with_floor(vec![floor.into()], vec![matt(0.5), matt(0.5)], vec![]);
        indirect(&lit(&s, 16, 32, 6), V::new(0.4, 0.4, 1.0), -V::Z)
    };
    let many = once().iter().map(|t| t.map(|p| p * 50.0)).collect();
    let wrong = vec![[Vec2::NAN; 3]; 2];
    for uv in [vec![], many, wrong, vec![[Vec2::splat(f32::MAX); 3]; 2]] {
        let found = floor(uv.clone());
        assert!((found / known - 1.0).abs() < 0.02, "{uv:?}: {found} for {known}");
    }
}

#[test]
fn a_lamp_of_which_a_half_is_lit_gives_what_that_half_gives() {
    let lit_half = (0..256).map(|i| if i % 64 < 32 { V::splat(8.0) } else { V::ZERO }).collect();
    let lamps = |textured: bool| {
        let glow = match textured {
            true => Material { emission_texture: Some(0), ..Material::new(V::ZERO, V::new(1.0, 0.5, 0.25)) },
            false => Material::new(V::ZERO, 8.0 * V::new(1.0, 0.5, 0.25)),
        };
        let width = if textured { 2.0 } else { 1.0 };
        let triangles = sheet(V::new(-1.0, 1.3, -0.8), V::X * width, V::Z * 1.6, 1);
        let uv = if textured { once() } else { vec![] };
        let mut s = scene(
            room(V::new(-2.0, 0.0, -1.0), V::new(2.0, 1.5, 1.0), 0),
            vec![matt(0.5), glow],
            vec![],
            0.0,
        );
        s.textures = vec![Texture::new(64, 4, Vec::clone(&lit_half)).unwrap()];
        s.objects.push(Object { triangles, uv });
        let settings =
            Settings { lamp_points: 2048, lamp_rays: 512, ..Settings::new(Grid::around(&s.objects, 16)) };
        Cache::new(&s, settings).unwrap()
    };
    let (found, known) = (lamps(true), lamps(false));
    for point in [V::new(-0.5, 0.0, 0.1), V::new(1.2, 0.0, -0.4), V::new(-1.6, 0.0, 0.7)] {
        let [a, b] = [&found, &known].map(|c| c.irradiance(point, V::Y).unwrap().direct);
        assert!((a - b).abs().max_element() < 0.05 * b.max_element(), "{point}: {a} for {b}");
    }
}

#[test]
fn textures_that_are_none_are_refused_by_name() {
    assert_eq!(
        Texture::new(2, 2, vec![V::ONE; 3]),
        Err(LightError::Texels { width: 2, height: 2, texels: 3 })
    );
    assert_eq!(Texture::new(0, 2, vec![]), Err(LightError::Texels { width: 0, height: 2, texels: 0 }));
    assert!(matches!(Texture::new(1, 1, vec![V::NAN]), Err(LightError::Value { index: 0, .. })));
    let texture = Texture::new(1, 1, vec![V::splat(1.5)]).unwrap();
    let try_it = |material: Material, uv: Vec<[Vec2; 3]>| {
        let triangles = sheet(V::ZERO, V::X, V::Y, 0);
        let s = Scene {
            objects: vec![Object { triangles, uv }],
            materials: vec![material],
            textures: vec![texture.clone()],
            ..Scene::default()
        };
        Cache::new(&s, Settings::new(Grid::around(&s.objects, 8))).map(|_| ())
    };
    let with = |albedo, texture| Material {
        albedo_texture: Some(texture),
        ..Material::new(V::splat(albedo), V::ZERO)
    };
    assert_eq!(try_it(with(0.6, 0), once()), Ok(()));
    assert!(matches!(try_it(with(0.7, 0), once()), Err(LightError::Value { .. })));
    assert_eq!(try_it(with(0.6, 3), once()), Err(LightError::Texture { material: 0, texture: 3, count: 1 }));
    let some = once()[..1].to_vec();
    let error = LightError::Coordinates { object: 0, coordinates: 1, triangles: 2 };
    assert_eq!(try_it(with(0.6, 0), some), Err(error));
}
