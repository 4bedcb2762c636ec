//! A lit scene for the radiosity cache.

use casca_radiosity::{Light, Material, Object, Scene, Sky, Triangle};

use super::{LightKind, LitScene, LitTriangle};

impl From<&LitScene> for Scene {
    /// Matt light of all surfaces: what they mirror is left out, and all lights fall by squares.
    ///
    /// Objects without sound triangles are empty, so that the others keep their numbers.
    fn from(scene: &LitScene) -> Self {
        let triangle = |t: &LitTriangle| Triangle { corners: t.corners, material: t.material };
        let mut objects = vec![Object::default(); scene.objects.len()];
        for t in scene.triangles() {
            objects[t.object as usize].triangles.push(triangle(&t));
        }
        let material = |m: &super::Material| Material::new(m.sound().albedo, m.sound().emission);
        Self {
            objects,
            materials: scene.materials.iter().map(material).collect(),
            lights: scene.lights.iter().map(light).collect(),
            sky: Sky::Even(scene.sky),
            ..Self::default()
        }
    }
}

fn light(l: &super::Light) -> Light {
    match l.kind {
        LightKind::Directional { direction, half_angle } => {
            Light::Sun { direction, irradiance: l.color, half_angle }
        }
        LightKind::Point { position, radius } => Light::Point { position, intensity: l.color, radius },
        LightKind::Spot { position, direction, radius, inner, outer } => {
            Light::Spot { position, direction, intensity: l.color, inner, outer, radius }
        }
    }
}
