//! What can be chosen about a server of tiles.

use crate::error::{ServerError, within};
use crate::numeric::LONGEST;

/// Maps are at most so wide and high, in tiles: beyond, single precision tells places in a tile
/// apart by a sixteenth of it.
pub(crate) const WIDEST: u32 = 1 << 20;

/// Reaches are longer by this, in tiles: sums of double precision on the widest map are off by
/// less than 2^-30, and positions of casca-plane are rounded to 2^-28.
pub(crate) const MARGIN: f64 = 1e-6;

/// What can be chosen about a [`PlaneServer`](crate::plane::PlaneServer).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PlaneOptions {
    /// The longest time from one tick to the next, in seconds, above 0. Default: 1/30.
    pub tick: f32,
    /// An eye of which no report came for so long is taken to have stopped, in seconds. Default: 1.
    pub most_age: f32,
    /// Whether opaque tiles stop eyes and entities that are not in one. If they walk through
    /// bushes, choose false. Default: true.
    pub walls_stop: bool,
    /// A client whose eye may be in more tiles than that is told of all. Default: 256.
    pub most_tiles: usize,
    /// Bytes of fields of view that are kept from tick to tick. Those of one tick are kept in any
    /// case. Default: 64 MiB.
    pub memory: usize,
    /// Whether each client is told of what any client of its team is told of. Default: false.
    pub teams_share: bool,
    /// The most clients. Default: 1,000.
    pub most_clients: usize,
    /// The most entities. Default: 10,000.
    pub most_entities: usize,
}

impl PlaneOptions {
    /// The default options.
    pub const fn new() -> Self {
        Self {
            tick: 1.0 / 30.0,
            most_age: 1.0,
            walls_stop: true,
            most_tiles: 256,
            memory: 64 << 20,
            teams_share: false,
            most_clients: 1000,
            most_entities: 10_000,
        }
    }

    /// Sets [`PlaneOptions::tick`].
    #[must_use]
    pub const fn tick(mut self, seconds: f32) -> Self {
        self.tick = seconds;
        self
    }

    /// Sets [`PlaneOptions::most_age`].
    #[must_use]
    pub const fn most_age(mut self, seconds: f32) -> Self {
        self.most_age = seconds;
        self
    }

    /// Sets [`PlaneOptions::walls_stop`].
    #[must_use]
    pub const fn walls_stop(mut self, stop: bool) -> Self {
        self.walls_stop = stop;
        self
    }

    /// Sets [`PlaneOptions::most_tiles`].
    #[must_use]
    pub const fn most_tiles(mut self, most: usize) -> Self {
        self.most_tiles = most;
        self
    }

    /// Sets [`PlaneOptions::memory`].
    #[must_use]
    pub const fn memory(mut self, bytes: usize) -> Self {
        self.memory = bytes;
        self
    }

    /// Sets [`PlaneOptions::teams_share`].
    #[must_use]
    pub const fn teams_share(mut self, share: bool) -> Self {
        self.teams_share = share;
        self
    }

    /// Sets [`PlaneOptions::most_clients`] and [`PlaneOptions::most_entities`].
    #[must_use]
    pub const fn most(mut self, clients: usize, entities: usize) -> Self {
        (self.most_clients, self.most_entities) = (clients, entities);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ServerError> {
        within("the time of a tick, in seconds,", self.tick, f32::MIN_POSITIVE, LONGEST)?;
        within("the greatest age of a report, in seconds,", self.most_age, 0.0, LONGEST)
    }
}

impl Default for PlaneOptions {
    fn default() -> Self {
        Self::new()
    }
}
