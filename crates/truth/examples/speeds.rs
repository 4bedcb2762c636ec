//! How fast the exact answers come: pixels of the item buffer, rays, and updates of moving objects.
//!
//! `cargo run --release -p casca-truth --example speeds`

use std::sync::Arc;
use std::time::Instant;

use casca_scenes::random::generator;
use casca_scenes::world::{Camera, Mesh, Motion, Object, Shape};
use casca_truth::oracle::{Frustum, ItemBuffer, Oracle, OracleOptions, RayOracle};
use glam::{Affine3A, DVec3, Vec3};
use rand::RngExt;

fn object(shape: Shape) -> Object {
    Object { name: String::new(), shape, motion: Motion::Static, occludes: true, tested: true }
}

fn sphere(x: f32, y: f32, z: f32, radius: f32) -> Object {
    object(Shape::Sphere { center: Vec3::new(x, y, z), radius })
}

fn cuboid(min: [f32; 3], max: [f32; 3]) -> Object {
    object(Shape::Box { min: min.into(), max: max.into() })
}

fn dynamic(object: Object) -> Object {
    Object { motion: Motion::Dynamic { max_speed: 1.0 }, ..object }
}

/// The corners of the box around a shape.
fn bounds(shape: &Shape) -> (DVec3, DVec3) {
    match shape {
        Shape::Sphere { center, radius } => ((*center - *radius).as_dvec3(), (*center + *radius).as_dvec3()),
        Shape::Box { min, max } => (min.as_dvec3(), max.as_dvec3()),
        Shape::Mesh { mesh, transform } => {
            let places = mesh.positions.iter().map(|p| transform.transform_point3(*p).as_dvec3());
            places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)))
        }
    }
}

/// Prints the times of nine runs. They pass on the wall: several threads share the work.
fn time(name: &str, mut run: impl FnMut()) {
    let mut times: Vec<f64> = (0..9)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{name}: best {:.1} ms, median {:.1} ms", times[0], times[4]);
}

fn uv_sphere(rings: u32) -> Mesh {
    let columns = rings * 2;
    let mut mesh = Mesh::default();
    for i in 0..=rings {
        for j in 0..columns {
            let (a, b) = (
                std::f32::consts::PI * i as f32 / rings as f32,
                std::f32::consts::TAU * j as f32 / columns as f32,
            );
            mesh.positions.push(Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()));
            if i < rings {
                let (p, q) = (i * columns, i * columns + columns);
                let k = (j + 1) % columns;
                mesh.triangles.push([p + j, p + k, q + j]);
                mesh.triangles.push([p + k, q + k, q + j]);
            }
        }
    }
    mesh
}

/// Prints the speed of rays around an eye and into a camera.
fn rays(name: &str, objects: &[Object], camera: &Camera, full: &mut ItemBuffer) {
    let start = Instant::now();
    let oracle = RayOracle::new(objects);
    println!("{name}: build {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    let frustum = Frustum::new(camera);
    full.render(objects, camera);
    let mut candidates: Vec<usize> = (0..objects.len()).filter(|&i| full.visible()[i] == 0).collect();
    let start = Instant::now();
    let report = oracle.probe(objects, DVec3::ZERO, &candidates, 16, 1, |_| true);
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{name}: all round {} candidates, {} rays, {} seen, {:.2} M rays/s",
        candidates.len(),
        report.rays,
        report.seen.len(),
        report.rays as f64 / seconds * 1e-6
    );
    candidates.retain(|&i| {
        let (min, max) = bounds(&objects[i].shape);
        frustum.may_meet_box(min, max)
    });
    let start = Instant::now();
    let report = oracle.probe_camera(objects, &frustum, &candidates, 16, 1);
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{name}: camera {} rays, {} seen, {:.2} M rays/s",
        report.rays,
        report.seen.len(),
        report.rays as f64 / seconds * 1e-6
    );
}

/// Prints what a frame costs in which all of these spheres move.
fn moving(spheres: Vec<Object>, camera: &Camera) {
    let mut crowd: Vec<Object> = spheres.into_iter().map(dynamic).collect();
    let all: Vec<usize> = (0..crowd.len()).collect();
    let mut oracle = Oracle::new(&crowd, OracleOptions { samples_per_object: 8, ..OracleOptions::default() });
    let pvs = oracle.frame(&crowd, &[], camera, &|_| true).exact;
    let verdict = oracle.frame(&crowd, &[], camera, &|i| pvs.binary_search(&i).is_ok());
    println!("{} visible, {} candidates, {} rays", pvs.len(), verdict.candidates, verdict.rays);
    time("100,000 moving spheres, update and frame", || {
        for object in &mut crowd {
            let Shape::Sphere { center, .. } = &mut object.shape else { unreachable!() };
            center.x += 0.01;
        }
        let verdict = oracle.frame(&crowd, &all, camera, &|i| pvs.binary_search(&i).is_ok());
        assert!(!verdict.exact.is_empty());
    });
    let mut rays = RayOracle::new(&crowd);
    time("100,000 moving spheres, update", || rays.update(&crowd, &all));
}

fn main() {
    let mut random = generator(1, 0);
    let camera = Camera::look_at(Vec3::ZERO, Vec3::new(0.3, 0.1, -1.0), 60.0, 16.0 / 9.0, 0.1, 300.0);
    let mut full = ItemBuffer::new(1920, 1080);
    let mut make = |count: usize, radius: f32| -> Vec<Object> {
        (0..count)
            .map(|_| {
                let mut at = || random.random_range(-1.0_f32..1.0);
                let c = Vec3::new(at() * 50.0, at() * 30.0, at() * 50.0);
                let c = if c.length() < 4.0 { c + Vec3::X * 10.0 } else { c };
                sphere(c.x, c.y, c.z, radius * (1.0 + 0.5 * at()))
            })
            .collect()
    };
    let spheres = make(5000, 1.6);
    time("5,000 spheres, pixels", || full.render(&spheres, &camera));
    let boxes: Vec<Object> = spheres
        .iter()
        .map(|object| {
            let Shape::Sphere { center, radius } = object.shape else { unreachable!() };
            cuboid((center - radius).to_array(), (center + radius).to_array())
        })
        .collect();
    time("5,000 boxes, pixels", || full.render(&boxes, &camera));
    let shared = Arc::new(uv_sphere(36));
    let meshes: Vec<Object> = make(50, 5.0)
        .into_iter()
        .map(|o| {
            let Shape::Sphere { center, radius } = o.shape else { unreachable!() };
            let transform = Affine3A::from_translation(center) * Affine3A::from_scale(Vec3::splat(radius));
            object(Shape::Mesh { mesh: Arc::clone(&shared), transform })
        })
        .collect();
    let room = object(Shape::Mesh {
        mesh: Arc::new(uv_sphere(256)),
        transform: Affine3A::from_scale(Vec3::new(60.0, 30.0, 60.0)),
    });
    println!("{} triangles each", shared.triangles.len());
    time("50 meshes of 5,184 triangles, pixels", || full.render(&meshes, &camera));
    time("a room of 262,144 triangles around the eye, pixels", || {
        full.render(std::slice::from_ref(&room), &camera);
    });
    let dense = object(Shape::Mesh {
        mesh: Arc::new(uv_sphere(256)),
        transform: Affine3A::from_translation(Vec3::new(4.0, 1.0, -15.0))
            * Affine3A::from_scale(Vec3::splat(6.0)),
    });
    time("a ball of 262,144 triangles in view, pixels", || {
        full.render(std::slice::from_ref(&dense), &camera)
    });

    let mut outside = vec![room, dense];
    outside.extend(make(20_000, 0.3).into_iter().map(|mut object| {
        let Shape::Sphere { center, .. } = &mut object.shape else { unreachable!() };
        *center *= 3.0;
        object
    }));
    for (name, objects) in
        [("spheres", make(100_000, 1.0)), ("boxes", boxes), ("meshes", meshes), ("around a room", outside)]
    {
        rays(name, &objects, &camera, &mut full);
    }
    moving(make(100_000, 1.0), &camera);
}
