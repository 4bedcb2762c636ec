//! Meshes among the lines, from files.

use std::path::Path;

use casca_lines::mesh::Mesh;
use casca_lines::sets::files::open_mesh;
use casca_scenes::import;
use casca_scenes::world::Shape;
use glam::Vec3A;

use crate::common::Failed;

/// The triangles of a file: those of all objects of glTF, or of OBJ or PLY.
pub fn open(path: &Path) -> Result<Mesh, Failed> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    if !ending.is_some_and(|e| e == "glb" || e == "gltf") {
        return Ok(open_mesh(path)?);
    }
    let mut all = Mesh::default();
    let world = import::load(path)?;
    for object in world.objects {
        let Shape::Mesh { mesh, mut transform } = object.shape else { continue };
        // Lines have the coordinates of their files.
        transform.translation += Vec3A::from(world.source.origin.as_vec3());
        let first = all.positions.len() as u32;
        all.positions.extend(mesh.positions.iter().map(|&p| transform.transform_point3(p)));
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    Ok(all)
}
