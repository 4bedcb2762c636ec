//! Objects as the map has them.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::properties::TmxValue;
use super::shape::TmxShape;
use crate::editor::Role;

/// An object of a map: see [`TmxMap::objects`](crate::tmx::TmxMap::objects).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TmxObject {
    /// Its number in the map; 0 if the file gives none.
    pub id: u32,
    /// Its name, often empty.
    pub name: String,
    /// Its class, or type as some versions of the editor say; that of its tile if it has none.
    pub class: Arc<str>,
    /// The name of its layer.
    pub layer: Arc<str>,
    /// False if it, its layer or a group around it is switched off in the editor. It may hide
    /// others all the same, as layers of tiles do.
    pub visible: bool,
    /// Its tile as the map counts, with the upper bits that turn it, for an object with a picture.
    /// `None` for that of a template whose tileset the map does not have.
    pub tile: Option<u32>,
    /// Where it is, in tiles.
    pub shape: TmxShape,
    /// Whether it hides others.
    pub role: Role,
    /// Its own properties and those of its template, by their names. Those of its tile are not
    /// repeated here.
    pub properties: BTreeMap<String, TmxValue>,
}
