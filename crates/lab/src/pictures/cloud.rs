//! Points of a cloud, coloured by how an answer about them differs from the truth.

use std::path::Path;

use glam::{Vec3, Vec4};
use plotters::style::RGBColor;

use super::PictureError;
use super::palette::{LOST, QUIET, SPARE, TEXT};
use super::raster::Canvas;
use casca_scenes::world::Camera;

/// What became of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// Hidden, and found so.
    Hidden,
    /// Visible, and found so.
    Visible,
    /// Hidden, but found visible.
    FalseVisible,
    /// Visible, but found hidden.
    FalseHidden,
}

impl Fate {
    /// The fate of a point by truth and answer.
    pub fn of(truth: bool, found: bool) -> Self {
        match (truth, found) {
            (true, true) => Self::Visible,
            (false, false) => Self::Hidden,
            (false, true) => Self::FalseVisible,
            (true, false) => Self::FalseHidden,
        }
    }

    fn color(self) -> RGBColor {
        match self {
            Self::Visible => RGBColor(176, 190, 214),
            Self::Hidden => RGBColor(58, 62, 74),
            Self::FalseVisible => SPARE,
            Self::FalseHidden => LOST,
        }
    }
}

/// One answer about the points of a cloud.
#[derive(Debug, Clone)]
pub struct CloudPanel {
    /// The method and its errors.
    pub caption: String,
    /// The fate of each point.
    pub fates: Vec<Fate>,
}

/// How the points of all panels are looked at.
#[derive(Debug, Clone, Copy)]
pub struct CloudView<'a> {
    /// The points.
    pub points: &'a [Vec3],
    /// The length that a point is drawn as, in the world.
    pub size: f32,
    /// The eye that the answers are for.
    pub eye: Vec3,
    /// The camera that looks at the points from elsewhere; as wide as high.
    pub camera: Camera,
}

const SIDE: usize = 460;
const HEAD: usize = 112;
const CAPTION: usize = 34;
const GROUND: RGBColor = RGBColor(250, 250, 252);
const WHITE: RGBColor = RGBColor(255, 255, 255);

/// Draws the points of a cloud as a PNG, once for each answer, side by side. The finding is its
/// title.
///
/// # Errors
/// If the file cannot be written.
pub fn cloud(
    path: &Path,
    title: &str,
    subtitle: &str,
    view: &CloudView,
    panels: &[CloudPanel],
) -> Result<(), PictureError> {
    let width = (SIDE + 10) * panels.len().max(2) + 10;
    let mut canvas = Canvas::new(width, HEAD + CAPTION + SIDE + 10, WHITE);
    canvas.text((12.0, 22.0), 25.0, TEXT, title);
    canvas.text((12.0, 52.0), 19.0, QUIET, subtitle);
    let mut x = 20.0;
    for (fate, label) in [
        (Fate::Visible, "visible, and found so"),
        (Fate::Hidden, "hidden, and found so"),
        (Fate::FalseVisible, "false visible: hidden, but found visible"),
        (Fate::FalseHidden, "false hidden: visible, but found hidden"),
    ] {
        canvas.disc((x, 86.0), 9.0, QUIET);
        canvas.disc((x, 86.0), 8.0, fate.color());
        x = canvas.text((x + 16.0, 86.0), 19.0, TEXT, label) + 36.0;
    }
    for (i, panel) in panels.iter().enumerate() {
        draw(&mut canvas, 10 + i * (SIDE + 10), view, panel);
    }
    canvas.save(path)
}

/// One panel, whose left border is given.
fn draw(canvas: &mut Canvas, left: usize, view: &CloudView, panel: &CloudPanel) {
    canvas.text((left as f32 + 2.0, (HEAD + CAPTION / 2) as f32), 19.0, TEXT, &panel.caption);
    let top = HEAD + CAPTION;
    canvas.rect((left, top), (SIDE, SIDE), GROUND);
    let matrix = view.camera.view_projection();
    let place = |clip: Vec4| {
        let half = SIDE as f32 / 2.0;
        (left as f32 + half + clip.x / clip.w * half, top as f32 + half - clip.y / clip.w * half)
    };
    let inside = |(x, y): (f32, f32), margin: f32| {
        let (x, y, side) = (x - left as f32, y - top as f32, SIDE as f32);
        x > margin && y > margin && x < side - margin && y < side - margin
    };
    let scale = view.camera.projection.y_axis.y * SIDE as f32 / 2.0;
    let mut order: Vec<(Vec4, Fate)> =
        view.points.iter().zip(&panel.fates).map(|(p, f)| (matrix * p.extend(1.0), *f)).collect();
    order.retain(|(clip, _)| clip.w > view.size);
    order.sort_by(|a, b| b.0.w.total_cmp(&a.0.w));
    for (clip, fate) in order {
        let radius = (view.size * scale / clip.w * 0.5).clamp(0.8, 6.0);
        // Errors are few, and must not be overlooked.
        let radius = if matches!(fate, Fate::Visible | Fate::Hidden) { radius } else { radius.max(1.6) };
        if inside(place(clip), radius + 1.0) {
            canvas.disc(place(clip), radius, fate.color());
        }
    }
    let clip = matrix * view.eye.extend(1.0);
    if clip.w > 0.0 {
        eye(canvas, place(clip), (left, top), inside(place(clip), 20.0));
    }
}

/// Marks the eye, or beside the border an arrow that comes from it.
fn eye(canvas: &mut Canvas, at: (f32, f32), (left, top): (usize, usize), is_inside: bool) {
    let half = SIDE as f32 / 2.0;
    let middle = (left as f32 + half, top as f32 + half);
    if is_inside {
        canvas.disc(at, 8.0, WHITE);
        canvas.disc(at, 6.0, TEXT);
        canvas.text((at.0 + 12.0, at.1), 19.0, TEXT, "eye");
        return;
    }
    let (x, y) = (at.0 - middle.0, at.1 - middle.1);
    let length = x.hypot(y);
    let border = (half - 26.0) / (x.abs().max(y.abs()) / length);
    let along = |t: f32| (middle.0 + x / length * t, middle.1 + y / length * t);
    for step in 0..40 {
        canvas.disc(along(border - step as f32), 1.5, TEXT);
    }
    canvas.diamond(along(border - 40.0), 7.0, TEXT);
    let text = along(border - 12.0);
    canvas.text((text.0 - 10.0, text.1 + 18.0), 19.0, TEXT, "eye");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_drawn_for_eyes_anywhere() {
        let path = std::env::temp_dir().join(format!("casca-cloud-{}.png", std::process::id()));
        let points = [Vec3::ZERO, Vec3::ONE, Vec3::NAN, Vec3::splat(1e30)];
        let fates =
            [Fate::of(true, true), Fate::of(false, true), Fate::of(true, false), Fate::of(false, false)];
        let panel = CloudPanel { caption: "a method".to_owned(), fates: fates.to_vec() };
        for eye in [Vec3::ZERO, Vec3::X * 50.0, Vec3::Z * 50.0, Vec3::Z * 4.0] {
            let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 45.0, 1.0, 0.1, 100.0);
            let view = CloudView { points: &points, size: 0.1, eye, camera };
            cloud(&path, "A title", "words", &view, &[panel.clone(), panel.clone()]).unwrap();
        }
        std::fs::remove_file(&path).unwrap();
    }
}
