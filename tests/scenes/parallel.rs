//! Queries that several threads share find the same as those of one: the same objects in the same
//! order, the same volumes, and the same counts of work.

use std::cell::RefCell;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::common::*;

const GRID: f32 = 48.0;

fn turn(random: &mut Random) -> Quat {
    let [a, b, c] = [(); 3].map(|()| random.between(-3.0, 3.0));
    Quat::from_euler(EulerRot::XYZ, a, b, c)
}

fn spot(random: &mut Random) -> Vec3 {
    random.place(2.0, GRID - 2.0, 1.0)
}

/// A sheet of bumpy quads with holes, about as wide as two.
fn holed(random: &mut Random) -> Arc<TriMesh> {
    let corner = |i: u32| i as f32 * 0.5 - 2.0;
    let (corners, mut triangles) =
        sheet(8, 8, |i, j| Vec3::new(corner(i), corner(j), random.between(-0.1, 0.1)));
    triangles.retain(|_| random.unit() > 0.1);
    mesh(corners, triangles)
}

/// A scene of spheres, boxes that stand askew, meshes and movers, in two layers, and the movers.
fn scene(random: &mut Random) -> (Scene, Vec<ObjectId>) {
    let mut scene = empty();
    let meshes = [holed(random), holed(random), holed(random)];
    let mut movers = Vec::new();
    for i in 0..700 {
        let (at, size) = (spot(random), random.between(0.1, 1.2));
        let desc = match i % 5 {
            0 => ObjectDesc::fixed(Sphere::new(at, size)).occluder(Sphere::new(at, size)),
            1 => {
                let half = Vec3::new(size, random.between(0.1, 1.2), random.between(0.1, 1.2));
                let askew = Obb::new(at, half, turn(random));
                ObjectDesc::fixed(askew).occluder(askew)
            }
            2 | 3 => {
                let to = Affine3A::from_scale_rotation_translation(Vec3::splat(size + 0.3), turn(random), at);
                let placed = Instance::new(meshes[i / 5 % 3].clone(), to).unwrap();
                ObjectDesc::fixed(placed.clone()).occluder(placed)
            }
            _ => ObjectDesc::dynamic(Sphere::new(at, size * 0.4)).max_speed(3.0),
        };
        let id = scene.insert(desc.layers(1 << (i % 7 / 6))).unwrap();
        if i % 5 == 4 {
            movers.push(id);
        }
    }
    (scene, movers)
}

fn view(random: &mut Random) -> View {
    let eye = Vec3::splat(GRID * 0.5) + (spot(random) - GRID * 0.5) * 0.6;
    let looks = turn(random) * Vec3::Z;
    let up = looks.any_orthonormal_vector();
    match random.unit() {
        x if x < 0.2 => around(eye),
        x if x < 0.3 => {
            let half = GRID * 0.4;
            let projection = directx::orthographic(-half, half, -half, half, 0.1, 90.0);
            View::orthographic(looks, projection * look_to_mat4(eye - looks * 30.0, looks, up)).unwrap()
        }
        x => {
            let matrix = directx::perspective(random.between(0.5, 1.8), 1.6, 0.1, 100.0)
                * look_to_mat4(eye, looks, up);
            let view = View::perspective(eye, matrix).unwrap();
            match x {
                x if x < 0.45 => view.with_reach(0.1).unwrap(),
                x if x < 0.6 => view.with_turn(0.1).unwrap(),
                x if x < 0.7 => view.with_layers(1),
                _ => view,
            }
        }
    }
}

/// Budgets that last, that end among the objects, and that are empty from the start.
fn options(random: &mut Random) -> PointOptions {
    let mut options = PointOptions::new().pixel_degrees(random.between(0.3, 2.0)).min_pixels(16);
    let budgets = [u32::MAX, 3000, 300, 40, 7, 0];
    let mut any = |all: &[u32]| all[(random.unit() * all.len() as f32) as usize % all.len()];
    options = options.refine_patches(any(&budgets)).refine_budget(any(&budgets));
    options = options.refine_squares(any(&[256, 1024, 20, 0]));
    options.coherent(any(&[0, 1]) == 1)
}

fn same(one: &Pvs, more: &Pvs, threads: usize) -> Result<(), TestCaseError> {
    prop_assert_eq!(one.visible(), more.visible(), "{} threads", threads);
    prop_assert_eq!(one.revealed(), more.revealed(), "{} threads", threads);
    prop_assert_eq!(one.stats(), more.stats(), "{} threads", threads);
    Ok(())
}

fn check(seed: u64, pools: &[(usize, ThreadPool)]) -> Result<[u64; 2], TestCaseError> {
    let random = &mut Random(seed);
    let (mut scene, movers) = scene(random);
    let method = Method::Point(options(random));
    let mut alone = query_by(method);
    let mut shared: Vec<Query> = pools.iter().map(|_| query_by(method)).collect();
    shared.iter_mut().for_each(|query| query.set_parallel(true));
    let mut views = [view(random), view(random)].to_vec();
    views.extend_from_within(..);
    let mut work = [0; 2];
    for (frame, view) in views.iter().enumerate() {
        scene.begin_frame(frame as f64 * 0.1).unwrap();
        for &id in &movers {
            if random.unit() < 0.5 {
                continue;
            }
            scene.update(id, Sphere::new(spot(random), 0.3), None).unwrap();
        }
        let stats = *alone.run(&scene, view).stats();
        work = [work[0] + stats.refine_squares, work[1] + u64::from(stats.refine_patches)];
        for ((threads, pool), query) in pools.iter().zip(&mut shared) {
            pool.install(|| query.run(&scene, view));
            same(alone.pvs(), query.pvs(), *threads)?;
        }
        scene.end_frame([alone.pvs()]).unwrap();
    }
    Ok(work)
}

fn pools() -> Vec<(usize, ThreadPool)> {
    let pool = |threads| (threads, ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    [1, 2, 3, 8].map(pool).into()
}

#[test]
fn threads_find_what_one_finds() {
    let pools = pools();
    let work = RefCell::new([0; 2]);
    proptest!(cases(24), |(seed in any::<u64>())| {
        let found = check(seed, &pools)?;
        work.borrow_mut().iter_mut().zip(found).for_each(|(all, found)| *all += found);
    });
    let [squares, patches] = work.into_inner();
    assert!(squares > 1000 && patches > 1000, "{squares} squares, {patches} patches");
}

#[test]
fn shared_queries_run_beside_each_other() {
    let random = &mut Random(77);
    let (scene, _) = scene(random);
    let views: Vec<View> = (0..12).map(|_| view(random)).collect();
    let mut alone: Vec<Query> = views.iter().map(|_| Query::new()).collect();
    for (query, view) in alone.iter_mut().zip(&views) {
        query.run(&scene, view);
    }
    let mut shared = vec![Query::new(); views.len()];
    shared.iter_mut().for_each(|query| query.set_parallel(true));
    for (threads, pool) in &pools() {
        pool.install(|| Query::run_all(&mut shared, &scene, &views));
        for (one, more) in alone.iter().zip(&shared) {
            assert!(more.is_parallel());
            same(one.pvs(), more.pvs(), *threads).unwrap();
        }
    }
}
