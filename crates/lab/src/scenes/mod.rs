//! Procedural test scenes, the same for the same seed.
//!
//! - [`SceneKind::Spheres`]: the scene of the thesis: clusters of spheres of varied size.
//! - [`SceneKind::City`]: blocks of buildings, thousands of small things, moving cars.
//! - [`SceneKind::Rooms`]: a floor of rooms with thin walls and sliding doors.
//! - [`SceneKind::Forest`]: thin trunks and foliage that hides nothing.
//! - [`SceneKind::Crowd`]: 100,000 people behind walls.

mod city;
mod crowd;
mod forest;
mod motion;
mod rooms;
mod spheres;

use std::str::FromStr;

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::world::{Motion, Object, Shape, World};

/// A procedural scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SceneKind {
    /// 4,800 static and 200 dynamic spheres.
    Spheres,
    /// Streets.
    City,
    /// Indoors.
    Rooms,
    /// Little to hide.
    Forest,
    /// 100,000 dynamic objects.
    Crowd,
}

impl SceneKind {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Spheres, Self::City, Self::Rooms, Self::Forest, Self::Crowd];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spheres => "spheres",
            Self::City => "city",
            Self::Rooms => "rooms",
            Self::Forest => "forest",
            Self::Crowd => "crowd",
        }
    }
}

/// The name is none of a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0} is no scene: there are spheres, city, rooms, forest and crowd")]
pub struct UnknownScene(String);

impl FromStr for SceneKind {
    type Err = UnknownScene;

    fn from_str(name: &str) -> Result<Self, UnknownScene> {
        Self::ALL.into_iter().find(|k| k.name() == name).ok_or_else(|| UnknownScene(name.to_owned()))
    }
}

/// What can be chosen about a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneOptions {
    /// Random seed.
    pub seed: u64,
    /// Frames of the path.
    pub frames: usize,
    /// Multiplies the number of objects where the scene allows it; 1 is the standard.
    pub scale: f32,
    /// `Spheres` only: builds a closed bunker beside the scene.
    pub bunker: bool,
    /// `Spheres` only: small dynamic spheres inside the bunker, where nobody sees them.
    pub hidden_extra: usize,
    /// `Spheres` only: puts closed walls around the scene and as many static spheres
    /// beyond them, as densely as inside.
    pub beyond_walls: Option<usize>,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self { seed: 1, frames: 150, scale: 1.0, bunker: false, hidden_extra: 0, beyond_walls: None }
    }
}

/// Builds a scene.
pub fn build(kind: SceneKind, options: &SceneOptions) -> World {
    let options = SceneOptions { frames: options.frames.max(1), ..*options };
    match kind {
        SceneKind::Spheres => spheres::build(&options),
        SceneKind::City => city::build(&options),
        SceneKind::Rooms => rooms::build(&options),
        SceneKind::Forest => forest::build(&options),
        SceneKind::Crowd => crowd::build(&options),
    }
}

/// The random numbers of a scene.
struct Dice(Pcg64Mcg);

impl Dice {
    fn new(seed: u64, scene: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ scene))
    }

    /// A number from `lo` to `hi`.
    fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.0.random::<f32>()
    }

    fn chance(&mut self, share: f32) -> bool {
        self.0.random::<f32>() < share
    }

    fn point(&mut self, lo: Vec3, hi: Vec3) -> Vec3 {
        Vec3::new(self.range(lo.x, hi.x), self.range(lo.y, hi.y), self.range(lo.z, hi.z))
    }
}

fn solid_box(name: &str, min: Vec3, max: Vec3) -> Object {
    object(name, Shape::Box { min, max })
}

fn object(name: &str, shape: Shape) -> Object {
    Object { name: name.to_owned(), shape, motion: Motion::Static, occludes: true, tested: true }
}

/// A box with its base at `base`.
fn standing_box(name: &str, base: Vec3, size: Vec3) -> Object {
    let half = Vec3::new(size.x * 0.5, 0.0, size.z * 0.5);
    solid_box(name, base - half, base + half + Vec3::Y * size.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::FRAME_SECONDS;

    fn bounds(shape: &Shape) -> (Vec3, Vec3) {
        match shape {
            Shape::Sphere { center, radius } => (*center - *radius, *center + *radius),
            Shape::Box { min, max } => (*min, *max),
            Shape::Mesh { .. } => unreachable!("procedural scenes have no meshes"),
        }
    }

    fn middle(shape: &Shape) -> Vec3 {
        let (lo, hi) = bounds(shape);
        (lo + hi) * 0.5
    }

    fn holds(shape: &Shape, p: Vec3) -> bool {
        match shape {
            Shape::Sphere { center, radius } => center.distance(p) <= *radius,
            Shape::Box { min, max } => min.cmple(p).all() && p.cmple(*max).all(),
            Shape::Mesh { .. } => false,
        }
    }

    fn worlds() -> impl Iterator<Item = World> {
        SceneKind::ALL.into_iter().flat_map(|kind| {
            [1, 2].map(|seed| build(kind, &SceneOptions { seed, ..SceneOptions::default() }))
        })
    }

    #[test]
    fn scenes_keep_to_their_grid_and_speeds_and_the_eye_is_free() {
        for mut world in worlds() {
            let (min, max) = (world.grid.min, world.grid.max);
            let count = |w: &World, dynamic| {
                w.objects.iter().filter(|o| (o.motion != Motion::Static) == dynamic).count()
            };
            println!("{}: {} static, {} dynamic", world.name, count(&world, false), count(&world, true));
            let step = if world.objects.len() > 50_000 { 15 } else { 1 };
            let mut last: Option<(usize, Vec<Vec3>)> = None;
            for frame in (0..world.frames).step_by(step) {
                let moved = world.set_frame(frame);
                assert!(moved.is_sorted());
                assert_eq!(moved.len(), count(&world, true), "every dynamic object is set");
                for o in &world.objects {
                    let (lo, hi) = bounds(&o.shape);
                    assert!(lo.cmple(hi).all() && lo.cmpge(min).all() && hi.cmple(max).all(), "{o:?}");
                }
                let eye = world.camera(frame, 1.5).eye;
                assert!(eye.cmpgt(min).all() && eye.cmplt(max).all());
                for o in world.objects.iter().filter(|o| o.occludes) {
                    assert!(!holds(&o.shape, eye), "{} frame {frame}: eye {eye} in {o:?}", world.name);
                }
                let middles: Vec<Vec3> = moved.iter().map(|&i| middle(&world.objects[i].shape)).collect();
                if let Some((before, old)) = last {
                    let seconds = (frame - before) as f32 * FRAME_SECONDS as f32;
                    for ((a, b), &i) in old.iter().zip(&middles).zip(&moved) {
                        let Motion::Dynamic { max_speed } = world.objects[i].motion else { panic!() };
                        let way = a.distance(*b);
                        assert!(way <= max_speed * seconds, "{}: {way}", world.objects[i].name);
                    }
                }
                last = Some((frame, middles));
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_scene() {
        for kind in SceneKind::ALL {
            let options = SceneOptions { seed: 7, ..SceneOptions::default() };
            let (a, b) = (build(kind, &options), build(kind, &options));
            assert_eq!(a.objects.len(), b.objects.len());
            assert!(a.objects.iter().zip(&b.objects).all(|(a, b)| bounds(&a.shape) == bounds(&b.shape)));
            assert_eq!(kind.name().parse::<SceneKind>(), Ok(kind));
        }
        assert!("house".parse::<SceneKind>().is_err());
    }

    #[test]
    fn extra_hidden_spheres_change_nothing_else() {
        let with = |hidden_extra| {
            build(SceneKind::Spheres, &SceneOptions { bunker: true, hidden_extra, ..SceneOptions::default() })
        };
        let (few, many) = (with(0), with(1000));
        assert_eq!(many.objects.len(), few.objects.len() + 1000);
        assert!(few.objects.iter().zip(&many.objects).all(|(a, b)| bounds(&a.shape) == bounds(&b.shape)));
    }
}
