//! What is computed, and what the shaders are told of it.

use bytemuck::{Pod, Zeroable};

use crate::gpu::antialiasing::Antialiasing;
use crate::gpu::error::LinesGpuError;
use crate::gpu::lens::Reach;
use crate::numeric::{USUAL_RAYS, USUAL_SIDE_RAYS};
use crate::occlusion::{AoOptions, BasePlane, Estimator, SetChoice};
use crate::slabs::Slices;
use crate::view::View;

/// What is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The occlusion.
    pub ao: AoOptions,
    /// Samples or rays of a set. The thesis takes 150.
    pub samples: u32,
    /// Sets of samples.
    pub sets: u32,
    /// Seed of the samples.
    pub seed: u64,
    /// Slices of a column.
    pub slices: Slices,
    /// Pixels along the side of a column, 1 to 64.
    pub coarse: u32,
    /// Whether borders of lines are smooth.
    pub antialiasing: Antialiasing,
}

impl Settings {
    /// The best estimator for tubes of a radius: [`USUAL_RAYS`] rays. Where lines stand still and
    /// the view moves, [`Self::of_places`] costs a tenth.
    pub fn new(radius: f32, line_radius: f32) -> Self {
        Self {
            ao: AoOptions::rays(radius, line_radius),
            samples: USUAL_RAYS,
            ..Self::of_columns(radius, line_radius)
        }
    }

    /// Rays from places along the lines: [`USUAL_SIDE_RAYS`] of a side of a place.
    pub fn of_places(radius: f32, line_radius: f32) -> Self {
        Self {
            ao: AoOptions::places(radius, line_radius),
            samples: USUAL_SIDE_RAYS,
            ..Self::of_columns(radius, line_radius)
        }
    }

    /// The best estimator of columns for tubes of a radius, with 150 samples and 256 slices in
    /// columns of 2 x 2 pixels.
    pub fn of_columns(radius: f32, line_radius: f32) -> Self {
        let ao = AoOptions::new(radius, line_radius);
        Self {
            ao,
            samples: 150,
            sets: 16,
            seed: 1,
            slices: Slices::S256,
            coarse: 2,
            antialiasing: Antialiasing::None,
        }
    }

    /// Whether rays through cells are taken, instead of columns: from pixels or from places.
    pub fn by_rays(&self) -> bool {
        matches!(self.ao.estimator, Estimator::Rays { .. } | Estimator::Places { .. })
    }

    /// Whether these rays are sent from places along the lines.
    pub fn by_places(&self) -> bool {
        matches!(self.ao.estimator, Estimator::Places { .. })
    }

    /// The margin of the cells of lines that suits the tubes that rays meet; 0 without rays.
    pub fn margin(&self) -> f32 {
        self.ao.margin()
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
        let mut reach = Reach::new(view, &self.grid(view)?, self.ao.radius, self.slices);
        let beyond = (view.pixel_size(view.depths()[1]) * self.antialiasing.beyond()) as f32;
        (reach.drawn, reach.read) = (reach.drawn + beyond, reach.read + beyond);
        // Cells hold all lines in any case.
        Ok(if self.by_rays() { Reach { read: reach.drawn, ..reach } } else { reach })
    }

    pub(super) fn check(&self) -> Result<(), LinesGpuError> {
        self.ao.check()?;
        self.antialiasing.check()?;
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
    tangents: u32,
    padding: u32,
}

impl GpuAo {
    /// For a picture of a size; the tangents of places begin at a place of their buffer.
    pub(super) fn new(settings: &Settings, size: [u32; 2], tangents: u32) -> Self {
        let ao = &settings.ao;
        let (estimator, value) = match ao.estimator {
            Estimator::MeanOfRatios { factor } => (0, factor),
            Estimator::RatioOfSums { factor } => (1, factor),
            Estimator::Extinction { k } => (2, k),
            Estimator::OpticalDepth { line_radius } => (3, line_radius),
            Estimator::Rays { line_radius } => (4, line_radius),
            Estimator::Places { line_radius, .. } => (5, line_radius),
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
            tangents,
            padding: 0,
        }
    }
}
