//! A scene with occluders, tiny objects that are seen closely past them, and what is known about
//! each.

mod aim;
mod judge;

use casca::{Bounds, ObjectDesc, ObjectId, Scene};
use glam::{DVec3, Vec3};

use super::super::dice::{Dice, direction};
use super::super::solid::Answer;
use super::rims::Start;
use super::tally::Tally;
use super::walls::{Meshes, Wall, thick};

pub use aim::rounded;

/// Occluders of a scene, at most: each has a bit.
const MOST_WALLS: usize = 60;

/// A place closely past an outline, the direction away from it, and the index of the shape.
pub type Graze = (DVec3, DVec3, usize);

pub struct Target {
    pub bounds: Bounds,
    pub layers: u64,
    pub dynamic: bool,
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
    Both,
    /// From an eye in a view cell.
    Room,
    /// From the cell of a camera with this number, inside its half-spaces.
    Cell(u8),
}

/// A point of a target, and the occluders between it and its eye.
pub struct Witness {
    /// The target's index; `None` for a point that is asked for alone, and is in single precision.
    pub target: Option<usize>,
    pub point: DVec3,
    pub start: Start,
    pub place: Place,
    /// Index in [`SHAPES`](super::walls::SHAPES) of the shape that it grazes.
    pub shape: usize,
    /// A bit for each wall that cuts the ray.
    cut: u64,
    /// A bit for each wall that may.
    doubt: u64,
}

pub struct Standing {
    pub wall: Wall,
    pub id: Option<ObjectId>,
    pub dynamic: bool,
    pub layers: u64,
}

pub struct Stage<'a> {
    pub dice: Dice<'static>,
    seed: u64,
    meshes: &'a Meshes,
    pub scene: Scene,
    /// The unit of length.
    pub unit: f32,
    pub cell: f32,
    /// About where eyes are.
    pub middle: Vec3,
    /// Coordinates are multiples of this; 0 for any.
    step: f32,
    /// Whether walls and targets are on layers.
    layered: bool,
    /// Whether some of the walls and targets may move.
    moving: bool,
    pub walls: Vec<Standing>,
    pub targets: Vec<Target>,
    pub witnesses: Vec<Witness>,
    pub tally: Tally,
    /// Lost objects, for people.
    pub lost: Vec<String>,
}

impl<'a> Stage<'a> {
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
        #[expect(clippy::expect_used, reason = "a grid of these numbers is one")]
        let scene = Scene::new(cell).expect("a grid");
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

    pub fn eye(&mut self) -> Vec3 {
        let by = direction(&mut self.dice) * self.unit * self.dice.unit();
        if self.step > 0.0 { self.middle } else { self.middle + by }
    }

    /// A mask of layers for an object; all, where the scene has none.
    pub fn layers(&mut self) -> u64 {
        if self.layered { self.dice.pick(&[u64::MAX, u64::MAX, 1, 2, 3, 5]) } else { u64::MAX }
    }

    pub fn mask(&mut self) -> u64 {
        if self.layered { self.dice.pick(&[u64::MAX, 1, 2, 4, 6]) } else { u64::MAX }
    }

    /// Puts an occluder, or several that belong together, into the scene, in a direction for which
    /// `faces` holds; `on_cells` asks for thick ones on cells.
    pub fn wall(&mut self, faces: impl Fn(Vec3) -> bool, on_cells: bool) {
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

    /// Takes a wall or a target out of the scene, or puts it back.
    pub fn toggle(&mut self, is_wall: bool, i: usize) {
        let (walls, targets) = (&mut self.walls, &mut self.targets);
        let id = if is_wall { &mut walls[i].id } else { &mut targets[i].id };
        if let Some(id) = id.take() {
            let _ = self.scene.remove(id);
        } else if is_wall {
            walls[i].id = self.scene.insert(walls[i].wall.describe(walls[i].dynamic, walls[i].layers)).ok();
        } else {
            targets[i].id = self.scene.insert(targets[i].describe()).ok();
        }
    }

    /// Puts a wall or a target on other layers.
    pub fn relayer(&mut self) {
        let layers = self.layers();
        let (walls, targets) = (self.walls.len() as u32, self.targets.len() as u32);
        let (id, old) = if self.dice.once_in(2) && walls > 0 {
            let wall = &mut self.walls[self.dice.below(walls) as usize];
            (wall.id, &mut wall.layers)
        } else if targets > 0 {
            let target = &mut self.targets[self.dice.below(targets) as usize];
            (target.id, &mut target.layers)
        } else {
            return;
        };
        *old = layers;
        if let Some(id) = id {
            let _ = self.scene.set_layers(id, layers);
        }
    }

    pub fn insert_targets(&mut self) {
        for target in self.targets.iter_mut().filter(|t| t.id.is_none()) {
            target.id = self.scene.insert(target.describe()).ok();
        }
    }
}

impl Target {
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
