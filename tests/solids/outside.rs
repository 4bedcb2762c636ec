//! Occluders that stick out of their bounds, and those that only seem to: boxes around shapes may
//! be larger than these.

use casca_scenes::world::Mesh;

use crate::common::*;

/// A long ellipsoid, and its vertices.
fn ellipsoid() -> (Arc<TriMesh>, Vec<Vec3>) {
    let ball = Mesh::ball(1);
    let points: Vec<Vec3> = ball.positions.iter().map(|p| *p * Vec3::new(11.0, 4.0, 3.9)).collect();
    (mesh(points.clone(), ball.triangles), points)
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
    let mut scene = empty();
    for (instance, tight) in turned() {
        for room in [0.02, 0.0] {
            let bounds = Aabb::new(tight.min - room, tight.max + room);
            scene.insert(ObjectDesc::fixed(bounds).occluder(instance.clone())).unwrap();
        }
    }
}

#[test]
fn an_instance_that_sticks_out_is_refused_and_the_error_says_by_how_far() {
    let mut scene = empty();
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
