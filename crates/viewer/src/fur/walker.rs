//! One animal that walks: a generated animal or a file with a skin.

use std::path::Path;

use casca_fur::gpu::records::DrawList;
use casca_fur::mesh::Mesh;
use casca_fur::skin::{Clip, Ending, Pose, Skeleton, SkinBounds, Weights};
use casca_fur::strands::Fur;
use casca_scenes::fur::CharacterRig;
use casca_scenes::fur::animals::Rig;
use glam::{Affine3A, Vec3};

use crate::common::Failed;

/// The skeleton, weights and clip of a subject.
pub struct Walker {
    skeleton: Skeleton,
    /// Those of each level of detail.
    pub weights: Vec<Weights>,
    clip: Clip,
    /// From where the skeleton poses the mesh to where the mesh was at rest, with its size.
    place: Affine3A,
    /// The ground below it.
    pub low: f32,
}

impl Walker {
    /// The walk of a generated animal.
    pub fn generated(rig: &Rig, mesh: &Mesh) -> Self {
        let weights = rig.weights.clone();
        let (place, low) = (Affine3A::IDENTITY, mesh.aabb().min.y);
        Self { skeleton: rig.skeleton.clone(), weights, clip: rig.walk.clone(), place, low }
    }

    /// The walker of the character of a file, by its first animation.
    ///
    /// # Errors
    /// The skin is refused, or the file has no animation that moves a joint.
    pub fn of_file(path: &Path, rig: &CharacterRig, mesh: &Mesh) -> Result<Self, Failed> {
        let refused = |e: casca_fur::Error| format!("{}: {e}", path.display());
        let Some((_, clip)) = rig.clips.first() else {
            return Err(format!("{}: has no animation that moves a joint", path.display()).into());
        };
        let (skeleton, weights) = (rig.skeleton.clone(), rig.weights.clone());
        // As large as at rest, around the origin, whatever the units of the skeleton are.
        let bald = Fur { height: 0.0, ..Fur::for_radius(1.0, 0.0, 0.1).map_err(refused)? };
        let posed = SkinBounds::new(mesh, &weights[0]).map_err(refused)?.posed(&Pose::rest(&skeleton), &bald);
        let size = |lo: Vec3, hi: Vec3| (hi - lo).length().max(f32::MIN_POSITIVE);
        let scale = size(mesh.aabb().min, mesh.aabb().max) / size(posed.min, posed.max);
        let place = Affine3A::from_scale(Vec3::splat(scale)) * Affine3A::from_translation(-posed.center());
        let low = -0.5 * scale * (posed.max.y - posed.min.y);
        Ok(Self { skeleton, weights, clip: clip.clone(), place, low })
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
