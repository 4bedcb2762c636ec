//! Key-framed properties of nodes.

use glam::{DQuat, DVec3};
use gltf::animation::Interpolation;

/// A key-framed property of a node, as the file has it.
#[derive(Debug, Clone)]
pub struct Track<T> {
    /// Seconds, in order.
    pub times: Vec<f32>,
    /// One for each time; of splines three, with the tangents before and after.
    pub values: Vec<T>,
    /// How values go over into each other.
    pub interpolation: Interpolation,
}

pub trait Mix: Copy {
    fn mix(a: Self, b: Self, t: f64) -> Self;
    /// The cubic Hermite spline of glTF: values, and tangents times the interval.
    fn spline(a: Self, out: Self, into: Self, b: Self, t: f64, dt: f64) -> Self;
}

impl Mix for DVec3 {
    fn mix(a: Self, b: Self, t: f64) -> Self {
        a.lerp(b, t)
    }

    fn spline(a: Self, out: Self, into: Self, b: Self, t: f64, dt: f64) -> Self {
        let [p, m, q, n] = hermite(t, dt);
        a * p + out * m + b * q + into * n
    }
}

impl Mix for DQuat {
    fn mix(a: Self, b: Self, t: f64) -> Self {
        a.slerp(b, t)
    }

    fn spline(a: Self, out: Self, into: Self, b: Self, t: f64, dt: f64) -> Self {
        let [p, m, q, n] = hermite(t, dt);
        (a * p + out * m + b * q + into * n).normalize()
    }
}

fn hermite(t: f64, dt: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, dt * (t3 - 2.0 * t2 + t), 3.0 * t2 - 2.0 * t3, dt * (t3 - t2)]
}

impl<T> Track<T> {
    /// The same with other values.
    pub fn map<U>(self, each: impl Fn(T) -> U) -> Track<U> {
        let values = self.values.into_iter().map(each).collect();
        Track { times: self.times, values, interpolation: self.interpolation }
    }
}

impl<T: Mix> Track<T> {
    /// The value at a time; none without keys.
    pub fn at(&self, time: f32) -> Option<T> {
        let last = self.times.len().checked_sub(1)?;
        let cubic = self.interpolation == Interpolation::CubicSpline;
        let value = |i: usize| self.values.get(if cubic { 3 * i + 1 } else { i }).copied();
        let next = self.times.partition_point(|&t| t <= time);
        if next == 0 || next > last {
            return value(next.min(last));
        }
        let (i, j) = (next - 1, next);
        let [from, to, time] = [self.times[i], self.times[j], time].map(f64::from);
        let dt = to - from;
        let t = if dt > 0.0 { ((time - from) / dt).clamp(0.0, 1.0) } else { 0.0 };
        let (a, b) = (value(i)?, value(j)?);
        Some(match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear => T::mix(a, b, t),
            Interpolation::CubicSpline => {
                T::spline(a, *self.values.get(3 * i + 2)?, *self.values.get(3 * j)?, b, t, dt)
            }
        })
    }
}

/// What moves, turns and scales a node.
#[derive(Debug, Clone, Default)]
pub struct Tracks {
    /// Where it is.
    pub translation: Option<Track<DVec3>>,
    /// How it is turned.
    pub rotation: Option<Track<DQuat>>,
    /// How large it is.
    pub scale: Option<Track<DVec3>>,
}
