//! What is computed, and what the shaders are told of it.

use bytemuck::{Pod, Zeroable};

use crate::gpu::error::LinesGpuError;
use crate::gpu::lens::Reach;
use crate::occlusion::{AoOptions, BasePlane, Estimator, SetChoice};
use crate::slabs::Slices;
use crate::view::View;

/// What is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The occlusion.
    pub ao: AoOptions,
    /// Samples of a set. The thesis takes 150.
    pub samples: u32,
    /// Sets of samples.
    pub sets: u32,
    /// Seed of the samples.
    pub seed: u64,
    /// Slices of a column.
    pub slices: Slices,
    /// Pixels along the side of a column, 1 to 64.
    pub coarse: u32,
}

impl Settings {
    /// The best estimator for tubes of a radius, with 256 slices in columns of 2 x 2 pixels.
    pub fn new(radius: f32, line_radius: f32) -> Self {
        let ao = AoOptions::new(radius, line_radius);
        Self { ao, samples: 150, sets: 16, seed: 1, slices: Slices::S256, coarse: 2 }
    }

    /// The view of the columns of a view.
    ///
    /// # Errors
    /// If the side of a column is out of its range.
    pub fn grid(&self, view: &View) -> Result<View, LinesGpuError> {
        match self.coarse {
            1 => Ok(*view),
            side @ 2..=64 => Ok(view.with_columns(side)?),
            side => Err(LinesGpuError::Coarse(side)),
        }
    }

    /// How far from a pixel's fragment lines can change the pixel.
    ///
    /// # Errors
    /// As [`Self::grid`].
    pub fn reach(&self, view: &View) -> Result<Reach, LinesGpuError> {
        Ok(Reach::new(view, &self.grid(view)?, self.ao.radius, self.slices))
    }

    pub(super) fn check(&self) -> Result<(), LinesGpuError> {
        self.ao.check()?;
        if !(1..=64).contains(&self.coarse) {
            return Err(LinesGpuError::Coarse(self.coarse));
        }
        Ok(())
    }
}

/// `Ao` of occlusion.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(super) struct GpuAo {
    radius: f32,
    value: f32,
    step: f32,
    estimator: u32,
    flags: u32,
    choice: u32,
    sets: u32,
    samples: u32,
    size: [u32; 2],
    padding: [u32; 2],
}

impl GpuAo {
    pub(super) fn new(settings: &Settings, size: [u32; 2]) -> Self {
        let ao = &settings.ao;
        let (estimator, value) = match ao.estimator {
            Estimator::MeanOfRatios { factor } => (0, factor),
            Estimator::RatioOfSums { factor } => (1, factor),
            Estimator::Extinction { k } => (2, k),
            Estimator::OpticalDepth { line_radius } => (3, line_radius),
        };
        let (choice, step) = match ao.choice {
            SetChoice::One => (0, 1.0),
            SetChoice::Screen => (1, 1.0),
            SetChoice::Surface { step } => (2, step),
        };
        let flag = |on: bool, bit: u32| u32::from(on) * bit;
        let flags =
            flag(ao.by_distance, 1) | flag(ao.by_angle, 2) | flag(ao.plane == BasePlane::ThesisSign, 4);
        let Settings { sets, samples, .. } = *settings;
        Self {
            radius: ao.radius,
            value,
            step,
            estimator,
            flags,
            choice,
            sets,
            samples,
            size,
            padding: [0; 2],
        }
    }
}
