//! Clients on a map of tiles.

use casca::glam::Vec2;

use crate::entity::Team;
use crate::error::{ServerError, within};
use crate::numeric::{FASTEST, LONGEST};
use crate::plane::options::{MARGIN, PlaneOptions};
use crate::roster::{Client, Party};

/// Describes a client of a [`PlaneServer`](crate::plane::PlaneServer).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PlaneClient {
    /// Where its eye is, in tiles.
    pub eye: Vec2,
    /// The greatest speed of the eye, in tiles a second.
    pub speed: f32,
    /// The longest way of a message from the client to the server and of one back, with the time
    /// between two reports and that by which the client draws entities late, in seconds from 0 to
    /// 60.
    pub latency: f32,
    /// It sees tiles of which some point is nearer than that, in tiles, above 0. Infinite if there
    /// is no limit.
    pub radius: f32,
    /// Its team: it is told of all entities of the team.
    pub team: Option<Team>,
}

impl PlaneClient {
    /// A client that sees as far as walls let it, of no team.
    pub const fn new(eye: Vec2, speed: f32, latency: f32) -> Self {
        Self { eye, speed, latency, radius: f32::INFINITY, team: None }
    }

    /// Sets [`PlaneClient::radius`].
    #[must_use]
    pub const fn radius(mut self, tiles: f32) -> Self {
        self.radius = tiles;
        self
    }

    /// Sets [`PlaneClient::team`].
    #[must_use]
    pub const fn team(mut self, team: Team) -> Self {
        self.team = Some(team);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ServerError> {
        within("the speed of an eye, in tiles a second,", self.speed, 0.0, FASTEST)?;
        within("the latency of a client, in seconds,", self.latency, 0.0, LONGEST)?;
        within("the radius of a client, in tiles,", self.radius, f32::MIN_POSITIVE, f32::INFINITY)
    }
}

impl Party for PlaneClient {
    fn speed(&self) -> f32 {
        self.speed
    }

    fn latency(&self) -> f32 {
        self.latency
    }

    fn team(&self) -> Option<Team> {
        self.team
    }
}

/// A client of a map, with its last report and answer.
pub(crate) type PlaneState = Client<PlaneClient, ()>;

impl PlaneState {
    /// How far the eye may be from where it was reported, in tiles.
    pub(crate) fn reach(&self, now: f64, options: &PlaneOptions) -> f64 {
        let (seconds, _) = self.time_ahead(now, options.tick, options.most_age);
        f64::from(self.desc.speed) * seconds + MARGIN
    }
}
