//! [`casca::MemoryUse`] against an allocator that counts.

mod common;

use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::Settled;
use casca_scenes::world::Mesh;
use peak_alloc::PeakAlloc;

use crate::common::*;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

const COUNT: usize = 20_000;
/// The part of the counted bytes by which a scene may be wrong: trees and tables are estimated.
const SHARE: f64 = 0.03;

/// Places that differ from each other.
fn place(i: usize) -> Vec3 {
    let share = |step: f64| (i as f64 * step).fract() as f32;
    Vec3::splat(3.0) + 250.0 * Vec3::new(share(0.754_877), share(0.569_840), share(0.438_579))
}

fn insert(scene: &mut Scene, mut desc: impl FnMut(usize) -> ObjectDesc) {
    for i in 0..COUNT {
        scene.insert(desc(i)).unwrap();
    }
}

/// Builds a scene and compares the two counts of its bytes.
fn check(name: &str, build: impl FnOnce(&mut Scene)) {
    let before = ALLOCATOR.current_usage();
    let mut scene = empty();
    build(&mut scene);
    let counted = ALLOCATOR.current_usage() - before;
    let said = scene.memory();
    let off = said.total() as f64 / counted as f64 - 1.0;
    println!("{name}: {} bytes an object, {:+.2}%: {said:?}", counted / COUNT, off * 100.0);
    assert!(off.abs() < SHARE, "{name}: {counted} bytes are counted, {} stated: {said:?}", said.total());
}

/// The allocator counts all of a program: there is one test.
#[test]
fn memory_is_as_stated_and_queries_take_none_again() {
    a_scene_states_the_bytes_that_an_allocator_counts();
    queries_take_no_memory_where_they_were_before();
}

/// Walks the same way twice.
fn queries_take_no_memory_where_they_were_before() {
    for kind in [SceneKind::Harbour, SceneKind::Town, SceneKind::Spheres, SceneKind::Leaves] {
        let options = PointOptions::new();
        let world = build(kind, &SceneOptions { frames: 40, ..SceneOptions::default() });
        let settled = Settled::new(&world, Method::Point(options)).unwrap();
        let mut query = query_by(Method::Point(options));
        let mut walk = || {
            let before = ALLOCATOR.current_usage();
            ALLOCATOR.reset_peak_usage();
            settled.views.iter().step_by(8).for_each(|view| {
                query.run(&settled.driver.scene, view);
            });
            ALLOCATOR.peak_usage() - before
        };
        let (first, second) = (walk(), walk());
        assert!(first > 0 && second == 0, "{kind:?}: {first} bytes, then {second}");
    }
}

fn a_scene_states_the_bytes_that_an_allocator_counts() {
    let ball = |i| Sphere::new(place(i), 0.4);
    let cube = |i| Aabb::new(place(i), place(i) + 1.0);
    let turned = |i: usize| Affine3A::from_rotation_translation(Quat::from_rotation_y(i as f32), place(i));
    let rock = || {
        let Mesh { positions, triangles, .. } = Mesh::ball(2);
        mesh(positions, triangles)
    };
    check("balls", |scene| insert(scene, |i| ObjectDesc::fixed(ball(i)).occluder(ball(i))));
    check("boxes that abut", |scene| {
        insert(scene, |i| {
            let at = place(i).floor();
            let solid = Aabb::new(at, at + 2.0);
            ObjectDesc::fixed(solid).occluder(solid)
        });
    });
    check("convex solids", |scene| {
        insert(scene, |i| {
            let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|p| p + place(i));
            ObjectDesc::fixed(cube(i)).occluder(Arc::new(Convex::from_points(&corners).unwrap()))
        });
    });
    check("movers, hidden", |scene| {
        insert(scene, |i| ObjectDesc::dynamic(ball(i)).max_speed(2.0));
        look_away(scene);
    });
    check("movers in lists of cells", |scene| {
        insert(scene, |i| ObjectDesc::dynamic(ball(i)).max_speed(2.0).occluder(ball(i)));
        query_by(Method::cell()).run(scene, &around(Vec3::ONE));
    });
    check("movers whose volumes leave the grid", |scene| {
        let floor = |i| Sphere::new(place(i) * Vec3::new(1.0, 0.01, 1.0), 0.4);
        insert(scene, |i| ObjectDesc::dynamic(floor(i)).max_speed(2.0));
        look_away(scene);
    });
    check("instances of one mesh", |scene| {
        let mesh = rock();
        insert(scene, |i| {
            let instance = Instance::new(mesh.clone(), turned(i)).unwrap();
            ObjectDesc::fixed(instance.clone()).occluder(instance)
        });
    });
    check("instances placed by the scene", |scene| {
        let mesh = rock();
        insert(scene, |i| ObjectDesc::fixed(mesh.clone()).occluder(mesh.clone()).placed(turned(i)));
    });
    check("closed and open meshes", |scene| {
        insert(scene, |i| {
            let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|p| p + place(i));
            let sides = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]][i % 2..].to_vec();
            let mesh = mesh(corners.to_vec(), sides);
            ObjectDesc::fixed(mesh.clone()).occluder(mesh)
        });
    });
}
