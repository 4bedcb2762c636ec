//! The same promise on maps of tiles: who may be told of whom in strategy games, roguelikes and
//! games seen from above.
//!
//! A [`PlaneServer`] has a map of opaque tiles, clients and entities. An answer names an entity if
//! any eye that the client may have by then could see a tile that the entity may be in by then:
//! wherever the eye gets to within `speed * (latency + tick + age of the report)`, and likewise the
//! entity. What one eye sees is [`casca_plane::FieldOfView`]'s matter; here, all eyes of a tile are
//! asked for at once ([`casca_plane::FieldOfView::run_from_tile`]) and kept by tile.
//!
//! An entity is in all tiles that its square touches. Those that are opaque do not count, unless
//! all of them are: who hugs a wall is not seen from behind it.
//!
//! Lengths are tiles, times seconds: tile `(x, y)` is the square from `(x, y)` to `(x + 1, y + 1)`.
//!
//! ```
//! use casca_plane::{BitGrid, OpaqueTiles};
//! use casca_server::casca::glam::Vec2;
//! use casca_server::plane::{PlaneServer, Square};
//! use casca_server::{ClientDesc, EntityDesc, ServerOptions};
//!
//! # fn main() -> Result<(), casca_server::ServerError> {
//! // A wall across the map, with a gap at its end.
//! let mut walls = BitGrid::new(32, 16);
//! walls.fill(8, 0..31);
//! let mut server = PlaneServer::new(OpaqueTiles::new(walls), ServerOptions::new())?;
//! // An eye that walks 4 tiles a second, of a client with 100 ms latency.
//! let client = server.add_client(ClientDesc::new(Vec2::new(3.5, 4.5), 4.0, 0.1), 0.0)?;
//! let person = |x, y| Square::new(Vec2::new(x, y), 0.3);
//! let friend = server.add_entity(EntityDesc::new(person(9.5, 2.5), 4.0), 0.0)?;
//! let enemy = server.add_entity(EntityDesc::new(person(3.5, 12.5), 4.0), 0.0)?;
//!
//! server.tick(0.0)?;
//! assert_eq!(server.answer(client)?.told, [friend], "the enemy is behind the wall");
//! server.move_entity(enemy, person(31.5, 8.5), 0.03)?;
//! server.tick(0.033)?;
//! assert_eq!(server.answer(client)?.new, [enemy]);
//! # Ok(())
//! # }
//! ```

mod ground;
mod sights;

use std::collections::BTreeSet;

use casca::glam::Vec2;
use casca_plane::OpaqueTiles;

use crate::describe::ClientDesc;
use crate::error::{ServerError, within};
use crate::options::ServerOptions;
use crate::server::Server;
use crate::world::World;

use ground::{Ground, MARGIN, Tile};
use sights::{Key, Sights, Window};

/// Maps are at most so wide and high, in tiles: beyond, single precision tells places in a tile
/// apart by a sixteenth of it.
const WIDEST: u32 = 1 << 20;

/// An entity may be in so many tiles: one that may be in more is told to all.
const MOST_TAKEN: usize = 4096;

/// A server on a map of tiles.
pub type PlaneServer = Server<Tiles>;

/// A map of tiles.
#[derive(Debug)]
pub struct Tiles {
    map: OpaqueTiles,
    walls_stop: bool,
    sights: Sights,
}

/// A square on a map, in tiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Square {
    /// Its middle, which is on the map.
    pub center: Vec2,
    /// Half of its side; 0 for a point.
    pub half: f32,
}

impl Square {
    /// A square around a place.
    pub const fn new(center: Vec2, half: f32) -> Self {
        Self { center, half }
    }
}

impl ClientDesc<Vec2> {
    /// Lets it see only tiles of which some point is nearer than that, above 0. Without a call it
    /// sees as far as opaque tiles let it.
    #[must_use]
    pub const fn radius(mut self, tiles: f32) -> Self {
        self.radius = tiles;
        self
    }
}

impl PlaneServer {
    /// A server for a map.
    ///
    /// # Errors
    /// Refuses options that are out of their ranges, and maps without a tile or with more than
    /// 2^20 columns or rows.
    pub fn new(map: OpaqueTiles, options: ServerOptions) -> Result<Self, ServerError> {
        for (what, size) in [("the width of a map", map.width()), ("the height of a map", map.height())] {
            within(what, size as f32, 1.0, WIDEST as f32)?;
        }
        Self::of(Tiles { map, walls_stop: options.walls, sights: Sights::default() }, options)
    }

    /// The map.
    pub fn map(&self) -> &OpaqueTiles {
        &self.world.map
    }

    /// Lets a tile block sight, or not, from the next tick on: a door, a tree that falls. All that
    /// was found is forgotten if it changed, which costs the next tick some microseconds for each
    /// tile that an eye may be in.
    ///
    /// # Errors
    /// Refuses tiles that are not on the map.
    pub fn set_opaque(&mut self, x: u32, y: u32, opaque: bool) -> Result<(), ServerError> {
        let Tiles { map, sights, .. } = &mut self.world;
        let (width, height) = (map.width(), map.height());
        if x >= width || y >= height {
            return Err(casca_plane::Error::Outside { x, y, width, height }.into());
        }
        if map.get(x, y) != opaque {
            map.set(x, y, opaque);
            sights.clear();
        }
        Ok(())
    }
}

impl Tiles {
    fn ground(&self) -> Ground<'_> {
        Ground { opaque: &self.map, walls_stop: self.walls_stop }
    }

    /// Refuses places that are not on the map, or not finite.
    fn check(&self, what: &'static str, place: Vec2) -> Result<(), ServerError> {
        let (width, height) = (self.map.width(), self.map.height());
        let is_on = |at: f32, size: u32| (0.0..=size as f32).contains(&at);
        if is_on(place.x, width) && is_on(place.y, height) {
            return Ok(());
        }
        Err(ServerError::OffMap { what, x: place.x, y: place.y, width, height })
    }
}

impl World for Tiles {
    type Eye = Vec2;
    type Bounds = Square;
    /// Where the eye may be; `None` if in too many tiles.
    type Kept = Option<Vec<Key>>;
    /// Where an entity may be; `None` if in too many tiles.
    type Reached = Option<Vec<Tile>>;
    /// What all eyes see together; `None` if they may see all.
    type Look<'a> = Option<Window>;

    fn check_eye(&self, eye: &Vec2) -> Result<(), ServerError> {
        self.check("the eye of a client", *eye)
    }

    fn check_bounds(&self, bounds: &Square) -> Result<(), ServerError> {
        self.check("the place of an entity", bounds.center)?;
        within("half the side of an entity, in tiles,", bounds.half, 0.0, WIDEST as f32)
    }

    fn apart(from: &Vec2, to: &Vec2) -> f64 {
        f64::from(to.x - from.x).hypot((to.y - from.y).into())
    }

    fn begin<'c>(
        &mut self,
        clients: impl Iterator<Item = (&'c ClientDesc<Vec2>, f64, &'c mut Self::Kept)>,
        tick: u64,
        options: &ServerOptions,
    ) -> Result<(), ServerError> {
        let mut all = BTreeSet::new();
        for (desc, reach, kept) in clients {
            let reached = self.ground().reached(desc.eye, reach + MARGIN, options.most_tiles);
            *kept = reached.map(|(tiles, _)| {
                tiles.into_iter().map(|tile| (tile, desc.radius.to_bits())).collect::<Vec<Key>>()
            });
            all.extend(kept.iter().flatten().copied());
        }
        self.sights.find(&self.map, &all, tick, options.memory)
    }

    fn place(&self, bounds: &Square, reach: f64) -> Self::Reached {
        self.ground().taken(bounds.center, bounds.half, reach + MARGIN, MOST_TAKEN)
    }

    fn look<'a>(&'a self, _: &Vec2, _: f64, kept: &'a mut Self::Kept) -> Self::Look<'a> {
        // Who may be in too many tiles sees all, and so does one whose view was not found.
        let windows: Vec<&Window> =
            kept.as_ref()?.iter().map(|key| self.sights.get(key)).collect::<Option<_>>()?;
        Some(Window::union(&windows))
    }

    fn may_see(look: &mut Self::Look<'_>, _: usize, place: &Self::Reached) -> bool {
        let (Some(seen), Some(tiles)) = (look, place) else { return true };
        tiles.iter().any(|tile| seen.has(*tile))
    }
}
