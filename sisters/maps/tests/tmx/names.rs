//! What blocks by its name, and what is said where nothing does.

use super::*;

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
        tile("", &property("opaque", "type=\"float\"", "nan")),
    ] {
        assert_eq!(walls(&map_of(&none, &layer("name=\"a\"", "", "1,2,0,2"))), [0u32; 0], "{none}");
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
        let said = read(&text).warnings.concat();
        assert_eq!(
            said.contains("layer \"a\" has 2 tiles that are walls or doors by shapes"),
            warns,
            "{one}"
        );
        let all = map_of(&one, &layer("name=\"walls\"", "", "1,2,0,2"));
        assert_eq!(walls(&all), if one.contains("door") { vec![0] } else { vec![0, 1, 3] }, "{one}");
    }
}

#[test]
fn objects_take_roles_by_class_property_and_layer_in_any_case() {
    let role = |layer: &str, attributes: &str, inner: &str| {
        let object =
            format!("<object x=\"0\" y=\"16\" width=\"16\" height=\"16\" {attributes}>{inner}</object>");
        let layer = format!("<objectgroup name=\"{layer}\">{object}</objectgroup>");
        read(&map_of("", &layer)).objects[0].role
    };
    assert_eq!(role("o", "type=\"WALL\"", ""), Role::Wall);
    assert_eq!(role("o", "class=\"Door\"", ""), Role::Door);
    assert_eq!(role("o", "", &property("Opaque", "", "1")), Role::Wall);
    assert_eq!(role("o", "type=\"wall\"", &property("door", "", "1")), Role::Door, "what is both");
    assert_eq!(role("Doors", "", ""), Role::Door);
    assert_eq!(role("Walls", "", ""), Role::Wall);
    assert_eq!(role("Walls", "", &property("wall", "type=\"bool\"", "false")), Role::Plain);
    assert_eq!(role("o", "type=\"guard\"", ""), Role::Plain);
}

#[test]
fn names_are_compared_without_capitals_blanks_and_numbers() {
    let role = |import: &TmxImport, name: &str| {
        let object = format!("<objectgroup><object type=\"{name}\" width=\"9\" height=\"9\"/></objectgroup>");
        import.parse(map_of("", &object).as_bytes(), |path| panic!("{path}")).unwrap().objects[0].role
    };
    let import = TmxImport::default();
    for name in ["walls", "Walls", "WALL", "Walls 2", "wall_3", "Opaque", "BlocksSight", "blocks_sight"] {
        assert_eq!(role(&import, name), Role::Wall, "{name}");
    }
    for name in ["Door", "DOORS", "door-1"] {
        assert_eq!(role(&import, name), Role::Door, "{name}");
    }
    for name in ["", "2", "wallpaper", "firewall", "Ground", "Collision", "no wall"] {
        assert_eq!(role(&import, name), Role::Plain, "{name}");
    }
    let own = TmxImport { walls: vec!["Tile Layer 1".into(), "-".into()], doors: Vec::new() };
    assert_eq!(
        ["tile layer 1", "Tile Layer 2", ""].map(|name| role(&own, name)),
        [Role::Wall, Role::Plain, Role::Plain]
    );
}

#[test]
fn a_map_in_which_nothing_blocks_says_so() {
    let said = read(&map_of("", &layer("name=\"Ground\"", "", "1,1,1,1"))).warnings.concat();
    for part in ["nothing blocks sight", "\"walls\"", "\"opaque\"", "TmxImport::walls"] {
        assert!(said.contains(part), "{said}");
    }
    // However long a name is, the warning is short.
    let long = layer(&format!("name=\"{}\"", "n".repeat(900)), "", "9,9,9,9");
    assert!(read(&map_of("", &long)).warnings[0].len() < 200);
}
