//! Levels from test scenes and glTF files.

use std::path::Path;

use casca::glam::Vec3;
use casca::{Aabb, Scene};
use casca_scenes::drive::{Driver, grid_for};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::import::{self, ImportError};
use casca_scenes::world::{Motion, Object, Shape, World};

use crate::error::ServerError;

/// Frames of the path of a generated scene: many, so that it is smooth.
const FRAMES: usize = 4000;

/// Occluders of a smaller diagonal are left out of the server's level, in metres: they hide hardly
/// an entity, and each costs time in each query.
const LEAST_OCCLUDER: f32 = 2.0;

/// Objects of a smaller diagonal that stand in the way of bots are cleared away, in metres.
const LARGEST_IN_THE_WAY: f32 = 3.5;

/// How far bots keep from what is not cleared away, in metres.
const CLEARANCE: f32 = 0.6;

/// The body of a bot around its eye: half its width, how far it goes down, and up.
const BODY: [f32; 3] = [0.3, 1.5, 0.15];

/// Where the height of the eye above the ground is not known, bodies are shorter.
const SHORT: f32 = 0.4;

/// Why a level cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LevelError {
    /// Neither the name of a generated scene nor a file.
    #[error("{0} is neither a generated scene nor a .glb or .gltf file")]
    Name(String),
    /// The file cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// casca refuses an object.
    #[error(transparent)]
    Casca(#[from] casca::Error),
    /// There is no path for bots: the file has no camera that moves.
    #[error("there is no path for bots in {0}: its camera does not move")]
    NoPath(String),
    /// The server refuses the level or what is in it.
    #[error(transparent)]
    Server(#[from] ServerError),
}

/// A level, with the path that its bots run on.
#[derive(Debug)]
pub struct Level {
    /// Its name, or that of its file.
    pub name: String,
    /// What hides, for the server.
    pub scene: Scene,
    /// All that stands in it, for exact visibility.
    pub objects: Vec<Object>,
    /// Where bots run.
    pub track: Track,
}

/// Where bots run.
#[derive(Debug, Clone)]
pub struct Track {
    /// Where eyes can be, from one end to the other. Steps are short.
    pub path: Vec<Vec3>,
    /// How far bodies go down from the eye, in metres.
    down: f32,
}

impl Level {
    /// The level of rooms that needs no file.
    ///
    /// # Errors
    /// None are known; as [`Level::open`].
    pub fn rooms() -> Result<Self, LevelError> {
        Self::of(build(SceneKind::Rooms, &options()), BODY[1])
    }

    /// A generated scene by its name, or a glTF file.
    ///
    /// # Errors
    /// Refuses other names, files that cannot be read, and those without a camera that moves.
    pub fn open(name: &str) -> Result<Self, LevelError> {
        if let Ok(kind) = name.parse::<SceneKind>() {
            let down = if kind == SceneKind::Rooms { BODY[1] } else { SHORT };
            return Self::of(build(kind, &options()), down);
        }
        let ending = Path::new(name).extension().unwrap_or_default();
        if !ending.eq_ignore_ascii_case("glb") && !ending.eq_ignore_ascii_case("gltf") {
            return Err(LevelError::Name(name.to_owned()));
        }
        Self::of(import::load(Path::new(name))?, SHORT)
    }

    fn of(mut world: World, down: f32) -> Result<Self, LevelError> {
        let frames = world.frames.max(2);
        let path: Vec<Vec3> = (0..frames).map(|frame| world.camera(frame, 1.0).eye).collect();
        let mut path = resampled(&path);
        path.dedup();
        if path.len() < 2 {
            return Err(LevelError::NoPath(world.name));
        }
        world.objects.retain(|object| {
            let b = bounds(object);
            let blocks = (b.max - b.min).length() < LARGEST_IN_THE_WAY && is_in_the_way(&b, &path, down);
            object.motion == Motion::Static && !blocks
        });
        let objects = std::mem::take(&mut world.objects);
        let hides = |object: &&Object| {
            let b = bounds(object);
            object.occludes && (b.max - b.min).length() >= LEAST_OCCLUDER
        };
        world.objects = objects.iter().filter(hides).cloned().collect();
        let mut grid = grid_for(&world.grid, None)?;
        // Walls are tested by themselves: cells need not be thinner.
        let coarse =
            grid_for(&casca_scenes::world::GridHint { cell: grid.cell.max(0.25), ..world.grid }, None);
        grid = coarse.unwrap_or(grid);
        let scene = Driver::new(&world, &grid, |_| ())?.scene;
        Ok(Self { name: world.name, scene, objects, track: Track { path, down } })
    }
}

impl Track {
    /// The sides of the body around an eye, at the height of the eye.
    pub fn sides(&self, eye: Vec3) -> [Vec3; 4] {
        [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z].map(|side| eye + side * BODY[0])
    }

    /// The box around a bot whose eye is at a place.
    pub fn body(&self, eye: Vec3) -> Aabb {
        let [half, _, up] = BODY;
        Aabb::new(eye - Vec3::new(half, self.down, half), eye + Vec3::new(half, up, half))
    }
}

fn options() -> SceneOptions {
    SceneOptions { frames: FRAMES, ..SceneOptions::default() }
}

/// A path with a step of 5 cm at most.
fn resampled(path: &[Vec3]) -> Vec<Vec3> {
    let mut all = Vec::new();
    for pair in path.windows(2) {
        let steps = (pair[0].distance(pair[1]) / 0.05).ceil().clamp(1.0, 10_000.0) as usize;
        all.extend((0..steps).map(|i| pair[0].lerp(pair[1], i as f32 / steps as f32)));
    }
    all.extend(path.last());
    all
}

fn bounds(object: &Object) -> Aabb {
    match &object.shape {
        Shape::Sphere { center, radius } => Aabb::from_center(*center, Vec3::splat(*radius)),
        Shape::Box { min, max } => Aabb::new(*min, *max),
        Shape::Mesh { mesh, transform } => {
            let (min, max) = mesh.bounds(transform);
            Aabb::new(min, max)
        }
    }
}

/// Whether a bot on the path may touch a box.
fn is_in_the_way(b: &Aabb, path: &[Vec3], down: f32) -> bool {
    let room = Vec3::new(CLEARANCE, BODY[2], CLEARANCE);
    path.iter().any(|&eye| {
        let (min, max) = (eye - room.with_y(down), eye + room);
        b.min.cmple(max).all() && b.max.cmpge(min).all()
    })
}
