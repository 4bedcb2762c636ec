//! Shells lit by either way of shadows among strands, beside strands with rays towards the sun.

use std::error::Error;

use casca_fur::gpu::look::{Look, SelfShadow, sky_pixel};
use casca_fur::gpu::records::Sun;
use casca_fur::gpu::reference::{Reference, Tint};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::strands::Fur;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::command_line::say;
use glam::Vec3;

use crate::fur::choices::Subject;
use crate::fur::one::{self, TO_SUN};
use crate::fur::shots::Shooter;
use crate::fur::study;

const SIZE: (u32, u32) = (120, 90);
/// Both pictures sample each pixel at the same 2x2 places.
const SMOOTH: u32 = 1;
/// Enough that what differs is light.
const LAYERS: u32 = 48;
/// Height as a share of the radius, density and bend of furs, and directions towards the sun: the
/// usual one, one from behind the animal, a low one.
const CASES: [(f32, f32, f32, Vec3); 6] = [
    (0.03, 0.45, 0.7, TO_SUN),
    (0.08, 0.1, 0.7, TO_SUN),
    (0.08, 0.45, 0.7, TO_SUN),
    (0.13, 0.45, 0.0, TO_SUN),
    (0.08, 0.45, 0.7, Vec3::new(-0.6, 0.7, 0.2)),
    (0.08, 0.45, 1.5, Vec3::new(0.3, 0.2, 0.9)),
];

/// Errors of shells by height and by depth, and how much brighter they are, of 1.
type Errors = [[f64; 2]; 2];

/// Prints the errors of all cases, and gives their means.
pub fn compare(gpu: &Gpu, subject: &Subject) -> Result<Errors, Box<dyn Error>> {
    say("shells against traced shadows among strands: RMSE (brighter by), by height and by depth");
    let mut means = Errors::default();
    for case in CASES {
        let found = errors(gpu, subject, case)?;
        let (height, density, bend, sun) = case;
        let [[a, brighter_a], [b, brighter_b]] = found;
        say(format_args!(
            "  height {height}, density {density}, bend {bend}, sun {sun}: {a:.4} ({brighter_a:+.3}), {b:.4} ({brighter_b:+.3})"
        ));
        let sums = means.as_flattened_mut().iter_mut().zip(found.as_flattened());
        sums.for_each(|(sum, value)| *sum += value / CASES.len() as f64);
    }
    say(format_args!("  mean: {:.4} by height, {:.4} by depth", means[0][0], means[1][0]));
    Ok(means)
}

fn errors(
    gpu: &Gpu,
    subject: &Subject,
    (height, density, bend, sun): (f32, f32, f32, Vec3),
) -> Result<Errors, Box<dyn Error>> {
    let fur = Fur::for_radius(subject.radius, height, density)?;
    let look = Look::new(Fur { bend: Vec3::new(-0.7, -0.7, 0.0) * bend, ..fur });
    let camera = study::close(subject.radius, SIZE);
    let tint: Tint = [one::ROOT, one::TIP].map(Vec3::from_array);
    let traced =
        Reference::new(&subject.levels[0], &look)?.with_images(&subject.images).with_traced_shadows();
    let want = traced.picture(&camera, SIZE, 1 << SMOOTH, &tint, sun.normalize());
    let shooter = Shooter::new(gpu, SIZE, SMOOTH);
    let mut renderer = Renderer::new(gpu, COLOUR, &subject.levels[..1], &look)?;
    renderer.set_images(gpu, &[0], &subject.images)?;
    let light = Sun { towards: sun, ..one::sun(subject.radius, false) };
    let list = one::tinted(LAYERS, (one::ROOT, one::TIP));
    let mut found = Errors::default();
    for (way, [error, brighter]) in [SelfShadow::Height, SelfShadow::Depth].into_iter().zip(&mut found) {
        renderer.set_look(gpu, &Look { self_shadow: way, ..look })?;
        let got = shooter.shoot(&mut renderer, &camera, &list, &light)?.pixels;
        *error = study::rmse(&want, &got, &sky_pixel());
        let sum = |pixels: &[u8]| pixels.iter().map(|v| f64::from(*v)).sum::<f64>();
        let seen = want.chunks(4).filter(|p| *p != sky_pixel()).count().max(1);
        *brighter = (sum(&got) - sum(&want)) / (3.0 * 255.0 * seen as f64);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing was chosen on this animal.
    #[test]
    fn shells_by_depth_are_nearer_to_traced_shadows_on_another_animal() {
        let Some(gpu) = Gpu::for_tests() else { return };
        let choices: crate::fur::Options = crate::common::parsed(&["--seed", "10"]).unwrap();
        let [[by_height, _], [by_depth, brighter]] = compare(&gpu, &choices.subject().unwrap()).unwrap();
        assert!(by_depth < 0.95 * by_height && brighter.abs() < 0.03, "{by_height} {by_depth} {brighter}");
    }
}
