//! A hall of moving spheres, in the open or behind a wall with a gate.

use std::f32::consts::TAU;

use glam::Vec3;
use rand::RngExt;

use casca_scenes::random::generator;
use casca_scenes::world::{Animation, Camera, FRAME_SECONDS, GridHint, Motion, Object, Shape, World};

/// The hall in metres. The eye stands near the face where x is 0 and looks along x.
const HALL: Vec3 = Vec3::new(128.0, 48.0, 128.0);
/// Where the wall stands, and half the width of its gate.
const WALL: (f32, f32) = (20.0, 22.0);
const GATE: f32 = 1.5;

/// What an arena is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arena {
    /// Moving spheres.
    pub(super) count: usize,
    /// Whether the wall hides most of them.
    pub(super) hidden: bool,
    /// Whether they move at up to 20 m/s instead of 0.5.
    pub(super) fast: bool,
    pub(super) seed: u64,
}

/// A sphere that swings around a place.
struct Ball {
    rest: Vec3,
    radius: f32,
    reach: Vec3,
    /// Radians a second.
    rate: Vec3,
    phase: Vec3,
}

impl Ball {
    fn at(&self, seconds: f32) -> Shape {
        let a = self.phase + self.rate * seconds;
        let swing = Vec3::new(a.x.sin(), a.y.sin(), a.z.sin());
        Shape::Sphere { center: self.rest + self.reach * swing, radius: self.radius }
    }

    /// No point moves faster; rounding of the coordinates included.
    fn max_speed(&self) -> f32 {
        (self.reach * self.rate).length() * 1.0001 + 2e-3
    }
}

struct Dance {
    balls: Vec<Ball>,
    /// The index of the first ball.
    first: usize,
}

impl Animation for Dance {
    fn shapes(&self, frame: usize, set: &mut dyn FnMut(usize, Shape)) {
        let seconds = (frame as f64 * FRAME_SECONDS) as f32;
        for (i, ball) in self.balls.iter().enumerate() {
            set(self.first + i, ball.at(seconds));
        }
    }

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        // Sways by two metres, so that what shows through the gate changes.
        let sway = (frame as f32 * 0.02).sin() * 2.0;
        let eye = Vec3::new(4.0, HALL.y * 0.5, HALL.z * 0.5 + sway);
        Camera::look_at(eye, eye + Vec3::X, 60.0, aspect, 0.1, 300.0)
    }
}

impl Arena {
    /// The number of objects before the first ball.
    pub(super) fn first(&self) -> usize {
        if self.hidden { 4 } else { 0 }
    }

    pub(super) fn build(&self) -> World {
        let mut dice = generator(self.seed, 0x00a2_e4a0_0000);
        let mut range = |lo: f32, hi: f32| lo + (hi - lo) * dice.random::<f32>();
        let (reach, speed) = if self.fast { (5.0, 20.0) } else { (1.0, 0.5) };
        let mut balls = Vec::with_capacity(self.count);
        for _ in 0..self.count {
            let reach = Vec3::new(range(0.3, 1.0), range(0.3, 1.0), range(0.3, 1.0)) * reach;
            let share = speed / 3f32.sqrt();
            let rate = Vec3::new(range(0.5, 1.0), range(0.5, 1.0), range(0.5, 1.0)) * share / reach;
            let phase = Vec3::new(range(0.0, TAU), range(0.0, TAU), range(0.0, TAU));
            let radius = range(0.15, 0.3);
            let margin = reach + radius + 0.1;
            let (lo, hi) = (Vec3::new(WALL.1, 0.0, 0.0) + margin, HALL - margin);
            let rest = Vec3::new(range(lo.x, hi.x), range(lo.y, hi.y), range(lo.z, hi.z));
            balls.push(Ball { rest, radius, reach, rate, phase });
        }
        let mut objects = Vec::with_capacity(self.count + 4);
        let mut add = |shape, motion, occludes| {
            objects.push(Object { name: String::new(), shape, motion, occludes, tested: true });
        };
        if self.hidden {
            let (middle, end) = (HALL * 0.5, HALL);
            for (y, z) in [
                ((0.0, middle.y - GATE), (0.0, end.z)),
                ((middle.y + GATE, end.y), (0.0, end.z)),
                ((middle.y - GATE, middle.y + GATE), (0.0, middle.z - GATE)),
                ((middle.y - GATE, middle.y + GATE), (middle.z + GATE, end.z)),
            ] {
                let (min, max) = (Vec3::new(WALL.0, y.0, z.0), Vec3::new(WALL.1, y.1, z.1));
                add(Shape::Box { min, max }, Motion::Static, true);
            }
        }
        for ball in &balls {
            add(ball.at(0.0), Motion::Dynamic { max_speed: ball.max_speed() }, false);
        }
        World {
            source: Default::default(),
            name: "arena".to_owned(),
            objects,
            grid: GridHint { min: Vec3::ZERO, max: HALL, cell: 1.0 },
            frames: 1,
            animation: Box::new(Dance { balls, first: self.first() }),
        }
    }
}
