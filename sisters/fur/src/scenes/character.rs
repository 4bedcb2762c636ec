//! Characters of one's own: meshes of files that grow fur.

use std::path::Path;

use crate::error::Error;
use crate::mesh::{Mesh, Vertex, prepare};
use crate::skin::{Clip, Joint, Pose, Skeleton, SkinBounds, Weights};
use crate::strands::Fur;
use glam::{Affine3A, Vec3};

use super::import::{Coated, Rig, read_coated, refused};
use casca_scenes::import::{ImportError, Trouble, open};

/// A mesh of a file that grows fur, at several levels of detail.
#[derive(Debug, Clone)]
pub struct Character {
    /// The levels, finest first. The centre of the box of the finest is the origin.
    pub levels: Vec<Mesh>,
    /// The motion, if the file has a skin.
    pub rig: Option<CharacterRig>,
}

/// The skeleton, weights and clip that move a character.
#[derive(Debug, Clone)]
pub struct CharacterRig {
    /// The joints; poses take the centred mesh to where the file has it.
    pub skeleton: Skeleton,
    /// For each level of detail the weights of its vertices.
    pub weights: Vec<Weights>,
    /// The animations that move a joint, with their names, which may be empty.
    pub clips: Vec<(String, Clip)>,
}

impl Character {
    /// The character of a file, without fur on some materials, by their names, and with at most
    /// this many levels of detail, 1 to 16.
    ///
    /// # Errors
    /// As [`read_coated`] and [`Character::new`].
    pub fn load(path: &Path, bald: &[String], levels: usize) -> Result<Self, ImportError> {
        open(path, |_, bytes, folder| Self::new(&read_coated(bytes, folder)?, bald, levels))
    }

    /// Makes a character of what was read: centred, with normals that are the same on both sides of
    /// each edge, without double vertices, in the order of drawing.
    ///
    /// # Errors
    /// Refuses names of materials that the file does not have, and meshes that the module
    /// [`mesh`](crate::mesh) refuses.
    pub fn new(coated: &Coated, bald: &[String], levels: usize) -> Result<Self, Trouble> {
        let bald = bald_materials(coated, bald)?;
        let given = &coated.mesh;
        // Parts of two materials share no vertices.
        let mut coats = coated.coats.clone();
        for (triangle, material) in given.triangles.iter().zip(&coated.materials) {
            if bald.contains(material) {
                triangle.iter().for_each(|&v| coats[v as usize].length = 0.0);
            }
        }
        let (mesh, placing) = prepare(&given.positions, &coats, &given.triangles).map_err(refused)?;
        let middle = placing.center;
        let levels = mesh.levels(levels).map_err(refused)?;
        let carried = |rig: &Rig| {
            let vertices = given.positions.iter().map(|&p| Vertex::at(p - middle)).collect();
            let from = Mesh::new(vertices, Vec::new(), given.triangles.clone())?;
            let weights = levels.iter().map(|level| rig.weights.carried(&from, level));
            let back = Affine3A::from_translation(middle);
            let moved = |joint: &Joint| Joint { inverse_bind: joint.inverse_bind * back, ..*joint };
            Ok(CharacterRig {
                skeleton: Skeleton::new(rig.skeleton.joints().iter().map(moved).collect())?,
                weights: weights.collect::<Result<_, _>>()?,
                clips: rig.clips.clone(),
            })
        };
        let rig = coated.rig.as_ref().map(carried).transpose().map_err(refused)?;
        Ok(Self { levels, rig })
    }
}

impl CharacterRig {
    /// From the posed mesh to where it has the size of the mesh at rest and its box, posed at rest,
    /// has the origin as its centre, whatever the units of the skeleton are; and the lower end of
    /// that box. `mesh` is the finest level.
    ///
    /// # Errors
    /// The weights are not those of the mesh.
    pub fn place_at_rest(&self, mesh: &Mesh) -> Result<(Affine3A, f32), Error> {
        let weights = self.weights.first().ok_or(Error::Empty)?;
        let bald = Fur { height: 0.0, ..Fur::for_radius(1.0, 0.0, 0.1)? };
        let posed = SkinBounds::new(mesh, weights)?.posed(&Pose::rest(&self.skeleton), &bald);
        let (size, wanted) = (posed.max - posed.min, mesh.aabb().max - mesh.aabb().min);
        let least = f32::MIN_POSITIVE;
        let scale = wanted.length().max(least) / size.length().max(least);
        let place = Affine3A::from_scale(Vec3::splat(scale)) * Affine3A::from_translation(-posed.center());
        Ok((place, -0.5 * scale * size.y))
    }
}

/// The numbers of materials with these names.
fn bald_materials(coated: &Coated, names: &[String]) -> Result<Vec<u32>, Trouble> {
    let mut found = Vec::new();
    for name in names {
        let of_name = (0..).zip(&coated.names).filter(|(_, known)| *known == name && !name.is_empty());
        let before = found.len();
        found.extend(of_name.map(|(number, _)| number));
        if found.len() == before {
            let known = coated.names.iter().map(String::as_str).filter(|name| !name.is_empty());
            let known = known.collect::<Vec<_>>().join(", ");
            return Err(Trouble::Part(format!("has no material {name:?}; there are: {known}")));
        }
    }
    Ok(found)
}
