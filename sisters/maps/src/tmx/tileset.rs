//! Which tiles of tilesets block sight, and the files of tilesets.

use std::collections::{BTreeMap, HashMap};
use std::io;
use std::rc::Rc;

use super::element::{Element, tree};
use super::names::{Role, Rule, Says};
use crate::MapError;

/// What a tileset says of a tile.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tile {
    /// By its properties.
    says: Says,
    /// By its class.
    class: Says,
    /// What the shapes that are drawn on it say of themselves, if there are any.
    drawn: Option<Says>,
}

impl Tile {
    fn read(tile: Element<'_>, rule: &Rule) -> Self {
        let shapes = tile.all("objectgroup").flat_map(|group| group.all("object"));
        let drawn = shapes.fold(None::<Says>, |all, shape| {
            let roles = [rule.role(shape.class()), rule.properties(shape).role()].into_iter().flatten();
            let mut all = all.unwrap_or_default();
            roles.filter(|role| *role != Role::Plain).for_each(|role| all.add(role, true));
            Some(all)
        });
        Self { says: rule.properties(tile), class: rule.role(tile.class()).into(), drawn }
    }

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
        let role = |drawn: Says| drawn.or(self.says).or(self.class).role().unwrap_or_default();
        self.drawn.is_some_and(|drawn| role(drawn) != Role::Plain)
    }
}

/// A tileset. The number of tiles that it promises takes no memory: those without properties are
/// not listed in a file.
#[derive(Debug)]
struct Tileset {
    /// Those that it lists, of which the last counts if they come twice.
    listed: BTreeMap<u32, Tile>,
    /// How many tiles it says that it has. Tilesets of single images leave numbers out, and list
    /// tiles beyond.
    count: Option<u32>,
}

impl Tileset {
    fn read(tileset: Element<'_>, rule: &Rule) -> Result<Self, MapError> {
        let count = tileset.attribute("tilecount").and_then(|count| count.trim().parse().ok());
        let tiles = tileset.all("tile").map(|tile| Ok((tile.number("id")?, Tile::read(tile, rule))));
        Ok(Self { listed: tiles.collect::<Result<_, MapError>>()?, count })
    }
}

/// The bits of an id that are not for turning the tile. The fourth turns hexagons only.
pub const TILE: u32 = 0x0fff_ffff;

/// The tilesets of a map, with the ids of their first tiles, which ascend.
pub struct Tilesets(Vec<(u32, Rc<Tileset>)>);

impl Tilesets {
    /// Reads the tilesets in a map, and those in files of their own: each once, by `open`.
    pub fn read(
        map: Element<'_>,
        rule: &Rule,
        open: &mut dyn FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Self, MapError> {
        let mut all: Vec<(u32, Rc<Tileset>)> = Vec::new();
        let mut files = HashMap::new();
        for element in map.all("tileset") {
            let first = element.number("firstgid")?;
            let tileset = match element.attribute("source") {
                None => Rc::new(Tileset::read(element, rule)?),
                Some(source) if files.contains_key(source) => Rc::clone(&files[source]),
                Some(source) => {
                    let bytes =
                        open(source).map_err(|why| MapError::File { file: source.to_owned(), why })?;
                    let tree = tree(&bytes, source)?;
                    let read = Rc::new(Tileset::read(Element::root(&tree, source, "tileset")?, rule)?);
                    files.insert(source, Rc::clone(&read));
                    read
                }
            };
            // A tile is of the last tileset in the file that begins at or before it.
            while all.pop_if(|(other, _)| *other >= first).is_some() {}
            all.push((first, tileset));
        }
        Ok(Self(all))
    }

    /// The tile of an id, of which the upper four bits turn it; `None` if there is no such tile.
    pub fn find(&self, id: u32) -> Option<Tile> {
        let id = id & TILE;
        let after = self.0.partition_point(|(first, _)| *first <= id);
        let (first, set) = &self.0[after.checked_sub(1)?];
        let number = id - first;
        let promised = set.count.is_none_or(|count| number < count).then(Tile::default);
        set.listed.get(&number).copied().or(promised)
    }
}
