//! Differences between pictures: of light, and as people see them.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageFloat, FlipImageRgb8, FlipPool, flip, magma_lut};

use crate::experiments::LabError;
use casca_scenes::lit::HdrImage;

/// An error is known if its square and that of the noise are in sum so many times the latter. The
/// noise is itself an estimate, good to a few per cent.
const KNOWN: f64 = 1.1;

/// How far a picture is from the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Difference {
    /// Root of the mean square of differences in linear light, over the mean of the truth.
    pub rmse: f64,
    /// The mean of FLIP, 0 to 1 (Andersson et al. 2020), of both pictures in sRGB at the exposure
    /// of the truth.
    pub flip: f64,
}

/// The mean over pixels and channels.
pub(super) fn mean(image: &HdrImage) -> f64 {
    let sum: f64 = image.pixels().iter().map(|p| p.as_dvec3().element_sum()).sum();
    sum / (3 * image.pixels().len()) as f64
}

/// Compares two pictures of one size.
///
/// # Errors
/// If their sizes differ, a pixel is not finite, or the truth is black: nothing can be said of the
/// size of errors then.
pub fn difference(truth: &HdrImage, found: &HdrImage) -> Result<Difference, LabError> {
    for (name, image) in [("truth", truth), ("picture that was found", found)] {
        let broken = image.pixels().iter().filter(|p| !p.is_finite()).count();
        if broken > 0 {
            let all = image.pixels().len();
            return Err(format!("{broken} of {all} pixels of the {name} are no finite numbers").into());
        }
    }
    let (error, light) = (truth.rmse(found)?, mean(truth));
    if light <= 0.0 {
        return Err("the truth is black: errors have no size beside it".into());
    }
    Ok(Difference { rmse: error / light, flip: f64::from(FlipPool::from_image(&map(truth, found)).mean()) })
}

/// An RMSE less the noise of the truth, both over its mean: the noise of independent samples adds
/// to the square. Not a number where it is hardly more than that noise: then nothing is known of
/// the error.
pub(super) fn less_noise(rmse: f64, noise: f64) -> f64 {
    let (all, noise) = (rmse * rmse, noise * noise);
    if all > KNOWN * noise { (all - noise).sqrt() } else { f64::NAN }
}

fn map(truth: &HdrImage, found: &HdrImage) -> FlipImageFloat {
    let (exposure, (width, height)) = (truth.exposure(), truth.size());
    let image = |of: &HdrImage| FlipImageRgb8::with_data(width as u32, height as u32, &of.srgb(exposure));
    flip(image(truth), image(found), DEFAULT_PIXELS_PER_DEGREE)
}

/// FLIP by pixel as bytes of RGB, from black (0) over red to yellow (1). For pictures that
/// [`difference`] takes.
pub fn flip_map(truth: &HdrImage, found: &HdrImage) -> Vec<u8> {
    map(truth, found).apply_color_lut(&magma_lut()).to_vec()
}
