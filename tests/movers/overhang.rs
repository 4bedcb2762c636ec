//! What lies far away, or reaches below the floor of a level, costs as anything else.

use crate::common::*;

/// A wall across the grid, and boxes that stand behind it, below the floor of the grid by a
/// distance.
fn street(below: f32) -> (Scene, Vec<ObjectId>) {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(0.0, 0.0, 60.0), Vec3::new(128.0, 16.0, 62.0)));
    let corner = |i: u32| Vec3::new(1.0 + (i % 50) as f32 * 2.5, 0.0, 64.0 + (i / 50) as f32);
    let boxes = (0..2500).map(|i| Aabb::new(corner(i) - Vec3::Y * below, corner(i) + 0.5));
    let ids = boxes.map(|b| scene.insert(ObjectDesc::dynamic(b)).unwrap()).collect();
    (scene, ids)
}

#[test]
fn what_is_far_away_costs_only_itself() {
    let eye = around(Vec3::new(64.3, 2.3, 20.3));
    let (mut scene, ids) = street(0.0);
    let mut query = Query::new();
    let before = query.run(&scene, &eye).clone();
    // A tower of a kilometre, a plain of ten, and a ball almost at the end of all cells.
    let places = (1..100).flat_map(|i| [Vec3::Y * i as f32 * 10.0, Vec3::new(i as f32, 0.0, -1.0) * 100.0]);
    let far: Vec<ObjectId> = places.map(|at| scene.fixed(Sphere::new(at - 50.0, 0.4))).collect();
    let last = scene.fixed(Sphere::new(Vec3::new(1e6, 2.0, 20.0), 3.0));
    let after = query.run(&scene, &eye);
    assert!(after.contains(last) && far.iter().all(|&id| after.contains(id)), "nothing hides them");
    assert!(ids.iter().all(|&id| after.contains(id) == before.contains(id)));
    let (own, all, new) = (before.stats(), after.stats(), far.len() as u32 + 1);
    assert!(
        all.shells - own.shells <= 2 * new && all.bricks_visited - own.bricks_visited <= 8 * u64::from(new)
    );
    assert!(all.objects_tested - own.objects_tested <= new, "{own:?} {all:?}");
}

#[test]
fn movers_that_reach_out_of_the_grid_a_little_get_volumes() {
    let (mut scene, ids) = street(1e-4);
    let eye = around(Vec3::new(64.3, 2.3, 20.3));
    let mut query = Query::new();
    for frame in 0..10 {
        scene.begin_frame(f64::from(frame) * 0.02).unwrap();
        look(&mut scene, &mut query, &eye);
    }
    let hidden = ids.iter().filter(|id| scene.tbv(**id).unwrap().is_some()).count();
    assert!(hidden > 2400, "{hidden} of 2500 are in volumes");
    assert!(query.run(&scene, &eye).stats().objects_tested < 100);
}
