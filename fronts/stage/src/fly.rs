//! A camera that is flown with keys and mouse.

use std::collections::HashSet;

use glam::Vec3;
use winit::event::{Touch, TouchPhase};
use winit::keyboard::KeyCode;

/// Radians for each pixel that the mouse moves.
const TURN: f32 = 0.004;
/// How much faster it goes with the Shift key.
const FAST: f32 = 5.0;
/// The steepest that it looks up or down, in radians.
const STEEP: f32 = 1.5;
/// How far two fingers must move apart or together before the camera flies, as a factor of their
/// distance.
const PINCH: f64 = 1.15;

/// The fingers on the screen: one turns the camera; two that move apart fly forward until they are
/// lifted, and two that come together fly backward.
#[derive(Debug, Default)]
pub(crate) struct Fingers {
    /// Their numbers and places, at most two.
    down: Vec<(u64, f64, f64)>,
    /// The distance at which two of them began.
    apart: f64,
}

impl Fingers {
    /// Follows a finger. If it is the only one, by how many pixels it has moved to the right and
    /// down. One that a panel takes counts for nothing.
    pub(crate) fn follow(&mut self, touch: &Touch, taken: bool) -> Option<(f32, f32)> {
        let (x, y) = (touch.location.x, touch.location.y);
        let known = self.down.iter().position(|(id, ..)| *id == touch.id);
        match (touch.phase, known) {
            (TouchPhase::Started, None) if !taken && self.down.len() < 2 => {
                self.down.push((touch.id, x, y));
                self.apart = self.distance().unwrap_or(0.0);
                None
            }
            (TouchPhase::Moved, Some(i)) => {
                let (_, before_x, before_y) = std::mem::replace(&mut self.down[i], (touch.id, x, y));
                (self.down.len() == 1).then_some(((x - before_x) as f32, (y - before_y) as f32))
            }
            (TouchPhase::Ended | TouchPhase::Cancelled, Some(i)) => {
                self.down.remove(i);
                None
            }
            _ => None,
        }
    }

    fn distance(&self) -> Option<f64> {
        let [(_, ax, ay), (_, bx, by)] = self.down[..] else { return None };
        Some((ax - bx).hypot(ay - by))
    }

    /// 1 to fly forward, -1 to fly backward, or 0.
    pub(crate) fn forward(&self) -> f32 {
        match self.distance() {
            Some(now) if now > self.apart * PINCH => 1.0,
            Some(now) if now * PINCH < self.apart => -1.0,
            _ => 0.0,
        }
    }
}

/// Where the camera is and looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fly {
    /// Position of the eye.
    pub eye: Vec3,
    yaw: f32,
    pitch: f32,
}

/// The way that the keys held ask for: right, up and forward. W and S, A and D, E and Q; longer
/// with Shift.
pub(crate) fn way(keys: &HashSet<KeyCode>) -> Vec3 {
    let axis = |plus: KeyCode, minus: KeyCode| {
        f32::from(u8::from(keys.contains(&plus))) - f32::from(u8::from(keys.contains(&minus)))
    };
    let way = Vec3::new(
        axis(KeyCode::KeyD, KeyCode::KeyA),
        axis(KeyCode::KeyE, KeyCode::KeyQ),
        axis(KeyCode::KeyW, KeyCode::KeyS),
    );
    if keys.contains(&KeyCode::ShiftLeft) { way * FAST } else { way }
}

impl Fly {
    /// A camera at `eye` that looks along `forward`.
    pub fn new(eye: Vec3, forward: Vec3) -> Self {
        let forward = forward.normalize_or(Vec3::NEG_Z);
        Self { eye, yaw: forward.x.atan2(-forward.z), pitch: forward.y.clamp(-1.0, 1.0).asin() }
    }

    /// The direction in which it looks.
    pub fn forward(&self) -> Vec3 {
        let ((sin_yaw, cos_yaw), (sin, cos)) = (self.yaw.sin_cos(), self.pitch.sin_cos());
        Vec3::new(sin_yaw * cos, sin, -cos_yaw * cos)
    }

    /// Turns it as the mouse moves, by pixels to the right and down.
    pub fn turn(&mut self, x: f32, y: f32) {
        self.yaw += x * TURN;
        self.pitch = (self.pitch - y * TURN).clamp(-STEEP, STEEP);
    }

    /// Moves it to the right, upwards and forward.
    pub fn go(&mut self, way: Vec3) {
        let forward = self.forward();
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        self.eye += right * way.x + Vec3::Y * way.y + forward * way.z;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_looks_where_it_was_told_and_turns_right_and_down() {
        for forward in [Vec3::NEG_Z, Vec3::X, Vec3::Z, Vec3::new(1.0, 0.5, -2.0).normalize()] {
            assert!(Fly::new(Vec3::ZERO, forward).forward().abs_diff_eq(forward, 1e-6), "{forward}");
        }
        let mut fly = Fly::new(Vec3::ONE, Vec3::NEG_Z);
        fly.turn(std::f32::consts::FRAC_PI_2 / TURN, 0.0);
        assert!(fly.forward().abs_diff_eq(Vec3::X, 1e-5));
        fly.turn(0.0, 1e9);
        assert!(fly.forward().y < -0.99 && fly.forward().is_normalized());
    }

    #[test]
    fn one_finger_turns_and_two_fly() {
        let touch = |id, phase, x: f64, y: f64| Touch {
            device_id: winit::event::DeviceId::dummy(),
            phase,
            location: (x, y).into(),
            force: None,
            id,
        };
        let mut fingers = Fingers::default();
        let mut follow = |id, phase, x, y| fingers.follow(&touch(id, phase, x, y), false);
        assert_eq!(follow(1, TouchPhase::Started, 10.0, 10.0), None);
        assert_eq!(follow(1, TouchPhase::Moved, 13.0, 8.0), Some((3.0, -2.0)));
        assert_eq!(follow(2, TouchPhase::Started, 113.0, 8.0), None);
        assert_eq!(follow(2, TouchPhase::Moved, 123.0, 8.0), None);
        assert_eq!(fingers.forward(), 0.0);
        fingers.follow(&touch(2, TouchPhase::Moved, 133.0, 8.0), false);
        assert_eq!(fingers.forward(), 1.0);
        fingers.follow(&touch(2, TouchPhase::Moved, 53.0, 8.0), false);
        assert_eq!(fingers.forward(), -1.0);
        fingers.follow(&touch(1, TouchPhase::Ended, 13.0, 8.0), false);
        assert_eq!(fingers.forward(), 0.0);
        assert_eq!(fingers.follow(&touch(2, TouchPhase::Moved, 54.0, 9.0), false), Some((1.0, 1.0)));
        // A finger on a panel moves nothing.
        let mut fingers = Fingers::default();
        fingers.follow(&touch(1, TouchPhase::Started, 10.0, 10.0), true);
        assert_eq!(fingers.follow(&touch(1, TouchPhase::Moved, 13.0, 8.0), false), None);
    }

    #[test]
    fn keys_move_it_along_its_own_axes() {
        let mut fly = Fly::new(Vec3::ZERO, Vec3::X);
        let keys = HashSet::from([KeyCode::KeyW, KeyCode::KeyD, KeyCode::KeyE]);
        fly.go(way(&keys));
        assert!(fly.eye.abs_diff_eq(Vec3::new(1.0, 1.0, 1.0), 1e-6), "{}", fly.eye);
        let both = HashSet::from([KeyCode::KeyW, KeyCode::KeyS, KeyCode::KeyA, KeyCode::ShiftLeft]);
        assert_eq!(way(&both), Vec3::new(-FAST, 0.0, 0.0));
    }
}
