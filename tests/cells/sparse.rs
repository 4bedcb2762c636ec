//! Walks pass over parts of the grid that hold nothing, and find the same as where every part holds
//! something.

use crate::common::*;
use crate::work::{some_scene, some_views};

const SIZE: u32 = 320;

/// The same objects in two scenes; the second also has a speck in every 64 cells along each axis.
fn scenes(seed: u64) -> [Scene; 2] {
    let mut scenes = [0, 1].map(|_| some_scene(&mut Random(seed), SIZE));
    let n = SIZE / 64;
    for i in 0..n * n * n {
        let at = UVec3::new(i % n, i / n % n, i / (n * n)).as_vec3() * 64.0 + 17.3;
        scenes[1].fixed(Sphere::new(at, 0.1));
    }
    scenes
}

#[test]
fn nothing_is_lost_where_walks_pass_over_emptiness() {
    let mut random = Random(77);
    let (mut seen, mut hidden) = (0, 0);
    for seed in 1..4 {
        let mut scenes = scenes(seed);
        let ids: Vec<ObjectId> = scenes[0].ids().collect();
        for round in 0..2 {
            for view in some_views(&mut random, SIZE as f32) {
                for method in [Method::cell(), Method::point()] {
                    let mut queries = [0, 1].map(|_| query_by(method));
                    for (query, scene) in queries.iter_mut().zip(&scenes) {
                        query.run(scene, &view);
                    }
                    let [a, b] = queries.each_ref().map(Query::pvs);
                    let b_has: BTreeSet<usize> = b.iter().map(|id| id.index()).collect();
                    for &id in &ids {
                        let found = a.contains(id);
                        assert_eq!(
                            found,
                            b_has.contains(&id.index()),
                            "{method:?}, seed {seed}, {id}, {view:?}"
                        );
                        if found { seen += 1 } else { hidden += 1 }
                    }
                    // Of parallel views, portions of what is there are counted.
                    let (a, b) = (a.stats().shells, b.stats().shells);
                    let walks = view.eye().is_some();
                    // Shells in which there is nothing are passed over.
                    assert!(!walks || a <= b, "{method:?}: {a} and {b} shells");
                }
            }
            // What nobody saw goes into volumes.
            let view = around(Vec3::splat(31.0 + 200.0 * round as f32));
            for scene in &mut scenes {
                look(scene, &mut Query::new(), &view);
            }
        }
    }
    assert!(seen > 1000 && hidden > 1000, "{seen} {hidden}");
}

#[test]
fn an_eye_in_a_closed_room_ends_the_walk_in_an_empty_grid() {
    let mut scene = empty();
    let (low, high) = (Vec3::splat(1000.0), Vec3::splat(1040.0));
    for axis in 0..3 {
        for side in [low, high] {
            let (mut min, mut max) = (low - 4.0, high + 4.0);
            (min[axis], max[axis]) = (side[axis] - 3.0, side[axis] + 3.0);
            scene.solid(Aabb::new(min, max));
        }
    }
    let far: Vec<ObjectId> = (0..8)
        .map(|i| {
            let at = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2040.0 + 3.0;
            scene.fixed(Sphere::new(at, 1.0))
        })
        .collect();
    for method in [Method::cell(), Method::point()] {
        let mut query = query_by(method);
        let inside = query.run(&scene, &around(Vec3::splat(1020.3)));
        assert!(far.iter().all(|&id| !inside.contains(id)) && inside.len() == 6, "{method:?}");
        assert!(inside.stats().shells < 40, "{method:?}: {} shells", inside.stats().shells);
        let outside = query.run(&scene, &around(Vec3::splat(500.3)));
        assert!(far[1..7].iter().all(|&id| outside.contains(id)), "{method:?}");
    }
}
