//! Conservative occlusion culling for Bevy 0.20, on the processor: entities that are hidden behind
//! others are neither drawn nor put into shadow maps. **What can be seen is never left out.**
//!
//! ```
//! use bevy_app::App;
//! use bevy_casca::CascaPlugin;
//!
//! let mut app = App::new();
//! // With all of Bevy: `(DefaultPlugins, CascaPlugin, standard_materials!(bevy::pbr))`.
//! app.add_plugins(CascaPlugin);
//! ```
//!
//! # What it does
//!
//! The plugin takes the place of three of Bevy's systems: the one that culls for cameras, and the
//! two that cull for lights. Each frame
//!
//! 1. entities with `Mesh3d`, `Aabb` and `GlobalTransform` are brought up to date in a
//!    [`casca::Scene`] ([`CascaSystems::Sync`]);
//! 2. each active camera queries the scene ([`CascaSystems::Cameras`]). Entities that the query
//!    finds must pass Bevy's own test, too, so that no set is larger than Bevy's;
//! 3. each light with shadows queries the scene for its shadow maps ([`CascaSystems::Lights`]);
//! 4. moving entities that no camera sees are put into volumes, which cost nothing until they come
//!    into sight ([`CascaSystems::End`]).
//!
//! All else is culled as Bevy does it, by the same tests: sprites, lights (also with a mesh),
//! entities without `Aabb`, with `NoFrustumCulling`, `VisibilityRange` or morph targets, skinned
//! meshes unless they have `DynamicSkinnedMeshBounds`, cameras with `NoCpuCulling`, and whatever
//! casca refuses, such as transforms that are not finite.
//!
//! # What hides
//!
//! A mesh hides others if Bevy draws it in this frame, it is known to be opaque, does not move, and
//! its triangles can be read. It is prepared in the background, once for all entities that share
//! it. Known to be opaque are entities with the component [`Opaque`], and those with materials that
//! a rule calls so: for Bevy's own [`standard_materials!`], for others a [`MaterialsPlugin`]. What
//! a material depends on has to be loaded. An [`Occluder`] hides wherever it moves; [`NotOccluder`]
//! and [`NoOcclusionCulling`] take exceptions. The README has a table.
//!
//! # More
//!
//! - [`CascaSettings::kept`]: cameras answer many frames from one result.
//! - [`CascaScene::shift_origin`]: worlds that move their origin.
//! - Feature `cache`: `CascaSettings::cache` is a folder of prepared meshes.
//!
//! # Limits
//!
//! - An entity hides others from the frame on in which its mesh is prepared, also while the
//!   renderer still compiles the pipeline that draws it: behind it there may be nothing until then.
//! - Entities that are drawn over nearer ones need [`NoOcclusionCulling`] if no rule tells: a
//!   renderer of your own ignores depth, or a shader moves their vertices out of the `Aabb`.
#![deny(missing_docs)]

mod border;
mod cameras;
mod casters;
mod diagnostics;
mod drawn;
mod eyes;
mod grid;
mod layers;
mod lights;
mod materials;
mod occluders;
mod plugin;
mod run;
mod scene;
mod settings;
mod sync;
mod told;

pub use casca;
pub use diagnostics::CascaDiagnostics;
pub use materials::{DeferredPlugin, MaterialsPlugin, NeverHiddenPlugin, NoDeferredPrepass, Surface};
pub use plugin::CascaPlugin;
pub use scene::{CascaScene, InScene};
pub use settings::{CascaSettings, CascaSystems, NoOcclusionCulling, NotOccluder, Occluder, Opaque, Shadows};
