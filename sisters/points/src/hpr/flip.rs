//! The images of points under the kernels.

use super::kernel::{HprError, Kernel};
use crate::numeric::{AT_EYE, LEAST_IMAGE, power_of_two_for};
use glam::DVec3;

/// The images of points, relative to the eye, all within a distance of 1. Points at the eye stay
/// there.
pub(super) fn flip(points: &[DVec3], eye: DVec3, kernel: Kernel) -> Result<Vec<DVec3>, HprError> {
    if !eye.is_finite() {
        return Err(HprError::EyeNotFinite);
    }
    let mut largest = 0.0_f64;
    for (index, &p) in points.iter().enumerate() {
        if !p.is_finite() {
            return Err(HprError::PointNotFinite { index });
        }
        let offset = p - eye;
        if !offset.is_finite() {
            return Err(HprError::TooFar { index });
        }
        largest = largest.max(offset.abs().max_element());
    }
    let scale = power_of_two_for(largest);
    let distances = || points.iter().map(|&p| ((p - eye) * scale).length());
    let farthest = distances().fold(0.0, f64::max);
    let nearest = distances().filter(|d| d / farthest >= AT_EYE).fold(farthest, f64::min);
    let image = image_distance(kernel, nearest / farthest, farthest, scale)?;
    let flip_one = |&p: &DVec3| {
        let offset = (p - eye) * scale;
        let distance = offset.length();
        // All distances are 0 if all points are at the eye.
        let share = if farthest > 0.0 { distance / farthest } else { 0.0 };
        if share < AT_EYE { DVec3::ZERO } else { offset / distance * image(share) }
    };
    Ok(points.iter().map(flip_one).collect())
}

/// The distance of an image by the distance of its point, in units of their largest values; so is
/// `nearest`, the least distance.
fn image_distance(
    kernel: Kernel,
    nearest: f64,
    farthest: f64,
    scale: f64,
) -> Result<impl Fn(f64) -> f64 + Copy, HprError> {
    let (radius, gamma) = match kernel {
        Kernel::Relative { log10_radius } => {
            if !(0.0..=300.0).contains(&log10_radius) {
                return Err(HprError::LogRadius { log10_radius });
            }
            (10_f64.powf(log10_radius), None)
        }
        Kernel::Absolute { radius } => {
            // Unit by unit: the product of the two may be more than a double can hold.
            let relative = if farthest > 0.0 { radius / (farthest / scale) } else { radius.max(1.0) };
            if !(relative >= 1.0 && radius.is_finite() && radius >= 0.0) {
                return Err(HprError::Radius { radius, farthest: farthest / scale });
            }
            (relative, None)
        }
        Kernel::Exponential { gamma } if gamma < 0.0 && gamma.is_finite() => (1.0, Some(gamma)),
        Kernel::Exponential { gamma } => return Err(HprError::Gamma { gamma }),
    };
    Ok(move |share: f64| match gamma {
        Some(gamma) => (gamma * (share / nearest).ln()).exp().max(LEAST_IMAGE),
        None => 1.0 - share / radius / 2.0,
    })
}
