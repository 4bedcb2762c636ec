//! How much of the hemisphere above a line is hidden by lines (Benevides 2015, section 3.3).
//!
//! The hemisphere of a radius R has its base tangent to the line and its pole turned to the viewer.
//! [`Estimator::Rays`] sends rays from it through [`Cells`]: nothing depends on columns, views or
//! pixels, so that few rays are near the truth and a moved picture stays the same.
//!
//! All other estimators count in columns.
//! Samples of a disc choose columns of a [`SlabGrid`]; each is clipped to the hemisphere, and its
//! set slices are counted. What the counts become is the [`Estimator`]'s matter.
//!
//! The thesis multiplies the share of set slices by a factor. That share is proportional to the
//! width of a column and the thickness of a slice, so its result fades with a finer grid.
//! [`Estimator::OpticalDepth`] asks instead how far light gets: lines of a radius r and a length L
//! in a volume V hide 2 r L sin(angle) / V of a ray for each unit of its way, and a share exp(-sum)
//! of the rays passes. L comes from the columns' lengths, so nothing depends on the grid but the
//! noise.

mod columns;
mod options;
mod prism;
mod rays;
mod sides;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::buffers::{Fragment, LineBuffer};
use crate::cells::Cells;
use crate::numeric::hash;
use crate::samples::SampleSets;
use crate::slabs::SlabGrid;
use crate::view::View;
use columns::Columns;
pub use columns::sector_of;
pub use options::{AoOptions, BasePlane, Estimator, OptionsError, SetChoice};
use prism::Hemisphere;
pub use sides::Sides;

/// An estimate of the occlusion at points of lines: 0 in the open, 1 where nothing gets through.
#[derive(Debug, Clone, Copy)]
pub struct Occlusion<'a> {
    through: Through<'a>,
    options: AoOptions,
}

/// What an estimate looks through.
#[derive(Debug, Clone, Copy)]
enum Through<'a> {
    Columns(&'a SlabGrid, &'a SampleSets),
    Cells(&'a Cells, &'a View, &'a SampleSets),
    Places(&'a Sides<'a>, &'a View),
}

impl<'a> Occlusion<'a> {
    /// The grid may have other pixels than the picture, but must be made for the same eye and
    /// direction.
    ///
    /// # Errors
    /// If an option is out of its range, or the estimator is [`Estimator::Rays`].
    pub fn new(
        grid: &'a SlabGrid,
        samples: &'a SampleSets,
        options: AoOptions,
    ) -> Result<Self, OptionsError> {
        options.check()?;
        match options.estimator {
            Estimator::Rays { .. } | Estimator::Places { .. } => Err(OptionsError::Source),
            _ => Ok(Self { through: Through::Columns(grid, samples), options }),
        }
    }

    /// By rays, for receivers of a view; `samples` are best those of [`SampleSets::spirals`].
    ///
    /// # Errors
    /// If an option is out of its range, the estimator is another than [`Estimator::Rays`], or its
    /// tubes are thicker than the margin of the cells.
    pub fn by_rays(
        cells: &'a Cells,
        view: &'a View,
        samples: &'a SampleSets,
        options: AoOptions,
    ) -> Result<Self, OptionsError> {
        options.check()?;
        let margin = cells.margin();
        match options.estimator {
            Estimator::Rays { line_radius } if line_radius > margin => {
                Err(OptionsError::Margin { radius: line_radius, margin })
            }
            Estimator::Rays { .. } => Ok(Self { through: Through::Cells(cells, view, samples), options }),
            _ => Err(OptionsError::Source),
        }
    }

    /// By rays from places along the lines, for receivers of a view.
    pub fn by_places(sides: &'a Sides<'a>, view: &'a View) -> Self {
        Self { through: Through::Places(sides, view), options: *sides.options() }
    }

    /// The occlusion in all pixels, row by row; 0 where there is no line. Time: proportional to the
    /// pixels with lines and to the samples of a set.
    pub fn of(&self, buffer: &LineBuffer) -> Vec<f32> {
        let width = buffer.view().size()[0] as usize;
        let at = |(i, fragment): (usize, &Option<Fragment>)| {
            let set = |f: &Fragment| self.set_of(f, [(i % width) as u32, (i / width) as u32]);
            fragment.as_ref().map_or(0.0, |f| self.at(f, set(f)))
        };
        buffer.fragments().par_iter().enumerate().map(at).collect()
    }

    /// The number of the set of samples that a fragment takes; 0 where places have their own.
    pub fn set_of(&self, fragment: &Fragment, pixel: [u32; 2]) -> usize {
        let (Through::Columns(_, samples) | Through::Cells(_, _, samples)) = self.through else { return 0 };
        let key = match self.options.choice {
            SetChoice::One => return 0,
            SetChoice::Screen => hash(pixel[0], pixel[1]),
            SetChoice::Surface { step } => hash(fragment.line, (fragment.along / step) as u32),
        };
        key as usize % samples.count()
    }

    /// The occlusion at a fragment, by a set of samples.
    pub fn at(&self, fragment: &Fragment, set: usize) -> f32 {
        let view = match self.through {
            Through::Columns(grid, _) => grid.view(),
            Through::Cells(_, view, _) | Through::Places(_, view) => view,
        };
        let Some(above) = Hemisphere::new(fragment, self.options.radius, view) else {
            return 0.0;
        };
        let value = match (self.through, self.options.estimator) {
            (Through::Cells(cells, view, samples), Estimator::Rays { line_radius }) => {
                rays::stopped(cells, view, &above, fragment.tangent, (samples.set(set), line_radius))
            }
            (Through::Columns(grid, samples), _) => {
                Columns { grid, options: &self.options }.at(&above, fragment.tangent, samples.set(set))
            }
            (Through::Places(sides, view), _) => {
                let pole = view.eye_from_world().matrix3.transpose() * above.pole.as_dvec3();
                sides.at(fragment.line, fragment.along, pole.as_vec3())
            }
            // Refused when this was made.
            (Through::Cells(..), _) => 0.0,
        };
        if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
    }
}
