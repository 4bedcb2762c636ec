//! Shapes that tilesets draw on their tiles.

use glam::{DVec2, IVec2};

use super::*;
use crate::grid::GridSpec;
use crate::query::Query;
use crate::scene::Scene;
use crate::view::View;

const SIDEWAYS: u32 = 0x8000_0000;
const UPSIDE_DOWN: u32 = 0x4000_0000;
const SWAPPED: u32 = 0x2000_0000;

/// All ways to turn a tile.
fn turns() -> impl Iterator<Item = u32> {
    (0..8).map(|turn: u32| turn << 29)
}

/// A tileset of one picture, with attributes, elements and the objects on its tile.
fn tileset(attributes: &str, elements: &str, objects: &str) -> String {
    format!(
        "<tileset {attributes} tilecount=\"9\">{elements}<tile id=\"1\"><objectgroup draworder=\"index\" id=\"2\">{objects}\
         </objectgroup></tile></tileset>"
    )
}

/// A map of 3 by 2 tiles of 16 by 8 pixels, with a tileset from 1 on and a layer of some tiles.
fn map_of(orientation: &str, tileset: &str, layer: &str, tiles: &str) -> String {
    let tileset = tileset.replacen("<tileset", "<tileset firstgid=\"1\"", 1);
    format!(
        "<map orientation=\"{orientation}\" width=\"3\" height=\"2\" tilewidth=\"16\" tileheight=\"8\" infinite=\"0\">\
         {tileset}<layer {layer} width=\"3\" height=\"2\"><data encoding=\"csv\">{tiles}</data></layer></map>"
    )
}

/// Reads a map with one tile with objects, in the column 1 and the row 1.
fn one(turn: u32, objects: &str) -> TmxMap {
    let set = tileset("tilewidth=\"16\" tileheight=\"8\"", "", objects);
    map(&map_of("orthogonal", &set, "name=\"l\"", &format!("0,0,0,0,{},0", turn | 2))).unwrap()
}

/// Whether a point in tiles is in a shape, from the definition of each.
fn holds(shape: &TmxShape, p: DVec2) -> bool {
    match shape {
        TmxShape::Rect(r) => p.cmpge(r.min.as_dvec2()).all() && p.cmple(r.max.as_dvec2()).all(),
        TmxShape::Disc(disc) => p.distance(disc.center.as_dvec2()) <= f64::from(disc.radius),
        TmxShape::Ellipse { center, axes: [a, b] } => {
            let p = p - center.as_dvec2();
            let (a, b) = (a.as_dvec2(), b.as_dvec2());
            let area = a.perp_dot(b);
            DVec2::new(p.perp_dot(b) / area, a.perp_dot(p) / area).length() <= 1.0
        }
        TmxShape::Polygon(corners) => {
            let ends = corners.iter().zip(corners.iter().cycle().skip(1));
            let crosses = ends.filter(|(a, b)| {
                let (a, b) = (a.as_dvec2(), b.as_dvec2());
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
            });
            crosses.count() % 2 == 1
        }
        TmxShape::Point(_) | TmxShape::Polyline(_) => panic!("no area"),
    }
}

/// Shapes without any symmetry: a rectangle, a turned one, a polygon and an ellipse.
const SHAPES: &str = "<object id=\"1\" type=\"opaque\" x=\"0\" y=\"0\" width=\"5\" height=\"3\"/>\
    <object id=\"2\" type=\"opaque\" x=\"18.3\" y=\"2.1\" width=\"6\" height=\"4\" rotation=\"33\"/>\
    <object id=\"3\" class=\"opaque\" x=\"2.2\" y=\"14.3\"><polygon points=\"0,0 9.4,1.3 3.1,11.2\"/></object>\
    <object id=\"4\" type=\"opaque\" x=\"13.6\" y=\"26.4\" width=\"9\" height=\"5\"><ellipse/></object>";

/// The same, by hand: whether the middle of a pixel of the picture is in one.
fn drawn(x: i32, y: i32) -> bool {
    let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let turned = DVec2::from_angle(-33_f64.to_radians()).rotate(p - DVec2::new(18.3, 2.1));
    let sides = [(2.2, 14.3), (11.6, 15.6), (5.3, 25.5)].map(DVec2::from);
    let inside = (0..3).all(|i| (sides[(i + 1) % 3] - sides[i]).perp_dot(p - sides[i]) >= 0.0);
    p.x < 5.0 && p.y < 3.0
        || turned.cmpge(DVec2::ZERO).all() && turned.x < 6.0 && turned.y < 4.0
        || inside
        || ((p.x - 18.1) / 4.5).hypot((p.y - 28.9) / 2.5) < 1.0
}

/// A picture of 24 by 32 pixels, turned pixel by pixel: swapped first, then to the sides.
fn turned(turn: u32) -> Vec<Vec<bool>> {
    let mut rows: Vec<Vec<bool>> = (0..32).map(|y| (0..24).map(|x| drawn(x, y)).collect()).collect();
    if turn & SWAPPED != 0 {
        rows = (0..24).map(|x| rows.iter().map(|row| row[x]).collect()).collect();
    }
    if turn & SIDEWAYS != 0 {
        rows.iter_mut().for_each(|row| row.reverse());
    }
    if turn & UPSIDE_DOWN != 0 {
        rows.reverse();
    }
    rows
}

/// Compares the only tile with a picture whose upper left pixel is at `least` on the screen, and
/// whose pixels are `scale` large. `tiles` takes the screen to tiles.
fn compare(
    found: &TmxMap,
    picture: &[Vec<bool>],
    least: DVec2,
    scale: DVec2,
    tiles: &dyn Fn(DVec2) -> DVec2,
) {
    let [tile] = &found.tiles[..] else { panic!("{:?}", found.tiles) };
    assert_eq!((found.warnings.len(), tile.role, tile.shapes.len()), (0, Role::Wall, 4));
    let (height, width) = (picture.len() as i32, picture[0].len() as i32);
    let mut inside = 0;
    for (x, y) in (-9..width + 9).flat_map(|x| (-9..height + 9).map(move |y| (x, y))) {
        let screen = least + scale * (DVec2::new(f64::from(x), f64::from(y)) + 0.5);
        let p = tiles(screen) - tile.place;
        let expected = (0..width).contains(&x) && (0..height).contains(&y) && picture[y as usize][x as usize];
        inside += i32::from(expected);
        assert_eq!(tile.shapes.iter().any(|shape| holds(shape, p)), expected, "{:x} ({x}, {y})", tile.tile);
    }
    assert!(inside > 100, "{inside}");
}

#[test]
fn shapes_turn_as_the_pixels_of_the_picture_do() {
    let plain = |p: DVec2| p / DVec2::new(16.0, 8.0);
    for turn in turns() {
        let picture = turned(turn);
        let high = picture.len() as f64;
        let read = |attributes: &str, elements: &str, layer: &str| {
            let set = tileset(&format!("tilewidth=\"24\" tileheight=\"32\" {attributes}"), elements, SHAPES);
            map(&map_of("orthogonal", &set, layer, &format!("0,0,0,0,{},0", turn | 2))).unwrap()
        };
        // The cell has its lower left corner at (16, 16).
        let least = DVec2::new(16.0, 16.0 - high);
        compare(&read("", "", "name=\"l\""), &picture, least, DVec2::ONE, &plain);
        // Offsets are not turned; shifts of the layer are whole tiles or not.
        let found = read("", "<tileoffset x=\"3\" y=\"-5\"/>", "name=\"l\" offsetx=\"-32\" offsety=\"8\"");
        compare(&found, &picture, least + DVec2::new(-29.0, 3.0), DVec2::ONE, &plain);
        let mut found = read("", "", "name=\"l\" offsetx=\"5\" offsety=\"-3\"");
        assert!(matches!(found.warnings[..], [TmxWarning::Offset { .. }]));
        found.warnings.clear();
        compare(&found, &picture, least + DVec2::new(5.0, -3.0), DVec2::ONE, &plain);
        // Made as large as a tile of the map, of which a swapped picture takes the sides.
        let found = read("tilerendersize=\"grid\"", "<tileoffset x=\"3\" y=\"0\"/>", "name=\"l\"");
        let scale = DVec2::new(16.0 / 24.0, 8.0 / 32.0);
        let scale_turned = if turn & SWAPPED == 0 { scale } else { DVec2::new(scale.y, scale.x) };
        let shown = if turn & SWAPPED == 0 { 8.0 } else { 16.0 };
        compare(&found, &picture, DVec2::new(16.0 + 2.0, 16.0 - shown), scale_turned, &plain);
        // With its ratio, in the middle of the tile's box.
        let found = read("tilerendersize=\"grid\" fillmode=\"preserve-aspect-fit\"", "", "name=\"l\"");
        let box_ = if turn & SWAPPED == 0 { DVec2::new(16.0, 8.0) } else { DVec2::new(8.0, 16.0) };
        let size = DVec2::new(picture[0].len() as f64, high) / 4.0;
        let least = DVec2::new(16.0, 16.0 - box_.y) + (box_ - size) / 2.0;
        compare(&found, &picture, least, DVec2::splat(0.25), &plain);
    }
}

#[test]
fn tiles_of_one_map_bring_what_each_does_alone() {
    let object =
        |width: u32| format!("<object type=\"opaque\" x=\"2\" y=\"1\" width=\"{width}\" height=\"2\"/>");
    let attributes = "tilewidth=\"16\" tileheight=\"8\"";
    let shapes = |found: &TmxMap| found.tiles.iter().map(|tile| tile.shapes.clone()).collect::<Vec<_>>();
    // All turns of a tile; they differ.
    let alone: Vec<_> = turns().flat_map(|turn| shapes(&one(turn, &object(5)))).collect();
    let set = tileset(attributes, "", &object(5));
    let all = turns().map(|turn| (turn | 2).to_string()).collect::<Vec<_>>().join(",");
    let together = map_of("orthogonal", &set, "name=\"l\"", &all);
    let together = together.replace("width=\"3\" height=\"2\"", "width=\"8\" height=\"1\"");
    assert_eq!(shapes(&map(&together).unwrap()), alone);
    assert!((0..8).all(|i| !alone[..i].contains(&alone[i])));
    // Pictures of their own sizes stand on the foot of the cell.
    let own = |id: u32, high: u32| {
        let image =
            format!("<image width=\"16\" height=\"{high}\"/><objectgroup>{}</objectgroup>", object(5));
        format!("<tile id=\"{id}\">{image}</tile>")
    };
    let pictures = format!("<tileset tilecount=\"2\">{}{}</tileset>", own(0, 8), own(7, 12));
    let tops = shapes(&map(&map_of("orthogonal", &pictures, "name=\"l\"", "1,8,0,0,0,0")).unwrap());
    assert_eq!(*tops[0], [rect(0.125, 0.125, 0.4375, 0.375)]);
    assert_eq!(*tops[1], [rect(0.125, -0.375, 0.4375, -0.125)]);
    // Two tiles of a tileset, and one of another that has the number of the first.
    let more = set.replace(
        "</tileset>",
        &format!("<tile id=\"2\"><objectgroup>{}</objectgroup></tile></tileset>", object(6)),
    );
    let other = tileset(attributes, "", &object(7)).replacen("<tileset", "<tileset firstgid=\"10\"", 1);
    let text =
        map_of("orthogonal", &more, "name=\"l\"", "2,3,11,0,0,0").replace("<layer", &(other + "<layer"));
    let widths = [5.0, 6.0, 7.0].map(|width| [rect(0.125, 0.125, (2.0 + width) / 16.0, 0.375)]);
    assert_eq!(shapes(&map(&text).unwrap()).iter().map(|shapes| &shapes[..]).collect::<Vec<_>>(), widths);
}

#[test]
fn isometric_maps_and_tilesets_stand_on_the_foot_of_the_cell() {
    let tiles = |p: DVec2| {
        let (x, y) = (p.x / 16.0, p.y / 8.0);
        DVec2::new(y + x, y - x)
    };
    for turn in turns() {
        let picture = turned(turn);
        let set = tileset("tilewidth=\"24\" tileheight=\"32\"", "", SHAPES);
        let found =
            map(&map_of("isometric", &set, "name=\"l\"", &format!("0,0,0,0,{},0", turn | 2))).unwrap();
        // The diamond of the column 1 and the row 1 has its corners at (0, 8) and (0, 16), and is
        // 16 wide.
        let least = DVec2::new(-8.0, 16.0 - picture.len() as f64);
        compare(&found, &picture, least, DVec2::ONE, &tiles);
    }
    // Objects of isometric tilesets count along the sides of a diamond: all of it is the cell.
    let grid = "<grid orientation=\"isometric\" width=\"16\" height=\"8\"/>";
    let set = |object: &str| tileset("tilewidth=\"16\" tileheight=\"24\"", grid, object);
    let read = |object: &str| map(&map_of("isometric", &set(object), "name=\"l\"", "0,0,0,0,2,0")).unwrap();
    let found = read("<object type=\"opaque\" x=\"0\" y=\"0\" width=\"8\" height=\"8\"/>");
    assert_eq!((found.walls.cells().collect::<Vec<_>>(), &found.tiles[..]), (vec![(1, 1)], &[][..]));
    let found = read("<object type=\"opaque\" x=\"4\" y=\"0\" width=\"4\" height=\"8\"/>");
    assert_eq!(*found.tiles[0].shapes, [rect(0.5, 0.0, 1.0, 1.0)]);
    let plain = map(&map_of(
        "orthogonal",
        &set("<object type=\"opaque\" width=\"8\" height=\"8\"/>"),
        "",
        "2,0,0,0,0,0",
    ));
    let TmxShape::Polygon(corners) = &plain.unwrap().tiles[0].shapes[0] else { panic!() };
    // The diamond at the foot of the picture.
    assert_eq!(corners[..], [(0.5, 0.0), (1.0, 0.5), (0.5, 1.0), (0.0, 0.5)].map(Vec2::from));
}

fn rect(x: f32, y: f32, right: f32, bottom: f32) -> TmxShape {
    TmxShape::Rect(Rect::new(Vec2::new(x, y), Vec2::new(right, bottom)))
}

#[test]
fn roles_are_those_of_objects() {
    let object = |attributes: &str, says: &str| {
        format!(
            "<object x=\"4\" y=\"2\" width=\"4\" height=\"2\" {attributes}><properties>{says}</properties></object>"
        )
    };
    let says =
        |name: &str, value: bool| format!("<property name=\"{name}\" type=\"bool\" value=\"{value}\"/>");
    let read = |tile: &str, layer: &str, objects: &str| {
        let set = tileset("tilewidth=\"16\" tileheight=\"8\"", "", objects);
        let set = set.replace("<tile id=\"1\">", tile);
        let found = map(&map_of("orthogonal", &set, &format!("name=\"{layer}\""), "0,0,0,0,2,0")).unwrap();
        let roles = found.tiles.iter().map(|tile| (tile.role, tile.shapes.len())).collect::<Vec<_>>();
        let nothing = matches!(found.warnings[..], [TmxWarning::NothingBlocks { .. }]);
        assert!(
            nothing == (found.walls.count() == 0 && roles.is_empty())
                && (nothing || found.warnings.is_empty())
        );
        (found.walls.count(), roles)
    };
    let tile = |properties: &str| format!("<tile id=\"1\"><properties>{properties}</properties>");
    let (plain, wall, door) =
        (object("", ""), object("type=\"opaque\"", ""), object("", &says("door", true)));
    // Shapes that say nothing are passed over.
    assert_eq!(read("<tile id=\"1\">", "l", &plain), (0, vec![]));
    assert_eq!(read("<tile id=\"1\">", "l", &wall), (0, vec![(Role::Wall, 1)]));
    assert_eq!(read("<tile id=\"1\">", "l", &object("", &says("opaque", true))), (0, vec![(Role::Wall, 1)]));
    let all = [&*plain, &*wall, &*door, &*wall].concat();
    assert_eq!(read("<tile id=\"1\">", "l", &all), (0, vec![(Role::Wall, 2), (Role::Door, 1)]));
    // The class of the tile counts for shapes without one.
    assert_eq!(read("<tile id=\"1\" type=\"door\">", "l", &plain), (0, vec![(Role::Door, 1)]));
    assert_eq!(read("<tile id=\"1\" class=\"opaque\">", "l", &object("type=\"other\"", "")), (0, vec![]));
    // A tile that blocks does so wholly, and needs no shapes of walls in it.
    assert_eq!(read(&tile(&says("opaque", true)), "l", &plain), (1, vec![]));
    assert_eq!(read("<tile id=\"1\">", "walls", &plain), (1, vec![]));
    let out = "<object type=\"opaque\" x=\"4\" y=\"-2\" width=\"4\" height=\"4\"/>";
    assert_eq!(read("<tile id=\"1\">", "walls", out), (1, vec![(Role::Wall, 1)]));
    let right = "<object type=\"opaque\" x=\"4\" y=\"2\" width=\"13\" height=\"4\"/>";
    assert_eq!(read("<tile id=\"1\">", "walls", right), (1, vec![(Role::Wall, 1)]));
    // But not with a door: then its other shapes are walls.
    let with_door = [&*plain, &*door].concat();
    assert_eq!(read("<tile id=\"1\">", "walls", &with_door), (0, vec![(Role::Wall, 1), (Role::Door, 1)]));
    assert_eq!(
        read(&tile(&(says("door", true) + &says("opaque", true))), "l", &plain),
        (0, vec![(Role::Door, 1)])
    );
    let open = object("", &says("opaque", false));
    assert_eq!(read("<tile id=\"1\">", "walls", &[&*open, &*door].concat()), (0, vec![(Role::Door, 1)]));
    // A rectangle over the cell becomes a tile; a larger one stays a shape beside the tile.
    let over =
        |x: i32, width: i32| format!("<object type=\"opaque\" x=\"{x}\" width=\"{width}\" height=\"8\"/>");
    assert_eq!(read("<tile id=\"1\">", "l", &over(0, 16)), (1, vec![]));
    assert_eq!(read("<tile id=\"1\">", "l", &over(-1, 17)), (1, vec![(Role::Wall, 1)]));
    assert_eq!(read("<tile id=\"1\">", "l", &over(0, 15)), (0, vec![(Role::Wall, 1)]));
    let low = over(0, 16).replace("height=\"8\"", "height=\"7\"");
    assert_eq!(read("<tile id=\"1\">", "l", &low), (0, vec![(Role::Wall, 1)]));
    // It hides, whatever doors are in it.
    assert_eq!(read("<tile id=\"1\">", "l", &(over(0, 16) + &door)), (1, vec![(Role::Door, 1)]));
    // On a layer that is shifted by a part of a tile, no tile stands for the shapes in it.
    let set = tileset("tilewidth=\"16\" tileheight=\"8\"", "", &over(0, 16));
    let shifted = map(&map_of("orthogonal", &set, "name=\"walls\" offsetx=\"5\"", "0,0,0,0,2,0")).unwrap();
    assert_eq!((shifted.walls.count(), shifted.tiles.len()), (0, 1));
    // `read` looks at tiles only.
    let set = tileset("tilewidth=\"16\" tileheight=\"8\"", "", &over(0, 16));
    let text = map_of("orthogonal", &set, "name=\"l\"", "0,0,0,0,2,0");
    assert_eq!(TmxImport::default().parse(text.as_bytes(), |_| unreachable!()).unwrap().count(), 0);
}

#[test]
fn tiles_know_where_they_are() {
    let object = "<object type=\"opaque\" x=\"4\" y=\"2\" width=\"4\" height=\"2\"/>";
    let set = "<tileset firstgid=\"7\" source=\"sets/own.tsx\"/>";
    let chunk = |x: i32, y: i32, tiles: &str| {
        format!("<chunk x=\"{x}\" y=\"{y}\" width=\"2\" height=\"1\">{tiles}</chunk>")
    };
    let (left, right) = (chunk(-20, 5, "0,8"), chunk(30, -3, "8,2147483656"));
    let text = format!(
        "<map orientation=\"orthogonal\" width=\"3\" height=\"2\" tilewidth=\"16\" tileheight=\"8\" infinite=\"1\">{set}\
         <group visible=\"0\" offsetx=\"16\"><layer name=\"far\" offsety=\"4\"><data encoding=\"csv\">{left}{right}</data></layer>\
         </group><layer name=\"near\"><data encoding=\"csv\">{left}</data></layer></map>"
    );
    let files = |path: &str| {
        assert_eq!(path, "sets/own.tsx");
        Ok(tileset("tilewidth=\"16\" tileheight=\"8\"", "", object).into())
    };
    let found = TmxImport::default().parse_map(text.as_bytes(), files).unwrap();
    let places: Vec<_> =
        found.tiles.iter().map(|t| (t.place.to_array(), t.tile, &*t.layer, t.visible)).collect();
    let expected = [
        ([-18.0, 5.5], 8, "far", false),
        ([31.0, -2.5], 8, "far", false),
        ([32.0, -2.5], SIDEWAYS | 8, "far", false),
        ([-19.0, 5.0], 8, "near", true),
    ];
    assert_eq!(places, expected);
    assert_eq!(*found.tiles[0].shapes, [rect(0.25, 0.25, 0.5, 0.5)]);
    assert_eq!(*found.tiles[2].shapes, [rect(0.5, 0.25, 0.75, 0.5)]);
    assert!(std::sync::Arc::ptr_eq(&found.tiles[0].shapes, &found.tiles[3].shapes), "shared");
}

#[test]
fn templates_of_shapes_count_from_the_folder_of_the_tileset() {
    let instance = "<object id=\"5\" template=\"parts/a.tx\" x=\"8\" y=\"4\"/>";
    let set = "<tileset firstgid=\"1\" source=\"sets/own.tsx\"/>";
    let text = map_of("orthogonal", "<tileset/>", "name=\"l\"", "0,0,0,0,2,1073741826");
    let text = text.replace("<tileset firstgid=\"1\"/>", set);
    let read = |template: &str| {
        let files = |path: &str| match path {
            "sets/own.tsx" => Ok(tileset("tilewidth=\"16\" tileheight=\"8\"", "", instance).into()),
            "sets/parts/a.tx" => Ok(format!("<template>{template}</template>").into()),
            _ => Err(io::ErrorKind::NotFound.into()),
        };
        TmxImport::default().parse_map(text.as_bytes(), files).unwrap()
    };
    let found = read("<object type=\"door\" width=\"8\" height=\"2\"/>");
    assert_eq!((found.tiles.len(), found.tiles[0].role), (2, Role::Door));
    assert_eq!(*found.tiles[0].shapes, [rect(0.5, 0.5, 1.0, 0.75)]);
    assert_eq!(*found.tiles[1].shapes, [rect(0.5, 0.25, 1.0, 0.5)]);
    // A template with a picture, one of itself, and none.
    let warned = |template: &str| match &read(template).warnings[..] {
        [TmxWarning::TileObject { first: 1, tile: 1, id: 5, fault }, TmxWarning::NothingBlocks { .. }] => {
            fault.clone()
        }
        other => panic!("{other:?}"),
    };
    let picture = "<tileset firstgid=\"1\" source=\"own.tsx\"/><object gid=\"1\" type=\"opaque\"/>";
    assert!(matches!(warned(picture), TmxFault::Template { .. }), "own.tsx is not beside the template");
    assert_eq!(warned("<object gid=\"1\" type=\"opaque\"/>"), TmxFault::Picture);
    assert!(matches!(warned("<object template=\"a.tx\"/>"), TmxFault::Template { .. }));
}

#[test]
fn what_is_amiss_with_shapes_is_named_once() {
    let objects = "<object id=\"1\" type=\"opaque\"><point/></object><object id=\"2\" width=\"-1\"/>\
        <object id=\"3\" type=\"opaque\" gid=\"1\" width=\"4\" height=\"4\"/><object id=\"4\"><text>opaque</text></object>\
        <object id=\"5\" type=\"opaque\"><polygon points=\"0,0 8,8 8,0 0,8\"/></object><object id=\"6\"><star/></object>\
        <object id=\"7\"><polygon points=\"0,0 8,8 8,0 0,8\"/></object><object id=\"8\"><point/></object>\
        <object id=\"9\" type=\"opaque\"><polyline points=\"0,0 8,8\"/></object><object id=\"10\" type=\"opaque\" x=\"1e30\" \
        width=\"1\" height=\"1\"/><object id=\"11\" width=\"4\" height=\"4\"><properties><property name=\"n\" type=\"int\" \
        value=\"x\"/></properties></object><object id=\"12\" width=\"4\" height=\"4\"><properties><property name=\"opaque\" \
        value=\"maybe\"/></properties></object>";
    let set = tileset("tilewidth=\"16\" tileheight=\"8\"", "", objects);
    let tiles = format!("2,2,{},0,{},2", SIDEWAYS | 2, SWAPPED | 2);
    let text = map_of("orthogonal", &set, "name=\"l\"", &tiles);
    let found = map(&text).unwrap();
    let fault = |warning: &TmxWarning| match warning {
        TmxWarning::TileObject { first: 1, tile: 1, id, fault } => (*id, fault.clone()),
        other => panic!("{other:?}"),
    };
    let faults: Vec<_> = found.warnings.iter().map(fault).collect();
    let ids: Vec<_> = faults.iter().map(|(id, _)| *id).collect();
    assert_eq!(ids, [2, 3, 6, 11, 1, 5, 10, 12]);
    assert_eq!(
        (&faults[1].1, &faults[4].1, &faults[5].1),
        (&TmxFault::Picture, &TmxFault::NoSize, &TmxFault::Crossed)
    );
    assert!(found.warnings[1].to_string().contains("the object 3 on tile 1 of the tileset from 1 on: "));
    // The polygon, as a ring of walls, and the line.
    assert_eq!((found.tiles.len(), found.tiles[0].shapes.len()), (5, 2));
    // In a layer of walls shapes hide that said nothing before.
    let both =
        text.replace("</map>", "") + &text[text.find("<layer").unwrap()..].replace("\"l\"", "\"walls\"");
    let found = map(&both).unwrap();
    let more = found.warnings.len() - faults.len();
    assert_eq!((more, found.walls.count()), (2, 5), "the shapes 7 and 8");
}

#[test]
fn walls_hide_and_doors_open_in_scenes() {
    let objects = "<object type=\"opaque\" x=\"0\" y=\"3\" width=\"6\" height=\"2\"/>\
        <object type=\"door\" x=\"6\" y=\"3\" width=\"4\" height=\"1\"/><object type=\"door\" x=\"6\" y=\"4\" width=\"4\" height=\"1\"/>\
        <object type=\"opaque\" x=\"10\" y=\"3\" width=\"6\" height=\"2\"/>";
    let found = one(0, objects);
    assert_eq!(found.origin, IVec2::ZERO);
    let mut scene =
        Scene::new(&GridSpec { min: Vec2::ZERO, cell: 2.0, dims: glam::UVec2::splat(4) }).unwrap();
    let origin = Vec2::new(0.5, 1.0);
    let placed: Vec<_> =
        found.tiles.iter().map(|tile| tile.insert(&mut scene, origin, 2.0, 77).unwrap()).collect();
    let [walls, doors] = &placed[..] else { panic!() };
    assert_eq!((walls.ids().count(), doors.ids().count()), (2, 2));
    assert!(placed.iter().flat_map(|placed| placed.ids()).all(|id| scene.user_data(id) == Ok(77)));
    let sees = |scene: &Scene, x: f32| {
        let mut query = Query::new();
        let at = |y: f32| origin + Vec2::new(2.0 + 2.0 * x / 16.0, 2.0 + 2.0 * y / 8.0);
        query.run(scene, &View::all_round(at(-1.0)).unwrap());
        query.sees_point(at(7.0))
    };
    assert_eq!([1.0, 8.0, 15.0].map(|x| sees(&scene, x)), [false; 3]);
    doors.set_closed(&mut scene, false).unwrap();
    assert_eq!([1.0, 8.0, 15.0].map(|x| sees(&scene, x)), [false, true, false]);
    assert!(found.tiles[0].insert(&mut scene, Vec2::NAN, 1.0, 0).is_err());
    assert!(found.tiles[0].parts(Vec2::ZERO, -1.0).is_err());
}
