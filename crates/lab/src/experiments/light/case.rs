//! The scenes that are measured, with the path tracer's pictures of them, and the volumes of light
//! in their voxels.

use glam::Vec3;
use rayon::prelude::*;
use std::path::Path;

use super::gather::{Gather, LightVolume, Spot};
use super::metric::mean;
use super::voxels::{Sides, Voxels};
use crate::experiments::{Lab, LabError};
use casca_scenes::import::load_lit;
use casca_scenes::lit::{HdrImage, Kind, LightKind, LitScene, Material};
use casca_scenes::measure::timed_by_wall;
use casca_truth::oracle::path::{PathTracer, Quantity, Surface};

/// The shared scene that is measured where it is there.
const SPONZA: &str = "../shared/scenes/sponza.glb";
/// A sun that shines through the roof of Sponza, and half the angle that it is seen under: eight
/// times that of the real one, so that its shadows are soft.
const SUN: LightKind = LightKind::Directional { direction: Vec3::new(0.25, -1.0, 0.12), half_angle: 0.04 };
/// Samples a pixel of the path tracer, in scenes of fewer triangles than [`MANY`] and in others.
const SAMPLES: [u32; 2] = [300, 150];
const MANY: usize = 10_000;
/// Light that was scattered so often is measured at most: 2 is the first bounce, 3 the second.
pub(super) const LAST: u32 = 3;

/// A scene and what its pixels show.
pub(super) struct Case {
    pub(super) scene: LitScene,
    pub(super) tracer: PathTracer,
    pub(super) size: (usize, usize),
    pub(super) surfaces: Vec<Option<Surface>>,
    pub(super) materials: Vec<Material>,
    /// How often light is scattered before it is in the first volume: 0 if surfaces or the sky emit
    /// it, 1 if there are lights.
    pub(super) held: u32,
}

/// A picture of the path tracer, and the standard error of its pixels over its mean.
pub(super) struct Truth {
    pub(super) image: HdrImage,
    pub(super) noise: f64,
}

/// The light of one order of scattering in voxels, and the milliseconds that this light and the
/// pyramid took.
pub(super) struct Stage<'a> {
    pub(super) volume: LightVolume<'a>,
    pub(super) ms: [f64; 2],
}

/// What a call gives, and the milliseconds that pass: several threads share the work with light.
pub(super) fn milliseconds<T>(call: impl FnOnce() -> T) -> (T, f64) {
    let (value, time) = timed_by_wall(call);
    (value, time.as_secs_f64() * 1e3)
}

impl Case {
    pub(super) fn new(scene: LitScene, size: (usize, usize)) -> Result<Self, LabError> {
        let tracer = PathTracer::new(&scene);
        let surfaces = tracer.surfaces(&scene.camera, size)?;
        let materials = scene.materials.iter().map(Material::sound).collect();
        let held = u32::from(!scene.lights.is_empty());
        Ok(Self { scene, tracer, size, surfaces, materials, held })
    }

    pub(super) fn truth(&self, lab: &Lab, quantity: &Quantity) -> Result<Truth, LabError> {
        let samples = lab.pick(SAMPLES[usize::from(self.scene.triangles().len() >= MANY)], 8);
        let render = self.tracer.render(&self.scene.camera, self.size, quantity, samples, lab.seed)?;
        let squares: f64 = render.error.pixels().iter().map(|p| p.as_dvec3().length_squared()).sum();
        let error = (squares / (3 * render.error.pixels().len()) as f64).sqrt();
        let noise = error / mean(&render.image).max(f64::MIN_POSITIVE);
        Ok(Truth { image: render.image, noise })
    }

    /// A picture from the surfaces that pixels show; black where there is none.
    pub(super) fn image<E: Into<LabError> + Send>(
        &self,
        of: impl Fn(&Surface) -> Result<Vec3, E> + Sync,
    ) -> Result<HdrImage, LabError> {
        let pixel = |s: &Option<Surface>| s.as_ref().map_or(Ok(Vec3::ZERO), &of);
        let pixels: Result<Vec<Vec3>, E> = self.surfaces.par_iter().map(pixel).collect();
        Ok(HdrImage::new(self.size.0, self.size.1, pixels.map_err(Into::into)?)?)
    }

    /// The picture of the light that surfaces scatter from a volume, and the milliseconds that it
    /// took.
    pub(super) fn gathered(&self, volume: &LightVolume, how: Gather) -> Result<(HdrImage, f64), LabError> {
        let scattered = |at: &Surface| volume.scattered(&self.spot(at), &self.materials[at.material], how);
        let (image, ms) = milliseconds(|| self.image(scattered));
        Ok((image?, ms))
    }

    fn spot(&self, at: &Surface) -> Spot {
        let (point, normal) = (at.point.as_vec3(), at.normal.as_vec3());
        Spot { point, normal, look: (point - self.scene.camera.eye).normalize_or_zero() }
    }

    /// How often light that a picture can be gathered of was scattered.
    pub(super) fn orders(&self) -> std::ops::RangeInclusive<u32> {
        self.held + 1..=LAST
    }

    /// The volumes of light that was scattered ever more often: one for each of [`Self::orders`],
    /// from which that light is gathered.
    pub(super) fn stages<'a>(&self, voxels: &'a Voxels, how: Gather) -> Result<Vec<Stage<'a>>, LabError> {
        let (sides, mut lit) = milliseconds(|| self.first(voxels, how));
        let (mut sides, mut sky) = (sides?, if self.held == 0 { self.scene.sky } else { Vec3::ZERO });
        let mut stages: Vec<Stage> = Vec::new();
        for order in self.orders() {
            let (volume, pyramid) =
                milliseconds(|| LightVolume::new(voxels, std::mem::take(&mut sides), sky));
            let before = lit;
            if order < LAST {
                let (next, bounce) = milliseconds(|| volume.bounce(how));
                (sides, lit) = (next?, bounce);
            }
            // Light of the sky enters once.
            sky = Vec3::ZERO;
            stages.push(Stage { volume, ms: [before, pyramid] });
        }
        Ok(stages)
    }

    /// The light in the first volume: what surfaces emit, or, if there are lights, all that was
    /// scattered once.
    fn first(&self, voxels: &Voxels, how: Gather) -> Result<Sides, LabError> {
        let emission = voxels.emission();
        if self.held == 0 {
            return Ok(emission);
        }
        let mut sides = voxels.direct(&self.scene.lights)?;
        if self.scene.sky != Vec3::ZERO || self.materials.iter().any(Material::emits) {
            let more = LightVolume::new(voxels, emission, self.scene.sky).bounce(how)?;
            sides.iter_mut().zip(more).for_each(|(a, b)| (a[0], a[1]) = (a[0] + b[0], a[1] + b[1]));
        }
        Ok(sides)
    }
}

/// What light that was scattered so often is called.
pub(super) fn order_name(order: u32) -> &'static str {
    ["emission", "direct", "first bounce", "second bounce"][(order as usize).min(3)]
}

/// Pixels of pictures.
pub(super) fn size(lab: &Lab) -> (usize, usize) {
    lab.pick((96, 72), (16, 12))
}

/// Sponza under the sun alone, so that each order of scattering can be looked at; else why it is
/// not there.
pub(super) fn sponza() -> Result<LitScene, String> {
    if !Path::new(SPONZA).exists() {
        return Err(format!("skipped: {SPONZA} is not here"));
    }
    let mut sponza = load_lit(Path::new(SPONZA)).map_err(|e| format!("skipped: {e}"))?;
    sponza.sky = Vec3::ZERO;
    sponza.lights.truncate(1);
    sponza.lights.iter_mut().for_each(|l| l.kind = SUN);
    Ok(sponza)
}

/// A generated scene under its own name.
pub(super) fn generated(kind: Kind) -> LitScene {
    LitScene { name: kind.name().to_owned(), ..kind.build() }
}

/// The Cornell box with a ball of light in its upper half instead of the patch. A light as near to
/// the ceiling as the patch would make a spot there that paths seldom find, and so much noise.
pub(super) fn cornell_ball() -> LitScene {
    let mut scene = LitScene { name: "cornell-ball".to_owned(), ..Kind::CornellPoint.build() };
    for light in &mut scene.lights {
        light.kind = LightKind::Point { position: Vec3::new(2.78, 4.0, 2.8), radius: 0.25 };
    }
    scene
}

/// The scenes of the bounces: the Cornell box by its patch and by a ball of light, the room with a
/// ball that emits, and Sponza if it is there.
pub(super) fn cases(lab: &Lab) -> Result<(Vec<Case>, Option<String>), LabError> {
    let scenes = [generated(Kind::Cornell), cornell_ball(), generated(Kind::Emissive)];
    let mut cases = scenes.into_iter().map(|s| Case::new(s, size(lab))).collect::<Result<Vec<_>, _>>()?;
    if lab.quick {
        return Ok((cases, Some("skipped: Sponza takes too long for a smoke run".to_owned())));
    }
    match sponza() {
        Ok(scene) => cases.push(Case::new(scene, size(lab))?),
        Err(why) => return Ok((cases, Some(why))),
    }
    Ok((cases, None))
}
