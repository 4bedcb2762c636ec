//! Pictures of linear light.

use glam::Vec3;

/// Pixels that a picture has at most.
pub const MOST_PIXELS: usize = 1 << 24;

/// Why there is no picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// It has no pixels, or too many.
    #[error("a picture of {width}x{height} pixels: there must be 1 to {MOST_PIXELS}")]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Two pictures are compared that differ in size.
    #[error("a picture of {ours:?} pixels cannot be compared with one of {theirs:?}")]
    Sizes {
        /// Width and height of the one.
        ours: (usize, usize),
        /// Width and height of the other.
        theirs: (usize, usize),
    },
}

/// A picture of linear RGB, without bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct HdrImage {
    width: usize,
    height: usize,
    /// Row by row from the top; as many as there are pixels.
    pixels: Vec<Vec3>,
}

impl HdrImage {
    /// A picture of pixels in rows from the top; those that are missing are black.
    ///
    /// # Errors
    /// [`ImageError::Size`].
    pub fn new(width: usize, height: usize, mut pixels: Vec<Vec3>) -> Result<Self, ImageError> {
        let count = width.checked_mul(height).filter(|n| (1..=MOST_PIXELS).contains(n));
        pixels.resize(count.ok_or(ImageError::Size { width, height })?, Vec3::ZERO);
        Ok(Self { width, height, pixels })
    }

    /// Pixels in a row and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Row by row from the top.
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// The square root of the mean of squared differences over pixels and channels. Pixels that are
    /// not finite count as black.
    ///
    /// # Errors
    /// [`ImageError::Sizes`].
    pub fn rmse(&self, other: &Self) -> Result<f64, ImageError> {
        if self.size() != other.size() {
            return Err(ImageError::Sizes { ours: self.size(), theirs: other.size() });
        }
        let square = |(a, b): (&Vec3, &Vec3)| (sound(*a) - sound(*b)).as_dvec3().length_squared();
        let sum: f64 = self.pixels.iter().zip(&other.pixels).map(square).sum();
        Ok((sum / (3 * self.pixels.len()) as f64).sqrt())
    }
}

fn sound(pixel: Vec3) -> Vec3 {
    if pixel.is_finite() { pixel } else { Vec3::ZERO }
}
