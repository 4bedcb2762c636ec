//! Which tiles of tilesets block sight, and the files of tilesets.

use std::collections::{BTreeMap, HashMap};
use std::io;
use std::rc::Rc;

use super::error::TmxError;
use super::names::{Role, Rule, Says, truth};
use super::xml::{Element, Xml, utf8};

/// What a tileset says of a tile.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tile {
    /// By its properties.
    says: Says,
    /// By its class.
    class: Says,
    /// What the shapes that are drawn on it say of themselves, if there are any.
    drawn: Option<Says>,
}

impl Tile {
    /// Whether it blocks in its whole cell, on a layer that makes walls of `all` or on another one.
    /// Its class says so only if no shapes are drawn on it: these may be smaller than the cell. Nor
    /// does it block if one of them is a door.
    pub fn blocks(self, all: bool) -> bool {
        let has_door = self.drawn.is_some_and(|says| says.role() == Some(Role::Door));
        let says = if self.drawn.is_none() { self.says.or(self.class) } else { self.says };
        !has_door && (all || says.is_wall())
    }

    /// Whether shapes are drawn on it that would hide if they were read.
    pub fn has_shapes(self) -> bool {
        let hides =
            |drawn: Says| drawn.or(self.says).or(self.class).role().unwrap_or_default() != Role::Plain;
        self.drawn.is_some_and(hides)
    }

    /// Reads a tile, from behind its start.
    fn read(xml: &mut Xml<'_>, element: &Element<'_>, rule: &Rule) -> Result<Self, TmxError> {
        let mut tile = Self { class: class_of(xml, element, rule)?, ..Self::default() };
        while let Some(child) = xml.child()? {
            match child.local_name().as_ref() {
                b"properties" => tile.says = properties(xml, rule)?,
                b"objectgroup" => tile.drawn = drawn(xml, rule)?.or(tile.drawn),
                _ => xml.skip(&child)?,
            }
        }
        Ok(tile)
    }
}

/// What the class of a tile or a shape says. Version 1.9 of the editor calls it `class`, those
/// before and after it `type`.
fn class_of(xml: &Xml<'_>, element: &Element<'_>, rule: &Rule) -> Result<Says, TmxError> {
    let kind = xml.attribute(element, "type")?.filter(|kind| !kind.is_empty());
    let class = kind.or(xml.attribute(element, "class")?);
    Ok(class.and_then(|class| rule.role(&class)).into())
}

/// What the shapes that are drawn on a tile say of themselves, from behind the start of their
/// group. `None` if there are none.
fn drawn(xml: &mut Xml<'_>, rule: &Rule) -> Result<Option<Says>, TmxError> {
    let mut all = None;
    while let Some(child) = xml.child()? {
        if child.local_name().as_ref() != b"object" {
            xml.skip(&child)?;
            continue;
        }
        let mut roles = vec![class_of(xml, &child, rule)?.role()];
        while let Some(part) = xml.child()? {
            match part.local_name().as_ref() {
                b"properties" => roles.push(properties(xml, rule)?.role()),
                _ => xml.skip(&part)?,
            }
        }
        let all = all.get_or_insert_with(Says::default);
        let hides = roles.into_iter().flatten().filter(|role| *role != Role::Plain);
        hides.for_each(|role| all.add(role, true));
    }
    Ok(all)
}

/// What a list of properties says, from behind its start. One that is neither true nor false says
/// nothing.
pub(super) fn properties(xml: &mut Xml<'_>, rule: &Rule) -> Result<Says, TmxError> {
    let mut all = BTreeMap::new();
    while let Some(child) = xml.child()? {
        let name = xml.attribute(&child, "name")?.unwrap_or_default();
        if let Some(role) = rule.role(&name) {
            let kind = xml.attribute(&child, "type")?.unwrap_or("string".into());
            let plain = ["bool", "string", "int", "float"].contains(&&*kind);
            let value = xml.attribute(&child, "value")?.filter(|_| plain);
            // Of properties that come twice the last counts.
            all.insert(name.into_owned(), (role, value.and_then(|value| truth(&value))));
        }
        xml.skip(&child)?;
    }
    let mut says = Says::default();
    for (role, value) in all.into_values() {
        value.into_iter().for_each(|value| says.add(role, value));
    }
    Ok(says)
}

/// A tileset. The number of tiles that it promises takes no memory: those without properties are
/// not listed in a file.
#[derive(Debug, Default)]
pub(super) struct Tileset {
    /// Those that it lists, of which the last counts if they come twice.
    listed: BTreeMap<u32, Tile>,
    /// How many tiles it says that it has. Tilesets of single images leave numbers out, and list
    /// tiles beyond.
    count: Option<u32>,
}

impl Tileset {
    /// Reads a tileset, from behind its start.
    pub fn read(xml: &mut Xml<'_>, tileset: &Element<'_>, rule: &Rule) -> Result<Self, TmxError> {
        let count = xml.attribute(tileset, "tilecount")?.and_then(|count| count.trim().parse().ok());
        let mut found = Self { count, ..Self::default() };
        while let Some(child) = xml.child()? {
            match child.local_name().as_ref() {
                b"tile" => _ = found.listed.insert(xml.number(&child, "id")?, Tile::read(xml, &child, rule)?),
                _ => xml.skip(&child)?,
            }
        }
        Ok(found)
    }

    /// A tile by its number; `None` if there is no such tile.
    fn get(&self, number: u32) -> Option<Tile> {
        let promised = self.count.is_none_or(|count| number < count).then(Tile::default);
        self.listed.get(&number).copied().or(promised)
    }
}

/// The bits of an id that are not for turning the tile.
pub(super) const TILE: u32 = 0x1fff_ffff;

/// The tilesets of a map, each read once.
pub(super) struct Tilesets<'f> {
    /// Opens a file by the path that the map has for it.
    open: &'f mut dyn FnMut(&str) -> io::Result<Vec<u8>>,
    files: HashMap<String, Rc<Tileset>>,
    /// With the number of their first tiles in the map, which ascend.
    all: Vec<(u32, Rc<Tileset>)>,
}

impl<'f> Tilesets<'f> {
    pub fn new(open: &'f mut dyn FnMut(&str) -> io::Result<Vec<u8>>) -> Self {
        Self { open, files: HashMap::new(), all: Vec::new() }
    }

    /// Forgets the tilesets of the map, but not their files.
    pub fn clear(&mut self) {
        self.all.clear();
    }

    pub fn push(&mut self, first: u32, tiles: Rc<Tileset>) {
        // A tile is of the last tileset in the file that begins at or before it.
        while self.all.pop_if(|(other, _)| *other >= first).is_some() {}
        self.all.push((first, tiles));
    }

    /// The tile of an id, of which the upper three bits turn it; `None` if there is no such tile.
    pub fn find(&self, id: u32) -> Option<Tile> {
        let id = id & TILE;
        let after = self.all.partition_point(|(first, _)| *first <= id);
        let (first, set) = &self.all[after.checked_sub(1)?];
        set.get(id - first)
    }

    /// Adds a tileset, from behind its start: one in the map, or one in a file of its own.
    pub fn add(&mut self, xml: &mut Xml<'_>, element: &Element<'_>, rule: &Rule) -> Result<(), TmxError> {
        let first = xml.number(element, "firstgid")?;
        let tiles = match xml.attribute(element, "source")? {
            Some(source) => {
                xml.skip(element)?;
                self.external(&source, rule)?
            }
            None => Rc::new(Tileset::read(xml, element, rule)?),
        };
        self.push(first, tiles);
        Ok(())
    }

    fn external(&mut self, source: &str, rule: &Rule) -> Result<Rc<Tileset>, TmxError> {
        if let Some(tiles) = self.files.get(source) {
            return Ok(tiles.clone());
        }
        let bytes = (self.open)(source).map_err(|why| TmxError::File { file: source.to_owned(), why })?;
        let mut xml = Xml::new(utf8(&bytes, source)?, source);
        let root = xml.root("tileset")?;
        let tiles = Rc::new(Tileset::read(&mut xml, &root, rule)?);
        self.files.insert(source.to_owned(), tiles.clone());
        Ok(tiles)
    }
}
