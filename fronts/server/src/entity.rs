//! Entities: players, vehicles, doors, whatever a client may or may not be told of.

use casca::{Aabb, Occluder};
use casca_walls::Span;

use crate::error::{ServerError, place, within};
use crate::id::ClientId;
use crate::numeric::{EVERYWHERE, FASTEST, ROUNDING, at_least, at_most};

/// The team of clients and entities: a number of the game.
pub type Team = u32;

/// Describes an entity.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct EntityDesc {
    /// A box around all that can be seen of it, in world units.
    pub bounds: Aabb,
    /// The greatest speed of any point of it, in metres a second.
    pub speed: f32,
    /// Hides what is behind it, as a door does. Only entities without speed may.
    pub occluder: Option<Occluder>,
    /// The client that is always told of it.
    pub owner: Option<ClientId>,
    /// The team whose clients are always told of it; without one, that of the owner.
    pub team: Option<Team>,
}

impl EntityDesc {
    /// An entity in a box that moves at so many metres a second at most, and hides nothing.
    pub const fn new(bounds: Aabb, speed: f32) -> Self {
        Self { bounds, speed, occluder: None, owner: None, team: None }
    }

    /// Sets [`EntityDesc::occluder`].
    #[must_use]
    pub fn occluder(mut self, occluder: impl Into<Occluder>) -> Self {
        self.occluder = Some(occluder.into());
        self
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

    pub(crate) fn check(&self) -> Result<(), ServerError> {
        check_box(&self.bounds)?;
        within("the speed of an entity, in m/s,", self.speed, 0.0, FASTEST)?;
        if self.occluder.is_some() && self.speed > 0.0 {
            return Err(ServerError::MovingOccluder(self.speed));
        }
        Ok(())
    }
}

pub(crate) fn check_box(b: &Aabb) -> Result<(), ServerError> {
    place("the bounds of an entity", b.min)?;
    place("the bounds of an entity", b.max)?;
    if b.min.cmple(b.max).all() { Ok(()) } else { Err(ServerError::Inverted("the bounds of an entity")) }
}

/// A box in double precision.
pub(crate) fn span_of(b: &Aabb) -> Span {
    Span { min: b.min.as_dvec3(), max: b.max.as_dvec3() }
}

/// A box grown by a length in all directions, rounded outwards, up to [`EVERYWHERE`].
pub(crate) fn grown(b: &Aabb, by: f64) -> Aabb {
    if by == 0.0 {
        return *b;
    }
    let by = by * (1.0 + ROUNDING);
    let (min, max) = (b.min.as_dvec3() - by, b.max.as_dvec3() + by);
    let min = min.to_array().map(|v| at_most(v).max(-EVERYWHERE));
    let max = max.to_array().map(|v| at_least(v).min(EVERYWHERE));
    Aabb::new(min.into(), max.into())
}

#[cfg(test)]
mod tests {
    use casca::glam::Vec3;

    use super::*;

    #[test]
    fn boxes_grow_outwards() {
        let b = Aabb::new(Vec3::splat(1.0), Vec3::splat(2.0));
        assert_eq!(grown(&b, 0.0), b);
        for by in [1e-9, 0.1, 3.0, 1e7] {
            let g = grown(&b, by);
            assert!(f64::from(g.min.x) <= 1.0 - by && f64::from(g.max.z) >= 2.0 + by, "{by}");
        }
    }
}
