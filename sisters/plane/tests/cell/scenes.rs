//! Random scenes whose objects move, and the truth about where they are.

use casca_plane::{Disc, GridSpec, ObjectDesc, ObjectId, Rect, Scene, Shape};
use glam::{DVec2, UVec2, Vec2};

use crate::rays::Box2;

/// Pseudo-random numbers (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    /// A multiple of 1/64 from `lo` to `hi`.
    pub fn between(&mut self, lo: f32, hi: f32) -> f32 {
        lo + self.below(((hi - lo) * 64.0) as u64 + 1) as f32 / 64.0
    }

    /// A point with coordinates from `lo` to `hi`, of which half are multiples of 1/2: on sides of
    /// cells, and where other objects end.
    pub fn point(&mut self, lo: f32, hi: f32) -> Vec2 {
        let mut coordinate = || match self.below(2) {
            0 => self.between(lo, hi),
            _ => lo + self.below(((hi - lo) * 2.0) as u64 + 1) as f32 / 2.0,
        };
        Vec2::new(coordinate(), coordinate())
    }
}

/// How an object moves and is reported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Stays.
    Fixed,
    /// Reported at each move; keeps to its speed, if it promised one.
    Honest,
    /// Reported at each move; breaks its promise now and then.
    Liar,
    /// Reported when it is due; keeps to its speed while it goes unreported.
    Silent,
}

/// An object of the scene, and where it really is.
pub struct Actor {
    pub id: ObjectId,
    pub kind: Kind,
    pub center: Vec2,
    /// Half the sides of a rectangle, or a radius.
    pub half: Vec2,
    pub is_disc: bool,
    pub hides: bool,
    pub speed: f32,
    target: Vec2,
}

impl Actor {
    pub fn shape(&self) -> Shape {
        if self.is_disc {
            Disc::new(self.center, self.half.x).into()
        } else {
            Rect::new(self.center - self.half, self.center + self.half).into()
        }
    }

    pub fn block(&self) -> Box2 {
        Box2::around(self.center.as_dvec2(), self.half.as_dvec2())
    }

    /// Points of the object: its middle and points on its border.
    pub fn points(&self) -> impl Iterator<Item = DVec2> {
        let (center, half, is_disc) = (self.center.as_dvec2(), self.half.as_dvec2(), self.is_disc);
        let border = (0..16).map(move |i| {
            let direction = DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 16.0);
            let scale = if is_disc { 1.0 } else { 1.0 / direction.abs().max_element() };
            center + direction * half * scale * (1.0 - 1e-9)
        });
        std::iter::once(center).chain(border)
    }

    /// Moves for some time. Half of the moves are as fast as promised.
    pub fn walk(&mut self, random: &mut Random, seconds: f32, size: f32) {
        if self.kind == Kind::Fixed {
            return;
        }
        if self.kind == Kind::Liar && random.below(12) == 0 {
            self.center = random.point(1.0, size - 1.0);
            return;
        }
        if random.below(10) == 0 || self.center.distance(self.target) < 0.1 {
            self.target = random.point(1.0, size - 1.0);
        }
        // A little less than promised, for rounding.
        let step = self.speed * seconds * if random.below(2) == 0 { 0.999 } else { 0.3 };
        let way = self.target - self.center;
        self.center += way.clamp_length_max(step);
    }
}

/// A scene and its actors.
pub struct World {
    pub scene: Scene,
    pub actors: Vec<Actor>,
    pub size: f32,
}

impl World {
    /// Walls, rocks and movers on a square grid.
    pub fn new(random: &mut Random) -> Self {
        let (cells, cell) = (16 + random.below(20) as u32, [0.5, 1.0][random.below(2) as usize]);
        let size = cells as f32 * cell;
        let spec = GridSpec { min: Vec2::ZERO, cell, dims: UVec2::splat(cells) };
        let mut world = Self { scene: Scene::new(&spec).unwrap(), actors: Vec::new(), size };
        for _ in 0..4 + random.below(8) {
            // With sides on those of cells or beside them, and walls without thickness.
            let halves = [(4.0, 0.8), (0.8, 4.0), (1.5, 1.5), (4.0, 0.5), (0.5, 3.0), (4.0, 0.0), (0.0, 4.0)];
            let half = Vec2::from(halves[random.below(7) as usize]);
            world.insert(random, Kind::Fixed, half * cell, true);
        }
        for _ in 0..6 + random.below(14) {
            let kind = [Kind::Honest, Kind::Liar, Kind::Silent, Kind::Silent][random.below(4) as usize];
            let half = Vec2::splat(cell) * [0.2, 0.5, 1.3][random.below(3) as usize];
            let hides = random.below(3) == 0;
            world.insert(random, kind, half, hides);
        }
        world
    }

    pub fn insert(&mut self, random: &mut Random, kind: Kind, half: Vec2, hides: bool) {
        let center = random.point(0.0, self.size);
        let speed = random.between(0.25, 4.0);
        let is_disc = !hides && random.below(2) == 0;
        let mut actor =
            Actor { id: self.any_id(), kind, center, half, is_disc, hides, speed, target: center };
        let desc = match kind {
            Kind::Fixed => ObjectDesc::fixed(actor.shape()),
            Kind::Silent => ObjectDesc::dynamic(actor.shape()).max_speed(speed).reported_on_expiry(),
            _ if random.below(3) == 0 => ObjectDesc::dynamic(actor.shape()),
            _ => ObjectDesc::dynamic(actor.shape()).max_speed(speed),
        };
        let desc = if hides { desc.occluder(actor.shape()) } else { desc };
        actor.id = self.scene.insert(desc).unwrap();
        self.actors.push(actor);
    }

    fn any_id(&mut self) -> ObjectId {
        let id = self.scene.insert(ObjectDesc::fixed(Disc::new(Vec2::ONE, 0.1))).unwrap();
        self.scene.remove(id).unwrap();
        id
    }

    pub fn report(&mut self, at: usize) {
        let actor = &self.actors[at];
        let occluder = actor.hides.then(|| actor.shape());
        self.scene.update(actor.id, actor.shape(), occluder).unwrap();
    }

    /// Whether an eye is in or near an occluder.
    pub fn blocks(&self, eye: DVec2) -> bool {
        self.actors.iter().any(|actor| actor.hides && actor.block().holds(eye))
    }

    /// Whether some ray from an eye surely reaches an actor, at a point that `in_view` accepts.
    pub fn sees(&self, eye: DVec2, at: usize, in_view: impl Fn(DVec2) -> bool) -> bool {
        let stops = |to: DVec2| {
            let others = self.actors.iter().enumerate().filter(|&(i, actor)| i != at && actor.hides);
            others.into_iter().any(|(_, actor)| actor.block().stops(eye, to))
        };
        self.actors[at].points().any(|to| in_view(to) && !stops(to))
    }
}
