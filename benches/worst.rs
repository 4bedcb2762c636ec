//! What costs most for its size: solids that fill the grid, and crowds in one place. Tests count the
//! work of empty grids and of meshes (`tests/cells/work.rs`, `tests/meshes/work.rs`).
//!
//! `cargo bench --bench worst`

use std::sync::Arc;
use std::time::Duration;

use casca::{Aabb, Bounds, Convex, Obb, ObjectDesc, ObjectId, Occluder, Query, Scene, Sphere, View};
use criterion::Criterion;
use glam::{Quat, Vec3};

fn scene(_cells: u32) -> Scene {
    Scene::new(1.0).expect("a plain grid")
}

/// Puts an object in and takes it out.
fn in_and_out(scene: &mut Scene, desc: ObjectDesc) {
    let id = scene.insert(desc).expect("a plain object");
    scene.remove(id).expect("it was just inserted");
}

/// Solids that fill most of 512^3 cells.
fn filling(c: &mut Criterion) {
    let mut group = c.benchmark_group("512^3 cells, in and out");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    let middle = Vec3::splat(256.0);
    let low = Aabb::new(Vec3::splat(0.5), Vec3::splat(511.5));
    let corners: Vec<Vec3> = (0..8)
        .map(|i| middle + (Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5) * 400.0)
        .collect();
    let convex = Arc::new(Convex::from_points(&corners).expect("a cube"));
    let solids: [(&str, Bounds, Occluder); 4] = [
        ("box", low.into(), low.into()),
        ("sphere", Sphere::new(middle, 255.0).into(), Sphere::new(middle, 255.0).into()),
        (
            "turned box",
            Obb::new(middle, Vec3::splat(200.0), Quat::from_rotation_y(0.3)).into(),
            Obb::new(middle, Vec3::splat(200.0), Quat::from_rotation_y(0.3)).into(),
        ),
        ("convex", low.into(), convex.into()),
    ];
    let mut scene = scene(512);
    for (name, bounds, occluder) in &solids {
        let fixed = ObjectDesc::fixed(bounds.clone()).occluder(occluder.clone());
        group.bench_function(*name, |b| b.iter(|| in_and_out(&mut scene, fixed.clone())));
        let dynamic = ObjectDesc::dynamic(bounds.clone()).occluder(occluder.clone());
        group.bench_function(format!("{name}, dynamic"), |b| {
            b.iter(|| in_and_out(&mut scene, dynamic.clone()));
        });
    }
    let half = Aabb::new(Vec3::splat(-9.0), Vec3::new(255.3, 520.0, 520.0));
    scene.insert(ObjectDesc::fixed(half).occluder(half)).expect("a box");
    let fixed = ObjectDesc::fixed(low).occluder(low);
    group
        .bench_function("box over half as large a one", |b| b.iter(|| in_and_out(&mut scene, fixed.clone())));
    group.finish();
    let mut scene = self::scene(160);
    let mut group = c.benchmark_group("160^3 cells");
    group.sample_size(10).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    let bounds = ObjectDesc::fixed(Aabb::new(Vec3::splat(0.5), Vec3::splat(159.5)));
    group.bench_function("bounds in and out", |b| b.iter(|| in_and_out(&mut scene, bounds.clone())));
    group.finish();
}

/// 10^5 objects in one brick.
fn crowd(c: &mut Criterion) {
    const MANY: usize = 100_000;
    let place = |i: usize, frame: usize| {
        let part = |n: usize, k: usize| 8.5 + ((i + frame * k) % n) as f32 * 7.0 / n as f32;
        Sphere::new(Vec3::new(part(97, 1), part(89, 3), part(83, 2)), 0.01)
    };
    let mut group = c.benchmark_group("100000 objects in one brick");
    group.sample_size(10).measurement_time(Duration::from_secs(8)).warm_up_time(Duration::from_millis(500));
    let wall = Aabb::new(Vec3::new(6.0, 0.0, 0.0), Vec3::new(7.0, 32.0, 32.0));
    let view = View::omnidirectional(Vec3::splat(4.5)).expect("a finite eye");
    group.bench_function("insert, move, hide, remove", |b| {
        b.iter(|| {
            let mut scene = scene(32);
            let insert = |i| scene.insert(ObjectDesc::dynamic(place(i, 0)).max_speed(1.0)).expect("a ball");
            let ids: Vec<ObjectId> = (0..MANY).map(insert).collect();
            for (i, &id) in ids.iter().enumerate() {
                scene.update(id, place(i, 1), None).expect("it is there");
            }
            scene.insert(ObjectDesc::fixed(wall).occluder(wall)).expect("a wall");
            let mut query = Query::new();
            query.run(&scene, &view);
            scene.end_frame([query.pvs()]).expect("a result of this scene");
            ids.into_iter().for_each(|id| scene.remove(id).expect("it is there"));
            scene.len()
        });
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    filling(&mut criterion);
    crowd(&mut criterion);
    criterion.final_summary();
}
