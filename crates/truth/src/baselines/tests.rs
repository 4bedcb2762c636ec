use glam::Vec3;

use super::*;
use casca_scenes::world::{Camera, Motion, Object, Shape};

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
fn both_find_what_is_seen_and_drop_what_is_hidden() {
    let (objects, camera) = scene();
    let all: Vec<usize> = (0..objects.len()).collect();
    let mut hzb = Hzb::new(240, 160);
    let mut rays = RayBuffer::new(&objects, 240, 160);
    let sorted = |mut v: Vec<usize>| {
        v.sort_unstable();
        v
    };
    assert_eq!(sorted(hzb.frame(&objects, &all, &camera)), [0, 2, 3]);
    assert_eq!(sorted(rays.frame(&objects, &all, &camera)), [0, 2, 3]);
}

#[test]
fn both_buffers_hold_the_same_depths() {
    let (objects, camera) = scene();
    let all: Vec<usize> = (0..objects.len()).collect();
    let (mut hzb, mut rays) = (Hzb::new(240, 160), RayBuffer::new(&objects, 240, 160));
    hzb.frame(&objects, &all, &camera);
    rays.frame(&objects, &all, &camera);
    let mut off = 0;
    for y in 0..160 {
        for x in 0..240 {
            let (a, b) = (hzb.depth().at(x, y), rays.depth().at(x, y));
            // The balls of the first are polyhedra.
            off += i32::from((a - b).abs() > 0.02 * a.max(b));
        }
    }
    assert!(off < 240 * 160 / 100, "{off}");
}

#[test]
fn both_lose_what_shows_through_a_gap_under_a_pixel() {
    let half = |x0: f32, x1: f32| {
        object(Shape::Box { min: Vec3::new(x0, -20.0, -10.0), max: Vec3::new(x1, 20.0, -9.0) })
    };
    let ball = object(Shape::Sphere { center: Vec3::new(0.001, 0.0, -30.0), radius: 5.0 });
    let objects = vec![half(-30.0, 0.0), half(0.002, 30.0), ball];
    let camera =
        Camera::look_at(Vec3::new(0.001, 0.0, 0.0), Vec3::new(0.001, 0.0, -1.0), 60.0, 1.5, 0.1, 100.0);
    let visible = Hzb::new(300, 200).frame(&objects, &[0, 1, 2], &camera);
    assert!(!visible.contains(&2), "sampling should miss a gap of 2 mm");
    assert!(!RayBuffer::new(&objects, 300, 200).frame(&objects, &[0, 1, 2], &camera).contains(&2));
}
