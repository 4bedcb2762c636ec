//! Differences between pictures: of light, and as people see them.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};

use crate::lab::LabError;
use crate::lit::HdrImage;

/// How far a picture is from the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Difference {
    /// Root of the mean square of differences in linear light, over the mean of the truth.
    pub rmse: f64,
    /// The mean of FLIP, 0 to 1 (Andersson et al. 2020), of both pictures in sRGB at the exposure of the truth.
    pub flip: f64,
}

/// Compares two pictures of one size.
///
/// # Errors
/// If their sizes differ.
pub fn difference(truth: &HdrImage, found: &HdrImage) -> Result<Difference, LabError> {
    let exposure = truth.exposure();
    let mean = truth.pixels().iter().map(|p| f64::from(p.element_sum())).sum::<f64>()
        / (3 * truth.pixels().len()) as f64;
    let rmse = truth.rmse(found)? / mean.max(f64::MIN_POSITIVE);
    Ok(Difference { rmse, flip: flip_of(truth.size(), &truth.srgb(exposure), &found.srgb(exposure)) })
}

fn flip_of((width, height): (usize, usize), truth: &[u8], found: &[u8]) -> f64 {
    let image = |bytes| FlipImageRgb8::with_data(width as u32, height as u32, bytes);
    let map = flip(image(truth), image(found), DEFAULT_PIXELS_PER_DEGREE);
    f64::from(FlipPool::from_image(&map).mean())
}
