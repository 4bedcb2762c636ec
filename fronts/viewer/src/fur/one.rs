//! One furry object: its picture, and its time by layers.

use std::error::Error;
use std::f32::consts::PI;

use crate::fur::fit::fit;
use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::records::Block;
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::visibility::{level_for, pixels_of};
use casca_scenes::world::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::wgpu::TextureFormat;
use casca_tools::command_line::say;
use casca_tools::image::write_png;
use glam::{Affine3A, Vec3};

use crate::fur::choices::{Choices, Subject};
use crate::fur::shots::{Shooter, sheet};

/// Numbers of layers whose times are fitted by a line.
const TIMED: [u32; 6] = [4, 8, 16, 24, 32, 48];
/// Frames of which the quickest counts.
const RUNS: usize = 5;

/// Seconds between pictures of what walks.
const STEP: f64 = 0.25;

/// The direction towards the sun.
pub const TO_SUN: Vec3 = Vec3::new(0.45, 0.75, 0.5);

/// Colours that multiply those of the mesh, at roots and tips: tips of real fur are bleached.
pub const ROOT: [f32; 3] = [0.85, 0.82, 0.8];
pub const TIP: [f32; 3] = [1.6, 1.57, 1.55];
/// Heights and densities: short and long, sparse and dense.
const COATS: [(f32, f32); 4] = [(0.03, 0.12), (0.03, 0.6), (0.13, 0.12), (0.13, 0.6)];
/// The haze of a way of one radius.
pub const HAZE: f32 = 0.008;

/// The sun over an object of a radius.
pub fn sun(radius: f32, shadows: bool) -> Sun {
    Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 1.6 * radius, shadows }
}

/// Looks at an object from before, from its side and from above.
pub fn camera(radius: f32, aspect: f32) -> Camera {
    let eye = Vec3::new(1.25, 0.42, 1.5) * radius * 0.9;
    Camera::look_at(eye, Vec3::new(0.05, -0.02, 0.0) * radius, 50.0, aspect, 0.05 * radius, 40.0 * radius)
}

/// The object where it is modelled, over a ground if it stands on one.
pub fn list(subject: &Subject, layers: u32, ground: bool) -> DrawList {
    level_list(subject, 0, layers, ground)
}

/// The same for a level of detail; the coarsest if there is none of this number.
pub fn level_list(subject: &Subject, level: u32, layers: u32, ground: bool) -> DrawList {
    let mesh = (level as usize).min(subject.levels.len() - 1);
    let place = subject.walker.as_ref().map_or(Affine3A::IDENTITY, |walker| walker.place());
    let stand = Stand { mesh, place, root: ROOT, tip: TIP };
    let mut list = DrawList::new(&[(stand, layers)], Vec::new());
    if let Some(walker) = &subject.walker {
        // It has the animal that is posed.
        walker.pose(&mut list, 0.0).ok();
    }
    let (low, r) = (subject.low, subject.radius);
    let block =
        Block { min: [-30.0 * r, low - r, -30.0 * r], paint: 0, max: [30.0 * r, low, 30.0 * r], pad: 0 };
    list.blocks.extend(ground.then_some(block));
    list
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
    let all: Vec<usize> = (0..subject.levels.len()).collect();
    renderer.set_images(gpu, &all, &subject.images)?;
    for level in all {
        if let Some(walker) = &subject.walker {
            renderer.set_weights(gpu, level, &walker.weights[level])?;
        }
    }
    Ok(renderer)
}

/// The object alone, with colours at roots and tips.
pub fn tinted(layers: u32, (root, tip): ([f32; 3], [f32; 3])) -> DrawList {
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root, tip };
    DrawList::new(&[(stand, layers)], Vec::new())
}

/// Draws the object into a file.
pub fn pictures(gpu: &Gpu, choices: &Choices, subject: &Subject) -> Result<(), Box<dyn Error>> {
    let shooter = Shooter::new(gpu, choices.common.drawing.size, choices.smooth);
    let mut renderer = renderer(gpu, COLOUR, choices, subject)?;
    let camera = camera(subject.radius, shooter.aspect());
    let sun = sun(subject.radius, true);
    let frames = subject.walker.as_ref().map_or(1, |_| choices.common.drawing.frames.unwrap_or(2));
    for frame in 0..frames {
        let mut list = level_list(subject, choices.level.unwrap_or(0), choices.layers, true);
        let name = match &subject.walker {
            None => format!("{}.png", subject.name),
            Some(walker) => {
                walker.pose(&mut list, 0.1 + STEP * f64::from(frame))?;
                format!("{}-walk-{frame}.png", subject.name)
            }
        };
        renderer.cast_shadows(gpu, &list, &sun)?;
        let picture = shooter.shoot(&mut renderer, &camera, &list, &sun)?;
        let path = choices.out().join(name);
        write_png(&path, picture.size, &picture.pixels)?;
        say(path.display());
    }
    let mesh = &subject.levels[(choices.level.unwrap_or(0) as usize).min(subject.levels.len() - 1)];
    say(format_args!(
        "{} triangles, {} vertices, {} layers",
        mesh.triangles().len(),
        mesh.vertices().len(),
        choices.layers
    ));
    Ok(())
}

/// Draws short and long fur, sparse and dense, into one file.
pub fn coats(gpu: &Gpu, choices: &Choices, subject: &Subject) -> Result<(), Box<dyn Error>> {
    let shooter = Shooter::new(
        gpu,
        (choices.common.drawing.size.0 / 2, choices.common.drawing.size.1 / 2),
        choices.smooth,
    );
    let mut renderer = renderer(gpu, COLOUR, choices, subject)?;
    let camera = camera(subject.radius, shooter.aspect());
    let list = list(subject, choices.layers, true);
    let sun = sun(subject.radius, true);
    let mut pictures = Vec::new();
    for (height, density) in COATS {
        let look = Choices { height, density, ..choices.clone() }.look(subject.radius)?;
        renderer.set_look(gpu, &look);
        renderer.cast_shadows(gpu, &list, &sun)?;
        pictures.push(shooter.shoot(&mut renderer, &camera, &list, &sun)?);
    }
    let path = choices.out().join(format!("{}-coats.png", subject.name));
    let all = sheet(&pictures, 2);
    write_png(&path, all.size, &all.pixels)?;
    say(path.display());
    Ok(())
}

/// Prints the time of a frame by layers, and the line through it.
pub fn time(gpu: &Gpu, choices: &Choices, subject: &Subject) -> Result<(), Box<dyn Error>> {
    let shooter = Shooter::new(gpu, choices.common.drawing.size, 0);
    let mut renderer = renderer(gpu, COLOUR, choices, subject)?;
    let camera = camera(subject.radius, shooter.aspect());
    let sun = sun(subject.radius, false);
    let lists = TIMED.map(|layers| list(subject, layers, true));
    let mut points = TIMED.map(|layers| (f64::from(layers), f64::INFINITY));
    // In turns, so that what else the machine does slows all alike.
    for _ in 0..RUNS {
        for (list, (_, ms)) in lists.iter().zip(&mut points) {
            let draw =
                &mut |canvas: &Canvas| Ok(renderer.draw(gpu, &canvas.picture(), &camera, list, &sun)?);
            *ms = ms.min(shooter.time(draw)?);
        }
    }
    let (w, h) = choices.common.drawing.size;
    say(format_args!("{}, {w}x{h}, the quickest of {RUNS} frames\nlayers    ms", subject.name));
    points.iter().for_each(|(layers, ms)| say(format_args!("{layers:>6} {ms:>7.2}")));
    if let Some(line) = fit(&points) {
        say(format_args!("ms = {:.2} + {:.3} layers, r^2 = {:.4}", line.base, line.slope, line.r2));
    }
    Ok(())
}
