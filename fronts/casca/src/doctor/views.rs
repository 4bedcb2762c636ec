//! Where one may look at a level from: along the path of its camera, or from places on its floors.

use std::collections::HashMap;
use std::sync::Arc;

use casca_scenes::generated::{WALK_SECONDS, WalkOptions, walking};
use casca_scenes::random::Dice;
use casca_scenes::world::{Camera, Mesh, Object, Shape, World};
use casca_truth::oracle::RayOracle;
use glam::camera::rh::view::look_to_mat4;
use glam::{DVec3, Vec3};

use super::parts::document;

/// Width over height of all pictures.
pub const ASPECT: f32 = 16.0 / 9.0;
/// Frames in one place. They begin with a jump, after which some do not count.
pub const FRAMES: usize = 25;
/// Frames after a jump that do not count.
pub const SETTLE: usize = 5;
/// Places.
const PLACES: usize = 12;
/// Random points under which a floor is looked for.
const TRIES: usize = 2000;
/// The height of an eye over the floor, in metres, and at most this share of the height of a level.
const EYE: (f32, f32) = (1.7, 0.6);
/// Metres a second.
const SPEED: f32 = 1.5;
/// The walker looks this far to the left and the right, in radians, once in this many frames.
const GLANCE: (f32, f32) = (1.2, 40.0);
/// A floor is hit from above if the ray that meets what is drawn from there is as long, but for
/// this share: both go through the same triangle.
const SAME: f64 = 1e-6;
/// Directions on a level around an eye.
const AROUND: usize = 8;

/// Views of a level.
pub struct Views {
    /// All frames: [`FRAMES`] in each place.
    pub cameras: Vec<Camera>,
    /// Where they are, in words.
    pub from: String,
    /// Whether most have a ceiling.
    pub indoors: bool,
}

impl Views {
    /// Those of a world, whose objects stand still from now on.
    pub fn of(world: World, seed: u64) -> (World, Self) {
        let eye = |frame| world.camera(frame, ASPECT).eye;
        let own_camera = document(&world)["cameras"].is_array();
        let moves = (1..world.frames).any(|frame| eye(frame) != eye(0));
        let from_file = world.source.document.is_empty() || own_camera && moves;
        let options = WalkOptions { movers: 0, stretches: PLACES, frames: FRAMES, seed };
        let world = walking(world, ASPECT, &options);
        let solid = RayOracle::new(&blocking(&world.objects));
        let mut cameras: Vec<Camera> = (0..world.frames).map(|frame| world.camera(frame, ASPECT)).collect();
        let mut from = "along the path of its camera".to_owned();
        if !from_file {
            let level = Level { world: &world, drawn: RayOracle::new(&world.objects), solid: &solid };
            let places = level.places(seed);
            from = match places.len() {
                0 => "on a circle inside its box: no floor has room for a walker".to_owned(),
                n => format!("at {n} places on its floors, {:.2} m high", level.height()),
            };
            if !places.is_empty() {
                cameras = places.iter().flat_map(|place| level.walk(*place, cameras[0])).collect();
            }
        }
        let covered = |c: &&Camera| solid.first_hit(c.eye.as_dvec3(), DVec3::Y).is_some();
        let indoors = cameras.iter().filter(covered).count() * 2 > cameras.len();
        (world, Self { cameras, from, indoors })
    }
}

/// The objects with surfaces that stop a walker from both sides.
fn blocking(objects: &[Object]) -> Vec<Object> {
    let mut made: HashMap<*const Mesh, Arc<Mesh>> = HashMap::new();
    let mut objects = objects.to_vec();
    for object in &mut objects {
        if let Shape::Mesh { mesh, .. } = &mut object.shape {
            let solid = |mesh: &Mesh| Arc::new(Mesh { sides: Vec::new(), ..mesh.clone() });
            *mesh = made.entry(Arc::as_ptr(mesh)).or_insert_with(|| solid(mesh)).clone();
            object.occludes = true;
        }
    }
    objects
}

/// What a walker meets.
struct Level<'a> {
    world: &'a World,
    /// What is drawn opaque, from the sides from which it is.
    drawn: RayOracle,
    /// All surfaces, from both sides.
    solid: &'a RayOracle,
}

impl Level<'_> {
    fn height(&self) -> f32 {
        let grid = &self.world.grid;
        EYE.0.min((grid.max.y - grid.min.y) * EYE.1)
    }

    /// How far one can go from a point, at most `most`.
    fn free(&self, at: Vec3, direction: Vec3, most: f32) -> f32 {
        let hit = self.solid.first_hit(at.as_dvec3(), direction.as_dvec3());
        hit.map_or(most, |(_, way)| (way as f32).min(most))
    }

    /// An eye over the floor below a point, if there is room for a walker who is not inside of
    /// something, and how much of what is around it is near.
    fn eye(&self, point: Vec3) -> Option<(Vec3, usize)> {
        let (at, height) = (point.as_dvec3(), self.height());
        let (_, down) = self.solid.first_hit(at, DVec3::NEG_Y)?;
        let (_, drawn) = self.drawn.first_hit(at, DVec3::NEG_Y)?;
        let eye = point + Vec3::Y * (height - down as f32);
        let up = self.solid.first_hit(eye.as_dvec3(), DVec3::Y);
        let sky = self.drawn.first_hit(eye.as_dvec3(), DVec3::Y);
        // Inside of a solid, the surface overhead is seen from behind, and not drawn.
        let is_inside = up.is_some_and(|(_, way)| sky.is_none_or(|(_, drawn)| drawn > way * (1.0 + SAME)));
        let foot = eye - Vec3::Y * height * 0.9;
        let room = self.free(foot, Vec3::Y, height * 2.0) > height
            && self.around(eye, height).all(|way| way > height / 4.0);
        let walls = self.around(eye, f32::INFINITY).filter(|way| way.is_finite()).count();
        let enclosed = walls + if up.is_some() { AROUND } else { 0 };
        (drawn <= down * (1.0 + SAME) && !is_inside && room).then_some((eye, enclosed))
    }

    fn around(&self, eye: Vec3, most: f32) -> impl Iterator<Item = f32> + '_ {
        (0..AROUND)
            .map(move |i| self.free(eye, level(i as f32 * std::f32::consts::TAU / AROUND as f32), most))
    }

    /// Places for an eye: of those that random points find, the half with more around them, since
    /// roofs are no place to walk on.
    fn places(&self, seed: u64) -> Vec<Vec3> {
        let mut dice = Dice::new(seed, 7);
        let grid = &self.world.grid;
        let mut found: Vec<(Vec3, usize)> =
            (0..TRIES).filter_map(|_| self.eye(dice.point(grid.min, grid.max))).take(2 * PLACES).collect();
        found.sort_by_key(|(_, enclosed)| std::cmp::Reverse(*enclosed));
        found.truncate(found.len().div_ceil(2));
        found.into_iter().map(|(eye, _)| eye).collect()
    }

    /// A walk from a place, to where most room is, looking around.
    fn walk(&self, eye: Vec3, camera: Camera) -> Vec<Camera> {
        let (i, room) =
            self.around(eye, 1e6).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        let heading = i as f32 * std::f32::consts::TAU / AROUND as f32;
        let step = (SPEED * WALK_SECONDS as f32).min(room / 2.0 / FRAMES as f32);
        let frame = |frame: usize| {
            let glance = GLANCE.0 * (frame as f32 * std::f32::consts::TAU / GLANCE.1).sin();
            let eye = eye + level(heading) * step * frame as f32;
            Camera { eye, view: look_to_mat4(eye, level(heading + glance), Vec3::Y), ..camera }
        };
        (0..FRAMES).map(frame).collect()
    }
}

/// A direction on a level.
fn level(angle: f32) -> Vec3 {
    Vec3::new(angle.cos(), 0.0, angle.sin())
}
