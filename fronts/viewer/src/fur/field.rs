//! A field of animals among walls: pictures and their comparison.

use std::error::Error;
use std::path::Path;

use crate::fur::herd::{Demand, Herd, Way, camera_at};
use casca_fur::gpu::records::Sun;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::scenes::Species;
use casca_fur::scenes::animals::Animal;
use casca_fur::scenes::field::{Field, generated};
use casca_fur::strands::Forces;
use casca_scenes::world::Camera;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::command_line::{Outcome, say};

use crate::common::Film;
use crate::fur::choices::{Choices, Subject};
use crate::fur::one::TO_SUN;

/// Kinds of generated animals in a field.
const SPECIES: usize = 4;
/// Layers that cast shadows.
const SHADOW_LAYERS: u32 = 3;
/// The part of the path that pictures are taken from: at its very start one stands
/// outside of the field.
const PATH: (f32, f32) = (0.2, 0.8);
/// Seconds between pictures of a herd that walks.
const STEP: f64 = 0.35;

/// A field and its renderer.
pub struct Stage {
    pub herd: Herd,
    pub renderer: Renderer,
}

impl Stage {
    /// A field of animals with the fur that is chosen: of the subject's species, or generated.
    pub fn new(
        gpu: &Gpu,
        format: casca_stage::wgpu::TextureFormat,
        choices: &Choices,
        subject: &Subject,
    ) -> Result<Self, Box<dyn Error>> {
        let (count, walks) = (choices.field.unwrap_or(1), choices.walk);
        // One fur for all species: generated animals are about a unit long.
        let radius = match &subject.species {
            Some(species) => species.radius(),
            None => Animal::new(choices.seed, 24)?.radius(),
        };
        let look = choices.look(radius)?;
        let species = match &subject.species {
            Some(own) => vec![(Species::clone(own), look.fur)],
            None => generated(SPECIES, choices.seed, |_| Ok(look.fur))?,
        };
        let field = Field::new(count as usize, species, choices.seed, walks.then(Forces::default))?;
        let herd = Herd::new(field)?;
        let mut renderer = Renderer::new(gpu, format, &herd.meshes(), &look)?;
        renderer.haze = 0.012;
        if walks {
            herd.weights().enumerate().try_for_each(|(i, weights)| renderer.set_weights(gpu, i, weights))?;
        }
        for (meshes, images) in herd.images() {
            renderer.set_images(gpu, &meshes, images)?;
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

/// Draws pictures along the path, and compares those of everything with those of what casca leaves:
/// they must be the same.
pub fn pictures(
    gpu: &Gpu,
    choices: &Choices,
    subject: &Subject,
    folder: &Path,
) -> Result<Outcome, Box<dyn Error>> {
    let film = Film::new(gpu, choices.common.size, true);
    let mut stage = Stage::new(gpu, COLOUR, choices, subject)?;
    let frames = choices.common.frames.unwrap_or(2) as usize;
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
                film.save(gpu, &folder.join(format!("field-{i}.png")))?;
                everything = Some(pixels);
                continue;
            };
            if way == Way::Layered {
                let pairs = want.iter().zip(&pixels);
                let sum: f64 = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
                // A quarter of the bytes is opacity, which never differs.
                let rmse = (sum / (0.75 * want.len() as f64)).sqrt() / 255.0;
                say(format_args!("{head}, RMSE {rmse:.4} from the picture of everything"));
                film.save(gpu, &folder.join(format!("field-{i}-{name}.png")))?;
                continue;
            }
            let differing = want.chunks(4).zip(pixels.chunks(4)).filter(|(a, b)| a != b).count();
            say(format_args!("{head}, {differing} pixels differ from the picture of everything"));
            if differing > 0 {
                film.save(gpu, &folder.join(format!("field-{i}-{name}-differs.png")))?;
                outcome = Outcome::Lost;
            }
        }
    }
    Ok(outcome)
}
