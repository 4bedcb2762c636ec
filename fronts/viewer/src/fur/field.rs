//! A field of animals among walls as a scene of casca: all of them or those that can be seen, in
//! pictures that must be the same.

use std::error::Error;
use std::path::Path;

use casca::{Aabb, DrawItem, DrawOptions, Method, Query, View};
use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::records::{Block, DrawList, Stand, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::scenes::animals::Animal;
use casca_fur::scenes::field::{Field, Kind};
use casca_fur::strands::{Forces, hash, unit};
use casca_scenes::world::Camera;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::wgpu::TextureFormat;
use casca_tools::command_line::{Outcome, say};
use glam::Vec3;

use crate::common::Film;
use crate::fur::choices::Choices;
use crate::fur::one::TO_SUN;

/// Kinds of generated animals in a field.
const SPECIES: usize = 4;
/// Layers that cast shadows.
const SHADOW_LAYERS: u32 = 3;
/// The part of the path that pictures are taken from: at its very start one stands outside of the
/// field.
const PATH: (f32, f32) = (0.2, 0.8);
/// Seconds between pictures of a herd that walks.
const STEP: f64 = 0.35;

/// A field and its renderer.
pub struct Stage {
    /// The field.
    pub field: Field,
    pub renderer: Renderer,
    query: Query,
    items: Vec<DrawItem>,
    /// Of each animal, at roots and tips.
    tints: Vec<[[f32; 3]; 2]>,
}

impl Stage {
    /// A field of animals with the fur that is chosen.
    pub fn new(gpu: &Gpu, format: TextureFormat, choices: &Choices) -> Result<Self, Box<dyn Error>> {
        let (count, walks) = (choices.field.unwrap_or(1), choices.walk);
        // One fur for all species: generated animals are about a unit long.
        let look = choices.look(Animal::new(choices.seed, 24)?.radius())?;
        let forces = walks.then(Forces::default);
        let field = Field::new(count as usize, SPECIES, choices.seed, look.fur, forces)?;
        let finest: Vec<_> = field.species().iter().map(|kind| kind.levels()[0].clone()).collect();
        let mut renderer = Renderer::new(gpu, format, &finest, &look)?;
        renderer.haze = 0.012;
        if walks {
            for (i, kind) in field.species().iter().enumerate() {
                renderer.set_weights(gpu, i, &kind.rig().weights[0])?;
            }
        }
        // Each animal a little lighter or darker, and warmer or colder; tips are bleached.
        let tint = |i: usize| {
            let word = hash([i as u32, 17, 4, 1]);
            let (light, b) = (0.8 + 0.4 * unit(word[0]), unit(word[1]));
            [0.85, 1.55].map(|share| [light * share * (0.95 + 0.1 * b), light * share, light * share])
        };
        let tints = (0..field.animals().len()).map(tint).collect();
        Ok(Self { field, renderer, query: Query::new(), items: Vec::new(), tints })
    }

    /// A list of some animals with so many layers, posed if they walk, and of some blocks.
    fn list(&self, animals: &[usize], layers: u32, blocks: Vec<Block>) -> Result<DrawList, FurGpuError> {
        let stand = |&animal: &usize| {
            let ([root, tip], resident) = (self.tints[animal], &self.field.animals()[animal]);
            (Stand { mesh: resident.species, place: resident.placement, root, tip }, layers)
        };
        let mut list = DrawList::new(&animals.iter().map(stand).collect::<Vec<_>>(), blocks);
        for (place, &animal) in animals.iter().enumerate() {
            if let Some(pose) = self.field.pose(animal) {
                list.pose(place, pose)?;
                list.lean(place, self.field.lean(animal))?;
            }
        }
        Ok(list)
    }

    /// What a camera draws with so many layers, near to far: all, or what casca finds visible; and how
    /// many animals that is.
    pub fn look(
        &mut self,
        camera: &Camera,
        culled: bool,
        layers: u32,
    ) -> Result<(DrawList, usize), FurGpuError> {
        // Everything is in sight of an eye that looks everywhere.
        let view = match culled {
            true => View::perspective(camera.eye, camera.view_projection())?,
            false => View::omnidirectional(camera.eye)?,
        };
        self.query.set_method(if culled { Method::point() } else { Method::Frustum })?;
        let pvs = self.query.run(&self.field.scene, &view);
        pvs.draw_list(&self.field.scene, &DrawOptions::default(), &mut self.items)?;
        let (mut blocks, mut animals) = (Vec::new(), Vec::new());
        for item in &self.items {
            match self.field.kind(item.id) {
                Some(Kind::Animal(animal)) => animals.push(animal),
                Some(Kind::Wall(wall)) => blocks.extend(self.field.walls().get(wall).map(|b| block(b, 1))),
                Some(Kind::Ground) => blocks.push(block(&self.field.ground(), 0)),
                None => {}
            }
        }
        Ok((self.list(&animals, layers, blocks)?, animals.len()))
    }

    /// Draws the shadow map for the part of the field before a camera. All animals there cast
    /// shadows, also those that are not drawn: the map must not depend on what the camera sees.
    pub fn cast_shadows(&mut self, gpu: &Gpu, camera: &Camera) -> Result<Sun, Box<dyn Error>> {
        let forward = -camera.view.row(2).truncate();
        let sun = Sun { towards: TO_SUN, center: camera.eye + forward * 9.0, radius: 14.0, shadows: true };
        // The map covers a cylinder around the ball.
        let near = |p: Vec3| p.distance(sun.center) <= 2.0 * sun.radius;
        // Where the space of the mesh has its origin says nothing of posed meshes of files.
        let is_near = |animal: &usize| {
            let bounds = self.field.scene.bounds(self.field.animals()[*animal].id);
            bounds.is_ok_and(|bounds| near(bounds.aabb().center()))
        };
        let animals: Vec<usize> = (0..self.field.animals().len()).filter(is_near).collect();
        let walls = self.field.walls().iter().filter(|w| near(sun.center.clamp(w.min, w.max)));
        let casters = self.list(&animals, SHADOW_LAYERS, walls.map(|w| block(w, 1)).collect())?;
        self.renderer.cast_shadows(gpu, &casters, &sun)?;
        Ok(sun)
    }
}

/// A box to draw.
fn block(aabb: &Aabb, paint: u32) -> Block {
    Block { min: aabb.min.to_array(), paint, max: aabb.max.to_array(), pad: 0 }
}

/// A camera in a field at a share of its path, for pictures so many times as wide as high.
pub fn camera_at(field: &Field, share: f32, aspect: f32) -> Camera {
    let (eye, forward) = field.eye(share);
    let size = field.ground().max - field.ground().min;
    Camera::look_at(eye, eye + forward, 60.0, aspect, 0.05, size.length().max(1.0) + Vec3::ONE.length())
}

/// Draws pictures along the path, and compares those of everything with those of what casca leaves:
/// they must be the same.
pub fn pictures(gpu: &Gpu, choices: &Choices, folder: &Path) -> Result<Outcome, Box<dyn Error>> {
    let film = Film::new(gpu, choices.common.size, true);
    let mut stage = Stage::new(gpu, COLOUR, choices)?;
    let frames = choices.common.frames.unwrap_or(2);
    let mut outcome = Outcome::Well;
    for i in 0..frames {
        if choices.walk {
            stage.field.walk(f64::from(i) * STEP)?;
        }
        let share = PATH.0 + (PATH.1 - PATH.0) * (i as f32 + 0.5) / frames as f32;
        let camera = camera_at(&stage.field, share, film.canvas.aspect());
        let sun = stage.cast_shadows(gpu, &camera)?;
        let mut pictures = Vec::new();
        for culled in [false, true] {
            let (list, animals) = stage.look(&camera, culled, choices.layers)?;
            stage.renderer.draw(gpu, &film.canvas.picture(), &camera, &list, &sun)?;
            pictures.push(film.read(gpu)?);
            let what = if culled { "visible" } else { "all" };
            say(format_args!("frame {i}, {what}: {animals} animals, {} shells", list.shells()));
            if !culled {
                film.save(gpu, &folder.join(format!("field-{i}.png")))?;
            }
        }
        let pairs = pictures[0].chunks(4).zip(pictures[1].chunks(4));
        let differing = pairs.filter(|(a, b)| a != b).count();
        say(format_args!("frame {i}: {differing} pixels differ"));
        if differing > 0 {
            film.save(gpu, &folder.join(format!("field-{i}-differs.png")))?;
            outcome = Outcome::Lost;
        }
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use casca_stage::canvas::Canvas;

    use super::*;
    use crate::common::parsed;

    /// Compares small pictures of what casca leaves with those of everything, and those with fewer
    /// layers, which must show somewhere: else no animal was in any picture.
    fn looks_the_same_when_it_is_culled(walks: bool) {
        let Some(gpu) = Gpu::for_tests() else { return };
        let words = ["--field", "24", "--seed", "5", "--height", "0.1", "--density", "0.4", "--walk"];
        let mut choices: Choices = parsed(&words[..8 + usize::from(walks)]).unwrap();
        (choices.thickness, choices.bend) = (0.03, 0.0);
        let mut stage = Stage::new(&gpu, COLOUR, &choices).unwrap();
        let canvas = Canvas::new(&gpu, (96, 64));
        let (mut saved, mut shown, mut changed) = (0, 0, 0);
        let mut last = Vec::new();
        for frame in 0..6 {
            if walks {
                stage.field.walk(0.17 * f64::from(frame)).unwrap();
            }
            // Twice at each place, so that what differs there is the walk.
            let camera = camera_at(&stage.field, 0.1 + 0.3 * (frame / 2) as f32, canvas.aspect());
            let sun = stage.cast_shadows(&gpu, &camera).unwrap();
            let mut drawn = |culled, layers| {
                let (list, animals) = stage.look(&camera, culled, layers).unwrap();
                let target = canvas.picture();
                stage.renderer.draw(&gpu, &target, &camera, &list, &sun).unwrap();
                (canvas.read_picture(&gpu).unwrap(), animals, list.blocks.len())
            };
            let all = drawn(false, 4);
            let (pixels, animals, _) = drawn(true, 4);
            assert!(all.0 == pixels, "culling changes pixels in frame {frame}");
            shown += usize::from(all.0 != drawn(false, 2).0);
            assert_eq!((all.1, all.2), (24, stage.field.walls().len() + 1));
            saved += 24 - animals;
            changed += usize::from(frame % 2 == 1 && all.0 != last);
            last = all.0;
        }
        println!("{saved} of 144 animals not drawn, {changed} of 3 places in motion");
        assert!(saved > 60 && shown > 0 && (changed > 0) == walks, "{saved} {shown} {changed}");
    }

    #[test]
    fn a_herd_looks_the_same_when_it_is_culled() {
        looks_the_same_when_it_is_culled(false);
        looks_the_same_when_it_is_culled(true);
    }
}
