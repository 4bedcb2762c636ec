//! Lightmaps beside a path tracer.

use casca_radiosity::lit::LitScene;
use casca_radiosity::lit::path::PathTracer;
use casca_scenes::world::Camera;
use glam::Vec3;

use crate::{Light, Placed, texels};

/// The eye is so far above a texel's point, in metres, and what it looks at is at most so far away from it.
const ABOVE: f32 = 0.02;
const SAME: f64 = 1e-4;

/// How the light of texels differs from a path tracer's at the same points, over its mean.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beside {
    /// The mean distance.
    pub error: f32,
    /// The mean difference.
    pub difference: f32,
    /// The mean distance that the noise of the path tracer alone would give.
    pub noise: f32,
    /// How many texels were looked at.
    pub texels: usize,
}

/// Compares the light of about so many texels with a path tracer's, which takes so many samples for each.
/// Texels of black and of shiny surfaces are passed over, and those with something close above.
pub fn beside(scene: &LitScene, placed: &[Placed], found: &Light, count: usize, samples: u32) -> Beside {
    let tracer = PathTracer::new(scene);
    let (mut sums, mut sum, mut looked) = ([0.0; 3], 0.0, 0);
    let all = texels(&found.atlas, placed).lit;
    for t in all.iter().step_by(all.len().div_ceil(count.max(1)).max(1)) {
        let eye = t.point + t.normal * ABOVE;
        let Some(at) = tracer.hit(eye.as_dvec3(), -t.normal.as_dvec3()) else { continue };
        let material = scene.materials[at.material].sound();
        let albedo = material.albedo * at.colour;
        let is_near = at.point.distance(t.point.as_dvec3()) < SAME;
        if !is_near || albedo == Vec3::ZERO || material.specular != Vec3::ZERO {
            continue;
        }
        let camera = Camera::look_at(eye, t.point, 40.0, 1.0, 0.1 * ABOVE, 2.0 * ABOVE);
        // One pixel is never too many.
        let Ok(truth) = tracer.render(&camera, (1, 1), &(1..=256), samples, t.number.into()) else {
            continue;
        };
        let off = albedo * found.texels[t.number as usize] - truth.image[0];
        // The mean of a normal distribution's distance from its middle.
        let noise = truth.error[0].element_sum() * (2.0 / std::f32::consts::PI).sqrt();
        for (all, one) in sums.iter_mut().zip([off.abs().element_sum(), off.element_sum(), noise]) {
            *all += one;
        }
        sum += truth.image[0].element_sum();
        looked += 1;
    }
    let [error, difference, noise] = sums.map(|all| all / sum.max(f32::MIN_POSITIVE));
    Beside { error, difference, noise, texels: looked }
}
