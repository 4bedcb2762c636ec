//! Temporal bounding volumes where a view shows their inside but not their surface.

use crate::common::*;

const EYE: Vec3 = Vec3::new(20.5, 20.5, 38.5);

fn view(eye: Vec3, forward: Vec3, degrees: f32, near: f32) -> View {
    looking(eye, forward, [degrees.to_radians(), 1.0, near, 100.0])
}

/// A wall across the grid from z = 20 to 22, and a mover behind it in a volume that reaches before
/// it.
fn hidden_mover(desc: ObjectDesc) -> (Scene, ObjectId) {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(0.0, 0.0, 20.0), Vec3::new(40.0, 40.0, 22.0)));
    let id = scene.insert(desc).unwrap();
    let mut query = Query::new();
    scene.begin_frame(0.0).unwrap();
    query.run(&scene, &view(EYE, Vec3::NEG_Z, 60.0, 0.1));
    assert!(!query.pvs().contains(id));
    scene.end_frame([query.pvs()]).unwrap();
    let (lo, hi) = scene.tbv(id).unwrap().expect("a volume");
    assert!(lo.z < 20.0 && hi.z > 25.0 && hi.z < 30.0, "{lo} to {hi}");
    (scene, id)
}

const START: Sphere = Sphere { center: Vec3::new(20.5, 20.5, 19.0), radius: 0.3 };

#[test]
fn a_volume_whose_front_the_near_plane_cuts_away_hides_nothing_in_it() {
    for unreported in [false, true] {
        let desc = ObjectDesc::dynamic(START).max_speed(14.0);
        let (mut scene, id) = hidden_mover(if unreported { desc.reported_on_expiry() } else { desc });
        scene.begin_frame(0.4).unwrap();
        // Through the wall to its front: 5 m in 0.4 s. The volume reaches further towards the eye.
        if !unreported {
            scene.update(id, Sphere::new(Vec3::new(20.5, 20.5, 23.5), 0.3), None).unwrap();
            assert!(scene.tbv(id).unwrap().is_some());
        }
        for method in [Method::Frustum, Method::cell(), Method::point()] {
            // The near plane lies at z = 24, within the volume and before the object.
            let mut query = query_by(method);
            let pvs = query.run(&scene, &view(EYE, Vec3::NEG_Z, 10.0, EYE.z - 24.0));
            assert!(pvs.contains(id), "{method:?}, unreported: {unreported}");
        }
    }
}

#[test]
fn an_unreported_object_is_in_every_frustum_that_its_volume_meets() {
    let desc = ObjectDesc::dynamic(START).max_speed(14.0).reported_on_expiry();
    let (mut scene, id) = hidden_mover(desc);
    scene.begin_frame(0.3).unwrap();
    // It may be 4 m beside its old place, where this view looks.
    let beside = view(Vec3::new(24.5, 20.5, 2.5), Vec3::Z, 10.0, 0.1);
    for method in [Method::Frustum, Method::cell(), Method::point()] {
        let mut query = query_by(method);
        assert!(query.run(&scene, &beside).contains(id), "{method:?}");
    }
}

#[test]
fn frames_end_whatever_is_on_opposite_sides_of_the_world() {
    let places = [-3e9, 8.0, 3e9, 1e30];
    for (at, eye) in places.into_iter().flat_map(|at| places.map(|eye| (at, eye))) {
        let mut scene = empty();
        let bounds = Sphere::new(Vec3::new(at, 8.0, 8.0), 1.0);
        let desc = ObjectDesc::dynamic(bounds).max_speed(1.0);
        scene.insert(desc.clone()).unwrap();
        scene.insert(desc.reported_on_expiry()).unwrap();
        // Nothing is in this view.
        let away = [Vec3::X, Vec3::NEG_X].map(|normal| casca::Plane { normal, offset: -2e30 });
        for method in [Method::Frustum, Method::cell(), Method::point()] {
            let mut query = query_by(method);
            for frame in 0..3 {
                scene.begin_frame(f64::from(frame) * 0.1).unwrap();
                let view = View::from_planes(Vec3::new(eye, 8.0, 8.0), &away).unwrap();
                look(&mut scene, &mut query, &view);
            }
        }
    }
}

#[test]
fn a_flat_object_may_lie_on_the_wall_of_its_volume() {
    for flat in [0.0, 0.25] {
        let mut scene = empty();
        let plate = |y: f32| Aabb::new(Vec3::new(12.6, y - flat, 1.6), Vec3::new(12.8, y, 1.8));
        let id = scene.insert(ObjectDesc::dynamic(plate(4.5)).max_speed(1.0)).unwrap();
        let past = casca::Plane { normal: Vec3::Z, offset: -20.0 };
        let mut elsewhere = query_by(Method::point());
        look(&mut scene, &mut elsewhere, &View::from_planes(Vec3::new(5.5, 18.5, 20.5), &[past]).unwrap());
        let (_, high) = scene.tbv(id).unwrap().expect("nobody looked");
        // Nothing else is in the scene: it is in plain sight from above.
        scene.update(id, plate(high.y as f32), None).unwrap();
        for method in [Method::cell(), Method::point()] {
            let mut query = query_by(method);
            let view = around(Vec3::new(12.5, 18.5, 1.5));
            assert!(query.run(&scene, &view).contains(id), "{method:?}, {flat} thick");
        }
    }
}
