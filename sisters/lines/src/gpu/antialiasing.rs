//! How pixels at the borders of lines are mixed.

use crate::gpu::error::LinesGpuError;
use crate::gpu::numeric::MOST_THICK;

/// Samples of a pixel that show another line, each with a fragment of its own, at most.
pub(super) const LAYERS: u32 = 4;

/// How pixels at the borders of lines are mixed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Antialiasing {
    /// A pixel shows one line: the nearest of those that cross it.
    #[default]
    None,
    /// A pixel is the mean of four samples, which lie on a turned square; the nearest line in it
    /// has the share that it covers, which the samples would tell in steps. Lines are `thickness`
    /// pixels thick with round ends, 1 to [`MOST_THICK`]: at any depth, so that none is too thin
    /// for the samples. The occlusion is computed once for each line that a pixel shows.
    ///
    /// Memory on the device: 228 bytes a pixel instead of 56; places take 64 more instead of 16.
    Four {
        /// In pixels.
        thickness: f32,
    },
}

impl Antialiasing {
    /// Lines of one pixel.
    pub const SMOOTH: Self = Self::Four { thickness: 1.0 };

    pub(super) fn check(self) -> Result<(), LinesGpuError> {
        match self {
            Self::Four { thickness } if !(1.0..=MOST_THICK).contains(&thickness) => {
                Err(LinesGpuError::Thickness(thickness))
            }
            _ => Ok(()),
        }
    }

    /// Whether pixels have samples.
    pub(super) fn has_samples(self) -> bool {
        matches!(self, Self::Four { .. })
    }

    /// How far from the middle of a line the samples that show it may lie, in pixels, beyond the
    /// pixel that [`Settings::reach`](crate::gpu::settings::Settings::reach) counts with.
    pub(super) fn beyond(self) -> f64 {
        match self {
            Self::None => 0.0,
            // Context is drawn up to 0.18 pixels beside the samples.
            Self::Four { thickness } => f64::from(thickness) / 2.0 - 0.5,
        }
    }

    /// The columns and rows of the fragments of a picture: one picture above the other.
    pub(super) fn layers_of(self, [width, height]: [u32; 2]) -> [u32; 2] {
        [width, if self.has_samples() { height * LAYERS } else { height }]
    }
}
