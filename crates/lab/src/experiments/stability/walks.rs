//! Walks through the procedural scenes, and cases of them: cameras that tremble, worlds far from
//! the origin, views at their limits.

use glam::camera::rh::proj::directx::{perspective, perspective_infinite_reverse};
use glam::{Mat4, Quat, Vec3};

use super::case::{ASPECT, Case, Shot, dice, placed, plain, still, through};
use crate::experiments::{Lab, LabError};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::{Camera, FRAME_SECONDS, Object, Shape};

/// Frames of a whole walk.
const WALK: usize = 150;

/// Some frames of the walk through a procedural scene.
pub(super) struct Walk {
    pub(super) objects: Vec<Object>,
    pub(super) cell: f32,
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
        let cell = world.grid.cell;
        Ok(Self { objects: world.objects, cell, frames, cameras, moves })
    }

    /// The walk itself.
    pub(super) fn case(&self, name: impl Into<String>) -> Case {
        let shots = self.cameras.iter().zip(&self.moves).zip(&self.frames);
        let shots = shots.map(|((&camera, moves), &frame)| Shot {
            camera,
            moves: moves.clone(),
            time: frame as f64 * FRAME_SECONDS,
        });
        Case::new(name, self.objects.clone(), self.cell, shots.collect())
    }

    /// Other cameras in the scene as it stands in the first frame.
    pub(super) fn still(&self, name: impl Into<String>, cameras: impl IntoIterator<Item = Camera>) -> Case {
        Case::new(name, self.objects.clone(), self.cell, still(cameras))
    }
}

/// Metres and radians.
const AMPLITUDES: [f32; 7] = [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];
/// Places of each scene from which it is seen.
const PLACES: usize = 4;
/// The scenes.
const JITTERED: [SceneKind; 2] = [SceneKind::Spheres, SceneKind::Rooms];

/// Frames at each place.
fn frames(lab: &Lab) -> usize {
    lab.pick(16, 3)
}

/// Each scene under each amplitude.
pub(super) fn jitter(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for kind in JITTERED {
        let walk = Walk::new(kind, lab.seed, PLACES)?;
        for amplitude in AMPLITUDES {
            // The same directions at every amplitude.
            let mut dice = dice(lab.seed, 1);
            let bases = walk.cameras.iter().flat_map(|base| std::iter::repeat_n(base, frames(lab)));
            let cameras: Vec<Camera> = bases
                .map(|base| {
                    let (step, turn) = (dice.ball() * amplitude, dice.ball() * amplitude);
                    placed(base, base.eye + step, Quat::from_scaled_axis(turn))
                })
                .collect();
            let name = format!("{}, jitter of {} m and rad", kind.name(), plain(amplitude));
            let case = walk.still(name, cameras);
            cases.push(case);
        }
    }
    Ok(cases)
}

/// Metres along each axis, by scene.
const OFFSETS: [(SceneKind, &[f32]); 2] =
    [(SceneKind::Spheres, &[0.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7]), (SceneKind::Rooms, &[0.0, 1e5, 1e7])];

/// Each scene at each offset. What is tested is the geometry as rounded to single precision.
pub(super) fn offset(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for (kind, offsets) in OFFSETS {
        let walk = Walk::new(kind, lab.seed, lab.pick(6, 2))?;
        for &offset in offsets {
            let by = Vec3::splat(offset);
            let case = walk.case(format!("{}, {} m from the origin", kind.name(), plain(offset)));
            let shots = case.shots.into_iter().map(|s| Shot {
                camera: placed(&s.camera, s.camera.eye + by, Quat::IDENTITY),
                moves: s.moves.iter().map(|(i, shape)| (*i, shape.moved(by))).collect(),
                time: s.time,
            });
            let mut case = Case { shots: shots.collect(), ..case };
            for object in &mut case.objects {
                object.shape = object.shape.moved(by);
            }
            cases.push(case);
        }
    }
    Ok(cases)
}

/// Fields of view, planes and pictures at their limits.
pub(super) fn views(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for kind in [SceneKind::Spheres, SceneKind::City] {
        let walk = Walk::new(kind, lab.seed, lab.pick(6, 2))?;
        let scene = kind.name();
        let mut add = |name: &str, projection: Mat4, turn: Quat| {
            let case = walk.case(format!("{scene}, {name}"));
            let shots = case.shots.into_iter();
            let shots = shots
                .map(|s| Shot { camera: placed(&through(&s.camera, projection), s.camera.eye, turn), ..s });
            cases.push(Case { shots: shots.collect(), ..case });
        };
        let of = |degrees: f32, aspect: f32, near: f32, far: f32| {
            perspective(degrees.to_radians(), aspect, near, far)
        };
        add("60 degrees high", of(60.0, ASPECT, 0.1, 400.0), Quat::IDENTITY);
        for degrees in [179.0, 150.0, 5.0, 1.0, 0.1] {
            let unit = if degrees == 1.0 { "degree" } else { "degrees" };
            add(&format!("{degrees} {unit} high"), of(degrees, ASPECT, 0.1, 400.0), Quat::IDENTITY);
        }
        if kind == SceneKind::Spheres {
            add("10 times as wide as high", of(20.0, 10.0, 0.1, 400.0), Quat::IDENTITY);
            add("10 times as high as wide", of(120.0, 0.1, 0.1, 400.0), Quat::IDENTITY);
            add("planes at 1e-4 and 1e6 m", of(60.0, ASPECT, 1e-4, 1e6), Quat::IDENTITY);
            add("near plane at 5 m", of(60.0, ASPECT, 5.0, 400.0), Quat::IDENTITY);
            let reversed = perspective_infinite_reverse(60f32.to_radians(), ASPECT, 0.1);
            add("reversed depth without a far plane", reversed, Quat::IDENTITY);
            add(
                "turned about all axes",
                of(60.0, ASPECT, 0.1, 400.0),
                Quat::from_xyzw(0.4, 0.3, 0.5, 0.7).normalize(),
            );
        }
    }
    Ok(cases)
}
