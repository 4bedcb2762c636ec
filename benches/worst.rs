//! What costs most for its size: solids that fill the grid, crowds in one place, emptiness, and
//! meshes of few but large triangles.
//!
//! `cargo bench --bench worst`

use std::hint::black_box;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;

use casca::{
    Aabb, Bounds, Convex, GridSpec, MeshOptions, Method, Obb, ObjectDesc, ObjectId, Occluder, Query, Scene,
    Sphere, TriMesh, View,
};
use criterion::Criterion;
use glam::{Quat, UVec3, Vec3};

fn scene(cells: u32) -> Scene {
    let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(cells) };
    Scene::new(&spec).expect("a plain grid")
}

fn with(method: Method) -> Query {
    Query::with_method(method).expect("settings within their ranges")
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

/// Grids of 8192^3 cells with nothing in them, or next to nothing.
fn emptiness(c: &mut Criterion) {
    let mut group = c.benchmark_group("8192^3 cells, all round");
    group.sample_size(10).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    let mut scene = scene(8192);
    for filled in [false, true] {
        if filled {
            for i in 0..8 {
                let at = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 8188.0 + 2.0;
                scene.insert(ObjectDesc::fixed(Sphere::new(at, 0.4))).expect("a ball");
            }
        }
        let what = if filled { "a ball in each corner" } else { "nothing" };
        for (name, eye) in [("inside", Vec3::splat(4096.3)), ("outside", Vec3::new(-900.0, 2000.3, 5000.0))] {
            let view = View::omnidirectional(eye).expect("a finite eye");
            for method in [Method::point(), Method::cell()] {
                let mut query = with(method);
                group.bench_function(format!("{method:?}, {what}, eye {name}"), |b| {
                    b.iter(|| query.run(&scene, &view).len());
                });
            }
        }
    }
    group.finish();
}

/// A box of twelve triangles.
fn cuboid(min: Vec3, max: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| {
        let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
        Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// Meshes whose few triangles span many cells, and one whose outline is all teeth.
fn meshes(c: &mut Criterion) {
    let mut group = c.benchmark_group("meshes");
    group.sample_size(10).measurement_time(Duration::from_secs(4)).warm_up_time(Duration::from_millis(500));
    let turn = Quat::from_rotation_y(0.6) * Quat::from_rotation_x(0.5);
    let middle = Vec3::splat(64.0);
    let (corners, triangles) = cuboid(Vec3::splat(-36.0), Vec3::splat(36.0));
    let corners = corners.into_iter().map(|p| middle + turn * p).collect();
    let turned = Arc::new(TriMesh::new(corners, triangles).expect("a closed box"));
    let mut scene = scene(128);
    let desc = ObjectDesc::fixed(turned.clone()).occluder(turned);
    group.bench_function("a turned box of 12 triangles in 128^3 cells, in and out", |b| {
        b.iter(|| in_and_out(&mut scene, desc.clone()));
    });
    // Each triangle crosses a good part of the grid.
    let part = |i: u32, k: u32| ((i * k) % 101) as f32 * 1.2;
    let soup: Vec<Vec3> = (0..60).map(|i| Vec3::new(part(i, 37), part(i, 53), part(i, 71)) + 3.0).collect();
    let soup = TriMesh::new(soup, (0..20).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect());
    let soup = Arc::new(soup.expect("triangles"));
    let desc = ObjectDesc::fixed(soup.clone()).occluder(soup);
    group.bench_function("20 slanted triangles across 128^3 cells, in and out", |b| {
        b.iter(|| in_and_out(&mut scene, desc.clone()));
    });
    // A flat comb: a strip, and a tooth at every other of its corners.
    let teeth = 1000;
    let mut comb = Vec::new();
    for i in 0..=2 * teeth {
        comb.extend([Vec3::new(i as f32, 0.0, 0.0), Vec3::new(i as f32, 1.0, 0.0)]);
    }
    let mut strips = Vec::new();
    for i in 0..2 * teeth {
        let at = 2 * i;
        strips.extend([[at, at + 2, at + 1], [at + 2, at + 3, at + 1]]);
        if i % 2 == 0 {
            let tip = comb.len() as u32;
            comb.push(Vec3::new(i as f32 + 0.5, 60.0, 0.0));
            strips.push([at + 1, at + 3, tip]);
        }
    }
    group.bench_function("a comb of 1000 teeth, prepared", |b| {
        b.iter(|| {
            let how = MeshOptions::default();
            let mesh =
                TriMesh::prepare(comb.clone(), strips.clone(), &how, &mut |_| ControlFlow::Continue(()));
            black_box(mesh.expect("triangles").sides())
        });
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    filling(&mut criterion);
    crowd(&mut criterion);
    emptiness(&mut criterion);
    meshes(&mut criterion);
    criterion.final_summary();
}
