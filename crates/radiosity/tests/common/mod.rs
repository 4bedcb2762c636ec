//! Scenes of boxes and sheets, and what tests ask of them.
#![allow(dead_code)]

use casca_radiosity::{Cache, Grid, Light, Material, Object, Scene, Settings, Sky, Triangle};
use glam::{Affine3A, Quat, Vec3};

/// A material that only scatters.
pub fn matt(albedo: f32) -> Material {
    Material { albedo: Vec3::splat(albedo), emission: Vec3::ZERO }
}

/// A parallelogram whose front is on the side of `u.cross(v)`.
pub fn sheet(corner: Vec3, u: Vec3, v: Vec3, material: u32) -> Vec<Triangle> {
    let [a, b, c, d] = [corner, corner + u, corner + u + v, corner + v];
    [[a, b, c], [a, c, d]].map(|corners| Triangle { corners, material }).into()
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
    Scene { objects: vec![Object { triangles }], materials, lights, sky }
}

/// A white point light.
pub fn lamp(position: Vec3, intensity: f32) -> Light {
    Light::Point { position, intensity: Vec3::splat(intensity), radius: 0.0 }
}

/// All states gathered and lit.
pub fn lit(scene: &Scene, cells: u32, rays: u32, passes: u32) -> Cache {
    let mut cache = Cache::new(scene, Settings::new(Grid::around(&scene.objects, cells))).unwrap();
    cache.request_all();
    cache.gather(rays).unwrap();
    cache.direct();
    (0..passes).for_each(|_| _ = cache.pass());
    cache
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
