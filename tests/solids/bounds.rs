//! Boxes of bounds and of instances, and bounds that change while the object stays where it is.

use crate::common::*;

fn holds(b: &Aabb, p: DVec3) -> bool {
    b.min.as_dvec3().cmple(p).all() && b.max.as_dvec3().cmpge(p).all()
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn the_box_of_bounds_holds_them(
        middle in vector(-1e4..1e4),
        half in vector(0.0..9.0),
        turn in rotation(),
        share in vector(-1.0..1.0),
    ) {
        let (c, h, s) = (middle.as_dvec3(), half.as_dvec3(), share.as_dvec3());
        let ball = Bounds::from(Sphere::new(middle, half.x)).aabb();
        prop_assert!(holds(&ball, c + s.normalize_or(DVec3::X) * h.x));
        prop_assert!(DVec3::AXES.iter().all(|a| holds(&ball, c + *a * h.x) && holds(&ball, c - *a * h.x)));
        let turned = Bounds::from(Obb::new(middle, half, turn)).aabb();
        let turn = turn.as_dquat().normalize();
        for corner in 0..8 {
            let sign = |bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
            prop_assert!(holds(&turned, c + turn * (h * DVec3::new(sign(0), sign(1), sign(2)))));
        }
        prop_assert!((turned.max - turned.min).max_element() < 2.001 * half.length() + 0.01);
        let b = Aabb::from_center(middle, half);
        prop_assert_eq!(Bounds::from(b).aabb(), b);
    }

    #[test]
    fn the_box_of_an_instance_holds_its_triangles_and_no_more(
        points in prop::collection::vec(vector(-5.0..5.0), 3..40),
        (turn, scale, at) in (rotation(), vector(0.1..3.0), vector(-300.0..300.0)),
    ) {
        let n = points.len() as u32;
        let triangles: Vec<[u32; 3]> = (0..n).map(|i| [i, (i + 1) % n, (i + 2) % n]).collect();
        let mesh = Arc::new(TriMesh::bounds_only(points.clone(), triangles).unwrap());
        let transform = Affine3A::from_scale_rotation_translation(scale, turn, at);
        let found = Instance::new(mesh, transform).unwrap().aabb();
        let matrix = Mat3::from(transform.matrix3).as_dmat3();
        let exact = DAffine3::from_mat3_translation(matrix, at.as_dvec3());
        for &p in &points {
            prop_assert!(holds(&found, exact.transform_point3(p.as_dvec3())));
            // As renderers find it.
            prop_assert!(found.contains(transform.transform_point3(p)));
        }
        let least = Aabb::from_points(points.iter().map(|p| transform.transform_point3(*p))).unwrap();
        let room = (least.min - found.min).max(found.max - least.max).max_element();
        prop_assert!(room < 2e-3, "{}", room);
    }
}

#[test]
fn bounds_of_a_placed_object_are_in_its_own_space() {
    let mut scene = empty();
    let body = Aabb::new(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 2.0, 0.5));
    let core = Aabb::new(Vec3::new(-0.2, 0.5, -0.2), Vec3::new(0.2, 1.0, 0.2));
    let at = |x: f32| Affine3A::from_translation(Vec3::new(x, 4.0, 9.0));
    let person = scene.insert(ObjectDesc::dynamic(body).occluder(core).placed(at(5.0))).unwrap();
    let before = scene.occluder(person).unwrap().cloned();
    assert!(before.is_some());

    let pose = Aabb { max: Vec3::new(3.0, 1.2, 0.5), ..body };
    scene.set_bounds(person, pose).unwrap();
    let near = |a: Vec3, b: Vec3| a.abs_diff_eq(b, 1e-3);
    let found = scene.bounds(person).unwrap().aabb();
    assert!(near(found.max, Vec3::new(8.0, 5.2, 9.5)) && near(found.min, Vec3::new(4.5, 4.0, 8.5)));
    assert_eq!(format!("{:?}", scene.occluder(person).unwrap()), format!("{:?}", before.as_ref()));
    assert_eq!(scene.transform(person).unwrap(), Some(at(5.0)));

    // The next step moves the new bounds.
    scene.set_transform(person, at(9.0)).unwrap();
    assert!(near(scene.bounds(person).unwrap().aabb().max, Vec3::new(12.0, 5.2, 9.5)));

    // Bounds that the occluder sticks out of, and none at all, change nothing.
    let small = Aabb { max: Vec3::new(0.5, 0.7, 0.5), ..body };
    let refused = scene.set_bounds(person, small);
    assert!(matches!(refused, Err(Error::OccluderOutside { by }) if (by - 0.3).abs() < 1e-6), "{refused:?}");
    assert!(scene.set_bounds(person, Sphere::new(Vec3::NAN, 1.0)).is_err());
    assert!(near(scene.bounds(person).unwrap().aabb().max, Vec3::new(12.0, 5.2, 9.5)));
    scene.set_transform(person, at(10.0)).unwrap();
    assert!(near(scene.bounds(person).unwrap().aabb().max, Vec3::new(13.0, 5.2, 9.5)));
    scene.remove(person).unwrap();
    assert_eq!(scene.set_bounds(person, body), Err(Error::UnknownObject(person)));
}

#[test]
fn bounds_of_other_objects_are_in_world_units() {
    let mut scene = empty();
    let wall = Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 18.0));
    let wall_id = scene.solid(wall);
    let ball = Sphere::new(Vec3::new(16.0, 16.0, 24.0), 0.5);
    let ball_id = scene.insert(ObjectDesc::dynamic(ball)).unwrap();
    let (mut query, view) = (Query::new(), around(Vec3::new(16.0, 16.0, 5.0)));
    assert!(!query.run(&scene, &view).contains(ball_id));
    scene.end_frame([query.pvs()]).unwrap();
    assert!(scene.tbv(ball_id).unwrap().is_some());
    // A hidden object that grows until it looks over the wall.
    scene.set_bounds(ball_id, Aabb::new(Vec3::splat(16.0), Vec3::new(17.0, 31.9, 24.0))).unwrap();
    assert!(query.run(&scene, &view).contains(ball_id));
    // The occluder stays where the wall only changes its bounds.
    scene.set_bounds(wall_id, Aabb::new(wall.min - 0.5, wall.max + 0.5)).unwrap();
    scene.set_bounds(ball_id, ball).unwrap();
    assert!(!query.run(&scene, &view).contains(ball_id));
    assert!(scene.set_bounds(wall_id, ball).is_err());
}
