//! Scenes of boxes and sheets, and what tests ask of them.
#![allow(dead_code)]

use casca_radiosity::{Cache, Grid, Light, Material, Object, Scene, Settings, Sky, Texture, Triangle};
use glam::{Affine3A, Quat, Vec2, Vec3, Vec4};

/// A material that only scatters.
pub fn matt(albedo: f32) -> Material {
    Material::new(Vec3::splat(albedo), Vec3::ZERO)
}

/// A parallelogram whose front is on the side of `u.cross(v)`.
pub fn sheet(corner: Vec3, u: Vec3, v: Vec3, material: u32) -> Vec<Triangle> {
    let [a, b, c, d] = [corner, corner + u, corner + u + v, corner + v];
    [[a, b, c], [a, c, d]].map(|corners| Triangle { corners, material }).into()
}

/// The same sheets with a texture that covers each of them so many times along both sides.
pub fn painted(triangles: Vec<Triangle>, times: f32) -> Object {
    let [a, b, c, d] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|p| p * times);
    let uv = [[a, b, c], [a, c, d]].repeat(triangles.len() / 2);
    Object { triangles, uv }
}

/// Four texels: white, black, a hole, white.
pub fn holed() -> Texture {
    Texture::new(2, 2, [Vec4::ONE, Vec4::W, Vec4::ZERO, Vec4::ONE]).unwrap()
}

/// A box with its fronts outside.
pub fn cuboid(min: Vec3, max: Vec3, material: u32) -> Vec<Triangle> {
    let d = max - min;
    let [x, y, z] = [Vec3::X * d.x, Vec3::Y * d.y, Vec3::Z * d.z];
    [
        sheet(min, y, x, material),
        sheet(min, z, y, material),
        sheet(min, x, z, material),
        sheet(max, -x, -y, material),
        sheet(max, -y, -z, material),
        sheet(max, -z, -x, material),
    ]
    .concat()
}

/// A box with its fronts inside.
pub fn room(min: Vec3, max: Vec3, material: u32) -> Vec<Triangle> {
    let mut inside = cuboid(min, max, material);
    inside.iter_mut().for_each(|t| t.corners.swap(1, 2));
    inside
}

/// Triangles in another place.
pub fn placed(triangles: &[Triangle], transform: Affine3A) -> Vec<Triangle> {
    let of = |t: &Triangle| Triangle { corners: t.corners.map(|p| transform.transform_point3(p)), ..*t };
    triangles.iter().map(of).collect()
}

/// A rotation that is aligned with nothing.
pub fn turned() -> Affine3A {
    Affine3A::from_quat(Quat::from_axis_angle(Vec3::new(1.0, 2.0, 0.5).normalize(), 0.7))
}

/// One object.
pub fn scene(triangles: Vec<Triangle>, materials: Vec<Material>, lights: Vec<Light>, sky: f32) -> Scene {
    let sky = Sky::Even(Vec3::splat(sky));
    Scene { objects: vec![triangles.into()], materials, textures: vec![], lights, sky }
}

/// A sky whose radiance is linear in the height of the direction.
pub fn linear() -> Sky {
    let (horizon, zenith) = (Vec3::new(1.0, 2.0, 0.5), Vec3::new(1.5, 0.5, 0.75));
    Sky::Gradient { up: Vec3::Y * 2.0, zenith, horizon, nadir: 2.0 * horizon - zenith }
}

/// A floor of 2 metres under that sky.
pub fn floor() -> Scene {
    let floor = sheet(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    Scene { sky: linear(), ..scene(floor, vec![matt(0.5)], vec![], 0.0) }
}

/// A white point light.
pub fn lamp(position: Vec3, intensity: f32) -> Light {
    Light::Point { position, intensity: Vec3::splat(intensity), radius: 0.0 }
}

/// All states gathered and lit.
pub fn lit(scene: &Scene, cells: u32, rays: u32, passes: u32) -> Cache {
    let mut cache = gathered(scene, Settings::new(Grid::around(&scene.objects, cells)), rays);
    (0..passes).for_each(|_| _ = cache.pass());
    cache
}

/// A cache with these settings, all states gathered and lit.
pub fn gathered(scene: &Scene, settings: Settings, rays: u32) -> Cache {
    let mut cache = Cache::new(scene, settings).unwrap();
    cache.request_all();
    cache.gather(rays).unwrap();
    cache.direct();
    cache
}

/// Light after the same passes from the dark, as bits, at so many points of a floor of some metres
/// along x and z, and of a ceiling.
pub fn bits(cache: &mut Cache, count: usize, size: Vec3) -> Vec<[u32; 3]> {
    cache.darken();
    cache.direct();
    cache.darken();
    (0..4).for_each(|_| _ = cache.pass());
    let of = |i: usize| {
        let (u, v) = (i as f32 / count as f32, (i as f32 * 0.618).fract());
        [(0.0, Vec3::Y), (size.y, -Vec3::Y)].map(|(y, normal)| {
            let found = cache.irradiance(Vec3::new(size.x * u, y, size.z * v), normal).unwrap();
            (found.indirect + found.direct).to_array().map(f32::to_bits)
        })
    };
    (0..count).flat_map(of).collect()
}

/// Direct and indirect irradiance together, by the mean of the channels.
pub fn total(cache: &Cache, point: Vec3, normal: Vec3) -> f64 {
    let light = cache.irradiance(point, normal).unwrap();
    f64::from((light.direct + light.indirect).element_sum()) / 3.0
}

/// The share of the indirect light alone.
pub fn indirect(cache: &Cache, point: Vec3, normal: Vec3) -> f64 {
    f64::from(cache.irradiance(point, normal).unwrap().indirect.element_sum()) / 3.0
}

/// Two rooms of 4 x 3 x 4 metres, one beside the other, on one floor and below one ceiling, with a
/// wall of a thickness between them; 0 is a sheet.
pub fn rooms(thickness: f32) -> Vec<Triangle> {
    let (low, high) = (Vec3::new(-4.3, 0.0, -2.1), Vec3::new(4.3, 3.0, 2.1));
    let mut all = Vec::new();
    let wall = |a: [f32; 3], b: [f32; 3]| cuboid(Vec3::from_array(a), Vec3::from_array(b), 0);
    let t = thickness.max(0.1);
    // One floor and one ceiling run below and above all walls.
    all.extend(wall([low.x - t, -t, low.z - t], [high.x + t, 0.0, high.z + t]));
    all.extend(wall([low.x - t, 3.0, low.z - t], [high.x + t, 3.0 + t, high.z + t]));
    all.extend(wall([low.x - t, 0.0, low.z - t], [low.x, 3.0, high.z + t]));
    all.extend(wall([high.x, 0.0, low.z - t], [high.x + t, 3.0, high.z + t]));
    all.extend(wall([low.x, 0.0, low.z - t], [high.x, 3.0, low.z]));
    all.extend(wall([low.x, 0.0, high.z], [high.x, 3.0, high.z + t]));
    if thickness > 0.0 {
        all.extend(wall([-0.5 * thickness, 0.0, low.z], [0.5 * thickness, 3.0, high.z]));
    } else {
        let size = high - low;
        all.extend(sheet(Vec3::new(0.0, 0.0, low.z), Vec3::Y * size.y, Vec3::Z * size.z, 0));
    }
    all
}

/// Points of the floor, the ceiling and the middle wall of a room, with normals; `side` is -1 or 1.
pub fn leak_questions(side: f32, thickness: f32) -> Vec<(Vec3, Vec3)> {
    let mut all = Vec::new();
    for i in 0..6 {
        for k in 0..6 {
            let (u, v) = ((i as f32 + 0.3) / 6.0, (k as f32 + 0.6) / 6.0);
            let (x, z) = (side * (0.5 * thickness + 0.01 + 4.0 * u), -2.0 + 4.0 * v);
            all.push((Vec3::new(x, 0.0, z), Vec3::Y));
            all.push((Vec3::new(x, 3.0, z), -Vec3::Y));
            all.push((Vec3::new(side * 0.5 * thickness, 0.05 + 2.9 * u, z), Vec3::X * side));
        }
    }
    all
}

/// The light inside a sealed box of 2 metres under a sky of radiance 1, over that of its roof: the
/// most of 80 points. Its walls have a thickness; 0 is a sheet.
pub fn sealed(thickness: f32, cells: u32, rays: u32, place: Affine3A) -> f64 {
    let mut all = cuboid(Vec3::ZERO, Vec3::splat(2.0), 0);
    if thickness > 0.0 {
        all.extend(room(Vec3::splat(thickness), Vec3::splat(2.0 - thickness), 0));
    }
    let scene = scene(placed(&all, place), vec![matt(0.7)], vec![], 1.0);
    let mut cache = Cache::new(&scene, Settings::new(Grid::around(&scene.objects, cells))).unwrap();
    let room = 2.0 - 2.0 * thickness;
    let mut inside = Vec::new();
    for i in 0..20 {
        let (u, v) = (
            thickness + room * (i as f32 + 0.3) / 20.0,
            thickness + room * (i as f32 * 0.618 + 0.31).fract(),
        );
        let (low, high) = (thickness, 2.0 - thickness);
        inside.push((Vec3::new(u, low, v), Vec3::Y));
        inside.push((Vec3::new(u, high, v), -Vec3::Y));
        inside.push((Vec3::new(low, u, v), Vec3::X));
        inside.push((Vec3::new(u, v, high), -Vec3::Z));
    }
    let roof = (Vec3::new(1.03, 2.0, 0.97), Vec3::Y);
    let at = |(p, n): (Vec3, Vec3)| (place.transform_point3(p), place.transform_vector3(n));
    for (p, n) in inside.iter().copied().chain([roof]).map(at) {
        cache.request(p, n).unwrap();
    }
    cache.gather(rays).unwrap();
    (0..8).for_each(|_| _ = cache.pass());
    let ask = |q| {
        let (p, n) = at(q);
        indirect(&cache, p, n)
    };
    let above = ask(roof);
    assert!((above / std::f64::consts::PI - 1.0).abs() < 1e-4, "{above}");
    inside.into_iter().map(ask).fold(0.0, f64::max) / above
}

/// A glowing room of 4 metres with a block. In cells of 25 cm its walls lie in faces of cells. A wall
/// in the upper face of a cell belongs to the next cell, which may lie outside of a window.
pub fn on_faces() -> Scene {
    let mut glowing = matt(0.5);
    glowing.emission = Vec3::ONE;
    let mut all = room(Vec3::ZERO, Vec3::splat(4.0), 0);
    all.extend(cuboid(Vec3::new(2.0, 0.0, 1.0), Vec3::new(2.5, 1.0, 3.0), 0));
    scene(all, vec![glowing], vec![], 0.0)
}

/// Points of its walls and of the block, with normals.
pub fn wall_questions() -> Vec<(Vec3, Vec3)> {
    let of = |i: usize| {
        let (u, v) = (0.03 + i as f32 / 16.5, 0.05 + 3.9 * (i as f32 * 0.618).fract());
        [
            (Vec3::new(4.0, u, v), -Vec3::X),
            (Vec3::new(u, 4.0, v), -Vec3::Y),
            (Vec3::new(u, v, 4.0), -Vec3::Z),
            (Vec3::new(2.0, 0.24 * u, 1.1 + 0.45 * v), -Vec3::X),
            (Vec3::new(2.5, 0.24 * u, 1.1 + 0.45 * v), Vec3::X),
        ]
    };
    (0..64).flat_map(of).collect()
}
