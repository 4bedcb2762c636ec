//! Projects of small levels: what blocks, entities, what is refused.

use std::io;

use glam::{IVec2, UVec2, Vec2};
use serde_json::{Value, json};

use super::*;
use crate::bits::BitGrid;
use crate::editor::Role;
use crate::geometry::{Rect, Shape};
use crate::grid::GridSpec;
use crate::query::Query;
use crate::scene::Scene;
use crate::view::View;

/// A layer of 4 by 2 tiles of 8 pixels, with other members.
fn layer(name: &str, definition: i64, members: Value) -> Value {
    let mut layer = json!({
        "__identifier": name, "__type": "IntGrid", "__cWid": 4, "__cHei": 2, "__gridSize": 8,
        "__pxTotalOffsetX": 0, "__pxTotalOffsetY": 0, "layerDefUid": definition, "iid": "l",
        "intGridCsv": [], "autoLayerTiles": [], "gridTiles": [], "entityInstances": [],
    });
    layer.as_object_mut().unwrap().extend(members.as_object().unwrap().clone());
    layer
}

fn level(layers: &[Value]) -> Value {
    json!({
        "identifier": "Cellar", "iid": "a-b", "worldX": -32, "worldY": 16, "worldDepth": -1,
        "pxWid": 32, "pxHei": 16, "layerInstances": layers,
    })
}

/// A project with values 1 (a wall) and 2 (water) in layers of the definition 10, and tiles 3 and 5
/// of the tileset 20 that are opaque.
fn project(levels: &[Value]) -> Value {
    json!({
        "jsonVersion": "1.5.3",
        "defs": {
            "layers": [{"uid": 10, "intGridValues": [
                {"value": 1, "identifier": "Opaque", "color": "#000000"},
                {"value": 2, "identifier": "water"}, {"value": 3, "identifier": null}]}],
            "tilesets": [
                {"uid": 20, "enumTags": [{"enumValueId": "Opaque", "tileIds": [3, 5]},
                    {"enumValueId": "Wet", "tileIds": [4]}]},
                {"uid": 21, "enumTags": []}],
            "entities": [{"uid": 30, "renderMode": "Rectangle"}, {"uid": 31, "renderMode": "Ellipse"}],
        },
        "levels": levels,
    })
}

fn read(levels: &[Value]) -> Result<Vec<LdtkLevel>, LdtkError> {
    LdtkImport::default().parse(project(levels).to_string().as_bytes(), |file| panic!("{file}"))
}

fn one(layers: &[Value]) -> LdtkLevel {
    read(&[level(layers)]).unwrap().remove(0)
}

fn drawn(walls: &BitGrid) -> Vec<String> {
    let row = |y| (0..walls.width()).map(|x| if walls.get(x, y) { '#' } else { '.' }).collect();
    (0..walls.height()).map(row).collect()
}

#[test]
fn values_block_by_their_names_or_by_the_layer() {
    let csv = json!({"intGridCsv": [0, 1, 2, 3, 1, 0, 0, 2]});
    let found = one(&[layer("Ground", 10, csv.clone())]);
    assert_eq!(drawn(&found.walls), [".#..", "#..."]);
    let placed = found.tile_layer(Vec2::new(10.0, 20.0), 0.5).unwrap().unwrap();
    assert_eq!((placed.bounds().min, placed.bounds().max), (Vec2::new(10.0, 20.0), Vec2::new(26.0, 28.0)));
    assert_eq!(placed.opaque().bits(), &found.walls);
    assert!(found.tile_layer(Vec2::ZERO, 0.0).is_err());
    assert_eq!((found.tile, found.place, found.depth), (Some(8), IVec2::new(-32, 16), -1));
    assert_eq!((&*found.name, &*found.iid, found.size, found.warnings.len()), ("Cellar", "a-b", [32, 16], 0));
    let found = one(&[layer("WALLS", 10, csv)]);
    assert_eq!(drawn(&found.walls), [".###", "#..#"]);
    // Nothing blocks, and no grid is made.
    let found = one(&[layer("Ground", 10, json!({"intGridCsv": [0, 2, 2, 3, 2, 0, 0, 2]}))]);
    assert_eq!(found.tile_layer(Vec2::ZERO, 0.0), Ok(None));
    assert_eq!((found.tile, found.walls), (None, BitGrid::default()));
    // Two layers together.
    let a = layer("A", 10, json!({"intGridCsv": [1, 0, 0, 0, 0, 0, 0, 0]}));
    let b = layer("B", 10, json!({"intGridCsv": [0, 0, 0, 0, 0, 0, 0, 1]}));
    assert_eq!(drawn(&one(&[a, b]).walls), ["#...", "...#"]);
}

#[test]
fn values_without_a_definition_are_named_and_block_only_in_walls() {
    let csv = json!({"intGridCsv": [0, 1, 7, 9, 0, 0, 0, 7]});
    let found = one(&[layer("Ground", 10, csv.clone())]);
    assert_eq!(drawn(&found.walls), [".#..", "...."]);
    let unknown = LdtkWarning::UnknownValues { layer: "Ground".into(), value: 7, count: 3 };
    assert_eq!(found.warnings, [unknown]);
    let found = one(&[layer("Walls", 99, csv)]);
    assert_eq!((drawn(&found.walls), found.warnings), (vec![".###".into(), "...#".into()], vec![]));
}

#[test]
fn files_with_a_byte_order_mark_and_in_utf_16_are_read() {
    let marked = |file: Value| [b"\xef\xbb\xbf", file.to_string().as_bytes()].concat();
    let wide = |file: Value| {
        let text = format!("\u{feff}{file}");
        text.encode_utf16().flat_map(u16::to_be_bytes).collect::<Vec<u8>>()
    };
    let walls = level(&[layer("Walls", 10, json!({"intGridCsv": [0, 1, 0, 0, 0, 0, 0, 1]}))]);
    let mut named = walls.clone();
    named["layerInstances"] = Value::Null;
    named["externalRelPath"] = "cellar.ldtkl".into();
    for project_of in [walls.clone(), named] {
        for file in [marked(project(std::slice::from_ref(&project_of))), wide(project(&[project_of]))] {
            let found = LdtkImport::default().parse(&file, |_| Ok(marked(walls.clone()))).unwrap();
            assert_eq!(drawn(&found[0].walls), [".#..", "...#"]);
        }
    }
}

#[test]
fn tiles_block_by_their_tags() {
    let tile = |x: i32, y: i32, t: i64| json!({"px": [x, y], "src": [0, 0], "f": 0, "t": t, "d": [1]});
    let tiles =
        json!([tile(0, 0, 3), tile(8, 0, 4), tile(16, 8, 5), tile(24, 8, 3), tile(-8, 0, 3), tile(8, 16, 3)]);
    let found = one(&[layer("Ground", 11, json!({"__tilesetDefUid": 20, "gridTiles": tiles}))]);
    assert_eq!(drawn(&found.walls), ["#...", "..##"], "tiles outside are cut");
    let found = one(&[layer("Ground", 11, json!({"__tilesetDefUid": 20, "autoLayerTiles": tiles}))]);
    assert_eq!(drawn(&found.walls), ["#...", "..##"]);
    let other = json!({"__tilesetDefUid": 20, "overrideTilesetUid": 21, "gridTiles": tiles});
    assert_eq!(one(&[layer("Ground", 11, other)]).tile, None);
    let other = json!({"__tilesetDefUid": 21, "overrideTilesetUid": 20, "gridTiles": tiles});
    assert_eq!(drawn(&one(&[layer("Ground", 11, other)]).walls), ["#...", "..##"]);
    // All tiles of a layer of this name.
    let found = one(&[layer("walls", 11, json!({"gridTiles": tiles}))]);
    assert_eq!(drawn(&found.walls), ["##..", "..##"]);
}

#[test]
fn layers_of_other_tiles_hide_no_more_than_they_cover() {
    let fine = layer("Walls", 10, json!({"intGridCsv": [0, 0, 0, 1, 0, 0, 0, 0]}));
    let large = |shift: i32, tile: u32| {
        let size = json!({"__cWid": 2, "__cHei": 1, "__gridSize": tile, "intGridCsv": [1, 0], "__pxTotalOffsetX": shift});
        layer("Walls", 10, size)
    };
    // Twice as wide.
    let found = one(&[large(0, 16), fine.clone()]);
    assert_eq!((drawn(&found.walls), found.tile), (vec!["##.#".into(), "##..".into()], Some(8)));
    assert!(found.warnings.is_empty());
    let found = one(&[fine.clone(), large(8, 16)]);
    assert_eq!(drawn(&found.walls), [".###", ".##."]);
    // Shifted by half a tile: of the two it covers one wholly.
    let found = one(&[fine.clone(), large(4, 16)]);
    assert_eq!(drawn(&found.walls), [".#.#", ".#.."]);
    let uneven = LdtkWarning::Uneven { layer: "Walls".into(), tile: 16, shift: [4, 0], finest: 8 };
    assert_eq!(found.warnings, [uneven]);
    let found = one(&[fine.clone(), large(-4, 12)]);
    assert_eq!(drawn(&found.walls), ["#..#", "...."]);
    assert_eq!(found.warnings.len(), 1);
    let found = one(&[fine.clone(), large(0, 8 * 64)]);
    assert_eq!(drawn(&found.walls), ["####", "####"]);
    let found = one(&[fine, large(0, 8 * 65)]);
    assert_eq!(drawn(&found.walls), ["...#", "...."]);
    assert_eq!(found.warnings, [LdtkWarning::Coarse { layer: "Walls".into(), tile: 520, finest: 8 }]);
}

#[test]
fn names_of_values_tags_layers_and_entities_count_in_any_case() {
    let named = |name: &str, layer_of: Value| {
        let text = project(&[level(&[layer_of])]).to_string().replace("\"Opaque\"", &format!("{name:?}"));
        LdtkImport::default().parse(text.as_bytes(), |file| panic!("{file}")).unwrap().remove(0)
    };
    let values = || layer("Ground", 10, json!({"intGridCsv": [0, 1, 2, 3, 1, 0, 0, 2]}));
    let tile = json!([{"px": [8, 0], "t": 3}]);
    let tiles = || layer("Ground", 11, json!({"__tilesetDefUid": 20, "gridTiles": tile}));
    for name in ["WALL", "Walls", "wall_2", "Blocks_Sight"] {
        assert_eq!(drawn(&named(name, values()).walls), [".#..", "#..."], "{name}");
        assert_eq!(drawn(&named(name, tiles()).walls), [".#..", "...."], "{name}");
        assert_eq!(entities(name, &[entity("Box", json!({}))]).entities[0].role, Role::Wall, "{name}");
    }
    for (field, value) in [("Wall", json!("yes")), ("OPAQUE", json!(1)), ("blocksSight", json!(true))] {
        let fields = json!({"fieldInstances": [{"__identifier": field, "__value": value}]});
        assert_eq!(entities("Things", &[entity("Box", fields)]).entities[0].role, Role::Wall, "{field}");
    }
    // What blocks the way hides only where nothing is a wall.
    let found = named("Solid", values());
    assert_eq!(drawn(&found.walls), [".#..", "#..."]);
    assert_eq!(found.warnings, [LdtkWarning::Obstacles { names: vec!["Solid".into()] }]);
    let both = [layer("Collisions", 10, json!({"intGridCsv": [0, 1, 2, 0, 0, 0, 0, 2]}))];
    assert_eq!(drawn(&one(&both).walls), [".#..", "...."]);
}

#[test]
fn a_level_in_which_nothing_blocks_says_so_with_what_there_is() {
    let things =
        layer("Things", 12, json!({"entityInstances": [entity("Tree", json!({"__tags": ["plant"]}))]}));
    let found = one(&[layer("Ground", 10, json!({"intGridCsv": [0, 2, 2, 0, 0, 0, 0, 2]})), things]);
    let expected = LdtkWarning::NothingBlocks {
        layers: ["Ground", "Things"].map(String::from).into(),
        names: ["Opaque", "Tree", "Wet", "plant", "water"].map(String::from).into(),
    };
    assert_eq!(found.warnings, [expected]);
    let said = found.warnings[0].to_string();
    assert!(said.contains("nothing blocks sight") && said.contains("\"water\""), "{said}");
}

fn entity(name: &str, members: Value) -> Value {
    let mut entity = json!({
        "__identifier": name, "iid": "e", "__pivot": [0.5, 1], "__tags": [], "px": [16, 12], "width": 8,
        "height": 4, "defUid": 30, "fieldInstances": [],
    });
    entity.as_object_mut().unwrap().extend(members.as_object().unwrap().clone());
    entity
}

fn entities(layer_name: &str, entities: &[Value]) -> LdtkLevel {
    one(&[layer(layer_name, 12, json!({"entityInstances": entities, "__pxTotalOffsetY": 2}))])
}

#[test]
fn entities_have_places_fields_and_roles() {
    let fields = json!([
        {"__identifier": "Count", "__type": "Int", "__value": 3},
        {"__identifier": "Speed", "__type": "Float", "__value": 1.5},
        {"__identifier": "Way", "__type": "Array<Point>", "__value": [{"cx": 1, "cy": 2}]},
        {"__identifier": "None", "__type": "String", "__value": null}]);
    let found = entities("Things", &[entity("Guard", json!({"fieldInstances": fields}))]);
    let [guard] = &found.entities[..] else { panic!("{found:?}") };
    assert_eq!(guard.rect, Rect::new(Vec2::new(12.0, 10.0), Vec2::new(20.0, 14.0)));
    assert_eq!((&*guard.name, &*guard.iid, &*guard.layer, guard.role), ("Guard", "e", "Things", Role::Plain));
    assert_eq!(guard.fields["Count"], LdtkValue::Int(3));
    assert_eq!(guard.fields["Speed"], LdtkValue::Float(1.5));
    assert_eq!(guard.fields["None"], LdtkValue::Null);
    let LdtkValue::List(way) = &guard.fields["Way"] else { panic!("{guard:?}") };
    let LdtkValue::Object(point) = &way[0] else { panic!("{way:?}") };
    assert_eq!(point["cy"], LdtkValue::Int(2));

    let role =
        |layer: &str, name: &str, members: Value| entities(layer, &[entity(name, members)]).entities[0].role;
    let says =
        |field: &str, value: bool| json!({"fieldInstances": [{"__identifier": field, "__value": value}]});
    assert_eq!(role("Things", "Door", json!({})), Role::Door);
    assert_eq!(role("Things", "Hatch", json!({"__tags": ["a", "DOOR"]})), Role::Door);
    assert_eq!(role("Things", "Hatch", says("Door", true)), Role::Door);
    assert_eq!(role("Things", "Door", says("Door", false)), Role::Plain);
    assert_eq!(role("Things", "Opaque", json!({})), Role::Wall);
    assert_eq!(role("Walls", "Hatch", json!({})), Role::Wall);
    assert_eq!(role("Walls", "Hatch", says("opaque", false)), Role::Plain);
    assert_eq!(role("Walls", "Hatch", json!({"width": 0, "height": 0})), Role::Plain);
}

#[test]
fn doors_hide_until_they_are_opened() {
    let door = entity("Door", json!({"px": [16, 6], "__pivot": [0.5, 0], "width": 2, "height": 6}));
    let oval =
        entity("Door", json!({"px": [16, 6], "__pivot": [0.5, 0], "width": 4, "height": 6, "defUid": 31}));
    let point = entity("Door", json!({"px": [16, 6], "width": 0, "height": 0}));
    let found = entities("Things", &[door, oval, point]);
    for (entity, doors) in found.entities.iter().zip([true, true, false]) {
        let grid = GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::new(8, 8) };
        let mut scene = Scene::new(&grid).unwrap();
        // Half a unit a pixel, the level at (-4, -1): the door is at x = 4 and y from 3 to 6.
        let placed = entity.insert(&mut scene, Vec2::new(-4.0, -1.0), 0.5, 7).unwrap();
        let view = View::all_round(Vec2::new(2.5, 4.5)).unwrap();
        let behind = Vec2::new(6.5, 4.5);
        let mut query = Query::new();
        query.run(&scene, &view);
        assert_eq!(query.sees_point(behind), !doors, "{entity:?}");
        let id = placed.ids().next().unwrap();
        assert_eq!(scene.user_data(id), Ok(7));
        if let (true, Shape::Polygon(_)) = (entity.is_ellipse, scene.bounds(id).unwrap()) {
            // A corner of the rectangle around the ellipse hides nothing.
            let corner = View::all_round(Vec2::new(3.4, 3.0)).unwrap();
            query.run(&scene, &corner);
            assert!(query.sees_point(Vec2::new(4.6, 3.0)));
        }
        placed.set_closed(&mut scene, false).unwrap();
        query.run(&scene, &view);
        assert!(query.sees_point(behind));
    }
}

#[test]
fn levels_are_found_in_files_and_worlds() {
    let inside = level(&[layer("Walls", 10, json!({"intGridCsv": [1, 0, 0, 0, 0, 0, 0, 0]}))]);
    let mut outside = level(&[]);
    outside["layerInstances"] = Value::Null;
    outside["externalRelPath"] = "world/Cellar.ldtkl".into();
    let import = LdtkImport::default();
    let mut asked = Vec::new();
    let text = project(&[outside.clone()]).to_string();
    let found = import.parse(text.as_bytes(), |file| {
        asked.push(file.to_owned());
        Ok(inside.to_string().into_bytes())
    });
    assert_eq!(found.unwrap()[0].tile, Some(8));
    assert_eq!(asked, ["world/Cellar.ldtkl"]);
    let missing = import.parse(text.as_bytes(), |_| Err(io::Error::other("gone")));
    assert!(matches!(missing, Err(LdtkError::File { file, .. }) if file == "world/Cellar.ldtkl"));
    let twice = project(&[outside.clone(), outside]).to_string();
    let twice = import.parse(twice.as_bytes(), |_| Ok(inside.to_string().into_bytes()));
    assert!(matches!(twice, Err(LdtkError::Twice(file)) if file == "world/Cellar.ldtkl"));
    let mut worlds = project(&[]);
    worlds["worlds"] = json!([{"levels": [inside.clone()]}, {"levels": [inside.clone(), inside]}]);
    assert_eq!(import.parse(worlds.to_string().as_bytes(), |_| Ok(vec![])).unwrap().len(), 3);
}

#[test]
fn what_contradicts_itself_is_refused() {
    let few = layer("Walls", 10, json!({"intGridCsv": [1, 0, 0]}));
    let few = read(&[level(&[few])]);
    assert!(matches!(few, Err(LdtkError::Values { found: 3, width: 4, height: 2, .. })), "{few:?}");
    let flat = read(&[level(&[layer("Walls", 10, json!({"__gridSize": 0}))])]);
    assert!(matches!(flat, Err(LdtkError::NoSize { .. })), "{flat:?}");
    let huge = read(&[level(&[layer("Walls", 10, json!({"__gridSize": u32::MAX}))])]);
    assert!(matches!(huge, Err(LdtkError::NoSize { .. })), "{huge:?}");
    // A tile of a pixel in a level that would take 2^58 bytes, and in one that is too high.
    for (width, height) in [(i32::MAX, i32::MAX), (1, 1 << 22)] {
        let mut wide =
            level(&[layer("Walls", 10, json!({"__gridSize": 1, "gridTiles": [{"px": [0, 0], "t": 0}]}))]);
        wide["pxWid"] = width.into();
        wide["pxHei"] = height.into();
        let wide = read(&[wide]);
        assert!(matches!(wide, Err(LdtkError::Spread { .. })), "{wide:?}");
    }
    let far = entities(
        "Things",
        &[entity("Guard", json!({"px": [1e12, 0]})), entity("Guard", json!({"width": -1}))],
    );
    assert_eq!((far.entities.len(), far.warnings.len()), (0, 3), "and nothing blocks");
    for text in ["", "{}", "[1, 2", "{\"defs\": {}, \"levels\": [{}]}"] {
        let found = LdtkImport::default().parse(text.as_bytes(), |_| Ok(vec![]));
        assert!(matches!(found, Err(LdtkError::Damaged { .. })), "{text}: {found:?}");
    }
    let deep = format!("{{\"defs\": {{}}, \"x\": {}", "[".repeat(1 << 20));
    assert!(matches!(
        LdtkImport::default().parse(deep.as_bytes(), |_| Ok(vec![])),
        Err(LdtkError::Damaged { .. })
    ));
}
