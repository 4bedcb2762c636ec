//! Clients and entities, as games describe them.

use casca::Aabb;
use casca::glam::Vec3;

use crate::error::{ServerError, within};
use crate::id::ClientId;
use crate::numeric::{FASTEST, LONGEST};

/// The team of clients and entities: a number of the game.
pub type Team = u32;

/// Describes a client: an eye that sees, and is told of entities.
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
    /// A client of no team.
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
        within("the speed of an eye, a second,", self.speed, 0.0, FASTEST)?;
        within("the latency of a client, in seconds,", self.latency, 0.0, LONGEST)
    }
}

/// Describes an entity: a player, a vehicle, whatever a client may or may not be told of.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EntityDesc {
    /// Around all that can be seen of it, in metres.
    pub bounds: Aabb,
    /// The greatest speed of any point of it, in metres a second.
    pub speed: f32,
    /// The client that is always told of it.
    pub owner: Option<ClientId>,
    /// The team whose clients are always told of it; without one, that of the owner.
    pub team: Option<Team>,
}

impl EntityDesc {
    /// An entity that moves at so many metres a second at most.
    pub const fn new(bounds: Aabb, speed: f32) -> Self {
        Self { bounds, speed, owner: None, team: None }
    }

    /// Sets [`EntityDesc::owner`].
    #[must_use]
    pub const fn owner(mut self, owner: ClientId) -> Self {
        self.owner = Some(owner);
        self
    }

    /// Sets [`EntityDesc::team`].
    #[must_use]
    pub const fn team(mut self, team: Team) -> Self {
        self.team = Some(team);
        self
    }
}
