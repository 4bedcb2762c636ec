//! The map of the harbour, and maps that are refused or read with warnings.

use std::io;
use std::path::{Path, PathBuf};

use casca_maps::{MapError, Role, TmxImport, TmxMap};
use casca_plane::{BitGrid, Disc, Rect, Shape};
use glam::Vec2;

mod json;
#[path = "../files/mod.rs"]
mod maps;
mod names;
mod objects;
mod stagger;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("levels").join(name)
}

/// A map, with a tileset beside it.
fn map(text: &str) -> Result<TmxMap, MapError> {
    TmxImport::default().parse(text.as_bytes(), |source| match source {
        "t.tsx" => Ok(maps::TILESET.into()),
        _ => Err(io::ErrorKind::NotFound.into()),
    })
}

fn why(text: &str) -> String {
    map(text).unwrap_err().to_string()
}

#[test]
fn damaged_files_are_refused() {
    assert!(matches!(TmxImport::default().read(example("none.tmx")), Err(MapError::File { .. })));
    assert!(matches!(TmxImport::default().read(example("")), Err(MapError::File { .. })));
    let text = std::fs::read_to_string(example("harbour.tmx")).unwrap();
    assert!(map(&text).is_ok());
    assert!(why(&text.replace("orthogonal", "oblique")).contains("the orientation oblique is not known"));
    for height in ["37", "35", "2000000000", "-1", "many"] {
        let other = text.replace("height=\"36\"", &format!("height=\"{height}\""));
        assert!(matches!(map(&other), Err(MapError::Damaged { .. })), "{height}");
    }
    let narrow = text.replacen("width=\"72\"", "width=\"71\"", 1);
    assert!(why(&narrow).contains("72 by 36 tiles, but the map has 71 by 36"));
    for part in 1..8 {
        assert!(matches!(map(&text[..text.len() * part / 8]), Err(MapError::Damaged { .. })), "{part}");
    }
    // Those of a file name its path.
    let path = std::env::temp_dir().join(format!("casca-tmx-{}.tmx", std::process::id()));
    std::fs::write(&path, "<map orientation=\"orthogonal\" width=\"x\" height=\"1\"/>").unwrap();
    let why = TmxImport::default().read(&path).unwrap_err().to_string();
    assert!(why.starts_with(&format!("{}, line 1: width=\"x\"", path.display())), "{why}");
    // The editor saves maps in UTF-8, with a mark or without.
    std::fs::write(&path, format!("\u{feff}{text}")).unwrap();
    assert_eq!(TmxImport::default().read(&path).unwrap(), map(&text).unwrap());
    std::fs::write(&path, b"<map name=\"W\xe4nde\"/>").unwrap();
    let why = TmxImport::default().read(&path).unwrap_err().to_string();
    assert!(why.contains("no text in UTF-8"), "{why}");
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn tiles_are_read_from_each_encoding_and_tileset() {
    for file in maps::all() {
        let text = String::from_utf8(file).unwrap();
        let opaque = map(&text).unwrap().walls;
        let tiles: Vec<_> = opaque.cells().map(|(x, y)| maps::TILES[(x + 4 * y) as usize]).collect();
        assert_eq!(tiles, [2, 6, 2, 6, 0x8000_0006]);
        // In a layer of walls all tiles block, but not where there is none.
        assert_eq!(map(&text.replace("farther", "walls")).unwrap().walls.count(), 11);
    }
}

#[test]
fn errors_name_the_file_the_line_and_the_cause() {
    let text = maps::map("encoding=\"csv\"", &maps::csv());
    let expect = |from: &str, to: &str, said: &str| {
        assert!(text.contains(from), "{from}");
        let why = why(&text.replace(from, to));
        assert!(why.contains(said), "{why} / {said}");
    };
    expect("t.tsx", "u.tsx", "u.tsx cannot be read");
    expect("</map>", "", "the map, line");
    expect("firstgid=\"1\"", "first=\"1\"", "line 3: the element tileset has no attribute firstgid");
    expect("encoding=\"csv\"", "", "tiles in \"\" and \"\" are not read");
    expect("encoding=\"csv\"", "encoding=\"base64\" compression=\"xz\"", "choose CSV");
    expect("<data encoding=\"csv\">", "<data encoding=\"csv\"><tile gid=\"1\"/>", "there are elements");
    expect("3,\n", "3;\n", "tile 3: 3;");
    expect("3,\n", "", "too few tiles for its dimensions: 11 of 12");
    expect("3,\n", "3,3,\n", "more than the 12 tiles");
    assert!(why(&text.replace("<map", "<plan").replace("</map", "</plan")).contains("no element map"));
    let empty = text.replace("<data", "<date").replace("</data", "</date");
    assert!(why(&empty).contains("the layer \"ground\": it has no tiles"));
    let damaged = maps::map("encoding=\"base64\" compression=\"zlib\"", &maps::base64("gzip"));
    assert!(why(&damaged).contains("the layer \"ground\": "), "{}", why(&damaged));
    let inner = TmxImport::default().parse(text.as_bytes(), |_| Ok(b"<tileset>\n<tile/></tileset>".into()));
    let why = inner.unwrap_err().to_string();
    assert!(why.contains("t.tsx, line 2: the element tile has no attribute id"), "{why}");
    for end in ["\n", "\r\n"] {
        let text = format!(
            "<map orientation=\"orthogonal\"{end} width=\"1\" height=\"1\" tilewidth=\"9\" tileheight=\"9\">{end}{end}<tileset/></map>"
        );
        let why = self::why(&text);
        assert!(why.starts_with("the map, line 4: "), "{end:?}: {why}");
    }
}

#[test]
fn lists_with_blank_lines_and_all_line_ends_are_read() {
    let text = maps::map("encoding=\"csv\"", &maps::csv());
    let whole = map(&text).unwrap().walls;
    let read = |tiles: &str| map(&text.replace(&maps::csv(), tiles)).map(|map| map.walls);
    for (from, to) in [("\n", ""), (",", ""), ("\n", "\r\n\r\n"), ("\n", "\r")] {
        for end in ["", ",", ",\n\n"] {
            let tiles = maps::csv().replace(from, to) + end;
            assert_eq!(read(&tiles).unwrap(), whole, "{from:?} {to:?}");
        }
    }
    for tiles in [maps::csv() + ",0,", maps::csv().replace("8,", ""), ",".repeat(13)] {
        assert!(read(&tiles).is_err(), "{tiles}");
    }
    // Base64 in lines, without its padding.
    let base64 = maps::base64("");
    let lines = base64.trim_end_matches('=').as_bytes().chunks(10).map(|c| str::from_utf8(c).unwrap());
    let lines = lines.collect::<Vec<_>>().join("\r\n  ");
    assert_eq!(map(&maps::map("encoding=\"base64\"", &lines)).unwrap().walls, whole);
}

#[test]
fn a_tile_is_of_the_last_tileset_that_begins_at_or_before_it() {
    // Tiles of a tileset that block: the one with the number of the tileset.
    let opaque = "<properties><property name=\"opaque\" value=\"true\"/></properties>";
    let ids: Vec<String> = (0..12).map(|id| (0x6000_0000 | id).to_string()).collect();
    for order in 0..256_u32 {
        let firsts = [0, 2, 4, 6].map(|shift| 1 + 2 * (order >> shift & 3));
        let tileset =
            |(i, first)| format!("<tileset firstgid=\"{first}\"><tile id=\"{i}\">{opaque}</tile></tileset>");
        let tilesets: String = (0..4).zip(firsts).map(tileset).collect();
        let blocks = |layer: &str| {
            let text = format!(
                "<map orientation=\"orthogonal\" width=\"12\" height=\"1\" tilewidth=\"9\" tileheight=\"9\">{tilesets}\
                 <layer name=\"{layer}\" width=\"12\" height=\"1\"><data encoding=\"csv\">{}</data></layer></map>",
                ids.join(",")
            );
            map(&text).unwrap().walls.cells().map(|(id, _)| id).collect::<Vec<_>>()
        };
        let last = |id: u32| (0..4).zip(firsts).rfind(|&(_, first)| first <= id);
        let in_any: Vec<u32> = (1..12).filter(|&id| last(id).is_some()).collect();
        assert_eq!(blocks("walls"), in_any, "{firsts:?}");
        let says_so = |id: &u32| last(*id).is_some_and(|(number, first)| id - first == number);
        assert_eq!(blocks("a"), in_any.into_iter().filter(says_so).collect::<Vec<_>>(), "{firsts:?}");
    }
}

/// A map of chunks: its tile `(x, y)` is wall where `wall` says so.
fn infinite(chunks: &[[i32; 4]], wall: impl Fn(i32, i32) -> bool) -> String {
    let chunk = |&[x, y, width, height]: &[i32; 4]| {
        let tiles = (y..y + height).flat_map(|q| (x..x + width).map(move |p| (p, q)));
        let ids: Vec<_> = tiles.map(|(p, q)| if wall(p, q) { "2" } else { "1" }).collect();
        format!("<chunk x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\">{}</chunk>", ids.join(","))
    };
    let chunks: String = chunks.iter().map(chunk).collect();
    let map = maps::map("encoding=\"csv\"", &chunks);
    map.replace("infinite=\"0\"", "infinite=\"1\"")
        .replace("name=\"farther\"", "name=\"farther\" offsetx=\"0\"")
}

#[test]
fn chunks_of_infinite_maps_lie_where_they_say() {
    let wall = |x: i32, y: i32| (x * 7 + y * 3).rem_euclid(5) == 0;
    let chunks = [[-16, -32, 16, 16], [0, -16, 16, 16], [16, 0, 8, 4]];
    let found = map(&infinite(&chunks, wall)).unwrap();
    assert_eq!((found.origin.to_array(), found.walls.width(), found.walls.height()), ([-16, -32], 40, 36));
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    for (x, y) in (-16..24).flat_map(|x| (-32..4).map(move |y| (x, y))) {
        let inside = chunks.iter().any(|&[p, q, w, h]| (p..p + w).contains(&x) && (q..q + h).contains(&y));
        assert_eq!(found.walls.get((x + 16) as u32, (y + 32) as u32), inside && wall(x, y), "({x}, {y})");
    }
}

#[test]
fn spread_chunks_and_damaged_ones_are_refused() {
    let far = infinite(&[[-1_000_000, 0, 1, 1], [1_000_000, 1_000_000, 1, 1]], |_, _| true);
    assert!(why(&far).contains("spread over 2000001 by 1000001 tiles, but have 4 only"));
    let edge = |x, y| infinite(&[[x, y, 2, 2]], |_, _| true);
    assert!(why(&edge(i32::MAX - 3, i32::MIN)).contains("spread over"));
    assert!(map(&edge(1 << 23, 1 - (1 << 24))).is_ok() && map(&edge(0, (1 << 24) - 1)).is_err());
    let near = infinite(&[[-2000, 0, 1, 1], [2000, 2000, 1, 1]], |_, _| true);
    assert_eq!(map(&near).unwrap().walls.count(), 2, "as small as any map may be");
    let small = infinite(&[[0, 0, 4, 4]], |_, _| true);
    for (from, to, said) in [
        ("width=\"4\" height=\"4\">", "width=\"4\" height=\"5\">", "too few tiles"),
        ("width=\"4\" height=\"4\">", "width=\"4\" height=\"2000000\">", "at most 1048576 along a side"),
        ("width=\"4\" height=\"4\">", "width=\"1048576\" height=\"1048576\">", "too few tiles"),
        ("chunk x=\"0\"", "chunk x=\"left\"", "x=\"left\": "),
        ("offsetx=\"0\"", "offsetx=\"NaN\"", "is no finite number"),
        ("tilewidth=\"16\"", "tilewidth=\"0\"", "tiles of no size"),
    ] {
        assert!(small.contains(from), "{from}");
        let why = why(&small.replacen(from, to, 1));
        assert!(why.contains(said), "{why} / {said}");
    }
    let found = map(&infinite(&[], |_, _| true)).unwrap();
    assert_eq!((found.walls.count(), found.objects.len()), (0, 1), "a map of objects");
}

#[test]
fn shifted_layers_lie_elsewhere() {
    let text = maps::map("encoding=\"csv\"", &maps::csv());
    let shifted = |group: &str, layer: &str| {
        let group = format!("<group id=\"4\" {group}");
        let layer = format!("name=\"farther\" {layer}");
        text.replace("<group id=\"4\"", &group).replace("name=\"farther\"", &layer)
    };
    let whole = map(&text).unwrap().walls;
    // By three tiles to the right and one up, in the group and the layer together.
    let found = map(&shifted("offsetx=\"32\" offsety=\"-32\"", "offsetx=\"16\" offsety=\"16\"")).unwrap();
    assert_eq!((found.origin.to_array(), found.walls.width(), found.walls.height()), ([0, -1], 7, 4));
    let layer = found.tile_layer().unwrap();
    assert_eq!((layer.bounds().min, layer.bounds().max), (Vec2::new(0.0, -1.0), Vec2::new(7.0, 3.0)));
    assert_eq!(layer.opaque().bits(), &found.walls);
    for (x, y) in (0..7).flat_map(|x| (0..4).map(move |y| (x, y))) {
        let own = y > 0 && whole.get(x, y - 1);
        let other = x > 2 && whole.get(x - 3, y);
        assert_eq!(found.walls.get(x, y), own || other, "({x}, {y})");
    }
    // Half a tile: it blocks nothing, and is named.
    let found = map(&shifted("", "offsetx=\"8\"")).unwrap();
    assert_eq!(found.walls, whole);
    let shift = "the layer \"farther\" is shifted by 0.5 and 0 tiles: only whole tiles are read";
    assert_eq!(found.warnings, [shift]);
    // A tile to the right in the plane is one along each axis of an isometric map.
    let isometric = shifted("", "offsetx=\"16\"").replace("orthogonal", "isometric");
    let found = map(&isometric).unwrap();
    assert_eq!((found.origin.to_array(), found.walls.width(), found.walls.height()), ([0, -1], 5, 4));
}

#[test]
fn unknown_tiles_are_named() {
    let text = maps::map("encoding=\"csv\"", &maps::csv());
    assert!(map(&text).unwrap().warnings.is_empty());
    let walls = text.replace("farther", "walls");
    let unknown = |text: &str| map(&text.replace("8,\n", "9,\n").replace("7,\n", "2147483900,\n")).unwrap();
    let found = unknown(&walls);
    let named = |layer: &str| format!("the layer {layer:?} has 2 tiles of no tileset, the first of id 252");
    assert_eq!(found.warnings, [named("ground"), named("walls")]);
    // They block nothing, even in a layer of walls.
    assert_eq!(found.walls.count(), map(&walls).unwrap().walls.count() - 2);
    // Also in layers that are shifted by a part of a tile.
    let shifted = unknown(&walls.replace("name=\"ground\"", "name=\"ground\" offsetx=\"3\""));
    assert!(matches!(&shifted.warnings[..], [shift, first, second]
        if shift.contains("shifted") && *first == named("ground") && *second == named("walls")));
    // A tileset of single images lists tiles beyond its number: 2 and 4 are listed.
    let listed =
        text.replace("tilecount=\"4\"", "tilecount=\"1\"").replace("<tile id=\"2\">", "<tile id=\"3\">");
    let first = &map(&listed).unwrap().warnings[0];
    assert_eq!(first, "the layer \"ground\" has 1 tiles of no tileset, the first of id 3");
}
