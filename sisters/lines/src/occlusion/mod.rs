//! How much of the hemisphere above a line is hidden by lines (Benevides 2015, section 3.3).
//!
//! The hemisphere of a radius R has its base tangent to the line and its pole turned to the viewer.
//! [`Estimator::Rays`] sends rays from it through [`Cells`]: nothing depends on columns, views or
//! pixels, so that few rays are near the truth and a moved picture stays the same.
//! [`Estimator::Places`] keeps what rays from places along the lines found, for all views.

mod options;
mod rays;
mod sides;
#[cfg(test)]
mod tests;

use crate::buffers::Fragment;
use crate::cells::Cells;
use crate::numeric::{SET_STEP, hash};
use crate::samples::SampleSets;
use crate::view::View;
pub use options::{AoOptions, Estimator, OptionsError};
use rays::{Hemisphere, stopped};
pub use sides::Sides;

/// An estimate of the occlusion at points of lines: 0 in the open, 1 where nothing gets through.
#[derive(Debug, Clone, Copy)]
pub struct Occlusion<'a> {
    through: Through<'a>,
    view: &'a View,
    radius: f32,
}

/// What an estimate looks through.
#[derive(Debug, Clone, Copy)]
enum Through<'a> {
    Cells(&'a Cells, &'a SampleSets, f32, bool),
    Places(&'a Sides<'a>),
}

impl<'a> Occlusion<'a> {
    /// By rays, for receivers of a view.
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
        options.check_with(cells)?;
        let Estimator::Rays { line_radius } = options.estimator else { return Err(OptionsError::Source) };
        let through = Through::Cells(cells, samples, line_radius, options.solid);
        Ok(Self { through, view, radius: options.radius })
    }

    /// By rays from places along the lines, for receivers of a view.
    pub fn by_places(sides: &'a Sides<'a>, view: &'a View) -> Self {
        Self { through: Through::Places(sides), view, radius: sides.options().radius }
    }

    /// The occlusion at a fragment. Rays choose their set of samples by the line and the way along
    /// it.
    pub fn at(&self, fragment: &Fragment) -> f32 {
        let Some(above) = Hemisphere::new(fragment, self.radius, self.view) else { return 0.0 };
        let value = match self.through {
            Through::Cells(cells, samples, line_radius, solid) => {
                let step = (fragment.along / (self.radius * SET_STEP)) as u32;
                let set = samples.set(hash(fragment.line, step) as usize);
                let own = solid.then_some(fragment.line);
                stopped(cells, self.view, &above, fragment.tangent, (set, line_radius, own))
            }
            Through::Places(sides) => {
                let pole = self.view.eye_from_world().matrix3.transpose() * above.pole.as_dvec3();
                sides.at(fragment.line, fragment.along, pole.as_vec3())
            }
        };
        if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
    }
}
