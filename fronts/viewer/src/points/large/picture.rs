//! The points that a frame takes without and with occlusion culling, from the eye and from above.

use std::path::Path;

use casca_points::bricks::{Loader, Want};
use casca_points::gpu::{Pane, Style, Surfel, SurfelRenderer, Surfels};
use casca_points::{Camera, PointCloud};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::panel::Panel;
use casca_stage::wgpu::Color;
use casca_stage::window::Done;
use casca_tools::image::{halved, write_png};
use glam::Vec3;

use crate::points::panes::caption;

/// Radii of discs, as multiples of those of squares: discs weigh little at their rims.
const DISC: f32 = 2.0;
/// How far discs may lie behind others and still blend with them, in metres.
const OFFSET: f32 = 0.1;
/// How high the eye above is, how far before the eye of the frame it looks, and how far it is
/// behind it, in metres.
const ABOVE: [f32; 3] = [260.0, 100.0, 60.0];

/// Draws four panes: in the upper row from the eye, in the lower from above; on the left the points
/// of all bricks in the frustum, on the right those of the bricks that may be seen. Waits until
/// they are loaded.
pub fn draw(path: &Path, loader: &Loader, camera: &Camera, wants: &[Vec<Want>; 2]) -> Done {
    let gpu = Gpu::headless(false)?;
    let (width, height) = camera.size();
    let canvas = Canvas::new(&gpu, (2 * width, height));
    let (renderer, mut panel) = (SurfelRenderer::new(&gpu, COLOUR), Panel::new(&gpu, COLOUR));
    let ways = ["in the frustum", "that may be visible"];
    let mut shown = Vec::new();
    for (wants, way) in wants.iter().zip(ways) {
        loader.want(wants);
        loader.settle();
        let cloud = loader.gather(wants);
        shown.push((
            Surfels::new(&gpu, &surfels(&cloud))?,
            format!("bricks {way}: {} of them, {} points", wants.len(), cloud.len()),
        ));
    }
    let style = Style { scale: 1.0, least_pixels: 0.8, offset: OFFSET, lit: false };
    let mut pixels = Vec::new();
    for camera in [camera, &above(camera)?] {
        let corners = [(0, 0), (width, 0)];
        let panes: Vec<Pane> =
            shown.iter().zip(corners).map(|((surfels, _), corner)| Pane { surfels, style, corner }).collect();
        renderer.draw(&gpu, &canvas.picture(), camera, Color::WHITE, &panes);
        panel.draw(&gpu, &canvas.picture(), 1.0, &|context| {
            for ((_, title), corner) in shown.iter().zip(corners) {
                caption(context, corner, (width, height), 1.0, title);
            }
        });
        pixels.extend(canvas.read_picture(&gpu)?);
    }
    write_png(path, (width, height), &halved(&pixels, (2 * width, 2 * height)))?;
    Ok(())
}

fn surfels(cloud: &PointCloud) -> Vec<Surfel> {
    let points = cloud.positions.iter().zip(&cloud.radii).zip(&cloud.colours);
    points
        .map(|((position, radius), &[r, g, b])| Surfel {
            position: position.to_array(),
            radius: DISC * radius,
            normal: [0.0; 3],
            colour: [r, g, b, 255],
        })
        .collect()
}

/// A camera high behind the eye, which looks down at the ground before it.
fn above(camera: &Camera) -> Result<Camera, casca_points::CameraError> {
    let [height, before, behind] = ABOVE;
    let forward = camera.axes()[2].with_y(0.0).normalize_or(Vec3::X);
    let eye = camera.eye() - forward * behind + Vec3::Y * height;
    let target = camera.eye() + forward * before;
    Camera::look_at(eye, target, Vec3::Y, 0.9, camera.size(), 1.0, 4.0 * height)
}
