//! How much of the hemisphere above a line is hidden by lines (Benevides 2015, section 3.3).
//!
//! The hemisphere of a radius R has its base tangent to the line and its pole turned to the viewer.
//! [`Estimator::Rays`] sends rays from it through [`Cells`]: nothing depends on columns, views or
//! pixels, so that few rays are near the truth and a moved picture stays the same.
//! [`Estimator::Places`] keeps what rays from places along the lines found, for all views.
//!
//! [`Estimator::Thesis`] is the method of the source, for comparison: samples of a disc choose
//! columns of a [`SlabGrid`], each is clipped to the hemisphere, and its set slices are counted.

mod columns;
mod hemisphere;
mod options;
mod rays;
mod sides;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::buffers::{Fragment, LineBuffer};
use crate::cells::Cells;
use crate::numeric::{SET_STEP, hash};
use crate::samples::SampleSets;
use crate::slabs::SlabGrid;
use crate::view::View;
use hemisphere::Hemisphere;
pub use options::{AoOptions, Estimator, OptionsError};
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
    /// By the thesis' columns, for receivers of the view of the grid; `samples` are best those of
    /// [`SampleSets::discs`].
    ///
    /// # Errors
    /// If an option is out of its range, or the estimator is another than [`Estimator::Thesis`].
    pub fn by_columns(
        grid: &'a SlabGrid,
        samples: &'a SampleSets,
        options: AoOptions,
    ) -> Result<Self, OptionsError> {
        options.check()?;
        match options.estimator {
            Estimator::Thesis { .. } => Ok(Self { through: Through::Columns(grid, samples), options }),
            _ => Err(OptionsError::Source),
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

    /// The number of the set of samples that a fragment takes. The thesis chooses it by the pixel,
    /// so that noise stands still on the screen while lines move under it; rays by the line and the
    /// way along it. Places have their own, and it is 0.
    pub fn set_of(&self, fragment: &Fragment, pixel: [u32; 2]) -> usize {
        match self.through {
            Through::Columns(_, samples) => hash(pixel[0], pixel[1]) as usize % samples.count(),
            Through::Cells(_, _, samples) => {
                let step = (fragment.along / (self.options.radius * SET_STEP)) as u32;
                hash(fragment.line, step) as usize % samples.count()
            }
            Through::Places(..) => 0,
        }
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
            (Through::Columns(grid, samples), Estimator::Thesis { factor }) => {
                columns::share(grid, &above, fragment.tangent, samples.set(set), factor)
            }
            (Through::Places(sides, view), _) => {
                let pole = view.eye_from_world().matrix3.transpose() * above.pole.as_dvec3();
                sides.at(fragment.line, fragment.along, pole.as_vec3())
            }
            // Refused when this was made.
            _ => 0.0,
        };
        if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
    }
}
