//! The parts of a file that are read.

use std::collections::{HashMap, HashSet};

use serde::Deserialize;
use serde_json::Value;

use crate::editor::{Inventory, Role, Rule};

#[derive(Debug, Deserialize)]
pub(super) struct Project {
    defs: Definitions,
    #[serde(default)]
    pub levels: Vec<Level>,
    #[serde(default)]
    pub worlds: Vec<World>,
}

/// A world of a project with several ones.
#[derive(Debug, Deserialize)]
pub(super) struct World {
    #[serde(default)]
    pub levels: Vec<Level>,
}

#[derive(Debug, Deserialize)]
struct Definitions {
    #[serde(default)]
    layers: Vec<LayerDefinition>,
    #[serde(default)]
    tilesets: Vec<Tileset>,
    #[serde(default)]
    entities: Vec<EntityDefinition>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct LayerDefinition {
    uid: i64,
    #[serde(default)]
    int_grid_values: Vec<IntGridValue>,
}

#[derive(Debug, Deserialize)]
struct IntGridValue {
    value: i64,
    identifier: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Tileset {
    uid: i64,
    #[serde(default)]
    enum_tags: Vec<EnumTag>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct EnumTag {
    enum_value_id: String,
    #[serde(default)]
    tile_ids: Vec<i64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct EntityDefinition {
    uid: i64,
    #[serde(default)]
    render_mode: String,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Level {
    pub identifier: String,
    #[serde(default)]
    pub iid: String,
    #[serde(default)]
    pub world_x: i32,
    #[serde(default)]
    pub world_y: i32,
    #[serde(default)]
    pub world_depth: i32,
    pub px_wid: u32,
    pub px_hei: u32,
    #[serde(default)]
    pub external_rel_path: Option<String>,
    /// `null` where the level is in a file of its own.
    #[serde(default)]
    pub layer_instances: Option<Vec<Layer>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Layer {
    #[serde(rename = "__identifier")]
    pub name: String,
    #[serde(rename = "__cWid")]
    pub width: u32,
    #[serde(rename = "__cHei")]
    pub height: u32,
    #[serde(rename = "__gridSize")]
    pub tile: u32,
    /// With that of the definition.
    #[serde(rename = "__pxTotalOffsetX", default)]
    pub shift_x: i32,
    #[serde(rename = "__pxTotalOffsetY", default)]
    pub shift_y: i32,
    #[serde(rename = "__tilesetDefUid", default)]
    tileset_def_uid: Option<i64>,
    #[serde(default)]
    override_tileset_uid: Option<i64>,
    pub layer_def_uid: i64,
    #[serde(default)]
    pub int_grid_csv: Vec<i64>,
    #[serde(default)]
    pub auto_layer_tiles: Vec<Tile>,
    #[serde(default)]
    pub grid_tiles: Vec<Tile>,
    #[serde(default)]
    pub entity_instances: Vec<Entity>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Tile {
    /// Where it is in the layer, in pixels.
    pub px: [i32; 2],
    /// Its number in the tileset.
    pub t: i64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Entity {
    #[serde(rename = "__identifier")]
    pub name: String,
    #[serde(default)]
    pub iid: String,
    #[serde(rename = "__pivot", default)]
    pub pivot: [f64; 2],
    #[serde(rename = "__tags", default)]
    pub tags: Vec<String>,
    pub px: [f64; 2],
    pub width: f64,
    pub height: f64,
    pub def_uid: i64,
    #[serde(default)]
    pub field_instances: Vec<Field>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Field {
    #[serde(rename = "__identifier")]
    pub name: String,
    #[serde(rename = "__value", default)]
    pub value: Value,
}

impl Layer {
    /// Adds its name, and those of its entities, their tags and fields.
    pub fn add_to(&self, inventory: &mut Inventory) {
        inventory.add_layer(&self.name);
        for entity in &self.entity_instances {
            let fields = entity.field_instances.iter().map(|field| &field.name);
            entity.tags.iter().chain([&entity.name]).chain(fields).for_each(|name| inventory.add_name(name));
        }
    }

    /// The tileset of its tiles.
    pub fn tileset(&self) -> Option<i64> {
        self.override_tileset_uid.or(self.tileset_def_uid)
    }
}

/// The definitions of layers, tiles and entities, as far as they are needed.
#[derive(Debug, Default)]
pub(super) struct Blocking {
    /// The values of a layer, by its definition, and whether they block.
    pub values: HashMap<i64, HashMap<i64, bool>>,
    /// The tiles of a tileset that block.
    pub tiles: HashMap<i64, HashSet<i64>>,
    /// Entities that are drawn as ellipses.
    pub ellipses: HashSet<i64>,
}

impl Project {
    /// The names of values and the tags of tiles.
    pub fn inventory(&self) -> Inventory {
        let mut inventory = Inventory::default();
        let values = self.defs.layers.iter().flat_map(|layer| &layer.int_grid_values);
        values.filter_map(|value| value.identifier.as_deref()).for_each(|name| inventory.add_name(name));
        let tags = self.defs.tilesets.iter().flat_map(|tileset| &tileset.enum_tags);
        tags.for_each(|tag| inventory.add_name(&tag.enum_value_id));
        inventory
    }

    /// Which values and tiles block, by their names or tags.
    pub fn blocking(&self, rule: &Rule) -> Blocking {
        let is_wall = |name: &str| rule.role(name) == Some(Role::Wall);
        let mut blocking = Blocking::default();
        for layer in &self.defs.layers {
            let values = blocking.values.entry(layer.uid).or_default();
            for value in &layer.int_grid_values {
                let named = value.identifier.as_deref().is_some_and(is_wall);
                values.insert(value.value, named);
            }
        }
        for tileset in &self.defs.tilesets {
            let tags = tileset.enum_tags.iter().filter(|tag| is_wall(&tag.enum_value_id));
            blocking.tiles.entry(tileset.uid).or_default().extend(tags.flat_map(|tag| &tag.tile_ids));
        }
        let ellipses = self.defs.entities.iter().filter(|entity| entity.render_mode == "Ellipse");
        blocking.ellipses.extend(ellipses.map(|entity| entity.uid));
        blocking
    }
}
