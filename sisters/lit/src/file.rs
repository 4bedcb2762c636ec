//! Scenes of glTF files, with their materials and lights.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;
use std::sync::Arc;

use glam::{Affine3A, DVec3, Quat, Vec3};
use gltf::khr_lights_punctual::Kind;
use gltf::material::AlphaMode;

use casca_images::linear_of;
use casca_scenes::import::parts::{File, Warnings, contents, nodes_of, parse};
use casca_scenes::import::{ImportError, Trouble, open};
use casca_scenes::world::{Mesh, Object, Shape, Sides, World};

use casca_radiosity::Light;
use casca_radiosity::lit::{ASPECT, LitObject, LitScene, Material};

use crate::paint::{Paint, Painted};

/// Share of light that surfaces other than metals reflect head-on.
const DIELECTRIC: f32 = 0.04;
/// What is less opaque than this is a hole, if the file does not say. Light passes half of a pane or
/// none of it.
const HALF: f32 = 0.5;

/// Loads a scene with its materials and lights from a `.glb` or `.gltf` file; see [`read_lit`].
///
/// # Errors
/// As [`casca_scenes::import::load`].
pub fn load_lit(path: &Path) -> Result<LitScene, ImportError> {
    open(path, read_lit)
}

/// Reads a scene with its materials and lights from the bytes of a glTF file, as
/// [`casca_scenes::import::read`] does. What moves stands where it is at frame 0.
///
/// - The colour of a material is its base colour times its texture. Its diffuse part is what metals
///   leave of it; its specular part is 0.04, and its mean colour for metals; its gloss is one minus its
///   roughness. Metal and roughness are the means of their texture, and emission is the mean of its
///   texture over each triangle. Colours of vertices are not read.
/// - Light passes where `alphaMode` MASK says that nothing is, and where BLEND is less than half opaque;
///   all else is solid. Images are PNG or JPEG.
/// - Lights are those of `KHR_lights_punctual`, where the file says; their units are taken as
///   radiometric. A file without lights and without emission gets a sun and a sky; beside suns of its
///   own it gets that sky, as many times as bright as they are.
///
/// # Errors
/// As [`casca_scenes::import::load`].
pub fn read_lit(name: &str, bytes: &[u8], folder: Option<&Path>) -> Result<LitScene, Trouble> {
    let warnings = Warnings::default();
    let file = parse(bytes, folder, &warnings)?;
    let world = contents(name, &file, &warnings)?;
    let mut scene = bare(&world);
    scene.materials = vec![Material { sides: Sides::Front, ..Material::matt(Vec3::ONE) }];
    let mut paint = Paint::new(&file, folder);
    for material in file.document.materials() {
        scene.materials.push(material_of(&material, &mut paint)?);
    }
    let nodes: Vec<gltf::Node> = file.document.nodes().collect();
    // Objects share them as they share meshes.
    let mut known: HashMap<(usize, *const u32), Painted> = HashMap::new();
    for (object, part) in scene.objects.iter_mut().zip(&world.source.parts) {
        // A box around what is deformed is no surface.
        let Some(mesh) = nodes[part.node].mesh() else { continue };
        let (materials, uv) = match known.entry((mesh.index(), part.primitives.as_ptr())) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                entry.insert(paint.mesh(&mesh, &part.primitives, &mut scene.materials)?)
            }
        };
        (object.materials, object.uv) = (materials.clone(), uv.clone());
    }
    scene.textures = paint.textures;
    let lights = lights_of(&file, world.source.origin)?;
    let mut used = known.values().flat_map(|painted| painted.0.iter());
    if !lights.is_empty() || used.any(|&m| scene.materials[m as usize].emits()) {
        let of =
            |l: &Light| if let Light::Sun { irradiance, .. } = l { irradiance.max_element() } else { 0.0 };
        let [new, old] = [&lights, &scene.lights].map(|all| all.iter().map(of).sum::<f32>());
        scene.sky *= new / old;
        scene.lights = lights;
    }
    Ok(scene)
}

fn material_of(material: &gltf::Material, paint: &mut Paint) -> Result<Material, Trouble> {
    let pbr = material.pbr_metallic_roughness();
    let [r, g, b, opacity] = pbr.base_color_factor();
    let share = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 };
    let color = Vec3::new(share(r), share(g), share(b));
    // Roughness is green, and metal is blue.
    let [_, rough, metal] =
        paint.mean(pbr.metallic_roughness_texture(), |byte| f32::from(byte) / 255.0)?.to_array();
    let metal = share(pbr.metallic_factor() * metal);
    let mean = paint.mean(pbr.base_color_texture(), linear_of)?;
    let specular = Vec3::splat(DIELECTRIC * (1.0 - metal)) + color * mean * metal;
    // A matt surface has no highlight that voxels could show.
    let gloss = 1.0 - share(pbr.roughness_factor() * rough);
    let specular = if gloss > 0.0 { specular } else { Vec3::ZERO };
    let strength = material.emissive_strength().unwrap_or(1.0);
    let emission = Vec3::from_array(material.emissive_factor()) * strength;
    let emission = if emission.is_finite() { emission.max(Vec3::ZERO) } else { Vec3::ZERO };
    let albedo = (color * (1.0 - metal)).min(Vec3::ONE - specular);
    // Read here, too: the path tracer is the truth of what the importer lets hide.
    let passes = |name: &str, factor: &str| {
        let value = material.extension_value(name).and_then(|v| v[factor].as_f64());
        value.is_some_and(|factor| factor != 0.0)
    };
    let least = match material.alpha_mode() {
        AlphaMode::Opaque => 0.0,
        AlphaMode::Mask => material.alpha_cutoff().unwrap_or(HALF),
        AlphaMode::Blend => HALF,
    };
    let texture = pbr.base_color_texture().map(|info| paint.texture(info, least, opacity)).transpose()?;
    let sides = match texture {
        None if opacity < least => Sides::Neither,
        _ if passes("KHR_materials_transmission", "transmissionFactor")
            || passes("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor") =>
        {
            Sides::Neither
        }
        _ if material.double_sided() => Sides::Both,
        _ => Sides::Front,
    };
    Ok(Material { albedo, specular, gloss, emission, sides, texture })
}

/// The lights of the nodes that are shown, at rest.
fn lights_of(file: &File, origin: DVec3) -> Result<Vec<Light>, Trouble> {
    let nodes = nodes_of(&file.document, &file.places)?;
    let mut lights = Vec::new();
    for (node, place) in nodes.0.iter().zip(nodes.globals(0.0)) {
        let Some(light) = file.document.nodes().nth(node.index).and_then(|n| n.light()) else { continue };
        let position = (place.translation - origin).as_vec3();
        let direction = place.transform_vector3(DVec3::NEG_Z).as_vec3();
        let strength = Vec3::from_array(light.color()) * light.intensity();
        lights.push(match light.kind() {
            Kind::Directional => Light::Sun { direction, irradiance: strength, half_angle: 0.0 },
            Kind::Point => Light::point(position, strength),
            Kind::Spot { inner_cone_angle: inner, outer_cone_angle: outer } => {
                Light::Spot { position, direction, intensity: strength, inner, outer, radius: 0.0 }
            }
        });
    }
    Ok(lights)
}

/// How often the triangles of a sphere are cut into four: 1,280 triangles.
const BALL_CUTS: u32 = 3;

/// A world without materials, under a sun and a pale sky.
fn bare(world: &World) -> LitScene {
    let ball = Arc::new(Mesh::ball(BALL_CUTS));
    let object = |object: &Object| {
        let (mesh, transform) = match &object.shape {
            Shape::Sphere { center, radius } => {
                let size = Vec3::splat(*radius);
                (ball.clone(), Affine3A::from_scale_rotation_translation(size, Quat::IDENTITY, *center))
            }
            Shape::Box { min, max } => (Arc::new(Mesh::cuboid(*min, *max)), Affine3A::IDENTITY),
            Shape::Mesh { mesh, transform } => (mesh.clone(), *transform),
        };
        LitObject { materials: Arc::default(), uv: Arc::default(), mesh, transform }
    };
    LitScene {
        name: world.name.clone(),
        objects: world.objects.iter().map(object).collect(),
        materials: Vec::new(),
        textures: Vec::new(),
        lights: vec![Light::Sun {
            direction: Vec3::new(0.35, -1.0, 0.25),
            irradiance: Vec3::new(3.0, 2.8, 2.5),
            half_angle: 0.0,
        }],
        sky: Vec3::new(0.3, 0.36, 0.45),
        camera: world.camera(0, ASPECT),
    }
}
