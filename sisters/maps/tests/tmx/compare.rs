//! The crate `tiled` reads the same.

use super::*;

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
        assert_eq!(ours.cells().collect::<Vec<_>>(), by_tiled(file), "{i}");
    }
}

#[test]
fn the_crate_tiled_reads_the_same_objects() {
    let text = maps::objects();
    let ours = map(&text).unwrap();
    assert!(matches!(&ours.warnings[..], [passed] if passed.contains("1 objects with pictures")));
    let mut loader =
        tiled::Loader::with_cache_and_reader(tiled::DefaultResourceCache::new(), Files(text.into_bytes()));
    let map = loader.load_tmx_map("map.tmx").unwrap();
    let (mut open, mut found) = (map.layers().collect::<Vec<_>>(), 0);
    while let Some(layer) = open.pop() {
        match layer.layer_type() {
            tiled::LayerType::Group(group) => open.extend(group.layers()),
            tiled::LayerType::Objects(objects) => {
                for theirs in objects.objects() {
                    let Some(ours) = ours.objects.iter().find(|ours| ours.id == theirs.id()) else {
                        let is_text = matches!(theirs.shape, tiled::ObjectShape::Text { .. });
                        assert!(is_text || theirs.tile_data().is_some());
                        continue;
                    };
                    found += 1;
                    assert_eq!(
                        (&ours.name, &*ours.class, &*ours.layer),
                        (&theirs.name, &*theirs.user_type, &*layer.name)
                    );
                    // The group of the layer of things is shifted by 8, and the layer by -4 pixels.
                    let shift = if &*ours.layer == "things" { Vec2::new(8., -4.) } else { Vec2::ZERO };
                    let at = (Vec2::new(theirs.x, theirs.y) + shift) / 16.;
                    let block = ours.bounds.bounds();
                    let first = match &theirs.shape {
                        tiled::ObjectShape::Polygon { points } | tiled::ObjectShape::Polyline { points } => {
                            let shift =
                                points.iter().fold(Vec2::INFINITY, |min, p| min.min(Vec2::new(p.0, p.1)));
                            block.min - shift / 16.
                        }
                        // The polygon around it has its centre.
                        tiled::ObjectShape::Ellipse { width, height } => {
                            block.min.midpoint(block.max) - Vec2::new(*width, *height) / 32.
                        }
                        // It is turned about its place: its hull has it as a corner.
                        _ => match &ours.bounds {
                            Shape::Polygon(box_) => {
                                let near = |p: &&Vec2| (**p - at).length() < 1e-4;
                                box_.corners().iter().find(near).copied().unwrap_or(Vec2::NAN)
                            }
                            _ => block.min,
                        },
                    };
                    assert!((first - at).length() < 1e-6, "{} {first} {at}", ours.id);
                }
            }
            _ => {}
        }
    }
    assert_eq!((found, ours.objects.len()), (7, 7));
}
