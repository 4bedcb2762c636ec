//! What applications rely on beside the sets: types that cross threads, ids, keys and the data of objects.

use casca::matrix::{BitMatrix, IdMatrix, TbvMatrix};
use casca::reference::{Cap, CapPolygon};
use casca::{
    Aabb, AggressiveOpacity, Bounds, CellRun, Convex, DrawItem, DrawOptions, Error, Facing, FileError,
    FrameReport, Grid, GridSpec, Instance, MemoryUse, Method, Motion, Obb, ObjectDesc, ObjectId, ObjectRef,
    Occluder, OcclusionImage, Plane, Preparation, Pvs, PvsChanges, Query, Reports, Scene, Settings, Sphere,
    Stats, TriMesh, View,
};
use glam::{UVec3, Vec3};

fn scene() -> Scene {
    Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(32) }).unwrap()
}

fn ball(x: f32) -> Sphere {
    Sphere::new(Vec3::new(x, 16.5, 16.5), 0.5)
}

const WALL: Aabb = Aabb { min: Vec3::new(8.0, 0.0, 0.0), max: Vec3::new(10.0, 32.0, 32.0) };

#[test]
fn every_public_type_crosses_threads() {
    fn crosses<T: Send + Sync>() {}
    macro_rules! all_cross {
        ($($type:ty),+ $(,)?) => { $(crosses::<$type>();)+ };
    }
    all_cross!(
        Aabb,
        AggressiveOpacity,
        BitMatrix,
        Bounds,
        Cap,
        CapPolygon,
        CellRun,
        Convex,
        DrawItem,
        DrawOptions,
        Error,
        Facing,
        FileError,
        FrameReport,
        Grid,
        GridSpec,
        IdMatrix,
        Instance,
        MemoryUse,
        Method,
        Motion,
        Obb,
        ObjectDesc,
        ObjectId,
        ObjectRef<'static>,
        Occluder,
        OcclusionImage,
        Plane,
        Preparation,
        Pvs,
        PvsChanges<'static>,
        Query,
        Reports,
        Scene,
        Settings,
        Sphere,
        Stats,
        TbvMatrix,
        TriMesh,
        View,
    );
}

#[test]
fn a_cleared_scene_is_an_empty_one_that_knows_no_old_id() {
    let mut scene = scene();
    let (empty, view) = (scene.clone().memory(), View::around(Vec3::new(2.5, 16.5, 16.5)).unwrap());
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
    let view = View::around(Vec3::new(2.5, 16.5, 16.5)).unwrap();
    let mut query = Query::new();
    query.run(&scene, &view);
    scene.set_user_data(moving, 10).unwrap();
    assert!(query.pvs().holds(&scene, &view), "nothing moved");
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
        query.run(scene, &View::around(Vec3::new(x, 12.5, 16.5)).unwrap()).clone()
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
