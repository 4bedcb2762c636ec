//! Objects of small maps: their shapes, their roles, and what is amiss with them.

use casca_maps::TmxObject;
use casca_plane::{GridSpec, Polyline, Query, Scene, Segment, View};
use glam::{IVec2, UVec2};

use super::*;

/// A map of tiles of 32 by 16 pixels with some layers.
fn map_of(orientation: &str, layers: &str) -> TmxMap {
    let text = format!(
        "<map orientation=\"{orientation}\" width=\"8\" height=\"8\" tilewidth=\"32\" tileheight=\"16\" \
         infinite=\"1\">{layers}</map>"
    );
    TmxImport::default().parse(text.as_bytes(), |_| Err(io::ErrorKind::NotFound.into())).unwrap()
}

/// The objects of a layer, and what is said of them.
fn objects(inner: &str) -> (Vec<TmxObject>, Vec<String>) {
    let found = map_of("orthogonal", &format!("<objectgroup name=\"o\">{inner}</objectgroup>"));
    let said = found.warnings.into_iter().filter(|said| !said.contains("nothing blocks"));
    (found.objects, said.collect())
}

/// The only object, with which nothing is amiss, as a wall.
fn wall(inner: &str) -> TmxObject {
    let (mut objects, said) = objects(&format!("<object type=\"wall\" {inner}"));
    assert_eq!((said.len(), objects.len()), (0, 1), "{inner} {said:?}");
    objects.remove(0)
}

fn rect(x: f32, y: f32, right: f32, bottom: f32) -> Shape {
    Rect::new(Vec2::new(x, y), Vec2::new(right, bottom)).into()
}

fn chain(points: &[(f32, f32)]) -> Shape {
    Polyline::new(&points.iter().map(|&p| Vec2::from(p)).collect::<Vec<_>>()).unwrap().into()
}

/// Whether a shape is a convex polygon with these corners.
fn is_polygon(shape: &Shape, corners: &[(f32, f32)]) -> bool {
    let Shape::Polygon(polygon) = shape else { return false };
    let near = |q: &(f32, f32)| polygon.corners().iter().any(|p| (*p - Vec2::from(*q)).length() < 1e-5);
    polygon.corners().len() == corners.len() && corners.iter().all(near)
}

#[test]
fn shapes_lie_in_tiles() {
    let same = |inner: &str| {
        let wall = wall(inner);
        assert_eq!(wall.occluder.as_ref(), Some(&wall.bounds), "{inner}");
        wall.bounds
    };
    assert_eq!(same("x=\"64\" y=\"8\" width=\"32\" height=\"32\"/>"), rect(2., 0.5, 3., 2.5));
    assert_eq!(same("x=\"32\" y=\"16\" width=\"64\"/>"), rect(1., 1., 3., 1.));
    let triangle = "points=\"0,0 32,0 0,-16\"/></object>";
    let polygon = same(&format!("x=\"32\" y=\"16\"><polygon {triangle}"));
    assert!(is_polygon(&polygon, &[(1., 1.), (2., 1.), (1., 0.)]), "{polygon:?}");
    let line = same(&format!("x=\"32\" y=\"16\"><polyline {triangle}"));
    assert_eq!(line, chain(&[(1., 1.), (2., 1.), (1., 0.)]));
    // Tiles are twice as wide as high.
    let ellipse = |size: &str| wall(&format!("x=\"32\" y=\"16\" {size} height=\"16\"><ellipse/></object>"));
    assert_eq!(ellipse("width=\"32\"").bounds, Shape::from(Disc::new(Vec2::splat(1.5), 0.5)));
    let TmxObject { bounds: Shape::Polygon(outer), occluder: Some(Shape::Polygon(inner)), .. } =
        ellipse("width=\"64\"")
    else {
        panic!()
    };
    let out = |p: Vec2| ((p - Vec2::new(2.0, 1.5)) / Vec2::new(1.0, 0.5)).length();
    assert!(inner.corners().iter().all(|&p| (out(p) - 1.0).abs() < 1e-5));
    let middles = outer.corners().iter().zip(outer.corners().iter().cycle().skip(1));
    assert!(middles.into_iter().all(|(p, q)| (out((*p + *q) / 2.0) - 1.0).abs() < 1e-5));
    let thin = same("x=\"32\" y=\"16\" height=\"32\"><ellipse/></object>");
    assert_eq!(thin, Shape::from(Segment::new(Vec2::new(1., 1.), Vec2::new(1., 3.))));
}

/// What is not convex hides by the ring of its sides, and is looked for in its hull.
#[test]
fn polygons_that_are_not_convex_are_rings() {
    for points in [&[(0, 0), (64, 0), (64, 32), (32, 8)][..], &[(0, 0), (64, 64), (64, 0), (0, 64)]] {
        let text: Vec<_> = points.iter().map(|(x, y)| format!("{x},{y}")).collect();
        let wall = wall(&format!("><polygon points=\"{}\"/></object>", text.join(" ")));
        let mut ring: Vec<_> = points.iter().map(|&(x, y)| (x as f32 / 32., y as f32 / 16.)).collect();
        ring.push(ring[0]);
        assert_eq!(wall.occluder, Some(chain(&ring)));
        assert!(matches!(wall.bounds, Shape::Polygon(_)));
    }
    // On one line, there is no hull.
    let flat = wall("><polygon points=\"0,0 32,0 64,0\"/></object>");
    assert_eq!(flat.bounds, chain(&[(0., 0.), (1., 0.), (2., 0.), (0., 0.)]));
}

#[test]
fn objects_turn_clockwise_about_their_place() {
    let turned = |rotation: f32, inner: &str| {
        wall(&format!("x=\"64\" y=\"64\" rotation=\"{rotation}\" {inner}")).bounds
    };
    let wide = "width=\"32\" height=\"16\"/>";
    // By a quarter: the right becomes down, down becomes left.
    assert_eq!(turned(90., wide), rect(1.5, 4., 2., 6.));
    assert_eq!(turned(-270., wide), rect(1.5, 4., 2., 6.));
    assert_eq!(turned(180., wide), rect(1., 3., 2., 4.));
    let (sin, cos) = (0.5, 0.75_f32.sqrt());
    let corners = [
        (2., 4.),
        (2. + cos, 4. + 2. * sin),
        (2. + cos - sin / 2., 4. + 2. * sin + cos),
        (2. - sin / 2., 4. + cos),
    ];
    assert!(is_polygon(&turned(30., wide), &corners));
    let line = turned(90., "><polyline points=\"0,0 32,0\"/></object>");
    assert_eq!(line, chain(&[(2., 4.), (2., 6.)]));
}

#[test]
fn objects_of_isometric_maps_lie_along_columns_and_rows() {
    let found = map_of(
        "isometric",
        "<objectgroup offsetx=\"16\" offsety=\"8\"><object x=\"16\" y=\"32\" width=\"32\" height=\"16\"/></objectgroup>",
    );
    // The shift is half a tile's width and height on the screen: one column.
    assert_eq!(found.objects[0].bounds, rect(2., 2., 4., 3.));
}

#[test]
fn layers_groups_and_names_are_kept() {
    let found = map_of(
        "orthogonal",
        "<group offsetx=\"32\"><group offsety=\"16\"><objectgroup name=\"in\" offsetx=\"-64\">\
         <object id=\"7\" name=\"n\" class=\"c\" x=\"0\" y=\"0\"><point/></object></objectgroup></group></group>\
         <objectgroup name=\"walls\"><object id=\"8\" type=\"t\" width=\"1\" height=\"1\"/>\
         <object id=\"10\"><text>opaque</text></object><object template=\"a.tx\"/><object gid=\"1\"/></objectgroup>",
    );
    assert_eq!((found.walls, found.origin), (BitGrid::default(), IVec2::ZERO));
    let [passed] = &found.warnings[..] else { panic!("{:?}", found.warnings) };
    assert!(passed.contains("the layer \"walls\" has 2 objects with pictures or of templates"), "{passed}");
    let [a, b] = &found.objects[..] else { panic!("{:?}", found.objects) };
    assert_eq!((a.id, &*a.name, &*a.class, &*a.layer, a.role), (7, "n", "c", "in", Role::Plain));
    assert_eq!((&a.bounds, &a.occluder), (&Shape::from(Disc::new(Vec2::new(-1., 1.), 0.0)), &None));
    assert_eq!((b.id, &*b.class, b.role), (8, "t", Role::Wall));
}

#[test]
fn warnings_name_the_object_and_the_reason() {
    let points = |element: &str, points: &str| format!("><{element} points=\"{points}\"/></object>");
    for (inner, left_out, said) in [
        ("x=\"NaN\"/>", true, "x=\"NaN\" is no number"),
        ("y=\"1e999\"/>", true, "y=\"1e999\" is no number"),
        ("width=\"-1\" height=\"4\"/>", true, "width=\"-1\""),
        ("rotation=\"left\"/>", true, "rotation=\"left\""),
        ("x=\"1e300\" width=\"4\" height=\"4\"/>", true, "too far away"),
        ("x=\"1e12\"><point/></object>", true, "31250000000 and 0 tiles"),
        ("><capsule/></object>", true, "the shape capsule is not known"),
        (&points("polygon", "0,0 1,1"), true, "2 points"),
        (&points("polyline", "0,0"), true, "not 1"),
        (&points("polygon", "0,0 1,1 2"), true, "points=\"2\""),
        (&points("polyline", "0,0 1,inf"), true, "points=\"1,inf\""),
        ("type=\"opaque\" x=\"4\"/>", false, "has no size"),
        ("type=\"opaque\"><point/></object>", false, "has no size"),
    ] {
        let (objects, warnings) = objects(&format!("<object id=\"5\" {inner}"));
        assert_eq!(objects.is_empty(), left_out, "{inner}");
        let [warning] = &warnings[..] else { panic!("{inner}: {warnings:?}") };
        assert!(warning.starts_with("the object 5 of the layer \"o\" "), "{warning}");
        assert!(warning.contains(said), "{warning}");
    }
}

#[test]
fn walls_and_doors_hide_in_scenes() {
    // An angle of walls around (3, 3), open to the left and to the top, in tiles of 32 by 16.
    let (found, said) = objects(
        "<object id=\"11\" type=\"door\" x=\"32\" y=\"16\"><polygon points=\"96,0 128,0 128,64 0,64 0,48 96,48\"/></object>",
    );
    assert!(said.is_empty(), "{said:?}");
    let mut scene =
        Scene::new(&GridSpec { min: Vec2::splat(-4.), cell: 1., dims: UVec2::splat(24) }).unwrap();
    let door = scene.insert(found[0].desc()).unwrap();
    assert_eq!(scene.user_data(door), Ok(11));
    let sees = |scene: &Scene, to: [(f32, f32); 3]| {
        let mut query = Query::new();
        query.run(scene, &View::all_round(Vec2::splat(3.)).unwrap());
        to.map(|to| query.sees_point(Vec2::from(to)))
    };
    // Behind the angle, twice, and in it.
    let points = [(6., 3.), (3., 6.), (1.5, 1.5)];
    assert_eq!(sees(&scene, points), [false, false, true]);
    scene.set_occluder(door, None).unwrap();
    assert_eq!(sees(&scene, points), [true; 3]);
}
