//! Who looks: from where, how far, and in which directions.

use glam::Vec2;

use crate::error::{Error, LEAST, finite2, within};
use crate::numeric::tiles::{DIRECTION, FARTHEST, SECTOR, TILE};

/// A position on a map, in tiles: tile `(x, y)` is the square from `(x, y)` to `(x + 1, y + 1)`.
///
/// A whole multiple of `2^-28` of a tile: numbers of single precision from 1/16 on are held
/// exactly, others are rounded to the nearest multiple. All that follows from a position is exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TilePoint {
    /// In units of 1 / [`TILE`], at most 2^60.
    units: [i64; 2],
}

impl TilePoint {
    /// A position. May lie outside of the map, on borders and corners of tiles, and in opaque
    /// tiles.
    ///
    /// # Errors
    /// A coordinate that is not finite, or whose magnitude exceeds `2^32` tiles.
    pub fn new(x: f64, y: f64) -> Result<Self, Error> {
        let units = |what, value| {
            within(what, value, [-FARTHEST, FARTHEST]).map(|v| (v * TILE as f64).round_ties_even() as i64)
        };
        Ok(Self { units: [units("the x of a position", x)?, units("the y of a position", y)?] })
    }

    /// The centre of a tile.
    pub fn center_of(x: u32, y: u32) -> Self {
        Self { units: [x, y].map(|at| i64::from(at) * TILE + TILE / 2) }
    }

    /// The coordinates in units of 1 / [`TILE`].
    pub(super) fn units(self) -> [i64; 2] {
        self.units
    }
}

/// How far and in which directions a viewer sees.
///
/// ```
/// use casca_plane::FovOptions;
/// use glam::Vec2;
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let guard = FovOptions::default().in_circle(12.0)?.in_sector(Vec2::X, 0.8)?;
/// # let _ = guard;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FovOptions {
    pub(super) range: Option<Range>,
    pub(super) sector: Option<Sector>,
}

impl FovOptions {
    /// Only tiles of which some point lies nearer to the eye than `radius` tiles. An infinite
    /// radius is no limit.
    ///
    /// # Errors
    /// A radius that is NaN, zero or negative.
    pub fn in_circle(self, radius: f32) -> Result<Self, Error> {
        Ok(Self { range: Range::new(radius)?, ..self })
    }

    /// Only directions that differ from `direction` by less than `half_angle`, in radians. An angle
    /// of pi or more is no limit. The sector is wider by 2e-9 radians at each side, to make up for
    /// rounding.
    ///
    /// # Errors
    /// A direction that is zero or not finite; an angle that is NaN, zero or negative.
    pub fn in_sector(self, direction: Vec2, half_angle: f32) -> Result<Self, Error> {
        Ok(Self { sector: Sector::new(direction, half_angle)?, ..self })
    }
}

/// A distance from the eye that no tile is as far away as.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    /// In units of positions, rounded up, at most 2^61.
    radius: i64,
}

impl Range {
    fn new(radius: f32) -> Result<Option<Self>, Error> {
        let units = (within("the range", radius.into(), [LEAST, f64::INFINITY])? * TILE as f64).ceil();
        Ok((units <= (1u64 << 61) as f64).then_some(Self { radius: units as i64 }))
    }

    /// The column after the last one of a row in which some point inside a tile is in range, right
    /// of an eye at `eye` units. `None` if the whole row is out of range. The row begins at the
    /// distance `ahead`, which is not negative.
    #[inline]
    pub fn end(self, eye: i64, ahead: i64) -> Option<i64> {
        if ahead >= self.radius {
            return None;
        }
        // Tiles from the eye's column on begin this far aside.
        let aside = |column: i64| column * TILE - eye;
        let own = eye.div_euclid(TILE);
        let square = |side: i64| i128::from(side) * i128::from(side);
        let rest = square(self.radius) - square(ahead);
        let in_range = |column: i64| column <= own || square(aside(column)) < rest;
        // Off by a column at most; then made exact.
        let mut end = ((eye as f64 + (rest as f64).sqrt()) / TILE as f64) as i64;
        while in_range(end) {
            end += 1;
        }
        while !in_range(end - 1) {
            end -= 1;
        }
        Some(end)
    }
}

/// The directions from one to another, counterclockwise (x to y), without these two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sector {
    /// Whole numbers of about [`DIRECTION`].
    pub from: [i64; 2],
    pub to: [i64; 2],
    /// Whether the angle between the two exceeds a half turn.
    wide: bool,
}

impl Sector {
    fn new(direction: Vec2, half_angle: f32) -> Result<Option<Self>, Error> {
        let what = "the direction of a sector";
        finite2(what, direction)?;
        let [x, y] = direction.as_dvec2().to_array();
        if direction == Vec2::ZERO {
            return Err(Error::NoDirection);
        }
        let half = within("the half angle of a sector", half_angle.into(), [LEAST, f64::INFINITY])? + SECTOR;
        if half >= std::f64::consts::PI - SECTOR {
            return Ok(None);
        }
        let middle = y.atan2(x);
        let whole = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            [cos, sin].map(|part| (part * DIRECTION).round() as i64)
        };
        let (from, to) = (whole(middle - half), whole(middle + half));
        Ok(Some(Self { from, to, wide: left(to, from) }))
    }

    /// Whether the sector holds a direction of numbers up to 2^32.
    pub fn holds(self, direction: [i64; 2]) -> bool {
        let (after, before) = (left(self.from, direction), left(direction, self.to));
        if self.wide { after || before } else { after && before }
    }
}

/// Whether a direction lies less than a half turn counterclockwise of another.
fn left(of: [i64; 2], direction: [i64; 2]) -> bool {
    i128::from(of[0]) * i128::from(direction[1]) > i128::from(of[1]) * i128::from(direction[0])
}
