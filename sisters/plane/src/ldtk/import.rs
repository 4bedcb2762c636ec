//! The names that say what blocks.

/// Which tiles and entities of a project block sight. Names are compared without regard to case:
/// the editor writes identifiers with a capital.
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
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LdtkImport {
    /// Values of IntGrid layers of this name block, and tiles that have this tag in their tileset;
    /// so do entities of this name, with this tag, or with a field of this name that is `true`; at
    /// first `opaque`.
    pub property: String,
    /// All values and tiles in layers of this name block, and all entities; at first `walls`.
    pub layer: String,
    /// Entities of this name, with this tag, or with a field of this name that is `true` are doors;
    /// at first `door`.
    pub door: String,
}

impl Default for LdtkImport {
    fn default() -> Self {
        Self { property: "opaque".into(), layer: "walls".into(), door: "door".into() }
    }
}

impl LdtkImport {
    /// Whether a name is the wanted one.
    pub(super) fn is(name: &str, wanted: &str) -> bool {
        name.eq_ignore_ascii_case(wanted)
    }
}
