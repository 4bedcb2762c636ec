//! The levels of detail of an object: side by side, and how far each is from the finest where it is
//! used.

use std::error::Error;
use std::f32::consts::PI;

use casca_fur::gpu::look::sky_pixel;
use casca_fur::visibility::{layers_for, level_for};
use casca_scenes::world::Camera;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::command_line::say;
use casca_tools::image::write_png;

use crate::fur::choices::{Choices, Subject};
use crate::fur::one;
use crate::fur::shots::{Shooter, sheet};

/// The height of the pictures that are compared, in pixels.
const HEIGHT: u32 = 240;

/// Draws all levels into one file, as large as the mesh itself, and prints for each the error of
/// its picture at the distance where it is used.
pub fn levels(gpu: &Gpu, choices: &Choices, subject: &Subject) -> Result<(), Box<dyn Error>> {
    let (width, height) = choices.common.drawing.size;
    let large = Shooter::new(gpu, (width / 2, height / 2), choices.smooth);
    let mut renderer = one::renderer(gpu, COLOUR, choices, subject)?;
    let (camera, sun) = (one::camera(subject.radius, large.aspect()), one::sun(subject.radius, true));
    let mut pictures = Vec::new();
    for level in 0..subject.levels.len() as u32 {
        let list = one::level_list(subject, level, choices.layers, true);
        renderer.cast_shadows(gpu, &list, &sun)?;
        pictures.push(large.shoot(&mut renderer, &camera, &list, &sun)?);
    }
    let path = choices.out().join(format!("{}-levels.png", subject.name));
    let all = sheet(&pictures, 2);
    write_png(&path, all.size, &all.pixels)?;
    say(path.display());

    let counts: Vec<u32> = subject.levels.iter().map(|mesh| mesh.vertices().len() as u32).collect();
    let small = Shooter::new(gpu, (HEIGHT, HEIGHT), choices.smooth);
    say("level  triangles  pixels high  layers  RMSE");
    for (level, mesh) in subject.levels.iter().enumerate() {
        let size = used_at(level, &counts);
        // A radius of 1 appears so large at a distance of 1.
        let focal = HEIGHT as f32 * 0.5 / (25.0f32).to_radians().tan();
        let distance = 2.0 * subject.radius * focal / size;
        let eye = camera.eye.normalize_or_zero() * distance.max(1.6 * subject.radius);
        let (near, far) = (0.02 * subject.radius, 4.0 * distance + 40.0 * subject.radius);
        let there = Camera::look_at(eye, glam::Vec3::ZERO, 50.0, 1.0, near, far);
        let height = choices.height * 0.5 * size.min(HEIGHT as f32);
        let layers = layers_for(height, 1.0, choices.layers);
        let mut shot = |level: u32| {
            let list = one::level_list(subject, level, layers, false);
            small.shoot(&mut renderer, &there, &list, &one::sun(subject.radius, false))
        };
        let error = rmse(&shot(0)?.pixels, &shot(level as u32)?.pixels, &sky_pixel());
        let triangles = mesh.triangles().len();
        say(format_args!("{level:>5}  {triangles:>9}  {size:>11.0}  {layers:>6}  {error:.4}"));
    }
    Ok(())
}

/// The diameter in pixels of an object for which a level is the coarsest that is fine enough.
fn used_at(level: usize, counts: &[u32]) -> f32 {
    let (mut low, mut high) = (1.0f32, 1e5f32);
    for _ in 0..40 {
        let middle = (low * high).sqrt();
        let found = level_for(0.25 * PI * middle * middle, counts);
        if found >= level { low = middle } else { high = middle }
    }
    low
}

/// The error over the pixels in which either picture shows the object, 0 to 1.
fn rmse(want: &[u8], got: &[u8], sky: &[u8]) -> f64 {
    let shown = || want.chunks(4).zip(got.chunks(4)).filter(|(a, b)| *a != sky || *b != sky);
    let square = |(a, b): (&[u8], &[u8])| -> f64 {
        (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum::<f64>() / 3.0
    };
    let count = shown().count().max(1) as f64;
    (shown().map(square).sum::<f64>() / count).sqrt() / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_used_where_their_vertices_are_four_pixels_apart() {
        let counts = [1600, 400, 100];
        let sizes: Vec<f32> = (0..3).map(|level| used_at(level, &counts)).collect();
        // Level 1: 400 vertices on 6,400 pixels, a disc of 90 across.
        assert!((sizes[1] - 90.27).abs() < 0.1 && (sizes[2] - 45.1).abs() < 0.1, "{sizes:?}");
        assert!(sizes[0] >= 1e4, "the finest is used however near");
    }

    #[test]
    fn the_level_that_is_drawn_follows_the_distance_and_the_size_of_the_picture() {
        let choices: Choices = crate::common::parsed(&[]).unwrap();
        let subject = choices.subject().unwrap();
        let counts: Vec<u32> = subject.levels.iter().map(|mesh| mesh.vertices().len() as u32).collect();
        let level = |distance: f32, height: u32| {
            let eye = glam::Vec3::new(0.6, 0.0, 0.8) * distance;
            let there = Camera::look_at(eye, glam::Vec3::ZERO, 50.0, 1.0, 0.01, 1e4);
            one::level_at(&subject, &there, (height, height)) as usize
        };
        let focal = |height: u32| height as f32 * 0.5 / (25.0f32).to_radians().tan();
        for (number, height) in [(1, 480), (2, 240), (3, 240), (3, 480)] {
            let distance = 2.0 * subject.radius * focal(height) / used_at(number, &counts);
            let found = [0.99, 1.01].map(|share| level(share * distance, height));
            assert_eq!(found, [number - 1, number], "{height} pixels");
        }
        // Within the object, and in a picture that is smaller than the object.
        assert_eq!((level(0.01, 4000), level(0.01, 16)), (0, 3));
    }
}
