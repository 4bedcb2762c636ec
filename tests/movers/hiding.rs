//! Movers go into volumes in turn: a bounded number in each frame, and none waits for ever.

use crate::common::*;

/// A wall across the grid.
fn scene() -> Scene {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(0.0, 0.0, 20.0), Vec3::new(128.0, 16.0, 23.0)));
    scene
}

/// A mover behind the wall, or before it.
fn insert(scene: &mut Scene, i: usize, z: f32) -> ObjectId {
    let center = Vec3::new(2.0 + (i % 120) as f32, 2.0 + (i / 120 % 10) as f32, z + (i / 1200 % 12) as f32);
    scene.insert(ObjectDesc::dynamic(Sphere::new(center, 0.4)).max_speed(1.0)).unwrap()
}

fn hidden(scene: &Scene, ids: &[ObjectId]) -> usize {
    ids.iter().filter(|id| scene.tbv(**id).unwrap().is_some()).count()
}

/// One frame; how many objects went into volumes in it.
fn frame(scene: &mut Scene, query: &mut Query, number: usize) -> usize {
    scene.begin_frame(number as f64 / 60.0).unwrap();
    query.run(scene, &around(Vec3::new(64.5, 8.0, 4.5)));
    scene.end_frame([query.pvs()]).unwrap().hidden
}

#[test]
fn all_are_in_volumes_after_as_many_frames_as_their_number_needs() {
    let (mut scene, mut query) = (scene(), Query::new());
    let count = 3 * MOST_NEW_VOLUMES - 100;
    let ids: Vec<ObjectId> = (0..count).map(|i| insert(&mut scene, i, 30.0)).collect();
    let made: Vec<usize> = (0..4).map(|number| frame(&mut scene, &mut query, number)).collect();
    assert_eq!(made, [MOST_NEW_VOLUMES, MOST_NEW_VOLUMES, MOST_NEW_VOLUMES - 100, 0]);
    assert_eq!(hidden(&scene, &ids), count);
    assert!(query.pvs().stats().objects_tested < 10);
}

#[test]
fn no_object_waits_for_ever_while_others_come_and_go() {
    let (mut scene, mut query) = (scene(), Query::new());
    // Some stay in sight.
    let seen: Vec<ObjectId> = (0..3000).map(|i| insert(&mut scene, i, 5.0)).collect();
    // Those that come and go are before the others in the order of their indices.
    let mut new: Vec<ObjectId> = (0..2500).map(|i| insert(&mut scene, i, 60.0)).collect();
    let old: Vec<ObjectId> = (0..5000).map(|i| insert(&mut scene, i, 30.0)).collect();
    let mut frames = 0;
    while hidden(&scene, &old) < old.len() {
        assert!(frames < 30, "{} of the old ones are in volumes", hidden(&scene, &old));
        // More come in each frame than one frame hides, and most of those before them go.
        for id in new.drain(..) {
            scene.remove(id).unwrap();
        }
        new.extend((0..2500).map(|i| insert(&mut scene, i, 60.0)));
        assert!(frame(&mut scene, &mut query, frames) <= MOST_NEW_VOLUMES);
        frames += 1;
    }
    assert_eq!(hidden(&scene, &seen), 0);
}
