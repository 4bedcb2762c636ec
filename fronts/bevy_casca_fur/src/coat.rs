//! The components, and how layers are chosen.

use bevy_asset::{AssetId, Handle};
use bevy_camera::visibility::{NoAutoAabb, Visibility};
use bevy_ecs::prelude::*;
use bevy_mesh::Mesh;
use bevy_transform::components::Transform;

use crate::material::FurMaterial;

/// Fur on the mesh of this entity (`Mesh3d`). The skin is drawn by the entity's own material, the
/// fur by a child with a [`Coat`], which the plugin makes and removes.
///
/// The child takes the entity's render layers, its `NotShadowCaster`, `NotShadowReceiver`,
/// `NoFrustumCulling` and its `SkinnedMesh`. Fur does not follow morph targets.
#[derive(Component, Debug, Clone, PartialEq, Eq)]
pub struct Furry(pub Handle<FurMaterial>);

/// The fur of its parent, made by the plugin. Its `Aabb` contains all layers.
#[derive(Component, Debug, Clone, PartialEq, Eq)]
#[require(Transform, Visibility, NoAutoAabb)]
pub struct Coat {
    pub(crate) layers: u32,
    pub(crate) made: Made,
}

/// The makings of a coat's mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Made {
    pub mesh: AssetId<Mesh>,
    /// Counts the changes of that mesh.
    pub version: u32,
    /// The layers in the mesh: those of the coat, or the last ones before it had none.
    pub layers: u32,
    /// The bits of the reach of the fur, for meshes with a skin.
    pub reach: u32,
}

impl Coat {
    /// The layers that it has now. With 0 it is hidden.
    pub fn layers(&self) -> u32 {
        self.layers
    }
}

/// How many layers coats get. The defaults are for a graphics processor of today.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct FurSettings {
    /// The most layers of a coat, at most 256; 0 for no fur at all. 24 by default.
    pub most_layers: u32,
    /// The greatest sum of the weights of all visible furry entities: for the skin and for each
    /// layer its vertices and its pixels ([`casca_fur::visibility::plan_layers`]). Infinite by
    /// default. A budget that is negative or NaN counts as none, with a warning.
    pub budget: f64,
    /// The weight of a pixel, where a vertex weighs 1. Finite and at least 0.
    pub pixel_weight: f64,
}

impl Default for FurSettings {
    fn default() -> Self {
        Self { most_layers: 24, budget: f64::INFINITY, pixel_weight: 1.0 }
    }
}
