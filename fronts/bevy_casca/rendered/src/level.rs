//! A level from a glTF file, with its path of the camera.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_casca::casca::glam;
use casca_scenes::world::{self, Shape, World as File};

/// So many materials share the meshes of a level.
const COLORS: usize = 12;

/// Frames of the path from one picture to the next.
const STRIDE: usize = 13;

/// A level. Its materials are matte, and seen from both sides.
pub struct Level(File);

impl Level {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be taken whole.
    pub fn load(path: &Path) -> Result<Self, String> {
        casca_scenes::import::load(path).map(Self).map_err(|why| why.to_string())
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// Spawns its meshes where they are in the first frame, a lamp and a sun.
    pub fn fill(&self, world: &mut World) {
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let colors: [_; COLORS] = std::array::from_fn(|i| {
            let base_color = Color::hsl(i as f32 * 360.0 / COLORS as f32, 0.3, 0.6);
            materials.add(StandardMaterial {
                base_color,
                perceptual_roughness: 0.9,
                cull_mode: None,
                double_sided: true,
                ..default()
            })
        });
        let mut known: HashMap<*const world::Mesh, Handle<Mesh>> = HashMap::new();
        for (i, object) in self.0.objects.iter().enumerate() {
            let Shape::Mesh { mesh, transform } = &object.shape else { continue };
            let handle = known
                .entry(Arc::as_ptr(mesh))
                .or_insert_with(|| world.resource_mut::<Assets<Mesh>>().add(drawn(mesh)));
            let place = glam::Mat4::from(*transform).to_cols_array();
            let place = Mat4::from_cols_array(&place);
            let look = (Mesh3d(handle.clone()), MeshMaterial3d(colors[i % COLORS].clone()));
            world.spawn((look, Transform::from_matrix(place)));
        }
        let (min, max) = (self.0.grid.min.to_array(), self.0.grid.max.to_array());
        let (min, max) = (Vec3::from_array(min), Vec3::from_array(max));
        let sun = DirectionalLight { illuminance: 5_000.0, shadow_maps_enabled: true, ..default() };
        world.spawn((sun, Transform::from_xyz(1.0, 4.0, 0.7).looking_at(Vec3::ZERO, Vec3::Y)));
        let range = (max - min).length();
        let lamp = PointLight { intensity: 600_000.0, range, shadow_maps_enabled: true, ..default() };
        world.spawn((lamp, Transform::from_translation(min.lerp(max, 0.4))));
    }

    /// Where the camera is in a picture.
    pub fn eye(&self, picture: u32) -> Transform {
        let frame = picture as usize * STRIDE % self.0.frames.max(1);
        let view = self.0.camera(frame, 1.0).view.inverse();
        Transform::from_matrix(Mat4::from_cols_array(&view.to_cols_array()))
    }
}

/// A mesh as Bevy draws it, with one normal for each triangle.
fn drawn(mesh: &world::Mesh) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let corners = mesh.triangles.iter().flatten().copied().collect();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_indices(Indices::U32(corners))
        .with_duplicated_vertices()
        .with_computed_flat_normals()
}
