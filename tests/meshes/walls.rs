//! Walls of panels that are objects of their own.

use crate::common::*;

/// A panel of a wall across z: a few triangles, with the corners it shares with its neighbours.
pub fn panel(x: f32, y: f32, z: f32, size: f32, gap: f32) -> Arc<TriMesh> {
    let place = |i: u32| size * i as f32 * 0.5 + [gap, 0.0, -gap][i as usize];
    let (corners, triangles) = sheet(2, 2, |i, j| Vec3::new(x + place(i), y + place(j), z));
    mesh(corners, triangles)
}

#[test]
fn panels_streamed_in_and_out_hide_as_if_new() {
    let mut random = Random(5);
    let places: Vec<(f32, f32, f32)> = (0..2000)
        .map(|i| (2.0 * (i % 24) as f32, 2.0 * (i / 24 % 12) as f32, 4.0 + 4.0 * (i / 288) as f32))
        .collect();
    let meshes: Vec<Arc<TriMesh>> = places.iter().map(|&(x, y, z)| panel(x, y, z, 2.0, 0.0)).collect();
    let insert = |scene: &mut Scene, i: usize| scene.solid(meshes[i].clone());
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
            let eye = random.point(0.0, 24.0).as_vec3();
            let view = around(eye);
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
    let at = |i: u32| 4.0 + 8.0 * i as f32 / n as f32;
    let (corners, triangles) =
        sheet(n, n, |i, j| Vec3::new(at(i), at(j), z + if (i + j).is_multiple_of(2) { 0.4 } else { -0.4 }));
    mesh(corners, triangles)
}

#[test]
fn what_moves_may_change_its_mesh() {
    let (small, large, wall) = (crumpled(2, 6.0), crumpled(9, 6.0), crumpled(6, 10.0));
    let fixed = |scene: &mut Scene| {
        scene.solid(wall.clone());
        for i in 0..60u8 {
            let at = Vec3::new(4.5 + f32::from(i % 8), 4.5 + f32::from(i / 8), 13.0);
            scene.fixed(Sphere::new(at, 0.1));
        }
    };
    let instance = |mesh: &Arc<TriMesh>, x: f32| {
        Instance::new(mesh.clone(), Affine3A::from_translation(Vec3::X * x)).unwrap()
    };
    let view = around(Vec3::new(8.3, 8.2, 1.1));
    let mut scene = empty();
    fixed(&mut scene);
    let ball = Sphere::new(Vec3::splat(8.0), 0.5);
    let id = scene.insert(ObjectDesc::dynamic(ball)).unwrap();
    let mut query = Query::new();
    let shapes = [None, Some(&small), Some(&large), None, Some(&large), Some(&small)];
    for (round, mesh) in shapes.into_iter().cycle().take(24).enumerate() {
        let x = round as f32 * 0.05;
        let mut fresh = empty();
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
    let mut fresh = empty();
    fixed(&mut fresh);
    assert_eq!(query.run(&scene, &view).len(), Query::new().run(&fresh, &view).len());
}
