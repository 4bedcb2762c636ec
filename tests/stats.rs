//! The numbers of a query say the same in a fresh query and in one that ran before, and count what
//! they say.

use std::sync::Arc;

use casca::{Aabb, GridSpec, Method, ObjectDesc, PointOptions, Query, Scene, Stats, TriMesh, View};
use casca_scenes::drive::{Driver, grid_for, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::FRAME_SECONDS;
use glam::{UVec3, Vec3};

fn methods() -> [Method; 5] {
    let options = PointOptions::default;
    [
        Method::point(),
        Method::Point(options().max_occluders(20)),
        Method::Point(options().refine_budget(50)),
        Method::cell(),
        Method::Frustum,
    ]
}

fn query(method: Method) -> Query {
    Query::with_method(method).unwrap()
}

fn point(query: &Query) -> Stats {
    let stats = *query.pvs().stats();
    assert!(stats.occluders_useful <= stats.occluders_drawn, "{stats:?}");
    stats
}

#[test]
fn queries_that_ran_before_count_as_fresh_ones() {
    let mut used = methods().map(query);
    let (mut useful, mut refined, mut hidden) = (0, 0, 0);
    for (kind, scale) in [
        (SceneKind::City, 0.3),
        (SceneKind::Rocks, 0.2),
        (SceneKind::Town, 0.1),
        (SceneKind::SpheresMeshes, 0.2),
        (SceneKind::Crowd, 0.02),
    ] {
        let mut world = build(kind, &SceneOptions { seed: 4, frames: 40, scale, ..Default::default() });
        let mut driver = Driver::new(&world, &grid_for(&world.grid, None).unwrap(), |_| ()).unwrap();
        for frame in (0..world.frames).step_by(8) {
            let moved = world.set_frame(frame);
            driver.scene.begin_frame(frame as f64 * FRAME_SECONDS).unwrap();
            driver.update(&world.objects, &moved).unwrap();
            let camera = world.camera(frame, 1.5);
            let views = [
                view_of(&camera).unwrap(),
                view_of(&camera).unwrap().with_reach(0.1).unwrap(),
                View::omnidirectional(camera.eye).unwrap(),
            ];
            for view in &views {
                for (query, method) in used.iter_mut().zip(methods()) {
                    let mut fresh = self::query(method);
                    let expected = fresh.run(&driver.scene, view).visible().to_vec();
                    query.run(&driver.scene, view);
                    assert_eq!(query.pvs().visible(), expected, "{kind:?} {frame} {method:?}");
                    assert_eq!(query.pvs().stats(), fresh.pvs().stats(), "{kind:?} {frame} {method:?}");
                    let stats = point(query);
                    useful += stats.occluders_useful;
                    refined += stats.refined;
                    hidden += stats.cells_hidden;
                }
                // Methods take turns in a query, too.
                used.rotate_left(1);
                for (query, method) in used.iter_mut().zip(methods()) {
                    query.set_method(method).unwrap();
                }
            }
            driver.scene.end_frame([used[0].pvs()]).unwrap();
        }
    }
    assert!(useful > 1000 && refined > 100 && hidden > 1000, "{useful} {refined} {hidden}");
}

fn grid() -> Scene {
    Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(64) }).unwrap()
}

/// A wall of `n` squares along each side, from a corner along y and z, with waves this deep.
fn wall(at: Vec3, size: f32, n: u32, deep: f32) -> Arc<TriMesh> {
    let corner = |i: u32| {
        let (y, z) = ((i % (n + 1)) as f32 * size / n as f32, (i / (n + 1)) as f32 * size / n as f32);
        at + Vec3::new(deep * (y * 0.3).sin() * (z * 0.3).cos(), y, z)
    };
    let square = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    let corners = (0..(n + 1) * (n + 1)).map(corner).collect();
    Arc::new(TriMesh::new(corners, (0..n * n).flat_map(square).collect()).unwrap())
}

fn insert(scene: &mut Scene, mesh: Arc<TriMesh>) {
    scene.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh)).unwrap();
}

fn eye() -> View {
    View::omnidirectional(Vec3::new(4.5, 32.5, 32.5)).unwrap()
}

#[test]
fn useful_occluders_are_objects() {
    // Meshes side by side, that are drawn together.
    let mut scene = grid();
    for i in 0..9 {
        insert(
            &mut scene,
            wall(Vec3::new(20.0, 2.0 + 20.0 * (i % 3) as f32, 2.0 + 20.0 * (i / 3) as f32), 18.0, 4, 0.0),
        );
    }
    // Boxes before them.
    for i in 0..4 {
        let b = Aabb::from_center(
            Vec3::new(12.0, 29.0 + 6.0 * (i % 2) as f32, 29.0 + 6.0 * (i / 2) as f32),
            Vec3::splat(2.0),
        );
        scene.insert(ObjectDesc::fixed(b).occluder(b)).unwrap();
    }
    let mut query = Query::new();
    query.run(&scene, &eye());
    let stats = point(&query);
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (13, 13), "{stats:?}");

    // One large mesh of many patches, that is drawn shell by shell.
    let mut scene = grid();
    insert(&mut scene, wall(Vec3::new(9.0, 0.5, 0.5), 63.0, 80, 4.0));
    query.run(&scene, &eye());
    let stats = point(&query);
    assert!(stats.patches_drawn > 20, "{stats:?}");
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (1, 1), "{stats:?}");

    // A mesh, solid inside and drawn beside its solid, is one object.
    let mut scene = grid();
    for i in 0..3 {
        insert(&mut scene, ball(Vec3::new(20.0, 20.0 + 12.0 * i as f32, 32.0), 4.0));
    }
    query.run(&scene, &eye());
    let stats = point(&query);
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (3, 3), "{stats:?}");
}

/// A bumpy ball of triangles.
fn ball(middle: Vec3, radius: f32) -> Arc<TriMesh> {
    let (rings, around) = (12, 24);
    let corner = |i: u32| {
        let (a, b) = (i / around, i % around);
        let (a, b) = (
            a as f32 / rings as f32 * std::f32::consts::PI,
            b as f32 / around as f32 * std::f32::consts::TAU,
        );
        let bump = 1.0 + 0.15 * (5.0 * a).sin() * (4.0 * b).cos();
        middle + Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()) * radius * bump
    };
    let at = |r: u32, i: u32| r * around + i % around;
    let quads = (0..rings)
        .flat_map(|r| (0..around).map(move |i| [at(r, i), at(r, i + 1), at(r + 1, i + 1), at(r + 1, i)]));
    let triangles = quads.flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    Arc::new(TriMesh::new((0..(rings + 1) * around).map(corner).collect(), triangles).unwrap())
}

#[test]
fn occluders_behind_others_are_of_no_use() {
    let mut scene = grid();
    let front = Aabb::new(Vec3::new(10.0, 0.0, 0.0), Vec3::new(14.0, 64.0, 64.0));
    scene.insert(ObjectDesc::fixed(front).occluder(front)).unwrap();
    // Its bounds stand out of the wall, its occluder does not.
    let inner = Aabb::new(Vec3::new(11.0, 28.0, 28.0), Vec3::new(13.0, 36.0, 36.0));
    let outer = Aabb::new(Vec3::new(9.0, 27.0, 27.0), Vec3::new(13.5, 37.0, 37.0));
    scene.insert(ObjectDesc::fixed(outer).occluder(inner)).unwrap();
    let mut query = Query::new();
    assert_eq!(query.run(&scene, &eye()).len(), 2);
    let stats = point(&query);
    // The nearer bounds come first, and their occluder is drawn before the wall. The wall covers
    // more.
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (2, 2), "{stats:?}");
    // With the wall nearer, the other is drawn after it, and covers nothing.
    let wall = Aabb::new(Vec3::new(8.0, 0.0, 0.0), Vec3::new(14.0, 64.0, 64.0));
    let mut scene = grid();
    scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
    let outer = Aabb::new(Vec3::new(8.0, 27.0, 27.0), Vec3::new(13.5, 37.0, 37.0));
    scene.insert(ObjectDesc::fixed(outer).occluder(inner)).unwrap();
    query.run(&scene, &eye());
    let stats = point(&query);
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (2, 1), "{stats:?}");
}
