//! A field of animals as a scene of casca, and the list of animals to draw: all of them, those in
//! the frustum, those that can be seen, or those that can be seen with fewer layers where less is
//! seen.

use casca::{Aabb, DrawItem, DrawOptions, Method, Query, Sight, View};
use casca_fur::mesh::Mesh;
use casca_fur::scenes::field::{Field, Kind};
use casca_fur::skin::Weights;
use casca_fur::visibility::{PlanOptions, Share, Sight as Seen, plan_sights};
use casca_scenes::world::Camera;
use glam::Vec3;

#[cfg(test)]
mod tests;

use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::records::{Block, DrawList, Stand};

/// Columns of an animal's box, each way, of which it is asked whether they are seen.
const COLUMNS: u32 = 4;

/// How the animals to draw are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Everything.
    All,
    /// What may be in the frustum.
    Frustum,
    /// The same, with level of detail and layers by projected size, within a budget: what games do
    /// without casca.
    Levels,
    /// What casca finds visible.
    Visible,
    /// The same, with level of detail and layers by projected size and by the share that is seen,
    /// within a budget.
    Layered,
}

impl Way {
    /// All ways.
    pub const EVERY: [Self; 5] = [Self::All, Self::Frustum, Self::Levels, Self::Visible, Self::Layered];

    /// Whether it draws fewer layers than everything, so that its pictures are not the same.
    pub fn is_coarser(self) -> bool {
        matches!(self, Self::Levels | Self::Layered)
    }

    /// Its name on command lines.
    pub fn name(self) -> &'static str {
        ["all", "frustum", "levels", "visible", "layered"][self as usize]
    }
}

/// What is drawn of a field.
pub struct Herd {
    /// The field.
    pub field: Field,
    /// By species, the number of its finest mesh.
    firsts: Vec<usize>,
    query: Query,
    items: Vec<DrawItem>,
    tints: Vec<[[f32; 3]; 2]>,
}

/// What a frame needs besides the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand {
    /// The way.
    pub way: Way,
    /// Layers above the skin: of all animals, or the most by [`Way::Levels`] and
    /// [`Way::Layered`].
    pub layers: u32,
    /// For [`Way::Levels`] and [`Way::Layered`]: the budget, as a share of the weight that it would
    /// draw without one. 1 or more sets no budget.
    pub budget: f64,
    /// The height of the picture in pixels.
    pub height: u32,
}

/// An animal that is drawn: its number, its level of detail, its layers.
type Chosen = (usize, usize, u32);

/// A list of what to draw, and how much it is.
#[derive(Debug, Clone, Default)]
pub struct Drawn {
    /// The list.
    pub list: DrawList,
    /// How many animals it holds.
    pub animals: usize,
    /// By how much the skins alone exceed the budget, in weight; they are drawn all the same.
    pub excess: f64,
    /// Vertices of all skins and layers.
    pub vertices: u64,
}

impl Herd {
    /// The animals of a field, which stands still or [walks](Field::walk).
    pub fn new(field: Field) -> Self {
        // Each animal a little lighter or darker, and warmer or colder.
        let tint = |i: usize| {
            let word = casca_fur::strands::hash([i as u32, 17, 4, 1]);
            let [a, b] = [word[0], word[1]].map(casca_fur::strands::unit);
            let light = 0.8 + 0.4 * a;
            // Tips are bleached.
            [0.85, 1.55].map(|share| [light * share * (0.95 + 0.1 * b), light * share, light * share])
        };
        let sizes = field.species().iter().map(|kind| kind.levels().len());
        let firsts = sizes.scan(0, |next, size| Some(std::mem::replace(next, *next + size))).collect();
        let tints = (0..field.animals().len()).map(tint).collect();
        Self { field, firsts, query: Query::new(), items: Vec::new(), tints }
    }

    /// The meshes of all species and levels of detail, as [`Stand::mesh`] numbers them.
    pub fn meshes(&self) -> Vec<Mesh> {
        self.field.species().iter().flat_map(|kind| kind.levels().iter().cloned()).collect()
    }

    /// Moves the animals to where they are at a time in seconds.
    ///
    /// # Errors
    /// As [`Field::walk`].
    pub fn walk(&mut self, time: f64) -> Result<(), FurGpuError> {
        Ok(self.field.walk(time)?)
    }

    /// All animals and walls within a distance of a point, with so many layers: for shadow maps,
    /// which must not depend on what the camera sees.
    ///
    /// # Errors
    /// None for lists of its own animals.
    pub fn around(&self, center: Vec3, reach: f32, layers: u32) -> Result<DrawList, FurGpuError> {
        let near = |p: Vec3| p.distance(center) <= reach;
        let animals = (0..self.field.animals().len())
            .filter(|&i| self.is_near(i, center, reach))
            .map(|i| (self.stand(i, 0), layers));
        let animals: Vec<(Stand, u32)> = animals.collect();
        let walls = self.field.walls().iter().filter(|w| near(center.clamp(w.min, w.max)));
        let list = DrawList::new(&animals, walls.map(|w| block(w, 1)).collect());
        self.posed(list, (0..self.field.animals().len()).filter(|&i| self.is_near(i, center, reach)))
    }

    /// Poses the animals of a list, which are in its order.
    fn posed(
        &self,
        mut list: DrawList,
        animals: impl Iterator<Item = usize>,
    ) -> Result<DrawList, FurGpuError> {
        for (place, animal) in animals.enumerate() {
            if let Some(pose) = self.field.pose(animal) {
                list.pose(place, pose)?;
                list.lean(place, self.field.lean(animal))?;
            }
        }
        Ok(list)
    }

    fn is_near(&self, animal: usize, center: Vec3, reach: f32) -> bool {
        let bounds = self.field.scene.bounds(self.field.animals()[animal].id);
        bounds.is_ok_and(|bounds| bounds.aabb().center().distance(center) <= reach)
    }

    /// The weights of all meshes, in the order of [`Herd::meshes`], for herds that walk.
    pub fn weights(&self) -> impl Iterator<Item = &Weights> {
        self.field.species().iter().flat_map(|kind| &kind.rig().weights)
    }

    /// Where an animal stands, with a level of detail.
    fn stand(&self, animal: usize, level: usize) -> Stand {
        let resident = &self.field.animals()[animal];
        let [root, tip] = self.tints[animal];
        Stand { mesh: self.firsts[resident.species] + level, place: resident.placement, root, tip }
    }

    /// What a camera draws, near to far.
    ///
    /// # Errors
    /// The camera is refused: a matrix that is not finite, for example.
    pub fn look(&mut self, camera: &Camera, demand: &Demand) -> Result<Drawn, FurGpuError> {
        let view = match demand.way {
            // Everything is in sight of an eye that looks everywhere.
            Way::All => View::omnidirectional(camera.eye)?,
            _ => View::perspective(camera.eye, camera.view_projection())?,
        };
        let culled = matches!(demand.way, Way::Visible | Way::Layered);
        self.query.set_method(if culled { Method::point() } else { Method::Frustum })?;
        let pvs = self.query.run(&self.field.scene, &view);
        pvs.draw_list(&self.field.scene, &DrawOptions::default(), &mut self.items)?;
        let mut blocks = Vec::new();
        let mut seen = Vec::new();
        for &item in &self.items {
            match self.field.kind(item.id) {
                Some(Kind::Animal(animal)) => seen.push((animal, item)),
                Some(Kind::Wall(wall)) => blocks.extend(self.field.walls().get(wall).map(|b| block(b, 1))),
                Some(Kind::Ground) => blocks.push(block(&self.field.ground(), 0)),
                None => {}
            }
        }
        let mut excess = 0.0;
        let chosen: Vec<Chosen> = match demand.way {
            way if way.is_coarser() => {
                let mut items: Vec<DrawItem> = seen.iter().map(|(_, item)| *item).collect();
                if let Some(sight) = self.query.sight(&self.field.scene).filter(|_| culled) {
                    for item in &mut items {
                        item.fraction =
                            share_seen(&sight, &self.field.scene.bounds(item.id)?.aabb(), camera.eye);
                    }
                }
                let planned;
                (planned, excess) = self.planned(&items, camera, demand)?;
                planned
            }
            _ => seen.iter().map(|&(animal, _)| (animal, 0, demand.layers)).collect(),
        };
        let stand = |&(animal, level, layers): &Chosen| (self.stand(animal, level), layers);
        let vertices = chosen.iter().map(|&(animal, level, layers)| {
            let species = &self.field.species()[self.field.animals()[animal].species];
            species.levels()[level].vertices().len() as u64 * u64::from(layers + 1)
        });
        let vertices = vertices.sum();
        let stands: Vec<(Stand, u32)> = chosen.iter().map(stand).collect();
        let list = DrawList::new(&stands, blocks);
        let list = self.posed(list, chosen.iter().map(|(animal, ..)| *animal))?;
        Ok(Drawn { list, animals: stands.len(), excess, vertices })
    }

    /// Animals with their level of detail and layers, and by how much they exceed the budget.
    fn planned(
        &self,
        items: &[DrawItem],
        camera: &Camera,
        demand: &Demand,
    ) -> Result<(Vec<Chosen>, f64), FurGpuError> {
        let vertices: Vec<Vec<u32>> = self
            .field
            .species()
            .iter()
            .map(|kind| kind.levels().iter().map(|m| m.vertices().len() as u32).collect())
            .collect();
        let number = |id| match self.field.kind(id) {
            Some(Kind::Animal(animal)) => Some(animal),
            _ => None,
        };
        let furry = |id| match number(id) {
            Some(animal) => {
                (&vertices[self.field.animals()[animal].species][..], self.field.fur_height(animal))
            }
            None => (&[] as &[u32], 0.0),
        };
        let focal = camera.projection.y_axis.y * demand.height as f32 * 0.5;
        let aspect = camera.projection.y_axis.y / camera.projection.x_axis.x;
        let options = PlanOptions {
            focal,
            screen: demand.height as f32 * demand.height as f32 * aspect,
            most_layers: demand.layers,
            ..PlanOptions::default()
        };
        let seen = |item: &DrawItem| {
            let (vertices, height) = furry(item.id);
            let DrawItem { distance, size, fraction, .. } = *item;
            Seen { vertices, height, distance, size, fraction }
        };
        let sights: Vec<Seen> = items.iter().map(seen).collect();
        let weight = |shares: &[Share]| shares.iter().map(|share| share.weight).sum::<f64>();
        let mut made = plan_sights(&sights, &options)?;
        let mut budget = f64::INFINITY;
        if demand.budget < 1.0 {
            budget = weight(&made) * demand.budget.max(0.0);
            made = plan_sights(&sights, &PlanOptions { budget, ..options })?;
        }
        let drawn = items.iter().zip(&made);
        let chosen = drawn.filter_map(|(item, share)| Some((number(item.id)?, share.level, share.layers)));
        Ok((chosen.collect(), (weight(&made) - budget).max(0.0)))
    }
}

/// The share of a box that is seen, from above: that of its columns along the axis on which it is
/// farthest from the eye.
fn share_seen(sight: &Sight, b: &Aabb, eye: Vec3) -> f32 {
    let depth = (b.center() - eye).abs().max_position();
    let [across, up] = [(depth + 1) % 3, (depth + 2) % 3];
    let step = (b.max - b.min) / COLUMNS as f32;
    let seen = (0..COLUMNS * COLUMNS).filter(|i| {
        let mut column = *b;
        for (axis, place) in [(across, i % COLUMNS), (up, i / COLUMNS)] {
            column.min[axis] = b.min[axis] + step[axis] * place as f32;
            column.max[axis] = column.min[axis] + step[axis];
        }
        sight.may_see_box(&column)
    });
    seen.count() as f32 / (COLUMNS * COLUMNS) as f32
}

/// A box to draw.
pub fn block(aabb: &Aabb, paint: u32) -> Block {
    Block { min: aabb.min.to_array(), paint, max: aabb.max.to_array(), pad: 0 }
}

/// A camera in a field at a share of its path, for pictures so many times as wide as high.
pub fn camera_at(field: &Field, share: f32, aspect: f32) -> Camera {
    let (eye, forward) = field.eye(share);
    let size = field.ground().max - field.ground().min;
    Camera::look_at(eye, eye + forward, 60.0, aspect, 0.05, size.length().max(1.0) + Vec3::ONE.length())
}
