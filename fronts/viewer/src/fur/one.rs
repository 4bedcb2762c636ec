//! One furry object: its picture.

use std::error::Error;
use std::f32::consts::PI;
use std::path::Path;

use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::records::Block;
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::visibility::{level_for, pixels_of};
use casca_scenes::world::Camera;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::wgpu::TextureFormat;
use casca_tools::command_line::say;
use glam::{Affine3A, Vec3};

use crate::common::Film;
use crate::fur::choices::{Choices, Subject};

/// Seconds between pictures of what walks.
const STEP: f64 = 0.25;

/// The direction towards the sun.
pub const TO_SUN: Vec3 = Vec3::new(0.45, 0.75, 0.5);

/// Colours that multiply those of the mesh, at roots and tips: tips of real fur are bleached.
const ROOT: [f32; 3] = [0.85, 0.82, 0.8];
const TIP: [f32; 3] = [1.6, 1.57, 1.55];
/// The haze of a way of one radius.
const HAZE: f32 = 0.008;

/// The sun over an object of a radius.
pub fn sun(radius: f32) -> Sun {
    Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 1.6 * radius, shadows: true }
}

/// Looks at an object from before, from its side and from above.
pub fn camera(radius: f32, aspect: f32) -> Camera {
    let eye = Vec3::new(1.25, 0.42, 1.5) * radius * 0.9;
    Camera::look_at(eye, Vec3::new(0.05, -0.02, 0.0) * radius, 50.0, aspect, 0.05 * radius, 40.0 * radius)
}

/// The object where it is modelled, over a ground, posed at a time in seconds if it walks: a level of
/// detail; the coarsest if there is none of this number.
pub fn level_list(
    subject: &Subject,
    level: u32,
    layers: u32,
    seconds: f64,
) -> Result<DrawList, casca_fur::Error> {
    let mesh = (level as usize).min(subject.levels.len() - 1);
    let place = subject.walker.as_ref().map_or(Affine3A::IDENTITY, |walker| walker.place);
    let stand = Stand { mesh, place, root: ROOT, tip: TIP };
    let (low, r) = (subject.low, subject.radius);
    let block =
        Block { min: [-30.0 * r, low - r, -30.0 * r], paint: 0, max: [30.0 * r, low, 30.0 * r], pad: 0 };
    let mut list = DrawList::new(&[(stand, layers)], vec![block]);
    if let Some(walker) = &subject.walker {
        walker.pose(&mut list, seconds)?;
    }
    Ok(list)
}

/// The level of detail for a camera and a picture of so many pixels: by [`level_for`], for the disc
/// that the ball around the object covers.
pub fn level_at(subject: &Subject, camera: &Camera, (width, height): (u32, u32)) -> u32 {
    let counts: Vec<u32> = subject.levels.iter().map(|mesh| mesh.vertices().len() as u32).collect();
    let focal = camera.projection.y_axis.y * height as f32 * 0.5;
    let size = pixels_of(2.0 * subject.radius, camera.eye.length(), focal);
    let covered = (0.25 * PI * size * size).min(width as f32 * height as f32);
    level_for(covered, &counts) as u32
}

/// A renderer for the object, which can be posed if it walks.
pub fn renderer(
    gpu: &Gpu,
    format: TextureFormat,
    choices: &Choices,
    subject: &Subject,
) -> Result<Renderer, FurGpuError> {
    let mut renderer = Renderer::new(gpu, format, &subject.levels, &choices.look(subject.radius)?)?;
    renderer.haze = HAZE / subject.radius;
    for (level, weights) in subject.walker.iter().flat_map(|walker| &walker.weights).enumerate() {
        renderer.set_weights(gpu, level, weights)?;
    }
    Ok(renderer)
}

/// Draws the object into a file.
pub fn pictures(
    gpu: &Gpu,
    choices: &Choices,
    subject: &Subject,
    folder: &Path,
) -> Result<(), Box<dyn Error>> {
    let film = Film::new(gpu, choices.common.size, true);
    let mut renderer = renderer(gpu, COLOUR, choices, subject)?;
    let camera = camera(subject.radius, film.canvas.aspect());
    let sun = sun(subject.radius);
    let frames = subject.walker.as_ref().map_or(1, |_| choices.common.frames.unwrap_or(2));
    for frame in 0..frames {
        let list = level_list(subject, 0, choices.layers, 0.1 + STEP * f64::from(frame))?;
        let name = match &subject.walker {
            None => format!("{}.png", subject.name),
            Some(_) => format!("{}-walk-{frame}.png", subject.name),
        };
        renderer.cast_shadows(gpu, &list, &sun)?;
        renderer.draw(gpu, &film.canvas.picture(), &camera, &list, &sun)?;
        film.save(gpu, &folder.join(name))?;
    }
    let mesh = &subject.levels[0];
    say(format_args!(
        "{} triangles, {} vertices, {} layers",
        mesh.triangles().len(),
        mesh.vertices().len(),
        choices.layers
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_of_detail_follows_the_distance_and_the_size_of_the_picture() {
        let choices: Choices = crate::common::parsed(&[]).unwrap();
        let subject = choices.subject().unwrap();
        let level = |distance: f32, height: u32| {
            let eye = Vec3::new(0.6, 0.0, 0.8) * distance;
            level_at(&subject, &Camera::look_at(eye, Vec3::ZERO, 50.0, 1.0, 0.01, 1e4), (height, height))
        };
        let far: Vec<u32> = (0..12).map(|i| level(2.0f32.powi(i), 480)).collect();
        assert!(far.is_sorted() && far[0] == 0 && far[11] as usize == subject.levels.len() - 1, "{far:?}");
        // Within the object, and in a picture that is smaller than the object.
        assert_eq!((level(0.01, 4000), level(0.01, 16) as usize), (0, subject.levels.len() - 1));
    }
}
