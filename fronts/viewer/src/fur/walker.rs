//! One animal that walks: a generated animal or a file with a skin.

use std::path::Path;

use casca_fur::gpu::records::DrawList;
use casca_fur::mesh::Mesh;
use casca_fur::scenes::CharacterRig;
use casca_fur::scenes::animals::Rig;
use casca_fur::skin::{Clip, Pose, Skeleton, Weights};
use glam::Affine3A;

use crate::common::Failed;

/// The skeleton, weights and clip of a subject.
pub struct Walker {
    skeleton: Skeleton,
    /// Those of each level of detail.
    pub weights: Vec<Weights>,
    clip: Clip,
    /// Where its posed mesh is placed: from there to where it was at rest, with its size.
    pub place: Affine3A,
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
        let Some((_, clip)) = rig.clips.first() else {
            return Err(format!("{}: has no animation that moves a joint", path.display()).into());
        };
        let (skeleton, weights) = (rig.skeleton.clone(), rig.weights.clone());
        let placed = rig.place_at_rest(mesh);
        let (place, low) = placed.map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self { skeleton, weights, clip: clip.clone(), place, low })
    }

    /// Poses the first animal of a list.
    pub fn pose(&self, list: &mut DrawList, seconds: f64) -> Result<(), casca_fur::Error> {
        let mut pose = Pose::rest(&self.skeleton);
        pose.set(&self.skeleton, &self.clip, seconds);
        list.pose(0, &pose)
    }
}
