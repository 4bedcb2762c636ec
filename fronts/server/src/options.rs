//! What can be chosen about a server.

use casca::PointOptions;

use crate::error::{ServerError, within};
use crate::numeric::LONGEST;

/// What can be chosen about a [`VisibilityServer`](crate::VisibilityServer).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ServerOptions {
    /// The longest time from one tick to the next, in seconds from 0 to 60. Default: 1/30. If
    /// ticks are farther apart than this, entities may be told late.
    pub tick: f32,
    /// A client's level is looked at again when its eye used up this room, as a share of its reach,
    /// from 0 to 10. Default: 0.5. More room costs fewer queries, and tells more entities early.
    pub room: f32,
    /// The eye of a client that reports nothing is taken to go on moving for so long, in seconds
    /// from 0 to 60; then it counts as gone, and [`Answer::is_stale`](crate::Answer::is_stale).
    /// Default: 1.
    pub most_age: f32,
    /// Whether eyes and entities keep out of the static occluders of the level, and never pass
    /// through them. Then walls, rectangles across an axis, hide and stop them: far more is
    /// withheld. Set it to false where players fly through walls, where boxes of entities stick out
    /// into another room, and for meshes that hide from their front only. Default: true.
    pub walls: bool,
    /// The most queries of the level in a tick, for what walls do not decide: occluders that are
    /// round or turned, several that hide together, doors. Clients whose result does not hold any
    /// more wait for their turn, the longest first, and are told of more meanwhile: this bounds the
    /// time of a tick, and tells nothing late. A query takes from half a millisecond to some tens
    /// of them, and a client a megabyte or more. Default: 0, so that walls decide alone.
    pub most_queries: usize,
    /// How the level is looked at. Default: pixels of 0.5 degrees, and nothing is examined again.
    pub point: PointOptions,
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
            room: 0.5,
            most_age: 1.0,
            walls: true,
            most_queries: 0,
            point: PointOptions::fast().pixel_degrees(0.5),
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

    /// Sets [`ServerOptions::room`], as a share of the reach.
    #[must_use]
    pub const fn room(mut self, share: f32) -> Self {
        self.room = share;
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

    /// Sets [`ServerOptions::most_queries`].
    #[must_use]
    pub const fn most_queries(mut self, most: usize) -> Self {
        self.most_queries = most;
        self
    }

    /// Sets [`ServerOptions::point`].
    #[must_use]
    pub const fn point(mut self, options: PointOptions) -> Self {
        self.point = options;
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
        within("the room of an eye, as a share of its reach,", self.room, 0.0, 10.0)?;
        within("the greatest age of a report, in seconds,", self.most_age, 0.0, LONGEST)
    }
}
