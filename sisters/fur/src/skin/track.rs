//! Keyed values over time, and clips: what moves which joint.

use glam::{Quat, Vec3, Vec4};

use super::skeleton::Skeleton;
use crate::error::{Error, range};
use crate::numeric::{MAX_COORDINATE, UNIT_QUATERNION};

/// How values between keys are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// The value of the last key.
    Step,
    /// Evenly from key to key; rotations turn evenly, the shorter way round.
    #[default]
    Linear,
    /// Cubic Hermite splines: three values a key, the tangent before it, the value, the tangent
    /// behind it, as in glTF. Rotations are normalised.
    CubicSpline,
}

/// Values that can be keyed.
pub trait Keyed: Copy {
    /// Whether it can be the value of a key.
    fn is_sound(self) -> bool;
    /// Whether it can be a tangent of a spline.
    fn is_finite(self) -> bool;
    /// Between two values.
    fn mix(a: Self, b: Self, t: f32) -> Self;
    /// The sum of four values, each by its factor.
    fn sum(terms: [(Self, f32); 4]) -> Self;
    /// The same value without the rounding of files: rotations get the length 1.
    fn settled(self) -> Self;
}

impl Keyed for Vec3 {
    fn is_sound(self) -> bool {
        self.abs().cmple(Vec3::splat(MAX_COORDINATE)).all()
    }

    fn is_finite(self) -> bool {
        self.is_sound()
    }

    fn mix(a: Self, b: Self, t: f32) -> Self {
        a.lerp(b, t)
    }

    fn sum(terms: [(Self, f32); 4]) -> Self {
        terms.into_iter().map(|(value, factor)| value * factor).sum()
    }

    fn settled(self) -> Self {
        self
    }
}

impl Keyed for Quat {
    fn is_sound(self) -> bool {
        (f64::from(self.length()) - 1.0).abs() <= UNIT_QUATERNION
    }

    fn is_finite(self) -> bool {
        self.to_array().iter().all(|c| c.abs() <= MAX_COORDINATE)
    }

    fn mix(a: Self, b: Self, t: f32) -> Self {
        a.slerp(b, t).normalize()
    }

    fn sum(terms: [(Self, f32); 4]) -> Self {
        let sum = terms.into_iter().map(|(value, factor)| Vec4::from(value) * factor).sum::<Vec4>();
        // Keys that cancel each other leave no rotation: the nearer one holds.
        let nearer = if terms[0].1 >= terms[2].1 { terms[0].0 } else { terms[2].0 };
        Quat::from_vec4(sum.try_normalize().unwrap_or(nearer.into()))
    }

    fn settled(self) -> Self {
        self.normalize()
    }
}

/// A value over time. Before the first key it is that of the first, behind the last that of the
/// last.
#[derive(Debug, Clone, PartialEq)]
pub struct Track<T> {
    times: Vec<f32>,
    values: Vec<T>,
    interpolation: Interpolation,
}

impl<T: Keyed> Track<T> {
    /// A track of keys at times in seconds, in ascending order; three values a key for splines,
    /// else one.
    ///
    /// # Errors
    /// Refuses no keys, times that are not finite or not in order, another number of values, and
    /// values that are not finite, above 1e9, or rotations that are not of length 1.
    pub fn new(times: Vec<f32>, mut values: Vec<T>, interpolation: Interpolation) -> Result<Self, Error> {
        if times.is_empty() {
            return Err(Error::Keys { key: 0, why: "is missing: a track needs at least one" });
        }
        let most = f64::from(MAX_COORDINATE);
        for (key, &time) in times.iter().enumerate() {
            range("the time of a key in seconds", time.into(), -most, most)?;
            if key > 0 && times[key - 1] > time {
                return Err(Error::Keys { key, why: "comes before the key in front of it" });
            }
        }
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let expected = times.len().saturating_mul(per_key);
        if values.len() != expected {
            return Err(Error::Count { what: "values of keys", found: values.len(), expected });
        }
        for (i, value) in values.iter_mut().enumerate() {
            let is_tangent = per_key == 3 && i % 3 != 1;
            if !(if is_tangent { value.is_finite() } else { value.is_sound() }) {
                let why = "is not finite, too great, or no rotation";
                return Err(Error::Keys { key: i / per_key, why });
            }
            if !is_tangent {
                *value = value.settled();
            }
        }
        Ok(Self { times, values, interpolation })
    }

    /// The time of the last key, in seconds.
    pub fn end(&self) -> f32 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The value at a time in seconds; at NaN that of the first key. Costs a binary search.
    pub fn at(&self, time: f32) -> T {
        let next = self.times.partition_point(|&t| t <= time);
        if next == 0 || next == self.times.len() {
            return self.value(next.saturating_sub(1));
        }
        let i = next - 1;
        let j = i + 1;
        let dt = self.times[j] - self.times[i];
        let t = if dt > 0.0 { ((time - self.times[i]) / dt).clamp(0.0, 1.0) } else { 0.0 };
        match self.interpolation {
            Interpolation::Step => self.value(i),
            Interpolation::Linear => T::mix(self.value(i), self.value(j), t),
            Interpolation::CubicSpline => {
                let (t2, t3) = (t * t, t * t * t);
                T::sum([
                    (self.value(i), 2.0 * t3 - 3.0 * t2 + 1.0),
                    (self.values[3 * i + 2], dt * (t3 - 2.0 * t2 + t)),
                    (self.value(j), 3.0 * t2 - 2.0 * t3),
                    (self.values[3 * j], dt * (t3 - t2)),
                ])
            }
        }
    }

    /// The value of a key.
    fn value(&self, key: usize) -> T {
        self.values[if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key }]
    }
}

/// The translation, rotation or scale of a joint over time. It replaces that at rest.
#[derive(Debug, Clone, PartialEq)]
pub enum Channel {
    /// Its translation.
    Translation(Track<Vec3>),
    /// Its rotation.
    Rotation(Track<Quat>),
    /// Its scale.
    Scale(Track<Vec3>),
}

/// Joints over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Clip {
    channels: Vec<(usize, Channel)>,
    seconds: f32,
}

impl Clip {
    /// A clip of channels and the joints that they move; of two for one property of a joint the
    /// later counts. It lasts from time 0 to its last key.
    ///
    /// # Errors
    /// Refuses joints that the skeleton lacks.
    pub fn new(channels: Vec<(usize, Channel)>, skeleton: &Skeleton) -> Result<Self, Error> {
        let joints = skeleton.joints().len();
        if let Some(of) = channels.iter().position(|(joint, _)| *joint >= joints) {
            let (what, does, number) = ("channel", "moves joint", channels[of].0);
            return Err(Error::Missing { what, of, does, number, count: joints });
        }
        let end = |channel: &Channel| match channel {
            Channel::Translation(track) | Channel::Scale(track) => track.end(),
            Channel::Rotation(track) => track.end(),
        };
        let seconds = channels.iter().map(|(_, channel)| end(channel)).fold(0.0, f32::max);
        Ok(Self { channels, seconds })
    }

    /// Its channels, and the joints that they move.
    pub fn channels(&self) -> &[(usize, Channel)] {
        &self.channels
    }

    /// How long it lasts, in seconds.
    pub fn seconds(&self) -> f32 {
        self.seconds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_interpolate_as_asked() {
        let times = vec![1.0, 2.0, 4.0];
        let xs = |xs: &[f32]| xs.iter().map(|&x| Vec3::X * x).collect::<Vec<_>>();
        for (interpolation, expected) in [
            (Interpolation::Step, [1.0, 1.0, 1.0, 3.0, 3.0, -1.0, -1.0]),
            (Interpolation::Linear, [1.0, 1.0, 2.0, 3.0, 1.0, -1.0, -1.0]),
        ] {
            let track = Track::new(times.clone(), xs(&[1.0, 3.0, -1.0]), interpolation).unwrap();
            let found = [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0].map(|t| track.at(t).x);
            assert_eq!(found, expected, "{interpolation:?}");
            assert_eq!((track.at(f32::NAN).x, track.end()), (1.0, 4.0));
        }
        // Tangents of the parabola t²: the spline is that parabola.
        let parabola = xs(&[2.0, 1.0, 2.0, 4.0, 4.0, 4.0, 8.0, 16.0, 8.0]);
        let track = Track::new(times, parabola, Interpolation::CubicSpline).unwrap();
        for t in [1.0, 1.25, 1.9, 2.0, 3.0, 3.5] {
            assert!((track.at(t).x - t * t).abs() < 1e-5, "{t}: {}", track.at(t).x);
        }
        let turn = vec![Quat::IDENTITY, -Quat::from_rotation_y(1.0)];
        let track = Track::new(vec![0.0, 1.0], turn, Interpolation::Linear).unwrap();
        assert!(track.at(0.25).angle_between(Quat::from_rotation_y(0.25)) < 1e-3, "the shorter way round");
    }

    #[test]
    fn absurd_tracks_are_refused() {
        let make = |times: &[f32], values: &[Vec3], how| Track::new(times.to_vec(), values.to_vec(), how);
        let (step, spline) = (Interpolation::Step, Interpolation::CubicSpline);
        assert!(matches!(make(&[], &[], step), Err(Error::Keys { .. })));
        assert!(matches!(make(&[1.0, 0.5], &[Vec3::ONE; 2], step), Err(Error::Keys { key: 1, .. })));
        assert!(matches!(make(&[f32::NAN], &[Vec3::ONE], step), Err(Error::Range { .. })));
        assert!(matches!(make(&[0.0], &[Vec3::ONE], spline), Err(Error::Count { expected: 3, .. })));
        assert!(matches!(make(&[0.0], &[Vec3::NAN], step), Err(Error::Keys { key: 0, .. })));
        assert!(Track::new(vec![0.0], vec![Quat::from_xyzw(0.0, 0.0, 0.0, 2.0)], step).is_err());
        // Opposite keys cancel in the middle; keys at one time have no length.
        let q = Quat::IDENTITY;
        let zero = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let track =
            Track::new(vec![0.0, 1.0, 1.0], vec![zero, q, zero, zero, -q, zero, zero, q, zero], spline);
        let track = track.unwrap();
        assert!([0.5, 1.0, 2.0].iter().all(|&t| track.at(t).is_sound()));
    }
}
