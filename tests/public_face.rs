//! What applications rely on beside the sets: types that cross threads, ids, keys and the data of
//! objects.

use casca::internals::SceneInternals;
use casca::{
    Aabb, Bounds, CellOptions, Convex, DrawOptions, Error, Facing, GridSpec, KeptJob, KeptQuery, KeptResult,
    MeshOptions, Method, Motion, ObjectDesc, ObjectId, PointOptions, Pvs, PvsChanges, Query, Reports, Scene,
    Sight, Sphere, TriMesh, View, World,
};
use glam::camera::rh::{proj, view::look_at_mat4};
use glam::{UVec3, Vec3};

fn scene() -> Scene {
    Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(32) }).unwrap()
}

fn ball(x: f32) -> Sphere {
    Sphere::new(Vec3::new(x, 16.5, 16.5), 0.5)
}

const WALL: Aabb = Aabb { min: Vec3::new(8.0, 0.0, 0.0), max: Vec3::new(10.0, 32.0, 32.0) };

#[test]
fn what_applications_hold_crosses_threads_and_prints_itself() {
    fn crosses_and_prints<T: Send + Sync + std::fmt::Debug>() {}
    crosses_and_prints::<(Scene, Query, Pvs, View, World, TriMesh, Convex, Error)>();
    crosses_and_prints::<(KeptQuery, KeptJob, KeptResult, ObjectDesc, Sight<'static>, PvsChanges<'static>)>();
}

#[test]
fn a_cleared_scene_is_an_empty_one_that_knows_no_old_id() {
    let mut scene = scene();
    let (empty, view) = (scene.clone().memory(), View::omnidirectional(Vec3::new(2.5, 16.5, 16.5)).unwrap());
    let fill = |scene: &mut Scene| {
        let wall = scene.insert(ObjectDesc::fixed(WALL).occluder(WALL)).unwrap();
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
    assert!(scene.tbv(old[2]).unwrap().is_some() && report.hidden == 1);
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
    let mut scene = scene();
    scene.reserve(usize::MAX);
    let wall = scene.insert(ObjectDesc::fixed(WALL).occluder(WALL).user_data(u64::MAX)).unwrap();
    let gone = scene.insert(ObjectDesc::fixed(ball(3.0))).unwrap();
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
    let view = View::omnidirectional(Vec3::new(2.5, 16.5, 16.5)).unwrap();
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
    let mut scene = scene();
    let mut keys = Vec::new();
    for _ in 0..50 {
        let id = scene.insert(ObjectDesc::fixed(ball(4.0))).unwrap();
        let key = scene.key(id).unwrap();
        assert!(!keys.contains(&key) && scene.id_from_key(key) == Ok(id));
        keys.push(key);
        scene.remove(id).unwrap();
        assert_eq!(scene.key(id), Err(Error::UnknownObject(id)));
    }
    assert!(keys.iter().all(|&key| scene.id_from_key(key) == Err(Error::UnknownKey(key))));
    assert_eq!(scene.id_from_key(u64::MAX), Err(Error::UnknownKey(u64::MAX)));
    let id = scene.insert(ObjectDesc::fixed(ball(4.0))).unwrap();
    let copy = scene.clone();
    assert_eq!(copy.id_from_key(scene.key(id).unwrap()), Ok(id), "clones have it in common");
    assert!(scene.key(self::scene().insert(ObjectDesc::fixed(ball(4.0))).unwrap()).is_err());
}

#[test]
fn changes_are_the_differences_of_two_sets() {
    let mut scene = scene();
    let wall = scene.insert(ObjectDesc::fixed(WALL).occluder(WALL)).unwrap();
    let balls: Vec<ObjectId> =
        (0..20).map(|i| scene.insert(ObjectDesc::fixed(ball(1.5 + 1.5 * i as f32))).unwrap()).collect();
    let mut query = Query::new();
    let run = |query: &mut Query, scene: &Scene, x: f32| {
        query.run(scene, &View::omnidirectional(Vec3::new(x, 12.5, 16.5)).unwrap()).clone()
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
    let new = scene.insert(ObjectDesc::fixed(ball(1.5))).unwrap();
    let later = run(&mut query, &scene, 2.5);
    let changes = later.changes_since(&low);
    assert!(new.index() == balls[0].index() && changes.entered().eq([new]) && changes.left().eq([balls[0]]));
}

#[test]
fn an_exact_eye_sees_the_same_with_any_depth() {
    let mut scene = scene();
    let wall = scene.insert(ObjectDesc::fixed(WALL).occluder(WALL)).unwrap();
    let near = scene.insert(ObjectDesc::fixed(ball(5.0))).unwrap();
    scene.insert(ObjectDesc::fixed(ball(20.0))).unwrap();
    scene.insert(ObjectDesc::fixed(ball(3.0))).unwrap();
    let eye = Vec3::new(2.0, 16.5, 16.5);
    let look = look_at_mat4(eye, eye + Vec3::X, Vec3::Y);
    // The near plane leaves out the ball at 3, the wall hides the one at 20.
    let views = [
        View::perspective(eye, proj::directx::perspective(1.0, 1.5, 1.8, 60.0) * look),
        View::perspective(eye, proj::directx::perspective_infinite_reverse(1.0, 1.5, 1.8) * look),
        View::perspective_gl(eye, proj::opengl::perspective(1.0, 1.5, 1.8, 60.0) * look),
    ];
    for view in views {
        let mut query = Query::new();
        let mut seen = query.run(&scene, &view.unwrap()).visible().to_vec();
        seen.sort_unstable();
        assert_eq!(seen, [wall, near]);
    }
    let gl = proj::opengl::perspective(1.0, 1.5, 1.8, 60.0) * look;
    assert!(matches!(View::perspective_gl(eye + Vec3::Y, gl), Err(Error::EyeMismatch { .. })));
    assert!(View::perspective_gl(Vec3::NAN, gl).is_err());
}

#[test]
fn options_are_built_in_one_expression() {
    let point = PointOptions::new()
        .min_solid_angle(0.1)
        .pixel_degrees(0.5)
        .min_pixels(1)
        .max_occluders(2)
        .refine_squares(3)
        .refine_depth(4)
        .refine_budget(5)
        .refine_patches(6)
        .coherent(true);
    let (angle, pixel) = (point.min_solid_angle, point.pixel_degrees);
    let numbers = (point.min_pixels, point.max_occluders, point.refine_squares, point.refine_depth);
    assert_eq!((angle, pixel, numbers), (0.1, 0.5, (1, 2, 3, 4)));
    assert_eq!((point.refine_budget, point.refine_patches, point.coherent), (5, 6, true));
    let cell = CellOptions::new().mask_resolution(64).min_solid_angle(0.2);
    assert_eq!((cell.mask_resolution, cell.min_solid_angle), (64, 0.2));
    let mesh = MeshOptions::default().tolerance(0.5).min_radius(0.25).max_angle(30.0);
    let mesh = mesh.gap(0.125).facing(Facing::Front).occludes(false);
    assert_eq!((mesh.tolerance, mesh.min_radius, mesh.max_angle), (Some(0.5), Some(0.25), Some(30.0)));
    assert_eq!(mesh.gap, Some(0.125));
    assert_eq!(
        (mesh.facing, mesh.occludes, DrawOptions::default().min_size(0.5).min_size),
        (Facing::Front, false, 0.5)
    );
    let mut query = Query::with_method(Method::Cell(cell)).unwrap();
    assert_eq!((query.method(), query.method().name()), (Method::Cell(cell), "cell"));
    assert!(query.set_method(Method::Point(point.pixel_degrees(f32::NAN))).is_err());
    assert_eq!(query.method(), Method::Cell(cell), "a query keeps its method where the new one is refused");
}

/// The tests of this package have all internals at hand; applications do not.
#[test]
fn examples_need_no_internals() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let entries = |folder| std::fs::read_dir(folder).unwrap().map(|entry| entry.map(|e| e.path()).unwrap());
    for example in entries(folder) {
        let sources = if example.is_dir() { entries(example).collect() } else { vec![example] };
        let texts: Vec<String> = sources.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
        assert!(texts.iter().any(|text| text.contains("use casca::")), "{sources:?}");
        assert!(!texts.iter().any(|text| text.contains("internals")), "{sources:?}");
    }
}

#[test]
fn boxes_know_their_middle_and_their_points() {
    assert_eq!(WALL.center(), Vec3::new(9.0, 16.0, 16.0));
    assert!(WALL.contains(WALL.min) && WALL.contains(WALL.max) && WALL.contains(WALL.center()));
    assert!(!WALL.contains(Vec3::new(7.99, 1.0, 1.0)) && !WALL.contains(Vec3::NAN));
}

#[test]
fn the_front_page_shows_the_readmes_example() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |file: &str| std::fs::read_to_string(root.join(file)).expect("a file of the package");
    let (readme, source) = (read("README.md"), read("src/lib.rs"));
    let example = readme.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next());
    let docs: Vec<&str> = source.lines().filter_map(|line| line.strip_prefix("//!")).collect();
    let docs: Vec<&str> = docs.into_iter().map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
    let example: Vec<&str> = example.expect("README has an example").lines().collect();
    assert!(example.len() > 20 && docs.windows(example.len()).any(|lines| lines == example));
}
