//! Coherent queries: they lose nothing, whatever the camera and the objects do between runs; they draw less than queries
//! that know nothing of the run before; and their sets are little larger.

use casca::{Method, PointOptions, Query, Scene};
use casca_lab::drive::{Driver, grid_for, view_of};
use casca_lab::oracle::{Oracle, OracleOptions};
use casca_lab::scenes::{SceneKind, SceneOptions, build};
use casca_lab::world::{Camera, FRAME_SECONDS, World};
use glam::{Mat3, Quat, Vec3};

const ASPECT: f32 = 16.0 / 9.0;

fn fresh() -> Query {
    Query::new()
}

fn coherent() -> Query {
    Query::with_method(Method::Point(PointOptions::default().coherent(true))).unwrap()
}

fn world(kind: SceneKind, scale: f32, frames: usize) -> World {
    build(kind, &SceneOptions { seed: 9, frames, scale, ..Default::default() })
}

fn driver(world: &World) -> Driver {
    Driver::new(world, &grid_for(&world.grid, None).unwrap(), |_| ()).unwrap()
}

/// A person who walks and looks around: 1.5 m/s and up to 90 degrees a second at 60 frames a second, from the place of a
/// camera.
fn walk(start: &Camera, frames: usize) -> Vec<Camera> {
    let mut eye = start.eye;
    let mut forward = -Mat3::from_mat4(start.view.transpose()).z_axis;
    forward = Vec3::new(forward.x, forward.y * 0.3, forward.z).normalize();
    let step = |i: usize| {
        forward = Quat::from_rotation_y((1.5f32).to_radians() * (i as f32 / 8.0).sin()) * forward;
        eye += Vec3::new(forward.x, 0.0, forward.z).normalize_or(Vec3::X) * 0.025;
        Camera::look_at(eye, eye + forward, 60.0, ASPECT, 0.1, 500.0)
    };
    (0..frames).map(step).collect()
}

/// The numbers of occluders and patches that a query drew.
fn drawn(query: &Query) -> u64 {
    let stats = query.pvs().stats();
    u64::from(stats.occluders_drawn) + u64::from(stats.patches_drawn)
}

#[test]
fn first_runs_and_those_after_a_reset_know_nothing() {
    for (kind, scale) in [(SceneKind::City, 0.5), (SceneKind::Rocks, 0.3), (SceneKind::Town, 0.1)] {
        let world = world(kind, scale, 4);
        let driver = driver(&world);
        let (mut fresh, mut coherent) = (fresh(), coherent());
        for frame in 0..world.frames {
            let view = view_of(&world.camera(frame, ASPECT)).unwrap();
            let expected = fresh.run(&driver.scene, &view).visible().to_vec();
            coherent.reset();
            assert_eq!(coherent.run(&driver.scene, &view).visible(), expected, "{kind:?}");
        }
    }
}

#[test]
fn walks_draw_less_and_find_little_more() {
    for (kind, scale) in [(SceneKind::City, 1.0), (SceneKind::Rocks, 0.5), (SceneKind::Town, 0.2)] {
        let world = world(kind, scale, 4);
        let driver = driver(&world);
        let (mut fresh, mut coherent) = (fresh(), coherent());
        let (mut work, mut found) = ([0, 0], [0, 0]);
        for view in walk(&world.camera(1, ASPECT), 40).iter().map(|camera| view_of(camera).unwrap()) {
            for (i, query) in [&mut fresh, &mut coherent].into_iter().enumerate() {
                found[i] += query.run(&driver.scene, &view).len();
                work[i] += drawn(query);
            }
        }
        assert!(work[1] * 100 < work[0] * 85, "{kind:?}: {work:?} drawn");
        assert!(found[1] * 100 < found[0] * 106, "{kind:?}: {found:?} found");
    }
}

#[test]
fn walks_lose_nothing() {
    let options =
        OracleOptions { width: 480, height: 270, samples_per_object: 2, ..OracleOptions::default() };
    let scenes = [
        (SceneKind::Crowd, 0.02),
        (SceneKind::City, 0.5),
        (SceneKind::Rocks, 0.3),
        (SceneKind::Forest, 0.3),
        (SceneKind::Terrain, 0.2),
        (SceneKind::SpheresMeshes, 0.2),
    ];
    for (kind, scale) in scenes {
        let mut world = world(kind, scale, 60);
        let mut driver = driver(&world);
        let mut query = coherent();
        let mut oracle = Oracle::new(&world.objects, options);
        // The world's own camera is far quicker: it jumps back to it after a while.
        let near = walk(&world.camera(20, ASPECT), 40);
        let cameras = near.into_iter().chain((0..20).map(|frame| world.camera(frame * 3, ASPECT)));
        for (frame, camera) in cameras.collect::<Vec<_>>().iter().enumerate() {
            let moved = world.set_frame(frame);
            driver.scene.begin_frame(frame as f64 * FRAME_SECONDS).unwrap();
            driver.update(&world.objects, &moved).unwrap();
            query.run(&driver.scene, &view_of(camera).unwrap());
            if frame % 4 == 3 {
                let sees = |i: usize| driver.sees(query.pvs(), i);
                let verdict = oracle.frame(&world.objects, &moved, camera, &sees);
                assert!(
                    verdict.false_negatives.is_empty(),
                    "{kind:?}, {frame}: {:?}",
                    verdict.false_negatives[0]
                );
            } else {
                oracle.frame(&world.objects, &moved, camera, &|_| true);
            }
            driver.scene.end_frame([query.pvs()]).unwrap();
        }
    }
}

#[test]
fn other_scenes_and_free_slots_are_no_trap() {
    let worlds = [world(SceneKind::City, 0.2, 3), world(SceneKind::Rocks, 0.2, 3)];
    let mut drivers = worlds.each_ref().map(driver);
    let mut query = coherent();
    for round in 0..6 {
        let at = round % 2;
        let view = view_of(&worlds[at].camera(round / 2, ASPECT)).unwrap();
        query.reset();
        let first = query.run(&drivers[at].scene, &view).visible().to_vec();
        // Another scene in between is as good as a reset.
        query.run(&drivers[1 - at].scene, &view);
        assert_eq!(query.run(&drivers[at].scene, &view).visible(), first);
        // The occluders of this run are gone in the next one.
        let scene: &mut Scene = &mut drivers[at].scene;
        for &id in first.iter().step_by(3) {
            scene.remove(id).unwrap();
        }
        query.run(scene, &view);
        let all = Query::with_method(Method::Frustum).unwrap().run(scene, &view).clone();
        assert!(
            query.pvs().iter().all(|id| all.contains(id) && !first.iter().step_by(3).any(|&gone| gone == id))
        );
    }
}
