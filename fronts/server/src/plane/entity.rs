//! Entities on a map of tiles.

use casca::glam::Vec2;

use crate::entity::Team;
use crate::error::{ServerError, within};
use crate::id::ClientId;
use crate::numeric::FASTEST;
use crate::plane::options::{MARGIN, WIDEST};
use crate::roster::{Entity, Thing};

/// Describes an entity of a [`PlaneServer`](crate::plane::PlaneServer).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PlaneEntity {
    /// Where its centre is, in tiles.
    pub place: Vec2,
    /// The greatest speed, in tiles a second.
    pub speed: f32,
    /// Half the side of a square that holds all that can be seen of it, in tiles. Default: 0, a
    /// point.
    pub half: f32,
    /// The client that is always told of it.
    pub owner: Option<ClientId>,
    /// The team whose clients are always told of it; without one, that of the owner.
    pub team: Option<Team>,
}

impl PlaneEntity {
    /// A point that moves at so many tiles a second at most.
    pub const fn new(place: Vec2, speed: f32) -> Self {
        Self { place, speed, half: 0.0, owner: None, team: None }
    }

    /// Sets [`PlaneEntity::half`].
    #[must_use]
    pub const fn half(mut self, tiles: f32) -> Self {
        self.half = tiles;
        self
    }

    /// Sets [`PlaneEntity::owner`].
    #[must_use]
    pub const fn owner(mut self, owner: ClientId) -> Self {
        self.owner = Some(owner);
        self
    }

    /// Sets [`PlaneEntity::team`].
    #[must_use]
    pub const fn team(mut self, team: Team) -> Self {
        self.team = Some(team);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ServerError> {
        within("the speed of an entity, in tiles a second,", self.speed, 0.0, FASTEST)?;
        within("half the side of an entity, in tiles,", self.half, 0.0, WIDEST as f32)
    }
}

impl Thing for PlaneEntity {
    fn owner(&mut self) -> &mut Option<ClientId> {
        &mut self.owner
    }

    fn team(&self) -> Option<Team> {
        self.team
    }
}

/// An entity of a map, with its last report.
pub(crate) type PlaneBody = Entity<PlaneEntity, ()>;

impl PlaneBody {
    /// How far its centre may be from its place within `seconds` of the time `now`, in tiles.
    pub(crate) fn reach(&self, now: f64, seconds: f64) -> f64 {
        f64::from(self.desc.speed) * (seconds + (now - self.time).max(0.0)) + MARGIN
    }
}
