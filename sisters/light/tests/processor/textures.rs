//! Textures beside closed forms: colours in a furnace, and light through holes.

use casca_radiosity::{Grid, Light, LightError, Material, Scene, Settings, Texture};
use glam::{Vec3 as V, Vec4};

use crate::closed::squares;
use crate::common::{holed, indirect, lit, matt, painted, room, scene, sheet};

/// A material with the only texture of a scene.
fn paint(albedo: f32, emission: f32) -> Material {
    Material { texture: Some(0), ..Material::new(V::splat(albedo), V::splat(emission)) }
}

#[test]
fn a_furnace_of_many_texels_glows_as_one_of_their_mean() {
    let walls = room(V::ZERO, V::splat(4.0), 0);
    // The last texel is no hole here: a mean of half, as roots are stored without loss.
    let checker = Texture::new(2, 2, [Vec4::ONE, Vec4::W, Vec4::W, Vec4::ONE]).unwrap();
    let mut s = scene(vec![], vec![paint(1.0, 1.0)], vec![], 0.0);
    (s.objects, s.textures) = (vec![painted(walls, 30.7)], vec![checker]);
    let cache = lit(&s, 12, 64, 30);
    let points: Vec<V> = (0..60).map(|i| V::new(0.1 + 0.064 * i as f32, 0.0, 2.0)).collect();
    let mean = points.iter().map(|p| indirect(&cache, *p, V::Y)).sum::<f64>() / 60.0;
    // Light of the glow itself is direct: pi / (1 - a) - pi.
    let known = std::f64::consts::PI;
    println!("{mean} of {known}");
    assert!((mean / known - 1.0).abs() < 0.01, "{mean} of {known}");
}

/// A black box of 4 x 1 x 4 metres, whose lid has a texture of tiles of 20 cm.
fn shaded(texture: Texture, lights: Vec<Light>, sky: f32) -> Scene {
    let size = V::new(4.0, 1.0, 4.0);
    let mut walls = room(V::ZERO, size, 1);
    walls.retain(|t| t.corners.iter().any(|p| p.y < 1.0));
    let mut s = scene(walls, vec![paint(0.0, 0.0), matt(0.0)], lights, sky);
    s.objects.push(painted(sheet(V::Y, V::X * 4.0, V::Z * 4.0, 0), 20.0));
    s.textures = vec![texture];
    s
}

#[test]
fn the_share_of_light_that_passes_is_that_of_the_holes() {
    let sun = Light::Sun { direction: V::NEG_Y, irradiance: V::ONE, half_angle: 0.0 };
    let mut cache = lit(&shaded(holed(), vec![sun], 1.0), 16, 256, 1);
    cache.smooth(2);
    let (mut direct, mut sky) = (0.0, 0.0);
    for i in 0..1600 {
        let (x, z) = (((i % 40) as f32 + 0.5) / 10.0, ((i / 40) as f32 + 0.31) / 10.0);
        let light = cache.irradiance(V::new(x, 0.0, z), V::Y).unwrap();
        let is_open = (x / 0.2).fract() < 0.5 && (z / 0.2).fract() >= 0.5;
        assert_eq!(light.direct.x, f32::from(u8::from(is_open)), "{x} {z}");
        direct += f64::from(light.direct.x) / 1600.0;
        sky += f64::from(light.indirect.x) / 1600.0 / std::f64::consts::PI;
    }
    let known = 0.25 * squares(4.0, 1.0);
    println!("{direct} of the sun, {sky} of the sky, not {known}");
    // The sky is that of 256 rays.
    assert!((direct - 0.25).abs() < 1e-9 && (sky / known - 1.0).abs() < 0.03, "{direct} {sky} {known}");
    // Without holes nothing passes.
    let solid = Texture::new(1, 1, [Vec4::ONE]).unwrap();
    let closed = lit(&shaded(solid, vec![sun], 1.0), 16, 16, 2);
    assert_eq!(crate::common::total(&closed, V::new(2.0, 0.0, 2.1), V::Y), 0.0);
}

#[test]
fn a_room_behind_a_wall_without_holes_is_dark_and_one_behind_holes_is_not() {
    let dark = |texture: Texture| {
        let lamp = crate::common::lamp(V::new(1.0, 1.5, 2.1), 10.0);
        let mut s =
            scene(room(V::ZERO, V::new(8.0, 3.0, 4.0), 1), vec![paint(0.7, 0.0), matt(0.7)], vec![lamp], 0.0);
        s.objects.push(painted(sheet(V::X * 4.0, V::Y * 3.0, V::Z * 4.0, 0), 7.3));
        s.textures = vec![texture];
        let cache = lit(&s, 24, 32, 6);
        let points = (0..40).map(|i| V::new(4.01 + 0.09 * i as f32, 0.0, 0.1 + 0.09 * i as f32));
        points.map(|p| crate::common::total(&cache, p, V::Y)).sum::<f64>()
    };
    let solid = Texture::new(3, 1, [Vec4::ONE, Vec4::W, Vec4::ONE]).unwrap();
    assert_eq!(dark(solid), 0.0);
    assert!(dark(holed()) > 1.0);
}

#[test]
fn textures_that_are_none_are_refused() {
    let texels = |width, height, count| Texture::new(width, height, vec![Vec4::ONE; count]).map(|_| ());
    assert_eq!(texels(2, 2, 3), Err(LightError::Texels { width: 2, height: 2, texels: 3 }));
    assert_eq!(texels(0, 2, 0), Err(LightError::Texels { width: 0, height: 2, texels: 0 }));
    let s = Scene { textures: vec![], ..shaded(holed(), vec![], 0.0) };
    let made = casca_radiosity::Cache::new(&s, Settings::new(Grid::around(&s.objects, 8))).map(|_| ());
    assert!(matches!(made, Err(LightError::Missing { what: "texture", number: 0, .. })));
    // Numbers that are none are black, and places that are none are in a corner.
    let odd = Texture::new(1, 1, [Vec4::NAN]).unwrap();
    assert_eq!(odd.at(glam::DVec2::NAN), Some(V::ZERO));
    let mut s = shaded(odd, vec![], 1.0);
    s.objects[1].uv = vec![[glam::Vec2::splat(f32::MAX), glam::Vec2::NAN, glam::Vec2::ZERO]];
    assert!(indirect(&lit(&s, 8, 8, 2), V::new(2.0, 0.0, 2.0), V::Y).is_finite());
}

/// The least light that single precision tells from none.
const FAINTEST: f32 = f32::from_bits(1);

/// Lamps that are nothing but holes, or fainter than single precision, once took any time or gave no number.
#[test]
fn lamps_without_light_are_none() {
    for (hole, glow) in [(Vec4::ZERO, 1.0), (Vec4::W, FAINTEST)] {
        let mut s = shaded(Texture::new(1, 1, [hole]).unwrap(), vec![], 0.0);
        s.materials[0].emission = V::splat(glow);
        assert_eq!(crate::common::total(&lit(&s, 16, 16, 2), V::new(2.0, 0.0, 2.1), V::Y), 0.0);
    }
}
