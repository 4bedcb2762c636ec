//! Clients and entities, as games describe them.

use casca::Aabb;
use casca::glam::Vec3;

use crate::error::{ServerError, within};
use crate::id::ClientId;
use crate::numeric::{FASTEST, LONGEST};

/// The team of clients and entities: a number of the game.
pub type Team = u32;

/// Describes a client: an eye that sees, and is told of entities. Lengths are metres in space, and
/// tiles on a map of tiles.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ClientDesc<E = Vec3> {
    /// Where its eye is.
    pub eye: E,
    /// The greatest speed of the eye, a second.
    pub speed: f32,
    /// The longest way of a message from the client to the server and of one back, with the time
    /// between two reports and that by which the client draws entities late, in seconds from 0 to
    /// 60.
    pub latency: f32,
    /// Its team: it is told of all entities of the team.
    pub team: Option<Team>,
    /// On a map of tiles: it sees those of which some point is nearer than that.
    pub(crate) radius: f32,
}

impl<E> ClientDesc<E> {
    /// A client that sees all around it, of no team.
    pub const fn new(eye: E, speed: f32, latency: f32) -> Self {
        Self { eye, speed, latency, team: None, radius: f32::INFINITY }
    }

    /// Sets [`ClientDesc::team`].
    #[must_use]
    pub const fn team(mut self, team: Team) -> Self {
        self.team = Some(team);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ServerError> {
        within("the speed of an eye, a second,", self.speed, 0.0, FASTEST)?;
        within("the latency of a client, in seconds,", self.latency, 0.0, LONGEST)?;
        within("the radius of a client, in tiles,", self.radius, f32::MIN_POSITIVE, f32::INFINITY)
    }
}

/// Describes an entity: a player, a vehicle, whatever a client may or may not be told of.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EntityDesc<B = Aabb> {
    /// Around all that can be seen of it: a box in space, in metres, or a square on a map of tiles.
    pub bounds: B,
    /// The greatest speed of any point of it: metres or tiles a second.
    pub speed: f32,
    /// The client that is always told of it.
    pub owner: Option<ClientId>,
    /// The team whose clients are always told of it; without one, that of the owner.
    pub team: Option<Team>,
}

impl<B> EntityDesc<B> {
    /// An entity that moves at so many metres or tiles a second at most.
    pub const fn new(bounds: B, speed: f32) -> Self {
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
