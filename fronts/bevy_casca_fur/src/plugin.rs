//! The plugin.

use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::{AssetApp, AssetEventSystems, Assets};
use bevy_camera::visibility::VisibilitySystems;
use bevy_ecs::prelude::*;
use bevy_image::Image;
use bevy_mesh::Mesh;
use bevy_pbr::MaterialPlugin;
use bevy_render::RenderApp;
use bevy_shader::Shader;
use bevy_transform::TransformSystems;

use crate::coat::FurSettings;
use crate::grow;
use crate::material::{FurMaterial, make_tables, shader};
use crate::store::Store;

/// Gives entities with [`Furry`](crate::Furry) their fur. Add it after `DefaultPlugins`. In an app
/// without a renderer it chooses layers all the same.
#[derive(Debug, Clone, Copy, Default)]
pub struct FurPlugin;

/// The plugin's systems in `PostUpdate`.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FurSystems {
    /// Coats are made, changed and removed, after transforms are propagated and before bounds are
    /// calculated.
    Grow,
}

impl Plugin for FurPlugin {
    fn build(&self, app: &mut App) {
        if app.get_sub_app(RenderApp).is_some() {
            app.add_plugins(MaterialPlugin::<FurMaterial>::default());
        } else {
            app.init_asset::<FurMaterial>();
        }
        if !app.world().contains_resource::<Assets<Mesh>>() {
            app.init_asset::<Mesh>();
        }
        if app.world().contains_resource::<Assets<Image>>() {
            // Tables of this frame reach the renderer with their materials.
            app.add_systems(PostUpdate, make_tables.before(AssetEventSystems));
        }
        app.init_resource::<FurSettings>().init_resource::<Store>();
        // New meshes must be seen by this frame's events, which reach the renderer. What was
        // visible in the last frame is known until visibility is propagated.
        let before = (AssetEventSystems, VisibilitySystems::VisibilityPropagate);
        let place = FurSystems::Grow.after(TransformSystems::Propagate).before(before.0).before(before.1);
        app.configure_sets(PostUpdate, place);
        app.add_systems(PostUpdate, grow::grow.in_set(FurSystems::Grow));
    }

    fn finish(&self, app: &mut App) {
        if let Some(mut shaders) = app.world_mut().get_resource_mut::<Assets<Shader>>() {
            let (handle, shader) = shader();
            if let Err(why) = shaders.insert(&handle, shader) {
                bevy_log::error!("the shader of fur is not there: {why}");
            }
        }
    }
}
