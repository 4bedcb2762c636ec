//! A lit scene for the radiosity cache.

use super::{LightKind, LitObject, LitScene, LitTriangle};
use crate::{Light, Material, Object, Scene, Sky, Triangle};

impl LitObject {
    /// Its sound triangles where it is now, for a scene with these materials: see
    /// [`Cache::set_objects`](crate::Cache::set_objects). All stop light from both sides.
    pub fn lit(&self, materials: &[super::Material]) -> Object {
        let triangle = |t: LitTriangle| Triangle { corners: t.corners, material: t.material };
        self.triangles(0, materials).map(triangle).collect::<Vec<_>>().into()
    }
}

impl From<&super::Light> for Light {
    /// A light that falls by squares, whatever the falloff.
    fn from(l: &super::Light) -> Self {
        match l.kind {
            LightKind::Directional { direction, half_angle } => {
                Self::Sun { direction, irradiance: l.color, half_angle }
            }
            LightKind::Point { position, radius } => Self::Point { position, intensity: l.color, radius },
            LightKind::Spot { position, direction, radius, inner, outer } => {
                Self::Spot { position, direction, intensity: l.color, inner, outer, radius }
            }
        }
    }
}

impl From<&LitScene> for Scene {
    /// Matt light of all surfaces: what they mirror is left out, and all lights fall by squares.
    ///
    /// Objects without sound triangles are empty, so that the others keep their numbers.
    fn from(scene: &LitScene) -> Self {
        let objects = scene.objects.iter().map(|o| o.lit(&scene.materials)).collect();
        let material = |m: &super::Material| Material::new(m.sound().albedo, m.sound().emission);
        Self {
            objects,
            materials: scene.materials.iter().map(material).collect(),
            lights: scene.lights.iter().map(Light::from).collect(),
            sky: Sky::Even(scene.sky),
        }
    }
}
