//! One frame: the objects seen and hidden.

use std::path::Path;

use plotters::style::RGBColor;

use super::PictureError;
use super::palette::{HIDDEN, LOST, QUIET, SPARE, TEXT, VISIBLE};
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
