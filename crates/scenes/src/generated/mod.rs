//! Procedural test scenes, the same for the same seed.
//!
//! - [`SceneKind::Spheres`]: the scene of the thesis: clusters of spheres of varied size.
//! - [`SceneKind::City`]: blocks of buildings, thousands of small things, moving cars.
//! - [`SceneKind::Rooms`]: a floor of rooms with thin walls and sliding doors.
//! - [`SceneKind::Forest`]: thin trunks and foliage that hides nothing.
//! - [`SceneKind::Crowd`]: 100,000 people behind walls.
//!
//! These are [`SceneKind::SOLIDS`], of spheres and boxes. Those of triangle meshes are:
//!
//! - [`SceneKind::Terrain`]: rolling ground, one mesh, with trees, houses and small things.
//! - [`SceneKind::Town`]: buildings of panels that share no vertices, thin railings, 20,000 small
//!   things.
//! - [`SceneKind::Rocks`]: closed meshes of high curvature.
//! - [`SceneKind::Valley`]: a wood of open cones and loose leaves on rolling ground.
//! - [`SceneKind::Harbour`]: stacked containers, cranes of thin beams, a ship, 2,500 small things.
//! - [`SceneKind::SpheresMeshes`], [`SceneKind::CityMeshes`]: the first two as meshes.
//!
//! [`SceneKind::Spheres16`] and [`SceneKind::City10`] have 16 and 10 times as many spheres and
//! small things.
//!
//! [`walking()`] puts a walker at 60 frames a second and floating spheres into any scene.

mod city;
mod crowd;
mod forest;
mod ground;
mod harbour;
mod motion;
mod noise;
mod options;
mod parts;
mod rocks;
mod rooms;
mod solid_meshes;
mod spheres;
mod terrain;
#[cfg(test)]
mod tests;
mod town;
mod valley;
mod walking;

use std::str::FromStr;

use crate::world::World;

pub use options::SceneOptions;
pub use walking::{WALK_SECONDS, WalkOptions, walking};

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
    /// Hills.
    Terrain,
    /// Streets between modular buildings.
    Town,
    /// Boulders.
    Rocks,
    /// `Spheres`, each of 320 triangles.
    SpheresMeshes,
    /// `City`, its boxes as meshes.
    CityMeshes,
    /// 80,000 spheres.
    Spheres16,
    /// 30,000 small things in the streets.
    City10,
    /// A wood of trees that are no solids.
    Valley,
    /// A container terminal.
    Harbour,
}

impl SceneKind {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Spheres,
        Self::City,
        Self::Rooms,
        Self::Forest,
        Self::Crowd,
        Self::Terrain,
        Self::Town,
        Self::Rocks,
        Self::SpheresMeshes,
        Self::CityMeshes,
        Self::Spheres16,
        Self::City10,
        Self::Valley,
        Self::Harbour,
    ];

    /// Those of spheres and boxes, at their standard sizes.
    pub const SOLIDS: [Self; 5] = [Self::Spheres, Self::City, Self::Rooms, Self::Forest, Self::Crowd];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spheres => "spheres",
            Self::City => "city",
            Self::Rooms => "rooms",
            Self::Forest => "forest",
            Self::Crowd => "crowd",
            Self::Terrain => "terrain",
            Self::Town => "town",
            Self::Rocks => "rocks",
            Self::SpheresMeshes => "spheres-meshes",
            Self::CityMeshes => "city-meshes",
            Self::Spheres16 => "spheres-16",
            Self::City10 => "city-10",
            Self::Valley => "valley",
            Self::Harbour => "harbour",
        }
    }

    /// The names of all scenes, with commas between them.
    pub fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

/// The name is none of a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0} is no scene: there are {names}", names = SceneKind::names())]
pub struct UnknownScene(String);

impl FromStr for SceneKind {
    type Err = UnknownScene;

    fn from_str(name: &str) -> Result<Self, UnknownScene> {
        Self::ALL.into_iter().find(|k| k.name() == name).ok_or_else(|| UnknownScene(name.to_owned()))
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
        SceneKind::Terrain => terrain::build(&options),
        SceneKind::Town => town::build(&options),
        SceneKind::Rocks => rocks::build(&options),
        SceneKind::SpheresMeshes => solid_meshes::meshed(spheres::build(&options), 2),
        SceneKind::CityMeshes => solid_meshes::meshed(city::build(&options), 1),
        SceneKind::Spheres16 => times(16.0, &options, spheres::build),
        SceneKind::City10 => times(10.0, &options, city::build),
        SceneKind::Valley => valley::build(&options),
        SceneKind::Harbour => harbour::build(&options),
    }
}

/// A scene with a multiple of the objects.
fn times(factor: f32, options: &SceneOptions, build: fn(&SceneOptions) -> World) -> World {
    let mut world = build(&SceneOptions { scale: options.scale * factor, ..*options });
    world.name.push_str(&format!("-{factor}"));
    world
}
