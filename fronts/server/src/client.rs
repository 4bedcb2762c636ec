//! Clients: eyes that see, and are told of entities.

use casca::glam::Vec3;

use crate::entity::Team;
use crate::error::{ServerError, place, within};
use crate::numeric::{FASTEST, LONGEST};
use crate::roster::Party;

/// Describes a client.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ClientDesc {
    /// Where its eye is.
    pub eye: Vec3,
    /// The greatest speed of the eye, in metres a second.
    pub speed: f32,
    /// The longest way of a message from the client to the server and of one back, with the time
    /// between two reports and that by which the client draws entities late, in seconds from 0 to
    /// 60.
    pub latency: f32,
    /// Its team: it is told of all entities of the team.
    pub team: Option<Team>,
}

impl ClientDesc {
    /// A client that sees all around it, of no team.
    pub const fn new(eye: Vec3, speed: f32, latency: f32) -> Self {
        Self { eye, speed, latency, team: None }
    }

    /// Sets [`ClientDesc::team`].
    #[must_use]
    pub const fn team(mut self, team: Team) -> Self {
        self.team = Some(team);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ServerError> {
        place("the eye of a client", self.eye)?;
        within("the speed of an eye, in m/s,", self.speed, 0.0, FASTEST)?;
        within("the latency of a client, in seconds,", self.latency, 0.0, LONGEST)
    }
}

impl Party for ClientDesc {
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
