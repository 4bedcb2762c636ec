//! A scene with occluders, tiny objects that are seen closely past them, and what is known about
//! each.

mod aim;
mod judge;

use casca::{Bounds, GridSpec, ObjectDesc, ObjectId, Scene};
use glam::{DVec3, UVec3, Vec3};

use super::super::dice::Dice;
use super::super::ops::direction;
use super::solid::{Answer, Start};
use super::tally::{Lost, Tally};
use super::walls::{Meshes, Wall, thick};

pub use aim::rounded;

/// Occluders of a scene, at most: each has a bit.
const MOST_WALLS: usize = 60;
/// Cells along each side of the grid.
const CELLS: u32 = 64;

/// A place closely past an outline, the direction away from it, and the index of the shape.
pub type Graze = (DVec3, DVec3, usize);

/// A tiny object.
pub struct Target {
    /// What the library is told.
    pub bounds: Bounds,
    /// Its layers.
    pub layers: u64,
    /// Whether it may move.
    pub dynamic: bool,
    /// Its id, while it is in the scene.
    pub id: Option<ObjectId>,
}

/// Where a point is seen from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// From the place of a view with this number.
    View(u8),
    /// From an eye that went as far as it may.
    Reach,
    /// By a camera that turned as far as it may.
    Turn,
    /// By one that did both.
    Both,
}

/// A point of a target, and the occluders between it and its eye.
pub struct Witness {
    /// The target's index; `None` for a point that is asked for alone, and is in single precision.
    pub target: Option<usize>,
    /// The point.
    pub point: DVec3,
    /// Where its ray starts.
    pub start: Start,
    /// What that place is.
    pub place: Place,
    /// Index in [`SHAPES`](super::walls::SHAPES) of the shape that it grazes.
    pub shape: usize,
    /// A bit for each wall that cuts the ray.
    cut: u64,
    /// A bit for each wall that may.
    doubt: u64,
}

/// A wall in a scene.
pub struct Standing {
    /// The wall.
    pub wall: Wall,
    /// Its id, while it is in the scene.
    pub id: Option<ObjectId>,
    /// Whether it may move.
    pub dynamic: bool,
    /// Its layers.
    pub layers: u64,
}

/// A scene with its truth.
pub struct Stage<'a> {
    /// Choices.
    pub dice: Dice<'static>,
    seed: u64,
    meshes: &'a Meshes,
    /// The library's scene.
    pub scene: Scene,
    /// The unit of length.
    pub unit: f32,
    /// Edge of a cell.
    pub cell: f32,
    /// About where eyes are.
    pub middle: Vec3,
    /// Coordinates are multiples of this; 0 for any.
    step: f32,
    /// Whether walls and targets are on layers.
    layered: bool,
    /// Whether some of the walls and targets may move.
    moving: bool,
    /// The occluders.
    pub walls: Vec<Standing>,
    /// The targets.
    pub targets: Vec<Target>,
    /// The points looked at.
    pub witnesses: Vec<Witness>,
    /// What was tried.
    pub tally: Tally,
    /// What was lost.
    pub lost: Vec<Lost>,
}

impl<'a> Stage<'a> {
    /// A scene without objects.
    pub fn new(seed: u64, meshes: &'a Meshes, layered: bool, moving: bool) -> Self {
        let mut dice = Dice::new(seed);
        let unit = dice.pick(&[1.0, 1.0, 1.0, 0.01, 100.0, 1e4]);
        let away = dice.pick(&[0.0, 0.0, 0.0, 0.0, 0.0, 1e2, 1e4]) * unit;
        // Where all is snapped to a lattice, edges meet the borders of pixels.
        let snapped = dice.once_in(2);
        let step = if snapped { unit * dice.pick(&[1.0, 0.5, 0.125]) } else { 0.0 };
        let middle = if snapped && away == 0.0 {
            Vec3::ZERO
        } else {
            let offset = away * direction(&mut dice);
            if snapped { (offset / step).round() * step } else { offset + unit * direction(&mut dice) }
        };
        let cell = unit * dice.pick(&[1.0, 1.0, 2.0]);
        let min = middle - 0.5 * cell * CELLS as f32;
        let min = if snapped { (min / cell).round() * cell } else { min };
        let spec = GridSpec { min, cell, dims: UVec3::splat(CELLS) };
        #[expect(clippy::expect_used, reason = "a grid of these numbers is one")]
        let scene = Scene::new(&spec).expect("a grid");
        Self {
            dice,
            seed,
            meshes,
            scene,
            unit,
            cell,
            middle,
            step,
            layered,
            moving,
            walls: Vec::new(),
            targets: Vec::new(),
            witnesses: Vec::new(),
            tally: Tally { scenes: 1, ..Tally::default() },
            lost: Vec::new(),
        }
    }

    /// A coordinate as this scene has it.
    pub fn snap(step: f32, p: Vec3) -> Vec3 {
        if step > 0.0 { (p / step).round() * step } else { p }
    }

    /// A place for an eye.
    pub fn eye(&mut self) -> Vec3 {
        let by = direction(&mut self.dice) * self.unit * self.dice.unit();
        if self.step > 0.0 { self.middle } else { self.middle + by }
    }

    /// A mask of layers for an object; all, where the scene has none.
    pub fn layers(&mut self) -> u64 {
        if self.layered { self.dice.pick(&[u64::MAX, u64::MAX, 1, 2, 3, 5]) } else { u64::MAX }
    }

    /// A mask of layers for a view.
    pub fn mask(&mut self) -> u64 {
        if self.layered { self.dice.pick(&[u64::MAX, 1, 2, 4, 6]) } else { u64::MAX }
    }

    /// Puts occluders into the scene, in directions for which `faces` holds.
    pub fn build(&mut self, count: u32, faces: impl Fn(Vec3) -> bool) {
        for _ in 0..count {
            self.wall(&faces, false);
        }
    }

    /// Puts thick occluders on cells into the scene.
    pub fn build_cells(&mut self, count: u32) {
        for _ in 0..count {
            self.wall(&|_| true, true);
        }
    }

    /// Puts an occluder, or several that belong together, into the scene.
    pub fn wall(&mut self, faces: &impl Fn(Vec3) -> bool, on_cells: bool) {
        let dice = &mut self.dice;
        let Some(ahead) = (0..20).map(|_| direction(dice)).find(|d| faces(*d)) else { return };
        let far = 10f32.powf(dice.between(0.35, 1.25));
        let size = far * dice.between(0.05, 0.35) * self.unit;
        let mut center = self.middle + ahead * far * self.unit;
        let step = self.step;
        if step > 0.0 {
            // A side of many boxes lies in a plane through the eye.
            center = Self::snap(step, center);
        }
        let walls = if on_cells {
            // Beside the cell of the eye, and some cells thick, so that cells hide.
            let (far, size) = (dice.between(5.5, 16.0), dice.between(1.0, 2.5));
            let center = self.middle + ahead * far * self.cell;
            let min = self.scene.grid().min().as_vec3();
            thick(dice, self.meshes, center, size * self.cell, self.cell, min)
        } else {
            Wall::some(dice, self.meshes, center, size, |p| Self::snap(step, p))
        };
        for wall in walls {
            self.put(wall);
        }
    }

    fn put(&mut self, wall: Wall) {
        // Rounding to a lattice may leave nothing of a box.
        if !wall.solid.has_rim() || self.walls.len() >= MOST_WALLS {
            return;
        }
        let (dynamic, layers) = (self.moving && self.dice.once_in(4), self.layers());
        // Some shapes are refused: flat ones, and solids too thin for where they are.
        let Ok(id) = self.scene.insert(wall.describe(dynamic, layers)) else { return };
        let bit = 1 << self.walls.len();
        for witness in &mut self.witnesses {
            witness.look(&wall, bit);
        }
        self.walls.push(Standing { wall, id: Some(id), dynamic, layers });
    }

    /// Takes a wall out of the scene, or puts it back.
    pub fn toggle_wall(&mut self, i: usize) {
        let standing = &mut self.walls[i];
        match standing.id.take() {
            Some(id) => {
                let _ = self.scene.remove(id);
            }
            None => {
                standing.id =
                    self.scene.insert(standing.wall.describe(standing.dynamic, standing.layers)).ok();
            }
        }
    }

    /// Takes a target out of the scene, or puts it back.
    pub fn toggle_target(&mut self, i: usize) {
        let target = &mut self.targets[i];
        match target.id.take() {
            Some(id) => {
                let _ = self.scene.remove(id);
            }
            None => target.id = self.scene.insert(target.describe()).ok(),
        }
    }

    /// Puts a wall or a target on other layers.
    pub fn relayer(&mut self) {
        let layers = self.layers();
        if self.dice.once_in(2) && !self.walls.is_empty() {
            let i = self.dice.below(self.walls.len() as u32) as usize;
            self.walls[i].layers = layers;
            if let Some(id) = self.walls[i].id {
                let _ = self.scene.set_layers(id, layers);
            }
        } else if !self.targets.is_empty() {
            let i = self.dice.below(self.targets.len() as u32) as usize;
            self.targets[i].layers = layers;
            if let Some(id) = self.targets[i].id {
                let _ = self.scene.set_layers(id, layers);
            }
        }
    }

    /// Puts all targets into the scene.
    pub fn insert_targets(&mut self) {
        for target in self.targets.iter_mut().filter(|t| t.id.is_none()) {
            target.id = self.scene.insert(target.describe()).ok();
        }
    }
}

impl Target {
    /// What the library is told.
    pub fn describe(&self) -> ObjectDesc {
        let bounds = self.bounds.clone();
        let desc = if self.dynamic { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
        desc.layers(self.layers)
    }
}

impl Witness {
    /// Notes what a wall does to the ray.
    fn look(&mut self, wall: &Wall, bit: u64) {
        let from = self.point - self.start.toward(self.point);
        match wall.solid.answer(from, self.point) {
            Answer::Free => {}
            Answer::Doubt => self.doubt |= bit,
            Answer::Cut => self.cut |= bit,
        }
    }
}
