//! Levels that `casca light bake` wrote: their light, given to what the loader of glTF files makes.

use bevy_asset::{AssetPath, Handle, LoadContext};
use bevy_ecs::prelude::*;
use bevy_gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy_gltf::{GltfLoaderSettings, gltf};
use bevy_image::{Image, ImageLoaderSettings, ImageSampler};
use bevy_math::{Rect, Vec3};
use bevy_mesh::Mesh3d;
use bevy_pbr::Lightmap;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::lit::{LitLevel, volume};

/// What files say in `extras`.
#[derive(Deserialize)]
struct Extras<T> {
    casca_light: Option<T>,
}

#[derive(Deserialize)]
struct OfScene {
    lightmaps: Vec<String>,
    probes: OfProbes,
    sky: Vec3,
    lights: String,
}

#[derive(Deserialize)]
struct OfProbes {
    image: String,
    min: Vec3,
    max: Vec3,
    spacing: f32,
}

#[derive(Deserialize)]
struct OfNode {
    lightmap: usize,
    uv_rect: [f32; 4],
}

/// What is said of the light, if anything. What cannot be read is told.
fn said<T: DeserializeOwned>(extras: &gltf::json::Extras, path: &AssetPath) -> Option<T> {
    let read = |text: &str| serde_json::from_str::<Extras<T>>(text).map(|extras| extras.casca_light);
    // Extras of others may be anything.
    let text = extras.as_ref()?.get();
    let read = if text.contains("casca_light") { read(text) } else { Ok(None) };
    read.unwrap_or_else(|why| {
        bevy_log::warn!("{path}: extras.casca_light is not what `casca light bake` writes: {why}");
        None
    })
}

/// Gives a file that is loaded its light.
#[derive(Clone, Default)]
pub(crate) struct Loader {
    level: Option<Level>,
}

#[derive(Clone)]
struct Level {
    scene: usize,
    lit: LitLevel,
    pages: Vec<Handle<Image>>,
    probes: ((Vec3, Vec3), Handle<Image>),
}

impl GltfExtensionHandler for Loader {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_root(&mut self, load: &mut LoadContext<'_>, gltf: &gltf::Gltf, _: &GltfLoaderSettings) {
        let Some(scene) = gltf.default_scene().or_else(|| gltf.scenes().next()) else { return };
        let path = load.path().clone();
        let Some(found) = said::<OfScene>(scene.extras(), &path) else { return };
        let mut image = |name: &String| {
            let settings = |settings: &mut ImageLoaderSettings| settings.sampler = ImageSampler::linear();
            let path = path.resolve_embed(&AssetPath::from(std::path::PathBuf::from(name)));
            load.load_builder().with_settings(settings).load(path)
        };
        let OfProbes { min, max, spacing, image: probes } = found.probes;
        self.level = Some(Level {
            scene: scene.index(),
            lit: LitLevel { sky: found.sky, spacing, live: found.lights == "live", ..LitLevel::default() },
            pages: found.lightmaps.iter().map(&mut image).collect(),
            probes: ((min, max), image(&probes)),
        });
    }

    fn on_gltf_node(&mut self, load: &mut LoadContext<'_>, node: &gltf::Node, entity: &mut EntityWorldMut) {
        let (Some(level), Some(mesh)) = (&self.level, node.mesh()) else { return };
        let Some(found) = said::<OfNode>(node.extras(), load.path()) else { return };
        let Some(page) = level.pages.get(found.lightmap) else { return };
        let [x0, y0, x1, y1] = found.uv_rect;
        let lightmap = Lightmap {
            image: page.clone(),
            uv_rect: Rect { min: (x0, y0).into(), max: (x1, y1).into() },
            ..Lightmap::default()
        };
        // Primitives come first, in order. Bevy draws nothing without both sets of coordinates: lines have none.
        let primitives: Vec<Entity> = entity.get::<Children>().into_iter().flatten().copied().collect();
        let is_mapped =
            |p: gltf::Primitive| [0, 1].iter().all(|i| p.get(&gltf::Semantic::TexCoords(*i)).is_some());
        entity.world_scope(|world| {
            for (child, is_mapped) in primitives.into_iter().zip(mesh.primitives().map(is_mapped)) {
                if is_mapped && world.get::<Mesh3d>(child).is_some() {
                    world.entity_mut(child).insert(lightmap.clone());
                }
            }
        });
    }

    fn on_scene_completed(
        &mut self,
        _: &mut LoadContext<'_>,
        scene: &gltf::Scene,
        root: Entity,
        world: &mut World,
    ) {
        if let Some(level) = self.level.as_ref().filter(|level| level.scene == scene.index()) {
            world.entity_mut(root).insert(level.lit);
            world.spawn((volume(level.probes.0, level.probes.1.clone()), ChildOf(root)));
        }
    }
}
