//! The occlusion by columns of slices, as in the thesis' table 3.1: the mean of the columns' shares
//! of set slices, weighted by angle and distance, times a factor.
//!
//! The share is proportional to the width of a column and the depth of a slice, so that the result
//! fades with a finer grid and with zoom: rays replaced it. It is here for comparison.

use glam::{Vec2, Vec3};

use super::hemisphere::Hemisphere;
use crate::numeric::{LEAST_SINE, PARALLEL};
use crate::slabs::SlabGrid;

/// A column in the hemisphere. Its points are `start + t * step` from the receiver, for `t` from
/// `from` to `to`; `t` is a depth, counted from that of `start`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prism {
    /// The sampled point of the disc, from the receiver.
    pub(super) start: Vec3,
    /// The motion along the column for each unit of depth.
    pub(super) step: Vec3,
    pub(super) from: f32,
    pub(super) to: f32,
}

impl Prism {
    /// The column through a sample of the disc of a hemisphere; `None` where it lies outside.
    pub(super) fn new(above: &Hemisphere, sample: Vec2) -> Option<Self> {
        let start = above.across[0] * sample.x + above.across[1] * sample.y;
        let step = match above.perspective {
            true => {
                let place = above.place(start);
                place / -place.z
            }
            false => Vec3::NEG_Z,
        };
        let (a, b) = (step.length_squared(), step.dot(start));
        let root = b * b - a * (start.length_squared() - 1.0);
        if root.is_nan() || root <= 0.0 {
            return None;
        }
        let (mut from, mut to) = ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a);
        let (height, slope) = (above.pole.dot(start), above.pole.dot(step));
        if slope.abs() < PARALLEL {
            return (height >= 0.0).then_some(Self { start, step, from, to });
        }
        // The thesis' equation 3.17 has the other sign, which mirrors the hemisphere in depth. The
        // pole may turn away from the viewer in perspective: the column then enters the hemisphere
        // through its base.
        let crossing = -height / slope;
        if slope < 0.0 {
            to = to.min(crossing)
        } else {
            from = from.max(crossing)
        }
        (from < to).then_some(Self { start, step, from, to })
    }

    /// A point of the column, from the receiver.
    pub(super) fn at(&self, t: f32) -> Vec3 {
        self.start + self.step * t
    }

    /// The range of depths, in units of the scene.
    fn depths(&self, above: &Hemisphere) -> [f64; 2] {
        let radius = f64::from(above.radius);
        let base = -f64::from(above.middle.z) - f64::from(self.start.z) * radius;
        [self.from, self.to].map(|t| base + f64::from(t) * radius)
    }
}

/// The occlusion of a hemisphere, not yet clamped, by the columns that a set of samples chooses.
/// Columns outside of the picture are not known, and left out.
pub(super) fn share(grid: &SlabGrid, above: &Hemisphere, tangent: Vec3, set: &[Vec2], factor: f32) -> f32 {
    let (mut ratios, mut columns) = (0.0, 0.0);
    for &sample in set {
        let Some(prism) = Prism::new(above, sample) else { continue };
        let Some([x, y]) = grid.view().pixel(above.place(prism.start)) else { continue };
        let [on, all] = grid.count(x, y, prism.depths(above));
        if all == 0 {
            continue;
        }
        let ends = [prism.at(prism.from), prism.at(prism.to)];
        // In radii: the thesis' units would make the result depend on the size of the scene.
        let distance = (ends[0].length() + ends[1].length()) / 2.0;
        let sine = ends.map(|e| tangent.cross(e.normalize_or_zero()).length());
        let sines = (sine[0] + sine[1]) / 2.0 / sine[0].max(LEAST_SINE);
        ratios += on as f32 / all as f32 * sines / (distance * distance);
        columns += 1.0;
    }
    if columns > 0.0 { ratios / columns * factor } else { 0.0 }
}
