//! The reasons for which calls are refused: every refusal says which argument and why.

use std::fmt;

use glam::{UVec2, Vec2};

use crate::id::ObjectId;

/// Why a call was refused. The scene or query is left as it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number that must be finite is not.
    #[error("{what} must be finite, not {}", Short(*value))]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// Its value, or the first component that is not finite.
        value: f64,
    },
    /// A rectangle whose least corner lies beyond its greatest.
    #[error("{what} must not be inverted: the corner {min} must lie below the corner {max} on both axes")]
    InvertedRect {
        /// The argument.
        what: &'static str,
        /// Its least corner.
        min: Vec2,
        /// Its greatest corner.
        max: Vec2,
    },
    /// A direction without length.
    #[error("the direction must not be zero")]
    NoDirection,
    /// Points whose hull has no area.
    #[error("the convex polygon has no area: its {points} points lie on a line")]
    FlatPolygon {
        /// How many points were given.
        points: usize,
    },
    /// A polyline needs two points at least.
    #[error("a polyline needs 2 points or more, not {points}")]
    ShortPolyline {
        /// How many points were given.
        points: usize,
    },
    /// The grid lies so far from the origin that its cells cannot be told apart.
    #[error(
        "a grid at {min} with cells of {cell} is too far from the origin: its lines are not exact numbers"
    )]
    GridTooFar {
        /// The least corner asked for.
        min: Vec2,
        /// The cell size asked for.
        cell: f32,
    },
    /// The id belongs to no object of this scene.
    #[error("{0} is not an object of this scene: it was removed, or belongs to another scene")]
    UnknownObject(ObjectId),
    /// The scene holds as many objects as ids can name.
    #[error("the scene is full: it already holds {0} objects")]
    SceneFull(usize),
    /// An occluder that sticks out of its bounds: it would hide more than the object does.
    #[error("the occluder sticks out of the rectangle around its bounds by {} world units", Short(*by))]
    OccluderOutside {
        /// By how much along an axis, in world units.
        by: f64,
    },
    /// An update without occluder of an object that has one.
    #[error("{0} has an occluder: update it with the occluder, or take that away by Scene::set_occluder")]
    OccluderMissing(ObjectId),
    /// A grid of other dimensions than those of the map: columns and rows.
    #[error("the tiles are {} by {}, but those of the map {} by {}", found.x, found.y, map.x, map.y)]
    Dimensions {
        /// Those of the grid.
        found: UVec2,
        /// Those of the map.
        map: UVec2,
    },
    /// A tile that the grid does not have.
    #[error("the tile ({}, {}) lies outside of the grid of {} by {} tiles", tile.x, tile.y, size.x, size.y)]
    Outside {
        /// Its column and row.
        tile: UVec2,
        /// The columns and rows of the grid.
        size: UVec2,
    },
    /// A number is out of its range.
    #[error("{what} must lie between {} and {}, not {}", Short(*min), Short(*max), Short(*value))]
    Range {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The least value.
        min: f64,
        /// The greatest value.
        max: f64,
    },
}

/// A number as short as it can be told from its neighbours: most were given in single precision.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The form for debugging has exponents where there would be many zeros.
        let single = self.0 as f32;
        if f64::from(single) == self.0 { write!(f, "{single:?}") } else { write!(f, "{:?}", self.0) }
    }
}

/// Refuses a vector with a component that is not finite.
pub(crate) fn finite2(what: &'static str, v: Vec2) -> Result<(), Error> {
    match v.to_array().into_iter().find(|c| !c.is_finite()) {
        Some(value) => Err(Error::NotFinite { what, value: value.into() }),
        None => Ok(()),
    }
}

/// The least number of single precision above zero.
pub(crate) const LEAST: f64 = f32::from_bits(1) as f64;

/// Refuses a number that does not lie between two, or is none.
pub(crate) fn within(what: &'static str, value: f64, [min, max]: [f64; 2]) -> Result<f64, Error> {
    if (min..=max).contains(&value) { Ok(value) } else { Err(Error::Range { what, value, min, max }) }
}
