//! Levels.

use glam::{IVec2, Vec2};

use super::entity::LdtkEntity;
use super::error::{LdtkError, LdtkWarning};
use super::import::LdtkImport;
use super::project::{Blocking, Level};
use super::walls::Budget;
use crate::bits::BitGrid;
use crate::editor::{Role, Rule};
use crate::tiles::{TileError, TileLayer};

/// A level: see [`LdtkImport::read`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LdtkLevel {
    /// Its name.
    pub name: String,
    /// The name that no other level has.
    pub iid: String,
    /// Where its upper left corner lies in the world, in pixels. Worlds that are a row of levels
    /// say -1 for both.
    pub place: IVec2,
    /// Its floor: levels of different depths may lie above each other.
    pub depth: i32,
    /// Its width and height in pixels.
    pub size: [u32; 2],
    /// The tiles that block, from the upper left corner on, column and row: the finest of all
    /// layers in which something blocks. Empty if nothing does.
    pub walls: BitGrid,
    /// The side of a tile of `walls` in pixels; `None` if nothing blocks.
    pub tile: Option<u32>,
    /// The entities of all layers.
    pub entities: Vec<LdtkEntity>,
    /// The parts that were passed over. Nothing of it blocks sight.
    pub warnings: Vec<LdtkWarning>,
}

impl LdtkImport {
    pub(super) fn level(
        &self,
        level: &Level,
        blocking: &Blocking,
        rule: &Rule,
        budget: &mut Budget,
    ) -> Result<LdtkLevel, LdtkError> {
        let mut warnings = Vec::new();
        let (walls, tile) = self.walls(level, blocking, rule, budget, &mut warnings)?;
        let mut entities = Vec::new();
        for layer in level.layer_instances.iter().flatten() {
            for entity in &layer.entity_instances {
                match self.entity(layer, entity, blocking, rule) {
                    Ok(found) => entities.push(found),
                    Err(warning) => warnings.push(warning),
                }
            }
        }
        Ok(LdtkLevel {
            name: level.identifier.clone(),
            iid: level.iid.clone(),
            place: IVec2::new(level.world_x, level.world_y),
            depth: level.world_depth,
            size: [level.px_wid, level.px_hei],
            walls,
            tile,
            entities,
            warnings,
        })
    }
}

impl LdtkLevel {
    /// Whether anything has one of these roles; tiles that block are walls.
    pub(super) fn has(&self, roles: &[Role]) -> bool {
        self.tile.is_some() && roles.contains(&Role::Wall)
            || self.entities.iter().any(|entity| roles.contains(&entity.role))
    }

    /// The tiles that block, placed in a scene as [`LdtkEntity::insert`] places entities: the upper
    /// left corner of the level lies at `origin`, and a pixel is `pixel` world units wide. `None`
    /// if nothing blocks. Copies the tiles.
    ///
    /// # Errors
    /// As [`TileLayer::new`].
    pub fn tile_layer(&self, origin: Vec2, pixel: f32) -> Result<Option<TileLayer>, TileError> {
        let layer = |tile: u32| TileLayer::new(origin, tile as f32 * pixel, self.walls.clone());
        self.tile.map(layer).transpose()
    }
}
