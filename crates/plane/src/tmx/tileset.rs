//! Which tiles of tilesets block sight.

use std::collections::BTreeSet;
use std::rc::Rc;

use super::TmxError;
use super::xml::{Element, Xml};

/// What a tileset says of its tiles.
#[derive(Debug, Default)]
pub(super) struct Opaque {
    /// Those that block, by their numbers in it.
    tiles: BTreeSet<u32>,
    /// How many tiles it says that it has.
    count: Option<u32>,
    /// Those that it lists beyond: tilesets of single images leave numbers out.
    listed: BTreeSet<u32>,
    /// Tiles with a property of the right name and another type than `bool`, and this type.
    wrong: Vec<(u32, String)>,
}

/// What a list of properties says.
enum Says {
    Nothing,
    Opaque,
    Wrong(String),
}

impl Opaque {
    /// Reads a tileset, from behind its start. The number of tiles that it promises takes no
    /// memory: those without properties are not listed in a file.
    pub fn read(xml: &mut Xml<'_>, tileset: &Element<'_>, property: &str) -> Result<Self, TmxError> {
        let count = xml.attribute(tileset, "tilecount")?.and_then(|count| count.trim().parse().ok());
        let mut found = Self { count, ..Self::default() };
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"tile" {
                xml.skip(&child)?;
                continue;
            }
            let id = xml.number(&child, "id")?;
            if count.is_some_and(|count| id >= count) {
                found.listed.insert(id);
            }
            // Of tiles and properties that come twice the last counts.
            found.tiles.remove(&id);
            while let Some(child) = xml.child()? {
                if child.local_name().as_ref() != b"properties" {
                    xml.skip(&child)?;
                    continue;
                }
                match says(xml, property)? {
                    Says::Opaque => _ = found.tiles.insert(id),
                    Says::Wrong(kind) => found.wrong.push((id, kind)),
                    Says::Nothing => {}
                }
            }
        }
        Ok(found)
    }

    /// Whether it has a tile.
    fn has(&self, tile: u32) -> bool {
        self.count.is_none_or(|count| tile < count) || self.listed.contains(&tile)
    }
}

/// What a list of properties says of one, from behind its start.
fn says(xml: &mut Xml<'_>, property: &str) -> Result<Says, TmxError> {
    let mut says = Says::Nothing;
    while let Some(child) = xml.child()? {
        if xml.attribute(&child, "name")?.is_some_and(|name| name == property) {
            // Without a type it is a string.
            let kind = xml.attribute(&child, "type")?.unwrap_or("string".into()).into_owned();
            says = match (kind == "bool", kind == "bool" && is_true(xml, &child)?) {
                (false, _) => Says::Wrong(kind),
                (true, true) => Says::Opaque,
                (true, false) => Says::Nothing,
            };
        }
        xml.skip(&child)?;
    }
    Ok(says)
}

/// Whether a property of the type `bool` is `true`.
fn is_true(xml: &Xml<'_>, property: &Element<'_>) -> Result<bool, TmxError> {
    match &*xml.required(property, "value")? {
        "true" => Ok(true),
        "false" => Ok(false),
        other => Err(xml.damaged(format!("{other:.40} is neither true nor false"))),
    }
}

/// The bits of an id that are not for turning the tile.
const TILE: u32 = 0x1fff_ffff;

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

    /// The tileset of a tile with the number of its first tile. The upper three bits of an id turn
    /// the tile.
    fn of(&self, id: u32) -> Option<&(u32, Rc<Opaque>)> {
        let after = self.all.partition_point(|(first, _)| *first <= id);
        after.checked_sub(1).map(|i| &self.all[i])
    }

    /// Whether a tile blocks, of a layer of which `all` do or those that say so.
    pub fn blocks(&self, id: u32, all: bool) -> bool {
        let id = id & TILE;
        // 0 is no tile.
        self.of(id).is_some_and(|(first, set)| id != 0 && (all || set.tiles.contains(&(id - first))))
    }

    /// Whether a tileset has a tile; there is always no tile.
    pub fn has(&self, id: u32) -> bool {
        let id = id & TILE;
        id == 0 || self.of(id).is_some_and(|(first, set)| set.has(id - first))
    }

    /// The first tiles of tilesets, with the tiles whose property has another type than `bool`, and
    /// the type. A file that the map names often comes once.
    pub fn wrong_types(&self) -> impl Iterator<Item = (u32, u32, String)> {
        let mut known = BTreeSet::new();
        let once = self.all.iter().filter(move |(_, set)| known.insert(Rc::as_ptr(set)));
        once.flat_map(|(first, set)| set.wrong.iter().map(|(tile, kind)| (*first, *tile, kind.clone())))
    }
}
