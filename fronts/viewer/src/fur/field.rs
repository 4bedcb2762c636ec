//! A field of animals among walls: pictures, their comparison, and times by the way of culling.

use std::error::Error;

use crate::fur::herd::{Demand, Herd, Way, camera_at};
use casca_fur::gpu::records::Sun;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::scenes::animals::Animal;
use casca_fur::scenes::field::Field;
use casca_fur::strands::Forces;
use casca_scenes::world::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::timing::{Clock, Instant};
use casca_tools::command_line::{Outcome, say};

use crate::common::Film;
use crate::fur::choices::Choices;
use crate::fur::one::TO_SUN;
use crate::times;

/// Kinds of generated animals in a field.
const SPECIES: usize = 4;
/// Layers that cast shadows.
const SHADOW_LAYERS: u32 = 3;
/// The part of the path that pictures and times are taken from: at its very start one stands
/// outside of the field.
const PATH: (f32, f32) = (0.2, 0.8);
/// Seconds between frames of a herd that is timed.
const FRAME: f64 = 1.0 / 60.0;
/// Seconds between pictures of a herd that walks.
const STEP: f64 = 0.35;
/// Places along the path at which frames are timed, if no other number is given, and frames at each.
const PLACES: u32 = 2;
const RUNS: usize = 3;

/// A field and its renderer.
pub struct Stage {
    pub herd: Herd,
    pub renderer: Renderer,
}

impl Stage {
    /// A field of animals with the fur that is chosen.
    pub fn new(
        gpu: &Gpu,
        format: casca_stage::wgpu::TextureFormat,
        choices: &Choices,
    ) -> Result<Self, Box<dyn Error>> {
        let (count, walks) = (choices.field.unwrap_or(1), choices.walk);
        // One fur for all species: generated animals are about a unit long.
        let look = choices.look(Animal::new(choices.seed, 24)?.radius())?;
        let forces = walks.then(Forces::default);
        let herd = Herd::new(Field::new(count as usize, SPECIES, choices.seed, look.fur, forces)?);
        let mut renderer = Renderer::new(gpu, format, &herd.meshes(), &look)?;
        renderer.haze = 0.012;
        if walks {
            herd.weights().enumerate().try_for_each(|(i, weights)| renderer.set_weights(gpu, i, weights))?;
        }
        Ok(Self { herd, renderer })
    }

    /// Draws the shadow map for the part of the field before a camera. All animals there cast
    /// shadows, also those that are not drawn.
    pub fn cast_shadows(&mut self, gpu: &Gpu, camera: &Camera) -> Result<Sun, Box<dyn Error>> {
        let forward = -camera.view.row(2).truncate();
        let sun = Sun { towards: TO_SUN, center: camera.eye + forward * 9.0, radius: 14.0, shadows: true };
        // The map covers a cylinder around the ball.
        let casters = self.herd.around(sun.center, 2.0 * sun.radius, SHADOW_LAYERS)?;
        self.renderer.cast_shadows(gpu, &casters, &sun)?;
        Ok(sun)
    }
}

fn demand(choices: &Choices, way: Way, height: u32) -> Demand {
    Demand { way, layers: choices.layers, budget: f64::from(choices.budget), height }
}

/// Place `i` of `n` on the path.
fn place(i: usize, n: usize) -> f32 {
    PATH.0 + (PATH.1 - PATH.0) * (i as f32 + 0.5) / n as f32
}

/// Draws pictures along the path, and compares those of everything with those of what the frustum
/// and casca leave: they must be the same.
pub fn pictures(gpu: &Gpu, choices: &Choices) -> Result<Outcome, Box<dyn Error>> {
    let film = Film::new(gpu, choices.common.drawing.size, true);
    let mut stage = Stage::new(gpu, COLOUR, choices)?;
    let frames = choices.common.drawing.frames.unwrap_or(2) as usize;
    let mut outcome = Outcome::Well;
    for i in 0..frames {
        if choices.walk {
            stage.herd.walk(i as f64 * STEP)?;
        }
        let camera = camera_at(&stage.herd.field, place(i, frames), film.canvas.aspect());
        let sun = stage.cast_shadows(gpu, &camera)?;
        let mut everything: Option<Vec<u8>> = None;
        for way in Way::EVERY {
            let drawn = stage.herd.look(&camera, &demand(choices, way, film.canvas.size().1))?;
            stage.renderer.draw(gpu, &film.canvas.picture(), &camera, &drawn.list, &sun)?;
            let pixels = film.read(gpu)?;
            let (name, shells) = (way.name(), drawn.list.shells());
            let head = format!("frame {i}, {name:<8} {:>6} animals, {shells:>7} shells", drawn.animals);
            let Some(want) = &everything else {
                say(head);
                film.save(gpu, &choices.out().join(format!("field-{i}.png")))?;
                everything = Some(pixels);
                continue;
            };
            if way.is_coarser() {
                let pairs = want.iter().zip(&pixels);
                let sum: f64 = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
                // A quarter of the bytes is opacity, which never differs.
                let rmse = (sum / (0.75 * want.len() as f64)).sqrt() / 255.0;
                let over = Some(drawn.excess).filter(|excess| *excess > 0.0);
                let over = over.map_or(String::new(), |excess| format!(", {excess:.0} above the budget"));
                say(format_args!("{head}{over}, RMSE {rmse:.4} from the picture of everything"));
                film.save(gpu, &choices.out().join(format!("field-{i}-{name}.png")))?;
                continue;
            }
            let differing = want.chunks(4).zip(pixels.chunks(4)).filter(|(a, b)| a != b).count();
            say(format_args!("{head}, {differing} pixels differ from the picture of everything"));
            if differing > 0 {
                film.save(gpu, &choices.out().join(format!("field-{i}-{name}-differs.png")))?;
                outcome = Outcome::Lost;
            }
        }
    }
    Ok(outcome)
}

/// Prints the time of frames along the path by the way of culling. The shadow map is drawn before.
pub fn time(gpu: &Gpu, choices: &Choices) -> Result<(), Box<dyn Error>> {
    let canvas = Canvas::new(gpu, choices.common.drawing.size);
    let mut stage = Stage::new(gpu, COLOUR, choices)?;
    let places = choices.common.drawing.frames.unwrap_or(PLACES) as usize;
    let mut frames = Way::EVERY.map(|way| (way.name(), Vec::new()));
    let (mut seconds, mut totals) = (0.0, [(0, 0); Way::EVERY.len()]);
    for i in 0..places {
        let camera = camera_at(&stage.herd.field, place(i, places), canvas.aspect());
        let sun = stage.cast_shadows(gpu, &camera)?;
        for ((way, (_, frames)), total) in Way::EVERY.into_iter().zip(&mut frames).zip(&mut totals) {
            let demand = demand(choices, way, canvas.size().1);
            // The first frame makes buffers, and is not counted.
            for run in 0..=RUNS {
                seconds += FRAME;
                gpu.wait()?;
                let (mut clock, start) = (Clock::on(), Instant::now());
                if choices.walk {
                    stage.herd.walk(seconds)?;
                }
                let drawn = stage.herd.look(&camera, &demand)?;
                clock.add("find", start.elapsed());
                let start = Instant::now();
                stage.renderer.draw(gpu, &canvas.picture(), &camera, &drawn.list, &sun)?;
                gpu.wait()?;
                clock.add("draw", start.elapsed());
                if run > 0 {
                    frames.push(clock.stages().to_vec());
                    *total = (total.0 + drawn.animals, total.1 + drawn.vertices as usize);
                }
            }
        }
    }
    let (width, height) = canvas.size();
    say(format_args!(
        "{} animals, {width}x{height}, {} layers, on {}; medians of {RUNS} frames at {places} places",
        stage.herd.field.animals().len(),
        choices.layers,
        gpu.name
    ));
    times::table(&frames);
    for ((name, _), (animals, vertices)) in frames.iter().zip(totals) {
        let runs = (RUNS * places).max(1);
        say(format_args!("{name:<9} {:>8} animals drawn, {:>10} vertices", animals / runs, vertices / runs));
    }
    Ok(())
}
