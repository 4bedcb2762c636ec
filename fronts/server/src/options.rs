//! What can be chosen about a server.

use crate::error::{ServerError, within};
use crate::numeric::LONGEST;

/// What can be chosen about a [`VisibilityServer`](crate::VisibilityServer).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ServerOptions {
    /// The longest time from one tick to the next, in seconds from 0 to 60. Default: 1/30. If
    /// ticks are farther apart than this, entities may be told late.
    pub tick: f32,
    /// The eye of a client that reports nothing is taken to go on moving for this long, in seconds
    /// from 0 to 60. Then it counts as gone, and its answers are stale
    /// ([`Answer::is_stale`](crate::Answer::is_stale)). Default: 1.
    pub most_age: f32,
    /// Whether static occluders of the level stop eyes and entities. Only then does anything hide:
    /// the walls (rectangles across an axis) of those occluders. Set it to false where players fly
    /// through walls, where boxes of entities stick out into another room, and for meshes that hide
    /// from their front only. Default: true.
    pub walls: bool,
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
        Self { tick: 1.0 / 30.0, most_age: 1.0, walls: true, most_clients: 1000, most_entities: 10_000 }
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
