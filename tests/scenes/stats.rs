//! The numbers of a query say the same in a fresh query and in one that ran before, and count what
//! they say.

use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::Mesh;

use crate::common::*;

fn methods() -> [Method; 4] {
    let options = PointOptions::default;
    [Method::point(), Method::Point(options().refine_budget(50)), Method::cell(), Method::Frustum]
}

fn point(query: &Query) -> Stats {
    let stats = *query.pvs().stats();
    assert!(stats.occluders_useful <= stats.occluders_drawn, "{stats:?}");
    stats
}

#[test]
fn queries_that_ran_before_count_as_fresh_ones() {
    let mut used = methods().map(query_by);
    let (mut useful, mut refined, mut hidden) = (0, 0, 0);
    for (kind, scale) in [
        (SceneKind::City, 0.3),
        (SceneKind::Rocks, 0.2),
        (SceneKind::Town, 0.1),
        (SceneKind::Harbour, 0.2),
        (SceneKind::Crowd, 0.02),
    ] {
        let mut world = build(kind, &SceneOptions { seed: 4, frames: 40, scale, ..Default::default() });
        let mut driver = driver(&world);
        for frame in (0..world.frames).step_by(8) {
            go_to(&mut driver, &mut world, frame);
            let camera = world.camera(frame, 1.5);
            let views = [
                view_of(&camera).unwrap(),
                view_of(&camera).unwrap().with_reach(0.1).unwrap(),
                around(camera.eye),
            ];
            for view in &views {
                for (query, method) in used.iter_mut().zip(methods()) {
                    let mut fresh = query_by(method);
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

/// A wall of `n` squares along each side, from a corner along y and z, with waves this deep.
fn wall(at: Vec3, size: f32, n: u32, deep: f32) -> Arc<TriMesh> {
    let (corners, triangles) = sheet(n, n, |i, j| {
        let [y, z] = [i, j].map(|i| i as f32 * size / n as f32);
        at + Vec3::new(deep * (y * 0.3).sin() * (z * 0.3).cos(), y, z)
    });
    mesh(corners, triangles)
}

fn eye() -> View {
    around(Vec3::new(4.5, 32.5, 32.5))
}

#[test]
fn useful_occluders_are_objects() {
    // Meshes side by side, that are drawn together.
    let mut scene = empty();
    for i in 0..9 {
        scene.solid(wall(
            Vec3::new(20.0, 2.0 + 20.0 * (i % 3) as f32, 2.0 + 20.0 * (i / 3) as f32),
            18.0,
            4,
            0.0,
        ));
    }
    // Boxes before them.
    for i in 0..4 {
        scene.solid(Aabb::from_center(
            Vec3::new(12.0, 29.0 + 6.0 * (i % 2) as f32, 29.0 + 6.0 * (i / 2) as f32),
            Vec3::splat(2.0),
        ));
    }
    let mut query = Query::new();
    query.run(&scene, &eye());
    let stats = point(&query);
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (13, 13), "{stats:?}");

    // One large mesh of many patches, that is drawn shell by shell.
    let mut scene = empty();
    scene.solid(wall(Vec3::new(9.0, 0.5, 0.5), 63.0, 80, 4.0));
    query.run(&scene, &eye());
    let stats = point(&query);
    assert!(stats.patches_drawn > 20, "{stats:?}");
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (1, 1), "{stats:?}");

    // A mesh, solid inside and drawn beside its solid, is one object.
    let mut scene = empty();
    for i in 0..3 {
        scene.solid(ball(Vec3::new(20.0, 20.0 + 12.0 * i as f32, 32.0), 4.0));
    }
    query.run(&scene, &eye());
    let stats = point(&query);
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (3, 3), "{stats:?}");
}

/// A bumpy ball of triangles.
fn ball(middle: Vec3, radius: f32) -> Arc<TriMesh> {
    let ball = Mesh::ball(2);
    let bump = |p: Vec3| 1.0 + 0.15 * (7.0 * p.y).sin() * (5.0 * p.x).cos();
    mesh(ball.positions.iter().map(|&p| middle + p * radius * bump(p)).collect(), ball.triangles)
}

#[test]
fn occluders_behind_others_are_of_no_use() {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(10.0, 0.0, 0.0), Vec3::new(14.0, 64.0, 64.0)));
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
    let mut scene = empty();
    scene.solid(wall);
    let outer = Aabb::new(Vec3::new(8.0, 27.0, 27.0), Vec3::new(13.5, 37.0, 37.0));
    scene.insert(ObjectDesc::fixed(outer).occluder(inner)).unwrap();
    query.run(&scene, &eye());
    let stats = point(&query);
    assert_eq!((stats.occluders_drawn, stats.occluders_useful), (2, 1), "{stats:?}");
}
