//! Walks pass over parts of the grid that hold nothing, and find the same as where every part holds
//! something.

use crate::common::*;

const SIZE: u32 = 320;

fn spot(random: &mut Random) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| random.unit()))
}

/// The same objects in two scenes; the second also has a speck in every 64 cells along each axis.
fn scenes(seed: u64, objects: usize) -> ([Scene; 2], Vec<[ObjectId; 2]>) {
    let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(SIZE) };
    let mut scenes = [Scene::new(&spec).unwrap(), Scene::new(&spec).unwrap()];
    let mut random = Random(seed);
    let mut ids = Vec::new();
    for i in 0..objects {
        let at = spot(&mut random) * SIZE as f32;
        let desc = match i % 4 {
            0 => {
                let half = spot(&mut random) * random.unit() * 50.0 + 1.0;
                let b = Aabb::from_center(at, half);
                ObjectDesc::fixed(b).occluder(b)
            }
            1 => {
                let ball = Sphere::new(at, 1.0 + 9.0 * random.unit());
                ObjectDesc::dynamic(ball).occluder(ball)
            }
            2 => ObjectDesc::dynamic(Sphere::new(at, 0.5)).max_speed(2.0),
            _ => ObjectDesc::fixed(Sphere::new(at, 0.7)),
        };
        ids.push(scenes.each_mut().map(|s| s.insert(desc.clone()).unwrap()));
    }
    let n = SIZE / 64;
    for i in 0..n * n * n {
        let at = UVec3::new(i % n, i / n % n, i / (n * n)).as_vec3() * 64.0 + 17.3;
        scenes[1].insert(ObjectDesc::fixed(Sphere::new(at, 0.1))).unwrap();
    }
    (scenes, ids)
}

fn views(random: &mut Random) -> Vec<View> {
    let size = SIZE as f32;
    let eyes =
        [spot(random) * size, Vec3::splat(size * 0.5), Vec3::new(-0.4, 0.3, 0.6) * size, Vec3::splat(0.2)];
    let mut views = Vec::new();
    for eye in eyes {
        views.push(around(eye));
        let toward = (Vec3::splat(size * 0.5) - eye + spot(random)).normalize();
        let camera = look_to_mat4(eye, toward, Vec3::Y);
        views.push(View::perspective(eye, directx::perspective(0.8, 1.5, 0.1, 2.0 * size) * camera).unwrap());
        let flat = directx::orthographic(-90.0, 90.0, -60.0, 60.0, 0.0, 2.0 * size);
        views.push(View::orthographic(toward, flat * camera).unwrap());
    }
    views
}

#[test]
fn nothing_is_lost_where_walks_pass_over_emptiness() {
    let mut random = Random(77);
    let (mut seen, mut hidden) = (0, 0);
    for (seed, objects) in [(1, 12), (2, 40), (3, 120)] {
        let (mut scenes, ids) = scenes(seed, objects);
        for round in 0..2 {
            for view in views(&mut random) {
                for method in [Method::cell(), Method::point()] {
                    let mut queries = [0, 1].map(|_| query_by(method));
                    for (query, scene) in queries.iter_mut().zip(&scenes) {
                        query.run(scene, &view);
                    }
                    let [a, b] = queries.each_ref().map(Query::pvs);
                    for [x, y] in &ids {
                        assert_eq!(a.contains(*x), b.contains(*y), "{method:?}, seed {seed}, {x}, {view:?}");
                        if a.contains(*x) { seen += 1 } else { hidden += 1 }
                    }
                    // Of parallel views, portions of what is there are counted.
                    let (a, b) = (a.stats().shells, b.stats().shells);
                    let walks = view.eye().is_some();
                    // Walks of the cell method end where they can find no more of the objects.
                    let ends = if method == Method::cell() { a <= b } else { a == b };
                    assert!(!walks || ends, "{method:?}: {a} and {b} shells");
                }
            }
            // What nobody saw goes into volumes.
            let view = around(Vec3::splat(31.0 + 200.0 * round as f32));
            for scene in &mut scenes {
                let mut query = Query::new();
                query.run(scene, &view);
                scene.end_frame([query.pvs()]).unwrap();
            }
        }
    }
    assert!(seen > 1000 && hidden > 1000, "{seen} {hidden}");
}

#[test]
fn an_eye_in_a_closed_room_ends_the_walk_in_an_empty_grid() {
    let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(2048) };
    let mut scene = Scene::new(&spec).unwrap();
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
