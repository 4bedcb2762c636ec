//! Damaged and hostile maps of Tiled give errors, and cost memory and time in proportion to their
//! bytes.

use std::fmt::Write as _;
use std::io::Write as _;
use std::sync::{Mutex, PoisonError};

use casca_maps::{TmxImport, TmxMap};
use casca_plane::{BitGrid, GridSpec, Scene};
use glam::{UVec2, Vec2};
use peak_alloc::PeakAlloc;

#[path = "../../../tests/damage/mod.rs"]
mod damage;
#[path = "files/mod.rs"]
mod maps;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// The tests run one after the other: the allocator counts for all.
static ALONE: Mutex<()> = Mutex::new(());

#[test]
fn damaged_maps_are_read_or_refused() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut files = maps::all();
    let chunk = format!("<chunk x=\"-16\" y=\"3\" width=\"4\" height=\"3\">{}</chunk>", maps::csv());
    let infinite = maps::map("encoding=\"csv\"", &chunk).replace("infinite=\"0\"", "infinite=\"1\"");
    files.push(infinite.replace("orthogonal", "hexagonal\" hexsidelength=\"4").into());
    files.push(infinite.replace("<group", "<group offsetx=\"16\" offsety=\"-32\"").into());
    files.push(maps::TILESET.into());
    let mut objects = 0;
    damage::survive(&HEAP, "maps", &files, 6000, &|_| (), &mut |bytes| {
        // A map, or the tileset of one.
        let read = |map: &[u8], tileset: &[u8]| TmxImport::default().parse(map, |_| Ok(tileset.to_vec()));
        drop(read(&files[0], bytes));
        let Ok(map) = read(bytes, maps::TILESET.as_bytes()) else { return };
        objects += insert(&map);
    });
    assert!(objects > 500, "{objects}: some maps keep theirs");
}

/// Puts objects into a scene, and gives how many went in.
fn insert(map: &TmxMap) -> usize {
    let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(8) }).unwrap();
    map.objects.iter().for_each(|object| _ = scene.insert(object.desc()).unwrap());
    scene.len()
}

/// Reads a map with objects in a layer, and puts them into a scene; gives how many objects and
/// warnings there are.
fn read_objects(layer: &str, objects: &str) -> (usize, usize) {
    let map = maps::map("encoding=\"csv\"", &maps::csv());
    let text = format!("<objectgroup name=\"{layer}\">{objects}</objectgroup></map>");
    let map = within_limits(&map.replace("</map>", &text), maps::TILESET).unwrap();
    (map.objects.len(), map.warnings.len())
}

/// Reads a map and its tileset, and puts its objects into a scene, within the limits.
fn within_limits(map: &str, tileset: &str) -> Result<TmxMap, String> {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut result = Err(String::new());
    damage::check(&HEAP, "map", map.as_bytes(), &mut |map| {
        let read = TmxImport::default().parse(map, |_| Ok(tileset.as_bytes().to_vec()));
        result = read.inspect(|map| _ = insert(map)).map_err(|why| why.to_string());
    });
    result
}

/// As [`within_limits`], the walls alone.
fn result(map: &str, tileset: &str) -> Result<BitGrid, String> {
    within_limits(map, tileset).map(|map| map.walls)
}

#[test]
fn objects_cost_what_their_bytes_do() {
    // As small as they get.
    assert_eq!(read_objects("o", &"<object/>".repeat(100_000)), (100_001, 0));
    // Names of layers are not repeated, in objects and in warnings.
    let long = "n".repeat(1_000_000);
    assert_eq!(read_objects(&long, &"<object/>".repeat(10_000)), (10_001, 0));
    assert_eq!(read_objects(&long, &"<object x=\"nan\"/>".repeat(10_000)), (1, 10_000));
    assert_eq!(read_objects(&long, &"<object gid=\"1\"/>".repeat(10_000)), (1, 1));
    // Polygons of many corners, and many polygons.
    let polygon = |corners: usize| {
        let mut points = String::new();
        (0..corners).for_each(|i| write!(points, "{i},{} ", i * i % 7 + 9).unwrap());
        format!("<object><polygon points=\"{points}{corners},0 0,0\"/></object>")
    };
    assert_eq!(read_objects("o", &polygon(150_000)), (2, 0));
    assert_eq!(read_objects("o", &polygon(254).repeat(600)), (601, 0));
    // Properties in each other.
    let (open, close) = ("<properties><property name=\"p\" type=\"class\">", "</property></properties>");
    let deep = format!("<object><point/>{}{}</object>", open.repeat(20_000), close.repeat(20_000));
    assert_eq!(read_objects("o", &deep), (2, 0));
}

#[test]
fn json_costs_what_its_bytes_do() {
    let list = maps::json("\"opacity\":1", &format!("[{}]", maps::csv()));
    let read = |more: &str| {
        within_limits(
            &list.replace("\"infinite\"", &format!("\"objects\":{more},\"infinite\"")),
            maps::TILESET,
        )
    };
    for item in ["{}", "{\"\":0}", "{\"layers\":[{}]}", "\"\\n\"", "0"] {
        assert!(read(&format!("[{item}{}]", format!(",{item}").repeat(100_000))).is_ok(), "{item}");
    }
    // Each level of 100 is read again.
    let (open, close) = ("{\"b\":".repeat(98), "}".repeat(98));
    assert!(read(&format!("{open}[{}0]{close}", "0,".repeat(400_000))).is_ok());
    for open in ["[", "{\"b\":"] {
        assert!(read(&open.repeat(200_000)).unwrap_err().contains("no JSON"));
    }
}

#[test]
fn promises_of_tilesets_cost_nothing() {
    let map = maps::map("encoding=\"csv\"", &maps::csv());
    let whole = result(&map, maps::TILESET).unwrap();
    // Tiles that a tileset does not list have no properties, whatever their number.
    let many = |text: &str| text.replace("tilecount=\"4\"", "tilecount=\"4294967295\"");
    assert_eq!(result(&many(&map), maps::TILESET), Ok(whole.clone()));
    assert_eq!(result(&map, &many(maps::TILESET)), Ok(whole));
}

#[test]
fn layers_that_unfold_to_more_than_their_tiles_are_refused() {
    // 64 MiB of zeros, in 64 KiB.
    let map = same_tiles(0, 1 << 24);
    assert!(result(&map, maps::TILESET).unwrap_err().contains("more than the 12 tiles"));
    // As many tiles as it says.
    let map = map.replace("width=\"4\" height=\"3\"", "width=\"4096\" height=\"4096\"");
    assert_eq!(result(&map, maps::TILESET).unwrap().count(), 0);
    // And more.
    let map = map.replace("height=\"4096\"", "height=\"1048576\"");
    assert!(result(&map, maps::TILESET).unwrap_err().contains("too few tiles"));
    let map = map.replace("width=\"4096\" height=\"1048576\"", "width=\"1\" height=\"4294967295\"");
    assert!(result(&map, maps::TILESET).unwrap_err().contains("along a side"));
}

/// Blocks of one byte that is repeated, 128 KiB for four bytes.
#[test]
fn zstandard_that_unfolds_to_more_than_its_tiles_is_refused() {
    use base64::Engine;
    let map = |window: u8, blocks: usize| {
        let frame =
            [&[0x28, 0xb5, 0x2f, 0xfd, 0, window][..], &[2, 0, 16, 0].repeat(blocks), &[1, 0, 0]].concat();
        let data = base64::engine::general_purpose::STANDARD.encode(frame);
        maps::map("encoding=\"base64\" compression=\"zstd\"", &data)
    };
    assert!(result(&map(0x68, 4096), maps::TILESET).unwrap_err().contains("more than the 12 tiles"));
    assert!(result(&map(0x70, 4096), maps::TILESET).unwrap_err().contains("window"));
    let whole = map(0x38, 1024).replace("width=\"4\" height=\"3\"", "width=\"8192\" height=\"4096\"");
    assert_eq!(result(&whole, maps::TILESET).unwrap().count(), 0);
}

/// Names are compared with each other, and entities repeat a text.
#[test]
fn attributes_namespaces_and_entities_are_few() {
    let map = maps::map("encoding=\"csv\"", &maps::csv());
    let many = |word: &str| (0..100_000).map(|i| format!(" {word}{i}=\"\"")).collect::<String>();
    let said = |from: &str, to: &str| result(&map.replace(from, to), maps::TILESET).unwrap_err();
    assert!(said("<map", &format!("<map{}", many("a"))).contains("attributes"));
    let spaces: String = (0..10_000).map(|i| format!("<g xmlns:n{i}=\"{i}\">")).collect();
    assert!(said("<group", &(spaces + "<group")).contains("namespaces"));
    let entity = "<!DOCTYPE map [<!ENTITY e \"x\">]><map";
    assert!(said("<map", entity).contains("entities"));
    // As old versions of the editor have it.
    let old = map.replace("<map", "<!DOCTYPE map SYSTEM \"http://mapeditor.org/dtd/1.0/map.dtd\">\n<map");
    assert_eq!(result(&old, maps::TILESET), result(&map, maps::TILESET));
}

/// A map whose layers have so many tiles of one id, and promise 4 by 3.
fn same_tiles(id: u32, count: usize) -> String {
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    let tiles = id.to_le_bytes().repeat(1 << 18);
    (0..count >> 18).for_each(|_| zlib.write_all(&tiles).unwrap());
    use base64::Engine;
    let data = base64::engine::general_purpose::STANDARD.encode(zlib.finish().unwrap());
    maps::map("encoding=\"base64\" compression=\"zlib\"", &data)
}

#[test]
fn numbers_of_parts_are_not_multiplied() {
    let map = same_tiles(2, 1 << 22).replace("width=\"4\" height=\"3\"", "width=\"2048\" height=\"2048\"");
    let all = result(&map, maps::TILESET).unwrap();
    assert_eq!(all.count(), 1 << 22);
    // Layers, of which none stays in memory.
    let (from, to) = (map.find("<layer").unwrap(), map.find("</layer>").unwrap() + 8);
    let layers = map.replace(&map[from..to], &map[from..to].repeat(8));
    assert_eq!(result(&layers, maps::TILESET).as_ref(), Ok(&all));
    // Tiles, each of one of many tilesets.
    let mut tilesets = String::new();
    (9..20_000).for_each(|first| write!(tilesets, "<tileset firstgid=\"{first}\"/>").unwrap());
    let many = map.replace("<objectgroup", &(tilesets + "<objectgroup"));
    assert_eq!(result(&many, maps::TILESET), Ok(all));
}

#[test]
fn depth_does_not_matter() {
    let plain = maps::map("encoding=\"csv\"", &maps::csv());
    let whole = result(&plain, maps::TILESET).unwrap();
    let nested = |element: &str, start: &str, end: &str| {
        let (first, last) = (format!("<{element} "), format!("</{element}>"));
        let opened = plain.replace(&first, &format!("{}{first}", start.repeat(100_000)));
        opened.replace(&last, &format!("{last}{}", end.repeat(100_000)))
    };
    assert_eq!(result(&nested("group", "<group>", "</group>"), maps::TILESET), Ok(whole.clone()));
    let (start, end) = ("<properties><property name=\"p\" type=\"class\">", "</property></properties>");
    assert_eq!(result(&nested("objectgroup", start, end), maps::TILESET), Ok(whole.clone()));
}
