//! What one client may see of the level: a result that is kept while its eye stays near.

use casca::glam::{DVec3, Vec3};
use casca::{KeptOptions, KeptQuery, PointOptions, Scene, View};

use crate::error::ServerError;
use crate::numeric::{AHEAD, KEPT_REACH, ROUNDING, at_least};

/// A kept result for more than this many times the reach that is needed tells too much: the reports
/// of the client were late for a while.
const LOOSE: f64 = 1.25;

/// All eyes within a distance of a place.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball {
    center: Vec3,
    radius: f32,
}

impl Ball {
    /// Whether all eyes of another ball are among these.
    fn holds(&self, eye: Vec3, reach: f64) -> bool {
        let off = (eye.as_dvec3() - self.center.as_dvec3()).length();
        (off + reach) * (1.0 + ROUNDING) <= f64::from(self.radius)
    }
}

/// The memory of one client's queries.
#[derive(Debug, Clone)]
pub(crate) struct Gaze {
    query: KeptQuery,
    ball: Option<Ball>,
}

impl Gaze {
    pub(crate) fn new(point: PointOptions) -> Result<Self, ServerError> {
        let mut query = KeptQuery::with_options(KeptOptions::new().reach(KEPT_REACH).turn(0.0))?;
        query.set_point_options(point)?;
        Ok(Self { query, ball: None })
    }

    /// Whether the last result holds for all eyes within `reach` of a place, brought up to date
    /// with the level. `room` is how much farther it may reach.
    pub(crate) fn holds(&self, eye: Vec3, reach: f64, room: f64) -> bool {
        let wide = (reach + room) * LOOSE;
        self.ball.is_some_and(|ball| ball.holds(eye, reach) && f64::from(ball.radius) <= wide)
    }

    /// Brings a result that holds up to date with the level.
    pub(crate) fn follow(&mut self, level: &Scene) -> Result<(), ServerError> {
        match self.query.sight(level) {
            Some(sight) if sight.has_occlusion() => Ok(()),
            _ => self.look_again(level),
        }
    }

    /// Looks at the level for all eyes within `reach` of a place, and `room` farther. `step` is
    /// where the eye goes.
    pub(crate) fn look(
        &mut self,
        level: &Scene,
        eye: Vec3,
        reach: f64,
        room: f64,
        step: DVec3,
    ) -> Result<(), ServerError> {
        self.run(level, aim(eye, reach, room, step))
    }

    /// Looks again from where it looked last, at entities that are in the scene.
    pub(crate) fn look_again(&mut self, level: &Scene) -> Result<(), ServerError> {
        self.ball.map_or(Ok(()), |ball| self.run(level, ball))
    }

    fn run(&mut self, level: &Scene, ball: Ball) -> Result<(), ServerError> {
        let view = View::omnidirectional(ball.center)?.with_reach(ball.radius)?;
        self.query.run(level, &view);
        self.ball = Some(ball);
        Ok(())
    }

    /// The last result.
    pub(crate) fn query(&self) -> &KeptQuery {
        &self.query
    }
}

/// A ball that holds all eyes within reach, ahead of an eye that moves.
fn aim(eye: Vec3, reach: f64, room: f64, step: DVec3) -> Ball {
    let radius = at_least((reach + room) * (1.0 + 2.0 * ROUNDING));
    let ahead = (eye.as_dvec3() + step.normalize_or_zero() * (AHEAD * room)).as_vec3();
    [ahead, eye]
        .map(|center| Ball { center, radius })
        .into_iter()
        .find(|ball| ball.holds(eye, reach))
        .unwrap_or(Ball { center: eye, radius })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_ahead_holds_the_eyes_within_reach() {
        for eye in [Vec3::ZERO, Vec3::new(1234.5, -77.7, 0.3), Vec3::splat(-9e5)] {
            for (reach, room) in [(0.0, 0.0), (0.0, 1.0), (0.66, 0.33), (3.0, 0.01), (500.0, 250.0)] {
                for step in [DVec3::ZERO, DVec3::X, DVec3::new(-1e-9, 2e-9, 0.0)] {
                    let ball = aim(eye, reach, room, step);
                    assert!(ball.holds(eye, reach), "{eye} {reach} {room} {step} {ball:?}");
                    assert!(!ball.holds(eye, reach + room + 0.01) || room == 0.0 && reach > 100.0);
                }
            }
        }
    }
}
