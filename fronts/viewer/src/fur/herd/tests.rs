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
fn species_with_different_furs_are_refused() {
    let species = generated(3, 5, |radius| Fur::for_radius(radius, 0.1, 0.4)).unwrap();
    let field = Field::new(12, species, 5, None).unwrap();
    assert!(matches!(Herd::new(field), Err(FurGpuError::Furs)));
}

/// A herd among walls, drawn in small pictures.
struct Shown {
    herd: Herd,
    renderer: Renderer,
    gpu: Gpu,
    canvas: Canvas,
}

impl Shown {
    /// A herd of generated animals, or of the character of a file, which may walk.
    fn new(own: Option<(Species, Fur)>, walks: bool) -> Option<Self> {
        let gpu = Gpu::for_tests()?;
        let fur = Fur { spacing: 0.02, ..Fur::for_radius(0.6, 0.1, 0.4).unwrap() };
        let species = own.map_or_else(|| generated(1, 5, |_| Ok(fur)).unwrap(), |own| vec![own]);
        let look = Look::new(species[0].1);
        let herd = Herd::new(Field::new(24, species, 5, walks.then(Forces::default)).unwrap()).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, &herd.meshes(), &look).unwrap();
        if walks {
            for (i, weights) in herd.weights().enumerate() {
                renderer.set_weights(&gpu, i, weights).unwrap();
            }
        }
        for (meshes, images) in herd.images() {
            renderer.set_images(&gpu, &meshes, images).unwrap();
        }
        let canvas = Canvas::new(&gpu, (96, 64));
        Some(Self { herd, renderer, gpu, canvas })
    }

    /// Compares pictures of what casca leaves with those of everything, and those with fewer layers,
    /// which must show somewhere: else no animal was in any picture.
    fn looks_the_same_when_it_is_culled(mut self, walks: bool) {
        let (mut saved, mut shown, mut changed) = (0, 0, 0);
        let mut last = Vec::new();
        for frame in 0..6 {
            if walks {
                self.herd.walk(0.17 * f64::from(frame)).unwrap();
            }
            // Twice at each place, so that what differs there is the walk.
            let camera = camera_at(&self.herd.field, 0.1 + 0.3 * (frame / 2) as f32, self.canvas.aspect());
            let sun = Sun { towards: TO_SUN, center: camera.eye, radius: 12.0, shadows: true };
            let mut want = (Vec::new(), 0);
            for way in Way::EVERY {
                let demand = Demand { way, layers: 4, budget: 0.5, height: 64 };
                let drawn = self.herd.look(&camera, &demand).unwrap();
                if way == Way::All {
                    self.renderer.cast_shadows(&self.gpu, &drawn.list, &sun).unwrap();
                    let blocks = self.herd.field.walls().len() + 1;
                    assert_eq!((drawn.animals, drawn.list.blocks.len()), (24, blocks));
                }
                let target = self.canvas.picture();
                self.renderer.draw(&self.gpu, &target, &camera, &drawn.list, &sun).unwrap();
                let pixels = self.canvas.read_picture(&self.gpu).unwrap();
                if way == Way::All {
                    want = (pixels, drawn.list.shells());
                } else if way == Way::Layered {
                    assert!(drawn.list.shells() < want.1);
                    shown += usize::from(want.0 != pixels);
                } else {
                    assert!(want.0 == pixels, "{way:?} changes pixels in frame {frame}");
                    saved += 24 - drawn.animals;
                }
            }
            changed += usize::from(frame % 2 == 1 && want.0 != last);
            last = want.0;
        }
        println!("{saved} of 144 animals not drawn, {changed} of 3 places in motion");
        assert!(saved > 60 && shown > 0 && (changed > 0) == walks, "{saved} {shown} {changed}");
    }
}

#[test]
fn a_herd_looks_the_same_when_it_is_culled() {
    for walks in [false, true] {
        let Some(shown) = Shown::new(None, walks) else { return };
        shown.looks_the_same_when_it_is_culled(walks);
    }
}

#[test]
fn a_walking_herd_of_a_file_looks_the_same_when_it_is_culled() {
    let file = character_glb(12, 40).unwrap();
    let character = Character::new(&read_coated(&file, None).unwrap(), &[], 3).unwrap();
    let species = Species::of_character(&character).unwrap();
    assert_eq!((species.levels().len(), species.images().len()), (3, 1));
    let radius = species.radius();
    let fur = Fur { spacing: 0.03 * radius, ..Fur::for_radius(radius, 0.1, 0.4).unwrap() };
    let Some(mut shown) = Shown::new(Some((species, fur)), true) else { return };
    // All of its levels of detail are drawn.
    let mut levels = [0; 3];
    for place in 0..5 {
        let camera = camera_at(&shown.herd.field, 0.2 * place as f32, 1.5);
        let demand = Demand { way: Way::Layered, layers: 4, budget: 1.0, height: 160 };
        shown.herd.look(&camera, &demand).unwrap();
        let planned = shown.herd.planned(&shown.herd.items, &camera, &demand).unwrap();
        planned.iter().for_each(|(_, level, _)| levels[*level] += 1);
    }
    assert!(levels.iter().all(|count| *count > 0), "{levels:?}");
    shown.looks_the_same_when_it_is_culled(true);
}
