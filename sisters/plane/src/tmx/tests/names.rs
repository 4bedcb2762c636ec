//! What blocks by its name, and what is said where nothing does.

use super::*;
use crate::editor::MapNames;

/// A map of 4 by 1 tiles of 16 pixels; `tiles` says something of the tiles 1 to 4 of its tileset.
fn map_of(tiles: &str, layers: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<map orientation=\"orthogonal\" width=\"4\" height=\"1\" \
         tilewidth=\"16\" tileheight=\"16\"><tileset firstgid=\"1\" tilewidth=\"16\" tileheight=\"16\" tilecount=\"4\">\
         {tiles}</tileset>{layers}</map>"
    )
}

fn layer(attributes: &str, inner: &str, tiles: &str) -> String {
    format!(
        "<layer {attributes} width=\"4\" height=\"1\">{inner}<data encoding=\"csv\">{tiles}</data></layer>"
    )
}

fn property(name: &str, kind: &str, value: &str) -> String {
    format!("<properties><property name=\"{name}\" {kind} value=\"{value}\"/></properties>")
}

fn read(text: &str) -> TmxMap {
    TmxImport::default().parse(text.as_bytes(), |path| panic!("{path}")).unwrap()
}

/// The tiles that block.
fn walls(text: &str) -> Vec<u32> {
    read(text).walls.cells().map(|(x, _)| x).collect()
}

#[test]
fn layers_and_groups_block_by_name_class_and_property_in_any_case() {
    for layer_of in [
        layer("name=\"Walls\"", "", "1,0,2,0"),
        layer("name=\"WALL\"", "", "1,0,2,0"),
        layer("name=\"walls 2\"", "", "1,0,2,0"),
        layer("name=\"a\" class=\"Wall\"", "", "1,0,2,0"),
        layer("name=\"a\"", &property("Opaque", "type=\"bool\"", "True"), "1,0,2,0"),
        layer("name=\"a\"", &property("blocksSight", "", "yes"), "1,0,2,0"),
        format!("<group name=\"Walls\">{}</group>", layer("name=\"a\"", "", "1,0,2,0")),
        format!("<group name=\"b\"><group class=\"wall\">{}</group></group>", layer("", "", "1,0,2,0")),
    ] {
        assert_eq!(walls(&map_of("", &layer_of)), [0, 2], "{layer_of}");
    }
    let no = layer("name=\"walls\"", &property("opaque", "type=\"bool\"", "false"), "1,0,2,0");
    assert_eq!(walls(&map_of("", &no)), [0u32; 0], "the property takes it back");
    let empty = "<objectgroup name=\"o\"/><group/>".to_owned() + &layer("name=\"Walls\"", "", "1,0,2,0");
    assert_eq!(walls(&map_of("", &empty)), [0, 2], "what is empty has no properties");
}

#[test]
fn tiles_block_by_class_and_by_properties_of_all_types() {
    let tile = |attributes: &str, inner: &str| format!("<tile id=\"1\" {attributes}>{inner}</tile>");
    for one in [
        tile("class=\"Wall\"", ""),
        tile("type=\"OPAQUE\"", ""),
        tile("", &property("Wall", "type=\"bool\"", "true")),
        tile("", &property("opaque", "", "True")),
        tile("", &property("opaque", "type=\"int\"", "1")),
        tile("class=\"stone\"", &property("Opaque", "type=\"string\"", "YES")),
    ] {
        assert_eq!(walls(&map_of(&one, &layer("name=\"a\"", "", "1,2,0,2"))), [1, 3], "{one}");
    }
    for none in [
        tile("class=\"Wallpaper\"", ""),
        tile("class=\"wall\"", &property("opaque", "type=\"bool\"", "false")),
        tile("", &property("opaque", "type=\"int\"", "0")),
        tile("", &property("opaque", "", "maybe")),
    ] {
        let text = map_of(&none, &layer("name=\"a\"", "", "1,2,0,2"));
        assert_eq!(walls(&text), [0u32; 0], "{none}");
        let wrong = read(&text).warnings.iter().any(|w| matches!(w, TmxWarning::PropertyType { .. }));
        assert_eq!(wrong, none.contains("maybe"));
    }
}

/// Shapes that are smaller than their tile do not make all of it hide.
#[test]
fn tiles_with_shapes_hide_by_their_properties_only_and_not_with_doors() {
    let tile = |attributes: &str, inner: &str, shape: &str| {
        let group = format!("<objectgroup><object {shape} width=\"2\" height=\"9\"/></objectgroup>");
        format!("<tile id=\"1\" {attributes}>{inner}{group}</tile>")
    };
    let opaque = property("opaque", "type=\"bool\"", "true");
    for (one, hides, warns) in [
        (tile("class=\"Wall\"", "", ""), false, true),
        (tile("", "", "type=\"wall\""), false, true),
        (tile("", &opaque, ""), true, true),
        (tile("", &opaque, "class=\"door\""), false, true),
        (tile("", "", "type=\"grass\""), false, false),
    ] {
        let text = map_of(&one, &layer("name=\"a\"", "", "1,2,0,2"));
        assert_eq!(walls(&text), if hides { vec![1, 3] } else { vec![] }, "{one}");
        let warning = TmxWarning::DrawnShapes { layer: "a".into(), count: 2 };
        assert_eq!(read(&text).warnings.contains(&warning), warns, "{one}");
        let all = map_of(&one, &layer("name=\"walls\"", "", "1,2,0,2"));
        assert_eq!(walls(&all), if one.contains("door") { vec![0] } else { vec![0, 1, 3] }, "{one}");
    }
}

#[test]
fn objects_take_roles_by_class_property_tile_and_layer_in_any_case() {
    let role = |layer: &str, attributes: &str, inner: &str| {
        let object =
            format!("<object x=\"0\" y=\"16\" width=\"16\" height=\"16\" {attributes}>{inner}</object>");
        let layer = format!("<objectgroup name=\"{layer}\">{object}</objectgroup>");
        read(&map_of("<tile id=\"0\" type=\"Door\"/>", &layer)).objects[0].role
    };
    assert_eq!(role("o", "type=\"WALL\"", ""), Role::Wall);
    assert_eq!(role("o", "class=\"Door\"", ""), Role::Door);
    assert_eq!(role("o", "", &property("Opaque", "", "1")), Role::Wall);
    assert_eq!(role("o", "gid=\"1\"", ""), Role::Door);
    assert_eq!(role("o", "gid=\"1\" type=\"Wall\"", ""), Role::Wall, "its own class");
    assert_eq!(role("Doors", "", ""), Role::Door);
    assert_eq!(role("Walls", "", ""), Role::Wall);
    assert_eq!(role("Walls", "", &property("wall", "type=\"bool\"", "false")), Role::Plain);
    assert_eq!(role("o", "type=\"guard\"", ""), Role::Plain);
}

#[test]
fn what_blocks_the_way_hides_only_where_nothing_is_a_wall_and_not_without_a_word() {
    let water = layer("name=\"Collision\"", "", "0,0,1,1");
    let found = read(&map_of("", &water));
    assert_eq!(walls(&map_of("", &water)), [2, 3]);
    assert_eq!(found.warnings, [TmxWarning::Obstacles { names: vec!["Collision".into()] }]);
    let said = found.warnings[0].to_string();
    assert!(said.contains("\"Collision\"") && said.contains("MapNames::obstacles"), "{said}");
    // With a wall, the water does not hide.
    let both = layer("name=\"Walls\"", "", "1,0,0,0") + &water;
    assert_eq!((walls(&map_of("", &both)), read(&map_of("", &both)).warnings), (vec![0], vec![]));
    let never = MapNames { obstacles: Vec::new(), ..MapNames::default() };
    let found = TmxImport { names: never }.parse(map_of("", &water).as_bytes(), |path| panic!("{path}"));
    let found = found.unwrap();
    assert!(found.walls.count() == 0 && matches!(found.warnings[..], [TmxWarning::NothingBlocks { .. }]));
    let own = MapNames { walls: vec!["Tile Layer 1".into()], ..MapNames::default() };
    let text = map_of(
        "",
        &(layer("name=\"Tile Layer 1\"", "", "1,0,0,0") + &layer("name=\"Tile Layer 2\"", "", "0,1,0,0")),
    );
    let found = TmxImport { names: own }.parse(text.as_bytes(), |path| panic!("{path}")).unwrap();
    assert_eq!(found.walls.cells().collect::<Vec<_>>(), [(0, 0)]);
}

#[test]
fn a_map_in_which_nothing_blocks_says_so_with_what_there_is() {
    let tiles = format!("<tile id=\"0\" class=\"Grass\">{}</tile>", property("speed", "type=\"int\"", "3"));
    let object = format!(
        "<objectgroup name=\"Spawns\"><object type=\"Hero\">{}</object></objectgroup>",
        property("hp", "", "9")
    );
    let found = read(&map_of(&tiles, &(layer("name=\"Ground\"", "", "1,1,1,1") + &object)));
    let expected = TmxWarning::NothingBlocks {
        layers: ["Ground", "Spawns"].map(String::from).into(),
        names: ["Grass", "Hero", "hp", "speed"].map(String::from).into(),
    };
    assert_eq!(found.warnings.last(), Some(&expected));
    let said = expected.to_string();
    for part in ["nothing blocks sight", "\"Ground\", \"Spawns\"", "\"Hero\"", "\"walls\"", "\"opaque\""] {
        assert!(said.contains(part), "{said}");
    }
    // However long a map is, the warning is short.
    let many: String =
        (0..500).map(|i| layer(&format!("name=\"{}{i}\"", "n".repeat(90)), "", "1,1,1,1")).collect();
    assert!(read(&map_of("", &many)).warnings[0].to_string().len() < 1000);
}

#[test]
fn lists_with_blank_lines_missing_numbers_and_all_line_ends_are_read() {
    let wall = |tiles: &str| map_of("", &layer("name=\"Walls\"", "", tiles));
    for (tiles, missing) in [
        ("1,0,\n2,0", 0),
        ("1,0\n2,0", 0),
        ("\r\n1,0,\r\n\r\n2,0\r\n", 0),
        ("\r1,0,\r2,0\r", 0),
        ("1,0,2,0,", 1),
        ("1,0,2,0,\n\n", 1),
        ("1,,2,", 2),
    ] {
        let count = if tiles == "1,,2," { "1,,2,0," } else { tiles };
        let found = read(&wall(count));
        assert_eq!(found.walls.cells().map(|(x, _)| x).collect::<Vec<_>>(), [0, 2], "{tiles:?}");
        let expected = TmxWarning::Commas { layer: "Walls".into(), count: missing };
        assert_eq!(found.warnings, Vec::from_iter((missing > 0).then_some(expected)), "{tiles:?}");
    }
    for tiles in ["1,0,2,0,0,", "1,0,2,", ",,,,,"] {
        assert!(TmxImport::default().parse(wall(tiles).as_bytes(), |_| unreachable!()).is_err(), "{tiles}");
    }
    // Base64 in lines, without its padding.
    let whole = maps::base64("");
    let base64 =
        whole.trim_end_matches('=').as_bytes().chunks(10).map(|c| str::from_utf8(c).unwrap().to_owned());
    let lines = base64.collect::<Vec<_>>().join("\r\n  ");
    let text = |data: &str| maps::map("encoding=\"base64\"", data);
    assert_eq!(parse(&text(&lines)).unwrap(), parse(&text(&maps::base64(""))).unwrap());
    // Lines are counted whatever ends them.
    for end in ["\n", "\r\n", "\r"] {
        let text = format!(
            "<map orientation=\"orthogonal\"{end} width=\"1\" height=\"1\" tilewidth=\"9\" tileheight=\"9\">{end}{end}<tileset/></map>"
        );
        let why = TmxImport::default().parse(text.as_bytes(), |_| unreachable!()).unwrap_err().to_string();
        assert!(why.starts_with("the map, line 4: "), "{end:?}: {why}");
    }
}

#[test]
fn maps_in_all_encodings_are_read() {
    let text = map_of("", &layer("name=\"W\u{e4}nde\"", "", "1,0,2,0"));
    let names = MapNames { walls: vec!["W\u{c4}NDE".into()], ..MapNames::default() };
    let read =
        |bytes: &[u8]| TmxImport { names: names.clone() }.parse(bytes, |path| panic!("{path}")).unwrap();
    let latin = |text: &str| text.chars().map(|c| c as u8).collect::<Vec<u8>>();
    let wide = |unit: fn(u16) -> [u8; 2]| {
        let text = text.replace("UTF-8", "UTF-16");
        format!("\u{feff}{text}").encode_utf16().flat_map(unit).collect::<Vec<u8>>()
    };
    let odd = TmxWarning::Encoding { file: "the map".into() };
    for (bytes, warning) in [
        (format!("\u{feff}{text}").into_bytes(), None),
        (wide(u16::to_le_bytes), None),
        (wide(u16::to_be_bytes), None),
        (latin(&text.replace("UTF-8", "ISO-8859-1")), None),
        (latin(&text), Some(odd)),
    ] {
        let found = read(&bytes);
        assert_eq!(found.walls.count(), 2, "{:?}", &bytes[..40]);
        assert_eq!(found.warnings, Vec::from_iter(warning));
    }
}

#[test]
fn errors_of_files_name_the_file() {
    let path = std::env::temp_dir().join(format!("casca-tmx-{}.tmx", std::process::id()));
    for (text, said) in [
        ("<map orientation=\"hexagonal\"/>", "hexagonal"),
        ("<map orientation=\"orthogonal\" width=\"x\" height=\"1\"/>", "the map, line 1: width=\"x\""),
    ] {
        std::fs::write(&path, text).unwrap();
        let why = TmxImport::default().read(&path).unwrap_err().to_string();
        assert!(why.starts_with(&format!("{}: ", path.display())) && why.contains(said), "{why}");
    }
    std::fs::remove_file(&path).unwrap();
}
