//! Fields of view.

use casca::Aabb;
use casca::glam::{DVec3, Vec3};

use crate::error::{ServerError, place, within};
use crate::numeric::{ANGLE, FASTEST};

/// The field of view of a client: a cone around a direction, which may turn.
///
/// Give one only if clients cannot turn faster than this: most games let a mouse turn a camera
/// at once, and then all directions count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldOfView {
    /// Where the client looks, of any length.
    pub direction: Vec3,
    /// From there to the corner of the picture, in radians from 0 to pi.
    pub half_angle: f32,
    /// How fast the client can turn, in radians a second.
    pub turn_speed: f32,
}

impl FieldOfView {
    pub(crate) fn check(&self) -> Result<(), ServerError> {
        place("the direction of a view", self.direction)?;
        if self.direction == Vec3::ZERO {
            return Err(ServerError::NoDirection("the direction of a view"));
        }
        within("the half angle of a view, in radians,", self.half_angle, 0.0, std::f32::consts::PI)?;
        within("the speed of turning, in radians a second,", self.turn_speed, 0.0, FASTEST)
    }

    /// Whether a camera may see a point of a box after it moved by `reach` and turned for `time`;
    /// in doubt, yes.
    pub(crate) fn may_see(&self, eye: DVec3, reach: f64, time: f64, b: &Aabb) -> bool {
        let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
        let way = (min + max) * 0.5 - eye;
        // A ball around the box, for an eye that stays: it grows by as much as the eye may go.
        let radius = (max - min).length() * 0.5 + reach;
        let far = way.length();
        if far <= radius {
            return true;
        }
        let toward = self.direction.as_dvec3().normalize();
        let off = (toward.dot(way) / far).clamp(-1.0, 1.0).acos();
        let open = f64::from(self.half_angle) + f64::from(self.turn_speed) * time;
        let outside = off - (radius / far).clamp(0.0, 1.0).asin() > open + ANGLE;
        // A comparison with a number that is none keeps the box.
        !outside
    }
}

#[cfg(test)]
mod tests {
    use casca_truth::places::{coordinates, place_in, points};
    use proptest::prelude::*;
    use rand::RngExt;

    use super::*;

    fn ahead(half_angle: f32, turn_speed: f32) -> FieldOfView {
        FieldOfView { direction: Vec3::new(0.0, 0.0, -3.0), half_angle, turn_speed }
    }

    #[test]
    fn boxes_beside_the_cone_are_out_of_view_until_the_eye_turns_or_moves() {
        let beside = Aabb::from_center(Vec3::new(10.0, 0.0, 0.0), Vec3::splat(0.5));
        let view = ahead(0.7, 1.0);
        assert!(!view.may_see(DVec3::ZERO, 0.0, 0.0, &beside));
        assert!(view.may_see(DVec3::ZERO, 0.0, 0.9, &beside), "it turned");
        assert!(view.may_see(DVec3::ZERO, 9.5, 0.0, &beside), "it moved");
        let before = Aabb::from_center(Vec3::new(1.0, 0.0, -10.0), Vec3::splat(0.5));
        assert!(view.may_see(DVec3::ZERO, 0.0, 0.0, &before));
        let behind = Aabb::from_center(Vec3::new(0.0, 0.0, 10.0), Vec3::splat(0.5));
        assert!(!ahead(3.0, 0.0).may_see(DVec3::ZERO, 0.0, 0.0, &behind));
        assert!(ahead(std::f32::consts::PI, 0.0).may_see(DVec3::ZERO, 0.0, 0.0, &behind));
    }

    proptest! {
        #![proptest_config(casca_truth::cases(500))]
        #[test]
        fn what_a_camera_sees_may_be_seen(
            (eye, min, direction) in (points(-2.0..2.0, 1.0), points(-2.0..2.0, 1.0), points(-2.0..2.0, 1.0)),
            (size, way) in (points(0.0..2.0, 1.0), points(-1.0..1.0, 1.0)),
            (half_angle, turned, seed) in (coordinates(0.0..3.0, 0.5), coordinates(0.0..1.0, 0.5), any::<u64>()),
        ) {
            prop_assume!(direction != Vec3::ZERO);
            let view = FieldOfView { direction, half_angle, turn_speed: turned };
            let b = Aabb::new(min, min + size);
            let (eye, reach) = (eye.as_dvec3(), way.as_dvec3().length());
            let mut random = casca_scenes::random::generator(seed, 0);
            for _ in 0..50 {
                let mut share = || random.random_range(0.0..1.0);
                let point = place_in(b.min.as_dvec3(), b.max.as_dvec3(), &mut share);
                let off = (point - eye - way.as_dvec3() * share()).angle_between(direction.as_dvec3());
                let sees = off < f64::from(half_angle) + f64::from(turned) * 0.5;
                prop_assert!(!sees || view.may_see(eye, reach, 0.5, &b), "{point}");
            }
        }
    }

    #[test]
    fn a_view_without_direction_is_refused() {
        assert!(ahead(0.7, 0.0).check().is_ok());
        assert!(FieldOfView { direction: Vec3::ZERO, ..ahead(0.7, 0.0) }.check().is_err());
        assert!(ahead(-0.1, 0.0).check().is_err() && ahead(f32::NAN, 0.0).check().is_err());
        assert!(ahead(0.7, f32::INFINITY).check().is_err());
    }
}
