//! A walker at 60 frames a second through any scene, in which nothing moves but new objects that
//! float about.

use std::f32::consts::{PI, TAU};

use glam::camera::rh::view::look_to_mat4;
use glam::{Mat4, Vec2, Vec3};

use super::motion::{Moving, Path, Way};
use super::parts::object;
use crate::random::Dice;
use crate::world::{Animation, Camera, Motion, Object, Shape, World};

/// Seconds between two frames of the walker.
pub const WALK_SECONDS: f64 = 1.0 / 60.0;
/// Metres a second.
const SPEED: f32 = 1.5;
/// The most that the walker turns in a second, in radians.
const TURN: f32 = PI / 2.0;
/// The walker looks this far to the left and the right, in radians, once in this many seconds.
const GLANCE: (f32, f32) = (1.0, 6.0);
/// The diagonal of a scene in which movers have their full size, in metres.
const FULL: f32 = 60.0;
/// Greatest radius of a mover, the farthest that it floats along an axis, and its greatest speed.
const MOVER: (f32, f32, f32) = (0.3, 1.5, 1.5);
/// Places that are tried for a mover.
const TRIES: usize = 100;

/// How long a walk is, and how many objects move around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WalkOptions {
    /// Spheres that float about; every second one hides others.
    pub movers: usize,
    /// The path of the scene is walked in this many places, evenly spread: long paths differ along
    /// their way.
    pub stretches: usize,
    /// Frames in each of these places.
    pub frames: usize,
    /// Seed of the movers.
    pub seed: u64,
}

/// Turns a scene into one where a person walks along its path at 1.5 m/s and looks around, turning
/// by at most 90 degrees a second. All its objects stand still as they are at frame 0; the movers
/// are new ones. In scenes smaller than 60 m across, movers are smaller and slower in proportion.
pub fn walking(mut world: World, aspect: f32, options: &WalkOptions) -> World {
    world.set_frame(0);
    let eyes: Vec<Vec3> = (0..world.frames.max(2)).map(|f| world.camera(f, aspect).eye).collect();
    let path = Path::new(&eyes);
    let cameras = cameras(&path, options);
    let unit = ((world.grid.max - world.grid.min).length() / FULL).min(1.0);
    for object in &mut world.objects {
        object.motion = Motion::Static;
    }
    let movers = movers(&mut world, &path, unit, options);
    let frames = cameras.len();
    let scene = world.animation;
    world.animation = Box::new(Walking { scene, movers, cameras });
    world.frames = frames;
    world
}

/// The eyes and directions of all frames.
fn cameras(path: &Path, options: &WalkOptions) -> Vec<(Vec3, Vec3)> {
    let step = SPEED * WALK_SECONDS as f32;
    let stretches = options.stretches.max(1);
    let mut all = Vec::with_capacity(stretches * options.frames);
    for stretch in 0..stretches {
        let start = path.length() * (stretch as f32 + 0.5) / stretches as f32;
        let mut yaw: Option<f32> = None;
        for frame in 0..options.frames.max(1) {
            let (eye, ahead) = there_and_back(path, start + frame as f32 * step);
            let heading = if ahead == Vec2::ZERO { yaw.unwrap_or(0.0) } else { ahead.to_angle() };
            let seconds = (frame as f64 * WALK_SECONDS) as f32;
            let target = heading + GLANCE.0 * (TAU * seconds / GLANCE.1).sin();
            let limit = TURN * WALK_SECONDS as f32;
            let now = yaw.map_or(target, |last| last + between(last, target).clamp(-limit, limit));
            yaw = Some(now);
            all.push((eye, Vec3::new(now.cos(), 0.0, now.sin())));
        }
    }
    all
}

/// The turn from one angle to another, between half a turn to the left and to the right.
fn between(from: f32, to: f32) -> f32 {
    (to - from + PI).rem_euclid(TAU) - PI
}

/// The place after a way along a path, which turns round at its ends, and the direction there as
/// seen from above.
fn there_and_back(path: &Path, way: f32) -> (Vec3, Vec2) {
    let length = path.length().max(f32::MIN_POSITIVE);
    let along = way.rem_euclid(2.0 * length);
    let (at, sign) = if along < length { (along, 1.0) } else { (2.0 * length - along, -1.0) };
    let reach = 0.05 * length.min(10.0);
    let ahead = path.at((at + reach).min(length)) - path.at((at - reach).max(0.0));
    (path.at(at), Vec2::new(ahead.x, ahead.z).normalize_or_zero() * sign)
}

/// Adds the movers around the height of the path, off the eye.
fn movers(world: &mut World, path: &Path, unit: f32, options: &WalkOptions) -> Vec<Moving> {
    let mut dice = Dice::new(options.seed, 99);
    let (radius, reach, speed) = (MOVER.0 * unit, MOVER.1 * unit, MOVER.2 * unit);
    let eyes = path.samples((path.length() / unit).ceil().clamp(1.0, 10_000.0) as usize);
    let heights =
        eyes.iter().map(|e| e.y).fold((f32::INFINITY, f32::NEG_INFINITY), |a, y| (a.0.min(y), a.1.max(y)));
    let margin = Vec3::splat(radius + reach);
    let (mut lo, mut hi) = (world.grid.min + margin, world.grid.max - margin);
    (lo.y, hi.y) = (lo.y.max(heights.0 - reach), hi.y.min(heights.1 + reach));
    let mut movers = Vec::with_capacity(options.movers);
    for i in 0..options.movers {
        let swing = Way::swing(&mut dice, Vec3::splat(reach * 0.5), speed);
        let radius = dice.range(0.5, 1.0) * radius;
        let free = |p: &Vec3| eyes.iter().all(|e| e.distance(*p) > 2.0 * radius + reach);
        let place = (0..TRIES).map(|_| dice.point(lo.min(hi), hi.max(lo))).find(free);
        let Some(center) = place else { continue };
        let mover = object("mover", Shape::Sphere { center, radius });
        world.objects.push(Object { occludes: i % 2 == 0, ..mover });
        movers.push(Moving::last(&mut world.objects, swing));
    }
    movers
}

struct Walking {
    /// For the projection of its camera.
    scene: Box<dyn Animation>,
    movers: Vec<Moving>,
    cameras: Vec<(Vec3, Vec3)>,
}

impl Animation for Walking {
    fn shapes(&self, frame: usize, set: &mut dyn FnMut(usize, Shape)) {
        let seconds = (frame as f64 * WALK_SECONDS) as f32;
        self.movers.iter().for_each(|m| set(m.index, m.shape(seconds)));
    }

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        let last = self.cameras.len().saturating_sub(1);
        let (eye, forward) = self.cameras.get(frame.min(last)).copied().unwrap_or((Vec3::ZERO, Vec3::NEG_Z));
        let view: Mat4 = look_to_mat4(eye, forward, Vec3::Y);
        Camera { eye, view, projection: self.scene.camera(0, aspect).projection }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated::{SceneKind, SceneOptions, build};

    const ASPECT: f32 = 16.0 / 9.0;

    fn options(movers: usize) -> WalkOptions {
        WalkOptions { movers, stretches: 3, frames: 200, seed: 1 }
    }

    #[test]
    fn a_walker_keeps_pace_and_turns_no_faster_than_it_may() {
        for kind in [SceneKind::City, SceneKind::Rooms] {
            let world = walking(build(kind, &SceneOptions::default()), ASPECT, &options(0));
            assert_eq!(world.frames, 600);
            let forward = |c: &Camera| -c.view.row(2).truncate();
            let mut fastest = 0f32;
            for frame in 1..world.frames {
                if frame % options(0).frames == 0 {
                    continue;
                }
                let (a, b) = (world.camera(frame - 1, ASPECT), world.camera(frame, ASPECT));
                let speed = a.eye.distance(b.eye) / WALK_SECONDS as f32;
                assert!(speed < SPEED * 1.01, "{kind:?} frame {frame}: {speed}");
                let turn = forward(&a).angle_between(forward(&b)) / WALK_SECONDS as f32;
                assert!(turn < TURN * 1.01, "{kind:?} frame {frame}: {turn}");
                fastest = fastest.max(turn);
            }
            assert!(fastest > TURN * 0.6, "{kind:?}: {fastest}");
        }
    }

    #[test]
    fn movers_keep_to_the_grid_and_their_speed_and_off_the_eye() {
        let mut world = walking(build(SceneKind::Rooms, &SceneOptions::default()), ASPECT, &options(200));
        let first = world.objects.len() - 200;
        let mut last: Vec<Vec3> = Vec::new();
        for frame in 0..120 {
            let moved = world.set_frame(frame);
            assert_eq!(moved, (first..first + 200).collect::<Vec<_>>(), "nothing else moves");
            let eye = world.camera(frame, ASPECT).eye;
            let centers: Vec<Vec3> = moved
                .iter()
                .map(|&i| {
                    let Shape::Sphere { center, radius } = world.objects[i].shape else { panic!("a sphere") };
                    assert!(center.distance(eye) > radius, "frame {frame}");
                    assert!((center - radius).cmpge(world.grid.min).all());
                    assert!((center + radius).cmple(world.grid.max).all());
                    center
                })
                .collect();
            for ((a, b), &i) in last.iter().zip(&centers).zip(&moved) {
                let Motion::Dynamic { max_speed } = world.objects[i].motion else { panic!("a mover") };
                assert!(a.distance(*b) <= max_speed * WALK_SECONDS as f32);
            }
            last = centers;
        }
    }

    #[test]
    fn turns_take_the_shorter_way() {
        assert!((between(3.0, -3.0) - (TAU - 6.0)).abs() < 1e-5);
        assert!((between(-3.0, 3.0) + (TAU - 6.0)).abs() < 1e-5);
        assert!((between(0.5, 1.0) - 0.5).abs() < 1e-6);
    }
}
