//! How much of the hemisphere above a line is hidden by other lines (Benevides 2015, section 3.3).
//!
//! The hemisphere of a radius R has its base tangent to the line and its pole turned to the viewer. Samples of a disc choose
//! columns of a [`SlabGrid`]; each is clipped to the hemisphere, and its set slices are counted. What the counts become is the
//! [`Estimator`]'s matter.
//!
//! The thesis multiplies the share of set slices by a factor. That share is proportional to the width of a column and the
//! thickness of a slice, so its result fades with a finer grid. [`Estimator::OpticalDepth`] asks instead how far light gets: lines of
//! a radius r and a length L in a volume V hide 2 r L sin(angle) / V of a ray for each unit of its way, and a share exp(-sum) of the
//! rays passes. L comes from the columns' lengths, so nothing depends on the grid but the noise.

mod prism;
#[cfg(test)]
mod tests;

use glam::Vec3;
use rayon::prelude::*;

use crate::buffers::{Fragment, LineBuffer};
use crate::numeric::{LEAST_KNOWN, LEAST_SINE, hash};
use crate::samples::{Sample, SampleSets};
use crate::slabs::SlabGrid;
use prism::{Hemisphere, Prism};

/// The mean sine of the angle between a line and a ray, if all directions are alike: pi / 4.
const MEAN_SINE: f32 = std::f32::consts::FRAC_PI_4;

/// How the counts of the columns become an occlusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Estimator {
    /// The mean of the columns' shares of set slices, times a factor; the thesis' table 3.1.
    MeanOfRatios {
        /// The thesis uses 4.
        factor: f32,
    },
    /// All set slices over all slices of the columns, weighted alike, times a factor; the thesis' equation 3.4.
    RatioOfSums {
        /// As above.
        factor: f32,
    },
    /// 1 - exp(-k x), where x is the mean of ratios: the share of the light that a medium of density x takes.
    Extinction {
        /// About 10 for the thesis' grids; it depends on the grid.
        k: f32,
    },
    /// The share of cosine-weighted rays that the lines stop, as tubes of a radius. Only noise and blur depend on the grid: finer
    /// columns hold thin lines more rarely, so that fewer samples meet one; coarser ones and few slices blur dense bundles. Lines
    /// along the view need coarse columns, a third to an eighth of the picture's rows.
    OpticalDepth {
        /// The radius of the tubes, in units of the scene.
        line_radius: f32,
    },
}

/// Which slices of a column lie in the hemisphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BasePlane {
    /// Those above the plane that is tangent to the line.
    #[default]
    Tangent,
    /// Those above that plane mirrored in depth, as the sign in the thesis' equation 3.17 has it. For comparison only.
    ThesisSign,
}

/// Which set of samples a pixel takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SetChoice {
    /// The same for all: patterns show.
    One,
    /// By the pixel, as in the thesis: noise stands still on the screen while lines move under it, so they flicker.
    Screen,
    /// By the line and the place along it, in steps of this length in units of the scene: noise moves with the line.
    Surface {
        /// Greater than 0.
        step: f32,
    },
}

/// What an estimate is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AoOptions {
    /// The radius of the hemisphere in units of the scene. The thesis takes 0.13 of the scene's extent.
    pub radius: f32,
    /// How counts become an occlusion.
    pub estimator: Estimator,
    /// Whether near columns count more (by the inverse square of the distance over the radius). Only for the first three estimators;
    /// the last one weighs each slice by its solid angle.
    pub by_distance: bool,
    /// Whether columns beside the line count more than those along it, likewise.
    pub by_angle: bool,
    /// Which slices lie in the hemisphere.
    pub plane: BasePlane,
    /// Which samples a pixel takes.
    pub choice: SetChoice,
}

/// Why options were refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OptionsError {
    /// The radius of the hemisphere.
    #[error(
        "a radius of {0}: it must be greater than 0 and finite, and its square must be neither 0 nor infinite"
    )]
    Radius(f32),
    /// The factor, k or line radius of the estimator.
    #[error("an estimator with {0}: it must be 0 or more and finite")]
    Estimator(f32),
    /// The step of [`SetChoice::Surface`].
    #[error("a step of {0} along lines: it must be greater than 0")]
    Step(f32),
}

impl AoOptions {
    /// The best estimator, for tubes of a radius; samples are fixed to the lines.
    pub fn new(radius: f32, line_radius: f32) -> Self {
        let estimator = Estimator::OpticalDepth { line_radius };
        let choice = SetChoice::Surface { step: radius / 8.0 };
        Self { radius, estimator, by_distance: true, by_angle: true, plane: BasePlane::Tangent, choice }
    }

    /// The thesis' own method: table 3.1 with its factor, samples by the pixel.
    pub fn thesis(radius: f32) -> Self {
        let estimator = Estimator::MeanOfRatios { factor: 4.0 };
        Self { estimator, choice: SetChoice::Screen, ..Self::new(radius, 0.0) }
    }

    fn check(&self) -> Result<(), OptionsError> {
        let square = self.radius * self.radius;
        if !(self.radius > 0.0 && square.is_normal()) {
            return Err(OptionsError::Radius(self.radius));
        }
        let value = match self.estimator {
            Estimator::MeanOfRatios { factor } | Estimator::RatioOfSums { factor } => factor,
            Estimator::Extinction { k } => k,
            Estimator::OpticalDepth { line_radius } => line_radius,
        };
        if !(value >= 0.0 && value.is_finite()) {
            return Err(OptionsError::Estimator(value));
        }
        match self.choice {
            SetChoice::Surface { step } if step.is_nan() || step <= 0.0 => Err(OptionsError::Step(step)),
            _ => Ok(()),
        }
    }
}

/// An estimate of the occlusion at points of lines: 0 in the open, 1 where nothing gets through.
#[derive(Debug, Clone, Copy)]
pub struct Occlusion<'a> {
    grid: &'a SlabGrid,
    samples: &'a SampleSets,
    options: AoOptions,
}

impl<'a> Occlusion<'a> {
    /// The grid may have other pixels than the picture, but must be made for the same eye and direction.
    ///
    /// # Errors
    /// If an option is out of its range.
    pub fn new(
        grid: &'a SlabGrid,
        samples: &'a SampleSets,
        options: AoOptions,
    ) -> Result<Self, OptionsError> {
        options.check()?;
        Ok(Self { grid, samples, options })
    }

    /// The occlusion in all pixels, row by row; 0 where there is no line. Time: proportional to the pixels with lines and to the
    /// samples of a set.
    pub fn of(&self, buffer: &LineBuffer) -> Vec<f32> {
        let width = buffer.view().size()[0] as usize;
        let at = |(i, fragment): (usize, &Option<Fragment>)| {
            let set = |f: &Fragment| self.set_of(f, [(i % width) as u32, (i / width) as u32]);
            fragment.as_ref().map_or(0.0, |f| self.at(f, set(f)))
        };
        buffer.fragments().par_iter().enumerate().map(at).collect()
    }

    /// The number of the set of samples that a fragment takes.
    pub fn set_of(&self, fragment: &Fragment, pixel: [u32; 2]) -> usize {
        let key = match self.options.choice {
            SetChoice::One => return 0,
            SetChoice::Screen => u64::from(pixel[0]) << 32 | u64::from(pixel[1]),
            SetChoice::Surface { step } => u64::from(fragment.line) << 32 | (fragment.along / step) as u64,
        };
        (hash(key) % self.samples.count() as u64) as usize
    }

    /// The occlusion at a fragment, by a set of samples.
    pub fn at(&self, fragment: &Fragment, set: usize) -> f32 {
        let Some(above) = Hemisphere::new(fragment, self.options.radius, self.grid.view()) else {
            return 0.0;
        };
        let set = self.samples.set(set);
        let value = match self.options.estimator {
            Estimator::MeanOfRatios { factor } => self.shares(&above, fragment.tangent, set).mean() * factor,
            Estimator::RatioOfSums { factor } => self.shares(&above, fragment.tangent, set).ratio() * factor,
            Estimator::Extinction { k } => {
                1.0 - (-k * self.shares(&above, fragment.tangent, set).mean()).exp()
            }
            Estimator::OpticalDepth { line_radius } => self.stopped(&above, set, line_radius),
        };
        if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The prism of a sample, its column, and the range of its depths; `None` where there is nothing or nothing is known.
    fn prism(&self, above: &Hemisphere, sample: &Sample) -> Option<(Prism, [u32; 2], [f64; 2])> {
        let prism = above.prism(sample.at, self.options.plane, 0.0)?;
        let column = self.grid.view().pixel(above.middle + prism.start)?;
        let base = above.depth(&prism);
        Some((prism, column, [base + prism.from, base + prism.to].map(f64::from)))
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
                // Over the radius: the thesis' units would make the result depend on the size of the scene.
                let mean = (ends[0].length() + ends[1].length()) / (2.0 * above.radius);
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
        let slice = (far - near) as f32 / self.grid.slices().count() as f32;
        let pixel = view.pixel_size(f64::from(-above.middle.z)) as f32;
        let pole = above.pole.abs();
        // Half of a cell in the direction of the pole: cells that the base plane cuts may hold the receiver's own line. They are
        // taken as unknown: the cells above them stand for them, too.
        let lift = (pixel * (pole.x + pole.y) + slice * pole.z) / 2.0;
        for sample in set {
            let Some(prism) = above.prism(sample.at, self.options.plane, lift) else { continue };
            let weight = prism.weight(above.pole) * sample.area * above.radius * above.radius;
            all += weight;
            let base = above.depth(&prism);
            let Some([x, y]) = view.pixel(above.middle + prism.start) else { continue };
            let range = [base + prism.from, base + prism.to].map(f64::from);
            let Some(slices) = self.grid.slices_in(range) else { continue };
            let sector = &mut sectors[sector_of(sample)];
            sector.weight += weight;
            let lines = self.in_column([x, y], slices, |depth| {
                let from = prism.at(depth - base);
                let (height, distance) = (above.pole.dot(from), from.length());
                let side = view.pixel_size(f64::from(depth)) as f32;
                let inside = height > lift && distance < above.radius;
                if inside { height / (std::f32::consts::PI * distance.powi(3) * side * side) } else { 0.0 }
            });
            sector.stopped += sample.area * above.radius * above.radius * lines;
        }
        let known: f32 = sectors.iter().map(|s| s.weight).sum();
        if known <= all * LEAST_KNOWN {
            return 0.0;
        }
        let hidden = |s: &Sector| {
            let depth = 2.0 * line_radius * MEAN_SINE * above.radius * s.stopped / s.weight;
            if s.weight > 0.0 { s.weight * (1.0 - (-depth).exp()) } else { 0.0 }
        };
        sectors.iter().map(hidden).sum::<f32>() / known
    }

    /// The sum over the set slices of a column of the length of lines in each times a weight of its depth.
    fn in_column(&self, [x, y]: [u32; 2], [first, last]: [u32; 2], weight: impl Fn(f32) -> f32) -> f32 {
        let column = self.grid.column(x, y);
        let on = column[0].count_ones() + column[1].count_ones();
        if on == 0 {
            return 0.0;
        }
        let mut sum = 0.0;
        for (mut word, i) in column.into_iter().zip(0..) {
            word &= crate::slabs::mask(first, last, i);
            while word != 0 {
                sum += weight(self.grid.slice_depth(i * 128 + word.trailing_zeros()) as f32);
                word &= word - 1;
            }
        }
        sum * self.grid.length(x, y) / on as f32
    }
}

/// Parts of the disc of samples. Lines on one side do not hide light from the other: each part is a medium of its own.
const SECTORS: usize = 8;

/// Sums over the columns of a part.
#[derive(Debug, Clone, Copy, Default)]
struct Sector {
    /// The share of the directions times the way in them.
    weight: f32,
    /// The length of the lines, weighted likewise.
    stopped: f32,
}

/// The part of a sample: an eighth of the circle.
fn sector_of(sample: &Sample) -> usize {
    let p = sample.at;
    usize::from(p.x > 0.0) + 2 * usize::from(p.y > 0.0) + 4 * usize::from(p.x.abs() > p.y.abs())
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
