//! Clients on a map of tiles.

use casca::glam::Vec2;

use crate::answer::Answer;
use crate::entity::Team;
use crate::error::{ServerError, within};
use crate::id::{ClientId, EntityId};
use crate::numeric::{FASTEST, LONGEST};
use crate::plane::numeric::MARGIN;
use crate::plane::options::PlaneOptions;

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

/// A client as a server knows it.
#[derive(Debug, Clone)]
pub(crate) struct PlaneState {
    pub(crate) desc: PlaneClient,
    /// When its last report came.
    pub(crate) time: f64,
    /// Whether the eye jumped since the last tick.
    pub(crate) jumped: bool,
    /// What it was told of in the tick before.
    pub(crate) before: Vec<EntityId>,
    pub(crate) answer: Answer,
}

impl PlaneState {
    pub(crate) fn new(id: ClientId, desc: PlaneClient, time: f64) -> Self {
        Self { desc, time, jumped: true, before: Vec::new(), answer: Answer::new(id) }
    }

    /// For how long the eye and all entities may move until the next answer counts, in seconds; and
    /// whether the last report is too old.
    pub(crate) fn time_ahead(&self, now: f64, options: &PlaneOptions) -> (f64, bool) {
        let (age, most) = ((now - self.time).max(0.0), f64::from(options.most_age));
        (f64::from(self.desc.latency) + f64::from(options.tick) + age.min(most), age > most)
    }

    /// How far the eye may be from where it was reported, in tiles.
    pub(crate) fn reach(&self, now: f64, options: &PlaneOptions) -> f64 {
        f64::from(self.desc.speed) * self.time_ahead(now, options).0 + MARGIN
    }
}
