//! A level lit by its lightmap beside a path tracer: `lit LEVEL SAMPLES PNG [X,Y,Z X,Y,Z]`, where the
//! points are the eye and what it looks at.

use std::error::Error;
use std::path::Path;

use casca_lightmap::{Backs, Level, Settings, light, on_page};
use casca_radiosity::lit::LitTriangle;
use casca_radiosity::lit::path::PathTracer;
use casca_scenes::world::Camera;
use casca_tools::command_line::point;
use casca_tools::image::{srgb, write_png};
use casca_truth::oracle::Frustum;
use glam::Vec3;

const SIZE: (usize, usize) = (480, 360);
/// The near plane over the far one: nearer than anything that one looks at.
const NEAR: f32 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [file, samples, png, ..] = &words[..] else { return Err("LEVEL SAMPLES PNG are needed".into()) };
    let bytes = std::fs::read(file)?;
    let mut level = Level::read("level", &bytes, Path::new(file).parent())?;
    let (_, far) = level.scene.bounds();
    if let [eye, to, ..] = &words[3..] {
        let [eye, to] = [point(eye)?.as_vec3(), point(to)?.as_vec3()];
        let far = 4.0 * (far - eye).length();
        level.scene.camera = Camera::look_at(eye, to, 60.0, 4.0 / 3.0, NEAR * far, far);
    }
    let settings = Settings { texels: 16.0, cells: 128, ..Settings::default() };
    let found = light(&level.scene, &level.placed, &settings, &mut |_, _, _| {})?;
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
    let truth = tracer.render(&level.scene.camera, SIZE, &(0..=256), samples.parse()?, 1)?;
    let frustum = Frustum::new(&level.scene.camera);
    let mapped = |i: usize| {
        let (x, y) = ((i % SIZE.0) as f64 + 0.5, (i / SIZE.0) as f64 + 0.5);
        let (start, step) = frustum.ray(2.0 * x / SIZE.0 as f64 - 1.0, 1.0 - 2.0 * y / SIZE.1 as f64);
        let Some(seen) = tracer.hit(frustum.eye() + start, step) else { return level.scene.sky };
        let material = level.scene.materials[seen.material];
        let Some((t, _)) = backs.first(frustum.eye() + start, step) else { return material.emission };
        let (t, p) = (&triangles[t], seen.point);
        let [a, b, c] = t.corners.map(|p| p.as_dvec3());
        let area = (b - a).cross(c - a);
        let share = |p: glam::DVec3, q: glam::DVec3| (p.cross(q).dot(area) / area.length_squared()) as f32;
        let (v, w) = (share(p - a, c - a), share(b - a, p - a));
        let uv = t.uv[0] * (1.0 - v - w) + t.uv[1] * v + t.uv[2] * w - 0.5;
        let (low, part) = (uv.floor().max(glam::Vec2::ZERO), uv.fract());
        let texel = |x: u32, y: u32| {
            let (x, y) = ((low.x as u32 + x).min(atlas.width - 1), (low.y as u32 + y).min(atlas.height - 1));
            found.texels[((t.object * atlas.height + y) * atlas.width + x) as usize]
        };
        let row = |y: u32| texel(0, y).lerp(texel(1, y), part.x);
        material.emission + material.albedo * seen.colour * row(0).lerp(row(1), part.y)
    };
    let left: Vec<Vec3> = (0..SIZE.0 * SIZE.1).map(mapped).collect();
    let mean = truth.image.iter().map(|c| c.element_sum() / 3.0).sum::<f32>() / truth.image.len() as f32;
    let byte = |c: f32| srgb(0.25 * c / mean);
    let rows = left.chunks(SIZE.0).zip(truth.image.chunks(SIZE.0)).flat_map(|(l, r)| [l, r].concat());
    let pixels: Vec<u8> = rows.flat_map(|c| [byte(c.x), byte(c.y), byte(c.z), 255]).collect();
    write_png(Path::new(png), (2 * SIZE.0 as u32, SIZE.1 as u32), &pixels)?;
    let sum = |p: &[Vec3]| p.iter().map(|c| c.element_sum()).sum::<f32>();
    println!(
        "mean light of the lightmap's picture over the path tracer's: {:.3}",
        sum(&left) / sum(&truth.image)
    );
    Ok(())
}
