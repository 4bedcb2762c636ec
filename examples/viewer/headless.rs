//! Pictures without a window.

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use casca_lab::command_line::{make_folder, say};
use casca_lab::world::{Camera, Shape};
use glam::Vec3;

use super::canvas::{Canvas, coloured, write_png};
use super::gpu::{COLOUR, Gpu};
use super::overlays::{Layer, Overlays};
use super::panel::{Numbers, Panel};
use super::renderer::Renderer;
use super::stage::{Method, Stage};

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

/// Draws the path of a scene into PNG files.
///
/// # Errors
/// What is drawn cannot be had or written.
pub fn pictures(gpu: &Gpu, stage: &mut Stage, plan: &Plan<'_>) -> Result<(), Box<dyn Error>> {
    make_folder(plan.out)?;
    let canvas = Canvas::new(gpu, plan.size);
    let mut renderer = Renderer::new(gpu, COLOUR, &stage.geometry);
    renderer.haze = haze(stage);
    let mut panel = Panel::new(gpu, COLOUR);
    let mut overlays = Overlays::default();
    plan.layers.iter().for_each(|&layer| overlays.toggle(layer));
    let aspect = canvas.size.0 as f32 / canvas.size.1 as f32;
    let name = stage.world.name.clone();
    let last = stage.world.frames.saturating_sub(1);
    for picture in 0..plan.frames {
        let at = last * (picture * 2 + 1) / (plan.frames * 2).max(1);
        while stage.ticks() < at {
            let camera = stage.path_camera(aspect);
            stage.frame(plan.method, &camera, &mut |_| Ok(()))?;
            stage.advance();
        }
        let camera = stage.path_camera(aspect);
        let watcher = if plan.bird { bird(&camera, stage, aspect) } else { camera };
        let ceilings = if plan.bird { ceilings(&camera, stage) } else { Vec::new() };
        stage.frame(plan.method, &camera, &mut |frame| {
            let check =
                canvas.check(gpu, &mut renderer, &camera, (frame.geometry, frame.objects), &frame.visible)?;
            let mut marks = overlays.marks(&frame, &check.lost)?;
            while !overlays.are_caps_ready() {
                std::thread::sleep(Duration::from_millis(20));
                marks = overlays.marks(&frame, &check.lost)?;
            }
            let start = Instant::now();
            let shown: Vec<usize> =
                frame.visible.iter().copied().filter(|&i| !ceilings.contains(&i)).collect();
            let list = coloured(frame.geometry, frame.objects, &shown);
            canvas.draw(gpu, &mut renderer, &watcher, &list, &marks);
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
            let view = canvas.picture.create_view(&Default::default());
            panel.draw(gpu, &view, 1.0, &numbers, &overlays, &images);
            let path = plan.out.join(format!("{name}-{at:04}-{}.png", plan.method));
            write_png(&path, canvas.size, &gpu.read(&canvas.picture)?)?;
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
    Ok(())
}

/// How fast things fade: by about a fifth over the length of the scene.
pub fn haze(stage: &Stage) -> f32 {
    0.25 / (stage.world.grid.max - stage.world.grid.min).length().max(1e-3)
}

/// What would hide a storey from above: wide boxes above the eye.
fn ceilings(camera: &Camera, stage: &Stage) -> Vec<usize> {
    let grid = &stage.world.grid;
    let is_ceiling = |shape: &Shape| match shape {
        Shape::Box { min, max } => min.y > camera.eye.y && max.x - min.x > 0.5 * (grid.max.x - grid.min.x),
        _ => false,
    };
    let objects = stage.world.objects.iter().enumerate();
    objects.filter(|(_, object)| is_ceiling(&object.shape)).map(|(i, _)| i).collect()
}

/// A camera that looks on from behind and above another.
fn bird(camera: &Camera, stage: &Stage, aspect: f32) -> Camera {
    let grid = &stage.world.grid;
    let reach = (grid.max - grid.min).length();
    let forward = -camera.view.row(2).truncate();
    let level = Vec3::new(forward.x, 0.0, forward.z).normalize_or(Vec3::X);
    let side = level.cross(Vec3::Y);
    let eye = camera.eye - level * (0.2 * reach) + Vec3::Y * (0.36 * reach) + side * (0.12 * reach);
    Camera::look_at(eye, camera.eye + level * (0.18 * reach), 50.0, aspect, 0.01 * reach, 4.0 * reach)
}
