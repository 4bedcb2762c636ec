//! Occluders that stick out of their bounds, and those that only seem to: boxes around shapes may
//! be larger than these.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use casca::{Aabb, Error, GridSpec, Instance, ObjectDesc, Scene, TriMesh};
use glam::{Affine3A, EulerRot, Quat, UVec3, Vec3};

fn scene() -> Scene {
    Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(64) }).unwrap()
}

/// A long ellipsoid, and its vertices.
fn ellipsoid() -> (Arc<TriMesh>, Vec<Vec3>) {
    let (n, m) = (7u32, 9u32);
    let angle = |i: u32, of: u32, full: f32| full * i as f32 / of as f32;
    let point = |t: f32, u: f32| Vec3::new(11.0 * t.sin() * u.cos(), 4.0 * t.sin() * u.sin(), 3.9 * t.cos());
    let points: Vec<Vec3> =
        (0..=m).flat_map(|j| (0..n).map(move |i| point(angle(j, m, PI), angle(i, n, TAU)))).collect();
    let at = |i: u32, j: u32| if j == 0 || j == m { j * n } else { j * n + i % n };
    let quad = |i: u32, j: u32| {
        [[at(i, j), at(i, j + 1), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i + 1, j)]]
    };
    let mut triangles: Vec<[u32; 3]> = (0..m).flat_map(|j| (0..n).flat_map(move |i| quad(i, j))).collect();
    triangles.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    (Arc::new(TriMesh::new(points.clone(), triangles).unwrap()), points)
}

/// The ellipsoid under many transforms, and the box around its vertices there.
fn turned() -> impl Iterator<Item = (Instance, Aabb)> {
    let (mesh, points) = ellipsoid();
    (0..200).map(move |k| {
        let a = k as f32 * 0.37;
        let at = Affine3A::from_translation(Vec3::splat(32.0))
            * Affine3A::from_quat(Quat::from_euler(EulerRot::XYZ, a, a * 1.7, a * 0.6));
        let tight = Aabb::from_points(points.iter().map(|p| at.transform_point3(*p))).unwrap();
        (Instance::new(mesh.clone(), at).unwrap(), tight)
    })
}

#[test]
fn a_box_around_the_vertices_of_an_instance_bounds_it() {
    let mut scene = scene();
    for (instance, tight) in turned() {
        for room in [0.02, 0.0] {
            let bounds = Aabb::new(tight.min - room, tight.max + room);
            scene.insert(ObjectDesc::fixed(bounds).occluder(instance.clone())).unwrap();
        }
    }
}

#[test]
fn an_instance_that_sticks_out_is_refused_and_the_error_says_by_how_far() {
    let mut scene = scene();
    for (k, (instance, tight)) in turned().enumerate() {
        let (axis, far) = (k % 3, 1.5e-3 * (tight.max - tight.min).length());
        let mut bounds = tight;
        if k % 2 == 0 {
            bounds.max[axis] -= far
        } else {
            bounds.min[axis] += far
        }
        let refused = scene.insert(ObjectDesc::fixed(bounds).occluder(instance));
        let Err(Error::OccluderOutside { by }) = refused else { panic!("{refused:?}") };
        assert!((by - f64::from(far)).abs() < 1e-4, "{by} instead of {far}");
    }
    assert!(scene.is_empty());
}
