//! Light by voxels against the path tracer: bounces, reflections, soft shadows and ambient
//! occlusion, by resolution and cone step. All on the processor, so that the errors of the method
//! are measured without those of a graphics device.

mod bounces;
mod case;
mod gather;
mod gloss;
mod metric;
mod rows;
mod shadows;
mod sweep;
#[cfg(test)]
mod tests;
mod voxels;

pub use gather::{Gather, LightVolume, Spot};
pub use metric::{Difference, difference};
pub use voxels::{Sides, Voxel, Voxels};

use super::{Lab, LabError, Section};

/// The title and introduction of the page.
pub const HEAD: &str = "# Light by voxels\n\n\
    How near the light that cones gather from voxels on the grid of casca comes to that of a path tracer, by the resolution of the grid and \
    the step of the cones, and in which time. RMSE is relative to the mean of the path tracer's picture; FLIP is the difference that people see.\n";

/// Measures light by voxels against the path tracer.
///
/// # Errors
/// If a scene cannot be read or is refused, or a chart cannot be written.
pub fn light(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Light by voxels against a path tracer");
    let (cases, skipped) = case::cases(lab)?;
    section.text(format!(
        "The path tracer gives the truth; both show the same surface points, those at the centres of pixels. RMSE is the root of the \
         mean square of differences in linear light over the mean of the truth; FLIP is the mean difference that people see, 0 to 1, in sRGB. \
         The noise is the standard error of the truth over its mean; the error is the RMSE less that noise, in squares, and empty where noise \
         hides it. FLIP counts the noise. Cones sample a pyramid of voxels; walks \
         follow single directions through the cells exactly. Times are those of {} threads on a shared, noisy machine: compare those of one \
         table only.",
        rayon::current_num_threads()
    ));
    section.text(skipped.unwrap_or_default());
    let truths = bounces::bounces(lab, &cases, &mut section)?;
    // The Cornell box with a ball of light, and the shared scene.
    let some: Vec<_> = cases.iter().zip(&truths).filter(|(case, _)| case.held == 1).collect();
    sweep::sweep(lab, &mut section, &some, lab.pick(rows::MIDDLE, rows::SIZES[0]))?;
    gloss::gloss(lab, &mut section)?;
    shadows::shadows(lab, &mut section)?;
    Ok(section)
}
