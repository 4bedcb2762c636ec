//! One animal that walks: a generated animal or a file with a skin.

use std::path::Path;

use casca_fur::gpu::records::DrawList;
use casca_fur::mesh::{Coat, Mesh, NormalRule, Vertex, center, continuous_normals, weld};
use casca_fur::skin::{Clip, Ending, Joint, Pose, Skeleton, SkinBounds, Weights};
use casca_fur::strands::Fur;
use casca_scenes::fur::animals::Rig;
use casca_scenes::import::Skinned;
use glam::{Affine3A, Vec3};

use crate::common::Failed;

/// The skeleton, weights and clip of a subject.
pub struct Walker {
    skeleton: Skeleton,
    /// Those of its finest mesh.
    pub weights: Weights,
    clip: Clip,
    /// From where the skeleton poses the mesh to where the mesh was at rest, with its size.
    place: Affine3A,
    /// The ground below it.
    pub low: f32,
}

impl Walker {
    /// The walk of a generated animal.
    pub fn generated(rig: &Rig, mesh: &Mesh) -> Self {
        let weights = rig.weights[0].clone();
        let (place, low) = (Affine3A::IDENTITY, mesh.aabb().min.y);
        Self { skeleton: rig.skeleton.clone(), weights, clip: rig.walk.clone(), place, low }
    }

    /// The mesh of a file, centred, and what moves it by the first animation.
    ///
    /// # Errors
    /// The mesh is refused, or the file has no animation that moves a joint.
    pub fn of_file(path: &Path, skinned: &Skinned) -> Result<(Mesh, Self), Failed> {
        let refused = |e: casca_fur::Error| format!("{}: {e}", path.display());
        let Some((_, clip)) = skinned.clips.first() else {
            return Err(format!("{}: has no animation that moves a joint", path.display()).into());
        };
        let corners = skinned.mesh.triangles.as_flattened();
        let mut soup: Vec<Vertex> =
            corners.iter().map(|&v| Vertex::at(skinned.mesh.positions[v as usize])).collect();
        let middle = center(&mut soup).map_err(refused)?.center;
        let vertices = skinned.mesh.positions.iter().map(|&p| Vertex::at(p - middle)).collect();
        let from = Mesh::new(vertices, Vec::new(), skinned.mesh.triangles.clone()).map_err(refused)?;
        continuous_normals(&mut soup, NormalRule::AngleWeighted).map_err(refused)?;
        let brown = vec![Coat { color: Vec3::new(0.36, 0.21, 0.10), length: 1.0 }; soup.len()];
        let mesh = weld(&soup, &brown).map_err(refused)?.ordered();
        let weights = skinned.weights.carried(&from, &mesh).map_err(refused)?;
        let back = Affine3A::from_translation(middle);
        let moved = |joint: &Joint| Joint { inverse_bind: joint.inverse_bind * back, ..*joint };
        let skeleton =
            Skeleton::new(skinned.skeleton.joints().iter().map(moved).collect()).map_err(refused)?;
        // As large as at rest, around the origin, whatever the units of the skeleton are.
        let bald = Fur { height: 0.0, ..Fur::for_radius(1.0, 0.0, 0.1).map_err(refused)? };
        let posed = SkinBounds::new(&mesh, &weights).map_err(refused)?.posed(&Pose::rest(&skeleton), &bald);
        let size = |lo: Vec3, hi: Vec3| (hi - lo).length().max(f32::MIN_POSITIVE);
        let scale = size(mesh.aabb().min, mesh.aabb().max) / size(posed.min, posed.max);
        let place = Affine3A::from_scale(Vec3::splat(scale)) * Affine3A::from_translation(-posed.center());
        let low = -0.5 * scale * (posed.max.y - posed.min.y);
        Ok((mesh, Self { skeleton, weights, clip: clip.clone(), place, low }))
    }

    /// Where its posed mesh is placed.
    pub fn place(&self) -> Affine3A {
        self.place
    }

    /// Poses the first animal of a list.
    ///
    /// # Errors
    /// None for lists with an animal.
    pub fn pose(&self, list: &mut DrawList, seconds: f64) -> Result<(), casca_fur::Error> {
        let mut pose = Pose::rest(&self.skeleton);
        pose.set(&self.skeleton, &self.clip, seconds, Ending::Loop);
        list.pose(0, &pose)
    }
}
