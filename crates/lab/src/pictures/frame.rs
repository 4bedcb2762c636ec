//! One frame: the objects seen and hidden, and the occlusion buffers behind that.

use std::path::Path;

use casca::internals::OcclusionImage;
use plotters::style::RGBColor;

use super::PictureError;
use super::palette::{HIDDEN, LOST, OPEN_PIXEL, QUIET, SPARE, TEXT, VISIBLE};
use super::raster::Canvas;
use casca_scenes::world::{Camera, Object, Shape};
use casca_truth::oracle::{ItemBuffer, NONE};

const WHITE: RGBColor = RGBColor(255, 255, 255);
const SKY: RGBColor = RGBColor(245, 246, 250);
/// Pixels above a frame, for its finding and the legend.
const HEAD: usize = 106;

/// A frame, and the objects that a method finds visible in it.
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

/// What the method did with an object that is in the frustum.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fate {
    Kept,
    Lost,
    Hidden,
    Spare,
}

fn fate(f: &FramePicture, object: usize) -> Fate {
    match (f.exact.visible()[object] > 0, (f.sees)(object)) {
        (true, true) => Fate::Kept,
        (true, false) => Fate::Lost,
        (false, false) => Fate::Hidden,
        (false, true) => Fate::Spare,
    }
}

/// The mark of an object: each fate has another shape. White around it parts it from the picture.
fn mark(canvas: &mut Canvas, at: (f32, f32), fate: Fate) {
    match fate {
        Fate::Kept => canvas.disc(at, 8.0, VISIBLE),
        Fate::Hidden => {
            canvas.disc(at, 4.2, WHITE);
            canvas.disc(at, 3.0, HIDDEN);
        }
        Fate::Spare => {
            canvas.diamond(at, 8.5, TEXT);
            canvas.diamond(at, 6.0, SPARE);
        }
        Fate::Lost => {
            canvas.cross(at, 9.0, 3.5, WHITE);
            canvas.cross(at, 8.0, 2.0, LOST);
        }
    }
}

/// Draws a frame as a PNG: the scene, in orange the visible objects that were lost, and marks where
/// hidden objects are, left out or drawn in vain. The finding is its title, and `title` stands
/// below.
///
/// # Errors
/// If the file cannot be written.
pub fn frame(path: &Path, title: &str, f: &FramePicture) -> Result<(), PictureError> {
    let (w, h) = (f.exact.width(), f.exact.height());
    let mut canvas = Canvas::new(w, h + HEAD, WHITE);
    canvas.rect((0, HEAD), (w, h), SKY);
    let depths = f.exact.depths();
    let far = depths.iter().copied().filter(|d| d.is_finite()).fold(1.0, f64::max);
    for (i, (&item, &depth)) in f.exact.items().iter().zip(depths).enumerate() {
        if item != NONE {
            let lost = f.objects[item as usize].tested && !(f.sees)(item as usize);
            let color = if lost { LOST } else { shade(item, depth, far) };
            canvas.set(i % w, i / w + HEAD, color);
        }
    }
    let tested = f.in_frustum.iter().copied().filter(|&i| f.objects[i].tested);
    let fates: Vec<(usize, Fate)> = tested.map(|i| (i, fate(f, i))).collect();
    let matrix = f.camera.view_projection();
    // The rarer fates last, on top.
    for wanted in [Fate::Hidden, Fate::Spare, Fate::Lost] {
        for &(i, fate) in fates.iter().filter(|(_, fate)| *fate == wanted) {
            let clip = matrix * middle(&f.objects[i].shape).extend(1.0);
            let x = (clip.x / clip.w * 0.5 + 0.5) * w as f32;
            let y = (0.5 - clip.y / clip.w * 0.5) * h as f32;
            let inside = x > 3.0 && y > 3.0 && x < w as f32 - 3.0 && y < h as f32 - 3.0;
            if clip.w > 0.0 && inside {
                mark(&mut canvas, (x, y + HEAD as f32), fate);
            }
        }
    }
    let count = |wanted: Fate| fates.iter().filter(|(_, fate)| *fate == wanted).count();
    let [kept, lost, hidden, spare] = [Fate::Kept, Fate::Lost, Fate::Hidden, Fate::Spare].map(count);
    canvas.text((14.0, 22.0), 26.0, TEXT, &finding(kept, lost, hidden, spare));
    canvas.text((14.0, 52.0), 19.0, QUIET, title);
    let mut x = 22.0;
    for (fate, label) in [
        (Fate::Kept, format!("visible and found: {kept}")),
        (Fate::Lost, format!("visible and lost: {lost}")),
        (Fate::Hidden, format!("hidden and left out, marked at its middle: {hidden}")),
        (Fate::Spare, format!("hidden, but drawn: {spare}")),
    ] {
        mark(&mut canvas, (x, 84.0), fate);
        x = canvas.text((x + 16.0, 84.0), 19.0, TEXT, &label) + 38.0;
    }
    canvas.save(path)
}

fn finding(kept: usize, lost: usize, hidden: usize, spare: usize) -> String {
    let visible = match lost {
        0 => format!("None of {kept} visible objects is lost"),
        _ => format!("{lost} of {} visible objects are lost", kept + lost),
    };
    format!("{visible}, and {hidden} of {} hidden ones are left out", hidden + spare)
}

/// Draws the occlusion buffers of a query as a PNG: a panel for each side, covered pixels lighter
/// with distance, open ones in yellow. The finding is its title, and `title` stands below.
///
/// # Errors
/// If the file cannot be written, or there are no buffers.
pub fn buffers(path: &Path, title: &str, images: &[OcclusionImage]) -> Result<(), PictureError> {
    if images.is_empty() {
        return Err(PictureError::at(path)("there are no buffers".to_owned()));
    }
    let scale = |i: &OcclusionImage| (560 / i.width.max(i.height).max(1)).max(1);
    let width = images.iter().map(|i| i.width * scale(i) + 24).sum::<usize>().max(900);
    let height = images.iter().map(|i| i.height * scale(i)).max().unwrap_or(0) + 160;
    let mut canvas = Canvas::new(width, height, WHITE);
    let in_view = || images.iter().flat_map(|i| &i.depth).filter(|d| **d != 0.0);
    let covered = in_view().filter(|d| d.is_finite()).count() as f64 / in_view().count().max(1) as f64;
    let finding = format!("Occluders cover {:.0}% of the buffers' pixels in view", covered * 100.0);
    canvas.text((14.0, 22.0), 26.0, TEXT, &finding);
    canvas.text((14.0, 52.0), 19.0, QUIET, title);
    legend(&mut canvas);
    let mut left = 12;
    for image in images {
        let size = scale(image);
        let far = image.depth.iter().copied().filter(|d| d.is_finite()).fold(1.0f32, f32::max);
        for (i, &depth) in image.depth.iter().enumerate() {
            // Rows go up on the face and down on the screen.
            let (x, y) = (i % image.width, image.height - 1 - i / image.width);
            canvas.rect((left + x * size, 142 + y * size), (size, size), covering(depth, far));
        }
        let label = format!("side towards {}", axis(image.direction));
        canvas.text((left as f32, 124.0), 18.0, TEXT, &label);
        left += image.width * size + 24;
    }
    canvas.save(path)
}

/// The axis along which a side lies.
fn axis(direction: glam::Vec3) -> String {
    let sign = if direction.max_element() > 0.5 { "+" } else { "-" };
    format!("{sign}{}", ["x", "y", "z"][direction.abs().max_position()])
}

/// The colour of a buffer's pixel.
fn covering(depth: f32, far: f32) -> RGBColor {
    if depth == 0.0 {
        return WHITE;
    }
    if !depth.is_finite() {
        return OPEN_PIXEL;
    }
    let light = (40.0 + 160.0 * (depth / far).clamp(0.0, 1.0).sqrt()) as u8;
    RGBColor(light, light, light.saturating_add(20))
}

fn legend(canvas: &mut Canvas) {
    let boxed = |canvas: &mut Canvas, x: f32, color: RGBColor| {
        canvas.rect((x as usize, 74), (34, 20), QUIET);
        canvas.rect((x as usize + 1, 75), (32, 18), color);
    };
    let text = |canvas: &mut Canvas, x: f32, label: &str| canvas.text((x, 84.0), 19.0, TEXT, label);
    for step in 0..68 {
        let color = covering(step as f32 + 1.0, 68.0);
        canvas.rect((14 + step, 74), (1, 20), color);
    }
    let x = text(canvas, 92.0, "covered, near to far") + 30.0;
    boxed(canvas, x, OPEN_PIXEL);
    let x = text(canvas, x + 44.0, "open: objects here can be seen") + 30.0;
    boxed(canvas, x, WHITE);
    text(canvas, x + 44.0, "outside the view");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_title_of_a_frame_counts_losses() {
        assert_eq!(
            finding(9, 0, 30, 1),
            "None of 9 visible objects is lost, and 30 of 31 hidden ones are left out"
        );
        assert_eq!(
            finding(7, 2, 3, 0),
            "2 of 9 visible objects are lost, and 3 of 3 hidden ones are left out"
        );
    }
}
