//! What of a world is lit: its meshes, materials and lights, as a scene of casca's.

use std::f32::consts::PI;
use std::sync::Arc;

use bevy_asset::{Assets, Handle};
use bevy_color::{Color, ColorToComponents, LinearRgba};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_image::Image;
use bevy_light::{DirectionalLight, NotShadowCaster, PointLight, SpotLight};
use bevy_material::AlphaMode;
use bevy_mesh::{Mesh, Mesh3d, PrimitiveTopology, VertexAttributeValues};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use bevy_transform::components::GlobalTransform;
use casca_radiosity::Light;
use casca_radiosity::lit::{LitObject, LitScene, Material};
use casca_scenes::world::{Camera, Mesh as OwnMesh, Sides};
use glam::{Affine3A, Vec3};

use crate::lit::Moves;

/// Texels of a texture that its mean is taken of, along each side.
const SAMPLES: u32 = 8;
/// What is less opaque than this lets light pass.
const HALF: f32 = 0.5;

type Drawn = (Entity, &'static Mesh3d, &'static MeshMaterial3d<StandardMaterial>, &'static GlobalTransform);

/// What is read of the world.
#[derive(SystemParam)]
pub(crate) struct Surroundings<'w, 's> {
    meshes: Res<'w, Assets<Mesh>>,
    materials: Res<'w, Assets<StandardMaterial>>,
    pub images: ResMut<'w, Assets<Image>>,
    drawn: Query<'w, 's, Drawn, Without<NotShadowCaster>>,
    places: Query<'w, 's, &'static GlobalTransform>,
    parents: Query<'w, 's, &'static ChildOf>,
    moves: Query<'w, 's, (), With<Moves>>,
    points: Query<'w, 's, (Entity, &'static PointLight, &'static GlobalTransform)>,
    spots: Query<'w, 's, (Entity, &'static SpotLight, &'static GlobalTransform)>,
    suns: Query<'w, 's, (&'static DirectionalLight, &'static GlobalTransform)>,
}

/// A level as a scene, in metres from its root on, whatever its scale is.
pub(crate) struct Found {
    pub scene: LitScene,
    /// By object: its entity, its mesh, and whether it moves.
    pub objects: Vec<(Entity, Handle<Mesh>, bool)>,
}

impl Surroundings<'_, '_> {
    /// From the world into the frame of a level, and the scale of its root.
    pub fn frame(&self, root: Entity) -> Option<(Affine3A, Vec3)> {
        let (scale, turn, at) = self.places.get(root).ok()?.to_scale_rotation_translation();
        let frame = bevy_math::Affine3A::from_rotation_translation(turn, at).inverse();
        Some((own(&frame), Vec3::from_array(scale.to_array())))
    }

    /// Where an entity is in a frame; a point if it is no more.
    pub fn place(&self, frame: &Affine3A, entity: Entity) -> Affine3A {
        let place = self.places.get(entity).map(|place| own(&place.affine()));
        place.map_or(Affine3A::from_scale(Vec3::ZERO), |place| *frame * place)
    }

    fn moves(&self, entity: Entity) -> bool {
        self.moves.contains(entity) || self.parents.iter_ancestors(entity).any(|e| self.moves.contains(e))
    }

    /// Whether anything moves.
    pub fn is_any_moving(&self) -> bool {
        !self.moves.is_empty()
    }

    /// All below a root, what moves, and suns.
    pub fn scene(&self, root: Entity, frame: &Affine3A, sky: bevy_math::Vec3) -> Found {
        let is_below = |e: Entity| e == root || self.parents.iter_ancestors(e).any(|e| e == root);
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 1.0, 0.1, 1.0);
        let sky = Vec3::from_array(sky.to_array());
        let mut scene = LitScene {
            name: String::new(),
            objects: Vec::new(),
            materials: Vec::new(),
            textures: Vec::new(),
            lights: Vec::new(),
            sky,
            camera,
        };
        let mut objects = Vec::new();
        for (entity, handle, material, _) in &self.drawn {
            let moves = self.moves(entity);
            let (Some(mesh), Some(material)) = (self.meshes.get(handle), self.materials.get(material)) else {
                continue;
            };
            let Some(mesh) = own_mesh(mesh).filter(|_| moves || is_below(entity)) else { continue };
            scene.objects.push(LitObject {
                materials: vec![scene.materials.len() as u32; mesh.triangles.len()].into(),
                mesh: Arc::new(mesh),
                uv: Arc::default(),
                transform: self.place(frame, entity),
            });
            scene.materials.push(self.material(material));
            objects.push((entity, handle.0.clone(), moves));
        }
        let at = |place: &GlobalTransform| *frame * own(&place.affine());
        let ahead = |place: Affine3A| place.transform_vector3(Vec3::NEG_Z);
        // Bevy has the light of a ball in lumens. Its radius casts no shadows.
        let candela = |color: Color, lumens: f32| linear(color.to_linear()) * (lumens / (4.0 * PI));
        for (_, l, place) in self.points.iter().filter(|l| is_below(l.0)) {
            scene.lights.push(Light::point(at(place).translation.into(), candela(l.color, l.intensity)));
        }
        for (_, l, place) in self.spots.iter().filter(|l| is_below(l.0)) {
            scene.lights.push(Light::Spot {
                position: at(place).translation.into(),
                direction: ahead(at(place)),
                intensity: candela(l.color, l.intensity),
                inner: l.inner_angle,
                outer: l.outer_angle,
                radius: 0.0,
            });
        }
        for (l, place) in &self.suns {
            let irradiance = linear(l.color.to_linear()) * l.illuminance;
            scene.lights.push(Light::Sun { direction: ahead(at(place)), irradiance, half_angle: 0.0 });
        }
        Found { scene, objects }
    }

    fn material(&self, m: &StandardMaterial) -> Material {
        let base = m.base_color.to_linear();
        let passes = m.specular_transmission > 0.0 || m.diffuse_transmission > 0.0;
        let sides = match m.alpha_mode {
            _ if passes => Sides::Neither,
            AlphaMode::Opaque => {
                if m.cull_mode.is_none() {
                    Sides::Both
                } else {
                    Sides::Front
                }
            }
            _ if base.alpha < HALF => Sides::Neither,
            _ => Sides::Both,
        };
        let albedo = linear(base) * self.mean(&m.base_color_texture) * (1.0 - m.metallic);
        let emission = linear(m.emissive) * self.mean(&m.emissive_texture);
        Material { emission, sides, ..Material::matt(albedo) }.sound()
    }

    /// The mean of a texture; white where it cannot be read, as if it is packed.
    fn mean(&self, texture: &Option<Handle<Image>>) -> Vec3 {
        let Some(image) = texture.as_ref().and_then(|handle| self.images.get(handle)) else {
            return Vec3::ONE;
        };
        let at = |i: u32| {
            image.get_color_at(i % SAMPLES * image.width() / SAMPLES, i / SAMPLES * image.height() / SAMPLES)
        };
        let texels = (0..SAMPLES * SAMPLES).filter_map(|i| at(i).ok()).map(|c| linear(c.to_linear()));
        let texels: Vec<Vec3> = texels.collect();
        if texels.is_empty() { Vec3::ONE } else { texels.iter().sum::<Vec3>() / texels.len() as f32 }
    }
}

fn own(place: &bevy_math::Affine3A) -> Affine3A {
    Affine3A::from_cols_array(&place.to_cols_array())
}

fn linear(color: LinearRgba) -> Vec3 {
    Vec3::from_array(color.to_f32_array_no_alpha())
}

/// A list of triangles, if it is one that can be read.
fn own_mesh(mesh: &Mesh) -> Option<OwnMesh> {
    let is_list = mesh.primitive_topology() == PrimitiveTopology::TriangleList;
    let Ok(VertexAttributeValues::Float32x3(points)) = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION) else {
        return None;
    };
    let indices: Vec<u32> = match mesh.try_indices_option().ok()? {
        Some(indices) => indices.iter().map(|i| i as u32).collect(),
        None => (0..points.len() as u32).collect(),
    };
    let triangles = indices.as_chunks::<3>().0.to_vec();
    let positions = points.iter().map(|p| Vec3::from_array(*p)).collect();
    is_list.then(|| OwnMesh { positions, triangles, ..OwnMesh::default() })
}
