//! Options, shapes and descriptions, stored as JSON and read back; files that are old, new, wrong
//! or hostile.

use std::fmt::Debug;

use casca::internals::SceneInternals;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{from_str, to_string};

use crate::common::*;

fn round_trip<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: T) {
    let text = to_string(&value).unwrap();
    assert_eq!(from_str::<T>(&text).unwrap(), value, "{text}");
}

fn refused<T: DeserializeOwned + Debug>(text: &str, why: &str) {
    let error = from_str::<T>(text).unwrap_err().to_string();
    assert!(error.contains(why), "{text}: {error}");
}

fn cube() -> Convex {
    let side = |normal: Vec3| Plane { normal, offset: 0.7 };
    Convex::from_planes(&Vec3::AXES.map(|n| [side(n), side(-n)]).concat()).unwrap()
}

#[test]
fn values_come_back_as_they_were() {
    for options in [PointOptions::new(), PointOptions::new().pixel_degrees(0.1).min_pixels(7)] {
        round_trip(options);
        round_trip(Method::Point(options));
    }
    round_trip(Method::Cell(CellOptions::new().mask_resolution(512)));
    round_trip(Method::Frustum);
    round_trip(MeshOptions::default().tolerance(0.5).facing(Facing::Front).occludes(false));
    round_trip(DrawOptions::default().min_size(0.25));
    round_trip(Aabb::new(Vec3::splat(-0.1), Vec3::splat(1e-30)));
    round_trip(Sphere::new(Vec3::new(0.1, 0.2, 0.3), 0.0));
    round_trip(Obb::new(Vec3::ONE, Vec3::splat(0.1), Quat::from_rotation_y(0.3)));
    round_trip(Plane { normal: Vec3::new(0.0, -3.0, 0.1), offset: 4.5 });
    round_trip(Motion::Static);
    round_trip(Motion::Dynamic { max_speed: Some(2.5), reports: Reports::OnExpiry });
    round_trip(Motion::Dynamic { max_speed: None, reports: Reports::WhenMoved });
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    for solid in [Convex::from_points(&corners).unwrap(), cube()] {
        let again: Convex = from_str(&to_string(&solid).unwrap()).unwrap();
        assert_eq!((again.faces(), again.vertices().len()), (solid.faces(), solid.vertices().len()));
        assert!(again.vertices().all(|v| solid.vertices().any(|own| own == v)));
    }
}

#[test]
fn names_in_files_are_those_of_the_documentation() {
    let cell: Method = from_str(r#"{"cell": {"mask_resolution": 64}}"#).unwrap();
    assert_eq!(cell, Method::Cell(CellOptions::new().mask_resolution(64)));
    assert_eq!(from_str::<Method>(r#""frustum""#).unwrap(), Method::Frustum);
    for method in [Method::cell(), Method::point(), Method::Frustum] {
        assert!(to_string(&method).unwrap().contains(method.name()));
    }
    let ball: Bounds = from_str(r#"{"sphere": {"center": [1, 2, 3], "radius": 0.5}}"#).unwrap();
    assert!(matches!(ball, Bounds::Sphere(s) if s == Sphere::new(Vec3::new(1.0, 2.0, 3.0), 0.5)));
    let bird: Motion = from_str(r#"{"dynamic": {"max_speed": 12}}"#).unwrap();
    assert_eq!(bird, Motion::Dynamic { max_speed: Some(12.0), reports: Reports::WhenMoved });
}

/// Files of older versions lack fields; those of newer ones have more.
#[test]
fn options_of_other_versions_are_read() {
    assert_eq!(from_str::<PointOptions>("{}").unwrap(), PointOptions::default());
    assert_eq!(from_str::<MeshOptions>("{}").unwrap(), MeshOptions::default());
    let newer: CellOptions = from_str(r#"{"mask_resolution": 64, "of_tomorrow": [1, 2]}"#).unwrap();
    assert_eq!(newer, CellOptions::new().mask_resolution(64));
    assert_eq!(from_str::<DrawOptions>(r#"{"x": null}"#).unwrap(), DrawOptions::default());
}

#[test]
fn options_out_of_range_are_refused_where_they_are_used() {
    let mut query = Query::new();
    for text in [
        r#"{"cell": {"mask_resolution": 65}}"#,
        r#"{"point": {"pixel_degrees": 1e30}}"#,
        r#"{"point": {"refine_depth": 17}}"#,
        r#"{"point": {"patch_radius": 65}}"#,
    ] {
        let method: Method = from_str(text).unwrap();
        assert!(matches!(query.set_method(method), Err(Error::Setting { .. })), "{text}");
    }
    refused::<Method>(r#"{"point": {"min_pixels": -1}}"#, "invalid value");
    refused::<Method>(r#""of_tomorrow""#, "unknown variant");
}

#[test]
fn values_that_are_no_shapes_are_refused() {
    refused::<Aabb>(r#"{"min": [0, 0, 2], "max": [1, 1, 1]}"#, "the box must not be inverted");
    refused::<Aabb>(r#"{"min": [0, 0, 0], "max": [1, 1, 1e39]}"#, "the box must be finite");
    refused::<Aabb>(r#"{"min": [0, 0, null], "max": [1, 1, 1]}"#, "null");
    refused::<Aabb>(r#"{"min": [0, 0, 0]}"#, "missing field `max`");
    refused::<Sphere>(r#"{"center": [0, 0, 0], "radius": -0.1}"#, "the sphere must not be negative");
    refused::<Sphere>(r#"{"center": [0, -1e39, 0], "radius": 1}"#, "must be finite");
    refused::<Obb>(r#"{"center": [0,0,0], "half": [1,1,1], "rotation": [0,0,0,0]}"#, "must have a rotation");
    refused::<Obb>(r#"{"center": [0,0,0], "half": [1,-1,1], "rotation": [0,0,0,1]}"#, "negative");
    refused::<Plane>(r#"{"normal": [0, 0, 0], "offset": 1}"#, "must not be zero");
    refused::<Plane>(r#"{"normal": [0, 0, 1], "offset": 1e300}"#, "must be finite");
    refused::<Convex>(r#"{"vertices": [[0,0,0],[1,0,0],[0,1,0]]}"#, "4 to 124");
    refused::<Convex>(r#"{"vertices": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]]}"#, "one plane");
    refused::<Convex>(r#"{"vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1e39]]}"#, "range of single");
    refused::<Convex>(
        r#"{"vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "lost": -1}"#,
        "must not be negative",
    );
}

#[test]
fn descriptions_come_back_and_make_the_same_cells() {
    let turned = Obb::new(Vec3::ONE, Vec3::splat(1.3), Quat::from_rotation_y(0.3));
    let around = Aabb::new(Vec3::splat(-3.0), Vec3::splat(3.9));
    let descs = [
        ObjectDesc::fixed(around).occluder(turned).user_data(u64::MAX),
        ObjectDesc::dynamic(around).occluder(Arc::new(cube())).max_speed(3.0).reported_on_expiry(),
        ObjectDesc::dynamic(turned),
        ObjectDesc::dynamic(around).occluder(around).placed(Affine3A::from_rotation_x(0.3)),
        ObjectDesc::fixed(around).occluder(Sphere::new(Vec3::ONE, 2.0)).layers(6),
    ];
    for desc in descs {
        let text = to_string(&desc).unwrap();
        let again: ObjectDesc = from_str(&text).unwrap();
        // Corners of convex solids may come in another order.
        assert!(to_string(&again).unwrap() == text || text.contains("convex"), "{text}");
        let (mut a, mut b) = (Scene::new(0.25).unwrap(), Scene::new(0.25).unwrap());
        let (id, copy) = (a.insert(desc).unwrap(), b.insert(again).unwrap());
        assert_eq!((a.user_data(id), a.layers(id)), (b.user_data(copy), b.layers(copy)));
        let state =
            |s: &Scene| (s.static_opacity().count(), s.dynamic_opacity().count(), s.id_matrix().entries());
        assert_eq!(state(&a), state(&b));
        assert!(state(&a).2 > 0);
    }
}

#[test]
fn descriptions_that_no_scene_takes_are_refused_both_ways() {
    let ball = Sphere::new(Vec3::ZERO, 1.0);
    let error = |desc: &ObjectDesc| to_string(desc).unwrap_err().to_string();
    assert_eq!(error(&ObjectDesc::fixed(ball).max_speed(1.0)), Error::FixedMoves.to_string());
    let sphere = r#"{"sphere": {"center": [0, 0, 0], "radius": 1}}"#;
    let text = |motion: &str, occluder: &str| {
        format!(r#"{{"bounds": {sphere}, "motion": {motion}, "occluder": {occluder}}}"#)
    };
    assert!(from_str::<ObjectDesc>(&text(r#""static""#, sphere)).is_ok());
    assert!(from_str::<ObjectDesc>(&text(r#""static""#, "null")).is_ok());
    let large = r#"{"box": {"min": [-1, -1, -2], "max": [1, 1, 1]}}"#;
    refused::<ObjectDesc>(&text(r#""static""#, large), "sticks out");
    let silent = r#"{"dynamic": {"reports": "on_expiry"}}"#;
    refused::<ObjectDesc>(&text(silent, "null"), "needs a greatest speed");
    refused::<ObjectDesc>(&text(r#"{"dynamic": {"max_speed": -1}}"#, "null"), "must not be negative");
    let flat = r#"null, "transform": [1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]"#;
    refused::<ObjectDesc>(&text(r#""static""#, flat), "must scale all axes alike");
}

/// Meshes have a file format of their own, and are shared: see `TriMesh::write`.
#[test]
fn meshes_are_left_out() {
    let mesh = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
    let mesh = Arc::new(mesh);
    let instance = Instance::new(mesh.clone(), Affine3A::IDENTITY).unwrap();
    let error = |text: serde_json::Result<String>| text.unwrap_err().to_string();
    assert!(error(to_string(&Bounds::from(mesh.clone()))).contains("Bounds::Mesh cannot be serialized"));
    assert!(error(to_string(&Occluder::from(instance))).contains("Occluder::Instance cannot be serialized"));
    assert!(to_string(&ObjectDesc::fixed(mesh)).is_err());
    refused::<Bounds>(r#"{"mesh": []}"#, "unknown variant `mesh`, expected one of");
}
