//! Pictures without a window.

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use casca::internals::QueryInternals;
use casca_lab::command_line::{make_folder, say};
use casca_lab::world::{Camera, Shape};
use casca_stage::canvas::{Canvas, write_png};
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::panel::Panel;
use glam::Vec3;

use crate::draw::{Painter, coloured};
use crate::overlays::{Layer, Overlays};
use crate::panel::{self, Numbers};
use crate::playback::{Method, Playback};
use crate::renderer::Renderer;

/// What to draw.
pub struct Plan<'a> {
    /// How the scene is culled.
    pub method: Method,
    /// How many pictures of the path, evenly spread.
    pub frames: usize,
    /// Where they go.
    pub out: &'a Path,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Whether they look on from behind the culling camera.
    pub bird: bool,
    /// Layers that are on.
    pub layers: &'a [Layer],
}

/// Draws the path of a scene into PNG files; returns how many visible objects were lost, over all pictures.
///
/// # Errors
/// What is drawn cannot be had or written.
pub fn pictures(gpu: &Gpu, playback: &mut Playback, plan: &Plan<'_>) -> Result<usize, Box<dyn Error>> {
    make_folder(plan.out)?;
    let canvas = Canvas::new(gpu, plan.size);
    let mut renderer = Renderer::new(gpu, COLOUR, &playback.geometry);
    renderer.haze = haze(playback);
    let mut panel = Panel::new(gpu, COLOUR);
    let mut overlays = Overlays::default();
    plan.layers.iter().for_each(|&layer| overlays.toggle(layer));
    let aspect = canvas.aspect();
    let mut lost = 0;
    let name = playback.world.name.clone();
    let last = playback.world.frames.saturating_sub(1);
    for picture in 0..plan.frames {
        let at = last * (picture * 2 + 1) / (plan.frames * 2).max(1);
        while playback.ticks() < at {
            let camera = playback.path_camera(aspect);
            playback.frame(plan.method, &camera, &mut |_| Ok(()))?;
            playback.advance();
        }
        let camera = playback.path_camera(aspect);
        let watcher = if plan.bird { bird(&camera, playback, aspect) } else { camera };
        let ceilings = if plan.bird { ceilings(&camera, playback) } else { Vec::new() };
        playback.frame(plan.method, &camera, &mut |frame| {
            let mut painter = Painter { gpu, canvas: &canvas, renderer: &mut renderer };
            let check = painter.check(&camera, (frame.geometry, frame.objects), &frame.visible)?;
            lost += check.lost.len();
            let mut marks = overlays.marks(&frame, &check.lost)?;
            while !overlays.are_caps_ready() {
                std::thread::sleep(Duration::from_millis(20));
                marks = overlays.marks(&frame, &check.lost)?;
            }
            let start = Instant::now();
            let shown: Vec<usize> =
                frame.visible.iter().copied().filter(|&i| !ceilings.contains(&i)).collect();
            let list = coloured(frame.geometry, frame.objects, &shown);
            painter.picture(&watcher, &list, &marks);
            gpu.wait()?;
            let numbers = Numbers {
                scene: name.clone(),
                device: gpu.name.clone(),
                method: plan.method,
                frozen: plan.bird,
                visible: (frame.visible.len(), frame.objects.len()),
                times: (frame.time, start.elapsed()),
                check: Some((check.shown.len(), check.lost.len())),
                help: false,
            };
            let images = if overlays.is_on(Layer::Buffers) { frame.query.occlusion_images() } else { vec![] };
            panel::draw(&mut panel, (gpu, &canvas.picture(), 1.0), &numbers, &overlays, &images);
            let path = plan.out.join(format!("{name}-{at:04}-{}.png", plan.method));
            write_png(&path, canvas.size(), &canvas.read_picture(gpu)?)?;
            say(format_args!(
                "{}: {} of {} objects drawn, {} visible in pixels, {} lost",
                path.display(),
                frame.visible.len(),
                frame.objects.len(),
                check.shown.len(),
                check.lost.len()
            ));
            Ok(())
        })?;
    }
    Ok(lost)
}

/// How fast things fade: by about a fifth over the length of the scene.
pub fn haze(playback: &Playback) -> f32 {
    0.25 / (playback.world.grid.max - playback.world.grid.min).length().max(1e-3)
}

/// What would hide a storey from above: wide boxes above the eye.
fn ceilings(camera: &Camera, playback: &Playback) -> Vec<usize> {
    let grid = &playback.world.grid;
    let is_ceiling = |shape: &Shape| match shape {
        Shape::Box { min, max } => min.y > camera.eye.y && max.x - min.x > 0.5 * (grid.max.x - grid.min.x),
        _ => false,
    };
    let objects = playback.world.objects.iter().enumerate();
    objects.filter(|(_, object)| is_ceiling(&object.shape)).map(|(i, _)| i).collect()
}

/// A camera that looks on from behind and above another.
fn bird(camera: &Camera, playback: &Playback, aspect: f32) -> Camera {
    let grid = &playback.world.grid;
    let reach = (grid.max - grid.min).length();
    let forward = -camera.view.row(2).truncate();
    let level = Vec3::new(forward.x, 0.0, forward.z).normalize_or(Vec3::X);
    let side = level.cross(Vec3::Y);
    let eye = camera.eye - level * (0.2 * reach) + Vec3::Y * (0.36 * reach) + side * (0.12 * reach);
    Camera::look_at(eye, camera.eye + level * (0.18 * reach), 50.0, aspect, 0.01 * reach, 4.0 * reach)
}
