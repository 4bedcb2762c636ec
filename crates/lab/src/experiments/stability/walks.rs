//! Cases from the procedural scenes.

use casca::GridSpec;
use glam::Vec3;

use super::case::{ASPECT, Case, Shot, still};
use crate::experiments::LabError;
use casca_scenes::drive::grid_for;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::{Camera, FRAME_SECONDS, Object, Shape};

/// Frames of a whole walk.
const WALK: usize = 150;

/// Some frames of the walk through a procedural scene.
pub(super) struct Walk {
    pub(super) objects: Vec<Object>,
    pub(super) grid: GridSpec,
    pub(super) frames: Vec<usize>,
    pub(super) cameras: Vec<Camera>,
    /// Shapes of the objects that move, by frame.
    pub(super) moves: Vec<Vec<(usize, Shape)>>,
}

impl Walk {
    /// Frames spread evenly over the walk.
    pub(super) fn new(kind: SceneKind, seed: u64, frames: usize) -> Result<Self, LabError> {
        let mut world = build(kind, &SceneOptions { seed, frames: WALK, ..SceneOptions::default() });
        let frames: Vec<usize> = (0..frames).map(|i| (2 * i + 1) * WALK / (2 * frames.max(1))).collect();
        let mut moves = Vec::new();
        for &frame in &frames {
            let moved = world.set_frame(frame);
            moves.push(moved.into_iter().map(|i| (i, world.objects[i].shape.clone())).collect());
        }
        let cameras = frames.iter().map(|&f| world.camera(f, ASPECT)).collect();
        world.set_frame(frames.first().copied().unwrap_or(0));
        let grid = grid_for(&world.grid, None)?;
        Ok(Self { objects: world.objects, grid, frames, cameras, moves })
    }

    /// The walk itself.
    pub(super) fn case(&self, name: impl Into<String>) -> Case {
        self.timed(name, |i| self.frames[i] as f64 * FRAME_SECONDS)
    }

    /// The walk at other times of the clock.
    pub(super) fn timed(&self, name: impl Into<String>, time: impl Fn(usize) -> f64) -> Case {
        let shots = self.cameras.iter().zip(&self.moves).enumerate();
        let shots = shots.map(|(i, (&camera, moves))| Shot { camera, moves: moves.clone(), time: time(i) });
        Case::new(name, self.objects.clone(), self.grid, shots.collect())
    }

    /// Other cameras in the scene as it stands in the first frame.
    pub(super) fn still(&self, name: impl Into<String>, cameras: impl IntoIterator<Item = Camera>) -> Case {
        Case::new(name, self.objects.clone(), self.grid, still(cameras))
    }
}

/// A shape moved by an offset; its coordinates are rounded.
pub(super) fn shifted(shape: &Shape, by: Vec3) -> Shape {
    match shape {
        Shape::Sphere { center, radius } => Shape::Sphere { center: *center + by, radius: *radius },
        Shape::Box { min, max } => Shape::Box { min: *min + by, max: *max + by },
        mesh => mesh.clone(),
    }
}
