//! Procedural test scenes. A seed always gives the same scene; [`SceneKind`] describes each.
//!
//! [`walking()`] puts a walker at 60 frames a second and floating spheres into any scene.

mod city;
mod crowd;
mod forest;
mod harbour;
mod leaves;
mod motion;
mod noise;
mod options;
mod parts;
mod rocks;
mod rooms;
mod spheres;
#[cfg(test)]
mod tests;
mod town;
mod voxels;
mod walking;

use std::str::FromStr;

use crate::world::World;

pub use options::SceneOptions;
pub use walking::{WALK_SECONDS, WalkOptions, walking};

/// Declares the scenes: a description, a name for the command line, and the function that builds it.
macro_rules! scenes {
    ($($(#[$what:meta])+ $kind:ident $name:literal $build:expr;)+) => {
        /// A procedural scene.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum SceneKind {
            $($(#[$what])+ $kind,)+
        }

        impl SceneKind {
            /// All of them.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$kind),+];

            /// Its name on the command line.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)+
                }
            }

            fn build(self, options: &SceneOptions) -> World {
                let build: fn(&SceneOptions) -> World = match self {
                    $(Self::$kind => $build,)+
                };
                build(options)
            }
        }
    };
}

scenes! {
    /// The scene of the thesis: clusters of spheres of varied size, 4,800 static and 200 dynamic.
    Spheres "spheres" spheres::build;
    /// Blocks of buildings, thousands of small things, moving cars.
    City "city" city::build;
    /// A floor of rooms with thin walls and sliding doors.
    Rooms "rooms" rooms::build;
    /// Thin trunks, and foliage that hides nothing.
    Forest "forest" forest::build;
    /// 100,000 people behind walls.
    Crowd "crowd" crowd::build;
    /// Buildings of panels that share no vertices, thin railings, 20,000 small things.
    Town "town" town::build;
    /// Boulders: closed meshes of high curvature.
    Rocks "rocks" rocks::build;
    /// Stacked containers, cranes of thin beams, a ship, 2,500 small things.
    Harbour "harbour" harbour::build;
    /// Hills and caves of blocks, in chunks of 16x16x256, with small things on floors.
    Voxels "voxels" voxels::build;
    /// A wood of branches and leaf quads on rolling ground, one mesh.
    Leaves "leaves" leaves::build;
}

impl SceneKind {
    /// Those of spheres and boxes, at their standard sizes.
    pub const SOLIDS: [Self; 5] = [Self::Spheres, Self::City, Self::Rooms, Self::Forest, Self::Crowd];

    /// The names of all scenes, with commas between them.
    pub fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

impl FromStr for SceneKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let unknown = || format!("{name} is no scene: there are {}", Self::names());
        Self::ALL.into_iter().find(|k| k.name() == name).ok_or_else(unknown)
    }
}

/// Builds a scene.
pub fn build(kind: SceneKind, options: &SceneOptions) -> World {
    kind.build(&SceneOptions { frames: options.frames.max(1), ..*options })
}
