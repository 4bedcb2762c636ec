//! Levels from test scenes and glTF files.

use std::collections::BTreeSet;
use std::path::Path;

use casca::glam::{DVec3, Vec3};
use casca::{Aabb, Scene};
use casca_bake::{BakeError, Baker, Cells, Progress, bounds_of};
use casca_scenes::drive::Driver;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::import::{self, ImportError};
use casca_scenes::world::{GridHint, Motion, Object, Source, World};
use casca_walls::{Span, Walls};

use crate::error::ServerError;
use crate::numeric::LEAST_WALL;
use crate::space::span_of;

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

/// Cells are baked so far beside bodies on the path, in metres: as far as eyes and entities may be
/// expected, at 5 m/s and a latency of a tenth of a second.
const BESIDE: f64 = 0.8;

/// The least edge of a cell, in metres: a body has points in a few hundred of these.
const LEAST_CELL: f32 = 0.25;

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
    /// Cells are too small.
    #[error("the edge of a cell must be {LEAST_CELL} m at least, not {0} m")]
    Cell(f32),
    /// A bake ended early.
    #[error(transparent)]
    Bake(#[from] BakeError),
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
    /// Which cells along the path see each other, if that was found ahead of time: a file for
    /// [`VisibilityServer::set_baked`](crate::VisibilityServer::set_baked).
    pub baked: Option<Vec<u8>>,
    /// What its file says: tools show the warnings. Its origin is added to the coordinates of all
    /// that is here, and of all that the server is told and tells, for those of the file.
    pub source: Source,
    grid: GridHint,
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
    /// A generated scene by its name, or a glTF file.
    ///
    /// # Errors
    /// Refuses other names, files that cannot be read, and those without a camera that moves.
    pub fn open(name: &str) -> Result<Self, LevelError> {
        if let Ok(kind) = name.parse::<SceneKind>() {
            let down = if kind == SceneKind::Rooms { BODY[1] } else { SHORT };
            let options = SceneOptions { frames: FRAMES, ..SceneOptions::default() };
            return Self::of(build(kind, &options), down);
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
            let b = bounds_of(&object.shape);
            let blocks = (b.max - b.min).length() < LARGEST_IN_THE_WAY && is_in_the_way(&b, &path, down);
            object.motion == Motion::Static && !blocks
        });
        let objects = std::mem::take(&mut world.objects);
        world.objects = objects.iter().filter(hides).cloned().collect();
        // Walls are tested by themselves: cells need not be thinner.
        let cell = world.grid.cell.max(0.25);
        let scene = Driver::new(&world, cell, |_| ())?.scene;
        let track = Track { path, down };
        Ok(Self {
            name: world.name,
            scene,
            objects,
            track,
            baked: None,
            source: world.source,
            grid: world.grid,
        })
    }

    /// Finds which cells along the path see each other, for [`Level::baked`]. `edge` is that of a
    /// cell, in metres; `queries` as for [`casca_bake::Finder::new`].
    ///
    /// # Errors
    /// Refuses an edge of less than 0.25 m or that makes too many cells, and stops if the progress
    /// says so.
    pub fn bake(
        &self,
        edge: f32,
        queries: u32,
        threads: usize,
        progress: &mut Progress,
    ) -> Result<Vec<u8>, LevelError> {
        if edge.is_nan() || edge < LEAST_CELL {
            return Err(LevelError::Cell(edge));
        }
        let occluders: Vec<Object> = self.objects.iter().filter(hides).cloned().collect();
        let walls = Walls::of(&self.scene, LEAST_WALL);
        let (cells, numbers) = self.track.cells(&walls, edge);
        let level = casca_bake::Level::of(&occluders, self.grid, None, false)?;
        let level = level.cell_to_cell(&cells, &numbers)?;
        let baker = Baker::of(&level, cells, &numbers, queries);
        let sets = baker.run(threads, None, progress)?;
        Ok(sets.finish().map_err(BakeError::from)?)
    }
}

impl Track {
    /// The cells in which bodies on the path and beside it may have points, and eyes. What lies
    /// behind walls is left out: the space under a floor sees all that is under it.
    fn cells(&self, walls: &Walls, edge: f32) -> (Cells, Vec<u32>) {
        let reached = |&eye: &Vec3| {
            let body = span_of(&self.body(eye));
            let grown = Span { min: body.min - BESIDE, max: body.max + BESIDE };
            walls.reached(&body, grown)
        };
        let all: Vec<Span> = self.path.iter().map(reached).collect();
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = all.iter().fold(none, |(a, b), span| (a.min(span.min), b.max(span.max)));
        // The grid ends where they do.
        let counts = ((high - low) / f64::from(edge)).ceil().max(DVec3::ONE);
        let size = ((high - low) / counts).to_array();
        let dims = counts.to_array().map(|n| n as u32);
        let cells = Cells { low: low.to_array(), size, dims, origin: [0.0; 3] };
        let boxes = all.iter().filter_map(|span| cells.of_box(span.min.to_array(), span.max.to_array()));
        let numbers: BTreeSet<u32> = boxes.flat_map(|all| cells.numbers(all)).collect();
        (cells, numbers.into_iter().collect())
    }

    /// From side to side of the body around an eye, at the height of the eye.
    pub fn across(&self, eye: Vec3) -> [[Vec3; 2]; 2] {
        [Vec3::X, Vec3::Z].map(|side| [eye - side * BODY[0], eye + side * BODY[0]])
    }

    /// The box around a bot whose eye is at a place.
    pub fn body(&self, eye: Vec3) -> Aabb {
        let [half, _, up] = BODY;
        Aabb::new(eye - Vec3::new(half, self.down, half), eye + Vec3::new(half, up, half))
    }
}

/// Whether an object is one of the occluders of the server.
fn hides(object: &&Object) -> bool {
    let b = bounds_of(&object.shape);
    object.occludes && (b.max - b.min).length() >= LEAST_OCCLUDER
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

/// Whether a bot on the path may touch a box.
fn is_in_the_way(b: &Aabb, path: &[Vec3], down: f32) -> bool {
    let room = Vec3::new(CLEARANCE, BODY[2], CLEARANCE);
    path.iter().any(|&eye| {
        let (min, max) = (eye - room.with_y(down), eye + room);
        b.min.cmple(max).all() && b.max.cmpge(min).all()
    })
}
