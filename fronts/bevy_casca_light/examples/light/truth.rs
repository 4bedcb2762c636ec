//! What pictures must show, by the processor: surfaces by texels, and balls by probes.

use casca_lightmap::{Backs, Level, Light, Probes, on_page};
use casca_radiosity::lit::LitTriangle;
use casca_radiosity::lit::path::PathTracer;
use casca_scenes::world::Camera;
use casca_truth::oracle::Frustum;
use glam::{DVec3, Vec2, Vec3};

/// Points of a surface by two ways to find them are nearer than this, in metres.
const SAME: f64 = 1e-4;

/// The rays of the pixels of a camera.
pub fn rays(camera: &Camera, (width, height): (u32, u32)) -> Vec<(DVec3, DVec3)> {
    let frustum = Frustum::new(camera);
    let ray = |i: u32| {
        let (x, y) = (f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
        let (start, step) = frustum.ray(2.0 * x / f64::from(width) - 1.0, 1.0 - 2.0 * y / f64::from(height));
        (frustum.eye() + start, step)
    };
    (0..width * height).map(ray).collect()
}

/// What rays see of surfaces with lightmaps: their albedo times the mean of four texels, by distance.
pub fn mapped(level: &Level, found: &Light, rays: &[(DVec3, DVec3)]) -> Vec<Option<Vec3>> {
    let atlas = &found.atlas;
    // Their coordinates are in texels, and their objects are pages.
    let mut triangles = Vec::new();
    for (p, layout) in level.placed.iter().zip(&atlas.meshes) {
        for (place, rect) in p.places.iter().zip(&layout.instances) {
            for (t, new) in p.mesh.triangles.iter().zip(layout.indices.as_chunks::<3>().0) {
                let corners = t.map(|v| place.transform_point3(p.mesh.positions[v as usize]));
                let uv = new.map(|v| on_page(atlas, rect, layout.vertices[v as usize].uv).as_vec2());
                triangles.push(LitTriangle { corners, uv, material: 0, object: rect.page });
            }
        }
    }
    let (backs, tracer) = (Backs::new(&triangles), PathTracer::new(&level.scene));
    let pixel = |(from, step): &(DVec3, DVec3)| {
        let seen = tracer.hit(*from, *step)?;
        let (t, far) = backs.first(*from, *step)?;
        // A door may stand before it.
        let p = Some(seen.point).filter(|p| p.distance(*from + *step * far) < SAME)?;
        let t = &triangles[t];
        let [a, b, c] = t.corners.map(|p| p.as_dvec3());
        let area = (b - a).cross(c - a);
        let share = |p: DVec3, q: DVec3| (p.cross(q).dot(area) / area.length_squared()) as f32;
        let (v, w) = (share(p - a, c - a), share(b - a, p - a));
        let uv = t.uv[0] * (1.0 - v - w) + t.uv[1] * v + t.uv[2] * w - 0.5;
        let (low, part) = (uv.floor().max(Vec2::ZERO), uv.fract());
        let texel = |x: u32, y: u32| {
            let (x, y) = ((low.x as u32 + x).min(atlas.width - 1), (low.y as u32 + y).min(atlas.height - 1));
            found.texels[((t.object * atlas.height + y) * atlas.width + x) as usize]
        };
        let row = |y: u32| texel(0, y).lerp(texel(1, y), part.x);
        Some(level.scene.materials[seen.material].albedo * row(0).lerp(row(1), part.y))
    };
    rays.iter().map(pixel).collect()
}

/// Where a ray meets a ball, and the normal there.
pub fn on_ball((from, step): &(DVec3, DVec3), (middle, radius): (Vec3, f32)) -> Option<(Vec3, Vec3)> {
    let (way, to) = (step.normalize(), middle.as_dvec3() - *from);
    let under = f64::from(radius).powi(2) - (to.length_squared() - to.dot(way).powi(2));
    let at = *from + way * (to.dot(way) - (under >= 0.0).then(|| under.sqrt())?);
    Some((at.as_vec3(), (at - middle.as_dvec3()).normalize().as_vec3()))
}

/// The light of probes on a white surface: ambient cubes, mixed by distance.
pub fn by_probes(probes: &Probes, at: Vec3, normal: Vec3) -> Vec3 {
    let counts = probes.counts.as_vec3();
    let place = (at - probes.min) / (probes.max - probes.min) * counts;
    let place = place.clamp(Vec3::splat(0.5), counts - 0.5) - 0.5;
    let (low, part) = (place.floor(), place.fract());
    let mut sum = Vec3::ZERO;
    for i in 0..8_u32 {
        let bit = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let weight = (bit * part + (1.0 - bit) * (1.0 - part)).element_product();
        let [x, y, z] = (low + bit).min(counts - 1.0).as_uvec3().to_array();
        let cube = probes.cubes[((z * probes.counts.y + y) * probes.counts.x + x) as usize];
        for axis in 0..3 {
            let face = 2 * axis + usize::from(normal[axis] < 0.0);
            sum += cube[face] * (normal[axis] * normal[axis] * weight);
        }
    }
    sum
}
