use casca_fur::gpu::look::Look;
use casca_fur::gpu::records::Sun;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::scenes::animals::LEVELS;
use casca_fur::scenes::field::Field;
use casca_fur::strands::{Forces, Fur};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use glam::Vec3;

use super::{Demand, Herd, Way, camera_at};

const TO_SUN: Vec3 = Vec3::new(0.6, 0.64, 0.48);

/// A herd among walls, drawn in small pictures.
struct Shown {
    herd: Herd,
    renderer: Renderer,
    gpu: Gpu,
    canvas: Canvas,
}

impl Shown {
    /// A herd of generated animals, which may walk.
    fn new(walks: bool) -> Option<Self> {
        let gpu = Gpu::for_tests()?;
        let look = Look::new(Fur { spacing: 0.02, ..Fur::for_radius(0.6, 0.1, 0.4).unwrap() });
        let herd = Herd::new(Field::new(24, 1, 5, look.fur, walks.then(Forces::default)).unwrap());
        let mut renderer = Renderer::new(&gpu, COLOUR, &herd.meshes(), &look).unwrap();
        if walks {
            for (i, weights) in herd.weights().enumerate() {
                renderer.set_weights(&gpu, i, weights).unwrap();
            }
        }
        let canvas = Canvas::new(&gpu, (96, 64));
        Some(Self { herd, renderer, gpu, canvas })
    }

    /// All levels of detail of its animals are drawn somewhere along the path.
    fn draws_all_levels_of_detail(&mut self) {
        let mut levels = [0; LEVELS];
        for place in 0..5 {
            let camera = camera_at(&self.herd.field, 0.2 * place as f32, 1.5);
            let demand = Demand { way: Way::Levels, layers: 4, budget: 1.0, height: 160 };
            self.herd.look(&camera, &demand).unwrap();
            let (planned, _) = self.herd.planned(&self.herd.items, &camera, &demand).unwrap();
            planned.iter().for_each(|(_, level, _)| levels[*level] += 1);
        }
        assert!(levels.iter().all(|count| *count > 0), "{levels:?}");
    }

    /// Compares pictures of what the frustum and casca leave with those of everything, and those with
    /// fewer layers, which must show somewhere: else no animal was in any picture.
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
                } else if way.is_coarser() {
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
        println!("{saved} of 288 animals not drawn, {changed} of 3 places in motion");
        assert!(saved > 60 && shown > 0 && (changed > 0) == walks, "{saved} {shown} {changed}");
    }
}

#[test]
fn a_herd_looks_the_same_when_it_is_culled() {
    for walks in [false, true] {
        let Some(mut shown) = Shown::new(walks) else { return };
        shown.draws_all_levels_of_detail();
        shown.looks_the_same_when_it_is_culled(walks);
    }
}
