//! Scenes from files.

use crate::scenes::Scene;
use glam::{Mat4, Vec3};
use std::error::Error;
use std::path::Path;

/// The triangles of each `.glb` file of a folder, seen from places that its camera walks by.
pub fn scenes(folder: &Path) -> Result<Vec<Scene>, Box<dyn Error>> {
    let mut scenes = Vec::new();
    for name in ["kitchen-parts", "sponza", "cornell"] {
        let path = folder.join(format!("{name}.glb"));
        if path.exists() {
            scenes.push(scene(name, &path)?);
        } else {
            println!("skipped: there is no {}", path.display());
        }
    }
    Ok(scenes)
}

fn scene(name: &str, path: &Path) -> Result<Scene, Box<dyn Error>> {
    let gltf::Gltf { document, blob } = gltf::Gltf::open(path)?;
    let blob = blob.ok_or("the file has no buffer of its own")?;
    let mut scene = Scene { name: name.into(), triangles: Vec::new(), eyes: Vec::new() };
    for root in document.scenes().flat_map(|scene| scene.nodes()) {
        add(&mut scene.triangles, &root, Mat4::IDENTITY, &blob);
    }
    for channel in document.animations().flat_map(|animation| animation.channels()) {
        let reader = channel.reader(|_| Some(&blob[..]));
        if let Some(gltf::animation::util::ReadOutputs::Translations(way)) = reader.read_outputs() {
            let way: Vec<Vec3> = way.map(Vec3::from).collect();
            scene.eyes.extend([0, way.len() / 3, 2 * way.len() / 3].map(|i| way[i]));
        }
    }
    Ok(scene)
}

fn add(triangles: &mut Vec<[Vec3; 3]>, node: &gltf::Node, above: Mat4, blob: &[u8]) {
    let here = above * Mat4::from_cols_array_2d(&node.transform().matrix());
    for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>()) {
        let reader = primitive.reader(|_| Some(blob));
        let positions: Vec<Vec3> =
            reader.read_positions().into_iter().flatten().map(|p| here.transform_point3(p.into())).collect();
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        let corners = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| positions[i as usize]));
        triangles
            .extend(corners.filter(|[a, b, c]| (b - a).cross(c - a).length() > crate::scenes::LEAST_CROSS));
    }
    node.children().for_each(|child| add(triangles, &child, here, blob));
}
