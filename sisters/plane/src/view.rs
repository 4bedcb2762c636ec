//! The view: an eye, and the part of the plane that it sees.

use std::f64::consts::PI;

use glam::{DVec2, Vec2};

use crate::error::{Error, LEAST, finite2, within};
use crate::geometry::{Block, point_along};
use crate::numeric::{DISTANCE, TILT, WHOLE};

/// The part of the plane that an eye looks at: all of it, or a sector; as far as a range, if one is
/// given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    eye: DVec2,
    /// The direction of a view that does not look all round, of length 1, and the half angle around
    /// it in radians, less than half a turn.
    sector: Option<(DVec2, f64)>,
    range: Option<f64>,
}

impl View {
    /// A view in all directions.
    ///
    /// # Errors
    /// Refuses an eye that is not finite.
    pub fn all_round(eye: Vec2) -> Result<Self, Error> {
        finite2("the eye", eye)?;
        Ok(Self { eye: eye.as_dvec2(), sector: None, range: None })
    }

    /// A view in the directions that make an angle of `half_angle` radians at most with
    /// `direction`, which may have any length. From half a turn on (π) it looks all round.
    ///
    /// Its sides are moved outwards by their rounding: by 5e-12 radians at most.
    ///
    /// # Errors
    /// Refuses an eye or a direction that is not finite, a direction of length 0, and a half angle
    /// that is not between 0 and π.
    pub fn sector(eye: Vec2, direction: Vec2, half_angle: f32) -> Result<Self, Error> {
        let view = Self::all_round(eye)?;
        finite2("the direction", direction)?;
        let direction = direction.as_dvec2().try_normalize().ok_or(Error::NoDirection)?;
        let half_angle = f64::from(half_angle);
        // The nearest number to π in single precision lies above it.
        let most = f64::from(std::f32::consts::PI);
        within("the half angle in radians", half_angle, [0.0, most])?;
        let whole = half_angle + WHOLE >= PI;
        Ok(Self { sector: (!whole).then_some((direction, half_angle)), ..view })
    }

    /// The same view as far as `range` world units from the eye, the circle included.
    ///
    /// # Errors
    /// Refuses a range that is not a positive number.
    pub fn with_range(self, range: f32) -> Result<Self, Error> {
        let range = within("the range", range.into(), [LEAST, f32::MAX.into()])?;
        Ok(Self { range: Some(range), ..self })
    }

    /// The eye in world units.
    pub fn eye(&self) -> DVec2 {
        self.eye
    }

    /// The direction of a sector, of length 1; `None` for a view all round.
    pub fn direction(&self) -> Option<DVec2> {
        self.sector.map(|(direction, _)| direction)
    }

    /// The half angle of a sector in radians; half a turn for a view all round.
    pub fn half_angle(&self) -> f64 {
        self.sector.map_or(PI, |(_, half_angle)| half_angle)
    }

    /// How far the view goes from the eye, in world units, if it ends.
    pub fn range(&self) -> Option<f64> {
        self.range
    }

    /// Whether something in a block may lie within the range.
    pub(crate) fn reaches(&self, block: &Block) -> bool {
        let off = (self.eye.clamp(block.min, block.max) - self.eye).abs();
        self.range.is_none_or(|range| off.max_element() <= range * (1.0 + DISTANCE))
    }

    /// Points on the two sides of a sector, the first and the last counterclockwise; the directions
    /// to these points are the sides, exactly.
    pub(crate) fn sides(&self) -> Option<[DVec2; 2]> {
        let (direction, half_angle) = self.sector?;
        let angle = half_angle + TILT;
        Some([-angle, angle].map(|angle| point_along(self.eye, DVec2::from_angle(angle).rotate(direction))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::orient;

    #[test]
    fn sides_lie_outside_by_little() {
        for (x, y) in [(0.0, 0.0), (1000.3, -7.7), (1e30, 1e-30), (-3e-45, 5e6)] {
            for i in 0..64 {
                let angle = f64::from(i) * 0.1;
                let direction = DVec2::from_angle(angle).as_vec2();
                for half in [0.0, 1e-6, 0.5, 1.5, 3.0] {
                    let view = View::sector(Vec2::new(x, y), direction, half).unwrap();
                    let [first, last] = view.sides().unwrap().map(|p| p - view.eye());
                    let angle = direction.as_dvec2().to_angle();
                    let off = |side: DVec2, angle: f64| {
                        (side.to_angle() - angle + 3.0 * PI).rem_euclid(2.0 * PI) - PI
                    };
                    let (low, high) =
                        (off(first, angle - f64::from(half)), off(last, angle + f64::from(half)));
                    assert!(low < -1e-12 && low > -5e-12, "{low}");
                    assert!(high > 1e-12 && high < 5e-12, "{high}");
                }
                assert!(View::sector(Vec2::ZERO, direction, std::f32::consts::PI).unwrap().sides().is_none());
            }
        }
        let [first, last] = View::sector(Vec2::ONE, Vec2::X, 0.0).unwrap().sides().unwrap();
        assert!(orient(DVec2::ONE, first, last) > 0.0);
    }

    #[test]
    fn refuses_what_is_no_view() {
        assert!(matches!(View::all_round(Vec2::NAN), Err(Error::NotFinite { .. })));
        assert!(matches!(View::sector(Vec2::ZERO, Vec2::ZERO, 1.0), Err(Error::NoDirection)));
        for half in [-0.1, 3.2, f32::NAN] {
            assert!(matches!(View::sector(Vec2::ZERO, Vec2::X, half), Err(Error::Range { .. })), "{half}");
        }
        for range in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let view = View::all_round(Vec2::ZERO).unwrap();
            assert!(matches!(view.with_range(range), Err(Error::Range { .. })), "{range}");
        }
    }
}
