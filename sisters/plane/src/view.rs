//! The view: an eye, and the part of the plane that it sees.

use std::f64::consts::PI;

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2, not_negative};
use crate::geometry::point_along;
use crate::numeric::{DISTANCE, REACH, TILT, WHOLE};

/// Sectors of eyes within a reach are as if their half angle were this at least, in radians: else
/// the eye that holds them all lies far away. Those as near to half a turn bound nothing.
const LEAST_GATE: f64 = 0.125;

/// The part of the plane that an eye looks at: all of it, or a sector; as far as a range, if one is
/// given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    eye: DVec2,
    sector: Option<Sector>,
    range: Option<f64>,
    reach: f64,
    layers: u64,
}

/// The directions of a view that does not look all round.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sector {
    /// Of length 1.
    direction: DVec2,
    /// In radians, less than half a turn.
    half_angle: f64,
}

impl View {
    /// A view in all directions.
    ///
    /// # Errors
    /// Refuses an eye that is not finite.
    pub fn all_round(eye: Vec2) -> Result<Self, Error> {
        finite2("the eye", eye)?;
        Ok(Self { eye: eye.as_dvec2(), sector: None, range: None, reach: 0.0, layers: u64::MAX })
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
        let direction = direction.as_dvec2().try_normalize();
        let direction = direction.ok_or(Error::NoDirection { what: "the direction" })?;
        let half_angle = f64::from(half_angle);
        // The nearest number to π in single precision lies above it.
        let most = f64::from(std::f32::consts::PI);
        if !(0.0..=most).contains(&half_angle) {
            let what = "the half angle in radians";
            return Err(Error::Setting { what, value: half_angle, min: 0.0, max: most });
        }
        let whole = half_angle + WHOLE >= PI;
        Ok(Self { sector: (!whole).then_some(Sector { direction, half_angle }), ..view })
    }

    /// The same view as far as `range` world units from the eye, the circle included.
    ///
    /// # Errors
    /// Refuses a range that is not a positive number.
    pub fn with_range(self, range: f32) -> Result<Self, Error> {
        if !(range.is_finite() && range > 0.0) {
            let (what, max) = ("the range", f32::MAX.into());
            return Err(Error::Setting { what, value: range.into(), min: f32::MIN_POSITIVE.into(), max });
        }
        Ok(Self { range: Some(range.into()), ..self })
    }

    /// The same view for an eye that may go up to `reach` world units from its place, in any
    /// direction and without turning: the result of a query has all that it can see from anywhere
    /// there. It holds for many frames ([`Pvs::is_valid_for`](crate::Pvs::is_valid_for)), or for a
    /// client whose eye is known with delay.
    ///
    /// A sector and a range go along with the eye. Occluders hide less at their ends, as far as one
    /// of these eyes sees past them: far behind, their shadow is narrower by the reach on either
    /// side. Those within reach hide nothing. Walls whose ends lie on or in others hide as one, and
    /// so do tiles that share a border. Objects are tested as they are. [`Query::polygon`] and the
    /// like then are about a region that holds what any of these eyes sees.
    ///
    /// Costs a query in all directions, with the walls at the ends of walls looked up in the grid.
    /// [`Method::Cell`] takes each cell within the reach as an eye's, and costs a query for each;
    /// from more than 16 cells it hides nothing. 0 is the view as it was.
    ///
    /// ```
    /// use casca_plane::{Disc, GridSpec, ObjectDesc, Query, Scene, Segment, View};
    /// use glam::{UVec2, Vec2};
    ///
    /// # fn main() -> Result<(), casca_plane::Error> {
    /// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(16) })?;
    /// let wall = Segment::new(Vec2::new(2.0, 6.0), Vec2::new(8.0, 6.0));
    /// scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
    /// let behind = scene.insert(ObjectDesc::fixed(Disc::new(Vec2::new(5.0, 9.0), 0.5)))?;
    /// let beside = scene.insert(ObjectDesc::fixed(Disc::new(Vec2::new(10.5, 10.5), 0.4)))?;
    /// let (view, mut query) = (View::all_round(Vec2::new(5.0, 2.0))?, Query::new());
    /// assert!(!query.run(&scene, &view).contains(beside));
    /// let kept = query.run(&scene, &view.with_reach(1.0)?).clone();
    /// // From a step to the right, the eye sees past the end of the wall.
    /// let step = View::all_round(Vec2::new(5.9, 2.0))?;
    /// assert!(query.run(&scene, &step).contains(beside));
    /// assert!(kept.contains(beside) && !kept.contains(behind));
    /// assert!(kept.is_valid_for(&scene, &step));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// [`Query::polygon`]: crate::Query::polygon
    /// [`Method::Cell`]: crate::Method::Cell
    ///
    /// # Errors
    /// Refuses a reach that is negative or not finite.
    pub fn with_reach(self, reach: f32) -> Result<Self, Error> {
        not_negative("the reach", reach)?;
        Ok(Self { reach: reach.into(), ..self })
    }

    /// How far the eye may go from its place, in world units: see [`View::with_reach`].
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The same view of the objects that share a layer with it, a bit for each layer; without this
    /// it shows all but those on no layer. Only objects that it shows hide others in it.
    ///
    /// ```
    /// use casca_plane::{Disc, GridSpec, ObjectDesc, Query, Scene, View};
    /// use glam::{UVec2, Vec2};
    ///
    /// # fn main() -> Result<(), casca_plane::Error> {
    /// const WORLD: u64 = 1;
    /// const GHOSTS: u64 = 2;
    /// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(16) })?;
    /// let disc = Disc::new(Vec2::splat(9.5), 1.0);
    /// let guard = scene.insert(ObjectDesc::dynamic(disc).layers(WORLD))?;
    /// let ghost = scene.insert(ObjectDesc::dynamic(disc).layers(GHOSTS))?;
    /// let (view, mut query) = (View::all_round(Vec2::splat(2.5))?, Query::new());
    /// assert_eq!(query.run(&scene, &view.with_layers(WORLD)).visible(), [guard]);
    /// assert_eq!(query.run(&scene, &view.with_layers(GHOSTS)).visible(), [ghost]);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_layers(self, mask: u64) -> Self {
        Self { layers: mask, ..self }
    }

    /// The layers that it shows, a bit for each: see [`View::with_layers`].
    pub fn layers(&self) -> u64 {
        self.layers
    }

    /// The eye in world units.
    pub fn eye(&self) -> DVec2 {
        self.eye
    }

    /// The direction of a sector, of length 1; `None` for a view all round.
    pub fn direction(&self) -> Option<DVec2> {
        self.sector.map(|sector| sector.direction)
    }

    /// The half angle of a sector in radians; half a turn for a view all round.
    pub fn half_angle(&self) -> f64 {
        self.sector.map_or(PI, |sector| sector.half_angle)
    }

    /// How far the view goes from the eye, in world units, if it ends.
    pub fn range(&self) -> Option<f64> {
        self.range
    }

    /// How far from the place of the eye a point in the view may be, if the view ends.
    pub(crate) fn farthest(&self) -> Option<f64> {
        let rounding = if self.reach > 0.0 { DISTANCE } else { 0.0 };
        self.range.map(|range| (range + self.reach) * (1.0 + rounding))
    }

    /// A view of one eye, farther back, that holds the sectors of all eyes within the reach of this
    /// one; `None` if these may look in all directions.
    ///
    /// The points within r of a sector of half angle h lie in that whose apex is r / sin(h) behind.
    pub(crate) fn gate(&self) -> Option<Self> {
        let Sector { direction, half_angle } = self.sector?;
        let half_angle = half_angle.max(LEAST_GATE);
        let back = half_angle.sin();
        if self.reach == 0.0 || back < LEAST_GATE.sin() {
            return None;
        }
        // As far as the apex is rounded to single precision.
        let rounding = f64::from(f32::EPSILON) * (self.eye.abs().max_element() + self.reach / back);
        let room = self.reach * (1.0 + REACH) + 4.0 * rounding + f64::from(f32::MIN_POSITIVE);
        let apex = self.eye - direction * (room / back);
        // Beyond the numbers of single precision nothing is known.
        let eye = Some(apex).filter(|apex| apex.abs().max_element() < f64::from(f32::MAX));
        let sector = Some(Sector { direction, half_angle });
        eye.map(|eye| Self { eye: eye.as_vec2().as_dvec2(), sector, range: None, reach: 0.0, ..*self })
    }

    /// Whether all that another view sees is seen by some eye of this one, in the same layers. In
    /// doubt, no.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        let looks = match (self.sector, other.sector) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(own), Some(other)) => {
                let turn = own.direction.perp_dot(other.direction).atan2(own.direction.dot(other.direction));
                own == other || turn.abs() + other.half_angle + TILT <= own.half_angle
            }
        };
        let sees_as_far = self.range.is_none_or(|own| other.range.is_some_and(|other| other <= own));
        // Rounded up by more than the distance is rounded.
        let apart = self.eye.distance(other.eye) * (1.0 + DISTANCE) + other.reach;
        let within = self.eye == other.eye && other.reach <= self.reach || apart < self.reach;
        looks && sees_as_far && within && self.layers == other.layers
    }

    /// Points on the two sides of a sector, the first and the last counterclockwise; the directions
    /// to these points are the sides, exactly.
    pub(crate) fn sides(&self) -> Option<[DVec2; 2]> {
        let Sector { direction, half_angle } = self.sector?;
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
        assert!(matches!(View::sector(Vec2::ZERO, Vec2::ZERO, 1.0), Err(Error::NoDirection { .. })));
        for half in [-0.1, 3.2, f32::NAN] {
            assert!(matches!(View::sector(Vec2::ZERO, Vec2::X, half), Err(Error::Setting { .. })), "{half}");
        }
        for reach in [-1.0, f32::NAN, f32::INFINITY] {
            assert!(View::all_round(Vec2::ZERO).unwrap().with_reach(reach).is_err(), "{reach}");
        }
        for range in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let view = View::all_round(Vec2::ZERO).unwrap();
            assert!(matches!(view.with_range(range), Err(Error::Setting { .. })), "{range}");
        }
    }
}
