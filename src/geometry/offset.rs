//! Offsets between coordinates in double precision, with sums whose rounding is known exactly.

use glam::{DVec3, Vec3};

use crate::geometry::block::{above, below};

/// How the coordinates of shapes become others: a point `p` of a shape is at `p + by`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Offset {
    pub(crate) by: DVec3,
    /// The true offset differs from `by` by this along each axis at most: 0 where it is exact.
    pub(crate) error: f64,
}

/// A sum of two numbers, and its rounding error, which is exact (Knuth's two-sum).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let back = sum - a;
    (sum, (a - (sum - back)) + (b - back))
}

/// A number that is not less than the sum of two, and the second one is not negative.
fn up(a: f64, b: f64) -> f64 {
    if b == 0.0 { a } else { (a + b).next_up() }
}

impl Offset {
    /// Coordinates that stay as they are.
    pub(crate) const NONE: Self = Self { by: DVec3::ZERO, error: 0.0 };

    /// Of shapes relative to a place, to coordinates relative to an origin.
    pub(crate) fn between(place: DVec3, origin: DVec3) -> Self {
        let sums = [0, 1, 2].map(|axis| two_sum(place[axis], -origin[axis]));
        let error = sums.iter().map(|(_, lost)| lost.abs()).fold(0.0, f64::max);
        Self { by: DVec3::from_array(sums.map(|(sum, _)| sum)), error }
    }

    /// The offset in single precision, where that and the offset itself are exact.
    pub(crate) fn single(&self) -> Option<Vec3> {
        let single = self.by.as_vec3();
        (self.error == 0.0 && single.as_dvec3() == self.by).then_some(single)
    }

    /// A coordinate along an axis, and how far it is from the true one at most.
    fn sum(&self, axis: usize, p: f64) -> (f64, f64) {
        let (sum, lost) = two_sum(p, self.by[axis]);
        (sum, up(lost.abs(), self.error))
    }

    /// The greatest point in single precision that is not greater than the true one on any axis.
    pub(crate) fn below(&self, p: Vec3) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| {
            let (sum, off) = self.sum(axis, f64::from(p[axis]));
            below(if off == 0.0 { sum } else { (sum - off).next_down() })
        }))
    }

    /// The least point in single precision that is not less than the true one on any axis.
    pub(crate) fn above(&self, p: Vec3) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| {
            let (sum, off) = self.sum(axis, f64::from(p[axis]));
            above(if off == 0.0 { sum } else { (sum + off).next_up() })
        }))
    }

    /// A point in single precision, and a distance from the true one that is not exceeded.
    pub(crate) fn nearest(&self, p: Vec3) -> (Vec3, f64) {
        let (mut at, mut far) = (Vec3::ZERO, 0.0);
        for axis in 0..3 {
            let (sum, off) = self.sum(axis, f64::from(p[axis]));
            at[axis] = sum as f32;
            far = up(far, up((f64::from(at[axis]) - sum).abs(), off));
        }
        (at, far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn sums_are_bounded_from_both_sides_and_exact_ones_do_not_round() {
        let mut random = Random::new(3);
        for _ in 0..2000 {
            let (place, origin) = (random.point(1e7), random.point(1e7).round());
            let offset = Offset::between(place, origin);
            let p = random.point(100.0).as_vec3();
            let (low, high, (at, far)) = (offset.below(p), offset.above(p), offset.nearest(p));
            for axis in 0..3 {
                // In whole numbers of 2^-60, which hold all digits of these.
                let whole = |v: f64| (v * 2f64.powi(60)) as i128;
                let lost = |v: f64| whole(v) as f64 * 2f64.powi(-60) - v;
                assert_eq!((lost(place[axis]), lost(origin[axis])), (0.0, 0.0));
                let exact = whole(place[axis]) - whole(origin[axis]) + whole(f64::from(p[axis]));
                let (low, high) = (whole(f64::from(low[axis])), whole(f64::from(high[axis])));
                assert!(low <= exact && exact <= high, "{low} {exact} {high}");
                let off = (whole(f64::from(at[axis])) - exact).unsigned_abs() as f64 * 2f64.powi(-60);
                assert!(off <= far, "{off} {far}");
            }
        }
        let exact = Offset::between(DVec3::splat(1_048_576.0), DVec3::splat(1_048_064.0));
        let p = Vec3::new(0.25, 17.5, -300.125);
        assert_eq!((exact.below(p), exact.above(p)), (p + 512.0, p + 512.0));
        assert_eq!((exact.nearest(p), exact.single()), ((p + 512.0, 0.0), Some(Vec3::splat(512.0))));
        assert_eq!(Offset::between(DVec3::splat(0.1), DVec3::splat(-4096.0)).single(), None);
    }
}
