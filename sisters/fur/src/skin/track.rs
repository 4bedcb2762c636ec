//! Keyed values over time.

use glam::{DVec4, Quat, Vec3, Vec4};

use crate::error::{Error, range};
use crate::numeric::{LEAST_SPLINE, MAX_COORDINATE, UNIT_QUATERNION};

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
    /// A value and a multiple of a tangent, not settled.
    fn ahead(value: Self, tangent: Self, factor: f32) -> Self;
    /// How far two values are apart: a distance, or the angle between rotations in radians.
    fn apart(a: Self, b: Self) -> f64;
    /// No less than the way of a spline over a part of the time between two keys, 0 to 1, by the
    /// control points of its Bezier curve; infinite for rotations that come near to zero.
    fn spline_way(control: [Self; 4], part: [f64; 2]) -> f64;
}

/// No less than the speed of a cubic Bezier curve, for each unit of its parameter: the derivative
/// is a mean of three differences of its control points.
fn speed([a, b, c, d]: [DVec4; 4]) -> f64 {
    3.0 * (b - a).length().max((c - b).length()).max((d - c).length())
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

    fn ahead(value: Self, tangent: Self, factor: f32) -> Self {
        value + tangent * factor
    }

    fn apart(a: Self, b: Self) -> f64 {
        a.as_dvec3().distance(b.as_dvec3())
    }

    fn spline_way(control: [Self; 4], [from, to]: [f64; 2]) -> f64 {
        speed(control.map(|p| p.as_dvec3().extend(0.0))) * (to - from)
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
        let sum =
            terms.into_iter().map(|(value, factor)| glam::Vec4::from(value) * factor).sum::<glam::Vec4>();
        // Keys that cancel each other leave no rotation: the nearer one holds.
        let nearer = if terms[0].1 >= terms[2].1 { terms[0].0 } else { terms[2].0 };
        Quat::from_vec4(sum.try_normalize().unwrap_or(nearer.into()))
    }

    fn settled(self) -> Self {
        self.normalize()
    }

    fn ahead(value: Self, tangent: Self, factor: f32) -> Self {
        Quat::from_vec4(Vec4::from(value) + Vec4::from(tangent) * factor)
    }

    fn apart(a: Self, b: Self) -> f64 {
        let [a, b] = [a, b].map(|q| Vec4::from(q).as_dvec4().normalize_or_zero());
        // The same rotation has two signs. Half the chord is the sine of a quarter of the angle.
        4.0 * (0.5 * (a - b).length().min((a + b).length())).asin()
    }

    fn spline_way(control: [Self; 4], part: [f64; 2]) -> f64 {
        let [a, b, c, d] = control.map(|q| Vec4::from(q).as_dvec4());
        let way = speed([a, b, c, d]) * (part[1] - part[0]);
        let length = |t: f64| {
            let [p, q, r] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
            p.lerp(q, t).lerp(q.lerp(r, t), t).length()
        };
        // From the nearer end it is at most half the way.
        let least = length(part[0]).min(length(part[1])) - 0.5 * way;
        if least < LEAST_SPLINE { f64::INFINITY } else { 2.0 * way / least }
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
    pub fn new(times: Vec<f32>, values: Vec<T>, interpolation: Interpolation) -> Result<Self, Error> {
        if times.is_empty() {
            return Err(Error::Keys { key: 0, why: "is missing: a track needs at least one" });
        }
        for (key, &time) in times.iter().enumerate() {
            range(
                "the time of a key in seconds",
                time.into(),
                -f64::from(MAX_COORDINATE),
                MAX_COORDINATE.into(),
            )?;
            if key > 0 && times[key - 1] > time {
                return Err(Error::Keys { key, why: "comes before the key in front of it" });
            }
        }
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let expected = times.len().saturating_mul(per_key);
        if values.len() != expected {
            return Err(Error::Count { what: "values of keys", found: values.len(), expected });
        }
        for (i, value) in values.iter().enumerate() {
            let is_tangent = per_key == 3 && i % 3 != 1;
            if !(if is_tangent { value.is_finite() } else { value.is_sound() }) {
                return Err(Error::Keys {
                    key: i / per_key,
                    why: "is not finite, too great, or no rotation",
                });
            }
        }
        let settled =
            |(i, value): (usize, T)| if per_key == 3 && i % 3 != 1 { value } else { value.settled() };
        let values = values.into_iter().enumerate().map(settled).collect();
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
        self.between(next - 1, time)
    }

    /// The value of a key.
    fn value(&self, key: usize) -> T {
        self.values[if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key }]
    }

    /// The value behind a key and before the next.
    fn between(&self, i: usize, time: f32) -> T {
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

    /// No less than how far the value is from that at `middle` at any time of a stretch, ends
    /// included. Costs two binary searches and the keys in the stretch.
    ///
    /// Between two times a and b without a key between them a value is on a way from that at a to
    /// that at b: one that is w long leads no farther from the middle than half the sum of w and of
    /// both ends' distances.
    pub(crate) fn spread(&self, [from, to]: [f32; 2], middle: f32) -> f64 {
        let center = self.at(middle);
        let mut most = T::apart(self.at(from), center).max(T::apart(self.at(to), center));
        let first = self.times.partition_point(|&t| t <= from).saturating_sub(1);
        for i in first..self.times.len() {
            if self.times[i] > to {
                break;
            }
            if self.times[i] >= from {
                most = most.max(T::apart(self.value(i), center));
            }
            let Some(&next) = self.times.get(i + 1).filter(|next| **next > from) else { continue };
            // Cut in the middle, where nothing is apart.
            let (start, end) = (self.times[i].max(from), next.min(to));
            let cut = middle.clamp(start, end);
            most = most.max(self.way(i, [start, cut], center)).max(self.way(i, [cut, end], center));
        }
        most
    }

    /// The same behind one key and before the next.
    fn way(&self, i: usize, [from, to]: [f32; 2], center: T) -> f64 {
        let [a, b] = [from, to].map(|time| self.between(i, time));
        let way = match self.interpolation {
            Interpolation::Step => 0.0,
            Interpolation::Linear => T::apart(a, b),
            Interpolation::CubicSpline => {
                let dt = self.times[i + 1] - self.times[i];
                let (p, q) = (self.value(i), self.value(i + 1));
                let (out, into) = (self.values[3 * i + 2], self.values[3 * i + 3]);
                let control = [p, T::ahead(p, out, dt / 3.0), T::ahead(q, into, -dt / 3.0), q];
                let part =
                    [from, to].map(|t| f64::from(t - self.times[i]) / f64::from(dt).max(f64::MIN_POSITIVE));
                if to > from { T::spline_way(control, part) } else { 0.0 }
            }
        };
        0.5 * (T::apart(a, center) + T::apart(b, center) + way)
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
