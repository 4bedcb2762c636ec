//! The crate `tiled` reads the same.

use super::*;

/// A map with a tileset beside it, by the crate `tiled`.
fn by_tiled(map: &[u8]) -> tiled::Map {
    let map = map.to_vec();
    let open = move |path: &Path| -> io::Result<_> {
        let is_map = path.extension().is_some_and(|e| e == "tmx");
        Ok(io::Cursor::new(if is_map { map.clone() } else { maps::TILESET.into() }))
    };
    tiled::Loader::with_reader(open).load_tmx_map("map.tmx").unwrap()
}

/// Its layers, also those in groups.
fn layers(map: &tiled::Map) -> Vec<tiled::Layer<'_>> {
    let mut all: Vec<_> = map.layers().collect();
    let mut next = 0;
    while let Some(layer) = all.get(next) {
        if let tiled::LayerType::Group(group) = layer.layer_type() {
            all.extend(group.layers());
        }
        next += 1;
    }
    all
}

#[test]
fn the_crate_tiled_reads_the_same() {
    let mut files = maps::all();
    // It was built without Zstandard, a library of C.
    files.retain(|file| !String::from_utf8_lossy(file).contains("zstd"));
    files.push(std::fs::read(example("harbour.tmx")).unwrap());
    let text = String::from_utf8(files[0].clone()).unwrap();
    files.push(text.replace("farther", "walls").into_bytes());
    // Tiles before the first tileset are none; of tilesets that begin at one tile the last has it.
    files.push(text.replace("farther", "walls").replace("firstgid=\"1\"", "firstgid=\"3\"").into_bytes());
    files.push(text.replace("firstgid=\"5\"", "firstgid=\"1\"").into_bytes());
    files.push(text.replace("firstgid=\"1\"", "firstgid=\"7\"").into_bytes());
    for (i, file) in files.into_iter().enumerate() {
        let ours = TmxImport::default().parse(&file, |_| Ok(maps::TILESET.into())).unwrap().walls;
        let map = by_tiled(&file);
        let mut opaque = BitGrid::new(map.width, map.height);
        for layer in layers(&map) {
            let tiled::LayerType::Tiles(tiled::TileLayer::Finite(tiles)) = layer.layer_type() else {
                continue;
            };
            for (x, y) in (0..map.height).flat_map(|y| (0..map.width).map(move |x| (x, y))) {
                let Some(tile) = tiles.get_tile(x as i32, y as i32) else { continue };
                let says_so = tile.get_tile().and_then(|t| t.properties.get("opaque").cloned());
                let blocks = says_so == Some(tiled::PropertyValue::BoolValue(true));
                opaque.set(x, y, opaque.get(x, y) || blocks || layer.name == "walls");
            }
        }
        assert_eq!(ours, opaque, "{i}");
    }
}

#[test]
fn the_crate_tiled_reads_the_same_objects() {
    let text = maps::objects();
    let ours = map(&text).unwrap();
    assert!(matches!(&ours.warnings[..], [passed] if passed.contains("1 objects with pictures")));
    let (map, mut found) = (by_tiled(text.as_bytes()), 0);
    for layer in layers(&map) {
        let tiled::LayerType::Objects(objects) = layer.layer_type() else { continue };
        for theirs in objects.objects() {
            let Some(ours) = ours.objects.iter().find(|ours| ours.id == theirs.id()) else {
                let is_text = matches!(theirs.shape, tiled::ObjectShape::Text { .. });
                assert!(is_text || theirs.tile_data().is_some());
                continue;
            };
            found += 1;
            let names = (&*theirs.name, &*theirs.user_type, &*layer.name);
            assert_eq!((&*ours.name, &*ours.class, &*ours.layer), names);
            // The group of the layer of things is shifted by 8, and the layer by -4 pixels.
            let shift = if layer.name == "things" { Vec2::new(8., -4.) } else { Vec2::ZERO };
            let at = (Vec2::new(theirs.x, theirs.y) + shift) / 16.;
            let Rect { min, max } = ours.bounds.bounds();
            assert!(at.clamp(min, max).distance(at) < 1e-5, "{} {at} {min} {max}", ours.id);
        }
    }
    assert_eq!((found, ours.objects.len()), (7, 7));
}
