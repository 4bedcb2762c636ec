//! Queries that several threads share find the same as those of one: the same objects in the same
//! order, the same volumes, and the same counts of work.

use std::cell::RefCell;
use std::sync::Arc;

use casca::{
    GridSpec, Instance, Method, Obb, ObjectDesc, ObjectId, PointOptions, Pvs, Query, Scene, Sphere, TriMesh,
    View,
};
use casca_truth::cases;
use casca_truth::places::coordinate;
use glam::camera::rh::{proj::directx::perspective, view::look_to_mat4};
use glam::{Affine3A, EulerRot, Quat, UVec3, Vec3};
use proptest::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

const GRID: f32 = 48.0;

/// Numbers that follow from a seed.
struct Dice(u64);

impl Dice {
    fn share(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    fn within(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.share()
    }

    fn point(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| coordinate(self.share().into(), 2.0..GRID - 2.0, 1.0)))
    }

    fn turn(&mut self) -> Quat {
        Quat::from_euler(
            EulerRot::XYZ,
            self.within(-3.0, 3.0),
            self.within(-3.0, 3.0),
            self.within(-3.0, 3.0),
        )
    }
}

/// A sheet of bumpy quads with holes, about as wide as two.
fn sheet(dice: &mut Dice) -> Arc<TriMesh> {
    const SIDE: u32 = 9;
    let corner = |i: u32| {
        let (x, y) = ((i % SIDE) as f32 - 4.0, (i / SIDE) as f32 - 4.0);
        Vec3::new(x * 0.5, y * 0.5, dice.within(-0.1, 0.1))
    };
    let corners: Vec<Vec3> = (0..SIDE * SIDE).map(corner).collect();
    let quads = (0..SIDE * (SIDE - 1)).filter(|i| i % SIDE < SIDE - 1);
    let triangles = quads
        .filter(|_| dice.share() > 0.1)
        .flat_map(|a| [[a, a + 1, a + SIDE], [a + 1, a + SIDE + 1, a + SIDE]]);
    let triangles = triangles.collect();
    Arc::new(TriMesh::new(corners, triangles).unwrap())
}

/// A scene of spheres, boxes that stand askew, meshes and movers, in two layers, and the movers.
fn scene(dice: &mut Dice) -> (Scene, Vec<ObjectId>) {
    let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(GRID as u32) };
    let mut scene = Scene::new(&spec).unwrap();
    let meshes = [sheet(dice), sheet(dice), sheet(dice)];
    let mut movers = Vec::new();
    for i in 0..700 {
        let (at, size) = (dice.point(), dice.within(0.1, 1.2));
        let desc = match i % 5 {
            0 => ObjectDesc::fixed(Sphere::new(at, size)).occluder(Sphere::new(at, size)),
            1 => {
                let half = Vec3::new(size, dice.within(0.1, 1.2), dice.within(0.1, 1.2));
                let askew = Obb::new(at, half, dice.turn());
                ObjectDesc::fixed(askew).occluder(askew)
            }
            2 | 3 => {
                let to = Affine3A::from_scale_rotation_translation(Vec3::splat(size + 0.3), dice.turn(), at);
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

fn view(dice: &mut Dice) -> View {
    let eye = Vec3::splat(GRID * 0.5) + (dice.point() - GRID * 0.5) * 0.6;
    let looks = dice.turn() * Vec3::Z;
    let up = looks.any_orthonormal_vector();
    match dice.share() {
        x if x < 0.2 => View::omnidirectional(eye).unwrap(),
        x if x < 0.3 => {
            let half = GRID * 0.4;
            let projection =
                glam::camera::rh::proj::directx::orthographic(-half, half, -half, half, 0.1, 90.0);
            View::orthographic(looks, projection * look_to_mat4(eye - looks * 30.0, looks, up)).unwrap()
        }
        x => {
            let matrix = perspective(dice.within(0.5, 1.8), 1.6, 0.1, 100.0) * look_to_mat4(eye, looks, up);
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
fn options(dice: &mut Dice) -> PointOptions {
    let mut options = PointOptions::new().pixel_degrees(dice.within(0.3, 2.0)).min_pixels(16);
    let budgets = [u32::MAX, 3000, 300, 40, 7, 0];
    let mut any = |all: &[u32]| all[(dice.share() * all.len() as f32) as usize % all.len()];
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
    let dice = &mut Dice(seed);
    let (mut scene, movers) = scene(dice);
    let method = Method::Point(options(dice));
    let mut alone = Query::with_method(method).unwrap();
    let mut shared: Vec<Query> = pools.iter().map(|_| Query::with_method(method).unwrap()).collect();
    shared.iter_mut().for_each(|query| query.set_parallel(true));
    let mut views = [view(dice), view(dice)].to_vec();
    views.extend_from_within(..);
    let mut work = [0; 2];
    for (frame, view) in views.iter().enumerate() {
        scene.begin_frame(frame as f64 * 0.1).unwrap();
        for &id in &movers {
            if dice.share() < 0.5 {
                continue;
            }
            scene.update(id, Sphere::new(dice.point(), 0.3), None).unwrap();
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
    let dice = &mut Dice(77);
    let (scene, _) = scene(dice);
    let views: Vec<View> = (0..12).map(|_| view(dice)).collect();
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
