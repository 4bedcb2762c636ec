//! Lightmaps and probes of casca's for Bevy.
//!
//! [`CascaLightPlugin`] loads levels that `casca light bake` wrote: what Bevy's glTF loader spawns then has
//! its `Lightmap`s, and an `IrradianceVolume` with the probes. [`BakeLight`] lights what stands in the world
//! instead, and with [`Moves`] probes follow doors, both in the background. The README has an example.

mod follow;
mod load;
mod world;

use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::{Handle, RenderAssetUsages};
use bevy_ecs::prelude::*;
use bevy_gltf::extensions::GltfExtensionHandlers;
use bevy_image::{Image, ImageSampler};
use bevy_light::IrradianceVolume;
use bevy_math::Vec3;
use bevy_reflect::Reflect;
use bevy_transform::TransformSystems;
use bevy_transform::components::Transform;
use casca_lightmap::packed;
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

pub use casca_lightmap::Settings;
pub use follow::{BakeLight, Moves};

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
        // What is new has its place before it is drawn, and what is read has its own of this frame.
        app.add_systems(PostUpdate, follow::finish.before(TransformSystems::Propagate));
        let systems = (follow::bake, follow::dim, follow::follow).chain();
        app.add_systems(PostUpdate, systems.after(TransformSystems::Propagate));
    }
}

/// A level that is lit, on the root of its scene. The child of that with an `IrradianceVolume` has its probes.
#[derive(Component, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Component, Clone)]
pub struct LitLevel {
    /// Radiance of the sky, which lights what follows doors, too.
    pub sky: Vec3,
    /// Metres between probes, at most.
    pub spacing: f32,
    /// Cells of the radiosity cache along the longest axis, when probes follow what moves.
    pub cells: u32,
    /// Whether lightmaps lack the light that comes straight from lights that are no surfaces.
    pub live: bool,
}

impl Default for LitLevel {
    fn default() -> Self {
        Self::of(Vec3::ZERO, &Settings::default())
    }
}

impl LitLevel {
    fn of(sky: Vec3, settings: &Settings) -> Self {
        Self { sky, spacing: settings.spacing, cells: settings.cells, live: settings.live }
    }
}

/// The least size of a box of probes along an axis, in metres: Bevy inverts its transform.
const LEAST_BOX: f32 = 1e-3;

/// Probes in a box.
fn volume((min, max): (Vec3, Vec3), voxels: Handle<Image>) -> (Transform, IrradianceVolume) {
    let size = (max - min).max(Vec3::splat(LEAST_BOX));
    // What has a lightmap has this light in it.
    let volume = IrradianceVolume { voxels, intensity: 1.0, affects_lightmapped_meshes: false };
    (Transform::from_translation((min + max) / 2.0).with_scale(size), volume)
}

/// An image of light, as the files have it; of three dimensions if there is a depth.
fn image([width, height, depth]: [u32; 3], texels: &[glam::Vec3]) -> Image {
    let size = Extent3d { width, height, depth_or_array_layers: depth.max(1) };
    let kind = if depth > 0 { TextureDimension::D3 } else { TextureDimension::D2 };
    let data = texels.iter().flat_map(|t| packed(*t).to_le_bytes()).collect();
    let mut image = Image::new(size, kind, data, TextureFormat::Rgb9e5Ufloat, RenderAssetUsages::default());
    image.sampler = ImageSampler::linear();
    image
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
