//! One set of lines in one view, with the true occlusion at some of the pixels that show a line.

use casca_lines::LineSet;
use casca_lines::buffers::{Fragment, LineBuffer};
use casca_lines::occlusion::{AoOptions, Estimator, Occlusion};
use casca_lines::samples::SampleSets;
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::slabs::{SlabGrid, Slices, SpanRule};
use casca_lines::view::View;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::clock::timed;
use super::score::fit;
use super::truth::Tubes;
use crate::experiments::LabError;

/// The radius of hemispheres as a share of the scene's extent, as in the thesis.
pub const RADIUS: f64 = 0.13;

/// Samples of a set, as in the thesis.
pub const SAMPLES: u32 = 150;

/// Sets of samples.
const SETS: u32 = 16;

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Width and height of the picture in pixels.
    pub canvas: u32,
    /// Pixels at which estimates are compared with the truth.
    pub receivers: usize,
    /// The square root of the rays at each.
    pub rays: usize,
    /// Seconds that a measurement takes at least.
    pub seconds: f64,
    /// Seed of lines, samples and rays.
    pub seed: u64,
}

/// A pixel at which an estimate is compared with the truth.
pub type Receiver = ([u32; 2], Fragment);

/// A set of lines in a view.
pub struct Case {
    /// The lines.
    pub lines: LineSet,
    /// The view.
    pub view: View,
    /// Some of them.
    pub receivers: Vec<Receiver>,
    /// The true occlusion at each.
    pub truth: Vec<f64>,
    /// The radius of hemispheres.
    pub radius: f32,
    /// The radius of the tubes, half a pixel.
    pub line_radius: f32,
    tubes: Tubes,
}

/// The direction that a family is seen from: the lines of `Parallel` point at the viewer.
pub fn seen_from(family: Family) -> Vec3 {
    if family == Family::Parallel { Vec3::Z } else { Vec3::new(0.5, 0.6, 1.0) }
}

/// The direction away from a line that turns most to the viewer, in the world.
fn pole(fragment: &Fragment, view: &View) -> DVec3 {
    let (tangent, viewer) = (fragment.tangent.as_dvec3(), DVec3::Z);
    let pole = (viewer - tangent * tangent.dot(viewer)).try_normalize().unwrap_or(viewer);
    view.eye_from_world().matrix3.transpose() * pole
}

impl Case {
    /// A family in an orthographic view.
    ///
    /// # Errors
    /// If the library refuses the view.
    pub fn new(family: Family, sampling: &Sampling) -> Result<Self, LabError> {
        let lines = Recipe::new(family, sampling.seed).make()?;
        let bounds = lines.bounds();
        let view = View::around(bounds, seen_from(family), None, [sampling.canvas; 2])?;
        let buffer = LineBuffer::new(&lines, &view);
        let width = sampling.canvas as usize;
        let at =
            |(i, f): (usize, &Option<Fragment>)| f.map(|f| ([(i % width) as u32, (i / width) as u32], f));
        let all: Vec<Receiver> = buffer.fragments().iter().enumerate().filter_map(at).collect();
        let step = all.len().div_ceil(sampling.receivers.max(1)).max(1);
        let receivers: Vec<Receiver> = all.iter().step_by(step).copied().collect();
        let line_radius = view.pixel_size(1.0) / 2.0;
        let mut case = Self {
            tubes: Tubes::new(&lines, line_radius),
            radius: (RADIUS * f64::from((bounds[1] - bounds[0]).max_element())) as f32,
            line_radius: line_radius as f32,
            truth: Vec::new(),
            lines,
            view,
            receivers,
        };
        case.truth = case.rays(&case.view, &case.receivers, sampling);
        Ok(case)
    }

    /// The same with every n-th receiver only.
    #[must_use]
    pub fn thinned(mut self, n: usize) -> Self {
        self.receivers = self.receivers.iter().step_by(n.max(1)).copied().collect();
        self.truth = self.truth.iter().step_by(n.max(1)).copied().collect();
        self
    }

    /// The true occlusion at receivers of a view.
    pub fn rays(&self, view: &View, receivers: &[Receiver], sampling: &Sampling) -> Vec<f64> {
        let one = |(i, (_, f)): (usize, &Receiver)| {
            let seed = sampling.seed ^ (i as u64) << 20;
            let at = view.to_world(f.position);
            self.tubes.occlusion(at, pole(f, view), f64::from(self.radius), sampling.rays, seed)
        };
        receivers.par_iter().enumerate().map(one).collect()
    }

    /// A grid of the lines, with other pixels than the picture.
    ///
    /// # Errors
    /// If a side would have no pixel, or too many.
    pub fn grid(&self, height: u32, slices: Slices) -> Result<SlabGrid, LabError> {
        Ok(SlabGrid::of_lines(&self.lines, &self.view.with_height(height)?, slices, SpanRule::Span))
    }

    /// Sets of samples, at most as many in all as the library takes.
    ///
    /// # Errors
    /// If there are too many samples.
    pub fn samples(samples: u32, seed: u64) -> Result<SampleSets, LabError> {
        Ok(SampleSets::new(samples, SETS.min(8192 / samples.max(1)).max(1), seed)?)
    }

    /// Estimates at receivers, and the microseconds that one takes on one thread; measured for some
    /// seconds at least.
    ///
    /// # Errors
    /// If an option is out of its range.
    pub fn estimate(
        grid: &SlabGrid,
        samples: &SampleSets,
        options: AoOptions,
        receivers: &[Receiver],
        seconds: f64,
    ) -> Result<(Vec<f64>, f64), LabError> {
        let occlusion = Occlusion::new(grid, samples, options)?;
        let at = |(pixel, f): &Receiver| f64::from(occlusion.at(f, occlusion.set_of(f, *pixel)));
        let (time, values) = timed(seconds, || receivers.iter().map(at).collect());
        Ok((values, time * 1e6 / receivers.len().max(1) as f64))
    }

    /// The factor or k that fits an estimator's shares best to the truth; 1 for one that has none.
    ///
    /// # Errors
    /// As [`Self::estimate`].
    pub fn fitted(&self, grid: &SlabGrid, samples: &SampleSets, way: Way) -> Result<AoOptions, LabError> {
        // So small that nothing is cut off at 1.
        const SMALL: f32 = 1e-3;
        let options = |estimator| AoOptions { estimator, ..AoOptions::new(self.radius, self.line_radius) };
        let share = match way {
            Way::OpticalDepth => return Ok(AoOptions::new(self.radius, self.line_radius)),
            Way::RatioOfSums => Estimator::RatioOfSums { factor: SMALL },
            Way::MeanOfRatios | Way::Extinction => Estimator::MeanOfRatios { factor: SMALL },
        };
        let (small, _) = Self::estimate(grid, samples, options(share), &self.receivers, 0.0)?;
        let shares: Vec<f64> = small.iter().map(|x| x / f64::from(SMALL)).collect();
        let best =
            |estimate: fn(f64, f64) -> f64| fit(&shares, &self.truth, [0.001, 1000.0], estimate) as f32;
        let linear = |factor: f64, x: f64| (factor * x).min(1.0);
        Ok(options(match way {
            Way::RatioOfSums => Estimator::RatioOfSums { factor: best(linear) },
            Way::Extinction => Estimator::Extinction { k: best(|k, x| 1.0 - (-k * x).exp()) },
            _ => Estimator::MeanOfRatios { factor: best(linear) },
        }))
    }
}

/// An estimator, without its parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// The thesis' table 3.1.
    MeanOfRatios,
    /// Its equation 3.4.
    RatioOfSums,
    /// The first one, as a density.
    Extinction,
    /// Lengths of lines in columns.
    OpticalDepth,
}

impl Way {
    /// All, the thesis' own first.
    pub const ALL: [Self; 4] = [Self::MeanOfRatios, Self::RatioOfSums, Self::Extinction, Self::OpticalDepth];

    /// The name in tables and charts.
    pub fn name(self) -> &'static str {
        match self {
            Self::MeanOfRatios => "mean of ratios (thesis)",
            Self::RatioOfSums => "ratio of sums",
            Self::Extinction => "extinction",
            Self::OpticalDepth => "optical depth",
        }
    }
}
