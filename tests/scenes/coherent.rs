//! Coherent queries: they lose nothing, whatever the camera and the objects do between runs; they
//! draw less than queries that know nothing of the run before; and their sets are little larger.

use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::{Camera, World};
use casca_truth::oracle::{Oracle, OracleOptions};

use crate::common::worlds::cuts_triangle;
use crate::common::*;

const ASPECT: f32 = 16.0 / 9.0;

fn coherent() -> Query {
    query_by(Method::Point(PointOptions::default().coherent(true)))
}

fn world(kind: SceneKind, scale: f32, frames: usize) -> World {
    build(kind, &SceneOptions { seed: 9, frames, scale, ..Default::default() })
}

/// A person who walks and looks around: 1.5 m/s and up to 90 degrees a second at 60 frames a
/// second, from the place of a camera.
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
        let (mut fresh, mut coherent) = (Query::new(), coherent());
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
        let (mut fresh, mut coherent) = (Query::new(), coherent());
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
        (SceneKind::Leaves, 0.1),
        (SceneKind::Harbour, 0.2),
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
            let moved = go_to(&mut driver, &mut world, frame);
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
        let all = query_by(Method::Frustum).run(scene, &view).clone();
        assert!(
            query.pvs().iter().all(|id| all.contains(id) && !first.iter().step_by(3).any(|&gone| gone == id))
        );
    }
}

/// Rolling ground: `n` squares along each side of 40 m.
struct Ground {
    mesh: Arc<TriMesh>,
    triangles: Vec<[DVec3; 3]>,
}

impl Ground {
    fn new(n: u32, wave: f32) -> Self {
        let at = |i: u32| (i as f32 / n as f32 - 0.5) * 40.0;
        let (corners, triangles) = sheet(n, n, |i, j| {
            let (x, z) = (at(i), at(j));
            Vec3::new(x, 1.5 * (x * wave).sin() * (z * wave * 0.8).cos(), z)
        });
        let placed = triangles.iter().map(|t| t.map(|i| corners[i as usize].as_dvec3())).collect();
        Self { mesh: mesh(corners, triangles), triangles: placed }
    }

    /// Whether the segment between two points passes a triangle.
    fn hides(&self, from: DVec3, to: DVec3) -> bool {
        self.triangles.iter().any(|t| cuts_triangle(t, from, to))
    }
}

/// Patches are remembered by slot and number, also where a slot has another mesh now. In debug
/// builds the library checks that no two patches of a batch have triangles in common: a group and a
/// part of it would hide more than their triangles.
#[test]
fn a_slot_with_another_mesh_is_no_trap() {
    let grounds = [Ground::new(12, 0.5), Ground::new(40, 0.31), Ground::new(24, 0.9)];
    let mut scene = empty();
    let spot = |i: u32| {
        Vec3::new((i * 7 % 39) as f32 - 19.0, (i % 5) as f32 * 0.5 - 1.0, (i * 11 % 37) as f32 - 18.0)
    };
    let balls: Vec<(ObjectId, Vec3)> =
        (0..300).map(spot).map(|at| (scene.fixed(Sphere::new(at, 0.1)), at)).collect();
    let mut query = coherent();
    let mut hidden = 0;
    for round in 0..24 {
        let ground = &grounds[round * 7 % 3];
        let id = scene.solid(ground.mesh.clone());
        for step in 0..4 {
            let away = [3.0, 9.0, 20.0][(round + step) % 3];
            let eye = Vec3::new(away, 1.0 + 0.1 * away, -away);
            let found = query.run(&scene, &around(eye));
            for &(ball, at) in balls.iter().filter(|b| !found.contains(b.0)) {
                hidden += 1;
                for d in [DVec3::ZERO, DVec3::Y, DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z] {
                    let point = at.as_dvec3() + d * 0.0999;
                    assert!(ground.hides(eye.as_dvec3(), point), "{round}.{step}: {ball} at {at} from {eye}");
                }
            }
        }
        scene.remove(id).unwrap();
    }
    assert!(hidden > 1000, "{hidden}");
}
