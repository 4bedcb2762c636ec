//! The names that say what blocks.

use crate::editor::MapNames;

/// Reads projects. What blocks sight in them is said by names, each in one of these places:
///
/// | name of | what hides |
/// |---|---|
/// | a layer | all values, tiles and entities in it |
/// | a value of an IntGrid layer | the value |
/// | a tag of tiles in their tileset | the tiles |
/// | an entity, a tag of it, or a field that is true | the entity |
///
/// A field that is false takes the role away that a name or a layer would give. Names of doors make
/// doors of entities.
///
/// ```no_run
/// use casca_plane::ldtk::LdtkImport;
/// use casca_plane::{GridSpec, Role, Scene};
/// use glam::{UVec2, Vec2};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let grid = GridSpec { min: Vec2::splat(-1024.0), cell: 16.0, dims: UVec2::splat(256) };
/// let mut scene = Scene::new(&grid)?;
/// // World units are pixels here.
/// for level in LdtkImport::default().read("world.ldtk")? {
///     level.warnings.iter().for_each(|warning| eprintln!("{}: {warning}", level.name));
///     let place = level.place.as_vec2();
///     if let Some(layer) = level.tile_layer(place, 1.0)? {
///         scene.insert_tiles(&layer)?;
///     }
///     for entity in &level.entities {
///         let placed = entity.insert(&mut scene, place, 1.0, 0)?;
///         if entity.role == Role::Door {
///             placed.set_closed(&mut scene, false)?;
///         }
///     }
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LdtkImport {
    /// The names that count.
    pub names: MapNames,
}
