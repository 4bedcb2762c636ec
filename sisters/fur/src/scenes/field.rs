//! Many furry animals among walls: a scene of casca for tests and programs.

use std::f32::consts::TAU;

use crate::error::Error;
use crate::skin::{Ending, Pose};
use crate::strands::{Forces, Fur, Lean};
use crate::visibility::{furry_object, inner_ball};
use casca::{Aabb, GridSpec, ObjectDesc, ObjectId, Occluder, Scene};
use glam::{Affine3A, UVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::scenes::animals::Animal;
use crate::scenes::species::Species;
use crate::scenes::walk::Walk;

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
    /// The number of its species: its meshes and its fur.
    pub species: usize,
    /// From the space of its meshes to the world.
    pub placement: Affine3A,
    walk: Walk,
    lean: Lean,
}

/// A square field of lots with walls between some of them, and animals on the lots. y is up, the
/// ground is at 0; one unit is the length of an animal.
pub struct Field {
    /// The scene, for queries.
    pub scene: Scene,
    species: Vec<(Species, Fur)>,
    /// By species, from the space of its meshes, posed in a herd, to units.
    places: Vec<Affine3A>,
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
    /// A field of `count` animals, 1 to 100,000, of 1 to 16 species, each with its fur: see
    /// [`generated`]. Each animal is of one of them, by the seed. Animals that stand hide others by
    /// a ball inside all levels of detail, if their meshes are closed.
    ///
    /// With `forces` it is a herd: all animals walk on their legs, their strands lean, and only
    /// walls hide. Bounds hold for the whole walk, so that a step moves an object and changes no
    /// bounds.
    ///
    /// # Errors
    /// Refuses counts and longest bends out of range, a herd of a species that cannot walk, and
    /// what casca refuses.
    pub fn new(
        count: usize,
        species: Vec<(Species, Fur)>,
        seed: u64,
        forces: Option<Forces>,
    ) -> Result<Self, Error> {
        Error::check_range("the number of animals", count as f64, 1.0, MOST as f64)?;
        Error::check_range("the number of species", species.len() as f64, 1.0, MOST_SPECIES as f64)?;
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let hides = species.iter().map(|(kind, _)| if forces.is_some() { Ok(None) } else { ball_in(kind) });
        let hides = hides.collect::<Result<Vec<Option<Occluder>>, Error>>()?;
        let place = |(kind, _): &(Species, Fur)| match forces {
            Some(_) => kind.places().posed,
            None => kind.places().rest,
        };
        let places: Vec<Affine3A> = species.iter().map(place).collect();
        let walk_bounds =
            |forces: Forces| species.iter().map(move |(kind, fur)| kind.bounds_of_walk(fur, forces));
        let whole = forces.map(|f| walk_bounds(f).collect::<Result<Vec<Aabb>, Error>>()).transpose()?;
        let lots = (count.div_ceil(CROWD) as f64).sqrt().ceil() as usize;
        let edge = lots as f32 * LOT;
        let ground = Aabb::new(Vec3::new(-LOT, -0.5, -LOT), Vec3::new(edge + LOT, 0.0, edge + LOT));
        let refused = |what| move |source| Error::Scene { what, source };
        // Cells of half a unit, or coarser for large fields.
        let cell = 0.5 * (edge / 200.0).max(1.0);
        let min = Vec3::new(-LOT - 1.0, -1.0, -LOT - 1.0);
        let size = Vec3::new(edge + 2.0 * LOT + 2.0, WALL[1] + 2.0, edge + 2.0 * LOT + 2.0);
        let dims = (size / cell).ceil().as_uvec3().max(UVec3::ONE);
        let mut scene = Scene::new(&GridSpec { min, cell, dims }).map_err(refused("grid of the field"))?;
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
            let walks = random.random_bool(0.5) || forces.is_some();
            let walk = Walk {
                center,
                radius: if walks { 0.3 } else { 0.0 },
                turn: [random.random_range(0.5..1.5), random.random_range(0.0..TAU)],
                scale: random.random_range(0.75..1.0),
            };
            let placement = walk.at(0.0).0 * places[kind];
            let hides = hides[kind].clone();
            let desc = match &whole {
                Some(whole) => ObjectDesc::dynamic(whole[kind]).placed(placement),
                None => furry_object(species[kind].0.aabb(), &species[kind].1, hides, placement, walks)?,
            };
            let id = scene.insert(desc.user_data(number as u64)).map_err(refused("animal"))?;
            animals.push(Resident { id, species: kind, placement, walk, lean: Lean::default() });
        }
        let mut field = Self {
            scene,
            species,
            places,
            animals,
            walls,
            ground,
            poses: Vec::new(),
            forces: forces.unwrap_or_default(),
        };
        if forces.is_some() {
            let rest = |(kind, _): &(Species, Fur)| Ok(Pose::rest(&kind.walker()?.skeleton));
            let rests = field.species.iter().map(rest).collect::<Result<Vec<Pose>, Error>>()?;
            field.poses = field.animals.iter().map(|resident| rests[resident.species].clone()).collect();
            field.walk(0.0)?;
        }
        Ok(field)
    }

    /// Moves the animals that walk to where they are at a time in seconds; at 0 they are where they
    /// were made.
    ///
    /// # Errors
    /// Refuses times that are not finite.
    pub fn walk(&mut self, time: f64) -> Result<(), Error> {
        Error::check_range("the time in seconds", time, -1e9, 1e9)?;
        let failed = |source| Error::Scene { what: "step of an animal", source };
        for (number, resident) in self.animals.iter_mut().enumerate().filter(|(_, r)| r.walk.radius > 0.0) {
            let (placement, [velocity, acceleration]) = resident.walk.at(time);
            resident.placement = placement * self.places[resident.species];
            if let Some(pose) = self.poses.get_mut(number) {
                let rig = self.species[resident.species].0.walker()?;
                let seconds = resident.walk.rounds(time, rig.stride) * f64::from(rig.walk.seconds());
                pose.set(&rig.skeleton, &rig.walk, seconds, Ending::Loop);
                resident.lean = self.forces.lean(velocity, acceleration)?;
            }
            self.scene.set_transform(resident.id, resident.placement).map_err(failed)?;
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

    /// The species: meshes and fur.
    pub fn species(&self) -> &[(Species, Fur)] {
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

    /// The height of an animal's fur in world units.
    pub fn fur_height(&self, animal: usize) -> f32 {
        let Some(resident) = self.animals.get(animal) else { return 0.0 };
        let (kind, fur) = &self.species[resident.species];
        fur.height * kind.places().scale * resident.walk.scale
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

/// A ball inside all levels of detail; none for meshes with holes, through which one could look.
fn ball_in(kind: &Species) -> Result<Option<Occluder>, Error> {
    let levels: Vec<_> = kind.levels().iter().collect();
    if levels.iter().any(|mesh| mesh.open_edges() > 0) {
        return Ok(None);
    }
    Ok(inner_ball(&levels)?.map(Occluder::from))
}

/// Generated species of a seed, 1 to 16, with their furs: `fur` makes one for an animal of a radius.
///
/// # Errors
/// Refuses other counts, and what `fur` refuses.
pub fn generated(
    count: usize,
    seed: u64,
    fur: impl Fn(f32) -> Result<Fur, Error>,
) -> Result<Vec<(Species, Fur)>, Error> {
    Error::check_range("the number of species", count as f64, 1.0, MOST_SPECIES as f64)?;
    let make = |i: usize| {
        let animal = Animal::new(seed.wrapping_mul(31).wrapping_add(i as u64), DETAIL)?;
        let fur = fur(animal.radius())?;
        Ok((Species::from(&animal), fur))
    };
    (0..count).map(make).collect()
}

#[cfg(test)]
mod tests {
    use casca::{Query, View};

    use super::*;

    fn fur(radius: f32) -> Result<Fur, Error> {
        Fur::for_radius(radius, 0.08, 0.2)
    }

    fn made(count: usize, species: usize, seed: u64) -> Result<Field, Error> {
        Field::new(count, generated(species, seed, fur)?, seed, None)
    }

    /// Whether a segment meets a box.
    fn meets(from: Vec3, to: Vec3, aabb: &Aabb) -> bool {
        let way = to - from;
        let (a, b) = ((aabb.min - from) / way, (aabb.max - from) / way);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        enter <= leave && leave >= 0.0 && enter <= 1.0
    }

    #[test]
    fn walls_hide_most_animals_and_no_tip_in_sight() {
        let mut field = made(200, 2, 3).unwrap();
        let mut query = Query::new();
        let (mut seen, mut tips) = (0, 0);
        for frame in 0..4 {
            field.scene.begin_frame(f64::from(frame)).unwrap();
            field.walk(f64::from(frame)).unwrap();
            let (eye, _) = field.eye(frame as f32 / 4.0);
            let visible = query.run(&field.scene, &View::omnidirectional(eye).unwrap()).visible().to_vec();
            field.scene.end_frame([query.pvs()]).unwrap();
            let animal = |id: &&ObjectId| matches!(field.kind(**id), Some(Kind::Animal(_)));
            seen += visible.iter().filter(animal).count();
            for resident in &field.animals {
                let (animal, fur) = &field.species[resident.species];
                for v in animal.levels()[3].vertices() {
                    let tip = resident.placement.transform_point3(fur.extruded(v.position, v.normal, 1.0));
                    let hidden = |aabb: &Aabb| meets(eye, tip, aabb);
                    // In sight if no wall and no whole animal is in the way.
                    let others = field.animals.iter().filter(|a| a.id != resident.id);
                    let near = |a: &&Resident| {
                        let way = tip - eye;
                        let middle = Vec3::from(a.placement.translation);
                        let t = ((middle - eye).dot(way) / way.length_squared()).clamp(0.0, 1.0);
                        (eye + way * t).distance(middle) < 1.2
                    };
                    if !field.walls.iter().any(hidden)
                        && !hidden(&field.ground)
                        && !others.clone().any(|a| near(&a))
                    {
                        tips += 1;
                        assert!(visible.contains(&resident.id), "a tip at {tip} is lost");
                    }
                }
            }
        }
        println!("{seen} of 800 animals found visible, {tips} tips in sight");
        assert!(seen < 400 && tips > 300);
    }

    #[test]
    fn fields_repeat_and_know_their_objects() {
        let make = |seed| made(31, 3, seed).unwrap();
        let (a, b, c) = (make(1), make(1), make(2));
        let places = |f: &Field| f.animals.iter().map(|a| a.placement).collect::<Vec<_>>();
        assert!(places(&a) == places(&b) && a.walls == b.walls);
        assert!(places(&a) != places(&c));
        assert_eq!(a.scene.len(), 31 + 1 + a.walls().len());
        let kinds: Vec<_> = a.scene.ids().map(|id| a.kind(id).unwrap()).collect();
        let count = |f: fn(&Kind) -> bool| kinds.iter().filter(|k| f(k)).count();
        assert_eq!(count(|k| matches!(k, Kind::Animal(_))), 31);
        assert_eq!(count(|k| matches!(k, Kind::Wall(_))), a.walls().len());
        for (number, resident) in a.animals().iter().enumerate() {
            assert_eq!(a.kind(resident.id), Some(Kind::Animal(number)));
            // Feet on the ground, within the lot.
            let (kind, _) = &a.species()[resident.species];
            let feet = resident.placement.transform_point3(Vec3::Y * kind.aabb().min.y);
            assert!(feet.y.abs() < 1e-5 && feet.x > 0.0 && feet.z > 0.0);
            assert!(a.fur_height(number) > 0.0);
        }
        assert_eq!((c.kind(a.animals()[0].id), a.fur_height(99)), (None, 0.0));
    }

    #[test]
    fn bad_fields_are_refused() {
        for (count, species) in [(0, 1), (MOST + 1, 1), (1, 0), (1, 17)] {
            assert!(matches!(made(count, species, 1), Err(Error::Range { .. })));
        }
        assert!(generated(1, 1, |r| Fur::for_radius(-r, 0.1, 0.1)).is_err());
        let mut field = made(2, 1, 1).unwrap();
        assert!(field.walk(f64::NAN).is_err());
        assert!(field.eye(f32::NAN).0.is_finite());
    }
}
