//! Walls of panels that are objects of their own.

use std::sync::Arc;

use casca::{
    Aabb, GridSpec, Instance, Method, ObjectDesc, ObjectId, PointOptions, Query, Scene, Sphere, TriMesh, View,
};
use glam::{Affine3A, UVec3, Vec3};

use crate::rays::Random;

/// A panel of a wall across z: a few triangles, with the corners it shares with its neighbours.
fn panel(x: f32, y: f32, z: f32, size: f32, gap: f32) -> Arc<TriMesh> {
    let corner = |i: usize, j: usize| {
        let inset = |k: usize| [gap, 0.0, -gap][k];
        Vec3::new(x + size * i as f32 * 0.5 + inset(i), y + size * j as f32 * 0.5 + inset(j), z)
    };
    let positions: Vec<Vec3> = (0..9).map(|k| corner(k % 3, k / 3)).collect();
    let squares = [0u32, 1, 3, 4];
    let triangles = squares.iter().flat_map(|&a| [[a, a + 1, a + 4], [a, a + 4, a + 3]]).collect();
    Arc::new(TriMesh::new(positions, triangles).unwrap())
}

fn empty() -> Scene {
    Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::new(48, 24, 32) }).unwrap()
}

/// The objects seen behind a wall of panels with gaps.
fn seen_behind(gap: f32) -> usize {
    let mut scene = empty();
    for i in 0..24 {
        for j in 0..12 {
            let mesh = panel(2.0 * i as f32, 2.0 * j as f32, 16.0, 2.0, gap);
            scene.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh)).unwrap();
        }
    }
    let mut row = Vec::new();
    for i in 0..60 {
        let low = Vec3::new(9.0 + 0.5 * i as f32, 12.0 - 0.1, 20.0);
        row.push(scene.insert(ObjectDesc::fixed(Aabb::new(low, low + Vec3::new(0.2, 0.2, 0.2)))).unwrap());
    }
    let options = PointOptions::default().pixel_degrees(1.0).min_pixels(0);
    let mut query = Query::with_method(Method::Point(options)).unwrap();
    let pvs = query.run(&scene, &View::omnidirectional(Vec3::new(24.1, 12.2, 6.0)).unwrap());
    row.iter().filter(|&&id| pvs.contains(id)).count()
}

#[test]
fn panels_that_meet_leave_no_seams() {
    assert_eq!(seen_behind(0.0), 0);
    let apart = seen_behind(0.01);
    assert!(apart > 10, "{apart}");
}

#[test]
fn panels_streamed_in_and_out_hide_as_if_new() {
    let mut random = Random(5);
    let places: Vec<(f32, f32, f32)> = (0..2000)
        .map(|i| (2.0 * (i % 24) as f32, 2.0 * (i / 24 % 12) as f32, 4.0 + 4.0 * (i / 288) as f32))
        .collect();
    let meshes: Vec<Arc<TriMesh>> = places.iter().map(|&(x, y, z)| panel(x, y, z, 2.0, 0.0)).collect();
    let insert = |scene: &mut Scene, i: usize| {
        scene.insert(ObjectDesc::fixed(meshes[i].clone()).occluder(meshes[i].clone())).unwrap()
    };
    let mut scene = empty();
    let mut ids: Vec<Option<ObjectId>> = vec![None; meshes.len()];
    let mut query = Query::new();
    for frame in 0..12 {
        scene.begin_frame(f64::from(frame)).unwrap();
        for _ in 0..1500 {
            let i = random.below(meshes.len());
            match ids[i].take() {
                Some(id) if random.below(3) == 0 => scene.remove(id).unwrap(),
                Some(id) => ids[i] = Some(id),
                None => ids[i] = Some(insert(&mut scene, i)),
            }
        }
        let mut fresh = empty();
        let new: Vec<Option<ObjectId>> =
            (0..meshes.len()).map(|i| ids[i].map(|_| insert(&mut fresh, i))).collect();
        for _ in 0..2 {
            let eye = random.place(0.0, 24.0).as_vec3();
            let view = View::omnidirectional(eye).unwrap();
            let seen: Vec<bool> = {
                let pvs = query.run(&scene, &view);
                ids.iter().map(|id| id.is_some_and(|id| pvs.contains(id))).collect()
            };
            let pvs = query.run(&fresh, &view);
            let differ: Vec<usize> =
                (0..new.len()).filter(|&i| seen[i] != new[i].is_some_and(|id| pvs.contains(id))).collect();
            assert!(differ.is_empty(), "frame {frame}, from {eye}: {differ:?} of {}", pvs.len());
            assert!(pvs.len() < fresh.len());
        }
    }
}

/// A crumpled sheet of `2 n^2` triangles, across the z axis at `z`.
fn crumpled(n: u32, z: f32) -> Arc<TriMesh> {
    let at = |i: u32, j: u32| {
        let bump = if (i + j).is_multiple_of(2) { 0.4 } else { -0.4 };
        Vec3::new(4.0 + 8.0 * i as f32 / n as f32, 4.0 + 8.0 * j as f32 / n as f32, z + bump)
    };
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let quad = |i: u32, j: u32| {
        let a = j * (n + 1) + i;
        [[a, a + 1, a + n + 1], [a + 1, a + n + 2, a + n + 1]]
    };
    let triangles = (0..n).flat_map(|j| (0..n).flat_map(move |i| quad(i, j))).collect();
    Arc::new(TriMesh::new(positions, triangles).unwrap())
}

#[test]
fn what_moves_may_change_its_mesh() {
    let (small, large, wall) = (crumpled(2, 6.0), crumpled(9, 6.0), crumpled(6, 10.0));
    let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(16) };
    let fixed = |scene: &mut Scene| {
        scene.insert(ObjectDesc::fixed(wall.clone()).occluder(wall.clone())).unwrap();
        for i in 0..60u8 {
            let at = Vec3::new(4.5 + f32::from(i % 8), 4.5 + f32::from(i / 8), 13.0);
            scene.insert(ObjectDesc::fixed(Sphere::new(at, 0.1))).unwrap();
        }
    };
    let instance = |mesh: &Arc<TriMesh>, x: f32| {
        Instance::new(mesh.clone(), Affine3A::from_translation(Vec3::X * x)).unwrap()
    };
    let view = View::omnidirectional(Vec3::new(8.3, 8.2, 1.1)).unwrap();
    let mut scene = Scene::new(&spec).unwrap();
    fixed(&mut scene);
    let ball = Sphere::new(Vec3::splat(8.0), 0.5);
    let id = scene.insert(ObjectDesc::dynamic(ball)).unwrap();
    let mut query = Query::new();
    let shapes = [None, Some(&small), Some(&large), None, Some(&large), Some(&small)];
    for (round, mesh) in shapes.into_iter().cycle().take(24).enumerate() {
        let x = round as f32 * 0.05;
        let mut fresh = Scene::new(&spec).unwrap();
        fixed(&mut fresh);
        match mesh {
            Some(mesh) => {
                scene.update(id, instance(mesh, x), Some(instance(mesh, x).into())).unwrap();
                fresh.insert(ObjectDesc::dynamic(instance(mesh, x)).occluder(instance(mesh, x))).unwrap();
            }
            None => {
                scene.set_occluder(id, None).unwrap();
                scene.update(id, ball, None).unwrap();
                fresh.insert(ObjectDesc::dynamic(ball)).unwrap();
            }
        }
        let count = query.run(&scene, &view).len();
        assert_eq!(count, Query::new().run(&fresh, &view).len(), "round {round}");
    }
    scene.remove(id).unwrap();
    let mut fresh = Scene::new(&spec).unwrap();
    fixed(&mut fresh);
    assert_eq!(query.run(&scene, &view).len(), Query::new().run(&fresh, &view).len());
}
