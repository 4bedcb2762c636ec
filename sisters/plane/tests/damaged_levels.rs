//! Damaged and hostile projects of LDtk give errors, and cost memory and time in proportion to
//! their bytes.
#![cfg(feature = "ldtk")]

use std::sync::{Mutex, PoisonError};

use casca_plane::ldtk::{LdtkImport, LdtkLevel};
use casca_plane::{GridSpec, Scene};
use glam::{UVec2, Vec2};
use peak_alloc::PeakAlloc;

#[path = "../../../tests/damage/mod.rs"]
mod damage;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// The tests run one after the other: the allocator counts for all.
static ALONE: Mutex<()> = Mutex::new(());

const LAYER: &str = r#"{"__identifier": "Walls", "__cWid": 4, "__cHei": 2, "__gridSize": 8, "layerDefUid": 10,
"__pxTotalOffsetX": 8, "__tilesetDefUid": 20, "intGridCsv": [0, 1, 2, 0, 1, 0, 0, 2],
"autoLayerTiles": [{"px": [8, 8], "t": 3}], "gridTiles": [{"px": [0, 8], "t": 4}], "entityInstances": [
{"__identifier": "Door", "iid": "d", "__pivot": [0.5, 1], "__tags": ["a"], "px": [16, 12], "width": 8,
"height": 4, "defUid": 31, "fieldInstances": [{"__identifier": "opaque", "__value": [1, 2.5, null, {"cx": 3}]}]}]}"#;

fn level(layers: &str, size: u32) -> String {
    format!(
        "{{\"identifier\": \"A\", \"iid\": \"i\", \"worldX\": 8, \"pxWid\": {size}, \"pxHei\": {size}, \
         \"layerInstances\": [{layers}]}}"
    )
}

fn project(levels: &str) -> String {
    format!(
        "{{\"defs\": {{\"layers\": [{{\"uid\": 10, \"intGridValues\": [{{\"value\": 1, \"identifier\": \"opaque\"}}]}}], \
         \"tilesets\": [{{\"uid\": 20, \"enumTags\": [{{\"enumValueId\": \"opaque\", \"tileIds\": [3]}}]}}], \
         \"entities\": [{{\"uid\": 31, \"renderMode\": \"Ellipse\"}}]}}, \"levels\": [{levels}]}}"
    )
}

/// Puts entities into a scene, and gives how many went in.
fn insert(levels: &[LdtkLevel]) -> usize {
    let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(8) }).unwrap();
    for entity in levels.iter().flat_map(|level| &level.entities) {
        let Ok(placed) = entity.insert(&mut scene, Vec2::ZERO, 0.25, 0) else { continue };
        assert_eq!(placed.set_closed(&mut scene, false), Ok(()));
    }
    scene.len()
}

#[test]
fn damaged_projects_are_read_or_refused() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let inside = level(LAYER, 32);
    let outside =
        r#"{"identifier": "B", "pxWid": 1, "pxHei": 1, "layerInstances": null, "externalRelPath": "b"}"#;
    let files = [project(&inside), project(outside), inside.clone()].map(String::into_bytes);
    let mut entities = 0;
    damage::survive(&HEAP, "projects", &files, 6000, &|_| (), &mut |bytes| {
        // A project, or a level in a file of its own.
        let within = LdtkImport::default().parse(&files[1], |_| Ok(bytes.to_vec()));
        let alone = LdtkImport::default().parse(bytes, |_| Ok(inside.clone().into()));
        entities += [within, alone].iter().flatten().map(|levels| insert(levels)).sum::<usize>();
    });
    assert!(entities > 400, "{entities}: some projects keep theirs");
}

#[test]
fn promises_cost_nothing() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let read = |text: &str| {
        let mut found = None;
        damage::check(&HEAP, "project", text.as_bytes(), &mut |bytes| {
            found = Some(LdtkImport::default().parse(bytes, |_| Ok(vec![])).map_err(|why| why.to_string()));
        });
        found.unwrap()
    };
    let tile = |width: u32, side: u32| {
        format!(
            "{{\"__identifier\": \"walls\", \"__cWid\": {width}, \"__cHei\": {width}, \"__gridSize\": {side}, \
             \"layerDefUid\": 1, \"gridTiles\": [{{\"px\": [0, 0], \"t\": 0}}]}}"
        )
    };
    // Many levels, each of 2 MiB; one is fine.
    let many = vec![level(&tile(4096, 1), 4096); 4000].join(",");
    let refused = read(&project(&many)).unwrap_err();
    assert!(refused.contains("4096 by 4096"), "{refused}");
    assert!(read(&project(&level(&tile(4096, 1), 4096))).is_ok());
    // Many layers in one level, each of whose tiles covers 64 by 64 of the finest.
    let layers: Vec<String> = (0..8000).map(|i| tile(64, if i == 0 { 1 } else { 64 })).collect();
    let levels = read(&project(&level(&layers.join(","), 4096))).unwrap();
    assert_eq!(levels[0].walls.count(), 64 * 64);
    // Layers that promise many tiles and have none.
    assert!(read(&project(&level(&tile(u32::MAX, 8), 32))).is_ok());
}
