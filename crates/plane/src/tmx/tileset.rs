//! Which tiles of tilesets block sight.

use std::collections::BTreeSet;
use std::rc::Rc;

use super::TmxError;
use super::xml::{Element, Xml};

/// The tiles of a tileset that block, by their numbers in it.
#[derive(Debug, Default)]
pub(super) struct Opaque(BTreeSet<u32>);

impl Opaque {
    /// Reads a tileset, from behind its start. The number of tiles that it promises does not
    /// matter: those without properties are not listed in a file.
    pub fn read(xml: &mut Xml<'_>, property: &str) -> Result<Self, TmxError> {
        let mut tiles = BTreeSet::new();
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"tile" {
                xml.skip(&child)?;
                continue;
            }
            let id = xml.number(&child, "id")?;
            // Of tiles and properties that come twice the last counts.
            tiles.remove(&id);
            while let Some(child) = xml.child()? {
                if child.local_name().as_ref() != b"properties" {
                    xml.skip(&child)?;
                    continue;
                }
                if opaque(xml, property)? {
                    tiles.insert(id);
                }
            }
        }
        Ok(Self(tiles))
    }
}

/// Whether a list of properties has one that is `true`, from behind its start.
fn opaque(xml: &mut Xml<'_>, property: &str) -> Result<bool, TmxError> {
    let mut opaque = false;
    while let Some(child) = xml.child()? {
        if xml.attribute(&child, "name")?.is_some_and(|name| name == property) {
            opaque = is_true(xml, &child)?;
        }
        xml.skip(&child)?;
    }
    Ok(opaque)
}

/// Whether a property is of the type `bool`, and `true`.
fn is_true(xml: &Xml<'_>, property: &Element<'_>) -> Result<bool, TmxError> {
    if xml.attribute(property, "type")?.is_none_or(|kind| kind != "bool") {
        return Ok(false);
    }
    match &*xml.required(property, "value")? {
        "true" => Ok(true),
        "false" => Ok(false),
        other => Err(xml.damaged(format!("{other:.40} is neither true nor false"))),
    }
}

/// The tilesets of a map.
#[derive(Debug, Default)]
pub(super) struct Tilesets {
    /// With the number of their first tiles in the map, which ascend.
    all: Vec<(u32, Rc<Opaque>)>,
}

impl Tilesets {
    /// Adds a tileset.
    pub fn push(&mut self, first: u32, tiles: Rc<Opaque>) {
        // A tile is of the last tileset in the file that begins at or before it.
        while self.all.pop_if(|(other, _)| *other >= first).is_some() {}
        self.all.push((first, tiles));
    }

    /// Whether a tile blocks, of a layer of which `all` do or those that say so. The upper three
    /// bits of an id turn the tile.
    pub fn blocks(&self, id: u32, all: bool) -> bool {
        let id = id & 0x1fff_ffff;
        let after = self.all.partition_point(|(first, _)| *first <= id);
        let tileset = after.checked_sub(1).map(|i| &self.all[i]);
        // 0 is no tile.
        tileset.is_some_and(|(first, tiles)| id != 0 && (all || tiles.0.contains(&(id - first))))
    }
}
