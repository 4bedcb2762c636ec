//! The crate `tiled` reads the same.

use std::collections::BTreeMap;

use super::*;

/// The files of the tests for the crate `tiled`.
struct Files(Vec<u8>);

impl tiled::ResourceReader for Files {
    type Resource = io::Cursor<Vec<u8>>;
    type Error = io::Error;

    fn read_from(&mut self, path: &Path) -> io::Result<Self::Resource> {
        let is_map = path.extension().is_some_and(|e| e == "tmx");
        let path = path.to_str().unwrap();
        Ok(io::Cursor::new(if is_map { self.0.clone() } else { maps::file(path) }))
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

/// A value of the crate `tiled` as one of this.
fn value(of: &tiled::PropertyValue) -> TmxValue {
    use tiled::PropertyValue as Of;
    match of {
        Of::BoolValue(v) => TmxValue::Bool(*v),
        Of::IntValue(v) => TmxValue::Int((*v).into()),
        Of::FloatValue(v) => TmxValue::Float((*v).into()),
        Of::StringValue(v) => TmxValue::String(v.clone()),
        Of::ColorValue(c) => TmxValue::Color(Some([c.red, c.green, c.blue, c.alpha])),
        Of::ObjectValue(v) => TmxValue::Object(*v),
        Of::FileValue(v) => TmxValue::File(v.clone()),
        Of::ClassValue { property_type, properties } => {
            let members = properties.iter().map(|(name, v)| (name.clone(), value(v))).collect();
            TmxValue::Class { class: property_type.clone(), members }
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_crate_tiled_reads_the_same_objects() {
    assert_eq!(compare_objects(maps::objects()), 8);
    assert_eq!(compare_objects(maps::made()), 6);
}

/// Compares the objects of a map, and gives how many there are.
fn compare_objects(text: String) -> usize {
    let ours = map(&text).unwrap();
    assert_eq!(ours.warnings, []);
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
                        assert!(matches!(theirs.shape, tiled::ObjectShape::Text { .. }));
                        continue;
                    };
                    found += 1;
                    // The group of the layer of things is switched off.
                    let visible = &*ours.layer != "things" && theirs.visible;
                    assert_eq!(
                        (&ours.name, &*ours.class, &*ours.layer, ours.visible),
                        (&theirs.name, &*theirs.user_type, &*layer.name, visible)
                    );
                    let properties: BTreeMap<_, _> =
                        theirs.properties.iter().map(|(name, v)| (name.clone(), value(v))).collect();
                    assert_eq!(ours.properties, properties);
                    // The group of the layer of things is shifted by 8, and the layer by -4 pixels.
                    let shift = if &*ours.layer == "things" { Vec2::new(8., -4.) } else { Vec2::ZERO };
                    let at = (Vec2::new(theirs.x, theirs.y) + shift) / 16.;
                    let first = match &ours.shape {
                        TmxShape::Polygon(points) | TmxShape::Polyline(points) => points[0],
                        TmxShape::Point(p) => *p,
                        // A picture stands on its place.
                        TmxShape::Rect(rect) if theirs.tile_data().is_some() => {
                            Vec2::new(rect.min.x, rect.max.y)
                        }
                        other => other.bounds().min,
                    };
                    assert!((first - at).length() < 1e-6, "{} {first} {at}", ours.id);
                }
            }
            _ => {}
        }
    }
    assert_eq!(found, ours.objects.len());
    found
}

#[test]
fn the_crate_tiled_reads_the_same_shapes_of_tiles() {
    let text = maps::drawn();
    let ours = map(&text).unwrap();
    assert_eq!(ours.warnings, []);
    let mut loader =
        tiled::Loader::with_cache_and_reader(tiled::DefaultResourceCache::new(), Files(text.into_bytes()));
    let map = loader.load_tmx_map("map.tmx").unwrap();
    let mut found = 0;
    let group = map.layers().filter_map(|layer| layer.as_group_layer().and_then(|group| group.get_layer(0)));
    for tiles in map.layers().chain(group).filter_map(|layer| layer.as_tile_layer()) {
        let tiled::TileLayer::Finite(tiles) = tiles else { panic!() };
        for (x, y) in (0..3).flat_map(|y| (0..4).map(move |x| (x, y))) {
            let Some(tile) = tiles.get_tile(x, y).filter(|tile| tile.id() == 0) else { continue };
            let Some(shapes) = tile.get_tile().and_then(|tile| tile.collision.clone()) else { continue };
            let place = glam::DVec2::new(x.into(), y.into());
            let here: Vec<_> = ours.tiles.iter().filter(|tile| tile.place == place).collect();
            for role in [Role::Wall, Role::Door] {
                let theirs =
                    shapes.object_data().iter().filter(|o| (o.user_type == "door") == (role == Role::Door));
                let ours = here.iter().find(|tile| tile.role == role).unwrap();
                assert_eq!(theirs.clone().count(), ours.shapes.len());
                for (theirs, ours) in theirs.zip(&*ours.shapes) {
                    found += 1;
                    let mut at = Vec2::new(theirs.x, theirs.y);
                    if tile.flip_d {
                        at = Vec2::new(at.y, at.x);
                    }
                    at.x = if tile.flip_h { 16.0 - at.x } else { at.x };
                    at.y = if tile.flip_v { 16.0 - at.y } else { at.y };
                    let at = (at + Vec2::new(2.0, -1.0)) / 16.0;
                    let first = match ours {
                        TmxShape::Polygon(points) | TmxShape::Polyline(points) => points[0],
                        round if tile.flip_h => round.bounds().max,
                        round => round.bounds().min,
                    };
                    assert!((first - at).length() < 1e-6, "{ours:?} {at}");
                }
            }
        }
    }
    // Two tiles in each of two layers, with four shapes each.
    assert_eq!(found, 16);
}
