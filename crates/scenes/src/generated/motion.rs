//! Motion and camera paths as functions of time.

use std::f32::consts::TAU;

use glam::Vec3;

use super::options::SceneOptions;
use crate::numeric::{SPEED_ROOM, SPEED_ROUNDING};
use crate::random::Dice;
use crate::world::{Animation, Camera, FRAME_SECONDS, GridHint, Motion, Object, Shape, Source, World};

/// How an object moves.
#[derive(Debug, Clone, Copy)]
pub(super) enum Way {
    /// Around a place: a sine along each axis.
    Swing { reach: Vec3, rate: Vec3, phase: Vec3 },
    /// To and fro along a line, slowing down at its ends, by radians a second.
    Slide { way: Vec3, rate: f32, phase: f32 },
}

impl Way {
    /// A swing of at most `reach` along each axis whose speed stays below `speed`.
    pub(super) fn swing(dice: &mut Dice, reach: Vec3, speed: f32) -> Self {
        let phase = dice.point(Vec3::ZERO, Vec3::splat(TAU));
        let share = speed / 3f32.sqrt();
        let rate = Vec3::from_array(
            reach.to_array().map(|r| if r > 0.0 { (share / r).min(6.0) * dice.range(0.4, 1.0) } else { 0.0 }),
        );
        Self::Swing { reach, rate, phase }
    }

    fn offset(&self, t: f32) -> Vec3 {
        match *self {
            Self::Swing { reach, rate, phase } => {
                let a = phase + rate * t;
                reach * Vec3::new(a.x.sin(), a.y.sin(), a.z.sin())
            }
            Self::Slide { way, rate, phase } => way * (0.5 - 0.5 * (phase + rate * t).cos()),
        }
    }

    /// No point moves faster.
    fn max_speed(&self) -> f32 {
        let speed = match *self {
            Self::Swing { reach, rate, .. } => (reach * rate).length(),
            Self::Slide { way, rate, .. } => way.length() * 0.5 * rate,
        };
        speed * SPEED_ROOM + SPEED_ROUNDING
    }
}

/// A moving object: its shape at rest, and how it moves.
#[derive(Debug, Clone)]
pub(super) struct Moving {
    pub(super) index: usize,
    rest: Shape,
    way: Way,
}

impl Moving {
    /// Makes the last object of a list move.
    pub(super) fn last(objects: &mut [Object], way: Way) -> Self {
        let index = objects.len() - 1;
        objects[index].motion = Motion::Dynamic { max_speed: way.max_speed() };
        let moving = Self { index, rest: objects[index].shape.clone(), way };
        objects[index].shape = moving.shape(0.0);
        moving
    }

    pub(super) fn shape(&self, t: f32) -> Shape {
        self.rest.moved(self.way.offset(t))
    }
}

/// A walk along a closed or open polyline with rounded corners, at even pace.
#[derive(Debug, Clone)]
pub(super) struct Path {
    points: Vec<Vec3>,
    lengths: Vec<f32>,
}

impl Path {
    /// Rounds the corners of a polyline by cutting them three times.
    pub(super) fn new(corners: &[Vec3]) -> Self {
        let mut points = corners.to_vec();
        for _ in 0..3 {
            let mut cut = vec![points[0]];
            for pair in points.windows(2) {
                cut.push(pair[0].lerp(pair[1], 0.25));
                cut.push(pair[0].lerp(pair[1], 0.75));
            }
            cut.push(points[points.len() - 1]);
            points = cut;
        }
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
        }
        Self { points, lengths }
    }

    /// A polyline that is rounded only within `room` metres of its corners.
    pub(super) fn close_to(stops: &[Vec3], room: f32) -> Self {
        let mut corners = vec![stops[0]];
        for w in stops.windows(3) {
            let [a, b, c] = [w[0], w[1], w[2]];
            corners.extend([b + (a - b).normalize() * room, b, b + (c - b).normalize() * room]);
        }
        corners.push(stops[stops.len() - 1]);
        Self::new(&corners)
    }

    /// Evenly spread places, from the start to the end.
    pub(super) fn samples(&self, steps: usize) -> Vec<Vec3> {
        (0..=steps).map(|i| self.at(self.length() * i as f32 / steps as f32)).collect()
    }

    pub(super) fn length(&self) -> f32 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The point at a distance from the start; beyond the end, straight on.
    pub(super) fn at(&self, distance: f32) -> Vec3 {
        let i = self.lengths.partition_point(|&l| l < distance).clamp(1, self.points.len() - 1);
        let (from, to) = (self.lengths[i - 1], self.lengths[i]);
        let t = if to > from { (distance - from) / (to - from) } else { 0.0 };
        self.points[i - 1].lerp(self.points[i], t)
    }
}

/// Moving objects, in order of their indices, and a walker who looks where they go.
pub(super) struct Walk {
    pub(super) moving: Vec<Moving>,
    pub(super) path: Path,
    pub(super) frames: usize,
    pub(super) fov_y: f32,
    /// How far the walker looks to the sides, in radians.
    pub(super) glance: f32,
    pub(super) far: f32,
}

impl Walk {
    /// A walk on which nothing moves, with a lens of 60 degrees that shows 400 m.
    pub(super) fn along(path: Path, options: &SceneOptions) -> Self {
        Self { moving: Vec::new(), path, frames: options.frames, fov_y: 60.0, glance: 0.6, far: 400.0 }
    }

    /// The scene that it goes through, in a box of cells.
    pub(super) fn through(self, name: &str, objects: Vec<Object>, [min, max]: [Vec3; 2], cell: f32) -> World {
        World {
            source: Source::default(),
            name: name.to_owned(),
            objects,
            grid: GridHint { min, max, cell },
            frames: self.frames,
            animation: Box::new(self),
        }
    }
}

impl Animation for Walk {
    fn shapes(&self, frame: usize, set: &mut dyn FnMut(usize, Shape)) {
        let t = (frame as f64 * FRAME_SECONDS) as f32;
        self.moving.iter().for_each(|m| set(m.index, m.shape(t)));
    }

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        let share = frame as f32 / self.frames.max(2) as f32;
        let at = share * self.path.length();
        let eye = self.path.at(at);
        let ahead = self.path.at(at + 1.5) - self.path.at(at - 0.5);
        let turn = self.glance * (share * TAU * 2.0).sin();
        let forward = glam::Quat::from_rotation_y(turn) * ahead.normalize_or(Vec3::NEG_Z);
        Camera::look_at(eye, eye + forward, self.fov_y, aspect, 0.1, self.far)
    }
}
