//! Lightmaps and probes of casca's for Bevy.
//!
//! [`CascaLightPlugin`] loads levels that `casca light bake` wrote: what Bevy's glTF loader spawns then has
//! its `Lightmap`s, and an `IrradianceVolume` with the probes. [`BakeLight`] lights what stands in the world
//! instead, and with [`Moves`] probes follow doors, both in the background. The README has an example.

mod follow;
mod lit;
mod load;
mod world;

use bevy_app::{App, Plugin, PostUpdate};
use bevy_ecs::prelude::*;
use bevy_gltf::extensions::GltfExtensionHandlers;
use bevy_transform::TransformSystems;

pub use casca_lightmap::Settings;
pub use follow::BakeLight;
pub use lit::{LitLevel, Moves};

/// Loads lit levels, lights others, and lets probes follow what moves. Add it after `DefaultPlugins`.
#[derive(Debug, Clone, Copy, Default)]
pub struct CascaLightPlugin;

impl Plugin for CascaLightPlugin {
    fn build(&self, app: &mut App) {
        // Scenes are copied by reflection.
        app.register_type::<LitLevel>();
        app.init_resource::<GltfExtensionHandlers>();
        let handlers = app.world().resource::<GltfExtensionHandlers>().0.clone();
        match handlers.try_write() {
            Some(mut handlers) => handlers.push(Box::<load::Loader>::default()),
            None => {
                bevy_log::error!("lit levels are loaded without their light: files are being loaded already")
            }
        }
        // Probes are spawned before transforms are propagated, and baking reads those of this frame.
        app.add_systems(PostUpdate, follow::finish.before(TransformSystems::Propagate));
        let systems = (follow::bake, follow::dim, follow::follow).chain();
        app.add_systems(PostUpdate, systems.after(TransformSystems::Propagate));
    }
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
