use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use rand::RngExt;

use super::*;
use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{Camera, Mesh, Motion, Object, Shape};

fn object(shape: Shape) -> Object {
    Object { name: String::new(), shape, motion: Motion::Static, occludes: true, tested: true }
}

fn scene() -> (Vec<Object>, Camera) {
    let wall = |z: f32, half: f32| {
        object(Shape::Box { min: Vec3::new(-half, -half, z - 0.5), max: Vec3::new(half, half, z) })
    };
    let ball = |x: f32, z: f32, radius| object(Shape::Sphere { center: Vec3::new(x, 0.0, z), radius });
    // A wall; behind it a small ball and a wall that looks out; beside it a ball, behind that
    // another.
    let objects = vec![
        wall(-10.0, 3.0),
        ball(0.0, -20.0, 1.0),
        wall(-30.0, 20.0),
        ball(6.0, -10.0, 2.0),
        ball(13.0, -22.0, 1.0),
    ];
    (objects, Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 80.0, 1.5, 0.1, 100.0))
}

#[test]
fn it_finds_what_is_seen_and_drops_what_is_hidden() {
    let (objects, camera) = scene();
    let all: Vec<usize> = (0..objects.len()).collect();
    let mut found = Hzb::new(240, 160).frame(&objects, &all, &camera);
    found.sort_unstable();
    assert_eq!(found, [0, 2, 3]);
}

#[test]
fn it_loses_what_shows_through_a_gap_under_a_pixel() {
    let half = |x0: f32, x1: f32| {
        object(Shape::Box { min: Vec3::new(x0, -20.0, -10.0), max: Vec3::new(x1, 20.0, -9.0) })
    };
    let ball = object(Shape::Sphere { center: Vec3::new(0.001, 0.0, -30.0), radius: 5.0 });
    let objects = vec![half(-30.0, 0.0), half(0.002, 30.0), ball];
    let camera =
        Camera::look_at(Vec3::new(0.001, 0.0, 0.0), Vec3::new(0.001, 0.0, -1.0), 60.0, 1.5, 0.1, 100.0);
    let visible = Hzb::new(300, 200).frame(&objects, &[0, 1, 2], &camera);
    assert!(!visible.contains(&2), "sampling should miss a gap of 2 mm");
}

fn placed(mesh: Mesh, transform: Affine3A) -> Object {
    object(Shape::Mesh { mesh: Arc::new(mesh), transform })
}

/// Triangles of all sizes and directions around the eye and before it.
fn soup(random: &mut Generator, count: u32) -> Mesh {
    let mut soup = Mesh::default();
    for i in 0..count {
        let middle = Vec3::new(random.random(), random.random(), random.random()) - Vec3::new(0.5, 0.5, 0.9);
        let size = 0.05 + 20.0 * random.random::<f32>().powi(4);
        for _ in 0..3 {
            let corner = Vec3::new(random.random(), random.random(), random.random()) - 0.5;
            soup.positions.push(middle * 20.0 + corner * size);
        }
        soup.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    soup
}

/// Nearness of a triangle along a ray whose points have depth 1 a step; 0 if the ray misses it.
fn nearness(step: DVec3, [a, b, c]: [DVec3; 3], near: f64) -> f64 {
    let (e, f) = (b - a, c - a);
    let p = step.cross(f);
    let inverse = 1.0 / e.dot(p);
    let (u, q) = (-a.dot(p) * inverse, (-a).cross(e));
    let (v, t) = (step.dot(q) * inverse, f.dot(q) * inverse);
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= near { 1.0 / t } else { 0.0 }
}

#[test]
fn depths_are_those_of_rays_through_the_middles_of_pixels() {
    let (width, height) = (100, 61);
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, 100.0 / 61.0, 0.1, 100.0);
    let inverse = camera.view_projection().as_dmat4().inverse();
    let step = |x: f64, y: f64| {
        let clip = DVec3::new(x / f64::from(width) * 2.0 - 1.0, 1.0 - y / f64::from(height) * 2.0, 0.5);
        let p = inverse.project_point3(clip);
        p / -p.z
    };
    let mut random = generator(1, 0);
    let (mut covered, mut doubtful) = (0, 0);
    for _ in 0..20 {
        let mesh = soup(&mut random, 60);
        let corners: Vec<[DVec3; 3]> =
            mesh.triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize].as_dvec3())).collect();
        let mut hzb = Hzb::new(width as usize, height as usize);
        hzb.draw_all(&[placed(mesh, Affine3A::IDENTITY)], [0], &camera);
        for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            // A triangle that rays around the middle miss or hit may be missed or hit by rounding.
            const OFF: f64 = 0.01;
            let around = [(0.0, 0.0), (OFF, OFF), (-OFF, OFF), (OFF, -OFF), (-OFF, -OFF)]
                .map(|(dx, dy)| step(f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy));
            let (mut must, mut may) = (0.0f64, 0.0f64);
            for &triangle in &corners {
                let hits = around.map(|step| nearness(step, triangle, 0.1));
                must = must.max(hits.into_iter().fold(f64::INFINITY, f64::min));
                may = may.max(hits.into_iter().fold(0.0, f64::max));
            }
            let found = f64::from(hzb.depth().at(x as usize, y as usize));
            assert!(must * 0.999 <= found && found <= may * 1.001, "{x} {y}: {must} {found} {may}");
            covered += u32::from(found > 0.0);
            doubtful += u32::from(may > must * 1.01);
        }
    }
    assert!(covered > 30_000 && doubtful < covered / 10, "{covered} covered, {doubtful} doubtful");
}

#[test]
fn neighbours_leave_no_pixel_between_them() {
    // Eight pixels a metre in every direction: corners lie on middles and on borders of pixels, and
    // anywhere.
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 90.0, 1.0, 0.1, 100.0);
    let mut random = generator(2, 0);
    for round in 0..20 {
        let mesh = Mesh::sheet(16, 16, |i, j| {
            let mut jitter = || match round % 2 {
                0 => (random.random_range(-3..=3i32) as f32) / 16.0,
                _ => random.random::<f32>() * 0.4 - 0.2,
            };
            let [x, y] = [i, j].map(|k| (k as f32 - 8.0) * 0.6 + jitter());
            Vec3::new(x, y, -4.0)
        });
        let mut hzb = Hzb::new(64, 64);
        hzb.draw_all(&[placed(mesh, Affine3A::IDENTITY)], [0], &camera);
        for (x, y) in (0..64).flat_map(|x| (0..64).map(move |y| (x, y))) {
            let near = hzb.depth().at(x, y);
            assert!((near - 0.25).abs() < 1e-4, "round {round}, pixel {x} {y}: {near}");
        }
    }
}

#[test]
fn a_closed_mesh_looks_the_same_without_its_backs_mirrored_or_not() {
    let camera = Camera::look_at(Vec3::new(0.3, 0.2, 4.0), Vec3::ZERO, 60.0, 1.5, 0.1, 100.0);
    let closed = Mesh::ball(2);
    // A triangle behind the camera opens it.
    let mut open = closed.clone();
    let first = open.positions.len() as u32;
    open.positions.extend([Vec3::new(0.0, 0.0, 50.0), Vec3::new(1.0, 0.0, 50.0), Vec3::new(0.0, 1.0, 50.0)]);
    open.triangles.push([first, first + 1, first + 2]);
    assert!(closed.is_closed() && !open.is_closed());
    for scale in [Vec3::new(1.0, 0.7, 1.2), Vec3::new(-1.0, 0.7, 1.2)] {
        let transform = Affine3A::from_scale(scale);
        let [a, b] = [&closed, &open].map(|mesh| {
            let mut hzb = Hzb::new(96, 64);
            hzb.draw_all(&[placed(mesh.clone(), transform)], [0], &camera);
            hzb
        });
        let differs = |(x, y): &(usize, usize)| a.depth().at(*x, *y) != b.depth().at(*x, *y);
        assert_eq!((0..96).flat_map(|x| (0..64).map(move |y| (x, y))).filter(differs).count(), 0);
        assert!(a.depth().at(48, 32) > 0.2);
    }
}
