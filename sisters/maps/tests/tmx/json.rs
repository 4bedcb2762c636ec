//! The same maps in JSON.

use super::*;

fn list() -> String {
    maps::json("\"opacity\":1", &format!("[{}]", maps::csv()))
}

#[test]
fn maps_of_json_are_those_of_xml() {
    let xml = map(&maps::objects()).unwrap();
    assert_eq!((xml.objects.len(), xml.walls.count(), xml.warnings.len()), (7, 5, 1));
    let mut files = vec![list(), maps::json("\"encoding\":\"csv\"", &format!("[{}]", maps::csv()))];
    files.extend(["", "zlib", "gzip", "zstd"].map(|compression| {
        let stored = format!("\"compression\":\"{compression}\",\"encoding\":\"base64\"");
        maps::json(&stored, &format!("\"{}\"", maps::base64(compression)))
    }));
    for text in files {
        assert_eq!(map(&text).unwrap(), xml, "{text}");
        // A tileset of JSON beside it.
        let by = TmxImport::default().parse(text.as_bytes(), |_| Ok(include_bytes!("../files/t.tsj").into()));
        assert_eq!(by.unwrap(), xml);
    }
}

#[test]
fn chunks_of_json_lie_where_they_say() {
    let chunks = "\"chunks\":[{\"x\":-2,\"y\":3,\"width\":2,\"height\":1,\"data\":[2,1]},\
                  {\"x\":0,\"y\":3,\"width\":1,\"height\":2,\"data\":[0,2]}],\"a\":[]";
    let text = list().replace("\"infinite\":false", "\"infinite\":true");
    let found = map(&text.replace(&format!("\"data\":[{}]", maps::csv()), chunks)).unwrap();
    assert_eq!((found.origin.to_array(), found.walls.width(), found.walls.height()), ([-2, 3], 3, 2));
    assert_eq!(found.walls.cells().collect::<Vec<_>>(), [(0, 0), (2, 1)]);
}

#[test]
fn errors_in_json_name_the_line_and_the_cause() {
    let text = list();
    let expect = |from: &str, to: &str, said: &str| {
        assert!(text.contains(from), "{from}");
        let why = why(&text.replace(from, to));
        assert!(why.contains(said), "{why} / {said}");
    };
    expect("\"firstgid\":5,", "", "the map, line 5: the element tileset has no attribute firstgid");
    expect("\"firstgid\":5,", "\"firstgid\":5.5,", "line 5: firstgid=\"5.5\"");
    expect("\"firstgid\":5,", "\"firstgid\":null,", "line 5: the element tileset has no attribute firstgid");
    expect("\"height\":3, ", "\"height\":\"3\",\"height\":4, ", "4 by 3 tiles, but the map has 4 by 4");
    expect("]\n}", "\n}", "no JSON");
    expect("\"opacity\":1", "\"encoding\":\"base85\"", "tiles in \"base85\" and \"\" are not read");
    expect("[0,\n", "[[0],", "tile 0: [0]");
    expect("[0,\n", "[{\"id\":0},", "there are elements where a text should be");
    expect("3,\n", "", "too few tiles for its dimensions: 11 of 12");
    expect("\"type\":\"map\"", "\"kind\":\"map\"", "it is no file of Tiled: it has no element map");
    expect("\"infinite\"", "\"properties\":{}, \"propertytypes\":{}, \"infinite\"", "before version 1.2");
    let deep = format!("{}1{}", "[{\"a\":".repeat(300), "}]".repeat(300));
    expect("\"infinite\"", &format!("\"b\":{deep},\"infinite\""), "deeper than 100");
    expect("te\\\"xt", "\\ud800", "line 42: it is no JSON that is read: unexpected end of hex escape");
}
