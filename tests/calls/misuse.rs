//! Calls that contradict themselves are refused, with a message that says how.

use casca::internals::SceneInternals;

use crate::common::*;

const WALL: Aabb = Aabb { min: Vec3::new(8.0, 0.0, 0.0), max: Vec3::new(10.0, 32.0, 32.0) };
const BALL: Sphere = Sphere { center: Vec3::new(20.0, 16.0, 16.0), radius: 1.0 };

#[test]
fn an_update_does_not_take_an_occluder_away_by_silence() {
    let mut scene = empty();
    let wall = scene.solid(WALL);
    let ball = scene.fixed(BALL);
    let (mut query, view) = (Query::new(), around(Vec3::new(2.5, 16.5, 16.5)));
    assert_eq!(scene.update(wall, WALL, None), Err(Error::OccluderMissing(wall)));
    assert!(Error::OccluderMissing(wall).to_string().contains("Scene::set_occluder"));
    assert!(!query.run(&scene, &view).contains(ball));
    scene.set_occluder(wall, None).unwrap();
    assert!(query.run(&scene, &view).contains(ball) && scene.occluder(wall).unwrap().is_none());
    assert_eq!(scene.static_opacity().count(), 0);
    scene.update(wall, WALL, None).unwrap();
    scene.set_occluder(wall, Some(WALL.into())).unwrap();
    assert!(!query.run(&scene, &view).contains(ball));
    assert!(scene.set_occluder(wall, Some(BALL.into())).is_err());
    scene.remove(wall).unwrap();
    assert_eq!(scene.set_occluder(wall, None), Err(Error::UnknownObject(wall)));
}

#[test]
fn a_fixed_object_has_no_speed() {
    let mut scene = empty();
    for desc in [ObjectDesc::fixed(BALL).max_speed(3.0), ObjectDesc::fixed(BALL).reported_on_expiry()] {
        assert_eq!(scene.insert(desc), Err(Error::FixedMoves));
    }
    let on_expiry = ObjectDesc::dynamic(BALL).reported_on_expiry();
    assert_eq!(scene.insert(on_expiry.clone()), Err(Error::SpeedNeeded));
    // In either order.
    scene.insert(on_expiry.max_speed(1.0)).unwrap();
    scene.insert(ObjectDesc::dynamic(BALL).max_speed(1.0).reported_on_expiry()).unwrap();
}

#[test]
fn an_occluder_lies_inside_its_bounds() {
    let mut scene = empty();
    let larger = Aabb { max: WALL.max + Vec3::X, ..WALL };
    assert_eq!(
        scene.insert(ObjectDesc::fixed(WALL).occluder(larger)),
        Err(Error::OccluderOutside { by: 1.0 })
    );
    let sticks = scene.insert(ObjectDesc::fixed(BALL).occluder(WALL)).unwrap_err();
    assert_eq!(sticks.to_string().matches("sticks out").count(), 1);
    let wall = scene.solid(WALL);
    assert_eq!(scene.update(wall, WALL, Some(larger.into())), Err(Error::OccluderOutside { by: 1.0 }));
    assert_eq!(scene.len(), 1);
    // The same numbers computed in another way are no mistake.
    for offset in [0.0, 1e3, 1e6] {
        let box_of = |c: Vec3| Aabb::from_center(c, Vec3::splat(0.3));
        let (a, b) = (Vec3::splat(offset) + 0.1 + 0.2, Vec3::splat(offset + 0.3));
        scene.insert(ObjectDesc::fixed(box_of(a)).occluder(box_of(b))).unwrap();
    }
}

#[test]
fn a_query_that_never_ran_ends_no_frame() {
    let mut scene = empty();
    let id = scene.insert(ObjectDesc::dynamic(BALL)).unwrap();
    let mut query = Query::new();
    assert_eq!(scene.end_frame([query.pvs()]).unwrap(), FrameReport::default());
    assert!(scene.tbv(id).unwrap().is_none(), "nobody looked");
    let none = Pvs::default();
    assert!(none.is_empty() && !none.contains(id) && !none.is_valid_for(&scene, &around(Vec3::ZERO)));
    assert_eq!(scene.end_frame([&none]).unwrap(), FrameReport::default());
    query.run(&scene, &around(Vec3::splat(3.5)));
    assert!(query.pvs().contains(id));
    scene.end_frame([query.pvs(), Query::new().pvs()]).unwrap();
    let mut other = empty();
    assert_eq!(other.end_frame([query.pvs()]), Err(Error::ForeignPvs));
}

#[test]
fn an_offset_moves_instances_and_no_meshes() {
    let mut scene = empty();
    let mesh = mesh(vec![Vec3::ONE, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let fixed = scene.solid(mesh.clone());
    assert_eq!(scene.translate(fixed, Vec3::X), Err(Error::FixedMesh(fixed)));
    let instance = Instance::new(mesh, Affine3A::IDENTITY).unwrap();
    let moving = scene.insert(ObjectDesc::dynamic(instance.clone()).occluder(instance)).unwrap();
    scene.translate(moving, Vec3::X).unwrap();
}

#[test]
fn messages_read_as_they_were_meant() {
    let mut scene = empty();
    let fine = PointOptions::default().pixel_degrees(0.01);
    let mut refused = |bounds: Bounds| scene.insert(ObjectDesc::fixed(bounds)).unwrap_err();
    for (error, text) in [
        (
            Query::with_method(Method::Point(fine)).unwrap_err(),
            "the width of a pixel in degrees must lie between 0.03 and 11.25, not 0.01",
        ),
        (
            refused(Aabb::new(Vec3::ONE, Vec3::ZERO).into()),
            "the bounds must not be inverted: the corner [1, 1, 1] must lie below the corner [0, 0, 0] on every axis",
        ),
        (refused(Sphere::new(Vec3::ZERO, -0.1).into()), "the bounds must not be negative: -0.1"),
        (
            refused(Sphere::new(Vec3::new(0.1, f32::INFINITY, 0.0), 1.0).into()),
            "the bounds must be finite, not [0.1, inf, 0]",
        ),
        (empty().begin_frame(f64::NAN).unwrap_err(), "the time must be finite, not NaN"),
    ] {
        assert_eq!(error.to_string(), text);
    }
}
