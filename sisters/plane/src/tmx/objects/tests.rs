//! Objects of small maps: their shapes, what they say, and what is amiss with them.

use std::io;

use glam::{IVec2, UVec2, Vec2};

use super::*;
use crate::bits::BitGrid;
use crate::editor::{Placed, Role};
use crate::geometry::{Disc, Rect, Shape};
use crate::grid::GridSpec;
use crate::query::Query;
use crate::scene::Scene;
use crate::tmx::{TmxError, TmxImport, TmxMap, TmxWarning};
use crate::view::View;

/// A tileset of tiles of 16 by 32 pixels; the tile 1 is a door, the tile 2 a wall of its own size.
const TILES: &str = "<tileset firstgid=\"1\" tilewidth=\"16\" tileheight=\"32\" tilecount=\"4\">\
    <tile id=\"1\" type=\"door\"/><tile id=\"2\"><image width=\"64\" height=\"48\"/><properties>\
    <property name=\"opaque\" type=\"bool\" value=\"true\"/></properties></tile></tileset>";

/// A map of tiles of 32 by 16 pixels with some layers.
fn map_of(orientation: &str, layers: &str) -> String {
    format!(
        "<map orientation=\"{orientation}\" width=\"8\" height=\"8\" tilewidth=\"32\" tileheight=\"16\" \
         infinite=\"1\">{TILES}{layers}</map>"
    )
}

fn read(text: &str) -> Result<TmxMap, TmxError> {
    TmxImport::default().parse_map(text.as_bytes(), |_| Err(io::ErrorKind::NotFound.into()))
}

/// The objects of a layer, and what is amiss with them.
fn objects(inner: &str) -> (Vec<TmxObject>, Vec<(u32, TmxFault)>) {
    let found =
        read(&map_of("orthogonal", &format!("<objectgroup name=\"o\">{inner}</objectgroup>"))).unwrap();
    let fault = |warning| match warning {
        TmxWarning::Object { id, layer, fault } => {
            assert_eq!(&*layer, "o");
            Some((id, fault))
        }
        TmxWarning::NothingBlocks { .. } => None,
        other => panic!("{other:?}"),
    };
    (found.objects, found.warnings.into_iter().filter_map(fault).collect())
}

/// The shape of the only object, with which nothing is amiss.
fn shape(inner: &str) -> TmxShape {
    let (mut objects, faults) = objects(inner);
    assert_eq!(faults, [], "{inner}");
    assert_eq!(objects.len(), 1, "{inner}");
    objects.remove(0).shape
}

fn rect(x: f32, y: f32, right: f32, bottom: f32) -> TmxShape {
    TmxShape::Rect(Rect::new(Vec2::new(x, y), Vec2::new(right, bottom)))
}

fn near(found: &[Vec2], expected: &[(f32, f32)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (p, &q) in found.iter().zip(expected) {
        assert!((*p - Vec2::from(q)).length() < 1e-6, "{found:?} {expected:?}");
    }
}

#[test]
fn shapes_lie_in_tiles() {
    assert_eq!(
        shape("<object id=\"1\" x=\"64\" y=\"8\" width=\"32\" height=\"32\"/>"),
        rect(2., 0.5, 3., 2.5)
    );
    assert_eq!(
        shape("<object id=\"1\" x=\"48\" y=\"8\"><point/></object>"),
        TmxShape::Point(Vec2::new(1.5, 0.5))
    );
    let corners = "points=\"0,0 32,0 0,-16\"/></object>";
    let points = [Vec2::new(1., 1.), Vec2::new(2., 1.), Vec2::new(1., 0.)];
    let polygon = shape(&format!("<object id=\"1\" x=\"32\" y=\"16\"><polygon {corners}"));
    assert_eq!(polygon, TmxShape::Polygon(points.to_vec()));
    let polyline = shape(&format!("<object id=\"1\" x=\"32\" y=\"16\"><polyline {corners}"));
    assert_eq!(polyline, TmxShape::Polyline(points.to_vec()));
    assert_eq!(polyline.bounds(), Rect::new(Vec2::new(1., 0.), Vec2::new(2., 1.)));
    // Tiles are twice as wide as high.
    let ellipse = |width: u32| {
        shape(&format!(
            "<object id=\"1\" x=\"32\" y=\"16\" width=\"{width}\" height=\"16\"><ellipse/></object>"
        ))
    };
    assert_eq!(ellipse(32), TmxShape::Disc(Disc::new(Vec2::splat(1.5), 0.5)));
    let axes = [Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.5)];
    assert_eq!(ellipse(64), TmxShape::Ellipse { center: Vec2::new(2.0, 1.5), axes });
    // A wall without thickness.
    assert_eq!(shape("<object id=\"1\" x=\"32\" y=\"16\" width=\"64\"/>"), rect(1., 1., 3., 1.));
    let wall = shape("<object id=\"1\" x=\"32\" y=\"16\" height=\"32\"><ellipse/></object>");
    assert_eq!(wall, TmxShape::Polyline(vec![Vec2::new(1., 1.), Vec2::new(1., 3.)]));
}

#[test]
fn objects_turn_clockwise_about_their_place() {
    let turned = |rotation: f32, inner: &str| {
        shape(&format!("<object id=\"1\" x=\"64\" y=\"64\" rotation=\"{rotation}\" {inner}"))
    };
    let wide = "width=\"32\" height=\"16\"/>";
    // By a quarter: the right becomes down, down becomes left.
    assert_eq!(turned(90., wide), rect(1.5, 4., 2., 6.));
    assert_eq!(turned(-270., wide), rect(1.5, 4., 2., 6.));
    assert_eq!(turned(180., wide), rect(1., 3., 2., 4.));
    let TmxShape::Polygon(corners) = turned(30., wide) else { panic!() };
    let (sin, cos) = (0.5, 0.75_f32.sqrt());
    near(
        &corners,
        &[
            (2., 4.),
            (2. + cos, 4. + 2. * sin),
            (2. + cos - sin / 2., 4. + 2. * sin + cos),
            (2. - sin / 2., 4. + cos),
        ],
    );
    let TmxShape::Polyline(wall) = turned(30., "width=\"32\"/>") else { panic!() };
    near(&wall, &[(2., 4.), (2. + cos, 4. + 2. * sin)]);
    let TmxShape::Ellipse { center, .. } = turned(90., "width=\"32\" height=\"16\"><ellipse/></object>")
    else {
        panic!()
    };
    near(&[center], &[(1.75, 5.)]);
    let round = turned(45., "width=\"64\" height=\"32\"><ellipse/></object>").bounds();
    // Half of sqrt(64^2 + 32^2) / sqrt(2) pixels around the middle, (64, 64) + (16, 48) / sqrt(2).
    let (half, root) = (2560_f32.sqrt() / 2., 0.5_f32.sqrt());
    let middle = Vec2::splat(64.) + Vec2::new(16., 48.) * root;
    let ends = [-half, half].map(|half| ((middle.x + half) / 32., (middle.y + half) / 16.));
    near(&[round.min, round.max], &ends);
    let TmxShape::Polyline(line) = turned(90., "><polyline points=\"0,0 32,0\"/></object>") else { panic!() };
    near(&line, &[(2., 4.), (2., 6.)]);
}

#[test]
fn tiles_stand_on_their_place() {
    let at = |inner: &str| shape(&format!("<object id=\"1\" x=\"64\" y=\"64\" {inner}/>"));
    // From the place up and to the right.
    assert_eq!(at("gid=\"1\" width=\"32\" height=\"16\""), rect(2., 3., 3., 4.));
    // Turned to the other side: the same box. Without a size, that of the tileset or the tile.
    assert_eq!(at("gid=\"2147483649\""), rect(2., 2., 2.5, 4.));
    assert_eq!(at("gid=\"3\""), rect(2., 1., 4., 4.));
    // By a quarter about the place: up becomes right.
    assert_eq!(at("gid=\"1\" width=\"32\" height=\"16\" rotation=\"90\""), rect(2., 4., 2.5, 6.));
    for (name, expected) in [
        ("topleft", rect(2., 4., 3., 5.)),
        ("center", rect(1.5, 3.5, 2.5, 4.5)),
        ("right", rect(1., 3.5, 2., 4.5)),
        ("bottom", rect(1.5, 3., 2.5, 4.)),
        ("bottomright", rect(1., 3., 2., 4.)),
        ("unspecified", rect(2., 3., 3., 4.)),
    ] {
        let object =
            "<objectgroup><object x=\"64\" y=\"64\" gid=\"1\" width=\"32\" height=\"16\"/></objectgroup>";
        let text = map_of("orthogonal", object);
        let text = text.replace("tilecount", &format!("objectalignment=\"{name}\" tilecount"));
        assert_eq!(read(&text).unwrap().objects[0].shape, expected, "{name}");
    }
}

#[test]
fn isometric_maps_count_along_rows_and_columns() {
    let text = map_of(
        "isometric",
        "<objectgroup offsetx=\"16\" offsety=\"8\"><object x=\"16\" y=\"32\" width=\"32\" height=\"16\"/>\
         <object x=\"16\" y=\"32\" gid=\"1\" width=\"32\" height=\"16\"/>\
         <object x=\"0\" y=\"0\" width=\"16\" height=\"16\" rotation=\"180\"/></objectgroup>",
    );
    let found = read(&text).unwrap().objects;
    // The shift is half a tile's width and height on the screen: one column.
    assert_eq!(found[0].shape, rect(2., 2., 4., 3.));
    // A picture stands with the middle of its foot on its place (2, 2). It is as wide as a tile, so
    // that its corners are those of the diamond's box.
    let TmxShape::Polygon(corners) = &found[1].shape else { panic!() };
    near(corners, &[(0.5, 1.5), (1.5, 0.5), (2.5, 1.5), (1.5, 2.5)]);
    assert_eq!(found[2].shape, rect(0., -1., 1., 0.));
}

#[test]
fn layers_groups_and_names_are_kept() {
    let text = map_of(
        "orthogonal",
        "<group offsetx=\"32\" visible=\"0\"><group offsety=\"16\"><objectgroup name=\"in\" offsetx=\"-64\">\
         <object id=\"7\" name=\"n\" class=\"c\" x=\"0\" y=\"0\"><point/></object></objectgroup></group></group>\
         <objectgroup name=\"walls\"><object id=\"8\" type=\"t\" width=\"1\" height=\"1\"/>\
         <object id=\"9\" visible=\"0\" width=\"1\" height=\"1\"><properties>\
         <property name=\"opaque\" type=\"bool\" value=\"false\"/></properties></object>\
         <object id=\"10\"><text>opaque</text></object></objectgroup>",
    );
    let found = read(&text).unwrap();
    assert_eq!((found.walls, found.origin, found.warnings), (BitGrid::default(), IVec2::ZERO, vec![]));
    let [a, b, c] = &found.objects[..] else { panic!("{:?}", found.objects) };
    assert_eq!((a.id, &*a.name, &*a.class, &*a.layer, a.visible), (7, "n", "c", "in", false));
    assert_eq!((&a.shape, a.role), (&TmxShape::Point(Vec2::new(-1., 1.)), Role::Plain));
    assert_eq!((b.id, &*b.class, b.visible, b.role), (8, "t", true, Role::Wall));
    assert_eq!((c.id, c.visible, c.role), (9, false, Role::Plain));
}

#[test]
fn properties_classes_and_tiles_say_the_role() {
    let role = |attributes: &str, properties: &str| {
        let (objects, faults) = objects(&format!(
            "<object id=\"1\" width=\"8\" height=\"8\" {attributes}><properties>{properties}</properties></object>"
        ));
        (objects[0].role, faults.into_iter().map(|(_, fault)| fault).collect::<Vec<_>>())
    };
    let says =
        |name: &str, value: bool| format!("<property name=\"{name}\" type=\"bool\" value=\"{value}\"/>");
    assert_eq!(role("", ""), (Role::Plain, vec![]));
    assert_eq!(role("", &says("opaque", true)).0, Role::Wall);
    assert_eq!(role("type=\"opaque\"", "").0, Role::Wall);
    assert_eq!(role("class=\"opaque\"", &says("opaque", false)).0, Role::Plain);
    assert_eq!(role("gid=\"3\"", "").0, Role::Wall);
    assert_eq!(role("gid=\"3\"", &says("opaque", false)).0, Role::Plain);
    assert_eq!(role("", &says("door", true)).0, Role::Door);
    assert_eq!(role("gid=\"3\" type=\"door\"", "").0, Role::Door);
    assert_eq!(role("gid=\"1073741826\"", "").0, Role::Door, "the class of the tile");
    assert_eq!(role("gid=\"2\" type=\"hatch\"", "").0, Role::Plain);
    let (found, faults) = role("", "<property name=\"opaque\" value=\"maybe\"/>");
    assert_eq!(found, Role::Plain);
    assert_eq!(faults, [TmxFault::PropertyType { property: "opaque".into(), kind: "string" }]);
}

#[test]
fn properties_have_types() {
    let (objects, faults) = objects(
        "<object id=\"4\"><point/><properties><property name=\"b\" type=\"bool\" value=\"true\"/>\
         <property name=\"i\" type=\"int\" value=\"-5\"/><property name=\"f\" type=\"float\" value=\"0.5\"/>\
         <property name=\"s\" value=\"a &amp; b\"/><property name=\"t\">two\nlines</property>\
         <property name=\"c\" type=\"color\" value=\"#80ff0102\"/><property name=\"d\" type=\"color\" value=\"#ff0102\"/>\
         <property name=\"e\" type=\"color\" value=\"\"/><property name=\"p\" type=\"file\" value=\"a.png\"/>\
         <property name=\"o\" type=\"object\" value=\"3\"/><property name=\"k\" type=\"class\" propertytype=\"K\">\
         <properties><property name=\"m\" type=\"int\" value=\"1\"/></properties></property>\
         <property name=\"w\" type=\"int\" value=\"1.5\"/><property name=\"x\" type=\"float\" value=\"inf\"/>\
         <property name=\"y\" type=\"list\"><item/></property></properties></object>",
    );
    let get = |name: &str| objects[0].properties[name].clone();
    assert_eq!(
        (get("b"), get("i"), get("f")),
        (TmxValue::Bool(true), TmxValue::Int(-5), TmxValue::Float(0.5))
    );
    assert_eq!(
        (get("s"), get("t")),
        (TmxValue::String("a & b".into()), TmxValue::String("two\nlines".into()))
    );
    assert_eq!(get("c"), TmxValue::Color(Some([255, 1, 2, 128])));
    assert_eq!((get("d"), get("e")), (TmxValue::Color(Some([255, 1, 2, 255])), TmxValue::Color(None)));
    assert_eq!((get("p"), get("o")), (TmxValue::File("a.png".into()), TmxValue::Object(3)));
    let members = [("m".to_string(), TmxValue::Int(1))].into();
    assert_eq!(get("k"), TmxValue::Class { class: "K".into(), members });
    assert_eq!(get("w"), TmxValue::String("1.5".into()));
    let wrong = |property: &str, kind: &str| {
        (4, TmxFault::PropertyValue { property: property.into(), kind: kind.into() })
    };
    assert_eq!(faults, [wrong("w", "int"), wrong("x", "float"), wrong("y", "list")]);
}

#[test]
fn faults_name_the_object_and_the_reason() {
    let many: String = (0..300).map(|i| format!("{i},{} ", i * i)).collect();
    let points = |element: &str, points: &str| format!("><{element} points=\"{points}\"/></object>");
    for (inner, left_out, said) in [
        ("x=\"NaN\"/>", true, "x=\"NaN\" is no number"),
        ("y=\"1e999\"/>", true, "y=\"1e999\" is no number"),
        ("width=\"-1\" height=\"4\"/>", true, "width=\"-1\""),
        ("rotation=\"left\"/>", true, "rotation=\"left\""),
        ("gid=\"-3\"/>", true, "gid=\"-3\""),
        ("gid=\"9\"/>", true, "no tileset has its tile 9"),
        ("gid=\"0\"/>", true, "no tileset has its tile 0"),
        ("x=\"1e300\" width=\"4\" height=\"4\"/>", true, "a coordinate=\""),
        ("x=\"1e12\"><point/></object>", true, "31250000000 tiles"),
        ("template=\"t.tx\"/>", true, "the template t.tx is not read: t.tx cannot be read"),
        ("><capsule/></object>", true, "the shape capsule is not known"),
        (&points("polygon", "0,0 1,1"), true, "2 points"),
        (&points("polyline", "0,0"), true, "1 points"),
        (&points("polygon", "0,0 1,1 2"), true, "points=\"2\""),
        (&points("polyline", "0,0 1,inf"), true, "points=\"1,inf\""),
        (&points("polygon", "0,0 9,9 9,0 0,9"), false, "cross or touch"),
        (&points("polygon", "0,0 9,9 3,3"), false, "cross or touch"),
        (&points("polygon", &many), false, "300 corners"),
        ("x=\"4\"/>", false, "it has no size"),
        ("type=\"opaque\"><point/></object>", false, "it has no size"),
    ] {
        let (objects, faults) = objects(&format!("<object id=\"5\" {inner}"));
        assert_eq!(objects.is_empty(), left_out, "{inner:.80}");
        let [(5, fault)] = &faults[..] else { panic!("{inner:.80}: {faults:?}") };
        assert!(fault.to_string().contains(said), "{fault} / {said}");
        let warning = TmxWarning::Object { id: 5, layer: "o".into(), fault: fault.clone() }.to_string();
        assert!(warning.starts_with("the object 5 of the layer \"o\": "), "{warning}");
    }
}

#[test]
fn classes_in_each_other_end() {
    let open = "<properties><property name=\"p\" type=\"class\">".repeat(100);
    let close = "</property></properties>".repeat(100);
    let (objects, faults) = objects(&format!("<object id=\"2\"><point/>{open}{close}</object>"));
    assert_eq!(faults, [(2, TmxFault::Deep("p".into()))]);
    let (mut depth, mut value) = (0, &objects[0].properties["p"]);
    while let TmxValue::Class { members, .. } = value {
        depth += 1;
        let Some(inner) = members.get("p") else { break };
        value = inner;
    }
    assert_eq!(depth, 17);
}

/// Whether an eye sees a point in a scene of some objects; tiles of the size 2 from (-4, -8) on.
fn sees(scene: &Scene, eye: (f32, f32), to: (f32, f32)) -> bool {
    let world = |p: (f32, f32)| Vec2::new(-4., -8.) + 2. * Vec2::from(p);
    let mut query = Query::new();
    query.run(scene, &View::all_round(world(eye)).unwrap());
    query.sees_point(world(to))
}

fn scene(objects: &[TmxObject]) -> (Scene, Vec<Placed>) {
    let spec = GridSpec { min: Vec2::splat(-16.), cell: 1., dims: UVec2::splat(48) };
    let mut scene = Scene::new(&spec).unwrap();
    let placed = objects.iter().map(|o| o.insert(&mut scene, Vec2::new(-4., -8.), 2.).unwrap()).collect();
    (scene, placed)
}

#[test]
fn walls_and_doors_hide_in_scenes() {
    // An angle of walls around (3, 3), open to the left and to the top, in tiles of 32 by 16.
    let (found, faults) = objects(
        "<object id=\"11\" type=\"door\" x=\"32\" y=\"16\"><polygon points=\"96,0 128,0 128,64 0,64 0,48 96,48\"/></object>\
         <object id=\"12\" type=\"opaque\" x=\"32\" y=\"128\" width=\"64\" height=\"16\"><ellipse/></object>\
         <object id=\"13\" x=\"192\" y=\"16\" width=\"32\" height=\"16\"/>",
    );
    assert_eq!(faults, []);
    let (mut scene, placed) = scene(&found);
    assert_eq!(placed[0].ids().count(), 2, "an angle of two parts");
    for (placed, object) in placed.iter().zip(&found) {
        for id in placed.ids() {
            assert_eq!(scene.user_data(id).unwrap(), u64::from(object.id));
            assert_eq!(scene.occluder(id).unwrap().is_some(), object.role != Role::Plain);
        }
    }
    let eye = (3., 3.);
    assert!(!sees(&scene, eye, (6., 3.)) && !sees(&scene, eye, (3., 6.)), "behind the angle");
    assert!(sees(&scene, eye, (1.5, 1.5)), "in the angle, and outside of its open sides");
    assert_eq!(placed[0].is_closed(&scene), Ok(true));
    placed[0].set_closed(&mut scene, false).unwrap();
    assert_eq!(placed[0].is_closed(&scene), Ok(false));
    assert!(sees(&scene, eye, (6., 3.)) && sees(&scene, eye, (3., 6.)));
    assert!(!sees(&scene, (2., 6.), (2., 10.)) && sees(&scene, (0.5, 6.), (0.5, 10.)), "the ellipse");
    placed[0].set_closed(&mut scene, true).unwrap();
    assert!(!sees(&scene, eye, (6., 3.)));
    assert!(sees(&scene, (6.5, 0.5), (6.5, 3.)), "through what hides nothing");
    let first = placed[0].ids().next().unwrap();
    let last = placed[0].ids().last().unwrap();
    scene.remove(last).unwrap();
    assert!(placed[0].set_closed(&mut scene, false).is_err() && placed[0].is_closed(&scene).is_err());
    assert!(scene.occluder(first).unwrap().is_some(), "nothing changed");
}

#[test]
fn each_shape_has_parts_that_scenes_take() {
    let (found, _) = objects(
        "<object id=\"1\" type=\"opaque\"><polygon points=\"0,0 64,64 64,0 0,64\"/></object>\
         <object id=\"2\" type=\"opaque\"><polyline points=\"0,0 64,64 64,64\"/></object>\
         <object id=\"3\" type=\"opaque\" width=\"32\" height=\"16\"><ellipse/></object>\
         <object id=\"4\" type=\"opaque\" width=\"64\" height=\"16\" rotation=\"20\"><ellipse/></object>\
         <object id=\"5\" type=\"opaque\" y=\"64\" width=\"64\" height=\"1e-40\"><ellipse/></object>\
         <object id=\"6\"><point/></object>",
    );
    let parts = |i: usize| found[i].parts(Vec2::ZERO, 1.0).unwrap().remove(0);
    let ring = |shape: &Shape| matches!(shape, Shape::Polyline(line) if line.points().len() == 5);
    assert!(ring(&parts(0).0) && parts(0).1.is_some_and(|occluder| ring(&occluder)));
    assert!(matches!(parts(1).0, Shape::Polyline(_)) && matches!(parts(2).0, Shape::Disc(_)));
    let (Shape::Polygon(outer), Some(Shape::Polygon(inner))) = parts(3) else { panic!() };
    let TmxShape::Ellipse { center, axes: [a, b] } = found[3].shape else { panic!() };
    // In the coordinates of the axes the ellipse is a circle.
    let from_center = |p: Vec2| {
        let p = p - center;
        Vec2::new(p.perp_dot(b), a.perp_dot(p)).length() / a.perp_dot(b).abs()
    };
    for corner in inner.corners() {
        assert!((from_center(*corner) - 1.0).abs() < 1e-5);
    }
    for (p, q) in outer.corners().iter().zip(outer.corners().iter().cycle().skip(1)) {
        assert!((from_center((*p + *q) / 2.0) - 1.0).abs() < 1e-5);
    }
    assert!(matches!(parts(4).0, Shape::Segment(_)));
    assert_eq!(parts(5), (Disc::new(Vec2::ZERO, 0.0).into(), None));
    let (scene, placed) = scene(&found);
    assert_eq!((scene.len(), placed.len()), (6, 6));
    for wrong in [f32::NAN, f32::INFINITY, -1.0] {
        assert!(found.iter().all(|object| object.parts(Vec2::ZERO, wrong).is_err()));
        assert!(wrong == -1.0 || found[0].parts(Vec2::new(wrong, 0.0), 1.0).is_err());
    }
    // Nothing is left of an object that does not fit into single precision.
    let (mut scene, _) = self::scene(&[]);
    let far = found.iter().filter(|o| o.id < 6);
    far.for_each(|object| _ = object.insert(&mut scene, Vec2::splat(f32::MAX), f32::MAX).unwrap_err());
    assert!(scene.is_empty());
}
