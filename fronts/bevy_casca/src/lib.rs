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
//! The plugin takes the place of three of Bevy's systems: the one that culls for cameras, and the
//! two that cull for lights. [`CascaSystems`] are its own, in their order. The README lists what
//! hides others, what nothing hides, the times, and the limits.
#![deny(missing_docs)]

mod asked;
mod beams;
mod border;
mod cameras;
mod casters;
mod diagnostics;
mod drawn;
mod grid;
mod lamps;
mod layers;
mod lights;
mod materials;
mod occluders;
mod plugin;
mod scene;
mod settings;
mod sync;
mod told;
mod why_not;

pub use casca;
pub use diagnostics::CascaDiagnostics;
pub use materials::{MaterialsPlugin, NoDeferredPrepass, Surface, deferred_by, never_hidden};
pub use plugin::CascaPlugin;
pub use scene::{CascaScene, InScene};
pub use settings::{CascaSettings, CascaSystems, NoOcclusionCulling, NotOccluder, Occluder, Opaque, Shadows};
pub use why_not::WhyNot;
