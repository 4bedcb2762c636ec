//! What can be chosen about a server.

use crate::error::{ServerError, within};
use crate::numeric::LONGEST;

/// What can be chosen about a [`Server`](crate::Server).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ServerOptions {
    /// The longest time from one tick to the next, in seconds from 0 to 60. Default: 1/30. If
    /// ticks are farther apart than this, entities may be told late.
    pub tick: f32,
    /// The eye of a client that reports nothing is taken to go on moving for so long, in seconds
    /// from 0 to 60; then it counts as gone, and [`Answer::is_stale`](crate::Answer::is_stale).
    /// Default: 1.
    pub most_age: f32,
    /// Whether solid things stop eyes and entities.
    ///
    /// In space, these are the static occluders of the level, and walls, rectangles across an axis,
    /// hide what is behind them. Set it to false where players fly through walls, where boxes of
    /// entities stick out into another room, and for meshes that hide from their front only: then
    /// nothing hides. On a map, these are the opaque tiles, but not for eyes and entities that are
    /// in one. Set it to false where they walk through bushes: tiles still hide. Default: true.
    pub walls: bool,
    /// On a map, a client whose eye may be in more tiles than that is told of all. Default: 256.
    pub most_tiles: usize,
    /// On a map, bytes of fields of view that are kept from tick to tick. Those of one tick are
    /// kept in any case. Default: 64 MiB.
    pub memory: usize,
    /// Whether clients of a team are told of what any of them is told of. Default: false.
    pub teams_share: bool,
    /// The most clients. Default: 1,000.
    pub most_clients: usize,
    /// The most entities. Default: 10,000.
    pub most_entities: usize,
}

impl Default for ServerOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl ServerOptions {
    /// The default options.
    pub const fn new() -> Self {
        Self {
            tick: 1.0 / 30.0,
            most_age: 1.0,
            walls: true,
            most_tiles: 256,
            memory: 64 << 20,
            teams_share: false,
            most_clients: 1000,
            most_entities: 10_000,
        }
    }

    /// Sets [`ServerOptions::tick`], in seconds.
    #[must_use]
    pub const fn tick(mut self, seconds: f32) -> Self {
        self.tick = seconds;
        self
    }

    /// Sets [`ServerOptions::most_age`], in seconds.
    #[must_use]
    pub const fn most_age(mut self, seconds: f32) -> Self {
        self.most_age = seconds;
        self
    }

    /// Sets [`ServerOptions::walls`].
    #[must_use]
    pub const fn walls(mut self, keep_out: bool) -> Self {
        self.walls = keep_out;
        self
    }

    /// Sets [`ServerOptions::most_tiles`].
    #[must_use]
    pub const fn most_tiles(mut self, most: usize) -> Self {
        self.most_tiles = most;
        self
    }

    /// Sets [`ServerOptions::memory`].
    #[must_use]
    pub const fn memory(mut self, bytes: usize) -> Self {
        self.memory = bytes;
        self
    }

    /// Sets [`ServerOptions::teams_share`].
    #[must_use]
    pub const fn teams_share(mut self, share: bool) -> Self {
        self.teams_share = share;
        self
    }

    /// Sets [`ServerOptions::most_clients`] and [`ServerOptions::most_entities`].
    #[must_use]
    pub const fn most(mut self, clients: usize, entities: usize) -> Self {
        (self.most_clients, self.most_entities) = (clients, entities);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ServerError> {
        within("the time from tick to tick, in seconds,", self.tick, 0.0, LONGEST)?;
        within("the greatest age of a report, in seconds,", self.most_age, 0.0, LONGEST)
    }
}
