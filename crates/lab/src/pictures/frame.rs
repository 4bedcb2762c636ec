//! One frame: what is seen and what is hidden, and the occlusion buffers behind that.

use std::path::Path;

use casca::OcclusionImage;
use plotters::prelude::*;

use super::{FONT, PictureError, error, with_font};
use crate::oracle::{ItemBuffer, NONE};
use crate::world::{Camera, Object, Shape};

const LOST: RGBColor = RGBColor(220, 30, 30);
const HIDDEN: RGBColor = RGBColor(30, 140, 60);
const SPARE: RGBColor = RGBColor(240, 150, 20);
const BACKGROUND: RGBColor = RGBColor(245, 246, 250);

/// What a method made of a frame.
pub struct FramePicture<'a> {
    /// The exact picture.
    pub exact: &'a ItemBuffer,
    /// The scene.
    pub objects: &'a [Object],
    /// The camera.
    pub camera: Camera,
    /// Objects in the frustum.
    pub in_frustum: &'a [usize],
    /// Whether the method finds an object visible.
    pub sees: &'a dyn Fn(usize) -> bool,
}

/// A color of its own for each object, darker with distance.
fn shade(object: u32, depth: f64, far: f64) -> RGBColor {
    let hash = object.wrapping_mul(0x9e37_79b9) >> 8;
    let near = 1.0 - 0.75 * (depth / far).clamp(0.0, 1.0).sqrt();
    let part = |shift: u32| {
        let own = f64::from(hash >> shift & 63);
        ((120.0 + own) * near + 225.0 * (1.0 - near) * 0.6) as u8
    };
    RGBColor(part(0), part(6), part(12))
}

fn middle(shape: &Shape) -> glam::Vec3 {
    match shape {
        Shape::Sphere { center, .. } => *center,
        Shape::Box { min, max } => (*min + *max) * 0.5,
        Shape::Mesh { mesh, transform } => {
            let sum: glam::Vec3 = mesh.positions.iter().sum();
            transform.transform_point3(sum / mesh.positions.len().max(1) as f32)
        }
    }
}

/// Draws a frame as a PNG: the scene, in red what is visible and was lost, and dots on what is
/// hidden: green where the method hides it, orange where it does not.
///
/// # Errors
/// If the file cannot be written.
pub fn frame(path: &Path, title: &str, f: &FramePicture) -> Result<(), PictureError> {
    let fail = error(path);
    with_font();
    let (w, h) = (f.exact.width(), f.exact.height());
    let root = BitMapBackend::new(path, (w as u32, h as u32 + 74)).into_drawing_area();
    let draw = || -> Result<(), Box<dyn std::error::Error>> {
        root.fill(&WHITE)?;
        let (head, picture) = root.split_vertically(74);
        picture.fill(&BACKGROUND)?;
        let depths = f.exact.depths();
        let far = depths.iter().copied().filter(|d| d.is_finite()).fold(1.0, f64::max);
        for (i, (&item, &depth)) in f.exact.items().iter().zip(depths).enumerate() {
            if item == NONE {
                continue;
            }
            let lost = f.objects[item as usize].tested && !(f.sees)(item as usize);
            let color = if lost { LOST } else { shade(item, depth, far) };
            picture.draw_pixel(((i % w) as i32, (i / w) as i32), &color)?;
        }
        let matrix = f.camera.view_projection();
        let (mut lost, mut hidden, mut spare, mut visible) = (0, 0, 0, 0);
        for &i in f.in_frustum.iter().filter(|&&i| f.objects[i].tested) {
            let color = match (f.exact.visible()[i] > 0, (f.sees)(i)) {
                (true, true) => {
                    visible += 1;
                    continue;
                }
                (true, false) => {
                    lost += 1;
                    LOST
                }
                (false, true) => {
                    spare += 1;
                    SPARE
                }
                (false, false) => {
                    hidden += 1;
                    HIDDEN
                }
            };
            let clip = matrix * middle(&f.objects[i].shape).extend(1.0);
            if clip.w > 0.0 {
                let x = (clip.x / clip.w * 0.5 + 0.5) * w as f32;
                let y = (0.5 - clip.y / clip.w * 0.5) * h as f32;
                let inside = x > 3.0 && y > 3.0 && x < w as f32 - 3.0 && y < h as f32 - 3.0;
                if inside {
                    picture.draw(&Circle::new((x as i32, y as i32), 2, color.filled()))?;
                }
            }
        }
        head.draw(&Text::new(title.to_owned(), (12, 8), (FONT, 24).into_font()))?;
        let mut x = 14;
        for (color, label) in [
            (RGBColor(120, 130, 150), format!("{visible} visible and found")),
            (LOST, format!("{lost} visible and lost")),
            (HIDDEN, format!("{hidden} hidden (middle marked)")),
            (SPARE, format!("{spare} hidden, but drawn")),
        ] {
            head.draw(&Circle::new((x, 55), 6, color.filled()))?;
            let width = 34 + 9 * label.len() as i32;
            head.draw(&Text::new(label, (x + 12, 45), (FONT, 18).into_font()))?;
            x += width;
        }
        root.present()?;
        Ok(())
    };
    draw().map_err(|e| fail(e.to_string()))
}

/// Draws the occlusion buffers of a query as a PNG: a panel for each side, covered pixels darker
/// with distance, uncovered ones in yellow.
///
/// # Errors
/// If the file cannot be written, or there are no buffers.
pub fn buffers(path: &Path, title: &str, images: &[OcclusionImage]) -> Result<(), PictureError> {
    let fail = error(path);
    with_font();
    let scale = |i: &OcclusionImage| (560 / i.width.max(i.height).max(1)).max(1);
    let width = images.iter().map(|i| i.width * scale(i) + 24).sum::<usize>().max(460) as u32;
    let height = images.iter().map(|i| i.height * scale(i)).max().unwrap_or(0) as u32 + 120;
    let root = BitMapBackend::new(path, (width, height)).into_drawing_area();
    let draw = || -> Result<(), Box<dyn std::error::Error>> {
        root.fill(&WHITE)?;
        root.draw(&Text::new(title.to_owned(), (12, 8), (FONT, 24).into_font()))?;
        let legend = "dark: covered (lighter = farther); yellow: open; white: outside the view";
        root.draw(&Text::new(legend.to_owned(), (12, 40), (FONT, 17).into_font()))?;
        let mut left = 12;
        for image in images {
            let size = scale(image);
            let far = image.depth.iter().copied().filter(|d| d.is_finite()).fold(1.0f32, f32::max);
            for y in 0..image.height {
                for x in 0..image.width {
                    let depth = image.depth[y * image.width + x];
                    let color = if depth == 0.0 {
                        WHITE
                    } else if depth.is_finite() {
                        let light = (40.0 + 160.0 * (depth / far).clamp(0.0, 1.0).sqrt()) as u8;
                        RGBColor(light, light, light.saturating_add(20))
                    } else {
                        RGBColor(255, 214, 90)
                    };
                    // Rows go up on the face and down on the screen.
                    let (px, py) = (left + x * size, 100 + (image.height - 1 - y) * size);
                    let corners = [(px as i32, py as i32), ((px + size) as i32, (py + size) as i32)];
                    root.draw(&Rectangle::new(corners, color.filled()))?;
                }
            }
            let side = image.direction;
            let label = format!("side ({:.0}, {:.0}, {:.0})", side.x, side.y, side.z);
            root.draw(&Text::new(label, (left as i32, 74), (FONT, 17).into_font()))?;
            left += image.width * size + 24;
        }
        root.present()?;
        Ok(())
    };
    draw().map_err(|e| fail(e.to_string()))
}
