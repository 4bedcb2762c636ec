//! What a lit level has: a component, probes, and images of light.

use bevy_asset::{Handle, RenderAssetUsages};
use bevy_ecs::prelude::*;
use bevy_image::{Image, ImageSampler};
use bevy_light::IrradianceVolume;
use bevy_math::Vec3;
use bevy_reflect::Reflect;
use bevy_transform::components::Transform;
use casca_lightmap::{Settings, packed};
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

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
    pub(crate) fn of(sky: Vec3, settings: &Settings) -> Self {
        Self { sky, spacing: settings.spacing, cells: settings.cells, live: settings.live }
    }
}

/// On a door, or on another thing that moves with all below it: the probes of each [`LitLevel`] follow it.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct Moves;

/// The least size of a box of probes along an axis, in metres: Bevy inverts its transform.
const LEAST_BOX: f32 = 1e-3;

/// Probes in a box.
pub(crate) fn volume((min, max): (Vec3, Vec3), voxels: Handle<Image>) -> (Transform, IrradianceVolume) {
    let size = (max - min).max(Vec3::splat(LEAST_BOX));
    // What has a lightmap has this light in it.
    let volume = IrradianceVolume { voxels, intensity: 1.0, affects_lightmapped_meshes: false };
    (Transform::from_translation((min + max) / 2.0).with_scale(size), volume)
}

/// An image of light, as the files have it; of three dimensions if there is a depth.
pub(crate) fn image([width, height, depth]: [u32; 3], texels: &[glam::Vec3]) -> Image {
    let size = Extent3d { width, height, depth_or_array_layers: depth.max(1) };
    let kind = if depth > 0 { TextureDimension::D3 } else { TextureDimension::D2 };
    let data = texels.iter().flat_map(|t| packed(*t).to_le_bytes()).collect();
    let mut image = Image::new(size, kind, data, TextureFormat::Rgb9e5Ufloat, RenderAssetUsages::default());
    image.sampler = ImageSampler::linear();
    image
}
