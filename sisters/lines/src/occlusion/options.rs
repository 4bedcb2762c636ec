//! What an estimate is told.

use crate::numeric::{MARGIN_IN_RADII, MARGIN_IN_TUBES, MOST_MARGIN_IN_TUBES, PLACE_STEP};

/// How the counts of the columns become an occlusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Estimator {
    /// The mean of the columns' shares of set slices, times a factor; the thesis' table 3.1.
    MeanOfRatios {
        /// The thesis uses 4.
        factor: f32,
    },
    /// All set slices over all slices of the columns, weighted alike, times a factor; the thesis'
    /// equation 3.4.
    RatioOfSums {
        /// As above.
        factor: f32,
    },
    /// 1 - exp(-k x), where x is the mean of ratios: the share of the light that a medium of
    /// density x takes.
    Extinction {
        /// About 10 for the thesis' grids; it depends on the grid.
        k: f32,
    },
    /// The share of cosine-weighted rays that the lines stop, as tubes of a radius. Only noise and
    /// blur depend on the grid: finer columns hold thin lines more rarely, so that fewer samples
    /// meet one; coarser ones and few slices blur dense bundles. Lines along the view need coarse
    /// columns, a third to an eighth of the picture's rows.
    OpticalDepth {
        /// The radius of the tubes, in units of the scene.
        line_radius: f32,
    },
    /// The share of cosine-weighted rays that tubes of a radius stop, by rays through [`Cells`]
    /// instead of columns. A ray has the width of its share of the hemisphere, up to the margin of
    /// the cells: tubes stop it by the share of that width, so that few rays give little noise.
    ///
    /// [`Cells`]: crate::cells::Cells
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
}

/// Which slices of a column lie in the hemisphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BasePlane {
    /// Those above the plane that is tangent to the line.
    #[default]
    Tangent,
    /// Those above that plane mirrored in depth, as the sign in the thesis' equation 3.17 has it.
    /// For comparison only.
    ThesisSign,
}

/// Which set of samples a pixel takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SetChoice {
    /// The same for all: patterns show.
    One,
    /// By the pixel, as in the thesis: noise stands still on the screen while lines move under it,
    /// so they flicker.
    Screen,
    /// By the line and the place along it, in steps of this length in units of the scene: noise
    /// moves with the line.
    Surface {
        /// Greater than 0.
        step: f32,
    },
}

/// What an estimate is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AoOptions {
    /// The radius of the hemisphere in units of the scene. The thesis takes 0.13 of the scene's
    /// extent.
    pub radius: f32,
    /// How counts become an occlusion.
    pub estimator: Estimator,
    /// Whether near columns count more (by the inverse square of the distance over the radius).
    /// Only for the first three estimators; the last one weighs each slice by its solid angle.
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
    #[error("a radius of {0}: it must be greater than 0 and finite")]
    Radius(f32),
    /// The factor, k or line radius of the estimator.
    #[error("an estimator with {0}: it must be 0 or more and finite")]
    Estimator(f32),
    /// The step of [`SetChoice::Surface`].
    #[error("a step of {0} along lines: it must be greater than 0")]
    Step(f32),
    /// Rays need cells, all other estimators need columns.
    #[error("rays go through cells, and all other estimators through columns")]
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
    /// Rays at tubes of a radius; their directions are fixed to the lines.
    pub fn rays(radius: f32, line_radius: f32) -> Self {
        Self { estimator: Estimator::Rays { line_radius }, ..Self::new(radius, line_radius) }
    }

    /// Rays from places along the lines, at tubes of a radius.
    pub fn places(radius: f32, line_radius: f32) -> Self {
        let estimator = Estimator::places(radius, line_radius);
        Self { estimator, ..Self::new(radius, line_radius) }
    }

    /// The best estimator of columns, for tubes of a radius; samples are fixed to the lines.
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

    /// The margin of the cells that suits rays, in units of the scene: a share of the radius within
    /// bounds in tubes. 0 without rays.
    pub fn margin(&self) -> f32 {
        match self.estimator {
            Estimator::Rays { line_radius } | Estimator::Places { line_radius, .. } => (self.radius
                * MARGIN_IN_RADII)
                .max(line_radius * MARGIN_IN_TUBES)
                .min(line_radius * MOST_MARGIN_IN_TUBES),
            _ => 0.0,
        }
    }

    /// Whether all values are in their ranges.
    ///
    /// # Errors
    /// If one is not.
    pub fn check(&self) -> Result<(), OptionsError> {
        if !(self.radius > 0.0 && self.radius.is_finite()) {
            return Err(OptionsError::Radius(self.radius));
        }
        let value = match self.estimator {
            Estimator::MeanOfRatios { factor } | Estimator::RatioOfSums { factor } => factor,
            Estimator::Extinction { k } => k,
            Estimator::OpticalDepth { line_radius }
            | Estimator::Rays { line_radius }
            | Estimator::Places { line_radius, .. } => line_radius,
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
