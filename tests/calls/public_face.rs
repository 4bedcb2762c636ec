//! What applications rely on beside the sets: types that cross threads, ids, keys and the data of
//! objects.

use casca::internals::SceneInternals;
use glam::camera::rh::{proj, view::look_at_mat4};

use crate::common::*;

fn ball(x: f32) -> Sphere {
    Sphere::new(Vec3::new(x, 16.5, 16.5), 0.5)
}

const WALL: Aabb = Aabb { min: Vec3::new(8.0, 0.0, 0.0), max: Vec3::new(10.0, 32.0, 32.0) };

#[test]
fn what_applications_hold_crosses_threads_and_prints_itself() {
    fn crosses_and_prints<T: Send + Sync + std::fmt::Debug>() {}
    crosses_and_prints::<(Scene, Query, Pvs, View, TriMesh, Convex, Error)>();
    crosses_and_prints::<(KeptQuery, KeptJob, KeptResult, ObjectDesc, Sight<'static>, PvsChanges<'static>)>();
}

#[test]
fn a_cleared_scene_is_an_empty_one_that_knows_no_old_id() {
    let mut scene = empty();
    let (empty, view) = (scene.clone().memory(), around(Vec3::new(2.5, 16.5, 16.5)));
    let fill = |scene: &mut Scene| {
        let wall = scene.solid(WALL);
        let near = scene.insert(ObjectDesc::dynamic(ball(4.5))).unwrap();
        let far = scene.insert(ObjectDesc::dynamic(ball(20.5)).max_speed(1.0).reported_on_expiry()).unwrap();
        let away = scene.insert(ObjectDesc::dynamic(ball(90.0)).occluder(ball(90.0))).unwrap();
        [wall, near, far, away]
    };
    let mut query = Query::new();
    let mut walk = |scene: &mut Scene| {
        scene.begin_frame(1.0).unwrap();
        let ids = fill(scene);
        query.run(scene, &view);
        let seen = ids.map(|id| query.pvs().contains(id));
        (ids, seen, scene.end_frame([query.pvs()]).unwrap())
    };
    let (old, seen, report) = walk(&mut scene);
    assert!(scene.tbv(old[2]).unwrap().is_some() && report.hidden == 2);
    scene.clear();
    assert!(scene.is_empty() && scene.iter().next().is_none());
    for id in old {
        assert!(!scene.contains(id));
        assert_eq!(scene.remove(id), Err(Error::UnknownObject(id)));
    }
    assert_eq!(scene.static_opacity().count() + scene.dynamic_opacity().count(), 0);
    assert_eq!((scene.id_matrix().entries(), scene.tbv_matrix().volumes()), (0, 0));
    assert!(scene.memory().grid() >= empty.grid());
    let (new, again, repeated) = walk(&mut scene);
    assert_eq!((seen, report), (again, repeated), "a cleared scene answers as a new one");
    assert!(new.iter().all(|id| scene.contains(*id) && !old.contains(id)));
}

#[test]
fn all_objects_are_listed_with_their_data() {
    let mut scene = empty();
    scene.reserve(usize::MAX);
    let wall = scene.insert(ObjectDesc::fixed(WALL).occluder(WALL).user_data(u64::MAX)).unwrap();
    let gone = scene.fixed(ball(3.0));
    let moving = scene.insert(ObjectDesc::dynamic(ball(4.0)).max_speed(2.0)).unwrap();
    scene.remove(gone).unwrap();
    let listed: Vec<_> = scene.iter().map(|(id, o)| (id, o.user_data())).collect();
    assert_eq!(listed, [(wall, u64::MAX), (moving, 0)]);
    assert!(scene.iter().map(|(id, _)| id).eq(scene.ids()));
    let (_, object) = scene.iter().nth(1).unwrap();
    assert!(matches!(object.bounds(), Bounds::Sphere(s) if *s == ball(4.0)) && object.occluder().is_none());
    assert_eq!(object.motion(), Motion::Dynamic { max_speed: Some(2.0), reports: Reports::WhenMoved });
    scene.set_user_data(moving, 9).unwrap();
    assert_eq!((scene.user_data(moving), scene.user_data(wall)), (Ok(9), Ok(u64::MAX)));
    let view = around(Vec3::new(2.5, 16.5, 16.5));
    let mut query = Query::new();
    query.run(&scene, &view);
    scene.set_user_data(moving, 10).unwrap();
    assert!(query.pvs().is_valid_for(&scene, &view), "nothing moved");
    let unknown = Error::UnknownObject(gone);
    assert_eq!(scene.user_data(gone), Err(unknown));
    assert_eq!(scene.set_user_data(gone, 1), Err(unknown));
}

#[test]
fn a_key_names_one_object_of_a_scene_for_ever() {
    let mut scene = empty();
    let mut keys = Vec::new();
    for _ in 0..50 {
        let id = scene.fixed(ball(4.0));
        let key = scene.key(id).unwrap();
        assert!(!keys.contains(&key) && scene.id_from_key(key) == Ok(id));
        keys.push(key);
        scene.remove(id).unwrap();
        assert_eq!(scene.key(id), Err(Error::UnknownObject(id)));
    }
    assert!(keys.iter().all(|&key| scene.id_from_key(key) == Err(Error::UnknownKey(key))));
    assert_eq!(scene.id_from_key(u64::MAX), Err(Error::UnknownKey(u64::MAX)));
    let id = scene.fixed(ball(4.0));
    let copy = scene.clone();
    assert_eq!(copy.id_from_key(scene.key(id).unwrap()), Ok(id), "clones have it in common");
    assert!(scene.key(empty().insert(ObjectDesc::fixed(ball(4.0))).unwrap()).is_err());
}

#[test]
fn changes_are_the_differences_of_two_sets() {
    let mut scene = empty();
    let wall = scene.solid(WALL);
    let balls: Vec<ObjectId> = (0..20).map(|i| scene.fixed(ball(1.5 + 1.5 * i as f32))).collect();
    let mut query = Query::new();
    let run = |query: &mut Query, scene: &Scene, x: f32| {
        query.run(scene, &around(Vec3::new(x, 12.5, 16.5))).clone()
    };
    let never = query.pvs().clone();
    let (low, high) = (run(&mut query, &scene, 2.5), run(&mut query, &scene, 28.5));
    assert!(low.contains(wall) && high.contains(wall));
    let only =
        |a: &Pvs, b: &Pvs| a.visible().iter().copied().filter(|&id| !b.contains(id)).collect::<Vec<_>>();
    let changes = high.changes_since(&low);
    assert_eq!(changes.entered().collect::<Vec<_>>(), only(&high, &low));
    assert_eq!(changes.left().collect::<Vec<_>>(), only(&low, &high));
    assert!(changes.entered().any(|id| id == balls[15]) && changes.left().any(|id| id == balls[0]));
    let same = low.changes_since(&low);
    assert_eq!(same.entered().chain(same.left()).count(), 0);
    assert!(low.changes_since(&never).entered().eq(&low) && never.changes_since(&low).left().eq(low.iter()));
    // The index of an object that is gone is another's now.
    scene.remove(balls[0]).unwrap();
    let new = scene.fixed(ball(1.5));
    let later = run(&mut query, &scene, 2.5);
    let changes = later.changes_since(&low);
    assert!(new.index() == balls[0].index() && changes.entered().eq([new]) && changes.left().eq([balls[0]]));
}

#[test]
fn an_exact_eye_sees_the_same_with_any_depth() {
    let mut scene = empty();
    let wall = scene.solid(WALL);
    let near = scene.fixed(ball(5.0));
    scene.fixed(ball(20.0));
    scene.fixed(ball(3.0));
    let eye = Vec3::new(2.0, 16.5, 16.5);
    let look = look_at_mat4(eye, eye + Vec3::X, Vec3::Y);
    // The near plane leaves out the ball at 3, the wall hides the one at 20.
    let views = [
        View::perspective(eye, proj::directx::perspective(1.0, 1.5, 1.8, 60.0) * look),
        View::perspective(eye, proj::directx::perspective_infinite_reverse(1.0, 1.5, 1.8) * look),
        View::perspective_gl(eye, proj::opengl::perspective(1.0, 1.5, 1.8, 60.0) * look),
    ];
    for view in views {
        assert_eq!(sorted(Query::new().run(&scene, &view.unwrap())), [wall, near]);
    }
    let gl = proj::opengl::perspective(1.0, 1.5, 1.8, 60.0) * look;
    assert!(matches!(View::perspective_gl(eye + Vec3::Y, gl), Err(Error::EyeMismatch { .. })));
    assert!(View::perspective_gl(Vec3::NAN, gl).is_err());
}

#[test]
fn a_query_keeps_its_method_where_a_new_one_is_refused() {
    let cell = Method::Cell(CellOptions::new().mask_resolution(64));
    let mut query = query_by(cell);
    assert!(query.set_method(Method::Point(PointOptions::new().pixel_degrees(f32::NAN))).is_err());
    assert_eq!((query.method(), query.method().name()), (cell, "cell"));
}
