//! How an animal of a field walks: on a circle, looking ahead.

use std::f64::consts::TAU;

use glam::{Affine3A, Quat, Vec3};

/// A walk on a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Walk {
    /// The middle of its walk, on the ground.
    pub(super) center: Vec3,
    /// The radius of its walk; 0 for those that stand.
    pub(super) radius: f32,
    /// Radians per second, and where it starts.
    pub(super) turn: [f32; 2],
    pub(super) scale: f32,
}

impl Walk {
    /// The placement at a time of what stands on the ground at 0 and looks along x, and the
    /// velocity and the acceleration, in units and seconds.
    pub(super) fn at(&self, time: f64) -> (Affine3A, [Vec3; 2]) {
        let angle = (f64::from(self.turn[1]) + time * f64::from(self.turn[0])).rem_euclid(TAU) as f32;
        let (sin, cos) = angle.sin_cos();
        let place = self.center + Vec3::new(cos * self.radius, 0.0, sin * self.radius);
        // Along the tangent (-sin, cos).
        let turn = Quat::from_rotation_y(-angle - std::f32::consts::FRAC_PI_2);
        let velocity = Vec3::new(-sin, 0.0, cos) * self.radius * self.turn[0];
        let acceleration = Vec3::new(-cos, 0.0, -sin) * self.radius * self.turn[0].powi(2);
        let placement = Affine3A::from_scale_rotation_translation(Vec3::splat(self.scale), turn, place);
        (placement, [velocity, acceleration])
    }

    /// How many rounds of its steps an animal of a stride has gone at a time.
    pub(super) fn rounds(&self, time: f64, stride: f32) -> f64 {
        let speed = f64::from(self.radius * self.turn[0]);
        f64::from(self.turn[1]) + time * speed / f64::from(stride * self.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_and_acceleration_are_those_of_the_placement() {
        let walk = Walk { center: Vec3::new(3.0, 0.0, 5.0), radius: 0.5, turn: [1.3, 0.4], scale: 0.9 };
        let at = |time: f64| Vec3::from(walk.at(time).0.translation);
        let h = 0.01;
        for step in 0..20 {
            let time = f64::from(step) * 0.3;
            let (placement, [velocity, acceleration]) = walk.at(time);
            let way = (at(time + h) - at(time - h)) / (2.0 * h as f32);
            let change = (at(time + h) - 2.0 * at(time) + at(time - h)) / (h * h) as f32;
            assert!(velocity.distance(way) < 1e-2 && acceleration.distance(change) < 5e-2, "{time}");
            let ahead = placement.transform_vector3(Vec3::X).normalize();
            assert!(ahead.distance(velocity.normalize()) < 1e-4, "it looks where it goes");
        }
        // Feet go as fast as the ground below: one round for each stride.
        assert!((walk.rounds(2.0, 0.5) - walk.rounds(1.0, 0.5) - 0.65 / 0.45).abs() < 1e-6);
    }
}
