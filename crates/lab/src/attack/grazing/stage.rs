//! A scene with occluders, tiny objects that are seen closely past them, and what is known about each.

use casca::{Aabb, Bounds, CameraQuery, GridSpec, Instance, Obb, ObjectDesc, ObjectId, Pvs, Scene, Sphere};
use glam::{Affine3A, DVec3, UVec3, Vec3};

use super::super::dice::Dice;
use super::super::ops::{direction, turn};
use super::solid::{Answer, Solid, Start};
use super::tally::{Count, Lost, Tally};
use super::views::outermost;
use super::walls::{Meshes, SHAPES, Wall, thick};

/// Occluders of a scene, at most: each has a bit.
const MOST_WALLS: usize = 60;
/// Cells along each side of the grid.
const CELLS: u32 = 64;
/// Aims that no point in single precision is found for are given up after so many tries.
const TRIES: u32 = 6;

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
    /// Index in [`SHAPES`] of the shape that it grazes.
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

/// Losses of one scene that are told.
const MOST_LOST: usize = 4;

impl<'a> Stage<'a> {
    /// A scene without objects.
    pub fn new(seed: u64, meshes: &'a Meshes, layered: bool, moving: bool) -> Self {
        let mut dice = Dice::new(seed);
        let unit = dice.pick(&[1.0, 1.0, 1.0, 0.01, 100.0, 1e4]);
        let away = dice.pick(&[0.0, 0.0, 0.0, 0.0, 0.0, 1e2, 1e4]) * unit;
        // Where all is snapped to a lattice, edges meet the borders of pixels.
        let snapped = dice.once_in(4);
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
            thick(dice, self.meshes, center, size.max(self.cell * 2.0), self.cell)
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

    /// A place closely past the outline of a wall, as seen from a start, the direction away from it, and the wall's shape.
    pub fn graze(&mut self, start: &Start) -> Option<Graze> {
        let (point, out, shape) = self.rim(|solid, dice| solid.rim(start, dice))?;
        Some((point + out * self.gap(start, point), out, shape))
    }

    /// An eye in a ball that looks as far past an edge as any eye in it does, and a place closely past that edge as
    /// [`Stage::graze`] tells it.
    pub fn outermost(&mut self, eye: DVec3, reach: f64) -> Option<(DVec3, Graze)> {
        let (point, out, shape) = self.rim(|solid, dice| solid.rim_of_ball(eye, reach, dice))?;
        let at = outermost(eye, out, reach);
        Some((at, (point + out * self.gap(&Start::Eye(at), point), out, shape)))
    }

    fn rim(
        &mut self,
        find: impl Fn(&Solid, &mut Dice) -> Option<(DVec3, DVec3)>,
    ) -> Option<(DVec3, DVec3, usize)> {
        if self.walls.is_empty() {
            return None;
        }
        let wall = &self.walls[self.dice.below(self.walls.len() as u32) as usize].wall;
        let (point, out) = find(&wall.solid, &mut self.dice)?;
        Some((point, out, wall.shape))
    }

    /// How far past an edge a ray goes.
    fn gap(&mut self, start: &Start, point: DVec3) -> f64 {
        let dice = &mut self.dice;
        let unit = match dice.below(3) {
            0 => 1.0,
            1 => start.toward(point).length().min(f64::from(self.unit) * 100.0),
            _ => f64::from(self.unit),
        };
        // Where coordinates are small, far smaller gaps are told apart.
        let least = if self.step > 0.0 { -11.0 } else { -7.0 };
        unit * 10f64.powf(least + (-2.0 - least) * dice.real())
    }

    /// A point behind a place, as seen from a start, rounded away from what it passes.
    pub fn behind(&mut self, start: &Start, place: DVec3, out: DVec3) -> DVec3 {
        let dice = &mut self.dice;
        // Views with a reach hide least of what is farthest.
        let most = if dice.once_in(6) { 5.0 } else { 1.3 };
        let beyond = 10f64.powf(-6.0 + (most + 6.0) * dice.real());
        let point = match *start {
            Start::Eye(eye) => place + (place - eye) * beyond,
            Start::Before(along, _) => place + along * (beyond * f64::from(self.unit)),
        };
        rounded(point, out)
    }

    /// Puts an object into the list of targets that has the point, or one next to it; says which.
    pub fn target_at(&mut self, point: DVec3, out: DVec3, toward: DVec3) -> DVec3 {
        let (layers, dynamic) = (self.layers(), self.moving && self.dice.once_in(4));
        let dice = &mut self.dice;
        let size = f64::from(self.unit) * 10f64.powf(-7.0 + 6.0 * dice.real());
        let at = point.as_vec3();
        let (bounds, seen): (Bounds, DVec3) = match dice.below(16) {
            0..=6 => (Aabb::new(at, at).into(), point),
            7..=10 => {
                // A corner shows; the rest is behind the occluder, or behind the corner.
                let inwards = toward.normalize() - out * dice.pick(&[1.0, 1.0, 0.1, 4.0]);
                let other = (point + inwards * size).as_vec3();
                (Aabb::new(at.min(other), at.max(other)).into(), point)
            }
            11..=13 => {
                let ball = Sphere::new((point - out * size).as_vec3(), size as f32);
                let center = ball.center.as_dvec3();
                (ball.into(), center + out * f64::from(ball.radius) * (1.0 - 1e-15))
            }
            14 => {
                let half = Vec3::splat(size as f32);
                let rotation = turn(dice);
                let axes = glam::DMat3::from_quat(rotation.as_dquat().normalize());
                let corner = DVec3::from_array(std::array::from_fn(|i| axes.col(i).dot(out).signum()));
                let corner = axes * (corner * half.as_dvec3());
                let center = (point - corner).as_vec3();
                (Obb::new(center, half, rotation).into(), center.as_dvec3() + corner * (1.0 - 1e-12))
            }
            _ => {
                let scale = Vec3::splat((size as f32).max(1e-6 * self.unit));
                let rotation = turn(dice);
                let transform = Affine3A::from_scale_rotation_translation(scale, rotation, at);
                let exact = super::solid::exact(transform);
                let corners = DVec3::AXES.map(|c| exact.transform_point3(c));
                let most = corners.into_iter().max_by(|a, b| a.dot(out).total_cmp(&b.dot(out)));
                match Instance::new(self.meshes.speck.clone(), transform) {
                    Ok(instance) => (instance.into(), most.unwrap_or(point)),
                    Err(_) => (Aabb::new(at, at).into(), point),
                }
            }
        };
        self.targets.push(Target { bounds, layers, dynamic, id: None });
        seen
    }

    /// Aims at a tiny object closely past an occluder. Only points for which `inside` holds are aimed at.
    pub fn aim(&mut self, start: Start, place: Place, inside: impl Fn(DVec3) -> bool) {
        for _ in 0..TRIES {
            if let Some(past) = self.graze(&start)
                && self.aim_past(start, place, past, true, &inside)
            {
                return;
            }
        }
    }

    /// Aims at a point of no object.
    pub fn aim_point(&mut self, start: Start, place: Place, inside: impl Fn(DVec3) -> bool) {
        for _ in 0..TRIES {
            if let Some(past) = self.graze(&start)
                && self.aim_past(start, place, past, false, &inside)
            {
                return;
            }
        }
    }

    /// Aims past a known place at an object, or at a point of none. Whether `inside` holds for it.
    pub fn aim_past(
        &mut self,
        start: Start,
        place: Place,
        (near, out, shape): Graze,
        object: bool,
        inside: &impl Fn(DVec3) -> bool,
    ) -> bool {
        let point = self.behind(&start, near, out);
        inside(point) && self.aim_at(start, place, (point, out, shape), object, inside)
    }

    /// Aims at an object that has a point, or at the point. Whether `inside` holds for it.
    pub fn aim_at(
        &mut self,
        start: Start,
        place: Place,
        (point, out, shape): Graze,
        object: bool,
        inside: &impl Fn(DVec3) -> bool,
    ) -> bool {
        if !object {
            self.witness(None, start, place, point, shape);
            return true;
        }
        let point = self.target_at(point, out, start.toward(point));
        if !inside(point) {
            self.targets.pop();
            return false;
        }
        self.witness(Some(self.targets.len() - 1), start, place, point, shape);
        true
    }

    /// Takes a point for one to look at.
    pub fn witness(&mut self, target: Option<usize>, start: Start, place: Place, point: DVec3, shape: usize) {
        let mut witness = Witness { target, point, start, place, shape, cut: 0, doubt: 0 };
        for (i, standing) in self.walls.iter().enumerate() {
            witness.look(&standing.wall, 1 << i);
        }
        self.witnesses.push(witness);
    }

    /// Puts all targets into the scene.
    pub fn insert_targets(&mut self) {
        for target in self.targets.iter_mut().filter(|t| t.id.is_none()) {
            target.id = self.scene.insert(target.describe()).ok();
        }
    }

    /// The walls that hide in a view of these layers, a bit for each.
    pub fn hiding(&self, mask: u64) -> u64 {
        let walls = self.walls.iter().enumerate();
        walls.filter(|(_, w)| w.id.is_some() && w.layers & mask != 0).map(|(i, _)| 1 << i).sum()
    }

    /// Whether nothing is between two points but what is seen through for certain.
    pub fn free(&self, from: DVec3, to: DVec3, mask: u64) -> Answer {
        let mut worst = Answer::Free;
        for standing in self.walls.iter().filter(|w| w.id.is_some() && w.layers & mask != 0) {
            match standing.wall.solid.answer(from, to) {
                Answer::Cut => return Answer::Cut,
                Answer::Doubt => worst = Answer::Doubt,
                Answer::Free => {}
            }
        }
        worst
    }

    /// Compares a set with the truth: it must hold each target that one of the places sees a point of.
    pub fn check(&mut self, way: &'static str, mask: u64, places: impl Fn(&Witness) -> bool, pvs: &Pvs) {
        let holds = |w: &Witness, targets: &[Target]| {
            let target = &targets[w.target?];
            target.id.filter(|_| target.layers & mask != 0).map(|id| pvs.contains(id))
        };
        let answers = self.witnesses.iter().map(|w| holds(w, &self.targets)).collect::<Vec<_>>();
        self.compare(way, mask, places, &answers);
    }

    /// Asks for all points, and compares the answers with the truth.
    pub fn ask(
        &mut self,
        way: &'static str,
        mask: u64,
        places: impl Fn(&Witness) -> bool,
        query: &impl CameraQuery,
    ) {
        let Some(sight) = query.sight(&self.scene) else { return };
        let answer = |w: &Witness| match w.target {
            None => sight.may_see_point(w.point.as_vec3()),
            Some(target) => sight.may_see_bounds(&self.targets[target].bounds),
        };
        let answers: Vec<_> = self.witnesses.iter().map(|w| places(w).then(|| answer(w))).collect();
        self.compare(way, mask, places, &answers);
    }

    /// Compares the answers about witnesses with the truth.
    fn compare(
        &mut self,
        way: &'static str,
        mask: u64,
        places: impl Fn(&Witness) -> bool,
        answers: &[Option<bool>],
    ) {
        let hiding = self.hiding(mask);
        let mut counts = [Count::default(); SHAPES.len()];
        for (i, held) in answers.iter().enumerate() {
            let (witness, Some(held)) = (&self.witnesses[i], *held) else { continue };
            if !places(witness) {
                continue;
            }
            let answer = match (witness.cut & hiding, witness.doubt & hiding) {
                (0, 0) => Answer::Free,
                (0, _) => Answer::Doubt,
                _ => Answer::Cut,
            };
            counts[witness.shape].note(answer, held);
            if answer == Answer::Free && !held {
                let shape = witness.shape;
                let bounds = witness.target.map(|t| (&self.targets[t].bounds, self.targets[t].id));
                let text = format!(
                    "{bounds:?}, of which {} is seen from {:?} ({:?}), mask {mask:#x}",
                    witness.point, witness.start, witness.place
                );
                self.tell(way, shape, &text);
            }
        }
        for (shape, count) in counts.iter().enumerate().filter(|(_, count)| count.tried > 0) {
            self.tally.of(way, SHAPES[shape]).add(count);
        }
    }

    /// Counts one answer of the library about a point, beside the truth.
    pub fn count(
        &mut self,
        way: &'static str,
        shape: usize,
        answer: Answer,
        held: bool,
        text: impl FnOnce() -> String,
    ) {
        self.tally.of(way, SHAPES[shape]).note(answer, held);
        if answer == Answer::Free && !held {
            self.tell(way, shape, &text());
        }
    }

    /// Tells of a loss.
    fn tell(&mut self, way: &'static str, shape: usize, text: &str) {
        if self.lost.len() < MOST_LOST {
            let walls = self.walls.iter().filter(|w| w.id.is_some());
            let walls: Vec<String> =
                walls.map(|w| format!("{} (layers {:#x})", w.wall.text, w.layers)).collect();
            let walls = walls.join("\n  ");
            let text = format!("{way} of scene {} lacks {text}; past\n  {walls}", self.seed);
            self.lost.push(Lost { seed: self.seed, way, shape: SHAPES[shape], text });
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

/// A point in single precision, rounded along each axis to the side that `out` points to.
pub fn rounded(point: DVec3, out: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|i| {
        let near = point[i] as f32;
        let short = (f64::from(near) - point[i]) * out[i] < 0.0;
        f64::from(match (short, out[i] > 0.0) {
            (false, _) => near,
            (true, true) => near.next_up(),
            (true, false) => near.next_down(),
        })
    }))
}
