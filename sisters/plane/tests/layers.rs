//! Layers of objects, the validity of kept results, doors, and stored values.

use casca_plane::{
    BitGrid, Disc, Error, FieldOfView, FovOptions, GridSpec, Method, ObjectDesc, Query, Rect, Scene,
    TileLayer, TilePoint, View,
};
use glam::{UVec2, Vec2};

fn scene() -> Scene {
    Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(32) }).unwrap()
}

const METHODS: [Method; 3] = [Method::Point, Method::Cell, Method::Sector];

/// The wall is on layer 1: only views of that layer are stopped by it.
#[test]
fn objects_hide_in_the_views_that_show_them() {
    let mut scene = scene();
    let wall = Rect::new(Vec2::new(8.0, 2.0), Vec2::new(10.0, 30.0));
    let wall = scene.insert(ObjectDesc::fixed(wall).occluder(wall).layers(1)).unwrap();
    let disc = Disc::new(Vec2::new(16.5, 16.5), 0.4);
    let behind = [1, 2, 3, 0].map(|mask| scene.insert(ObjectDesc::dynamic(disc).layers(mask)).unwrap());
    let view = View::all_round(Vec2::new(4.5, 16.5)).unwrap();
    for method in METHODS {
        let mut query = Query::with_method(method).unwrap();
        let mut sees = |mask: u64, id| query.run(&scene, &view.with_layers(mask)).contains(id);
        for (id, own) in behind.into_iter().zip([1u64, 2, 3, 0]) {
            assert!(!(sees(0, id) || own == 0 && sees(u64::MAX, id)), "{method:?}");
            assert_eq!(sees(2, id), own & 2 != 0, "no wall on layer 2, {method:?} {own}");
            // Cells are opaque in all views or none, so that this wall hides from eyes only.
            let through = method != Method::Point;
            assert_eq!(sees(1, id), through && own & 1 != 0, "{method:?} {own}");
            assert_eq!(sees(3, id), through && own != 0, "{method:?} {own}");
        }
        assert!(sees(1, wall) && sees(5, wall) && !sees(2, wall));
    }
    assert_eq!(scene.layers(behind[2]), Ok(3));
    scene.remove(wall).unwrap();
    assert_eq!(scene.layers(wall), Err(Error::UnknownObject(wall)));
}

/// An object of a layer that no view of a frame shows is hidden, and comes back with its layer.
#[test]
fn volumes_of_other_layers_stay_closed() {
    let mut scene = scene();
    let disc = Disc::new(Vec2::new(16.5, 16.5), 0.4);
    let ghost = scene.insert(ObjectDesc::dynamic(disc).max_speed(1.0).layers(2)).unwrap();
    let view = View::all_round(Vec2::new(4.5, 16.5)).unwrap();
    let mut query = Query::new();
    for time in 0..3 {
        scene.begin_frame(f64::from(time)).unwrap();
        assert!(!query.run(&scene, &view.with_layers(1)).contains(ghost));
        let report = scene.end_frame([query.pvs()]).unwrap();
        assert_eq!((report.hidden, report.revealed), (usize::from(time == 0), 0));
    }
    assert!(query.run(&scene, &view.with_layers(2)).contains(ghost));
    assert_eq!(scene.end_frame([query.pvs()]).unwrap().revealed, 1);
}

#[test]
fn kept_sets_say_whether_they_hold() {
    let mut scene = scene();
    let disc = Disc::new(Vec2::splat(9.5), 1.0);
    let id = scene.insert(ObjectDesc::dynamic(disc)).unwrap();
    let view = View::all_round(Vec2::splat(2.5)).unwrap();
    let mut query = Query::new();
    assert!(!query.pvs().is_valid_for(&scene, &view), "it never ran");
    let kept = query.run(&scene, &view).clone();
    assert!(kept.is_valid_for(&scene, &view) && !kept.is_valid_for(&scene.clone(), &view));
    for other in [view.with_layers(1), view.with_range(9.0).unwrap(), View::all_round(Vec2::ONE).unwrap()] {
        assert!(!kept.is_valid_for(&scene, &other), "{other:?}");
    }
    scene.set_user_data(id, 4).unwrap();
    assert!(kept.is_valid_for(&scene, &view));
    scene.update(id, disc, None).unwrap();
    assert!(!kept.is_valid_for(&scene, &view));
}

#[test]
fn doors_open_and_close_for_objects_and_tiles() {
    let mut walls = BitGrid::new(9, 9);
    walls.fill(4, 0..4);
    walls.fill(4, 5..9);
    let mut layer = TileLayer::new(Vec2::ONE, 2.0, walls).unwrap();
    let mut scene = scene();
    scene.insert_tiles(&layer).unwrap();
    let count = scene.len();
    assert_eq!(scene.insert_door(&mut layer, 3, 4, true), Err(Error::DoorInWall { x: 3, y: 4 }));
    let outside = Error::DoorOutside { x: 9, y: 4, width: 9, height: 9 };
    assert_eq!(scene.insert_door(&mut layer, 9, 4, true), Err(outside));
    assert_eq!(scene.len(), count);
    let door = scene.insert_door(&mut layer, 4, 4, false).unwrap();
    let (mut query, mut fov) = (Query::new(), FieldOfView::new());
    let view = View::all_round(Vec2::new(10.0, 4.0)).unwrap();
    let mut revision = scene.revision();
    for (closed, changes) in [(false, false), (true, true), (true, false), (false, true), (true, true)] {
        scene.set_door(&mut layer, &door, closed).unwrap();
        assert_eq!(scene.revision() != revision, changes);
        revision = scene.revision();
        query.run(&scene, &view);
        assert_eq!(query.sees_point(Vec2::new(10.0, 16.0)), !closed);
        let seen = fov.run(layer.opaque(), TilePoint::center_of(4, 1), &FovOptions::default());
        assert_eq!(seen.get(4, 8), !closed);
    }
    scene.remove(door.object).unwrap();
    let gone = Err(Error::UnknownObject(door.object));
    assert_eq!(scene.set_door(&mut layer, &door, false), gone);
    assert!(layer.opaque().get(4, 4), "nothing changes");
    let mut small = TileLayer::new(Vec2::ZERO, 1.0, BitGrid::new(2, 2)).unwrap();
    assert!(matches!(scene.set_door(&mut small, &door, true), Err(Error::DoorOutside { .. })));
}

#[cfg(feature = "serde")]
#[test]
fn shapes_and_options_are_stored() {
    use casca_plane::{CellOptions, ConvexPolygon, Motion, Polyline, Reports, Shape};

    fn again<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
        serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
    }

    let corners = [Vec2::ZERO, Vec2::new(3.0, 0.5), Vec2::new(1.0, 4.25)];
    let shapes: [Shape; 5] = [
        Disc::new(Vec2::new(0.1, -7.3), 2.5).into(),
        Rect::new(Vec2::ZERO, Vec2::ONE).into(),
        casca_plane::Segment::new(Vec2::ZERO, Vec2::ONE).into(),
        ConvexPolygon::new(&corners).unwrap().into(),
        Polyline::new(&corners).unwrap().into(),
    ];
    for shape in &shapes {
        assert_eq!(&again(shape), shape);
    }
    let spec = GridSpec { min: Vec2::new(0.1, 0.2), cell: 0.3, dims: UVec2::new(4, 5) };
    assert_eq!(again(&spec), spec);
    for motion in [Motion::Static, Motion::Dynamic { max_speed: Some(0.7), reports: Reports::OnExpiry }] {
        assert_eq!(again(&motion), motion);
    }
    assert_eq!(again(&CellOptions::default()), CellOptions::default());
    assert_eq!(again(&Method::Cell), Method::Cell);
    let mut bits = BitGrid::new(70, 3);
    bits.fill(1, 5..70);
    assert_eq!(again(&bits), bits);
    // What no constructor makes, no file does.
    for bad in [
        r#"{"width":4294967295,"height":4294967295,"words":[1]}"#,
        r#"{"width":3,"height":2,"words":[1,2,3]}"#,
    ] {
        assert!(serde_json::from_str::<BitGrid>(bad).is_err(), "{bad}");
    }
    let full: BitGrid = serde_json::from_str(r#"{"width":3,"height":1,"words":[255]}"#).unwrap();
    assert_eq!(full.count(), 3);
    for bad in [r#"{"polygon":[[0,0],[1,1],[2,2]]}"#, r#"{"polyline":[[0,0]]}"#, r#"{"ball":1}"#] {
        assert!(serde_json::from_str::<Shape>(bad).is_err(), "{bad}");
    }
}
