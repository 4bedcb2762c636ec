//! Many furry animals among walls: a scene of casca for tests and programs.

use std::f32::consts::{FRAC_PI_2, TAU};

use crate::error::{Error, range};
use crate::skin::Pose;
use crate::strands::{Forces, Fur, Lean};
use crate::visibility::{furry_object, inner_ball};
use casca::{Aabb, ObjectDesc, ObjectId, Occluder, Scene, Sphere};
use casca_scenes::random::generator;
use glam::{Affine3A, Quat, Vec3};
use rand::RngExt;

use crate::scenes::animals::Animal;

/// What an object of a field is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// An animal, by its number.
    Animal(usize),
    /// A wall, by its number.
    Wall(usize),
    /// The ground.
    Ground,
}

/// An animal in a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resident {
    /// Its object in the scene.
    pub id: ObjectId,
    /// The number of its species: its meshes.
    pub species: usize,
    /// From the space of its meshes to the world.
    pub placement: Affine3A,
    walk: Walk,
    lean: Lean,
}

/// A walk on a circle, looking ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Walk {
    /// The middle of the circle, on the ground.
    center: Vec3,
    /// Its radius; 0 for those that stand.
    radius: f32,
    /// Radians per second, and where it starts.
    turn: [f32; 2],
    scale: f32,
}

impl Walk {
    /// The placement at a time of what stands on the ground at 0 and looks along x, and the
    /// velocity and the acceleration, in units and seconds.
    fn at(&self, time: f64) -> (Affine3A, [Vec3; 2]) {
        let angle = f64::from(self.turn[1]) + time * f64::from(self.turn[0]);
        let angle = angle.rem_euclid(std::f64::consts::TAU) as f32;
        let (sin, cos) = angle.sin_cos();
        let place = self.center + Vec3::new(cos * self.radius, 0.0, sin * self.radius);
        // Along the tangent (-sin, cos).
        let turn = Quat::from_rotation_y(-angle - FRAC_PI_2);
        let velocity = Vec3::new(-sin, 0.0, cos) * self.radius * self.turn[0];
        let acceleration = Vec3::new(-cos, 0.0, -sin) * self.radius * self.turn[0].powi(2);
        let placement = Affine3A::from_scale_rotation_translation(Vec3::splat(self.scale), turn, place);
        (placement, [velocity, acceleration])
    }

    /// How many rounds of its steps an animal of a stride has gone at a time.
    fn rounds(&self, time: f64, stride: f32) -> f64 {
        let speed = f64::from(self.radius * self.turn[0]);
        f64::from(self.turn[1]) + time * speed / f64::from(stride * self.scale)
    }
}

/// A square field of lots with walls between some of them, and animals on the lots. y is up, the
/// ground is at 0; one unit is the length of an animal.
pub struct Field {
    /// The scene, for queries.
    pub scene: Scene,
    species: Vec<Animal>,
    fur: Fur,
    animals: Vec<Resident>,
    walls: Vec<Aabb>,
    ground: Aabb,
    /// By animal, in a herd.
    poses: Vec<Pose>,
    forces: Forces,
}

/// The edge of a lot, in units.
const LOT: f32 = 4.0;

/// Animals on each lot, on average.
const CROWD: usize = 2;

/// The thickness and the height of walls: higher than animals and eyes.
const WALL: [f32; 2] = [0.25, 2.0];

/// The share of the borders between lots that have a wall.
const WALLED: f64 = 0.4;

/// The most animals: walls and animals then fit a scene of casca.
const MOST: usize = 100_000;

/// The most species of a field.
const MOST_SPECIES: usize = 16;

/// The detail of the meshes of generated animals.
const DETAIL: u32 = 48;

impl Field {
    /// A field of `count` animals, 1 to 100,000, of 1 to 16 generated species with the same fur.
    /// Each animal is of one of them, by the seed. Animals that stand hide others by a ball inside
    /// all levels of detail.
    ///
    /// With `forces` it is a herd: all animals walk on their legs, their strands lean, and only
    /// walls hide.
    ///
    /// # Errors
    /// Refuses counts, fur and longest bends out of range, and what casca refuses.
    pub fn new(
        count: usize,
        species: usize,
        seed: u64,
        fur: Fur,
        forces: Option<Forces>,
    ) -> Result<Self, Error> {
        range("the number of animals", count as f64, 1.0, MOST as f64)?;
        range("the number of species", species as f64, 1.0, MOST_SPECIES as f64)?;
        let kind = |i: usize| Animal::new(seed.wrapping_mul(31).wrapping_add(i as u64), DETAIL);
        let species = (0..species).map(kind).collect::<Result<Vec<Animal>, Error>>()?;
        let mut random = generator(seed, 0);
        let ball = |kind: &Animal| match forces {
            Some(_) => Ok(None),
            None => inner_ball(&kind.levels().iter().collect::<Vec<_>>()),
        };
        let hides = species.iter().map(ball).collect::<Result<Vec<Option<Sphere>>, Error>>()?;
        let lots = (count.div_ceil(CROWD) as f64).sqrt().ceil() as usize;
        let edge = lots as f32 * LOT;
        let ground = Aabb::new(Vec3::new(-LOT, -0.5, -LOT), Vec3::new(edge + LOT, 0.0, edge + LOT));
        let refused = |what| move |source| Error::Scene { what, source };
        // Cells of half a unit, or coarser for large fields.
        let cell = 0.5 * (edge / 200.0).max(1.0);
        let mut scene = Scene::new(cell).map_err(refused("grid of the field"))?;
        let solid = |scene: &mut Scene, aabb: Aabb, number: u64, what| {
            let desc = ObjectDesc::fixed(aabb).occluder(aabb).user_data(number);
            scene.insert(desc).map_err(refused(what))
        };
        solid(&mut scene, ground, u64::MAX, "ground")?;
        let mut walls = Vec::new();
        for (x, z) in (0..=lots).flat_map(|x| (0..=lots).map(move |z| (x, z))) {
            let corner = Vec3::new(x as f32 * LOT, 0.0, z as f32 * LOT);
            let half = Vec3::new(WALL[0] * 0.5, 0.0, WALL[0] * 0.5);
            for (along, room) in [(Vec3::X, x < lots), (Vec3::Z, z < lots)] {
                if room && random.random_bool(WALLED) {
                    let wall = Aabb::new(corner - half, corner + half + along * LOT + Vec3::Y * WALL[1]);
                    solid(&mut scene, wall, (1 << 32) + walls.len() as u64, "wall")?;
                    walls.push(wall);
                }
            }
        }
        let mut animals = Vec::with_capacity(count);
        for number in 0..count {
            let lot = number / CROWD;
            let kind = random.random_range(0..species.len());
            // Each in its half of the lot.
            let side = LOT * (0.27 + 0.46 * (number % CROWD) as f32);
            let center =
                Vec3::new((lot % lots) as f32 * LOT + side, 0.0, (lot / lots) as f32 * LOT + LOT * 0.5);
            let walk = Walk {
                center,
                radius: if forces.is_some() { 0.3 } else { 0.0 },
                turn: [random.random_range(0.5..1.5), random.random_range(0.0..TAU)],
                scale: random.random_range(0.75..1.0),
            };
            let of = &species[kind];
            let placement = walk.at(0.0).0 * onto_ground(of);
            // Of those that walk the first step gives the bounds.
            let hides = hides[kind].map(Occluder::from);
            let desc = furry_object(of.aabb(), &fur, hides, placement, forces.is_some())?;
            let id = scene.insert(desc.user_data(number as u64)).map_err(refused("animal"))?;
            animals.push(Resident { id, species: kind, placement, walk, lean: Lean::default() });
        }
        let mut field = Self {
            scene,
            species,
            fur,
            animals,
            walls,
            ground,
            poses: Vec::new(),
            forces: forces.unwrap_or_default(),
        };
        if forces.is_some() {
            let rest = |resident: &Resident| Pose::rest(&field.species[resident.species].rig().skeleton);
            field.poses = field.animals.iter().map(rest).collect();
            field.walk(0.0)?;
        }
        Ok(field)
    }

    /// Moves the animals of a herd to where they are at a time in seconds; at 0 they are where they
    /// were made. Others stand.
    ///
    /// # Errors
    /// Refuses times that are not finite.
    pub fn walk(&mut self, time: f64) -> Result<(), Error> {
        range("the time in seconds", time, -1e9, 1e9)?;
        let failed = |source| Error::Scene { what: "step of an animal", source };
        let fur = self.fur.leaning(self.forces.most)?;
        // Only herds have poses.
        for (resident, pose) in self.animals.iter_mut().zip(&mut self.poses) {
            let (placement, [velocity, acceleration]) = resident.walk.at(time);
            let kind = &self.species[resident.species];
            resident.placement = placement * onto_ground(kind);
            let rig = kind.rig();
            let seconds = resident.walk.rounds(time, rig.stride) * f64::from(rig.walk.seconds());
            pose.set(&rig.skeleton, &rig.walk, seconds);
            resident.lean = self.forces.lean(velocity, acceleration)?;
            let bounds = rig.bounds.posed(pose, &fur);
            self.scene.set_transform(resident.id, resident.placement).map_err(failed)?;
            self.scene.set_bounds(resident.id, bounds).map_err(failed)?;
        }
        Ok(())
    }

    /// How an animal of a herd stands; `None` for others, which stand as modelled.
    pub fn pose(&self, animal: usize) -> Option<&Pose> {
        self.poses.get(animal)
    }

    /// How the strands of an animal lean.
    pub fn lean(&self, animal: usize) -> Lean {
        self.animals.get(animal).map_or(Lean::default(), |a| a.lean)
    }

    /// The species.
    pub fn species(&self) -> &[Animal] {
        &self.species
    }

    /// The animals.
    pub fn animals(&self) -> &[Resident] {
        &self.animals
    }

    /// The walls.
    pub fn walls(&self) -> &[Aabb] {
        &self.walls
    }

    /// The ground.
    pub fn ground(&self) -> Aabb {
        self.ground
    }

    /// What an object of the scene is; `None` for ids that are not of this field.
    pub fn kind(&self, id: ObjectId) -> Option<Kind> {
        let number = self.scene.user_data(id).ok()?;
        Some(match number {
            u64::MAX => Kind::Ground,
            wall if wall >> 32 == 1 => Kind::Wall((wall - (1 << 32)) as usize),
            animal => Kind::Animal(animal as usize),
        })
    }

    /// An eye on a path through the field and the direction in which it looks, for a share of the
    /// path, 0 to 1.
    pub fn eye(&self, share: f32) -> (Vec3, Vec3) {
        let edge = self.ground.max.x - LOT;
        let share = if share.is_finite() { share } else { 0.0 };
        let (start, end) = (Vec3::new(-LOT * 0.6, 1.3, -LOT * 0.6), Vec3::new(edge * 0.5, 1.3, edge * 0.45));
        let angle = std::f32::consts::FRAC_PI_4 + 0.5 * (share * TAU).sin();
        (start.lerp(end, share), Vec3::new(angle.cos(), -0.12, angle.sin()).normalize())
    }
}

/// From the space of a species' meshes to where it stands on the ground at 0.
fn onto_ground(kind: &Animal) -> Affine3A {
    Affine3A::from_translation(Vec3::Y * -kind.aabb().min.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_and_acceleration_are_those_of_the_placement() {
        let walk = Walk { center: Vec3::new(3.0, 0.0, 5.0), radius: 0.5, turn: [1.3, 0.4], scale: 0.9 };
        let at = |time: f64| Vec3::from(walk.at(time).0.translation);
        let h = 0.01;
        for step in 0..20 {
            let time = f64::from(step) * 0.3;
            let (placement, [velocity, acceleration]) = walk.at(time);
            let way = (at(time + h) - at(time - h)) / (2.0 * h as f32);
            let change = (at(time + h) - 2.0 * at(time) + at(time - h)) / (h * h) as f32;
            assert!(velocity.distance(way) < 1e-2 && acceleration.distance(change) < 5e-2, "{time}");
            let ahead = placement.transform_vector3(Vec3::X).normalize();
            assert!(ahead.distance(velocity.normalize()) < 1e-4, "it looks where it goes");
        }
        // Feet go as fast as the ground below: one round for each stride.
        assert!((walk.rounds(2.0, 0.5) - walk.rounds(1.0, 0.5) - 0.65 / 0.45).abs() < 1e-6);
    }
}
