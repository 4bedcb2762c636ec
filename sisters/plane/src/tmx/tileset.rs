//! Which tiles of tilesets block sight, and the files of tilesets.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io;
use std::rc::Rc;
use std::sync::Arc;

use super::TmxError;
use super::xml::{Element, Xml};
use crate::editor::{Inventory, Role, Rule, Says, truth};
use crate::files::text;

/// What a tileset says of its tiles.
#[derive(Debug, Default)]
pub(super) struct Opaque {
    /// What the properties of tiles say, by their numbers in it.
    says: BTreeMap<u32, Says>,
    /// The classes of those that have one, and the roles that these give.
    classes: BTreeMap<u32, (Arc<str>, Option<Role>)>,
    /// The names of properties and classes.
    pub names: Inventory,
    /// The tiles on which shapes are drawn, with the roles that these give.
    drawn: BTreeMap<u32, Says>,
    /// The size of all pictures in pixels, or of single ones.
    size: [f64; 2],
    sizes: BTreeMap<u32, [f64; 2]>,
    /// Which point of its picture an object names.
    alignment: Option<Alignment>,
    /// How many tiles it says that it has.
    count: Option<u32>,
    /// Those that it lists beyond: tilesets of single images leave numbers out.
    listed: BTreeSet<u32>,
    /// Tiles with a property of the right name that says neither yes nor no: its name and type.
    wrong: Vec<(u32, [String; 2])>,
}

/// A point of a picture, in shares of its width and height from the upper left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Alignment(pub [f64; 2]);

impl Alignment {
    pub const BOTTOM: Self = Self([0.5, 1.0]);
    pub const BOTTOM_LEFT: Self = Self([0.0, 1.0]);

    fn named(name: &str) -> Option<Self> {
        Some(Self(match name {
            "topleft" => [0.0, 0.0],
            "top" => [0.5, 0.0],
            "topright" => [1.0, 0.0],
            "left" => [0.0, 0.5],
            "center" => [0.5, 0.5],
            "right" => [1.0, 0.5],
            "bottomleft" => return Some(Self::BOTTOM_LEFT),
            "bottom" => return Some(Self::BOTTOM),
            "bottomright" => [1.0, 1.0],
            _ => return None,
        }))
    }
}

impl Opaque {
    /// Reads a tileset, from behind its start. The number of tiles that it promises takes no
    /// memory: those without properties are not listed in a file.
    pub fn read(xml: &mut Xml<'_>, tileset: &Element<'_>, rule: &Rule) -> Result<Self, TmxError> {
        let count = xml.attribute(tileset, "tilecount")?.and_then(|count| count.trim().parse().ok());
        let alignment = xml.attribute(tileset, "objectalignment")?.and_then(|name| Alignment::named(&name));
        let size = size(xml, tileset, ["tilewidth", "tileheight"])?;
        let mut found = Self { count, alignment, size, ..Self::default() };
        while let Some(child) = xml.child()? {
            match child.local_name().as_ref() {
                b"tile" => found.tile(xml, &child, rule)?,
                _ => xml.skip(&child)?,
            }
        }
        Ok(found)
    }

    /// Reads a tile, from behind its start.
    fn tile(&mut self, xml: &mut Xml<'_>, tile: &Element<'_>, rule: &Rule) -> Result<(), TmxError> {
        let id = xml.number(tile, "id")?;
        if self.count.is_some_and(|count| id >= count) {
            self.listed.insert(id);
        }
        let kind = xml.attribute(tile, "type")?.filter(|kind| !kind.is_empty());
        let class = kind.or(xml.attribute(tile, "class")?).filter(|class| !class.is_empty());
        // Of tiles and properties that come twice the last counts.
        self.says.remove(&id);
        self.classes.remove(&id);
        self.drawn.remove(&id);
        self.names.add_name(class.as_deref().unwrap_or_default());
        self.classes.extend(class.map(|class| (id, ((&*class).into(), rule.role(&class)))));
        // The tile may be a part of its image.
        let part = size(xml, tile, ["width", "height"])?;
        while let Some(child) = xml.child()? {
            match child.local_name().as_ref() {
                b"properties" => {
                    let (wrong, names) = (&mut self.wrong, &mut self.names);
                    let says = properties(xml, rule, names, |name, kind| wrong.push((id, [name, kind])))?;
                    self.says.insert(id, says);
                }
                b"objectgroup" => {
                    if let Some(drawn) = drawn(xml, rule)? {
                        self.drawn.insert(id, drawn);
                    }
                }
                b"image" => {
                    let all = size(xml, &child, ["width", "height"])?;
                    self.sizes.insert(id, if part.contains(&0.0) { all } else { part });
                    xml.skip(&child)?;
                }
                _ => xml.skip(&child)?,
            }
        }
        Ok(())
    }

    /// What the properties of a tile say of it, and its class, if that counts.
    pub fn says(&self, tile: u32, with_class: bool) -> Says {
        let says = self.says.get(&tile).copied().unwrap_or_default();
        let class = self.classes.get(&tile).filter(|_| with_class).and_then(|class| class.1);
        says.or(class.into())
    }

    /// Whether a tile blocks in its whole cell, on a layer that makes walls of `all` or on another
    /// one. Its class says so only if no shapes are drawn on it: these may be smaller than the
    /// cell. Nor does it block if one of them is a door.
    pub fn blocks(&self, tile: u32, all: bool) -> bool {
        let drawn = self.drawn.get(&tile);
        let has_door = drawn.is_some_and(|says| says.role() == Some(Role::Door));
        !has_door && (all || self.says(tile, drawn.is_none()).is_wall())
    }

    /// Whether shapes are drawn on a tile that would hide if they were read.
    pub fn has_shapes(&self, tile: u32) -> bool {
        let hides = |says: &Says| says.or(self.says(tile, true)).role().unwrap_or_default() != Role::Plain;
        self.drawn.get(&tile).is_some_and(hides)
    }

    /// The class of a tile.
    pub fn class(&self, tile: u32) -> Option<Arc<str>> {
        self.classes.get(&tile).map(|class| class.0.clone())
    }

    /// The size of a tile's picture, and the point of it that an object names.
    pub fn picture(&self, tile: u32) -> (Option<Alignment>, [f64; 2]) {
        (self.alignment, self.sizes.get(&tile).copied().unwrap_or(self.size))
    }

    /// Whether it has a tile.
    fn has(&self, tile: u32) -> bool {
        self.count.is_none_or(|count| tile < count) || self.listed.contains(&tile)
    }
}

/// The size of a picture in pixels; 0 where it is not said.
fn size(xml: &Xml<'_>, element: &Element<'_>, names: [&str; 2]) -> Result<[f64; 2], TmxError> {
    let mut size = [0.0; 2];
    for (length, name) in size.iter_mut().zip(names) {
        let found = xml.attribute(element, name)?.and_then(|text| text.trim().parse::<u32>().ok());
        *length = found.map_or(0.0, f64::from);
    }
    Ok(size)
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
        let all = all.get_or_insert_with(Says::default);
        let names = [xml.attribute(&child, "type")?, xml.attribute(&child, "class")?];
        let roles = names.iter().flatten().filter_map(|name| rule.role(name));
        roles.for_each(|role| all.add(role, true));
        while let Some(part) = xml.child()? {
            match part.local_name().as_ref() {
                b"properties" => {
                    let says = properties(xml, rule, &mut Inventory::default(), |_, _| ())?;
                    says.role()
                        .filter(|role| *role != Role::Plain)
                        .into_iter()
                        .for_each(|r| all.add(r, true));
                }
                _ => xml.skip(&part)?,
            }
        }
    }
    Ok(all)
}

/// What a list of properties says, from behind its start. `wrong` is told the name and the type of
/// a property that says neither yes nor no.
pub(super) fn properties(
    xml: &mut Xml<'_>,
    rule: &Rule,
    names: &mut Inventory,
    mut wrong: impl FnMut(String, String),
) -> Result<Says, TmxError> {
    let mut all = BTreeMap::new();
    while let Some(child) = xml.child()? {
        if let Some(name) = xml.attribute(&child, "name")? {
            names.add_name(&name);
            if let Some(role) = rule.role(&name) {
                let kind = xml.attribute(&child, "type")?.unwrap_or("string".into()).into_owned();
                let value = xml.attribute(&child, "value")?;
                let plain = ["bool", "string", "int", "float"].contains(&&*kind);
                let says = value.filter(|_| plain).and_then(|value| truth(&value));
                // Of properties that come twice the last counts.
                all.insert(name.into_owned(), (role, kind, says));
            }
        }
        xml.skip(&child)?;
    }
    let mut says = Says::default();
    for (name, (role, kind, value)) in all {
        match value {
            Some(value) => says.add(role, value),
            None => wrong(name, kind),
        }
    }
    Ok(says)
}

/// The bits of an id that are not for turning the tile.
pub(super) const TILE: u32 = 0x1fff_ffff;

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
    #[cfg(test)]
    pub fn blocks(&self, id: u32, all: bool) -> bool {
        let id = id & TILE;
        // 0 is no tile.
        self.of(id).is_some_and(|(first, set)| id != 0 && set.blocks(id - first, all))
    }

    /// The tileset of a tile, and the tile's number in it; `None` if there is no such tile.
    pub fn find(&self, id: u32) -> Option<(&Opaque, u32)> {
        let (first, set) = self.of(id & TILE)?;
        let number = (id & TILE) - first;
        set.has(number).then_some((&**set, number))
    }

    /// The tilesets with their first tiles. One that the map names often comes once.
    fn once(&self) -> impl Iterator<Item = &(u32, Rc<Opaque>)> {
        let mut known = BTreeSet::new();
        self.all.iter().filter(move |(_, set)| known.insert(Rc::as_ptr(set)))
    }

    /// The first tiles of tilesets, with the tiles whose property says neither yes nor no, its name
    /// and its type.
    pub fn wrong(&self) -> impl Iterator<Item = (u32, u32, [String; 2])> {
        self.once()
            .flat_map(|(first, set)| set.wrong.iter().map(|(tile, which)| (*first, *tile, which.clone())))
    }

    /// The names of properties and classes of each tileset.
    pub fn names(&self) -> impl Iterator<Item = &Inventory> {
        self.once().map(|(_, set)| &set.names)
    }
}

/// Opens a file by the path that the map has for it.
pub(super) type Open<'f> = &'f mut dyn FnMut(&str) -> io::Result<Vec<u8>>;

/// The files of tilesets: each is read once.
pub(super) struct Files<'f> {
    open: Open<'f>,
    pub rule: &'f Rule,
    /// Those of an encoding that was guessed.
    pub odd: Vec<String>,
    tilesets: HashMap<String, Rc<Opaque>>,
}

impl<'f> Files<'f> {
    pub fn new(open: Open<'f>, rule: &'f Rule) -> Self {
        Self { open, rule, odd: Vec::new(), tilesets: HashMap::new() }
    }

    /// Adds a tileset, from behind its start: one in the map, or one in a file of its own.
    pub fn tileset(
        &mut self,
        xml: &mut Xml<'_>,
        element: &Element<'_>,
        into: &mut Tilesets,
    ) -> Result<(), TmxError> {
        let first = xml.number(element, "firstgid")?;
        let tiles = match xml.attribute(element, "source")? {
            Some(source) => {
                xml.skip(element)?;
                self.external(&source)?
            }
            None => Rc::new(Opaque::read(xml, element, self.rule)?),
        };
        into.push(first, tiles);
        Ok(())
    }

    fn external(&mut self, source: &str) -> Result<Rc<Opaque>, TmxError> {
        if let Some(tiles) = self.tilesets.get(source) {
            return Ok(tiles.clone());
        }
        let bytes = (self.open)(source).map_err(|why| TmxError::File { file: source.to_owned(), why })?;
        let (text, is_odd) = text(&bytes);
        if is_odd {
            self.odd.push(source.to_owned());
        }
        let mut xml = Xml::new(&text, source);
        let root = xml.root("tileset")?;
        let tiles = Rc::new(Opaque::read(&mut xml, &root, self.rule)?);
        self.tilesets.insert(source.to_owned(), tiles.clone());
        Ok(tiles)
    }
}
