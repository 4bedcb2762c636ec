//! What an estimate is told.

use crate::cells::Cells;
use crate::numeric::{MARGIN_IN_RADII, MARGIN_IN_TUBES, MOST_MARGIN_IN_TUBES, PLACE_STEP};

/// How the lines around a receiver become an occlusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Estimator {
    /// The share of cosine-weighted rays that tubes of a radius stop, by rays through [`Cells`]. A
    /// ray has the width of its share of the hemisphere, up to the margin of the cells: tubes stop
    /// it by the share of that width, so that few rays give little noise.
    Rays {
        /// The radius of the tubes, in units of the scene.
        line_radius: f32,
    },
    /// The same share, by rays that are sent once from places along the lines, in all directions
    /// around them: they serve all views, so that a still set costs rays only for what comes into
    /// view.
    Places {
        /// The radius of the tubes, in units of the scene.
        line_radius: f32,
        /// The way from place to place along a line, in units of the scene.
        step: f32,
    },
}

impl Estimator {
    /// Rays from places along the lines for hemispheres and tubes of these radii, with the step
    /// that suits them: no less than the width of a tube, since pixels are as large.
    pub fn places(radius: f32, line_radius: f32) -> Self {
        Self::Places { line_radius, step: (radius * PLACE_STEP).max(line_radius * 2.0) }
    }

    /// The radius of the tubes, in units of the scene.
    pub fn line_radius(self) -> f32 {
        let (Self::Rays { line_radius } | Self::Places { line_radius, .. }) = self;
        line_radius
    }
}

/// What an estimate is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AoOptions {
    /// The radius of the hemisphere in units of the scene. The thesis takes 0.13 of the scene's
    /// extent.
    pub radius: f32,
    /// How lines become an occlusion.
    pub estimator: Estimator,
    /// Whether tubes are solid: where another line's tube holds the start of the rays, nothing gets
    /// through. Otherwise such a tube stops nothing.
    pub solid: bool,
}

/// Why options were refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OptionsError {
    /// The radius of the hemisphere.
    #[error("a radius of {0}: it must be greater than 0 and finite")]
    Radius(f32),
    /// The line radius of the estimator.
    #[error("tubes of the radius {0}: it must be 0 or more and finite")]
    LineRadius(f32),
    /// Rays need cells, and places need their sides.
    #[error("another estimator than the one that these lines were prepared for")]
    Source,
    /// Cells do not name all tubes that rays meet.
    #[error("tubes of the radius {radius} in cells with a margin of {margin}: it must be as great")]
    Margin {
        /// The radius of the tubes.
        radius: f32,
        /// That of the cells.
        margin: f32,
    },
}

impl AoOptions {
    /// Rays at tubes of a radius.
    pub fn rays(radius: f32, line_radius: f32) -> Self {
        Self { radius, estimator: Estimator::Rays { line_radius }, solid: false }
    }

    /// Rays from places along the lines, at tubes of a radius.
    pub fn places(radius: f32, line_radius: f32) -> Self {
        Self { radius, estimator: Estimator::places(radius, line_radius), solid: false }
    }

    /// The margin of the cells that suits rays, in units of the scene: a share of the radius within
    /// bounds in tubes.
    pub fn margin(&self) -> f32 {
        let tube = self.estimator.line_radius();
        (self.radius * MARGIN_IN_RADII).max(tube * MARGIN_IN_TUBES).min(tube * MOST_MARGIN_IN_TUBES)
    }

    /// Whether all values are in their ranges.
    ///
    /// # Errors
    /// If one is not.
    pub fn check(&self) -> Result<(), OptionsError> {
        if !(self.radius > 0.0 && self.radius.is_finite()) {
            return Err(OptionsError::Radius(self.radius));
        }
        let tube = self.estimator.line_radius();
        if tube >= 0.0 && tube.is_finite() { Ok(()) } else { Err(OptionsError::LineRadius(tube)) }
    }

    /// Whether all values are in their ranges, and the cells name all tubes that rays meet.
    pub(super) fn check_with(&self, cells: &Cells) -> Result<(), OptionsError> {
        self.check()?;
        let (radius, margin) = (self.estimator.line_radius(), cells.margin());
        if radius > margin { Err(OptionsError::Margin { radius, margin }) } else { Ok(()) }
    }
}
