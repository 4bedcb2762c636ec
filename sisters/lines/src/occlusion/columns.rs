//! The occlusion by columns of slices.

use glam::Vec3;

use super::options::{AoOptions, Estimator};
use super::prism::{Hemisphere, Prism};
use crate::numeric::{GROUP, LEAST_KNOWN, LEAST_SINE, MEAN_SINE, SECTORS};
use crate::samples::Sample;
use crate::slabs::{SlabGrid, mask};

/// The columns that an estimate counts in.
pub(super) struct Columns<'a> {
    pub(super) grid: &'a SlabGrid,
    pub(super) options: &'a AoOptions,
}

impl Columns<'_> {
    /// The occlusion of a hemisphere, not yet clamped.
    pub(super) fn at(&self, above: &Hemisphere, tangent: Vec3, set: &[Sample]) -> f32 {
        match self.options.estimator {
            Estimator::MeanOfRatios { factor } => self.shares(above, tangent, set).mean() * factor,
            Estimator::RatioOfSums { factor } => self.shares(above, tangent, set).ratio() * factor,
            Estimator::Extinction { k } => 1.0 - (-k * self.shares(above, tangent, set).mean()).exp(),
            Estimator::OpticalDepth { line_radius } => self.stopped(above, set, line_radius),
            Estimator::Rays { .. } | Estimator::Places { .. } => 0.0,
        }
    }

    /// The prism of a sample, its column, and the range of its depths; `None` where there is
    /// nothing or nothing is known.
    fn prism(&self, above: &Hemisphere, sample: &Sample) -> Option<(Prism, [u32; 2], [f64; 2])> {
        let prism = above.prism(sample.at, self.options.plane, 0.0)?;
        let column = self.grid.view().pixel(above.place(prism.start))?;
        Some((prism, column, above.depths(&prism)))
    }

    /// The set slices of the columns and all slices, weighted as the thesis does.
    fn shares(&self, above: &Hemisphere, tangent: Vec3, set: &[Sample]) -> Shares {
        let mut shares = Shares::default();
        for sample in set {
            let Some((prism, [x, y], depths)) = self.prism(above, sample) else { continue };
            let count = self.grid.count(x, y, depths);
            if count.total == 0 {
                continue;
            }
            let ends = [prism.at(prism.from), prism.at(prism.to)];
            let (mut near, mut sine) = (1.0, [1.0; 2]);
            if self.options.by_distance {
                // In radii: the thesis' units would make the result depend on the size of the
                // scene.
                let mean = (ends[0].length() + ends[1].length()) / 2.0;
                near = 1.0 / (mean * mean);
            }
            if self.options.by_angle {
                sine = ends.map(|e| tangent.cross(e.normalize_or_zero()).length());
            }
            let (mean_sine, first_sine) = ((sine[0] + sine[1]) / 2.0, sine[0].max(LEAST_SINE));
            let (on, total) = (count.on as f32, count.total as f32);
            shares.ratios += on * mean_sine * near / (total * first_sine);
            shares.columns += 1.0;
            shares.on += on * mean_sine * near;
            shares.total += total * mean_sine * near;
        }
        shares
    }

    /// The share of cosine-weighted rays that tubes of a radius stop.
    fn stopped(&self, above: &Hemisphere, set: &[Sample], line_radius: f32) -> f32 {
        let mut sectors = [Sector::default(); SECTORS];
        let mut all = 0.0;
        let view = self.grid.view();
        let [near, far] = view.depths();
        // All lengths are in radii from here on.
        let radius = f64::from(above.radius);
        let side = |depth: f64| (view.pixel_size(depth) / radius) as f32;
        let slice = ((far - near) / (f64::from(self.grid.slices().count()) * radius)) as f32;
        let pixel = side(f64::from(-above.middle.z));
        let pole = above.pole.abs();
        // Half of a cell in the direction of the pole: cells that the base plane cuts may hold the
        // receiver's own line. They are taken as unknown: the cells above them stand for them, too.
        let lift = (pixel * (pole.x + pole.y) + slice * pole.z) / 2.0;
        for sample in set {
            let Some(prism) = above.prism(sample.at, self.options.plane, lift) else { continue };
            let weight = prism.weight(above.pole) * sample.area;
            all += weight;
            let Some([x, y]) = view.pixel(above.place(prism.start)) else { continue };
            let Some(slices) = self.grid.slices_in(above.depths(&prism)) else { continue };
            let sector = &mut sectors[sector_of(sample)];
            sector.weight += weight;
            let base = above.base(&prism);
            let lines = self.in_column([x, y], slices, |depth| {
                let from = prism.at(((depth - base) / radius) as f32);
                let (height, distance, side) = (above.pole.dot(from), from.length(), side(depth));
                let inside = height > lift && distance < 1.0;
                if inside { height / (std::f32::consts::PI * distance.powi(3) * side * side) } else { 0.0 }
            });
            sector.stopped += sample.area * (lines / radius) as f32;
        }
        let known: f32 = sectors.iter().map(|s| s.weight).sum();
        if known <= all * LEAST_KNOWN {
            return 0.0;
        }
        let hidden = |s: &Sector| {
            let width = (2.0 * f64::from(line_radius) / radius) as f32;
            let depth = width * MEAN_SINE * s.stopped / s.weight;
            if s.weight > 0.0 { s.weight * (1.0 - (-depth).exp()) } else { 0.0 }
        };
        sectors.iter().map(hidden).sum::<f32>() / known
    }

    /// The sum over the set slices of a column of the length of lines in each times a weight of its
    /// depth. The length of a group of slices is spread evenly over those that are set.
    fn in_column(&self, [x, y]: [u32; 2], [first, last]: [u32; 2], weight: impl Fn(f64) -> f32) -> f64 {
        let (column, lengths) = (self.grid.column(x, y), self.grid.lengths(x, y));
        let mut sum = 0.0;
        for (group, &length) in (first / GROUP..=last / GROUP).zip(&lengths[(first / GROUP) as usize..]) {
            let (word, at) = (column[(group * GROUP / 128) as usize], group * GROUP % 128);
            let on = (word & mask(at, at + GROUP - 1, 0)).count_ones();
            let mut left = word & mask(at, at + GROUP - 1, 0) & mask(first, last, group * GROUP / 128);
            let mut weights = 0.0;
            while left != 0 {
                weights += weight(self.grid.slice_depth(group * GROUP / 128 * 128 + left.trailing_zeros()));
                left &= left - 1;
            }
            if weights > 0.0 {
                sum += f64::from(length) * f64::from(weights) / f64::from(on);
            }
        }
        sum
    }
}

/// Sums over the columns of a part.
#[derive(Debug, Clone, Copy, Default)]
struct Sector {
    /// The share of the directions times the way in them.
    weight: f32,
    /// The length of the lines, weighted likewise.
    stopped: f32,
}

/// Sums over the columns of a hemisphere.
#[derive(Debug, Default)]
struct Shares {
    ratios: f32,
    columns: f32,
    on: f32,
    total: f32,
}

impl Shares {
    fn mean(&self) -> f32 {
        if self.columns > 0.0 { self.ratios / self.columns } else { 0.0 }
    }

    fn ratio(&self) -> f32 {
        if self.total > 0.0 { self.on / self.total } else { 0.0 }
    }
}

/// The part of the disc that a sample lies in: an eighth of the circle.
pub fn sector_of(sample: &Sample) -> usize {
    let p = sample.at;
    usize::from(p.x > 0.0) + 2 * usize::from(p.y > 0.0) + 4 * usize::from(p.x.abs() > p.y.abs())
}
