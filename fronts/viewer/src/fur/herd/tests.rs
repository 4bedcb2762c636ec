use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::look::Look;
use casca_fur::gpu::records::Sun;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::scenes::field::{Field, generated};
use casca_fur::scenes::import::read_coated;
use casca_fur::scenes::sample::character_glb;
use casca_fur::scenes::{Character, Species};
use casca_fur::strands::{Forces, Fur};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use glam::Vec3;

use super::{Demand, Herd, Way, camera_at};

const TO_SUN: Vec3 = Vec3::new(0.6, 0.64, 0.48);

#[test]
fn pictures_of_what_can_be_seen_are_those_of_everything() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let fur = Fur { spacing: 0.02, ..Fur::for_radius(0.6, 0.1, 0.4).unwrap() };
    let field = Field::new(24, generated(1, 5, |_| Ok(fur)).unwrap(), 5, None).unwrap();
    let mut herd = Herd::new(field).unwrap();
    let mut renderer = Renderer::new(&gpu, COLOUR, &herd.meshes(), &Look::new(fur)).unwrap();
    let canvas = Canvas::new(&gpu, (96, 64));
    let (mut saved, mut shown) = (0, 0);
    for i in 0..5 {
        let camera = camera_at(&herd.field, 0.1 + 0.2 * i as f32, canvas.aspect());
        let sun = Sun { towards: TO_SUN, center: camera.eye, radius: 12.0, shadows: true };
        let mut want: Option<(Vec<u8>, usize)> = None;
        for way in Way::EVERY {
            let demand = Demand { way, layers: 4, budget: 0.5, height: 64 };
            let drawn = herd.look(&camera, &demand).unwrap();
            if way == Way::All {
                renderer.cast_shadows(&gpu, &drawn.list, &sun).unwrap();
                assert_eq!((drawn.animals, drawn.list.blocks.len()), (24, herd.field.walls().len() + 1));
            }
            renderer.draw(&gpu, &canvas.picture(), &camera, &drawn.list, &sun).unwrap();
            let pixels = canvas.read_picture(&gpu).unwrap();
            match &want {
                None => want = Some((pixels, drawn.list.shells())),
                Some((all, shells)) if way.is_coarser() => {
                    assert!(drawn.list.shells() < *shells);
                    shown += usize::from(*all != pixels);
                }
                Some((all, _)) => {
                    assert!(*all == pixels, "{way:?} changes pixels at place {i}");
                    saved += 24 - drawn.animals;
                }
            }
        }
    }
    assert!(saved > 60, "{saved}");
    assert!(shown > 0, "fewer layers must show somewhere: else no animal was in any picture");
}

#[test]
fn species_with_different_furs_are_refused() {
    let species = generated(3, 5, |radius| Fur::for_radius(radius, 0.1, 0.4)).unwrap();
    let field = Field::new(12, species, 5, None).unwrap();
    assert!(matches!(Herd::new(field), Err(FurGpuError::Furs)));
}

/// A herd that walks among walls, drawn in small pictures.
struct Walkers {
    herd: Herd,
    renderer: Renderer,
    gpu: Gpu,
    canvas: Canvas,
}

impl Walkers {
    /// A herd of generated animals, or of the character of a file.
    fn new(count: usize, seed: u64, own: Option<(Species, Fur)>) -> Option<Self> {
        let gpu = Gpu::for_tests()?;
        let (species, fur) = match own {
            Some((species, fur)) => (vec![(species, fur)], fur),
            None => {
                let fur = Fur { spacing: 0.02, ..Fur::for_radius(0.6, 0.1, 0.4).unwrap() };
                (generated(1, seed, |_| Ok(fur)).unwrap(), fur)
            }
        };
        let field = Field::new(count, species, seed, Some(Forces::default())).unwrap();
        let herd = Herd::new(field).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, &herd.meshes(), &Look::new(fur)).unwrap();
        for (i, weights) in herd.weights().enumerate() {
            renderer.set_weights(&gpu, i, weights).unwrap();
        }
        for (meshes, images) in herd.images() {
            renderer.set_images(&gpu, &meshes, images).unwrap();
        }
        let canvas = Canvas::new(&gpu, (96, 64));
        Some(Self { herd, renderer, gpu, canvas })
    }

    /// The picture by a way, and how many animals it draws.
    fn shoot(&mut self, share: f32, way: Way) -> (Vec<u8>, usize) {
        let camera = camera_at(&self.herd.field, share, self.canvas.aspect());
        let sun = Sun { towards: TO_SUN, center: camera.eye, radius: 12.0, shadows: true };
        let drawn = self.herd.look(&camera, &Demand { way, layers: 4, budget: 1.0, height: 64 }).unwrap();
        if way == Way::All {
            self.renderer.cast_shadows(&self.gpu, &drawn.list, &sun).unwrap();
        }
        self.renderer.draw(&self.gpu, &self.canvas.picture(), &camera, &drawn.list, &sun).unwrap();
        (self.canvas.read_picture(&self.gpu).unwrap(), drawn.animals)
    }
}

#[test]
fn a_walking_herd_looks_the_same_when_it_is_culled() {
    let Some(walkers) = Walkers::new(24, 5, None) else { return };
    looks_the_same_when_it_is_culled(walkers);
}

#[test]
fn a_walking_herd_of_a_file_looks_the_same_when_it_is_culled() {
    let file = character_glb(12, 40).unwrap();
    let character = Character::new(&read_coated(&file, None).unwrap(), &[], 3).unwrap();
    let species = Species::of_character(&character).unwrap();
    assert_eq!((species.levels().len(), species.images().len()), (3, 1));
    let radius = species.radius();
    let fur = Fur { spacing: 0.03 * radius, ..Fur::for_radius(radius, 0.1, 0.4).unwrap() };
    let Some(mut walkers) = Walkers::new(24, 5, Some((species, fur))) else { return };
    // All of its levels of detail are drawn.
    let mut levels = [0; 3];
    for place in 0..5 {
        let camera = camera_at(&walkers.herd.field, 0.2 * place as f32, 1.5);
        let demand = Demand { way: Way::Levels, layers: 4, budget: 0.5, height: 160 };
        walkers.herd.look(&camera, &demand).unwrap();
        let (planned, _) = walkers.herd.planned(&walkers.herd.items, &camera, &demand).unwrap();
        planned.iter().for_each(|(_, level, _)| levels[*level] += 1);
    }
    assert!(levels.iter().all(|count| *count > 0), "{levels:?}");
    looks_the_same_when_it_is_culled(walkers);
}

fn looks_the_same_when_it_is_culled(mut walkers: Walkers) {
    let (mut saved, mut changed) = (0, 0);
    let mut last = Vec::new();
    for frame in 0..6 {
        walkers.herd.walk(0.17 * f64::from(frame)).unwrap();
        // Twice at each place, so that what differs there is the walk.
        let share = 0.1 + 0.3 * (frame / 2) as f32;
        let (all, _) = walkers.shoot(share, Way::All);
        for way in [Way::Frustum, Way::Visible] {
            let (pixels, animals) = walkers.shoot(share, way);
            assert!(pixels == all, "{way:?} changes pixels in frame {frame}");
            saved += 24 - animals;
        }
        changed += usize::from(frame % 2 == 1 && all != last);
        last = all;
    }
    println!("{saved} of 288 animals not drawn, {changed} of 3 places in motion");
    assert!(saved > 60 && changed > 0, "{saved} {changed}");
}
