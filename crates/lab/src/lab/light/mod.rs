//! Light by voxels against the path tracer: bounces, soft shadows and ambient occlusion, by resolution and cone step. All on the
//! processor, so that the errors of the method are measured without those of a graphics device.

mod bounces;
mod gather;
mod metric;
mod shadows;
#[cfg(test)]
mod tests;
mod voxels;

use std::path::Path;

use glam::Vec3;

pub use gather::{Gather, LightVolume};
pub use metric::{Difference, difference};
pub use voxels::{Sides, Voxel, Voxels};

use super::{Lab, LabError, Section};
use crate::import::load_lit;
use crate::lit::{HdrImage, Kind, LitScene};
use crate::oracle::path::{PathTracer, Quantity, Surface};
use crate::pictures::Tile;

/// The title and introduction of the page.
pub const HEAD: &str = "# Light by voxels\n\n\
    How near the light that cones gather from voxels on the grid of casca comes to that of a path tracer, by the resolution of the grid and \
    the step of the cones, and in which time. RMSE is relative to the mean of the path tracer's picture; FLIP is the difference that people see.\n";

/// The shared scene that is measured where it is there.
const SPONZA: &str = "../shared/scenes/sponza.glb";

/// A scene and the path tracer's pictures of it.
struct Case {
    scene: LitScene,
    tracer: PathTracer,
    size: (usize, usize),
    surfaces: Vec<Option<Surface>>,
    /// How often light is scattered before it is in the first volume: 0 if surfaces emit it, 1 if lights do.
    held: u32,
}

impl Case {
    fn new(scene: LitScene, size: (usize, usize)) -> Result<Self, LabError> {
        let tracer = PathTracer::new(&scene);
        let surfaces = tracer.surfaces(&scene.camera, size)?;
        let held = u32::from(!scene.lights.is_empty());
        Ok(Self { scene, tracer, size, surfaces, held })
    }

    fn truth(&self, lab: &Lab, quantity: &Quantity) -> Result<HdrImage, LabError> {
        let samples = lab.pick(400, 8);
        Ok(self.tracer.render(&self.scene.camera, self.size, quantity, samples, lab.seed)?.image)
    }

    /// A picture from the surfaces that pixels show; black where there is none.
    fn image(&self, of: impl Fn(&Surface) -> Vec3 + Sync) -> Result<HdrImage, LabError> {
        use rayon::prelude::*;
        let pixel = |s: &Option<Surface>| s.as_ref().map_or(Vec3::ZERO, &of);
        let pixels = self.surfaces.par_iter().map(pixel).collect();
        Ok(HdrImage::new(self.size.0, self.size.1, pixels)?)
    }

    fn albedo(&self, at: &Surface) -> Vec3 {
        self.scene.materials[at.material].albedo
    }
}

/// The scenes of the bounces: two Cornell boxes, and Sponza under the sun if it is there.
fn cases(lab: &Lab) -> Result<(Vec<Case>, Option<String>), LabError> {
    let size = lab.pick((128, 96), (16, 12));
    let mut cases =
        vec![Case::new(Kind::Cornell.build(), size)?, Case::new(Kind::CornellPoint.build(), size)?];
    cases[1].scene.name = Kind::CornellPoint.name().to_owned();
    if !Path::new(SPONZA).exists() {
        return Ok((cases, Some(format!("skipped: {SPONZA} is not here"))));
    }
    if !lab.quick {
        let mut sponza = load_lit(Path::new(SPONZA))?;
        // Bounces of the sun alone, so that each order of scattering can be compared.
        sponza.sky = Vec3::ZERO;
        cases.push(Case::new(sponza, size)?);
    }
    Ok((cases, None))
}

/// A tile of a sheet.
fn tile(caption: String, image: &HdrImage, exposure: f32) -> Tile {
    Tile { caption, width: image.size().0, rgb: image.srgb(exposure) }
}

/// A number of three digits.
fn digits(value: f64) -> String {
    format!("{value:.3}")
}

/// Measures light by voxels against the path tracer.
///
/// # Errors
/// If a scene cannot be read or is refused, or a chart cannot be written.
pub fn light(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Light by voxels against a path tracer");
    let (cases, skipped) = cases(lab)?;
    section.text(
        "The path tracer gives the truth; both show the same surface points, those at the centres of pixels. RMSE is the root of the \
         mean square of differences in linear light over the mean of the truth; FLIP is the mean difference that people see, 0 to 1, in sRGB. Cones \
         sample a pyramid of voxels; walks follow single directions through the cells exactly. Times are those of two shared, noisy cores: \
         compare those of one table only.",
    );
    section.text(skipped.unwrap_or_default());
    bounces::bounces(lab, &cases, &mut section)?;
    shadows::shadows(lab, &mut section)?;
    Ok(section)
}
