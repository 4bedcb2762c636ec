//! The map of the harbour, maps that are refused, and the crate `tiled`, which reads the same.

use super::*;

#[path = "../../tests/maps/mod.rs"]
mod maps;

fn example(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("maps").join(name)
}

/// The file, changed.
fn read_changed(change: impl Fn(String) -> String) -> Result<BitGrid, TmxError> {
    let text = std::fs::read_to_string(example("harbour.tmx")).unwrap();
    TmxImport::default().parse(change(text).as_bytes(), |source| panic!("{source}"))
}

/// A map, with a tileset beside it.
fn parse(map: &str) -> Result<BitGrid, TmxError> {
    TmxImport::default().parse(map.as_bytes(), |source| match source {
        "t.tsx" => Ok(maps::TILESET.into()),
        _ => Err(io::ErrorKind::NotFound.into()),
    })
}

fn why(map: &str) -> String {
    parse(map).unwrap_err().to_string()
}

#[test]
fn properties_and_layers_block() {
    let drawing = include_str!("../../maps/harbour.txt");
    let walls = TmxImport::default().read(example("harbour.tmx")).unwrap();
    for (y, line) in (0..).zip(drawing.lines()) {
        for (x, letter) in (0..).zip(line.bytes()) {
            assert_eq!(walls.get(x, y), letter == b'#', "tile ({x}, {y})");
        }
    }
    let no_layer = TmxImport { layer: "none".into(), ..TmxImport::default() };
    let no_property = TmxImport { property: "none".into(), ..TmxImport::default() };
    let count = |import: TmxImport| import.read(example("harbour.tmx")).unwrap().count();
    let (by_property, by_layer) = (count(no_layer), count(no_property));
    assert_eq!(by_property + by_layer, walls.count());
    assert!(by_property > 0 && by_layer > 0);
}

#[test]
fn damaged_files_are_refused() {
    assert!(matches!(TmxImport::default().read(example("none.tmx")), Err(TmxError::File { .. })));
    assert!(matches!(TmxImport::default().read(example("")), Err(TmxError::File { .. })));
    assert!(read_changed(|text| text).is_ok());
    let infinite = |text: String| text.replace("infinite=\"0\"", "infinite=\"1\"");
    assert!(matches!(read_changed(infinite), Err(TmxError::Infinite)));
    let hexagons = |text: String| text.replace("orthogonal", "hexagonal");
    assert!(matches!(read_changed(hexagons), Err(TmxError::Orientation(_))));
    for height in ["37", "35", "2000000000", "-1", "many"] {
        let other = |text: String| text.replace("height=\"36\"", &format!("height=\"{height}\""));
        assert!(matches!(read_changed(other), Err(TmxError::Damaged { .. })), "{height}");
    }
    let narrow = |text: String| text.replacen("width=\"72\"", "width=\"71\"", 1);
    assert!(matches!(read_changed(narrow), Err(TmxError::Dimensions { .. })));
    for part in 1..8 {
        let cut = |text: String| text[..text.len() * part / 8].to_string();
        assert!(matches!(read_changed(cut), Err(TmxError::Damaged { .. })), "{part}");
    }
}

#[test]
fn tiles_are_read_from_each_encoding_and_tileset() {
    for map in maps::all() {
        let opaque = parse(str::from_utf8(&map).unwrap()).unwrap();
        let tiles: Vec<_> = opaque.cells().map(|(x, y)| maps::TILES[(x + 4 * y) as usize]).collect();
        assert_eq!(tiles, [2, 6, 2, 6, 0x8000_0006]);
        // In a layer of walls all tiles block, but not where there is none.
        let walls = String::from_utf8(map).unwrap().replace("farther", "walls");
        assert_eq!(parse(&walls).unwrap().count(), 11);
    }
}

#[test]
fn errors_name_the_file_the_line_and_the_cause() {
    let map = maps::map("encoding=\"csv\"", &maps::csv());
    let expect = |from: &str, to: &str, said: &str| {
        assert!(map.contains(from), "{from}");
        let why = why(&map.replace(from, to));
        assert!(why.contains(said), "{why} / {said}");
    };
    expect("t.tsx", "u.tsx", "u.tsx cannot be read");
    expect("</map>", "", "the map, line");
    expect("firstgid=\"1\"", "first=\"1\"", "line 3: the element tileset has no attribute firstgid");
    expect("value=\"true\"", "value=\"yes\"", "yes is neither true nor false");
    expect("encoding=\"csv\"", "", "tiles in \"\" and \"\" are not read");
    expect("encoding=\"csv\"", "encoding=\"base64\" compression=\"zstd\"", "choose CSV");
    expect("<data encoding=\"csv\">", "<data encoding=\"csv\"><tile gid=\"1\"/>", "there are elements");
    expect("3,\n", "3;\n", "tile 3, 3;");
    expect("3,\n", "", "too few tiles for its dimensions: about 11 of 12");
    expect("3,\n", "3,3,\n", "more than the 12 tiles");
    expect("<map", "<plan", "no element map");
    let none = map.replace("<layer", "<image").replace("</layer", "</image");
    assert!(matches!(parse(&none), Err(TmxError::NoTiles)));
    let empty = map.replace("<data", "<date").replace("</data", "</date");
    assert!(why(&empty).contains("the layer \"ground\" has no tiles"));
    let damaged = maps::map("encoding=\"base64\" compression=\"zlib\"", &maps::base64("gzip"));
    assert!(why(&damaged).contains("the layer \"ground\": "), "{}", why(&damaged));
    let inner = TmxImport::default().parse(map.as_bytes(), |_| Ok(b"<tileset>\n<tile/></tileset>".into()));
    let why = inner.unwrap_err().to_string();
    assert!(why.contains("t.tsx, line 2: the element tile has no attribute id"), "{why}");
}

#[test]
fn a_tile_is_of_the_last_tileset_that_begins_at_or_before_it() {
    // Tiles of a tileset that block: the one with the number of the tileset.
    let opaque: Vec<_> = (0..4)
        .map(|i| {
            let text = format!(
                "<tileset><tile id=\"{i}\"><properties>\
                 <property name=\"opaque\" type=\"bool\" value=\"true\"/></properties></tile></tileset>"
            );
            let mut xml = Xml::new(text.as_bytes(), "test").unwrap();
            xml.root("tileset").unwrap();
            Rc::new(Opaque::read(&mut xml, "opaque").unwrap())
        })
        .collect();
    for order in 0..256_u32 {
        let firsts = [0, 2, 4, 6].map(|shift| 1 + 2 * (order >> shift & 3));
        let mut tilesets = Tilesets::default();
        firsts.into_iter().zip(&opaque).for_each(|(first, tiles)| tilesets.push(first, tiles.clone()));
        for id in 0..12 {
            let last = (0_u32..).zip(firsts).filter(|&(_, first)| first <= id && id > 0).last();
            assert_eq!(tilesets.blocks(id, true), last.is_some(), "{firsts:?} {id}");
            let says_so = last.is_some_and(|(number, first)| id - first == number);
            assert_eq!(tilesets.blocks(id | 0x6000_0000, false), says_so, "{firsts:?} {id}");
        }
    }
}

/// The files of the tests for the crate `tiled`.
struct Files(Vec<u8>);

impl tiled::ResourceReader for Files {
    type Resource = io::Cursor<Vec<u8>>;
    type Error = io::Error;

    fn read_from(&mut self, path: &Path) -> io::Result<Self::Resource> {
        let is_map = path.extension().is_some_and(|e| e == "tmx");
        Ok(io::Cursor::new(if is_map { self.0.clone() } else { maps::TILESET.into() }))
    }
}

/// The tiles that block, by the crate `tiled`.
fn by_tiled(map: Vec<u8>) -> Vec<(u32, u32)> {
    let mut loader = tiled::Loader::with_cache_and_reader(tiled::DefaultResourceCache::new(), Files(map));
    let map = loader.load_tmx_map("map.tmx").unwrap();
    let mut opaque = BitGrid::new(map.width, map.height);
    let mut open: Vec<_> = map.layers().collect();
    while let Some(layer) = open.pop() {
        match layer.layer_type() {
            tiled::LayerType::Group(group) => open.extend(group.layers()),
            tiled::LayerType::Tiles(tiled::TileLayer::Finite(tiles)) => {
                for (x, y) in (0..map.height).flat_map(|y| (0..map.width).map(move |x| (x, y))) {
                    let Some(tile) = tiles.get_tile(x as i32, y as i32) else { continue };
                    let says_so = tile.get_tile().and_then(|t| t.properties.get("opaque").cloned());
                    let blocks = says_so == Some(tiled::PropertyValue::BoolValue(true));
                    opaque.set(x, y, opaque.get(x, y) || blocks || layer.name == "walls");
                }
            }
            _ => {}
        }
    }
    opaque.cells().collect()
}

#[test]
fn the_crate_tiled_reads_the_same() {
    let mut files = maps::all();
    files.push(std::fs::read(example("harbour.tmx")).unwrap());
    let text = String::from_utf8(files[0].clone()).unwrap();
    files.push(text.replace("farther", "walls").into_bytes());
    // Tiles before the first tileset are none; of tilesets that begin at one tile the last has it.
    files.push(text.replace("farther", "walls").replace("firstgid=\"1\"", "firstgid=\"3\"").into_bytes());
    files.push(text.replace("firstgid=\"5\"", "firstgid=\"1\"").into_bytes());
    files.push(text.replace("firstgid=\"1\"", "firstgid=\"7\"").into_bytes());
    for (i, file) in files.into_iter().enumerate() {
        let ours = TmxImport::default().parse(&file, |_| Ok(maps::TILESET.into())).unwrap();
        assert_eq!(ours.cells().collect::<Vec<_>>(), by_tiled(file), "{i}");
    }
}
